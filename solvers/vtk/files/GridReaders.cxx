#include "GridReaders.h"

#include "GridChecks.h"
#include "GridParser.h"
#include "vtkLatticeConversion.h"

#include "core/Error.h"
#include "core/Lower.h"

#include "vtkDataObject.h"
#include "vtkInformation.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkXMLImageDataReader.h"
#include "vtkXMLPolyDataReader.h"
#include "vtkXMLUnstructuredGridReader.h"

#include <filesystem>

namespace lamella
{

namespace
{

template <typename Base>
class CheckedReader : public Base
{
public:
  static CheckedReader* New() { VTK_STANDARD_NEW_BODY(CheckedReader); }

protected:
  void CreateXMLParser() override
  {
    if (this->XMLParser == nullptr) // else the reader's own complaint about that
    {
      GridParser* const parser = GridParser::New();
      parser->Kind = this->GetDataSetName();
      parser->Path = this->GetFileName() == nullptr ? "" : this->GetFileName();
      this->XMLParser = parser;
      return;
    }
    this->Base::CreateXMLParser();
  }
};

} // namespace

vtkSmartPointer<vtkXMLImageDataReader> newImageReader()
{
  return vtkSmartPointer<CheckedReader<vtkXMLImageDataReader>>::New();
}

vtkSmartPointer<vtkXMLPolyDataReader> newPolyDataReader()
{
  return vtkSmartPointer<CheckedReader<vtkXMLPolyDataReader>>::New();
}

vtkSmartPointer<vtkXMLUnstructuredGridReader> newUnstructuredGridReader()
{
  return vtkSmartPointer<CheckedReader<vtkXMLUnstructuredGridReader>>::New();
}

std::string endingOf(const char* fileName)
{
  if (fileName == nullptr || *fileName == '\0')
    throw InputError("no file is named", "set FileName");
  return endingOf(std::filesystem::path(fileName));
}

void readPolyData(const std::string& path, vtkPolyData* data)
{
  if (!std::filesystem::is_regular_file(path))
    throw InputError("there is no file '" + path + "'", "check the name and the folder");
  const auto reader = newPolyDataReader();
  reader->SetFileName(path.c_str());
  if (reader->CanReadFile(path.c_str()) == 0)
    throw InputError("'" + path + "' is not a whole .vtp file", "make or copy it again");
  requireReadable(reader, path);
  update(reader, path);
  data->ShallowCopy(reader->GetOutput());
}

std::optional<Lattice> latticeInFile(vtkXMLImageDataReader* reader)
{
  reader->UpdateInformation();
  vtkInformation* const information = reader->GetOutputInformation(0);
  int extent[6] = { 0, -1, 0, -1, 0, -1 };
  double origin[3] = { 0, 0, 0 };
  double spacing[3] = { 1, 1, 1 };
  if (information == nullptr || information->Has(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT()) == 0)
    return std::nullopt;
  information->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent);
  information->Get(vtkDataObject::ORIGIN(), origin);
  information->Get(vtkDataObject::SPACING(), spacing);
  if (reader->GetNumberOfPointArrays() == 0 || reader->GetNumberOfCellArrays() > 0)
    return std::nullopt;
  try
  {
    return latticeOf(extent, origin, spacing, Voxels::Any);
  }
  catch (const Error&)
  {
    return std::nullopt;
  }
}

} // namespace lamella
