#include "vtkCrackPath.h"

#include "Attempt.h"
#include "CrackInput.h"
#include "CrackSample.h"
#include "CrackTables.h"
#include "NewArray.h"
#include "vtkClassMacros.h"
#include "vtkLatticeConversion.h"
#include "vtkPieces.h"
#include "vtkProvenance.h"

#include "core/Error.h"
#include "cracks/BondCount.h"
#include "cracks/CrackPaths.h"
#include "cracks/CrackSurface.h"
#include "cracks/CrackTip.h"
#include "cracks/ThroughPath.h"

#include "vtkFieldData.h"
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

#include <cmath>
#include <numbers>
#include <optional>

namespace cracks = lamella::cracks;

/// One run of the filter.
struct vtkCrackPath::Work
{
  vtkCrackPath* Self;
  const lamella::Team& Team;
  vtkInformationVector* Outputs;

  [[nodiscard]] vtkPolyData* Paths() const { return vtkPolyData::GetData(this->Outputs, 0); }
  [[nodiscard]] vtkTable* Table(int port) const { return vtkTable::GetData(this->Outputs, port); }
  [[nodiscard]] vtkImageData* Image() const { return vtkImageData::GetData(this->Outputs, 4); }

  /// @throws Cancelled on every rank
  void Report(double share) const
  {
    this->Self->UpdateProgress(share);
    if (this->Team.any(this->Self->CheckAbort()))
      throw lamella::Cancelled();
  }

  void Set(const char* name, std::initializer_list<double> values) const
  {
    lamella::setFieldNumbers(this->Paths(), name, std::span(values.begin(), values.size()));
  }

  void Run(vtkPolyData* bonds, vtkImageData* image)
  {
    for (const double length : { this->Self->MinimumLength, this->Self->SpurLength })
    {
      if (!std::isfinite(length))
      {
        throw lamella::ParameterError(
          "a length of " + std::to_string(length) + " spacings", "give a number of spacings, or -1 for the default");
      }
    }
    this->Report(0.05);
    const lamella::CrackInput input = lamella::crackInput(bonds, this->Self->Horizon, this->Team);
    this->Report(0.2);
    std::optional<lamella::CrackSample> sample;
    if (image != nullptr)
    {
      sample.emplace(
        image, this->Self->GetInputArrayInformation(0), this->Self->GetInputArrayInformation(1), input, this->Team);
    }
    lamella::CrackScale scale{ input, input.phases };
    if (sample)
      scale.phases = sample->names();
    this->Report(0.4);
    const bool space = input.lattice.dimension == 3;
    cracks::CrackPaths paths;
    cracks::CrackSurface surface;
    if (space)
      this->FindSurface(surface, scale, sample);
    else
      this->FindPaths(paths, scale, sample);
    this->Report(0.7);
    const cracks::BondCount count(input.lattice.dimension, input.horizon);
    this->WriteNumbers(paths, count, scale);
    if (sample)
    {
      this->Image()->ShallowCopy(image);
      if (this->Self->ComputeFragments)
        this->WriteFragments(sample->fragments(), input.lattice);
    }
    this->Report(0.95);
    if (space)
      this->WriteSurface(surface, count, scale);
    else if (this->Team.rank() == 0)
    {
      lamella::fillCrackPaths(this->Paths(), paths, scale);
      lamella::fillPathTable(this->Table(1), paths, scale);
      lamella::fillPairTable(this->Table(2), paths.pairs, paths.length, cracks::bondsByPair(input.bonds, count), scale);
      lamella::fillGrowthTable(this->Table(3), paths, scale);
    }
    lamella::setFieldTexts(this->Paths(), "phase_names", scale.phases);
    lamella::setProvenance(
      this->Paths(), this->Team.share(lamella::provenance(bonds), !lamella::provenance(bonds).empty()));
    lamella::continueProvenance(this->Paths(), "crack_path",
      { { "horizon", input.horizon }, { "minimum_length", this->Self->MinimumLength },
        { "spur_length", this->Self->SpurLength } });
    for (const int port : { 1, 2, 3, 5 })
      this->Table(port)->GetFieldData()->ShallowCopy(this->Paths()->GetFieldData());
  }

  void FindPaths(
    cracks::CrackPaths& paths, lamella::CrackScale& scale, const std::optional<lamella::CrackSample>& sample) const
  {
    std::vector<std::uint8_t> phase;
    std::vector<std::uint8_t> solid;
    std::vector<double> displacement;
    if (sample)
    {
      phase = sample->phases();
      solid = sample->solid(phase);
      vtkInformation* const choice = this->Self->GetInputArrayInformation(2);
      displacement = sample->displacement(choice->Get(vtkDataObject::FIELD_NAME()));
    }
    const lamella::CrackInput& input = scale.input;
    this->Team.agree(
      [&]
      {
        paths = cracks::findCrackPaths(input.lattice, input.horizon, input.bonds, phase, solid,
          { this->Self->MinimumLength, this->Self->SpurLength });
      });
    for (const int axis : { 0, 1 })
    {
      scale.through[static_cast<std::size_t>(axis)] =
        cracks::throughPath(paths, input.lattice, solid, axis, 2 * input.horizon);
    }
    if (!displacement.empty())
    {
      cracks::openings(paths, input.lattice, displacement);
      scale.opening = true;
    }
  }

