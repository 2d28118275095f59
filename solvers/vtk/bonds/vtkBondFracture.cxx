#include "vtkBondFracture.h"

#include "BondScene.h"
#include "BreakData.h"
#include "FieldNumbers.h"
#include "FractureData.h"
#include "SurfaceDoubt.h"
#include "WindowFields.h"
#include "vtkClassMacros.h"
#include "vtkProvenance.h"

#include "core/Error.h"
#include "peridynamics/fracture/SurfaceStrength.h"
#include "peridynamics/fracture/WindowStrength.h"

#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkTable.h"

#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace pd = lamella::peridynamics;

namespace
{

void check(const lamella::BondSettings& settings)
{
  if (settings.largeStrains)
    throw lamella::ParameterError("fracture in large strains", "leave them out: quasi-static fracture is linear");
  const pd::PairTable& materials = settings.materials;
  if (materials.criticalStretch.empty() && materials.toughness.empty() && materials.fractureEnergy.empty())
  {
    throw lamella::ParameterError("nothing can break: there is no critical stretch, toughness or fracture energy",
      "give one of them for the pairs of phases that are to break");
  }
}

/// @param unwritten the last checkpoint
std::string textOf(const pd::FractureProgress& p, bool unwritten)
{
  std::array<char, 128> text{};
  if (p.equilibrium < 1)
  {
    std::snprintf(text.data(), text.size(), "first equilibrium, %.0f %%", 100 * p.equilibrium);
  }
  else
  {
    std::snprintf(text.data(), text.size(), "%lld bonds broken, peak %.3g Pa%s", static_cast<long long>(p.broken),
      p.peakStress, unwritten ? ", checkpoint not written" : "");
  }
  return text.data();
}

// What an image has of them from before goes where there are none.
void describeWindows(vtkImageData* image, std::optional<lamella::statistics::StrengthError> windows)
{
  for (const char* const name : { "strength_exponent", "weibull_modulus" })
    image->GetFieldData()->RemoveArray(name);
  if (!windows)
  {
    lamella::setWindowFields(image, {});
    return;
  }
  windows->error.name = "strength";
  lamella::setWindowFields(image, std::span(&windows->error, 1));
  lamella::setFieldNumber(image, "strength_exponent", windows->exponent);
  lamella::setFieldNumber(image, "weibull_modulus", windows->modulus);
}

/// What a doubt about surfaces does to the strength.
struct MovedSurfaces
{
  double doubt = 0; ///< [nodes]
  pd::SurfaceStrengths strengths;
};

void describeSurfaces(vtkImageData* image, double peak, const std::optional<MovedSurfaces>& surfaces)
{
  for (const char* const name :
    { "strength_grown", "strength_shrunk", "surface_step", "strength_segmentation_error", "strength_total_error" })
    image->GetFieldData()->RemoveArray(name);
  if (!surfaces)
    return;
  const double error = pd::strengthDoubt(peak, surfaces->strengths, surfaces->doubt);
  lamella::setFieldNumber(image, "surface_doubt", surfaces->doubt);
  lamella::setFieldNumber(image, "surface_step", surfaces->strengths.step);
  lamella::setFieldNumber(image, "strength_grown", surfaces->strengths.grown);
  lamella::setFieldNumber(image, "strength_shrunk", surfaces->strengths.shrunk);
  lamella::setFieldNumber(image, "strength_segmentation_error", error);
  const std::vector<lamella::statistics::ErrorPart> parts = lamella::strengthErrorParts(image);
  if (parts.size() > 1)
    lamella::setFieldNumber(image, "strength_total_error", lamella::statistics::totalError(parts) * peak);
}

} // namespace

struct vtkBondFracture::Internals
{
  std::vector<double> Strains;
  std::vector<double> Turns;
};

vtkStandardNewMacro(vtkBondFracture);

vtkBondFracture::vtkBondFracture()
  : Internal(std::make_unique<Internals>())
{
}

vtkBondFracture::~vtkBondFracture() = default;

vtkAddToListMacro(vtkBondFracture, StateAtStrain, StatesAtStrains, double, Internal->Strains);
vtkAddToListMacro(vtkBondFracture, TurningPoint, TurningPoints, double, Internal->Turns);

void vtkBondFracture::CheckPressure() const
{
  if (this->Load != PRESSURE)
    return;
  const std::array<std::pair<bool, const char*>, 3> not_{ { { this->Compression, "compression" },
    { this->EstimateWindowError, "a window error" },
    { this->EstimateSegmentationError || this->SurfaceDoubt > 0, "a segmentation error" } } };
  for (const auto& [asked, what] : not_)
    if (asked)
    {
      throw lamella::ParameterError(std::string(what) + " of a sample under a pressure",
        what == not_.front().second ? "leave it out; suction makes pores smaller" : "leave it out, or load by platens");
    }
}

