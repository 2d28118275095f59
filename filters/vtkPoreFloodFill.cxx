#include "vtkPoreFloodFill.h"

#include "Attempt.h"
#include "BoxExchange.h"
#include "PhaseIds.h"
#include "PoreTables.h"
#include "WindowFields.h"
#include "vtkClassMacros.h"
#include "vtkLatticeConversion.h"
#include "vtkPieces.h"
#include "vtkProvenance.h"

#include "core/Error.h"
#include "pores/PoreLabelling.h"
#include "pores/PoreWindows.h"

#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkSMPTools.h"
#include "vtkTable.h"

#include <algorithm>
#include <string>
#include <vector>

namespace pores = lamella::pores;

/// One run of the filter.
struct vtkPoreFloodFill::Work
{
  vtkPoreFloodFill* Self;
  vtkImageData* Output;
  vtkTable* Pores;
  vtkTable* Distribution;
  const lamella::Team& Team;
  lamella::WholeImage Whole;
  lamella::Block Block; ///< of this rank: every node is in one block

  Work(vtkPoreFloodFill* self, vtkImageData* input, vtkImageData* output, vtkTable* table, vtkTable* distribution,
    const lamella::Team& team)
    : Self(self)
    , Output(output)
    , Pores(table)
    , Distribution(distribution)
    , Team(team)
    , Whole(lamella::wholeImage(input, team))
    , Block{ { 0, 0, 0 }, Whole.lattice.size }
  {
    if (team.size() > 1)
      team.agree([&] { this->Block = lamella::decompose(this->Whole.lattice, team.comm()); });
  }

  [[nodiscard]] lamella::BoxExchange Exchange(const lamella::Block& from, const lamella::Block& to) const
  {
    return { this->Whole.lattice, from, to, { false, false, false }, this->Team.comm(), this->Team.size() };
  }

  [[nodiscard]] pores::LabelOptions Options() const
  {
    const lamella::Lattice& lattice = this->Whole.lattice;
    pores::LabelOptions options;
    options.connectivity = this->Self->Connectivity != 0 ? this->Self->Connectivity : lattice.dimension == 3 ? 6 : 4;
    for (std::size_t axis = 0; axis < 3; ++axis)
      options.periodic[axis] = this->Self->Periodic[axis] != 0;
    if (options.periodic[2] && lattice.dimension == 2)
    {
      throw lamella::ParameterError(
        "a picture is to be periodic along z; it has x and y only", "leave z out, or give a volume");
    }
    options.minimumSize = this->Self->MinimumSize;
    options.sortBySize = this->Self->SortBySize;
    options.mostLabels = this->Self->MaximumNumberOfLabels;
    options.slabs = std::max(1, vtkSMPTools::GetEstimatedNumberOfThreads());
    options.forEach = [](int count, const std::function<void(int)>& body)
    {
      vtkSMPTools::For(0, count, 1,
        [&](vtkIdType begin, vtkIdType end)
        {
          for (vtkIdType i = begin; i < end; ++i)
            body(static_cast<int>(i));
        });
    };
    options.progress = [this](double share)
    {
      this->Self->UpdateProgress(0.1 + 0.8 * share);
      return !this->Self->CheckAbort();
    };
    return options;
  }

  void Run(vtkImageData* input)
  {
    const lamella::PhaseIds phases = lamella::phaseIds(input, this->Self->GetInputArrayInformation(0), this->Team);
    const std::uint8_t wanted = lamella::findVoid(phases, this->Self->Phase, "pores");
    const pores::LabelOptions options = this->Options();
    this->Output->ShallowCopy(input);

    const lamella::BoxExchange inward = this->Exchange(this->Whole.held, this->Block);
    std::vector<std::uint8_t> own;
    std::span<const std::uint8_t> ids = phases.ids;
    if (!inward.identity())
    {
      own.resize(static_cast<std::size_t>(this->Block.count()));
      inward.run<std::uint8_t>(phases.ids, own);
      ids = own;
    }
    const pores::PoreLabelling labelling(
      this->Whole.lattice, lamella::Communicator(this->Team.comm()), ids, wanted, options);
    const pores::PoreSummary& sum = labelling.summary();
    const std::string& name = phases.names[wanted];
    if (sum.phaseNodes == 0)
    {
      throw lamella::InputError("no node of the image is '" + name + "': it has no pores",
        "choose another phase, or check which grey values '" + name + "' is");
    }
    if (sum.count == 0 && this->Team.rank() == 0)
    {
      vtkWarningWithObjectMacro(this->Self, << "all " << sum.dropped << " pores are smaller than "
                                            << this->Self->MinimumSize << " nodes; the largest has "
                                            << sum.largestDropped);
    }

    const bool same = inward.identity();
    if (this->Self->ComputeLabels)
    {
      vtkNew<vtkIntArray> labels;
      this->Add(labels.Get(), "pore", "1", "label of the pore; 0 outside", same,
        [&](std::span<int> out) { labelling.labels(out); });
      this->Output->GetPointData()->SetActiveScalars("pore");
    }
    if (this->Self->ComputeLabels && this->Self->ComputePoreSize)
    {
      vtkNew<vtkFloatArray> sizes;
      this->Add(sizes.Get(), "pore_size", lamella::nodesOf(this->Whole.lattice), "size of the node's pore; NaN outside",
        same, [&](std::span<float> out) { labelling.sizes(out); });
    }
    lamella::fillPores(this->Pores, labelling.pores(), this->Whole);
    lamella::fillSizeDistribution(this->Distribution, labelling.pores(), this->Whole.lattice);
    std::vector<lamella::statistics::WindowError> windows;
    if (this->Self->EstimateWindowError)
    {
      std::vector<std::uint8_t> whole(static_cast<std::size_t>(this->Whole.lattice.count())); // on every rank
      this->Exchange(this->Block, lamella::Block{ { 0, 0, 0 }, this->Whole.lattice.size })
        .run<std::uint8_t>(ids, whole);
      this->Team.agree([&] { windows = pores::poreWindows(this->Whole.lattice, whole, wanted, options); });
    }
    lamella::setWindowFields(this->Output, windows);
    this->WriteNumbers(sum, options, name);
  }

