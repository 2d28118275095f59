#include "vtkFluxMap.h"

#include "Attempt.h"
#include "BoxExchange.h"
#include "Columns.h"
#include "FluxInput.h"
#include "flux/FluxField.h"
#include "flux/FluxLines.h"
#include "vtkClassMacros.h"
#include "vtkLatticeConversion.h"
#include "vtkPieces.h"
#include "vtkProvenance.h"

#include "core/Error.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkSMPTools.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace lbm = lamella::lbm;

namespace
{

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
using ByDirection = std::array<double, 3>;
using Tensor = std::array<double, 9>;

/// An array of the piece as doubles: in place, or converted into `own`.
std::span<const double> doubles(vtkImageData* piece, const std::string& name, std::vector<double>& own)
{
  vtkDataArray* const array = piece->GetPointData()->GetArray(name.c_str());
  if (array == nullptr)
    return {}; // an empty piece
  if (auto* const ready = vtkDoubleArray::SafeDownCast(array))
    return { ready->GetPointer(0), static_cast<std::size_t>(ready->GetNumberOfValues()) };
  own.resize(static_cast<std::size_t>(array->GetNumberOfValues()));
  const int components = array->GetNumberOfComponents();
  for (vtkIdType i = 0; i < static_cast<vtkIdType>(own.size()); ++i)
    own[static_cast<std::size_t>(i)] = array->GetComponent(i / components, static_cast<int>(i % components));
  return own;
}

lbm::Block grown(const lbm::Block& block, const lamella::Lattice& lattice, bool periodic)
{
  lbm::Block box = block;
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(lattice.dimension); ++axis)
  {
    if (periodic || block.start[axis] > 0)
    {
      --box.start[axis];
      ++box.size[axis];
    }
    if (periodic || block.start[axis] + block.size[axis] < lattice.size[axis])
      ++box.size[axis];
  }
  return box;
}

} // namespace

/// One run of the filter.
struct vtkFluxMap::Work
{
  vtkFluxMap* Self;
  vtkImageData* Input;
  vtkImageData* Output;
  vtkPolyData* Lines;
  const lamella::Team& Team;
  lamella::WholeImage Whole;
  lamella::FluxInput Found;
  lbm::Block Block; ///< of this rank: every node is in one block
  lbm::Block Box;   ///< the block and a layer around it
  std::vector<std::uint8_t> PhaseBox;

  Tensor MeanFlux;
  Tensor Effective;
  ByDirection Tortuosity{ unknown, unknown, unknown };
  ByDirection TortuosityFactor{ unknown, unknown, unknown };
  ByDirection LineTortuosity{ unknown, unknown, unknown };
  double LineFlux = unknown;
  double MeanConductivity = unknown;

  Work(vtkFluxMap* self, vtkImageData* input, vtkImageData* output, vtkPolyData* lines, const lamella::Team& team)
    : Self(self)
    , Input(input)
    , Output(output)
    , Lines(lines)
    , Team(team)
    , Whole(lamella::wholeImage(input, team))
    , Found(lamella::fluxInput(input, self->GetInputArrayInformation(0), self->GetInputArrayInformation(1), team))
    , Block{ { 0, 0, 0 }, Whole.lattice.size }
  {
    if (team.size() > 1)
      team.agree([&] { this->Block = lbm::decompose(this->Whole.lattice, team.comm()); });
    this->Box = grown(this->Block, this->Whole.lattice, this->Found.periodic);
    this->MeanFlux.fill(unknown);
    this->Effective.fill(unknown);
  }

  /// Throws Cancelled on every rank once one of them is told to stop.
  void Proceed(double share) const
  {
    this->Self->UpdateProgress(share);
    if (this->Team.any(this->Self->CheckAbort()))
      throw lamella::Cancelled();
  }

  [[nodiscard]] lamella::BoxExchange Exchange(const lbm::Block& from, const lbm::Block& to, bool wrap) const
  {
    const bool periodic = wrap && this->Found.periodic;
    const bool third = periodic && this->Whole.lattice.dimension == 3;
    return { this->Whole.lattice, from, to, { periodic, periodic, third }, this->Team.comm(), this->Team.size() };
  }

  template <typename Value>
  [[nodiscard]] std::vector<Value> Fetch(std::span<const Value> piece, const lbm::Block& box, int components = 1) const
  {
    std::vector<Value> values(static_cast<std::size_t>(box.count() * components));
    this->Exchange(this->Whole.held, box, true).template run<Value>(piece, values, components);
    return values;
  }

