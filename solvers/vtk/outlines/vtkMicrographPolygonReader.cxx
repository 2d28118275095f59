#include "vtkMicrographPolygonReader.h"

#include "Attempt.h"
#include "ContourData.h"
#include "FieldNumbers.h"
#include "GridReaders.h"
#include "vtkClassMacros.h"
#include "vtkLatticeConversion.h"
#include "vtkPieces.h"
#include "vtkProvenance.h"

#include "core/Error.h"
#include "outlines/ContourEdit.h"
#include "outlines/PolygonFile.h"

#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string>

vtkStandardNewMacro(vtkMicrographPolygonReader);
vtkPrintSettingsMacro(vtkMicrographPolygonReader);

vtkMicrographPolygonReader::vtkMicrographPolygonReader()
{
  this->SetNumberOfInputPorts(0);
  this->SetNumberOfOutputPorts(2);
}

vtkMicrographPolygonReader::~vtkMicrographPolygonReader()
{
  this->SetFileName(nullptr);
}

vtkGetOutputMacro(vtkMicrographPolygonReader, Cells, vtkPolyData, 1);
vtkAllInFirstPieceMacro(vtkMicrographPolygonReader);

bool vtkMicrographPolygonReader::HasWindow() const
{
  return std::any_of(
    this->Window, this->Window + 4, [](double edge) { return edge != 0; });
}

void vtkMicrographPolygonReader::Crop(vtkPolyData* lumens)
{
  // The window is in the file's coordinates, in which the picture lies at its corner.
  const std::array<double, 3> corner = lamella::cornerOf(lumens);
  const std::array<double, 2> low{ this->Window[0] - corner[0], this->Window[1] - corner[1] };
  const std::array<double, 2> high{ this->Window[2] - corner[0], this->Window[3] - corner[1] };
  const auto part = lamella::toPolyData(lamella::micrograph::cropContours(lamella::contoursFrom(lumens), low, high),
    this->GetClassName(), { this->Window[0], this->Window[1], corner[2] });
  lamella::setProvenance(part, lamella::provenance(lumens));
  lamella::continueProvenance(part, "window", { { "window", this->Window } });
  lumens->ShallowCopy(part);
}

void vtkMicrographPolygonReader::Filter(vtkPolyData* lumens)
{
  namespace micrograph = lamella::micrograph;
  const micrograph::LumenFilter filter{ micrograph::areaOfCircle(this->LeastDiameter), this->LeastSolidity };
  if (filter.smallestArea == 0 && filter.leastSolidity == 0)
    return;
  const micrograph::ContourSet left = micrograph::filterLumens(lamella::contoursFrom(lumens), filter);
  if (left.contours.empty())
  {
    throw lamella::InputError(
      std::string("no lumen of '") + this->FileName + "' is left", "lower the least diameter or the least solidity");
  }
  const auto part = lamella::toPolyData(left, this->GetClassName(), lamella::cornerOf(lumens));
  lamella::setProvenance(part, lamella::provenance(lumens));
  lamella::continueProvenance(
    part, "filter", { { "least_diameter", this->LeastDiameter }, { "least_solidity", this->LeastSolidity } });
  for (const double unit : lamella::fieldNumbers(lumens, "unit"))
    lamella::setFieldNumbers(part, "unit", std::array{ unit });
  lumens->ShallowCopy(part);
}

void vtkMicrographPolygonReader::Read(vtkPolyData* lumens, vtkPolyData* cells)
{
  const std::string ending = lamella::endingOf(this->FileName);
  const std::filesystem::path path(this->FileName);
  if (ending == ".vtp")
  {
    lamella::readPolyData(this->FileName, lumens);
    try
    {
      this->HasWindow() ? this->Crop(lumens) : static_cast<void>(lamella::contoursFrom(lumens));
    }
    catch (const lamella::InputError& error)
    {
      throw lamella::InputError("'" + path.string() + "': " + error.what(), error.hint());
    }
    return;
  }
  lamella::micrograph::PolygonReadOptions options;
  nlohmann::json parameters{ { "y_down", this->YDown } };
  if (this->Unit != 0)
    options.unit = this->Unit;
  if (this->HasWindow())
  {
    options.window.emplace();
    std::copy_n(this->Window, 4, options.window->begin());
    parameters["window"] = this->Window;
  }
  options.yDown = this->YDown;
  const lamella::micrograph::PolygonFile file = lamella::micrograph::readPolygons(path, options);
  parameters["unit"] = file.unit;
  for (const std::string& warning : file.warnings)
    vtkWarningMacro(<< warning);
  lumens->ShallowCopy(lamella::toPolyData(file.lumens, this->GetClassName()));
  lamella::setFieldNumber(lumens, "unit", file.unit, "m", "one unit of the file's coordinates", this->GetClassName());
  lamella::beginProvenance(lumens, "polygons", parameters, {}, path);
  if (file.cells)
  {
    cells->ShallowCopy(lamella::toPolyData(*file.cells, this->GetClassName()));
    lamella::setProvenance(cells, lamella::provenance(lumens));
  }
}

int vtkMicrographPolygonReader::RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  vtkPolyData* const lumens = vtkPolyData::GetData(outputVector, 0);
  vtkPolyData* const cells = vtkPolyData::GetData(outputVector, 1);
  lumens->Initialize();
  cells->Initialize();
  if (!lamella::isFirstPiece(outputVector))
    return 1;
  if (lamella::attempt(this,
        [&]
        {
          this->Read(lumens, cells);
          this->Filter(lumens);
        }) != lamella::Outcome::Done)
  {
    lumens->Initialize();
    cells->Initialize();
    return 0;
  }
  return 1;
}
