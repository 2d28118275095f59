#include "vtkMatrixBridges.h"

#include "Attempt.h"
#include "PackingData.h"
#include "vtkClassMacros.h"
#include "vtkLatticeConversion.h"
#include "vtkPieces.h"
#include "vtkProvenance.h"

#include "core/Error.h"
#include "packing/Bridges.h"

#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"

#include <fmt/format.h>

#include <cmath>

vtkStandardNewMacro(vtkMatrixBridges);
vtkPrintSettingsMacro(vtkMatrixBridges);

vtkMatrixBridges::vtkMatrixBridges() = default;

vtkInputTypeMacro(vtkMatrixBridges, "vtkPolyData");

bool vtkMatrixBridges::Cement(vtkPolyData* particles)
{
  if (this->Image != nullptr && this->MadeTime > this->GetMTime() && this->MadeTime > particles->GetMTime())
    return true;
  this->Image = nullptr;
  const lamella::Outcome outcome = lamella::attempt(this,
    [&]
    {
      const lamella::packing::Packing packing = lamella::packingFrom(particles);
      lamella::packing::BridgeOptions bridges;
      bridges.width = this->Width;
      bridges.reach = this->Reach;
      bridges.filled = this->Filled;
      bridges.walls = this->WallBridges;
      if (this->Saturation != 0)
        bridges.saturation = this->Saturation;
      lamella::packing::RasterOptions raster{ this->NodesAcross, this->Platen, this->Shares };
      if (this->Spacing != 0)
      {
        const double nodes = std::round(packing.size[0] / this->Spacing);
        if (!(nodes >= 2 && nodes <= 1e6))
          throw lamella::ParameterError(
            fmt::format("spacing {:g} makes {:g} nodes across a box of {:g} m", this->Spacing, nodes, packing.size[0]),
            "give a length that goes into it 2 to 1000000 times");
        raster.nodesAcross = static_cast<std::int64_t>(nodes);
      }
      this->Image = lamella::cementedImage(packing, bridges, raster, this->GetClassName());

      nlohmann::json parameters{ { "reach", this->Reach }, { "nodes_across", raster.nodesAcross },
        { "platen", this->Platen } };
      if (this->WallBridges)
        parameters["wall_bridges"] = true;
      if (this->Shares)
        parameters["shares"] = true;
      if (this->Filled)
        parameters["filled"] = true;
      else if (bridges.saturation)
        parameters["saturation"] = this->Saturation;
      else
        parameters["width"] = this->Width;
      for (const std::string& warning : lamella::fieldTexts(this->Image, "warnings"))
        vtkWarningMacro(<< warning);
      lamella::setProvenance(this->Image, lamella::provenance(particles));
      lamella::continueProvenance(this->Image, "bridges", parameters);
    });
  if (outcome != lamella::Outcome::Done)
  {
    this->Image = nullptr;
    return false;
  }
  this->MadeTime.Modified();
  return true;
}

int vtkMatrixBridges::RequestInformation(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  // The extent depends on the grains; whole on every rank.
  int port = 0;
  vtkAlgorithm* const producer = this->GetInputAlgorithm(0, 0, port);
  if (producer != nullptr && producer->UpdatePiece(0, 1, 0) == 0)
    return 0; // it has said what is wrong
  vtkPolyData* const particles = vtkPolyData::GetData(inputVector[0]);
  if (particles == nullptr || !this->Cement(particles))
    return 0;
  lamella::announce(outputVector->GetInformationObject(0), lamella::latticeOf(this->Image));
  return 1;
}

int vtkMatrixBridges::RequestUpdateExtent(vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector*)
{
  lamella::requestWhole(inputVector[0]->GetInformationObject(0));
  return 1;
}

int vtkMatrixBridges::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  if (!this->Cement(vtkPolyData::GetData(inputVector[0])))
    return 0;
  lamella::deliver(this->Image, outputVector->GetInformationObject(0));
  return 1;
}
