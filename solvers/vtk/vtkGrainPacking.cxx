#include "vtkGrainPacking.h"

#include "Attempt.h"
#include "PackingData.h"
#include "vtkLatticeConversion.h"
#include "vtkProvenance.h"

#include "lattice/Error.h"
#include "packing/Packing.h"

#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <array>
#include <span>
#include <string>

vtkStandardNewMacro(vtkGrainPacking);

vtkGrainPacking::vtkGrainPacking()
{
  this->SetNumberOfInputPorts(0);
  this->SetNumberOfOutputPorts(2);
  const lamella::packing::PackingOptions options; // the library's own defaults
  this->Dimension = options.dimension;
  this->Count = static_cast<vtkIdType>(options.count);
  this->MeanDiameter = options.meanDiameter;
  this->DiameterRatio = options.diameterRatio;
  this->Sizes = static_cast<int>(options.sizes);
  this->Aspect = options.aspect;
  this->Periodic = options.periodic;
  this->Friction = options.friction;
  this->Pressure = options.pressure;
  this->Softness = options.softness;
  this->Seed = static_cast<vtkIdType>(options.seed);
  this->Tolerance = options.tolerance;
}

vtkPolyData* vtkGrainPacking::GetContacts()
{
  return vtkPolyData::SafeDownCast(this->GetOutputDataObject(1));
}

int vtkGrainPacking::RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  for (int port = 0; port < 2; ++port)
  {
    outputVector->GetInformationObject(port)->Set(CAN_HANDLE_PIECE_REQUEST(), 1); // all in the first piece
  }
  return 1;
}

void vtkGrainPacking::Pack(vtkPolyData* particles, vtkPolyData* contacts)
{
  if (this->Seed < 0)
  {
    throw lamella::ParameterError(
      "the seed is " + std::to_string(this->Seed), "give a whole number that is not negative");
  }
  lamella::packing::PackingOptions options;
  options.dimension = this->Dimension;
  options.count = this->Count;
  options.meanDiameter = this->MeanDiameter;
  options.diameterRatio = this->DiameterRatio;
  options.sizes = static_cast<lamella::packing::Sizes>(this->Sizes);
  options.aspect = this->Aspect;
  options.periodic = this->Periodic;
  options.friction = this->Friction;
  options.pressure = this->Pressure;
  options.softness = this->Softness;
  if (this->PackingFraction != 0)
  {
    options.packingFraction = this->PackingFraction;
  }
  options.seed = static_cast<std::uint64_t>(this->Seed);
  options.tolerance = this->Tolerance;
  options.progress = [this](double share)
  {
    this->SetProgressText("packing");
    this->UpdateProgress(share);
  };
  options.interrupted = [this] { return this->CheckAbort(); };
  const lamella::packing::Packing packing = lamella::packing::pack(options);
  lamella::setPacking(
    packing, lamella::packing::statistics(packing, options.friction > 0), this->GetClassName(), particles, contacts);

  const auto seed = static_cast<double>(this->Seed);
  nlohmann::json parameters{ { "dimension", this->Dimension }, { "count", this->Count },
    { "mean_diameter", this->MeanDiameter }, { "diameter_ratio", this->DiameterRatio },
    { "sizes", std::array{ "volume", "volume-share", "diameter" }.at(static_cast<std::size_t>(this->Sizes)) },
    { "aspect", this->Aspect }, { "periodic", this->Periodic }, { "friction", this->Friction },
    { "pressure", this->Pressure }, { "softness", this->Softness }, { "tolerance", this->Tolerance } };
  if (options.packingFraction)
  {
    parameters["packing_fraction"] = this->PackingFraction;
  }
  for (vtkPolyData* const data : { particles, contacts })
  {
    lamella::setFieldNumbers(data, "seed", std::span(&seed, 1));
    lamella::beginProvenance(data, "packing", parameters, options.seed);
  }
}

int vtkGrainPacking::RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  vtkPolyData* const particles = vtkPolyData::GetData(outputVector, 0);
  vtkPolyData* const contacts = vtkPolyData::GetData(outputVector, 1);
  particles->Initialize();
  contacts->Initialize();
  vtkInformation* const request = outputVector->GetInformationObject(0);
  if (request->Get(vtkStreamingDemandDrivenPipeline::UPDATE_PIECE_NUMBER()) > 0)
  {
    return 1;
  }
  const lamella::Outcome outcome = lamella::attempt(this, [&] { this->Pack(particles, contacts); });
  return lamella::concluded(this, outcome, outputVector);
}

void vtkGrainPacking::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Dimension: " << this->Dimension << "\n"
     << indent << "Count: " << this->Count << "\n"
     << indent << "MeanDiameter: " << this->MeanDiameter << "\n"
     << indent << "DiameterRatio: " << this->DiameterRatio << "\n"
     << indent << "Sizes: " << this->Sizes << "\n"
     << indent << "Aspect: " << this->Aspect << "\n"
     << indent << "Periodic: " << this->Periodic << "\n"
     << indent << "Friction: " << this->Friction << "\n"
     << indent << "Pressure: " << this->Pressure << "\n"
     << indent << "Softness: " << this->Softness << "\n"
     << indent << "PackingFraction: " << this->PackingFraction << "\n"
     << indent << "Seed: " << this->Seed << "\n"
     << indent << "Tolerance: " << this->Tolerance << "\n";
}
