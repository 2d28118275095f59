#include "vtkCollapseMap.h"

#include "Attempt.h"
#include "CollapseInput.h"
#include "Columns.h"
#include "FieldNumbers.h"
#include "PhaseIds.h"
#include "PoreTables.h"
#include "vtkClassMacros.h"
#include "vtkLatticeConversion.h"
#include "vtkPieces.h"
#include "vtkProvenance.h"

#include "compression/CollapseStrain.h"
#include "compression/LumenAreas.h"
#include "core/Error.h"

#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkTable.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace compression = lamella::compression;
using Pipeline = vtkStreamingDemandDrivenPipeline;

namespace
{

constexpr const char* collapseCreator = "vtkCollapseMap";
constexpr double noNumber = std::numeric_limits<double>::quiet_NaN();

/// One row of the table of states.
struct StateRow
{
  double strain;
  std::size_t collapsed;
  double ratio;
};

} // namespace

/// One run of the filter, from the first state to the last.
struct vtkCollapseMap::Work
{
  vtkCollapseMap* Self;
  lamella::Team Alone; ///< every rank does all of it
  lamella::WholeImage Whole;
  std::string Lumens; ///< name of the phase
  std::optional<compression::LumenAreas> Areas;
  std::optional<compression::CollapseStrain> Collapse;
  std::vector<StateRow> States;
  std::string Provenance;

  Work(vtkCollapseMap* self, vtkImageData* image, vtkInformation* request)
    : Self(self)
    , Alone(nullptr, request)
    , Whole(lamella::uprightImage(image, Alone))
    , Provenance(lamella::provenance(image))
  {
    const lamella::PhaseIds phases = lamella::phaseIds(image, self->GetInputArrayInformation(0), this->Alone);
    compression::LumenOptions options;
    options.empty = lamella::findVoid(phases, self->Phase, "lumens");
    options.minimumSize = self->MinimumSize;
    this->Lumens = phases.names[options.empty];
    this->Areas.emplace(this->Whole.lattice, phases.ids, options);
    this->Collapse.emplace(this->Areas->lumens().size(), self->Share);
  }

  void Add(vtkPolyData* points, double time)
  {
    const lamella::CollapseInput input = lamella::collapseInput(points, this->Whole.lattice.dimension, time);
    std::vector<double> ratio(this->Areas->lumens().size());
    this->Areas->areas(input.state(), ratio);
    double now = 0;
    double start = 0;
    for (std::size_t i = 0; i < ratio.size(); ++i)
    {
      const double initial = this->Areas->initial()[i];
      if (!std::isnan(ratio[i]))
      {
        now += ratio[i];
        start += initial;
      }
      ratio[i] /= initial;
    }
    this->Collapse->add(input.strain, ratio);
    this->States.push_back({ input.strain, this->Collapse->collapsed(), start > 0 ? now / start : noNumber });
    if (const std::string record = lamella::provenance(points); !record.empty())
      this->Provenance = record;
  }

  /// A node of a lumen its lumen's number, any other node NaN.
  void AddNumbers(vtkImageData* output, const char* name, const char* text, std::span<const double> byLumen) const
  {
    const auto array = lamella::newArray<vtkFloatArray>(name, 1, this->Areas->labels().size());
    std::ranges::transform(this->Areas->labels(), array->GetPointer(0),
      [&](std::int32_t label)
      {
        return label > 0 ? static_cast<float>(byLumen[static_cast<std::size_t>(label) - 1])
                         : std::numeric_limits<float>::quiet_NaN();
      });
    lamella::describe(array, "1", text, collapseCreator);
    output->GetPointData()->AddArray(array);
  }

  void WriteImage(vtkImageData* output) const
  {
    const auto labels = lamella::newArray<vtkIntArray>("lumen", 1, this->Areas->labels().size());
    std::ranges::copy(this->Areas->labels(), labels->GetPointer(0));
    lamella::describe(labels, "1", "label of the lumen; 0 outside", collapseCreator);
    output->GetPointData()->AddArray(labels);
    this->AddNumbers(output, "lumen_ratio", "area or volume of the lumen in the last state over that at the start",
      this->Collapse->ratio());
    this->AddNumbers(output, "collapse_strain",
      "strain at which the lumen's area or volume fell below the share; NaN: never", this->Collapse->strain());
    output->GetPointData()->SetActiveScalars("collapse_strain");
  }

