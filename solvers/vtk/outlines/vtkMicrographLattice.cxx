#include "vtkMicrographLattice.h"

#include "Attempt.h"
#include "ContourData.h"
#include "ContourField.h"
#include "FieldNumbers.h"
#include "vtkClassMacros.h"
#include "vtkPieces.h"
#include "vtkProvenance.h"

#include "core/Error.h"
#include "core/Memory.h"
#include "outlines/ContourLattice.h"
#include "outlines/LabelledLamella.h"
#include "outlines/MiddleLamella.h"
#include "outlines/WallDirection.h"
#include "outlines/WallThickness.h"

#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkIntArray.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

namespace
{

using lamella::describe;
namespace micrograph = lamella::micrograph;

/// Of all that is held at once: shares, grain and phases; directions; lamella; the image.
void requireMemory(const micrograph::ContourSet& contours, double spacing)
{
  const lamella::Lattice lattice = micrograph::latticeOf(contours.size, spacing);
  const double bytes = static_cast<double>(lattice.count()) * (17 + 28 + 20 + 21);
  if (const auto available = static_cast<double>(lamella::availableMemory()); bytes > available)
  {
    throw lamella::MemoryError(
      fmt::format("{} × {} nodes of {:.4g} m take about {}, and {} are free", lattice.size[0], lattice.size[1],
        lattice.spacing, lamella::bytesText(bytes), lamella::bytesText(available)),
      "take a larger spacing or a part of the picture");
  }
}

void addArrays(vtkImageData* image, const micrograph::ContourLattice& lattice,
  const micrograph::WallDirections& directions, const std::string& creator)
{
  const auto nodes = static_cast<vtkIdType>(lattice.lumenShare.size());
  const auto grain = vtkSmartPointer<vtkIntArray>::New();
  grain->SetName("grain");
  grain->SetNumberOfValues(nodes);
  std::copy(directions.grain.begin(), directions.grain.end(), grain->GetPointer(0));
  describe(grain, "1", "number of the cell: the lumen, and in the wall the nearest lumen", creator);
  const auto axis = vtkSmartPointer<vtkFloatArray>::New();
  axis->SetName("axis");
  axis->SetNumberOfComponents(3);
  axis->SetNumberOfTuples(nodes);
  float* value = axis->GetPointer(0);
  for (const std::array<float, 2>& direction : directions.axis)
  {
    *value++ = direction[0];
    *value++ = direction[1];
    *value++ = 0;
  }
  describe(axis, "1", "unit vector along the wall, its sign means nothing; 0 in lumens", creator);
  const auto share = vtkSmartPointer<vtkFloatArray>::New();
  share->SetName("lumen_share");
  share->SetNumberOfValues(nodes);
  std::copy(lattice.lumenShare.begin(), lattice.lumenShare.end(), share->GetPointer(0));
  describe(share, "1", "lumen's share of the node's pixel", creator);
  for (vtkDataArray* const array : std::initializer_list<vtkDataArray*>{ grain, axis, share })
    image->GetPointData()->AddArray(array);
}

/// What is told of every middle lamella.
void addLamella(
  vtkImageData* image, double wallShare, const micrograph::NodesAcross& across, const std::string& creator)
{
  lamella::setFieldNumber(
    image, "lamella_share", wallShare, "1", "share of the wall's nodes that are middle lamella", creator);
  lamella::setFieldNumbers(image, "lamella_nodes_across", std::array{ across.mean, across.low }, "1",
    "nodes across the middle lamella: mean; 5 % of it have fewer", creator);
}

void addLamella(vtkImageData* image, const micrograph::MiddleLamella& found, const std::string& creator)
{
  addLamella(image, found.wallShare, found.across, creator);
  const auto number = [&](const char* name, auto value, const char* unit, const char* text)
  { lamella::setFieldNumber(image, name, static_cast<double>(value), unit, text, creator); };
  number("lamella_thickness", found.thickness, "m", "gap that growing outlines keep, or constant thickness");
  number("lamella_radius", found.radius, "m", "radius of curvature at which growing outlines stop; 0: never");
  number("lamella_joined", found.joined, "1", "nodes that are lamella only so that it does not tear");
  number("lamella_networks", found.networks, "1", "parts of the lamella that do not hang together");
  number("lamella_largest_network", found.largestNetwork, "1", "share of the lamella's nodes in the largest part");
  number("cells", found.cells, "1", "lumens on the lattice");
  number("cells_touched", found.cellsTouched, "1",
    "of these, bordered by the largest part of the lamella or one cut off by the border");
  number(
    "cells_cut_off", found.cellsCutOff, "1", "of these, bordered by parts alone that the picture's border cuts off");
}

} // namespace

vtkStandardNewMacro(vtkMicrographLattice);

vtkMicrographLattice::vtkMicrographLattice() = default;

