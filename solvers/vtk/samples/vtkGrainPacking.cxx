#include "vtkGrainPacking.h"

#include "Attempt.h"
#include "FieldNumbers.h"
#include "LongRun.h"
#include "PackingData.h"
#include "ThreadCount.h"
#include "vtkClassMacros.h"
#include "vtkLatticeConversion.h"
#include "vtkProvenance.h"

#include "core/Error.h"
#include "core/Memory.h"
#include "packing/Packing.h"

#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <fmt/format.h>

#include <array>
#include <string>
#include <vector>

namespace packing = lamella::packing;

struct vtkGrainPacking::Internals
{
  lamella::KeptStates<vtkPolyData> States;
  lamella::KeptStates<vtkPolyData> Contacts; ///< one a state
  lamella::Pace Told;
  std::vector<vtkIdType> Seeds;
};

vtkStandardNewMacro(vtkGrainPacking);
vtkPrintSettingsMacro(vtkGrainPacking);

vtkGrainPacking::vtkGrainPacking()
  : Kept(std::make_unique<Internals>())
{
  this->SetNumberOfInputPorts(0);
  this->SetNumberOfOutputPorts(2);
}

vtkGetOutputMacro(vtkGrainPacking, Contacts, vtkPolyData, 1);

vtkGrainPacking::~vtkGrainPacking() = default;

vtkAddToListMacro(vtkGrainPacking, Seed, Seeds, vtkIdType, Kept->Seeds);
vtkGetStatesMacro(vtkGrainPacking, Grains, vtkPolyData, Kept->States);

vtkPolyData* vtkGrainPacking::GetStateContacts(int state)
{
  return this->Kept->Contacts.at(state);
}

void vtkGrainPacking::SetState(int state)
{
  this->Kept->States.choose(state);
  this->Kept->Contacts.choose(state);
}

vtkShownStateMacro(vtkGrainPacking, Kept->States);
vtkAllInFirstPieceMacro(vtkGrainPacking);

void vtkGrainPacking::Pack()
{
  Internals& kept = *this->Kept;
  for (const vtkIdType seed : kept.Seeds)
    if (seed < 0)
      throw lamella::ParameterError("a seed is " + std::to_string(seed), "give whole numbers that are not negative");
  if (!kept.Seeds.empty() && this->StateEvery > 0)
    throw lamella::ParameterError("states on the way of several packings", "give one seed, or no number of steps");
  packing::PackingOptions options;
  options.dimension = this->Dimension;
  options.count = this->Count;
  options.meanDiameter = this->MeanDiameter;
  options.diameterRatio = this->DiameterRatio;
  options.sizes = static_cast<packing::Sizes>(this->Sizes);
  options.aspect = this->Aspect;
  options.periodic = this->Periodic;
  options.friction = this->Friction;
  options.pressure = this->Pressure;
  options.softness = this->Softness;
  if (this->PackingFraction != 0)
    options.packingFraction = this->PackingFraction;
  options.seed = static_cast<std::uint64_t>(this->Seed);
  options.tolerance = this->Tolerance;
  options.progress = [&](double share, const char* stage)
  {
    if (kept.Told.due())
    {
      this->SetProgressText(stage);
      this->UpdateProgress(share);
    }
  };
  options.interrupted = [this] { return this->CheckAbort(); };

  nlohmann::json parameters{ { "dimension", this->Dimension }, { "count", this->Count },
    { "mean_diameter", this->MeanDiameter }, { "diameter_ratio", this->DiameterRatio },
    { "sizes", std::array{ "volume", "volume-share", "diameter" }.at(static_cast<std::size_t>(this->Sizes)) },
    { "aspect", this->Aspect }, { "periodic", this->Periodic }, { "friction", this->Friction },
    { "pressure", this->Pressure }, { "softness", this->Softness }, { "tolerance", this->Tolerance } };
  if (options.packingFraction)
    parameters["packing_fraction"] = this->PackingFraction;
  double made = 0;
  const auto keep = [&](const packing::Packing& grains, const char* stage, std::uint64_t seed)
  {
    const auto needed = static_cast<double>(lamella::packingBytes(grains));
    if (const auto available = static_cast<double>(lamella::availableMemory()); needed > available)
      throw lamella::MemoryError(fmt::format("state {} of {} grains needs {}, and {} are available", made,
                                   grains.count(), lamella::bytesText(needed), lamella::bytesText(available)),
        "keep fewer states: more steps from one to the next");
    vtkPolyData* const particles = kept.States.add(this->KeepStates);
    vtkPolyData* const contacts = kept.Contacts.add(this->KeepStates);
    lamella::setPacking(
      grains, packing::statistics(grains, options.friction > 0), this->GetClassName(), particles, contacts);
    for (vtkPolyData* const data : { particles, contacts })
    {
      lamella::setFieldNumber(data, "seed", static_cast<double>(seed));
      lamella::setFieldNumber(data, "relaxation_steps", static_cast<double>(grains.steps));
      lamella::setFieldText(data, "stage", stage);
      lamella::setFieldNumber(data, lamella::stateNumber, made);
      lamella::beginProvenance(data, "packing", parameters, seed);
      data->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), static_cast<double>(grains.steps));
    }
    ++made;
    lamella::tellStep(this, particles);
  };
  if (!kept.Seeds.empty())
  {
    const std::vector<std::uint64_t> seeds(kept.Seeds.begin(), kept.Seeds.end());
    const std::vector<packing::Packing> packed = packing::packMany(options, seeds, lamella::threadCount(this->Threads));
    for (std::size_t i = 0; i < seeds.size(); ++i)
    {
      for (const std::string& warning : packed[i].warnings)
        vtkWarningMacro(<< "seed " << seeds[i] << ": " << warning);
      keep(packed[i], "at rest", seeds[i]);
    }
    return;
  }
  options.every = this->StateEvery;
  options.state = [&](const packing::PackingState& state) { keep(state.packing, state.stage, options.seed); };
  const packing::Packing end = packing::pack(options);
  for (const std::string& warning : end.warnings)
    vtkWarningMacro(<< warning);
  keep(end, "at rest", options.seed);
}

int vtkGrainPacking::RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  vtkPolyData* const particles = vtkPolyData::GetData(outputVector, 0);
  vtkPolyData* const contacts = vtkPolyData::GetData(outputVector, 1);
  particles->Initialize();
  contacts->Initialize();
  vtkInformation* const request = outputVector->GetInformationObject(0);
  if (request->Get(vtkStreamingDemandDrivenPipeline::UPDATE_PIECE_NUMBER()) > 0)
    return 1;
  Internals& kept = *this->Kept;
  lamella::Failure failure = lamella::Failure::None;
  const lamella::Outcome outcome = lamella::attempt(
    this,
    [&]
    {
      kept.States.renew(
        nullptr, this->Superclass::GetMTime(), lamella::Team(nullptr, request), [&] { this->Pack(); },
        [&]
        {
          kept.Contacts.clear();
          this->StateRange[1] = 0;
        });
      this->StateRange[1] = kept.States.count() - 1;
      kept.States.show(particles);
      kept.Contacts.show(contacts);
    },
    &failure);
  this->Failure = static_cast<int>(failure);
  return lamella::concluded(this, outcome, outputVector);
}
