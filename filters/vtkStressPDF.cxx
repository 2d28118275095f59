#include "vtkStressPDF.h"

#include "Attempt.h"
#include "FieldNumbers.h"
#include "Listed.h"
#include "StressInput.h"
#include "StressTables.h"
#include "vtkClassMacros.h"
#include "vtkPieces.h"
#include "vtkProvenance.h"

#include "core/Error.h"
#include "statistics/StressDistribution.h"

#include "vtkDataSet.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkSMPTools.h"
#include "vtkTable.h"

#include <algorithm>

namespace statistics = lamella::statistics;

/// One run of the filter.
struct vtkStressPDF::Work
{
  vtkStressPDF* Self;
  const lamella::Team& Team;
  int Passes = 0;

  [[nodiscard]] statistics::DistributionOptions Options()
  {
    statistics::DistributionOptions options;
    options.binWidth = this->Self->BinWidth;
    options.low = this->Self->Range[0];
    options.high = this->Self->Range[1];
    if ((options.low != 0 || options.high != 0) && !(options.low < options.high))
    {
      throw lamella::ParameterError(
        "the range " + std::to_string(options.low) + " to " + std::to_string(options.high) + " is empty",
        "give its lower end first, or 0 and 0 for all stresses");
    }
    options.threshold = this->Self->Threshold;
    options.tailShare = this->Self->TailShare;
    options.reference = this->Self->ReferenceStress;
    options.slabs = std::max(1, vtkSMPTools::GetEstimatedNumberOfThreads());
    options.forEach = [this](int count, const std::function<void(int)>& body)
    {
      this->Report(0.2 + 0.25 * this->Passes++); // once a pass on every rank, so it may be collective
      vtkSMPTools::For(0, count, 1,
        [&](vtkIdType begin, vtkIdType end)
        {
          for (vtkIdType i = begin; i < end; ++i)
            body(static_cast<int>(i));
        });
    };
    return options;
  }

  /// @throws Cancelled on every rank
  void Report(double share) const
  {
    this->Self->UpdateProgress(share);
    if (this->Team.any(this->Self->CheckAbort()))
      throw lamella::Cancelled();
  }

  void Run(vtkDataSet* input, vtkTable* density, vtkTable* phases, vtkTable* thresholds)
  {
    const statistics::DistributionOptions options = this->Options();
    const auto measure = static_cast<statistics::StressMeasure>(this->Self->Component);
    this->Report(0.01);
    const lamella::StressInput stresses = lamella::stressInput(input, this->Self->GetInputArrayInformation(0),
      this->Self->GetInputArrayInformation(1), this->Self->Phases, this->Self->LeaveOutPlatens, measure, this->Team);
    const auto d = statistics::stressDistribution(stresses.values, stresses.group,
      static_cast<int>(stresses.phases.size()), options, lamella::Communicator(this->Team.comm()));
    if (this->Team.rank() == 0)
    {
      const std::span<const std::string> names =
        stresses.hasPhases ? std::span<const std::string>(stresses.phases) : std::span<const std::string>();
      lamella::fillDensity(density, d, names);
      lamella::fillPhases(phases, d, names);
      lamella::fillThresholds(thresholds, d);
    }
    const auto set = [&](const char* name, double value) { lamella::setFieldNumber(density, name, value); };
    const auto share = [&](std::int64_t part) { return static_cast<double>(part) / static_cast<double>(d.all.count); };
    set("stress_count", static_cast<double>(d.all.count));
    set("stress_mean", d.all.mean);
    set("stress_deviation", d.all.deviation);
    set("stress_mean_tensile", d.all.meanTensile);
    set("stress_mean_compressive", d.all.meanCompressive);
    set("stress_tensile_share", share(d.all.tensile));
    set("stress_compressive_share", share(d.all.compressive));
    set("stress_largest", d.all.largest);
    set("stress_smallest", d.all.smallest);
    set("stress_theta", d.all.tail.theta);
    set("stress_theta_error", d.all.tail.standardError);
    set("stress_tail_threshold", d.all.tail.threshold);
    set("stress_tail_count", static_cast<double>(d.all.tail.count));
    set("stress_tail_share", d.all.tail.share);
    set("stress_tail_distance", d.all.tail.distance);
    set("stress_reference", d.reference);
    lamella::setFieldText(density, "stress_array", stresses.array);
    const std::string component =
      stresses.components == 1 ? "as it is" : statistics::stressMeasureNames()[static_cast<std::size_t>(measure)];
    lamella::setFieldText(density, "stress_component", component);
    lamella::setProvenance(density, lamella::provenance(input));
    lamella::continueProvenance(density, "stress_pdf",
      { { "array", stresses.array }, { "component", component }, { "phases", stresses.phases },
        { "bin_width", options.binWidth }, { "threshold", options.threshold }, { "tail_share", options.tailShare },
        { "reference", options.reference } });
    phases->GetFieldData()->ShallowCopy(density->GetFieldData());
    thresholds->GetFieldData()->ShallowCopy(density->GetFieldData());
  }
};

vtkStandardNewMacro(vtkStressPDF);
vtkPrintSettingsMacro(vtkStressPDF);

vtkStressPDF::vtkStressPDF()
{
  this->SetNumberOfOutputPorts(3);
  this->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "stress");
  this->SetInputArrayToProcess(1, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "phase");
}

void vtkStressPDF::AddPhase(const char* phase)
{
  if (phase != nullptr && *phase != '\0')
  {
    this->Phases.emplace_back(phase);
    this->Modified();
  }
}

void vtkStressPDF::ClearPhases()
{
  lamella::removeAll(this, this->Phases);
}

int vtkStressPDF::GetNumberOfPhases()
{
  return static_cast<int>(this->Phases.size());
}

const char* vtkStressPDF::GetPhase(int i)
{
  return i >= 0 && i < this->GetNumberOfPhases() ? this->Phases[static_cast<std::size_t>(i)].c_str() : nullptr;
}

vtkGetOutputMacro(vtkStressPDF, PhaseTable, vtkTable, 1);
vtkGetOutputMacro(vtkStressPDF, ThresholdTable, vtkTable, 2);
vtkInputTypeMacro(vtkStressPDF, "vtkDataSet");
vtkRequestPiecesMacro(vtkStressPDF);

int vtkStressPDF::RequestData(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkDataSet* const input = vtkDataSet::GetData(inputVector[0]);
  vtkTable* const density = vtkTable::GetData(outputVector, 0);
  vtkTable* const phases = vtkTable::GetData(outputVector, 1);
  vtkTable* const thresholds = vtkTable::GetData(outputVector, 2);
  const lamella::Outcome outcome = lamella::attempt(this,
    [&]
    {
      lamella::emptyAll(outputVector);
      const lamella::Team team(this->Controller, lamella::requestedOutput(request, outputVector));
      Work{ this, team }.Run(input, density, phases, thresholds);
    });
  return lamella::concluded(this, outcome, outputVector);
}