void vtkBondFracture::CheckCycles(const lamella::BondSettings& settings) const
{
  if (this->Internal->Turns.empty() && this->Cycles != 1)
    throw lamella::ParameterError(
      fmt::format("{} cycles without turning points", this->Cycles), "give the strains between which the load goes");
  if (this->Contact && this->WantsSensitivity() && !settings.notches.empty())
    throw lamella::ParameterError(
      "a sensitivity of a sample whose notches close: its derivatives are those of open ones",
      "leave contact, the notches or the sensitivity out");
  if (this->Internal->Turns.empty())
    return;
  if (this->WantsSensitivity())
    throw lamella::ParameterError("a sensitivity of the first break under a load that turns round",
      "leave the sensitivity out, or the turning points");
  if (this->EstimateWindowError || this->EstimateSegmentationError || this->SurfaceDoubt > 0)
    throw lamella::ParameterError("an error of the strength under a load that turns round",
      "leave the window and the segmentation error out, or the turning points");
}

void vtkBondFracture::SetOptions(const lamella::BondScene& scene, pd::FractureStudyOptions& options) const
{
  options.loading = this->Platens(scene);
  options.loading.strain = this->Compression ? -1e-3 : 1e-3;
  options.loading.pressure *= this->Suction ? -1 : 1;
  options.loading.lateralStrain = this->LateralRatio * options.loading.strain;
  options.fracture.contact = this->Contact;
  const std::vector<double>& turns = this->Internal->Turns;
  for (int cycle = 0; cycle < this->Cycles; ++cycle)
    options.fracture.turningPoints.insert(options.fracture.turningPoints.end(), turns.begin(), turns.end());
  options.fracture.breaking = static_cast<pd::Breaking>(this->Breaking);
  options.fracture.stopShare = this->StopShare;
  SetLimit("the largest strain", this->MaximumStrain, options.fracture.maxStrain);
  options.fracture.strainStep = this->StrainStep;
  SetLimit("the largest number of broken bonds", this->MaximumBroken, options.fracture.maxBroken);
  options.fracture.tolerance = this->Tolerance;
  if (!this->Rivals)
    options.fracture.events.rivals = 0;
  if (this->Method != AUTO)
    options.method = this->Method == EVENTS ? pd::FractureMethod::Events : pd::FractureMethod::Accurate;
  options.fracture.renewEvery = this->CheckpointEvery;
  options.atStrains = this->Internal->Strains;
  options.atBroken = this->StatesAtBroken();
  options.displacement = this->ComputeDisplacement;
  options.stress = this->ComputeStress;
  options.energyDensity = this->ComputeStrainEnergy;
  options.threads = this->ThreadCount();
}

