#include "vtkPointAlgorithm.h"

#include "PointScene.h"
#include "vtkClassMacros.h"
#include "vtkPieces.h"

#include "core/Error.h"
#include "peridynamics/ElasticStudy.h"

#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

struct vtkPointAlgorithm::Internals
{
  std::map<std::string, std::map<std::string, double>> Constants;
};

vtkPointAlgorithm::vtkPointAlgorithm()
  : Internal(std::make_unique<Internals>())
{
  this->SetInputArrayToProcess(1, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "axis");
}

vtkPointAlgorithm::~vtkPointAlgorithm() = default;

void vtkPointAlgorithm::SetPhaseConstant(const char* phase, const char* constant, double value)
{
  if (phase == nullptr || *phase == '\0' || constant == nullptr)
    return;
  auto& constants = this->Internal->Constants[phase];
  const auto entry = constants.find(constant);
  if (entry == constants.end() || entry->second != value)
  {
    constants[constant] = value;
    this->Modified();
  }
}

vtkRemoveAllMacro(vtkPointAlgorithm, PhaseConstants, Internal->Constants);
vtkAllInFirstPieceMacro(vtkPointAlgorithm);

int vtkPointAlgorithm::RequestData(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  return this->Attempt(
    [&]
    {
      const lamella::Team team(this->Controller, lamella::requestedOutput(request, outputVector));
      if (team.size() == 1 && !lamella::isFirstPiece(outputVector))
        return;
      const lamella::peridynamics::ThreadScope threads(this->ThreadCount());
      this->Run(vtkImageData::GetData(inputVector[0]), outputVector, team);
    },
    outputVector);
}

void vtkPointAlgorithm::LetStop(const lamella::Team& team)
{
  this->UpdateProgress(0);
  if (team.any(this->CheckAbort()))
    throw lamella::Cancelled();
}

lamella::PointSettings vtkPointAlgorithm::Settings() const
{
  lamella::PointSettings s;
  if (this->Law != AUTO_LAW)
    s.law = static_cast<lamella::WallLaw>(this->Law - ISOTROPIC);
  if (this->Plane != AUTO_PLANE)
    s.plane = this->Plane == PLANE_STRESS ? lamella::mpm::PlaneState::Stress : lamella::mpm::PlaneState::Strain;
  s.wall = { this->YoungsModulus, this->TransverseModulus, this->PoissonsRatio, this->TransversePoissonsRatio,
    this->ShearModulus, this->Barrier, this->YieldStress, this->TransverseYieldStress, this->ShearYieldStress,
    this->Hardening, this->Density };
  for (const auto& [phase, constants] : this->Internal->Constants)
    for (const auto& [name, value] : constants)
      s.ofPhase[phase][lamella::wallConstant(name)] = value;
  s.voids = this->GivenVoids();
  s.perNode = this->PointsPerNode;
  if (s.perNode == 0)
    s.perNode = static_cast<int>(std::ceil(std::clamp(2 * this->CellsPerNode, 2.0, 16.0)));
  s.cellsPerNode = this->CellsPerNode;
  return s;
}
