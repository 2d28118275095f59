#include "BondFields.h"

#include "core/Error.h"
#include "peridynamics/BondForces.h"
#include "peridynamics/BondLattice.h"

#include "vtkDataObject.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkPointData.h"

namespace pd = lamella::peridynamics;

namespace lamella
{

void addDisplacement(
  vtkImageData* output, const BondScene& scene, const pd::NodeField<double>& displacement, const char* creator)
{
  const std::array<int, 3> from{ 0, 1, scene.lattice().dimension == 3 ? 2 : -1 };
  const auto array = scene.toPiece(displacement, from, "displacement");
  describe(array, "m", "displacement at equilibrium; 0 in voids", creator);
  output->GetPointData()->AddArray(array);
  output->GetPointData()->SetActiveVectors("displacement");
}

void addStrainEnergy(
  vtkImageData* output, const BondScene& scene, const pd::NodeField<double>& energy, const char* creator)
{
  const auto array = scene.toPiece(energy, std::array<int, 1>{ 0 }, "strain_energy");
  describe(array, "J/m^3", "elastic energy of half of the node's bonds over its volume", creator);
  output->GetPointData()->AddArray(array);
}

void displacementsOf(vtkImageData* state, const BondScene& scene, pd::NodeField<double>& u, const Team& team)
{
  const NodeVectors given =
    vectorsOf(state, nullptr, "displacement", "keep it in the states", scene.lattice().dimension, team);
  scene.toSlab(given.array, given.name, u);
}

void addMeasures(vtkImageData* state, const BondScene& scene, const pd::BondLattice& bonds, const Measures& measures,
  const char* creator, const Team& team)
{
  const int dimension = scene.lattice().dimension;
  pd::NodeField<double> u(bonds.layout());
  displacementsOf(state, scene, u, team);
  bonds.exchange(u);
  if (measures.stress)
  {
    pd::NodeField<double> stress(bonds.layout(), dimension == 2 ? 3 : 6);
    pd::nodalStress(bonds, u, stress, measures.largeStrains);
    state->GetPointData()->AddArray(stressArray(scene, stress, creator));
  }
  if (measures.energy)
  {
    pd::NodeField<double> energy(bonds.layout(), 1);
    pd::energyDensity(bonds, u, energy, measures.largeStrains);
    addStrainEnergy(state, scene, energy, creator);
  }
}

void leaveOut(vtkImageData* output, vtkImageData* input, const char* name)
{
  vtkDataArray* const given = input->GetPointData()->GetArray(name);
  if (given != output->GetPointData()->GetArray(name))
  {
    output->GetPointData()->RemoveArray(name);
    if (given != nullptr)
      output->GetPointData()->AddArray(given);
  }
}

NodeVectors vectorsOf(vtkImageData* piece, vtkInformation* choice, const char* otherwise, const char* whence,
  int dimension, const Team& team)
{
  const bool named = choice != nullptr && choice->Has(vtkDataObject::FIELD_NAME());
  const char* const name = named ? choice->Get(vtkDataObject::FIELD_NAME()) : "";
  NodeVectors v{ nullptr, *name != '\0' ? name : otherwise };
  team.agree(
    [&]
    {
      if (piece->GetNumberOfPoints() == 0)
        return;
      v.array = piece->GetPointData()->GetArray(v.name.c_str());
      if (v.array == nullptr)
        throw InputError(
          "the image has no point array '" + v.name + "'", std::string(whence) + ", or choose another array");
      if (const int n = v.array->GetNumberOfComponents(); n < dimension || n > 3)
        throw InputError("array '" + v.name + "' has " + std::to_string(n) + " components; vectors of a " +
            (dimension == 2 ? "picture have 2 or 3" : "volume have 3"),
          "choose another array");
    });
  return v;
}

} // namespace lamella
