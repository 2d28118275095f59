#include "vtkMicrostructureSource.h"

#include "Attempt.h"
#include "Settings.h"
#include "vtkClassMacros.h"
#include "vtkLatticeConversion.h"
#include "vtkPieces.h"
#include "vtkProvenance.h"

#include "core/Error.h"
#include "generators/Generators.h"
#include "generators/MicrographLook.h"

#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <array>
#include <optional>

vtkStandardNewMacro(vtkMicrostructureSource);
vtkPrintSettingsMacro(vtkMicrostructureSource);

vtkMicrostructureSource::vtkMicrostructureSource()
{
  this->SetNumberOfInputPorts(0);
}

namespace
{

namespace generators = lamella::generators;

constexpr int NodesPerPixel = 4; // edges are smooth to a sixteenth of a pixel's light

/// Each of its pixels in n x n.
template <typename Options>
Options finer(Options options, int n)
{
  options.size[0] *= n;
  options.size[1] *= n;
  options.spacing /= n;
  return options;
}

void addMicrograph(vtkImageData* image, const lamella::micrograph::Picture& picture)
{
  const std::vector<std::uint16_t>& values = picture.colour.empty() ? picture.grey : picture.colour;
  const auto array = vtkSmartPointer<vtkUnsignedCharArray>::New();
  array->SetName("micrograph");
  array->SetNumberOfComponents(picture.colour.empty() ? 1 : 3);
  array->SetNumberOfTuples(image->GetNumberOfPoints());
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  image->GetPointData()->AddArray(array);
}

} // namespace

/// The tissue, n times finer than asked for.
lamella::PhaseImage vtkMicrostructureSource::Tissue(int n)
{
  if (this->Kind == SOFTWOOD)
  {
    generators::SoftwoodOptions options;
    options.dimension = this->Size[2] > 1 ? 3 : 2;
    options.size = { this->Size[0], this->Size[1], this->Size[2] };
    options.spacing = this->Spacing;
    options.solidFraction = this->SolidFraction;
    options.tangentialDiameter = this->TangentialDiameter;
    options.radialDiameterEarly = this->RadialDiameter[0];
    options.radialDiameterLate = this->RadialDiameter[1];
    options.ringPosition0 = this->RingPosition[0];
    options.ringPosition1 = this->RingPosition[1];
    options.rayEvery = this->RayDistance;
    options.tracheidLength = this->TracheidLength;
    options.scatter = this->Scatter;
    options.seed = static_cast<std::uint64_t>(this->Seed);
    return generators::softwood(finer(options, n));
  }
  generators::HardwoodOptions options;
  options.dimension = this->Size[2] > 1 ? 3 : 2;
  options.size = { this->Size[0], this->Size[1], this->Size[2] };
  options.spacing = this->Spacing;
  options.solidFraction = this->SolidFraction;
  options.fibreDiameter = this->FibreDiameter;
  options.vesselDiameterEarly = this->VesselDiameter[0];
  options.vesselDiameterLate = this->VesselDiameter[1];
  options.vesselShareEarly = this->VesselShare[0];
  options.vesselShareLate = this->VesselShare[1];
  options.earlyEnd = this->EarlyEnd;
  options.multiples = this->Multiples;
  options.ringPosition0 = this->RingPosition[0];
  options.ringPosition1 = this->RingPosition[1];
  options.rayEvery = this->HardwoodRayDistance;
  options.scatter = this->Scatter;
  options.seed = static_cast<std::uint64_t>(this->Seed);
  return generators::hardwood(finer(options, n));
}

lamella::PhaseImage vtkMicrostructureSource::Sample()
{
  const std::array<std::int64_t, 3> size{ this->Size[0], this->Size[1], this->Size[2] };
  const int dimension = size[2] > 1 ? 3 : 2;
  switch (this->Kind)
  {
    case SOFTWOOD:
    case HARDWOOD:
      return this->Tissue(1);
    case HONEYCOMB:
      return generators::honeycomb({ size, this->Spacing, this->SolidFraction, this->Cells });
    case CHECKERBOARD:
      return generators::checkerboard(dimension, size, this->Spacing, this->Cells);
    case INCLUSIONS:
      return generators::inclusionArray(dimension, size, this->Spacing, this->SolidFraction, this->Cells);
    default:
      return generators::laminate(dimension, size, this->Spacing, this->Axis, this->SolidFraction, this->Cells);
  }
}

void vtkMicrostructureSource::Generate()
{
  const bool tissue = this->Kind == SOFTWOOD || this->Kind == HARDWOOD;
  std::optional<lamella::micrograph::Picture> drawn;
  if (tissue && this->Look != LABELS)
  {
    if (this->Size[2] > 1)
    {
      throw lamella::ParameterError(
        "a micrograph is of a cross-section, and this sample is a volume", "give a size of two numbers, or no look");
    }
    generators::LookOptions options;
    options.stain = static_cast<generators::Stain>(this->Look - MAGENTA);
    options.blur = this->Blur;
    options.noise = this->Noise;
    options.unevenLight = this->UnevenLight;
    options.dirt = this->Dirt;
    options.tears = this->Tears;
    options.rim = this->Rim;
    options.scaleBar = this->ScaleBar;
    options.seed = static_cast<std::uint64_t>(this->Seed);
    drawn = generators::makeLook(this->Tissue(NodesPerPixel), NodesPerPixel, options);
  }
  this->Image = lamella::toImageData(this->Sample());
  if (drawn)
    addMicrograph(this->Image, *drawn);
  lamella::setFieldText(this->Image, "pixel_size_source", "generated");
  const auto seed = static_cast<std::uint64_t>(this->Seed);
  lamella::beginProvenance(
    this->Image, "microstructure", lamella::settingsAsJson(this), tissue ? std::optional(seed) : std::nullopt);
}

int vtkMicrostructureSource::RequestInformation(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  const auto announce = [&]
  {
    const auto [nx, ny, nz] = this->Size;
    lamella::announce(
      outputVector->GetInformationObject(0), lamella::makeLattice(nx, ny, nz, nz > 1 ? 3 : 2, this->Spacing));
  };
  return lamella::attempt(this, announce) == lamella::Outcome::Done ? 1 : 0;
}

int vtkMicrostructureSource::RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  const auto make = [&]
  {
    if (this->Image == nullptr || this->MadeTime < this->GetMTime())
    {
      this->Image = nullptr;
      this->Generate();
      this->MadeTime.Modified();
    }
    lamella::deliver(this->Image, outputVector->GetInformationObject(0));
  };
  return lamella::concluded(this, lamella::attempt(this, make), outputVector);
}