  void Run()
  {
    this->Output->ShallowCopy(this->Input);
    this->LoadPhases();
    this->Proceed(0.05);
    const std::size_t shown = this->Shown();
    for (std::size_t i = 0; i < this->Found.directions.size(); ++i)
      this->Solve(this->Found.directions[i], i == shown);
    this->WriteNumbers();
  }

  void LoadPhases()
  {
    if (this->Found.phaseArray.empty())
      return;
    auto* const array =
      vtkUnsignedCharArray::SafeDownCast(this->Input->GetPointData()->GetArray(this->Found.phaseArray.c_str()));
    std::span<const std::uint8_t> piece;
    if (array != nullptr)
      piece = { array->GetPointer(0), static_cast<std::size_t>(array->GetNumberOfValues()) };
    this->PhaseBox = this->Fetch<std::uint8_t>(piece, this->Box);
    std::vector<std::int64_t> nodes(this->Found.conductivity.size(), 0);
    const lamella::flux::FluxSetting setting{ this->Whole.lattice, this->Box };
    this->ForNodes([&](const lamella::flux::Node& node) { ++nodes[this->PhaseBox[setting.index(node)]]; });
    this->Team.sum(nodes);
    this->MeanConductivity = 0;
    for (std::size_t id = 0; id < nodes.size(); ++id)
    {
      this->MeanConductivity += this->Found.conductivity[id] * static_cast<double>(nodes[id]) /
        static_cast<double>(this->Whole.lattice.count());
    }
  }

  [[nodiscard]] std::size_t Shown()
  {
    const auto& directions = this->Found.directions;
    for (std::size_t i = 0; i < directions.size(); ++i)
      if (this->Self->Direction == AUTO || directions[i].axis == this->Self->Direction || directions[i].axis < 0)
        return i;
    throw lamella::ParameterError(
      std::string("direction ") + "xyz"[this->Self->Direction] + " was not solved", "solve it, or choose another");
  }

  template <typename Action>
  void ForNodes(const Action& action) const
  {
    lamella::flux::Node node;
    const lbm::Block& block = this->Block;
    for (node[2] = block.start[2]; node[2] < block.start[2] + block.size[2]; ++node[2])
    {
      for (node[1] = block.start[1]; node[1] < block.start[1] + block.size[1]; ++node[1])
        for (node[0] = block.start[0]; node[0] < block.start[0] + block.size[0]; ++node[0])
          action(node);
    }
  }

  /// Sums over this rank's rows along x, added up in the same order whatever the threads did.
  /// @param rowSum (row, first node of the row, sums) fills four numbers
  template <typename RowSum>
  [[nodiscard]] std::array<double, 4> SumRows(const RowSum& rowSum) const
  {
    const std::int64_t rows = this->Block.size[1] * this->Block.size[2];
    std::vector<std::array<double, 4>> sums(static_cast<std::size_t>(rows));
    vtkSMPTools::For(0, rows,
      [&](vtkIdType begin, vtkIdType end)
      {
        for (vtkIdType row = begin; row < end; ++row)
        {
          auto& sum = sums[static_cast<std::size_t>(row)];
          sum.fill(0);
          rowSum(row,
            lamella::flux::Node{ this->Block.start[0], this->Block.start[1] + row % this->Block.size[1],
              this->Block.start[2] + row / this->Block.size[1] },
            sum);
        }
      });
    std::array<double, 4> total{ 0, 0, 0, 0 };
    for (const auto& sum : sums)
      for (std::size_t i = 0; i < 4; ++i)
        total[i] += sum[i];
    this->Team.sum(total);
    return total;
  }

