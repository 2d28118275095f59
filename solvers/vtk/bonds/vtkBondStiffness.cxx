#include "vtkBondStiffness.h"

#include "BondFields.h"
#include "StiffnessTables.h"
#include "vtkClassMacros.h"
#include "vtkProvenance.h"

#include "core/Error.h"
#include "peridynamics/StiffnessStudy.h"

#include "vtkDataObject.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkObjectFactory.h"
#include "vtkTable.h"

namespace pd = lamella::peridynamics;

namespace
{

using lamella::unknown;

/// What was found, as field data.
void write(vtkImageData* output, const lamella::StiffnessFound& found, const pd::StiffnessResult& r)
{
  lamella::setStiffness(output, found);
  const auto whole = [&](const char* name, std::int64_t value)
  { lamella::setFieldNumber(output, name, static_cast<double>(value)); };
  pd::EquilibriumResult most;
  for (const pd::EquilibriumResult& s : r.cell.solutions)
  {
    most.residual = std::max(most.residual, s.residual);
    most.hinges = std::max(most.hinges, s.hinges);
    most.levels = std::max(most.levels, s.levels);
    most.products += s.products;
  }
  lamella::setFieldNumber(output, "residual", most.residual);
  whole("hinges", most.hinges);
  whole("levels", most.levels);
  whole("products", most.products);
  lamella::setWork(output, r);
  lamella::setFieldNumbers(output, "seconds",
    std::array{ r.bondSeconds, r.setupSeconds, r.solveSeconds, r.measureSeconds, r.estimateSeconds });
}

} // namespace

vtkStandardNewMacro(vtkBondStiffness);

vtkBondStiffness::vtkBondStiffness()
  : EstimatedError(unknown)
{
  this->SetNumberOfOutputPorts(3);
}

vtkGetOutputMacro(vtkBondStiffness, Tensor, vtkTable, 1);
vtkGetOutputMacro(vtkBondStiffness, Constants, vtkTable, 2);
vtkOutputTypesMacro(vtkBondStiffness, "vtkImageData", "vtkTable", "vtkTable");

void vtkBondStiffness::Run(vtkImageData* input, vtkImageData* output, const lamella::Team& team)
{
  this->EstimatedError = unknown;
  vtkTable* const tensor = this->GetTensor();
  vtkTable* const constants = this->GetConstants();
  tensor->Initialize();
  constants->Initialize();
  lamella::BondSettings settings = this->Settings();
  settings.periodic = { false, false, false }; // every side is, whatever its dimension
  settings.micromodulus = settings.micromodulus.value_or(pd::Micromodulus::Isotropic);
  const lamella::BondScene scene(
    input, this->GetInputArrayInformation(0), this->GetInputArrayInformation(1), settings, team);
  pd::StiffnessOptions options;
  options.equilibrium.strains = settings.largeStrains ? pd::Strains::Large : pd::Strains::Small;
  options.equilibrium.tolerance = this->Tolerance;
  options.equilibrium.maxIterations = this->MaximumIterations;
  this->SetProgressText("stiffness");
  options.equilibrium.progress = [this](double share)
  {
    this->UpdateProgress(share);
    return this->CheckAbort();
  };
  options.estimateError = this->EstimateError;
  options.nodesPerPixel = this->NodesPerPixel;
  options.threads = this->ThreadCount();
  if (this->CheckAbort())
    throw lamella::Cancelled();
  const lamella::Communicator comm(team.comm());
  const int dimension = scene.lattice().dimension;
  pd::StiffnessResult result =
    pd::studyStiffness(scene.model(), scene.lattice(), scene.phase(), scene.grain(), options, comm);
  for (const std::string& doubt : lamella::unitDoubts(settings.materials))
    result.warnings.push_back(doubt);
  this->EstimatedError = result.error.relative;

  output->ShallowCopy(input);
  const pd::EffectiveStiffness& cell = result.cell;
  const lamella::StiffnessFound found{ dimension, cell.stiffness, cell.bounds.voigt, cell.bounds.reuss, cell.asymmetry,
    &cell.constants, &result.error, result.steps, result.sides, cell.crosses, cell.pieces, cell.loosePieces,
    cell.looseNodes };
  write(output, found, result);
  lamella::describeThickness(output, scene, result.thickness);
  settings.periodic = { true, true, dimension == 3 };
  const nlohmann::json model = lamella::describeModel(output, scene, settings);
  lamella::continueProvenance(output, "bond_stiffness",
    { { "model", model }, { "estimate_error", this->EstimateError }, { "nodes_per_pixel", this->NodesPerPixel },
      { "tolerance", this->Tolerance } });
  if (team.rank() == 0)
  {
    lamella::fillTensor(tensor, found, "vtkBondStiffness");
    lamella::fillConstants(constants, found, "vtkBondStiffness");
    for (const std::string& warning : result.warnings)
      vtkWarningMacro(<< warning);
  }
  for (vtkTable* const table : { tensor, constants })
    table->GetFieldData()->ShallowCopy(output->GetFieldData());
}