  void FindSurface(cracks::CrackSurface& surface, const lamella::CrackScale& scale,
    const std::optional<lamella::CrackSample>& sample) const
  {
    std::vector<std::uint8_t> phase;
    std::vector<std::uint8_t> solid;
    if (sample)
    {
      phase = sample->phases();
      solid = sample->solid(phase);
    }
    const lamella::CrackInput& input = scale.input;
    const double least = this->Self->MinimumLength < 0 ? input.horizon : this->Self->MinimumLength;
    this->Team.agree([&]
      { surface = cracks::findCrackSurface(input.lattice, input.horizon, input.bonds, phase, solid, least * least); });
  }

  void WriteSurface(
    const cracks::CrackSurface& surface, const cracks::BondCount& count, const lamella::CrackScale& scale) const
  {
    const double square = scale.input.lattice.spacing * scale.input.lattice.spacing;
    std::array<double, 2> areas{};
    if (this->Team.rank() == 0)
    {
      vtkNew<vtkFieldData> kept; // the surface takes the place of all that there is
      kept->ShallowCopy(this->Paths()->GetFieldData());
      const lamella::CrackAreas found =
        lamella::fillCrackSurfaces(this->Paths(), this->Table(1), this->Table(3), surface, scale);
      this->Paths()->GetFieldData()->ShallowCopy(kept);
      lamella::fillPairTable(
        this->Table(2), found.pairs, found.all, cracks::bondsByPair(scale.input.bonds, count), scale);
      areas = { found.all, found.main };
    }
    this->Team.sum(areas);
    this->Set("crack_count", { static_cast<double>(surface.cracks) });
    this->Set("crack_area", { square * areas[0] });
    this->Set("main_area", { square * areas[1] });
    this->Set("left_out_cracks", { static_cast<double>(surface.leftOutCracks) });
    this->Set("left_out_faces", { static_cast<double>(surface.leftOutFaces) });
  }

  void WriteNumbers(
    const cracks::CrackPaths& paths, const cracks::BondCount& count, const lamella::CrackScale& scale) const
  {
    const lamella::CrackInput& input = scale.input;
    constexpr double degrees = 180 / std::numbers::pi;
    const auto number = [](auto value) { return static_cast<double>(value); };
    const double spacing = input.lattice.spacing;
    const bool any = !paths.cracks.empty();
    if (input.lattice.dimension == 2)
    {
      this->Set("crack_count", { number(paths.cracks.size()) });
      this->Set("path_count", { number(paths.paths.size()) });
      this->Set("crack_length", { spacing * paths.length });
      this->Set("main_length", { any ? spacing * paths.cracks[0].length : 0 });
      this->Set("main_through",
        { any && paths.cracks[0].through[0] ? 1.0 : 0.0, any && paths.cracks[0].through[1] ? 1.0 : 0.0 });
      this->Set("crack_angle", { any ? degrees * paths.orientation.angle : std::nan("") });
      this->Set("crack_angle_spread", { any ? degrees * paths.orientation.spread : std::nan("") });
      const cracks::CrackTip tip = any ? cracks::crackTip(paths, 0, input.horizon) : cracks::CrackTip();
      const auto place = [&](const char* name, const cracks::Place& at)
      {
        const auto along = [&](std::size_t axis)
        { return tip.found ? input.lattice.origin[axis] + spacing * at[axis] : std::nan(""); };
        this->Set(name, { along(0), along(1) });
      };
      place("main_start", tip.start);
      place("main_tip", tip.tip);
      this->Set("main_extension", { tip.found ? spacing * tip.extension : 0 });
      const auto way = [&](const char* name, double unit, auto value)
      {
        const auto along = [&](std::size_t axis)
        { return scale.through[axis].found ? unit * value(scale.through[axis]) : std::nan(""); };
        this->Set(name, { along(0), along(1) });
      };
      way(
        "through_length", spacing, [](const cracks::ThroughPath& t) { return t.length; });
      way(
        "through_in_voids", spacing, [](const cracks::ThroughPath& t) { return t.inVoids; });
      way(
        "through_in_solid", spacing, [](const cracks::ThroughPath& t) { return t.inSolid; });
      way(
        "through_chord", spacing, [](const cracks::ThroughPath& t) { return t.chord; });
      way("through_tortuosity", 1, [](const cracks::ThroughPath& t) { return t.tortuosity(); });
      const cracks::LeftOut& left = paths.leftOut;
      this->Set("left_out_cracks", { number(left.cracks) });
      this->Set("left_out_length", { spacing * left.length });
      this->Set("left_out_bonds", { number(left.bonds) });
      this->Set("left_out_spurs", { number(left.spurs) });
      this->Set("crushed_pieces", { number(left.islands) });
    }
    this->Set("broken_bonds", { number(input.bonds.size()) });
    this->Set("counted_size", { std::pow(spacing, input.lattice.dimension - 1) * count.size(input.bonds) });
    this->Set("count_anisotropy", { count.anisotropy() });
    lamella::setFieldNumbers(this->Paths(), "crack_normals", count.normals(input.bonds));
    this->Set("horizon", { input.horizon });
  }