  /// The axis, where names do not tell it, and which way the value rises along it.
  void Orient(const lamella::SolvedDirection& direction, const std::vector<double>& valueBox,
    const std::array<double, 4>& fluxSum, lamella::flux::FluxSetting& setting) const
  {
    if (direction.value.empty())
    {
      if (setting.axis < 0)
      {
        setting.axis = static_cast<int>(
          std::max_element(
            fluxSum.begin(), fluxSum.begin() + 3, [](double a, double b) { return std::abs(a) < std::abs(b); }) -
          fluxSum.begin());
      }
      setting.rising = fluxSum[static_cast<std::size_t>(setting.axis)] < 0;
      return;
    }
    std::array<double, 12> layers{}; // sum and number of the first and of the last layer along each axis
    this->ForNodes(
      [&](const lamella::flux::Node& node)
      {
        const double value = valueBox[setting.index(node)];
        for (std::size_t axis = 0; axis < 3; ++axis)
        {
          for (std::size_t end = 0; end < 2; ++end)
          {
            const std::int64_t layer = end == 0 ? 0 : setting.lattice.size[axis] - 1;
            if (node[axis] == layer && std::isfinite(value))
            {
              layers[4 * axis + 2 * end] += value;
              layers[4 * axis + 2 * end + 1] += 1;
            }
          }
        }
      });
    this->Team.sum(layers);
    ByDirection rise{ 0, 0, 0 };
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      const double* const layer = &layers[4 * axis];
      if (layer[1] > 0 && layer[3] > 0)
        rise[axis] = layer[2] / layer[3] - layer[0] / layer[1];
    }
    if (setting.axis < 0)
    {
      setting.axis =
        static_cast<int>(std::max_element(
                           rise.begin(), rise.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }) -
          rise.begin());
    }
    setting.rising = rise[static_cast<std::size_t>(setting.axis)] > 0;
  }

  void Solve(const lamella::SolvedDirection& direction, bool shown)
  {
    lamella::flux::FluxSetting setting{ this->Whole.lattice, this->Box, direction.axis, this->Found.periodic,
      this->Found.transient };
    const bool links = !direction.value.empty() && !this->Found.phaseArray.empty();
    std::vector<double> own;
    std::vector<double> valueBox;
    if (!direction.value.empty() && (shown || direction.flux.empty()))
      valueBox = this->Fetch<double>(doubles(this->Input, direction.value, own), this->Box);
    std::vector<double> fluxBox;
    std::array<double, 4> sums{};
    const auto addFlux = [](std::array<double, 4>& sum, const double* flux)
    {
      sum[0] += flux[0];
      sum[1] += flux[1];
      sum[2] += flux[2];
      sum[3] += std::sqrt(flux[0] * flux[0] + flux[1] * flux[1] + flux[2] * flux[2]);
    };
    if (!direction.flux.empty())
    {
      fluxBox = this->Fetch<double>(doubles(this->Input, direction.flux, own), this->Box, 3);
      sums = this->SumRows(
        [&](std::int64_t, lamella::flux::Node node, std::array<double, 4>& sum)
        {
          const double* const row = &fluxBox[3 * setting.index(node)];
          for (std::int64_t x = 0; x < this->Block.size[0]; ++x)
            addFlux(sum, row + 3 * x);
        });
    }
    this->Proceed(0.3);
    const lamella::SolvedDirection named{ direction.axis, valueBox.empty() ? "" : direction.value, direction.flux,
      direction.suffix };
    this->Orient(named, valueBox, sums, setting);
    if (setting.wraps(static_cast<std::size_t>(setting.axis)) && !valueBox.empty())
      lamella::flux::continueValues(setting, valueBox);
    const lbm::Stencil stencil =
      this->Found.stencil.value_or(setting.lattice.dimension == 3 ? lbm::Stencil::D3Q7 : lbm::Stencil::D2Q5);
    std::unique_ptr<lamella::flux::LinkFlux> link;
    if (links && !valueBox.empty())
    {
      link =
        std::make_unique<lamella::flux::LinkFlux>(setting, stencil, valueBox, this->PhaseBox, this->Found.conductivity);
    }

    std::vector<double> blockFlux;
    if (direction.flux.empty())
    {
      blockFlux.resize(3 * static_cast<std::size_t>(this->Block.count()));
      sums = this->SumRows(
        [&](std::int64_t row, lamella::flux::Node node, std::array<double, 4>& sum)
        {
          double* flux = &blockFlux[static_cast<std::size_t>(3 * row * this->Block.size[0])];
          for (std::int64_t x = 0; x < this->Block.size[0]; ++x, ++node[0], flux += 3)
          {
            const auto vector = link->atNode(node);
            std::copy(vector.begin(), vector.end(), flux);
            addFlux(sum, flux);
          }
        });
    }
    this->Proceed(0.5);
    this->KeepNumbers(setting, sums);
    if (!shown)
      return;
    this->WriteMagnitude(direction, blockFlux);
    if (this->Self->NumberOfStreamlines > 0)
    {
      if (link != nullptr)
        this->Trace(*link, setting);
      else
        this->Trace(lamella::flux::NodeFlux(setting, fluxBox, valueBox), setting);
    }
  }

  void KeepNumbers(const lamella::flux::FluxSetting& setting, const std::array<double, 4>& sums)
  {
    const auto axis = static_cast<std::size_t>(setting.axis);
    const auto nodes = static_cast<double>(setting.lattice.count());
    const double sign = setting.rising ? -1.0 : 1.0;
    for (std::size_t row = 0; row < static_cast<std::size_t>(setting.lattice.dimension); ++row)
    {
      this->MeanFlux[3 * row + axis] = sums[row] / nodes;
      if (!setting.transient) // it flows between values that are not 1 and 0, and not evenly
        this->Effective[3 * row + axis] = sign * sums[row] / nodes * setting.lattice.length(setting.axis);
    }
    this->Tortuosity[axis] = sums[3] / (sign * sums[axis]);
    this->TortuosityFactor[axis] = this->MeanConductivity / this->Effective[4 * axis];
  }

  void WriteMagnitude(const lamella::SolvedDirection& direction, const std::vector<double>& blockFlux) const
  {
    const vtkIdType points = this->Output->GetNumberOfPoints();
    const auto count = static_cast<std::size_t>(points);
    std::vector<double> own;
    std::span<const double> flux;
    if (direction.flux.empty())
    {
      const auto array = lamella::newArray<vtkDoubleArray>(("flux" + direction.suffix).c_str(), 3, count);
      const std::span<double> piece(array->GetPointer(0), 3 * count);
      this->Exchange(this->Block, this->Whole.held, false).run<double>(blockFlux, piece, 3);
      lamella::describe(array, "conductivity/m", "flux of " + this->Found.quantity + ", -D grad u", "vtkFluxMap");
      this->Output->GetPointData()->AddArray(array);
      flux = piece;
    }
    else
    {
      flux = doubles(this->Input, direction.flux, own);
    }
    const auto magnitude = lamella::newArray<vtkDoubleArray>("flux_magnitude", 1, count);
    double* const out = magnitude->GetPointer(0);
    vtkSMPTools::For(0, points,
      [&](vtkIdType begin, vtkIdType end)
      {
        for (vtkIdType i = begin; i < end; ++i)
        {
          const double* const q = &flux[3 * static_cast<std::size_t>(i)];
          out[i] = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
        }
      });
    lamella::describe(magnitude, "conductivity/m", "magnitude of the flux of " + this->Found.quantity, "vtkFluxMap");
    this->Output->GetPointData()->AddArray(magnitude); // SetScalars() would throw the field out
    this->Output->GetPointData()->SetActiveScalars(magnitude->GetName());
  }

  void Trace(const lamella::flux::FluxField& field, const lamella::flux::FluxSetting& setting)
  {
    const lamella::flux::FluxLines lines = lamella::flux::traceLines(field, setting, this->Block,
      this->Self->NumberOfStreamlines, lamella::Communicator(this->Team.comm()),
      [this](double share)
      {
        this->Self->UpdateProgress(0.55 + 0.4 * share);
        return !this->Self->CheckAbort();
      });
    if (this->Team.any(this->Self->CheckAbort()))
      throw lamella::Cancelled();
    const double spacing = setting.lattice.spacing;
    const double box = setting.lattice.length(setting.axis);
    double sum = 0;
    std::int64_t arrived = 0;
    for (std::size_t line = 0; line < lines.length.size(); ++line)
    {
      sum += lines.arrived[line] != 0 ? lines.length[line] * spacing / box : 0.0;
      arrived += lines.arrived[line];
    }
    this->LineTortuosity[static_cast<std::size_t>(setting.axis)] =
      arrived > 0 ? sum / static_cast<double>(arrived) : unknown;
    const double area = setting.lattice.dimension == 3 ? spacing * spacing : spacing;
    this->LineFlux = lines.inflow * area / static_cast<double>(std::max<std::size_t>(lines.length.size(), 1));
    this->WriteLines(lines, setting);
  }

  void WriteLines(const lamella::flux::FluxLines& lines, const lamella::flux::FluxSetting& setting) const
  {
    using lamella::flux::LinePiece;
    std::size_t total = 0;
    for (const LinePiece& piece : lines.pieces)
      total += piece.points.size();
    const auto points = lamella::newPoints(total);
    vtkNew<vtkCellArray> cells;
    const auto magnitude = lamella::newArray<vtkDoubleArray>("flux_magnitude", 1, total);
    const auto value = lamella::newArray<vtkDoubleArray>(this->Found.quantity.c_str(), 1, total);
    const auto arc = lamella::newArray<vtkDoubleArray>("arc_length", 1, total);
    const double spacing = setting.lattice.spacing;
    vtkIdType at = 0;
    for (const LinePiece& piece : lines.pieces)
    {
      cells->InsertNextCell(static_cast<int>(piece.points.size()));
      for (std::size_t i = 0; i < piece.points.size(); ++i, ++at)
      {
        cells->InsertCellPoint(at);
        points->SetPoint(at, this->Whole.physical(piece.points[i]).data());
        magnitude->SetValue(at, piece.flux[i]);
        value->SetValue(at, piece.value[i]);
        arc->SetValue(at, piece.length[i] * spacing);
      }
    }
    const char* const creator = "vtkFluxMap";
    lamella::describe(magnitude, "conductivity/m", "magnitude of the flux", creator);
    lamella::describe(value, "1", this->Found.quantity, creator);
    lamella::describe(arc, "m", "way from the inlet along the line", creator);
    this->Lines->SetPoints(points);
    this->Lines->SetLines(cells);
    this->Lines->GetPointData()->SetScalars(magnitude);
    lamella::addArrays(this->Lines->GetPointData(), { value, arc });
    const lamella::Columns columns{ this->Lines->GetCellData(), lines.pieces, creator };
    const auto length = [&](const LinePiece& piece)
    { return lines.length[static_cast<std::size_t>(piece.line)] * spacing; };
    columns.counts("line", "number of the line; its pieces share it", &LinePiece::line);
    columns.numbers("length", "m", "length of the whole line", length);
    columns.numbers(
      "tortuosity", "1", "length of the whole line over the length of the box",
      [&](const LinePiece& piece) { return length(piece) / setting.lattice.length(setting.axis); });
    columns.add<vtkUnsignedCharArray>("arrived", "1", "1 where the line reached the outlet",
      [&](const LinePiece& piece) { return lines.arrived[static_cast<std::size_t>(piece.line)]; });
  }

  void WriteNumbers() const
  {
    lamella::setFieldNumbers(this->Output, "mean_flux", this->MeanFlux);
    lamella::setFieldNumbers(this->Output, "effective_from_flux", this->Effective);
    if (!this->Found.transient && lamella::fieldNumbers(this->Output, "effective_conductivity").empty())
      lamella::setFieldNumbers(this->Output, "effective_conductivity", this->Effective);
    lamella::setFieldNumbers(this->Output, "tortuosity", this->Tortuosity);
    lamella::setFieldNumbers(this->Output, "tortuosity_factor", this->TortuosityFactor);
    lamella::setFieldNumbers(this->Output, "streamline_tortuosity", this->LineTortuosity);
    lamella::setFieldNumbers(this->Output, "line_flux", std::span(&this->LineFlux, 1));
    lamella::continueProvenance(this->Output, "flux_map", { { "streamlines", this->Self->NumberOfStreamlines } });
    this->Lines->GetFieldData()->ShallowCopy(this->Output->GetFieldData());
  }
};

vtkStandardNewMacro(vtkFluxMap);
vtkPrintSettingsMacro(vtkFluxMap);

vtkFluxMap::vtkFluxMap()
{
  this->SetNumberOfOutputPorts(2);
}

vtkGetOutputMacro(vtkFluxMap, Streamlines, vtkPolyData, 1);
vtkOutputTypesMacro(vtkFluxMap, "vtkImageData", "vtkPolyData");
vtkRequestPiecesMacro(vtkFluxMap);

int vtkFluxMap::RequestData(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkImageData* const input = vtkImageData::GetData(inputVector[0]);
  vtkImageData* const output = vtkImageData::GetData(outputVector, 0);
  vtkPolyData* const lines = vtkPolyData::GetData(outputVector, 1);
  const lamella::Outcome outcome = lamella::attempt(this,
    [&]
    {
      const lamella::Team team(this->Controller, lamella::requestedOutput(request, outputVector));
      Work work(this, input, output, lines, team);
      work.Run();
    });
  return lamella::concluded(this, outcome, outputVector);
}
