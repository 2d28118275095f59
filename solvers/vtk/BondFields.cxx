#include "BondFields.h"

#include "vtkDoubleArray.h"
#include "vtkImageData.h"
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

} // namespace lamella
