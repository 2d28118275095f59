#include "GridReaders.h"

#include "GridChecks.h"
#include "vtkLatticeConversion.h"

#include "lattice/Error.h"

#include "vtkCallbackCommand.h"
#include "vtkDataObject.h"
#include "vtkInformation.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkXMLDataParser.h"
#include "vtkXMLImageDataReader.h"
#include "vtkXMLPolyDataReader.h"
#include "vtkXMLUnstructuredGridReader.h"

#include <dlfcn.h>

#include <algorithm>

#include <filesystem>

namespace lamella
{

namespace
{

/// Tells Expat to parse what it has; a release that always did so has no such function.
void parseAtOnce(void* parser)
{
  using Setter = unsigned char (*)(void* parser, unsigned char enabled);
  static const auto set = []() -> Setter
  {
    void* const expat = ::dlopen("libexpat.so.1", RTLD_LAZY | RTLD_NOLOAD); // VTK has loaded it
    return expat != nullptr ? reinterpret_cast<Setter>(::dlsym(expat, "XML_SetReparseDeferralEnabled")) : nullptr;
  }();
  if (set != nullptr)
  {
    set(parser, 0);
  }
}

class PromptParser : public vtkXMLDataParser
{
public:
  static PromptParser* New();
  vtkTypeMacro(PromptParser, vtkXMLDataParser);

protected:
  int ParseXML() override // Expat's parser is there by now and has read nothing
  {
    parseAtOnce(this->Parser);
    return this->Superclass::ParseXML();
  }
};
vtkStandardNewMacro(PromptParser);

template <typename Base>
class PromptReader : public Base
{
public:
  static PromptReader* New() { VTK_STANDARD_NEW_BODY(PromptReader); }

protected:
  void CreateXMLParser() override
  {
    if (this->XMLParser == nullptr) // else the reader's own complaint about that
    {
      this->XMLParser = PromptParser::New();
      return;
    }
    this->Base::CreateXMLParser();
  }
};

} // namespace

vtkSmartPointer<vtkXMLImageDataReader> newImageReader()
{
  return vtkSmartPointer<PromptReader<vtkXMLImageDataReader>>::New();
}

vtkSmartPointer<vtkXMLPolyDataReader> newPolyDataReader()
{
  return vtkSmartPointer<PromptReader<vtkXMLPolyDataReader>>::New();
}

vtkSmartPointer<vtkXMLUnstructuredGridReader> newUnstructuredGridReader()
{
  return vtkSmartPointer<PromptReader<vtkXMLUnstructuredGridReader>>::New();
}

std::string endingOf(const char* fileName)
{
  if (fileName == nullptr || *fileName == '\0')
  {
    throw InputError("no file is named", "set FileName");
  }
  std::string ending = std::filesystem::path(fileName).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  return ending;
}

void readPolyData(const std::string& path, vtkPolyData* data)
{
  if (!std::filesystem::is_regular_file(path))
  {
    throw InputError("there is no file '" + path + "'", "check the name and the folder");
  }
  const auto reader = newPolyDataReader();
  vtkNew<vtkCallbackCommand> silence; // said in our words
  silence->SetCallback([](vtkObject*, unsigned long, void*, void*) {});
  reader->AddObserver(vtkCommand::ErrorEvent, silence);
  reader->SetFileName(path.c_str());
  if (reader->CanReadFile(path.c_str()) == 0)
  {
    throw InputError("'" + path + "' is not a whole .vtp file", "make or copy it again");
  }
  requireReadable(reader, path);
  reader->Update();
  requireSoundCells(reader->GetOutput(), path);
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
  {
    return std::nullopt;
  }
  information->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent);
  information->Get(vtkDataObject::ORIGIN(), origin);
  information->Get(vtkDataObject::SPACING(), spacing);
  if (reader->GetNumberOfPointArrays() == 0 || reader->GetNumberOfCellArrays() > 0)
  {
    return std::nullopt;
  }
  try
  {
    return latticeOf(extent, origin, spacing);
  }
  catch (const Error&)
  {
    return std::nullopt;
  }
}

} // namespace lamella
