#include "vtkMicrographLattice.h"

#include "Attempt.h"
#include "ContourData.h"
#include "FieldNumbers.h"
#include "vtkPieces.h"
#include "vtkProvenance.h"

#include "lattice/Error.h"
#include "micrograph/ContourLattice.h"
#include "micrograph/MiddleLamella.h"
#include "micrograph/WallDirection.h"
#include "micrograph/WallThickness.h"

#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkIntArray.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <span>
#include <string>
#include <vector>

namespace
{

using lamella::describe;
namespace micrograph = lamella::micrograph;

/// A spacing that resolves the walls, as advice.
std::string advice(const micrograph::ContourSet& contours)
{
  const double median = micrograph::wallThickness(contours).median;
  if (!(median > 0))
  {
    return "give it in metres, such as 1e-6";
  }
  std::array<char, 128> text{};
  std::snprintf(text.data(), text.size(),
    "give it in metres; %.2g is a quarter of the walls' median thickness of %.2g m", median / 4, median);
  return text.data();
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
  {
    image->GetPointData()->AddArray(array);
  }
}

void addLamella(vtkImageData* image, const micrograph::MiddleLamella& found, const std::string& creator)
{
  const auto number = [&](const char* name, auto value, const char* unit, const char* text)
  { lamella::setFieldNumber(image, name, static_cast<double>(value), unit, text, creator); };
  number("lamella_thickness", found.thickness, "m", "gap that growing outlines keep, or constant thickness");
  number("lamella_radius", found.radius, "m", "radius of curvature at which growing outlines stop; 0: never");
  number("lamella_share", found.wallShare, "1", "share of the wall's nodes that are middle lamella");
  lamella::setFieldNumbers(image, "lamella_nodes_across", std::array{ found.across.mean, found.across.low }, "1",
    "nodes across the middle lamella: mean; 5 % of it have fewer", creator);
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

int vtkMicrographLattice::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkPolyData");
  return 1;
}

vtkSmartPointer<vtkImageData> vtkMicrographLattice::Made(vtkPolyData* outlines)
{
  const micrograph::ContourSet contours = lamella::contoursFrom(outlines);
  if (this->Spacing == 0)
  {
    throw lamella::ParameterError("no spacing is given", advice(contours));
  }
  if (!(this->Horizon >= 0) || !std::isfinite(this->Horizon))
  {
    throw lamella::ParameterError(
      "the horizon is " + std::to_string(this->Horizon) + " nodes", "give 0 or more, such as 3");
  }
  micrograph::ContourLatticeOptions options;
  options.spacing = this->Spacing;
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

  nlohmann::json parameters{ { "spacing", this->Spacing } };
  const std::string creator = this->GetClassName();
  vtkSmartPointer<vtkImageData> image;
  if (this->Lamella == NONE)
  {
    image = placed(std::move(lattice.image));
  }
  else
  {
    micrograph::LamellaOptions lamella;
    lamella.method = this->Lamella == GROWTH ? micrograph::LamellaMethod::Growth : micrograph::LamellaMethod::Constant;
    if (this->LamellaThickness != 0)
    {
      lamella.thickness = this->LamellaThickness;
    }
    if (!(this->LamellaRadius < 0))
    {
      lamella.radius = this->LamellaRadius;
    }
    lamella.horizon = this->Horizon;
    micrograph::MiddleLamella found = micrograph::middleLamella(lattice, directions, lamella);
    warnings.insert(warnings.end(), found.warnings.begin(), found.warnings.end());
    image = placed(std::move(found.image));
    addLamella(image, found, creator);
    parameters["lamella"] = this->Lamella == GROWTH ? "growth" : "constant";
    parameters["lamella_thickness"] = found.thickness;
    if (this->Lamella == GROWTH)
    {
      parameters["lamella_radius"] = found.radius;
    }
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
  {
    vtkWarningMacro(<< warning);
  }
  return image;
}

bool vtkMicrographLattice::Rasterise(vtkPolyData* outlines)
{
  if (this->Image != nullptr && this->MadeTime > this->GetMTime() && this->MadeTime > outlines->GetMTime())
  {
    return true;
  }
  this->Image = nullptr;
  if (lamella::attempt(this, [&] { this->Image = this->Made(outlines); }) != lamella::Outcome::Done)
  {
    return false;
  }
  this->MadeTime.Modified();
  return true;
}

int vtkMicrographLattice::RequestInformation(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  // The extent depends on the outlines; whole on every rank.
  int port = 0;
  vtkAlgorithm* const producer = this->GetInputAlgorithm(0, 0, port);
  if (producer != nullptr && producer->UpdatePiece(0, 1, 0) == 0)
  {
    return 0; // it has said what is wrong
  }
  vtkPolyData* const outlines = vtkPolyData::GetData(inputVector[0]);
  if (outlines == nullptr || !this->Rasterise(outlines))
  {
    return 0;
  }
  lamella::announce(outputVector->GetInformationObject(0), lamella::latticeOf(this->Image));
  return 1;
}

int vtkMicrographLattice::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector*)
{
  lamella::requestWhole(inputVector[0]->GetInformationObject(0));
  return 1;
}

int vtkMicrographLattice::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  if (!this->Rasterise(vtkPolyData::GetData(inputVector[0])))
  {
    return 0;
  }
  lamella::deliver(this->Image, outputVector->GetInformationObject(0));
  return 1;
}

void vtkMicrographLattice::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  lamella::printSettings(this, os, indent);
}
