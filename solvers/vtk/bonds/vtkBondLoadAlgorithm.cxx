#include "vtkBondLoadAlgorithm.h"

#include "BondScene.h"
#include "BreakData.h"
#include "vtkClassMacros.h"

#include "peridynamics/Loading.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace pd = lamella::peridynamics;

struct vtkBondLoadAlgorithm::Internals
{
  lamella::BondUncertainties Uncertainties;
  std::vector<std::string> PressurePhases;
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

vtkRemoveAllMacro(vtkBondLoadAlgorithm, PressurePhases, Given->PressurePhases);

void vtkBondLoadAlgorithm::AddPressurePhase(const char* phase)
{
  std::vector<std::string>& phases = this->Given->PressurePhases;
  if (phase == nullptr || *phase == '\0' || std::find(phases.begin(), phases.end(), phase) != phases.end())
    return;
  phases.emplace_back(phase);
  this->Modified();
}

const std::vector<std::string>& vtkBondLoadAlgorithm::PressurePhases() const
{
  return this->Given->PressurePhases;
}

const lamella::BondUncertainties& vtkBondLoadAlgorithm::Uncertainties() const
{
  this->Given->Uncertainties.require(this->Settings().materials);
  return this->Given->Uncertainties;
}

bool vtkBondLoadAlgorithm::WantsSensitivity() const
{
  return this->ComputeSensitivity || this->Given->Uncertainties.any();
}

pd::Loading vtkBondLoadAlgorithm::Platens(const lamella::BondScene& scene) const
{
  pd::Loading loading;
  loading.load = static_cast<pd::LoadCase>(this->Load);
  loading.axis = this->LoadAxis;
  loading.smooth = this->SmoothPlatens;
  loading.rigid = this->RigidPlatens;
  loading.layers = this->PlatenLayers;
  loading.straightSides = this->StraightSides;
  for (const std::string& name : this->Given->PressurePhases)
  {
    const std::uint8_t id = lamella::findVoid(scene.phases(), name, "pores under pressure");
    const std::vector<std::uint8_t>& voids = scene.model().voids;
    if (std::find(voids.begin(), voids.end(), id) == voids.end())
    {
      throw lamella::ParameterError(
        fmt::format("a pressure is to act in {}, which is solid", name), "choose phases that are void");
    }
    loading.pressureIn.push_back(id);
  }
  return loading;
}

const char* vtkBondLoadAlgorithm::LoadName() const
{
  constexpr std::array<const char*, 5> names{ "stretch", "shear", "biaxial", "traction", "pressure" };
  return names.at(static_cast<std::size_t>(this->Load));
}
