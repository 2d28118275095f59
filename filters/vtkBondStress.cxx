#include "vtkBondStress.h"

#include "BondFields.h"
#include "vtkProvenance.h"

#include "core/Error.h"
#include "peridynamics/BondForces.h"
#include "peridynamics/BondLattice.h"
#include "peridynamics/ElasticStudy.h"

#include "vtkImageData.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"

namespace pd = lamella::peridynamics;

vtkStandardNewMacro(vtkBondStress);

vtkBondStress::vtkBondStress()
{
  this->SetInputArrayToProcess(2, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "displacement");
}

void vtkBondStress::Run(vtkImageData* input, vtkImageData* output, const lamella::Team& team)
{
  lamella::BondSettings settings = this->Settings();
  if (this->ModelFromInput)
  {
    const bool known = input->GetNumberOfPoints() > 0;
    const std::string text = team.share(lamella::fieldText(input, lamella::bondModelName).value_or(""), known);
    if (text.empty())
    {
      throw lamella::InputError(
        std::string("the image does not tell its model: it has no field text '") + lamella::bondModelName + "'",
        "make it with lamella equilibrium, or switch ModelFromInput off and give the model");
    }
    settings = lamella::bondSettingsFromJson(text);
  }
  const lamella::BondScene scene(
    input, this->GetInputArrayInformation(0), this->GetInputArrayInformation(1), settings, team);
  const int dimension = scene.lattice().dimension;
  const lamella::NodeVectors given = lamella::vectorsOf(
    input, this->GetInputArrayInformation(2), "displacement", "solve for it with lamella equilibrium", dimension, team);
  this->UpdateProgress(0.1);
  const pd::ThreadScope threads(this->ThreadCount());
  const lamella::Communicator comm(team.comm());
  const pd::BondLattice bonds(scene.model(), scene.lattice(), scene.phase(), scene.grain(), comm);
  pd::NodeField<double> u(bonds.layout());
  scene.toSlab(given.array, given.name, u);
  bonds.exchange(u);
  this->UpdateProgress(0.5);
  if (team.any(this->CheckAbort()))
    throw lamella::Cancelled();
  pd::NodeField<double> stress(bonds.layout(), dimension == 2 ? 3 : 6);
  pd::nodalStress(bonds, u, stress, settings.largeStrains);

  output->ShallowCopy(input);
  const auto array = lamella::stressArray(scene, stress, this->GetClassName());
  output->GetPointData()->AddArray(array);
  if (this->ComputeStrainEnergy)
  {
    pd::NodeField<double> energy(bonds.layout(), 1);
    pd::energyDensity(bonds, u, energy, settings.largeStrains);
    lamella::addStrainEnergy(output, scene, energy, this->GetClassName());
  }
  lamella::setFieldNumbers(output, "mean_stress", pd::meanStress(bonds, stress, scene.model().continuum));
  const nlohmann::json model = lamella::toJson(settings);
  lamella::setFieldText(output, lamella::bondModelName, model.dump());
  lamella::continueProvenance(output, "bond_stress", { { "model", model }, { "displacement", given.name } });
}
