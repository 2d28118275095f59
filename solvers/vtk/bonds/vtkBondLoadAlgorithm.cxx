#include "vtkBondLoadAlgorithm.h"

#include "peridynamics/Loading.h"

#include <array>

namespace pd = lamella::peridynamics;

pd::Loading vtkBondLoadAlgorithm::Platens() const
{
  pd::Loading loading;
  loading.load = static_cast<pd::LoadCase>(this->Load);
  loading.axis = this->LoadAxis;
  loading.smooth = this->SmoothPlatens;
  loading.rigid = this->RigidPlatens;
  loading.layers = this->PlatenLayers;
  return loading;
}

const char* vtkBondLoadAlgorithm::LoadName() const
{
  constexpr std::array<const char*, 4> names{ "stretch", "shear", "biaxial", "traction" };
  return names.at(static_cast<std::size_t>(this->Load));
}