  void WriteNumbers(vtkDataObject* output) const
  {
    const auto set = [&](const char* name, double value, const char* text)
    { lamella::setFieldNumber(output, name, value, "1", text, collapseCreator); };
    const auto strains = this->Collapse->strain();
    double first = noNumber;
    for (const double strain : strains)
      first = std::isnan(first) || strain < first ? strain : first;
    const std::size_t count = strains.size();
    std::size_t cut = 0;
    for (std::size_t i = 0; i < count; ++i)
      cut += this->Areas->cut(i) ? 1 : 0;
    set("lumen_count", static_cast<double>(count), "lumens");
    set("lumen_cut", static_cast<double>(cut), "lumens that the sample's rim cuts");
    set("lumen_collapsed", static_cast<double>(this->Collapse->collapsed()), "lumens that collapsed");
    set("lumen_ratio", this->States.back().ratio,
      "area or volume of all lumens in the last state over that at the start");
    set("first_collapse_strain", first, "strain at which the first lumen collapsed; NaN: none did");
    set("collapse_share", this->Self->Share, "share of its area at which a lumen has collapsed");
    set("state_count", static_cast<double>(this->States.size()), "states");
    lamella::setFieldText(output, "lumen_phase", this->Lumens);
    lamella::setProvenance(output, this->Provenance);
    lamella::continueProvenance(output, "collapse_map",
      { { "phase", this->Lumens }, { "share", this->Self->Share }, { "minimum_size", this->Self->MinimumSize },
        { "states", this->States.size() } });
  }

  void WriteTables(vtkTable* lumens, vtkTable* states) const
  {
    lamella::fillPores(lumens, this->Areas->lumens(), this->Whole);
    lumens->GetColumn(0)->SetName("lumen");
    const lamella::Columns columns{ lumens->GetRowData(), this->Areas->lumens(), collapseCreator };
    columns.add<vtkUnsignedCharArray>(
      "cut", "1", "1 where the sample's rim cuts it", [&](std::size_t i) { return this->Areas->cut(i); });
    columns.numbers(
      "ratio", "1", "area or volume in the last state over that at the start",
      [&](std::size_t i) { return this->Collapse->ratio()[i]; });
    columns.numbers("collapse_strain", "1", "strain at which it collapsed; NaN: never",
      [&](std::size_t i) { return this->Collapse->strain()[i]; });
    const lamella::Columns rows{ states->GetRowData(), this->States, collapseCreator };
    const auto all = static_cast<double>(this->Areas->lumens().size());
    rows.numbers("strain", "1", "of the state", &StateRow::strain);
    rows.counts("collapsed", "lumens that have collapsed by then", &StateRow::collapsed);
    rows.numbers("collapsed_share", "1", "their share of all lumens",
      [&](const StateRow& s) { return static_cast<double>(s.collapsed) / all; });
    rows.numbers("ratio", "1", "area or volume of all lumens over that at the start", &StateRow::ratio);
  }
};

vtkStandardNewMacro(vtkCollapseMap);
vtkPrintSettingsMacro(vtkCollapseMap);

vtkCollapseMap::vtkCollapseMap()
{
  this->SetNumberOfInputPorts(2);
  this->SetNumberOfOutputPorts(3);
  this->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "phase");
}

vtkCollapseMap::~vtkCollapseMap() = default;

void vtkCollapseMap::SetPointsConnection(vtkAlgorithmOutput* points)
{
  this->SetInputConnection(1, points);
}

void vtkCollapseMap::AddPointsData(vtkPolyData* points)
{
  this->AddInputDataObject(1, points);
}

void vtkCollapseMap::RemoveAllPoints()
{
  this->SetInputConnection(1, nullptr);
}

vtkGetOutputMacro(vtkCollapseMap, LumenTable, vtkTable, 1);
vtkGetOutputMacro(vtkCollapseMap, StateTable, vtkTable, 2);

int vtkCollapseMap::FillInputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), port == 0 ? "vtkImageData" : "vtkPolyData");
  if (port == 1)
    info->Set(vtkAlgorithm::INPUT_IS_REPEATABLE(), 1);
  return 1;
}

