#include "vtkBondAlgorithm.h"

#include "BondScene.h"

#include "vtkClassMacros.h"
#include "vtkDataObject.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"

#include <array>
#include <string>
#include <vector>

namespace pd = lamella::peridynamics;

struct vtkBondAlgorithm::Internals
{
  pd::PairTable Table;
  std::vector<pd::Notch> Notches;
};

vtkBondAlgorithm::vtkBondAlgorithm()
  : Internal(std::make_unique<Internals>())
{
  this->SetInputArrayToProcess(1, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "grain");
  this->Controller = vtkMultiProcessController::GetGlobalController();
}

vtkBondAlgorithm::~vtkBondAlgorithm() = default;

vtkSetNamedMacro(vtkBondAlgorithm, YoungsModulus, YoungsModuli, Internal->Table.young);
vtkSetNamedMacro(vtkBondAlgorithm, FractureEnergy, FractureEnergies, Internal->Table.fractureEnergy);
vtkSetNamedMacro(vtkBondAlgorithm, Toughness, Toughnesses, Internal->Table.toughness);
vtkSetNamedMacro(vtkBondAlgorithm, CriticalStretch, CriticalStretches, Internal->Table.criticalStretch);
vtkRemoveAllMacro(vtkBondAlgorithm, Likes, Internal->Table.like);
vtkRemoveAllMacro(vtkBondAlgorithm, Notches, Internal->Notches);

void vtkBondAlgorithm::SetLike(const char* pair, const char* other)
{
  if (other != nullptr && *other != '\0')
    lamella::setNamed(this, this->Internal->Table.like, pair, std::string(other));
}

void vtkBondAlgorithm::AddNotch(double x1, double y1, double x2, double y2)
{
  this->Internal->Notches.push_back({ { x1, y1, 0 }, { x2 - x1, y2 - y1, 0 }, { 0, 0, 0 } });
  this->Modified();
}

void vtkBondAlgorithm::AddNotchInSpace(const double corner[3], const double along[3], const double across[3])
{
  const auto vector = [](const double v[3]) { return std::array<double, 3>{ v[0], v[1], v[2] }; };
  this->Internal->Notches.push_back({ vector(corner), vector(along), vector(across) });
  this->Modified();
}

vtkImageData* vtkBondAlgorithm::GetOutput()
{
  return this->GetOutput(0);
}

vtkImageData* vtkBondAlgorithm::GetOutput(int port)
{
  return vtkImageData::SafeDownCast(this->GetOutputDataObject(port));
}

vtkOutputTypesMacro(vtkBondAlgorithm, "vtkImageData");

int vtkBondAlgorithm::RequestData(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  return this->Attempt(
    [&]
    {
      const lamella::Team team(this->Controller, lamella::requestedOutput(request, outputVector));
      this->Run(vtkImageData::GetData(inputVector[0]), vtkImageData::GetData(outputVector), team);
    },
    outputVector);
}

lamella::BondSettings vtkBondAlgorithm::Settings() const
{
  lamella::BondSettings s;
  s.materials = this->Internal->Table;
  s.materials.voids = this->GivenVoids();
  s.materials.relativeTo = this->RelativeTo;
  s.materials.mixing = static_cast<pd::Mixing>(this->Mixing);
  if (this->Continuum != AUTO_CONTINUUM)
    s.continuum = static_cast<pd::Continuum>(this->Continuum - PLANE_STRESS);
  s.horizon = this->Horizon;
  if (this->Micromodulus != AUTO_MICROMODULUS)
    s.micromodulus = static_cast<pd::Micromodulus>(this->Micromodulus);
  s.voidBonds = this->CutVoidBonds ? pd::VoidBonds::Cut : pd::VoidBonds::Keep;
  s.surfaceCorrection = this->SurfaceCorrection;
  s.largeStrains = this->LargeStrains;
  s.notches = this->Internal->Notches;
  for (std::size_t a = 0; a < 3; ++a)
    s.periodic[a] = this->Periodic[a] != 0;
  return s;
}

void vtkBondAlgorithm::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Model: " << lamella::toJson(this->Settings()).dump() << "\n";
}
