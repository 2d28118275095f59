#include "vtkBondLoadAlgorithm.h"

#include "BreakData.h"
#include "vtkClassMacros.h"

#include "peridynamics/Loading.h"

#include <array>

namespace pd = lamella::peridynamics;

struct vtkBondLoadAlgorithm::Internals
{
  lamella::BondUncertainties Uncertainties;
};

vtkBondLoadAlgorithm::vtkBondLoadAlgorithm()
  : Given(std::make_unique<Internals>())
{
}

vtkBondLoadAlgorithm::~vtkBondLoadAlgorithm() = default;

vtkSetNamedMacro(
  vtkBondLoadAlgorithm, YoungsModulusUncertainty, YoungsModulusUncertainties, Given->Uncertainties.young);
vtkSetNamedMacro(
  vtkBondLoadAlgorithm, FractureEnergyUncertainty, FractureEnergyUncertainties, Given->Uncertainties.fractureEnergy);
vtkSetNamedMacro(vtkBondLoadAlgorithm, ToughnessUncertainty, ToughnessUncertainties, Given->Uncertainties.toughness);
vtkSetNamedMacro(
  vtkBondLoadAlgorithm, CriticalStretchUncertainty, CriticalStretchUncertainties, Given->Uncertainties.criticalStretch);

const lamella::BondUncertainties& vtkBondLoadAlgorithm::Uncertainties() const
{
  this->Given->Uncertainties.require(this->Settings().materials);
  return this->Given->Uncertainties;
}

bool vtkBondLoadAlgorithm::WantsSensitivity() const
{
  return this->ComputeSensitivity || this->Given->Uncertainties.any();
}

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
