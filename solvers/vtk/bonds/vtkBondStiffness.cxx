#include "vtkBondStiffness.h"

#include "BondFields.h"
#include "vtkProvenance.h"

#include "core/Error.h"
#include "peridynamics/StiffnessStudy.h"

#include "vtkDataObject.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkStringArray.h"
#include "vtkTable.h"

#include <vector>

namespace el = lamella::elasticity;
namespace pd = lamella::peridynamics;

namespace
{

using lamella::unknown;

/// The values, or as many unknown ones.
std::vector<double> orUnknown(const std::vector<double>& values, std::size_t count)
{
  return values.empty() ? std::vector<double>(count, unknown) : values;
}

template <class Values>
std::vector<double> numbers(const Values& values)
{
  return { values.begin(), values.end() };
}

/// What was found, as field data.
void write(vtkImageData* output, const pd::StiffnessResult& r, int dimension)
{
  const auto set = [output](const char* name, const std::vector<double>& values)
  { lamella::setFieldNumbers(output, name, values); };
  const auto whole = [&](const char* name, std::int64_t value) { set(name, { static_cast<double>(value) }); };
  const pd::EffectiveStiffness& cell = r.cell;
  const std::size_t entries = cell.stiffness.size();
  lamella::setFieldTexts(output, "stiffness_components", el::voigtNames(dimension));
  set("stiffness", cell.stiffness);
  set("stiffness_extrapolated", orUnknown(r.error.extrapolated, entries));
  set("stiffness_error", orUnknown(r.error.components, entries));
  set("stiffness_voigt", cell.bounds.voigt);
  set("stiffness_reuss", cell.bounds.reuss);
  set("stiffness_asymmetry", { cell.asymmetry });
  set("estimated_error", { r.error.relative });
  const std::vector<double> constants = el::constantValues(cell.constants);
  lamella::setFieldTexts(output, "constant_names", el::constantNames(dimension));
  set("constants", constants);
  set("constants_extrapolated", orUnknown(el::constantValues(r.error.constants), constants.size()));
  set("constants_error", orUnknown(r.error.ofConstants, constants.size()));
  set("eigenvalues", cell.constants.eigenvalues);
  whole("resisting", cell.constants.resisting);
  set("crosses", numbers(cell.crosses));
  whole("pieces", cell.pieces);
  whole("loose_pieces", cell.loosePieces);
  whole("loose_nodes", cell.looseNodes);
  std::vector<double> across;
  std::vector<double> inside;
  for (const el::SideMatch& side : r.sides)
  {
    across.push_back(side.across);
    inside.push_back(side.inside);
  }
  set("seam_mismatch", across);
  set("layer_mismatch", inside);

  std::array<std::vector<double>, 5> steps;
  for (const pd::StiffnessStep& step : r.steps)
  {
    std::int64_t iterations = 0;
    for (const std::int64_t n : step.iterations)
      iterations += n;
    steps[0].push_back(step.every);
    steps[1].push_back(step.pictures);
    steps[2].push_back(static_cast<double>(step.nodes));
    steps[3].push_back(static_cast<double>(iterations));
    steps[4].push_back(step.seconds);
  }
  constexpr std::array<const char*, 5> names{ "step_every", "step_pictures", "step_nodes", "step_iterations",
    "step_seconds" };
  for (std::size_t i = 0; i < names.size(); ++i)
    set(names[i], steps[i]);
  set("iterations", numbers(r.steps.front().iterations));
  pd::EquilibriumResult most;
  for (const pd::EquilibriumResult& s : cell.solutions)
  {
    most.residual = std::max(most.residual, s.residual);
    most.hinges = std::max(most.hinges, s.hinges);
    most.levels = std::max(most.levels, s.levels);
    most.products += s.products;
  }
  set("residual", { most.residual });
  whole("hinges", most.hinges);
  whole("levels", most.levels);
  whole("products", most.products);
  lamella::setWork(output, r);
  set("seconds", { r.bondSeconds, r.setupSeconds, r.solveSeconds, r.measureSeconds, r.estimateSeconds });
}

void addNumbers(vtkTable* table, const std::string& name, const char* unit, const char* words,
  const std::vector<double>& values, std::size_t first, std::size_t step, std::size_t rows)
{
  vtkNew<vtkDoubleArray> column;
  column->SetName(name.c_str());
  for (std::size_t row = 0; row < rows; ++row)
    column->InsertNextValue(values.at(first + step * row));
  lamella::describe(column, unit, words, "vtkBondStiffness");
  table->AddColumn(column);
}

void addTexts(vtkTable* table, const char* name, const std::vector<std::string>& texts)
{
  vtkNew<vtkStringArray> column;
  column->SetName(name);
  for (const std::string& text : texts)
    column->InsertNextValue(text);
  table->AddColumn(column);
}

void fillTensor(vtkTable* table, const pd::StiffnessResult& r, int dimension)
{
  const std::vector<std::string> names = el::voigtNames(dimension);
  const std::size_t n = names.size();
  addTexts(table, "stress", names);
  const auto block = [&](const std::string& prefix, const char* words, const std::vector<double>& values)
  {
    for (std::size_t strain = 0; strain < n; ++strain)
      addNumbers(table, prefix + names[strain], "Pa", words, values, strain, n, n);
  };
  block("", "stress over this mean strain", r.cell.stiffness);
  block("extrapolated_", "what the material is expected to have", orUnknown(r.error.extrapolated, n * n));
  block("error_", "estimated error against the material", orUnknown(r.error.components, n * n));
}

void fillConstants(vtkTable* table, const pd::StiffnessResult& r, int dimension)
{
  const std::vector<std::string> names = el::constantNames(dimension);
  const std::size_t n = names.size();
  addTexts(table, "constant", names);
  const auto column = [&](const char* name, const char* words, const std::vector<double>& values)
  { addNumbers(table, name, "", words, values, 0, 1, n); };
  column("value", "moduli in Pa, Poisson's ratios", el::constantValues(r.cell.constants));
  column("extrapolated", "what the material is expected to have", orUnknown(el::constantValues(r.error.constants), n));
  column("error", "estimated error against the material", orUnknown(r.error.ofConstants, n));
  std::vector<std::string> units;
  for (const std::string& name : names)
    units.emplace_back(name.starts_with("nu") ? "1" : "Pa");
  addTexts(table, "unit", units);
}

} // namespace