vtkSmartPointer<vtkImageData> vtkMicrographLattice::Made(vtkPolyData* outlines, vtkImageData* picture)
{
  const micrograph::ContourSet contours = lamella::contoursFrom(outlines);
  const std::optional<lamella::OutlineRecipe> recipe = lamella::recipeOf(outlines);
  micrograph::ContourLatticeOptions options;
  options.spacing =
    lamella::spacingOf(this->Spacing, recipe, this->Spacing > 0 ? 0 : micrograph::wallThickness(contours).median);
  requireMemory(contours, options.spacing);
  options.lines = 0;
  micrograph::ContourLattice lattice = micrograph::contourLattice(contours, options);
  const micrograph::WallDirections directions = micrograph::wallDirections(contours, lattice);
  std::vector<std::string> warnings = lattice.warnings;
  const std::array<double, 3> corner = lamella::cornerOf(outlines);
  const auto placed = [&](lamella::PhaseImage image)
  {
    image.lattice.origin = { corner[0] + image.lattice.spacing / 2, corner[1] + image.lattice.spacing / 2, corner[2] };
    return lamella::toImageData(std::move(image));
  };

  nlohmann::json parameters{ { "spacing", options.spacing } };
  const std::string creator = this->GetClassName();
  vtkSmartPointer<vtkImageData> image;
  if (this->Lamella == NONE)
  {
    image = placed(std::move(lattice.image));
  }
  else if (this->Lamella == LABELS)
  {
    const lamella::LamellaLabels labels = lamella::lamellaLabels(picture, recipe, this->LamellaPhase);
    lamella::PhaseImage found = micrograph::labelledLamella(lattice, labels.image, labels.lamella);
    const micrograph::NodesAcross across = micrograph::nodesAcross(lattice, directions, found.phase);
    if (this->Horizon > 0 && across.mean < this->Horizon)
    {
      warnings.push_back(fmt::format(
        "the middle lamella is {:.2g} nodes thick, thinner than the horizon of {:g}", across.mean, this->Horizon));
    }
    const double share = micrograph::lamellaShare(found);
    image = placed(std::move(found));
    addLamella(image, share, across, creator);
    parameters["lamella"] = "labels";
    parameters["horizon"] = this->Horizon;
  }
  else
  {
    micrograph::LamellaOptions lamella;
    lamella.method = this->Lamella == GROWTH ? micrograph::LamellaMethod::Growth : micrograph::LamellaMethod::Constant;
    if (this->LamellaThickness != 0)
      lamella.thickness = this->LamellaThickness;
    if (!(this->LamellaRadius < 0))
      lamella.radius = this->LamellaRadius;
    lamella.horizon = this->Horizon;
    micrograph::MiddleLamella found = micrograph::middleLamella(lattice, directions, lamella);
    warnings.insert(warnings.end(), found.warnings.begin(), found.warnings.end());
    image = placed(std::move(found.image));
    addLamella(image, found, creator);
    parameters["lamella"] = this->Lamella == GROWTH ? "growth" : "constant";
    parameters["lamella_thickness"] = found.thickness;
    if (this->Lamella == GROWTH)
      parameters["lamella_radius"] = found.radius;
    parameters["horizon"] = this->Horizon;
  }
  addArrays(image, lattice, directions, creator);
  lamella::setFieldNumber(
    image, "lumen_fraction", lattice.lumenFraction, "1", "share of the box within outlines, exact", creator);
  lamella::setFieldNumber(
    image, "wall_fraction", 1 - lattice.lumenFraction, "1", "share of the box outside outlines, exact", creator);
  lamella::setFieldNumber(
    image, "cropped", lattice.cropped, "m", "strip at the picture's top that no node stands for", creator);
  lamella::setFieldNumbers(image, "wall_thickness", std::array{ lattice.thickness.low, lattice.thickness.median }, "m",
    "from lumen to lumen: that 5 % of the outlines' length falls below; median", creator);
  lamella::setFieldText(
    image, "pixel_size_source", lamella::fieldText(outlines, "pixel_size_source").value_or("outlines"));
  lamella::setProvenance(image, lamella::provenance(outlines));
  lamella::continueProvenance(image, "lattice", parameters);
  for (const std::string& warning : warnings)
    vtkWarningMacro(<< warning);
  return image;
}

bool vtkMicrographLattice::Rasterise(vtkPolyData* outlines, vtkImageData* picture)
{
  if (this->Image != nullptr && this->MadeTime > this->GetMTime() && this->MadeTime > outlines->GetMTime() &&
    (picture == nullptr || this->MadeTime > picture->GetMTime()))
    return true;
  this->Image = nullptr;
  if (lamella::attempt(this, [&] { this->Image = this->Made(outlines, picture); }) != lamella::Outcome::Done)
    return false;
  this->MadeTime.Modified();
  return true;
}

vtkGetOutputMacro(vtkMicrographLattice, Output, vtkImageData, 0);
vtkOutputTypesMacro(vtkMicrographLattice, "vtkImageData");

int vtkMicrographLattice::RequestInformation(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  // The extent depends on the outlines; whole on every rank.
  for (int input = 0; input < 2; ++input)
  {
    int port = 0;
    vtkAlgorithm* const producer =
      this->GetNumberOfInputConnections(input) > 0 ? this->GetInputAlgorithm(input, 0, port) : nullptr;
    if (producer != nullptr && producer->UpdatePiece(0, 1, 0) == 0)
      return 0; // it has said what is wrong
  }
  vtkPolyData* const outlines = vtkPolyData::GetData(inputVector[0]);
  if (outlines == nullptr || !this->Rasterise(outlines, vtkImageData::GetData(inputVector[1])))
    return 0;
  lamella::announce(outputVector->GetInformationObject(0), lamella::latticeOf(this->Image));
  return 1;
}

int vtkMicrographLattice::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  if (!this->Rasterise(vtkPolyData::GetData(inputVector[0]), vtkImageData::GetData(inputVector[1])))
    return 0;
  lamella::deliver(this->Image, outputVector->GetInformationObject(0));
  return 1;
}
