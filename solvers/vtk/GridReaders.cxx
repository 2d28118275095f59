#include "GridReaders.h"

#include "vtkObjectFactory.h"
#include "vtkXMLDataParser.h"
#include "vtkXMLImageDataReader.h"
#include "vtkXMLPolyDataReader.h"

#include <dlfcn.h>

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

} // namespace lamella