  template <typename Array, typename Write>
  void Add(Array* array, const char* name, const char* unit, const char* description, bool same, const Write& write)
  {
    using Value = std::remove_pointer_t<decltype(array->GetPointer(0))>;
    array->SetName(name);
    array->SetNumberOfTuples(this->Output->GetNumberOfPoints());
    const std::span<Value> piece(array->GetPointer(0), static_cast<std::size_t>(array->GetNumberOfValues()));
    if (same)
    {
      write(piece);
    }
    else
    {
      std::vector<Value> block(static_cast<std::size_t>(this->Block.count()));
      write(std::span<Value>(block));
      this->Exchange(this->Block, this->Whole.held).template run<Value>(block, piece);
    }
    lamella::describe(array, unit, description, "vtkPoreFloodFill");
    this->Output->GetPointData()->AddArray(array);
  }

  void WriteNumbers(const pores::PoreSummary& sum, const pores::LabelOptions& options, const std::string& phase) const
  {
    const auto set = [this](const char* name, std::initializer_list<double> values)
    { lamella::setFieldNumbers(this->Output, name, std::span(values.begin(), values.size())); };
    const auto number = [](auto value) { return static_cast<double>(value); };
    const double open = sum.total > 0 ? number(sum.openNodes) / number(sum.total) : 0;
    const auto bit = [&](std::uint8_t axis) { return number(sum.percolates >> axis & 1); };
    set("pore_count", { number(sum.count) });
    set("pore_total", { number(sum.total) });
    set("pore_mean", { sum.mean() });
    set("pore_largest", { number(sum.largest) });
    set("porosity", { number(sum.phaseNodes) / number(this->Whole.lattice.count()) });
    set("pore_dropped", { number(sum.dropped), number(sum.droppedNodes) });
    set("pore_open", { open });
    set("pore_closed", { sum.total > 0 ? 1 - open : 0 });
    set("pore_open_count", { number(sum.touching) });
    set("pore_percolates", { bit(0), bit(1), bit(2) });
    set("pore_connectivity", { number(options.connectivity) });
    set("pore_periodic", { number(options.periodic[0]), number(options.periodic[1]), number(options.periodic[2]) });
    lamella::setFieldText(this->Output, "pore_phase", phase);
    lamella::continueProvenance(this->Output, "pore_flood_fill",
      { { "phase", phase }, { "connectivity", options.connectivity }, { "periodic", options.periodic },
        { "minimum_size", options.minimumSize }, { "sort_by_size", options.sortBySize } });
    this->Pores->GetFieldData()->ShallowCopy(this->Output->GetFieldData());
    this->Distribution->GetFieldData()->ShallowCopy(this->Output->GetFieldData());
  }
};

vtkStandardNewMacro(vtkPoreFloodFill);
vtkPrintSettingsMacro(vtkPoreFloodFill);

vtkPoreFloodFill::vtkPoreFloodFill()
{
  this->SetNumberOfOutputPorts(3);
  this->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "phase");
}

vtkGetOutputMacro(vtkPoreFloodFill, Pores, vtkTable, 1);
vtkGetOutputMacro(vtkPoreFloodFill, SizeDistribution, vtkTable, 2);
vtkOutputTypesMacro(vtkPoreFloodFill, "vtkImageData", "vtkTable", "vtkTable");
vtkRequestPiecesMacro(vtkPoreFloodFill);

int vtkPoreFloodFill::RequestData(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkImageData* const input = vtkImageData::GetData(inputVector[0]);
  vtkImageData* const output = vtkImageData::GetData(outputVector, 0);
  vtkTable* const table = vtkTable::GetData(outputVector, 1);
  vtkTable* const distribution = vtkTable::GetData(outputVector, 2);
  const lamella::Outcome outcome = lamella::attempt(this,
    [&]
    {
      table->Initialize();
      distribution->Initialize();
      const lamella::Team team(this->Controller, lamella::requestedOutput(request, outputVector));
      Work(this, input, output, table, distribution, team).Run(input);
    });
  return lamella::concluded(this, outcome, outputVector);
}