void vtkBondFracture::Solve(vtkImageData* input, const lamella::Team& team, vtkPolyData* broken, vtkTable* curve)
{
  const lamella::BondSettings settings = this->Settings();
  check(settings);
  this->CheckPressure();
  this->CheckCycles(settings);
  const bool surfaces = this->EstimateSegmentationError || this->SurfaceDoubt > 0;
  std::optional<MovedSurfaces> moved;
  if (surfaces)
    moved.emplace().doubt = lamella::surfaceDoubt(input, this->SurfaceDoubt, lamella::Communicator(team.comm()));
  if (this->EstimateWindowError && !settings.notches.empty())
    throw lamella::ParameterError("a window error of a sample with a notch, which is no part of its material",
      "leave the notch, or the window error out");
  const lamella::BondUncertainties& uncertainties = this->Uncertainties();
  const lamella::BondScene scene(
    input, this->GetInputArrayInformation(0), this->GetInputArrayInformation(1), settings, team);
  pd::FractureStudyOptions options;
  this->SetOptions(scene, options);
  options.fracture.continueFrom = this->PrepareCheckpoints(input, team, options.fracture.checkpoint);
  bool unwritten = false; // the last checkpoint
  options.fracture.checkpoint.warn = [&unwritten](const std::string&) { unwritten = true; };
  this->SetProgressText("fracture");
  bool first = false; // on the way to the first equilibrium
  options.fracture.progress = [&](const pd::FractureProgress& p)
  {
    unwritten = unwritten && this->LastCheckpoint == p.checkpoint;
    this->LastCheckpoint = p.checkpoint;
    if (first != (p.equilibrium < 1))
      this->TellNext();
    first = p.equilibrium < 1;
    this->Tell(p.share, [&] { return textOf(p, unwritten); });
    return static_cast<bool>(this->CheckAbort());
  };
  options.keep = [&](const pd::FractureState& state)
  {
    vtkImageData* const image = this->NewState(input);
    lamella::setFractureState(image, state, scene, this->GetClassName());
    this->EmitState(image);
  };
  if (this->CheckAbort())
    throw lamella::Cancelled();
  pd::FractureResult result = pd::studyFracture(
    scene.model(), scene.lattice(), scene.phase(), scene.grain(), options, lamella::Communicator(team.comm()));
  this->PeakStress = result.peak.stress;
  std::optional<lamella::BondScene::Whole> whole; // for what is done with all of it
  if (this->EstimateWindowError || moved)
    whole = scene.whole();
  std::optional<lamella::statistics::StrengthError> windows;
  if (this->EstimateWindowError)
  {
    this->TellNext();
    const std::vector<lamella::statistics::WindowTiling> strengths = pd::windowStrengths(
      scene.model(), scene.lattice(), whole->phase, whole->grain, options, lamella::Communicator(team.comm()));
    if (!strengths.empty())
      windows = lamella::statistics::strengthError(result.peak.stress, strengths);
    else
      result.warnings.emplace_back(
        "the window error could not be told: the sample is too small to be cut into windows");
  }
  if (moved)
  {
    this->TellNext();
    moved->strengths = pd::surfaceStrengths(scene.model(), scene.lattice(), whole->phase, whole->grain, options,
      moved->doubt, lamella::Communicator(team.comm()));
  }
  std::optional<pd::BreakSensitivity> sensitivity;
  if (this->WantsSensitivity() && !result.record.broken.empty())
  {
    this->TellNext();
    pd::ElasticOptions unbroken;
    unbroken.loading = options.loading;
    unbroken.equilibrium.tolerance = options.fracture.tolerance;
    unbroken.equilibrium.progress = [this](double share)
    {
      this->Tell(share, [] { return std::string("sensitivity of the first break"); });
      return static_cast<bool>(this->CheckAbort());
    };
    unbroken.sensitivity = true;
    unbroken.threads = options.threads;
    sensitivity = pd::studyElastic(lamella::sensitivityModel(scene, settings), scene.lattice(), scene.phase(),
      scene.grain(), unbroken, lamella::Communicator(team.comm()))
                    .sensitivity;
  }
  this->AddWarnings(settings, result.warnings);
  for (vtkImageData* const image : this->KeptStates())
  {
    this->Describe(image, scene, settings, result);
    describeWindows(image, windows);
    describeSurfaces(image, result.peak.stress, moved);
    lamella::setBreakSensitivity(image, scene, settings, uncertainties, result.record.first.stress, sensitivity);
  }
  if (team.rank() == 0)
  {
    lamella::setBrokenBonds(broken, result, scene, this->GetClassName());
    lamella::setFractureCurve(curve, result, this->GetClassName());
  }
  std::vector<pd::Bond> order;
  for (const auto& b : result.record.broken)
    order.push_back(b.bond);
  this->Finish(broken, curve, std::move(order), scene, result.warnings, team);
}

void vtkBondFracture::Describe(vtkImageData* image, const lamella::BondScene& scene,
  const lamella::BondSettings& settings, const pd::FractureResult& result) const
{
  const auto breaking = static_cast<pd::Breaking>(this->Breaking);
  lamella::setFractureNumbers(image, result);
  lamella::describeThickness(image, scene, result.thickness);
  const nlohmann::json model = lamella::describeModel(image, scene, settings);
  lamella::setFieldText(image, "load", this->LoadName());
  lamella::setFieldNumber(image, "compression", this->Compression ? 1.0 : 0.0);
  lamella::setFieldNumber(image, "suction", this->Load == PRESSURE && this->Suction ? 1.0 : 0.0);
  lamella::setFieldNumber(image, "contact", this->Contact ? 1.0 : 0.0);
  lamella::setFieldText(image, "breaking", lamella::wordOf(breaking));

  lamella::continueProvenance(image, "fracture",
    { { "model", model }, { "load", this->LoadName() }, { "axis", std::string(1, "xyz"[result.axis]) },
      { "compression", this->Compression }, { "contact", this->Contact }, { "turning_points", this->Internal->Turns },
      { "cycles", this->Cycles }, { "suction", this->Suction }, { "pressure_in", this->PressurePhases() },
      { "straight_sides", this->StraightSides }, { "lateral_ratio", this->LateralRatio },
      { "smooth_platens", this->SmoothPlatens }, { "rigid_platens", this->RigidPlatens },
      { "platen_layers", this->PlatenLayers }, { "method", lamella::wordOf(result.method) },
      { "breaking", lamella::wordOf(breaking) }, { "rivals", this->Rivals }, { "stop_share", this->StopShare },
      { "maximum_strain", this->MaximumStrain }, { "strain_step", this->StrainStep },
      { "sensitivity", this->WantsSensitivity() }, { "window_error", this->EstimateWindowError },
      { "segmentation_error", this->EstimateSegmentationError || this->SurfaceDoubt > 0 },
      { "surface_doubt", this->SurfaceDoubt }, { "maximum_broken", this->MaximumBroken },
      { "tolerance", this->Tolerance }, { "checkpoint_every", this->CheckpointEvery } });
}