  void WriteFragments(const lamella::CrackFragments& fragments, const lamella::Lattice& lattice) const
  {
    const auto labels = lamella::newArray<vtkIntArray>("fragment", 1, fragments.ofPiece.size());
    std::copy(fragments.ofPiece.begin(), fragments.ofPiece.end(), labels->GetPointer(0));
    lamella::describe(labels, "1", "number of the fragment, 1 is the largest; 0 in voids", "vtkCrackPath");
    this->Image()->GetPointData()->AddArray(labels);
    if (this->Team.rank() == 0)
      lamella::fillFragmentTable(this->Table(5), fragments, lattice);
    const double solid = static_cast<double>(fragments.nodes());
    this->Set("fragment_count", { static_cast<double>(fragments.list.size()) });
    this->Set(
      "fragment_largest", { fragments.list.empty() ? 0 : static_cast<double>(fragments.list.front().nodes) / solid });
    const auto flag = [&](std::size_t axis) { return fragments.severed[axis] ? 1.0 : 0.0; };
    this->Set("severed", { flag(0), flag(1), flag(2) });
  }
};

vtkStandardNewMacro(vtkCrackPath);
vtkPrintSettingsMacro(vtkCrackPath);

vtkCrackPath::vtkCrackPath()
{
  this->SetNumberOfInputPorts(2);
  this->SetNumberOfOutputPorts(6);
  this->SetInputArrayToProcess(0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "phase");
  this->SetInputArrayToProcess(1, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "grain");
  this->SetInputArrayToProcess(2, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "displacement");
}

void vtkCrackPath::SetImageData(vtkImageData* image)
{
  this->SetInputData(1, image);
}

void vtkCrackPath::SetImageConnection(vtkAlgorithmOutput* image)
{
  this->SetInputConnection(1, image);
}

vtkGetOutputMacro(vtkCrackPath, PathTable, vtkTable, 1);
vtkGetOutputMacro(vtkCrackPath, PairTable, vtkTable, 2);
vtkGetOutputMacro(vtkCrackPath, GrowthTable, vtkTable, 3);
vtkGetOutputMacro(vtkCrackPath, Image, vtkImageData, 4);
vtkGetOutputMacro(vtkCrackPath, FragmentTable, vtkTable, 5);

int vtkCrackPath::FillInputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), port == 0 ? "vtkPolyData" : "vtkImageData");
  if (port == 1)
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  return 1;
}

vtkOutputTypesMacro(vtkCrackPath, "vtkPolyData", "vtkTable", "vtkTable", "vtkTable", "vtkImageData", "vtkTable");

int vtkCrackPath::RequestInformation(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  // of the image on port 4; the executive copied what it found on the first input
  vtkInformation* const image = inputVector[1]->GetInformationObject(0);
  vtkInformation* const output = outputVector->GetInformationObject(4);
  if (image != nullptr)
  {
    output->CopyEntry(image, vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT());
    output->CopyEntry(image, vtkDataObject::SPACING());
    output->CopyEntry(image, vtkDataObject::ORIGIN());
    output->CopyEntry(image, vtkDataObject::DIRECTION());
    output->CopyEntry(image, vtkAlgorithm::CAN_PRODUCE_SUB_EXTENT());
  }
  lamella::allInFirstPiece(outputVector);
  return 1;
}

int vtkCrackPath::RequestUpdateExtent(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkInformation* const wanted = lamella::requestedOutput(request, outputVector);
  if (!lamella::Team::together(this->Controller, wanted))
    lamella::requestWhole(inputVector[0]->GetInformationObject(0));
  if (vtkInformation* const image = inputVector[1]->GetInformationObject(0))
    lamella::requestInput(image, wanted, this->Controller);
  return 1;
}

int vtkCrackPath::RequestData(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  const lamella::Outcome outcome = lamella::attempt(this,
    [&]
    {
      lamella::emptyAll(outputVector);
      const lamella::Team team(this->Controller, lamella::requestedOutput(request, outputVector));
      Work{ this, team, outputVector }.Run(vtkPolyData::GetData(inputVector[0]), vtkImageData::GetData(inputVector[1]));
    });
  return lamella::concluded(this, outcome, outputVector);
}