vtkStandardNewMacro(vtkBondStiffness);

vtkBondStiffness::vtkBondStiffness()
  : EstimatedError(unknown)
{
  this->SetNumberOfOutputPorts(3);
}

vtkTable* vtkBondStiffness::GetTensor()
{
  return vtkTable::SafeDownCast(this->GetOutputDataObject(1));
}

vtkTable* vtkBondStiffness::GetConstants()
{
  return vtkTable::SafeDownCast(this->GetOutputDataObject(2));
}

int vtkBondStiffness::FillOutputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), port == 0 ? "vtkImageData" : "vtkTable");
  return 1;
}

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
  write(output, result, dimension);
  lamella::describeThickness(output, scene, result.thickness);
  settings.periodic = { true, true, dimension == 3 };
  const nlohmann::json model = lamella::describeModel(output, scene, settings);
  lamella::continueProvenance(output, "bond-stiffness",
    { { "model", model }, { "estimate_error", this->EstimateError }, { "nodes_per_pixel", this->NodesPerPixel },
      { "tolerance", this->Tolerance } });
  if (team.rank() == 0)
  {
    fillTensor(tensor, result, dimension);
    fillConstants(constants, result, dimension);
    for (const std::string& warning : result.warnings)
      vtkWarningMacro(<< warning);
  }
  for (vtkTable* const table : { tensor, constants })
    table->GetFieldData()->ShallowCopy(output->GetFieldData());
}