vtkOutputTypesMacro(vtkCollapseMap, "vtkImageData", "vtkTable", "vtkTable");

int vtkCollapseMap::RequestInformation(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  this->Times.clear();
  this->Step = 0;
  this->Run.reset();
  vtkInformation* const points = inputVector[1]->GetInformationObject(0);
  if (inputVector[1]->GetNumberOfInformationObjects() == 1 && points->Has(Pipeline::TIME_STEPS()))
  {
    const double* const times = points->Get(Pipeline::TIME_STEPS());
    this->Times.assign(times, times + points->Length(Pipeline::TIME_STEPS()));
  }
  for (int port = 0; port < this->GetNumberOfOutputPorts(); ++port)
  {
    // the map is of all states, whatever time is asked for
    outputVector->GetInformationObject(port)->Remove(Pipeline::TIME_STEPS());
    outputVector->GetInformationObject(port)->Remove(Pipeline::TIME_RANGE());
  }
  outputVector->GetInformationObject(0)->Set(vtkAlgorithm::CAN_PRODUCE_SUB_EXTENT(), 1);
  lamella::allInFirstPiece(outputVector);
  return 1;
}

int vtkCollapseMap::RequestUpdateExtent(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  lamella::requestInput(
    inputVector[0]->GetInformationObject(0), lamella::requestedOutput(request, outputVector), nullptr);
  for (int i = 0; i < inputVector[1]->GetNumberOfInformationObjects(); ++i)
  {
    vtkInformation* const points = inputVector[1]->GetInformationObject(i);
    lamella::requestWhole(points);
    if (this->Step < this->Times.size())
      points->Set(Pipeline::UPDATE_TIME_STEP(), this->Times[this->Step]);
  }
  return 1;
}

int vtkCollapseMap::RequestData(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkImageData* const image = vtkImageData::GetData(inputVector[0]);
  const auto stop = [&]
  {
    request->Remove(Pipeline::CONTINUE_EXECUTING());
    this->Step = 0;
    this->Run.reset();
  };
  bool more = false;
  const lamella::Outcome outcome = lamella::attempt(this,
    [&]
    {
      vtkInformation* const wanted = lamella::requestedOutput(request, outputVector);
      if (this->Run == nullptr)
        this->Run = std::make_unique<Work>(this, image, wanted);
      for (int i = 0; i < inputVector[1]->GetNumberOfInformationObjects(); ++i)
      {
        vtkPolyData* const points = vtkPolyData::GetData(inputVector[1], i);
        vtkInformation* const told = points->GetInformation();
        const double time = this->Step < this->Times.size() ? this->Times[this->Step]
          : told->Has(vtkDataObject::DATA_TIME_STEP())      ? told->Get(vtkDataObject::DATA_TIME_STEP())
                                                            : noNumber;
        this->Run->Add(points, time);
      }
      ++this->Step;
      more = this->Step < this->Times.size();
      this->UpdateProgress(more ? static_cast<double>(this->Step) / static_cast<double>(this->Times.size()) : 1);
      if (this->CheckAbort())
        throw lamella::Cancelled();
      if (more)
      {
        request->Set(Pipeline::CONTINUE_EXECUTING(), 1);
        return;
      }
      vtkNew<vtkImageData> whole;
      whole->ShallowCopy(image);
      this->Run->WriteImage(whole);
      this->Run->WriteNumbers(whole);
      vtkInformation* const first = outputVector->GetInformationObject(0);
      if (first->Get(Pipeline::UPDATE_NUMBER_OF_PIECES()) > 1)
        lamella::deliver(whole, first);
      else
        vtkImageData::GetData(outputVector, 0)->ShallowCopy(whole);
      for (const int port : { 1, 2 })
      {
        vtkTable::GetData(outputVector, port)->Initialize();
        vtkTable::GetData(outputVector, port)->GetFieldData()->ShallowCopy(whole->GetFieldData());
      }
      if (lamella::isFirstPiece(outputVector))
        this->Run->WriteTables(vtkTable::GetData(outputVector, 1), vtkTable::GetData(outputVector, 2));
    });
  if (outcome == lamella::Outcome::Done && more)
    return 1;
  stop();
  return lamella::concluded(this, outcome, outputVector);
}
