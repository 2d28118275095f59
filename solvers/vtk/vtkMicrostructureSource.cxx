#include "vtkMicrostructureSource.h"

#include "vtkLatticeConversion.h"
#include "vtkPieces.h"
#include "vtkProvenance.h"

#include "generators/Generators.h"
#include "lattice/Error.h"

#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"

#include <algorithm>
#include <array>
#include <optional>

vtkStandardNewMacro(vtkMicrostructureSource);

vtkMicrostructureSource::vtkMicrostructureSource()
{
  this->SetNumberOfInputPorts(0);
}

void vtkMicrostructureSource::Generate()
{
  namespace generators = lamella::generators;
  const std::array<std::int64_t, 3> size{ this->Size[0], this->Size[1], this->Size[2] };
  const int dimension = size[2] > 1 ? 3 : 2;
  nlohmann::json parameters{ { "size", this->Size }, { "spacing", this->Spacing } };
  std::optional<std::uint64_t> seed;
  lamella::PhaseImage image;
  if ((this->Kind == SOFTWOOD || this->Kind == HARDWOOD) && this->Seed < 0)
  {
    throw lamella::ParameterError(
      "the seed is " + std::to_string(this->Seed), "give a whole number that is not negative");
  }
  switch (this->Kind)
  {
    case SOFTWOOD:
    {
      generators::SoftwoodOptions options;
      options.dimension = dimension;
      options.size = size;
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
      seed = options.seed;
      image = generators::softwood(options);
      parameters["kind"] = "softwood";
      parameters["solid_fraction"] = this->SolidFraction;
      parameters["tangential_diameter"] = this->TangentialDiameter;
      parameters["radial_diameter"] = this->RadialDiameter;
      parameters["ring_position"] = this->RingPosition;
      parameters["ray_distance"] = this->RayDistance;
      parameters["scatter"] = this->Scatter;
      if (dimension == 3)
      {
        parameters["tracheid_length"] = this->TracheidLength;
      }
      break;
    }
    case HARDWOOD:
    {
      generators::HardwoodOptions options;
      options.dimension = dimension;
      options.size = size;
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
      seed = options.seed;
      image = generators::hardwood(options);
      parameters["kind"] = "hardwood";
      parameters["solid_fraction"] = this->SolidFraction;
      parameters["fibre_diameter"] = this->FibreDiameter;
      parameters["vessel_diameter"] = this->VesselDiameter;
      parameters["vessel_share"] = this->VesselShare;
      parameters["early_end"] = this->EarlyEnd;
      parameters["multiples"] = this->Multiples;
      parameters["ring_position"] = this->RingPosition;
      parameters["ray_distance"] = this->HardwoodRayDistance;
      parameters["scatter"] = this->Scatter;
      break;
    }
    case HONEYCOMB:
    {
      generators::HoneycombOptions options;
      options.size = size;
      options.spacing = this->Spacing;
      options.solidFraction = this->SolidFraction;
      options.cellsAcross = this->Cells;
      image = generators::honeycomb(options);
      parameters["kind"] = "honeycomb";
      parameters["solid_fraction"] = this->SolidFraction;
      parameters["cells"] = this->Cells;
      break;
    }
    case CHECKERBOARD:
      image = generators::checkerboard(dimension, size, this->Spacing, this->Cells);
      parameters["kind"] = "checkerboard";
      parameters["cells"] = this->Cells;
      break;
    case INCLUSIONS:
      image = generators::inclusionArray(dimension, size, this->Spacing, this->SolidFraction, this->Cells);
      parameters["kind"] = dimension == 3 ? "spheres" : "disks";
      parameters["solid_fraction"] = this->SolidFraction;
      parameters["cells"] = this->Cells;
      break;
    default:
      image = generators::laminate(dimension, size, this->Spacing, this->Axis, this->SolidFraction, this->Cells);
      parameters["kind"] = "laminate";
      parameters["solid_fraction"] = this->SolidFraction;
      parameters["cells"] = this->Cells;
      parameters["axis"] = this->Axis;
  }
  this->Image = lamella::toImageData(std::move(image));
  lamella::setFieldText(this->Image, "pixel_size_source", "option");
  lamella::beginProvenance(this->Image, "microstructure", parameters, seed);
}

int vtkMicrostructureSource::RequestInformation(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  if (this->Size[0] < 1 || this->Size[1] < 1 || this->Size[2] < 1 || !(this->Spacing > 0))
  {
    vtkErrorMacro("a sample of " << this->Size[0] << " x " << this->Size[1] << " x " << this->Size[2]
                                 << " nodes with spacing " << this->Spacing
                                 << "\nhint: give at least one node along each axis and a positive spacing");
    return 0;
  }
  const auto lattice =
    lamella::makeLattice(this->Size[0], this->Size[1], this->Size[2], this->Size[2] > 1 ? 3 : 2, this->Spacing);
  lamella::announce(outputVector->GetInformationObject(0), lattice);
  return 1;
}

int vtkMicrostructureSource::RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  try
  {
    if (this->Image == nullptr || this->MadeTime < this->GetMTime())
    {
      this->Image = nullptr;
      this->Generate();
      this->MadeTime.Modified();
    }
    lamella::deliver(this->Image, outputVector->GetInformationObject(0));
  }
  catch (const lamella::Error& error)
  {
    vtkErrorMacro(<< error.what() << "\nhint: " << error.hint());
    return 0;
  }
  catch (const std::exception& error)
  {
    vtkErrorMacro(<< error.what());
    return 0;
  }
  return 1;
}

void vtkMicrostructureSource::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Kind: " << this->Kind << "\n"
     << indent << "Size: " << this->Size[0] << " " << this->Size[1] << " " << this->Size[2] << "\n"
     << indent << "Spacing: " << this->Spacing << "\n"
     << indent << "SolidFraction: " << this->SolidFraction << "\n"
     << indent << "Seed: " << this->Seed << "\n"
     << indent << "TangentialDiameter: " << this->TangentialDiameter << "\n"
     << indent << "RadialDiameter: " << this->RadialDiameter[0] << " " << this->RadialDiameter[1] << "\n"
     << indent << "RingPosition: " << this->RingPosition[0] << " " << this->RingPosition[1] << "\n"
     << indent << "RayDistance: " << this->RayDistance << "\n"
     << indent << "TracheidLength: " << this->TracheidLength << "\n"
     << indent << "Scatter: " << this->Scatter << "\n"
     << indent << "FibreDiameter: " << this->FibreDiameter << "\n"
     << indent << "VesselDiameter: " << this->VesselDiameter[0] << " " << this->VesselDiameter[1] << "\n"
     << indent << "VesselShare: " << this->VesselShare[0] << " " << this->VesselShare[1] << "\n"
     << indent << "EarlyEnd: " << this->EarlyEnd << "\n"
     << indent << "Multiples: " << this->Multiples << "\n"
     << indent << "HardwoodRayDistance: " << this->HardwoodRayDistance << "\n"
     << indent << "Cells: " << this->Cells << "\n"
     << indent << "Axis: " << this->Axis << "\n";
}
