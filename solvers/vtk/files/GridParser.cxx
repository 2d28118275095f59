#include "GridParser.h"

#include "XmlChecks.h"

#include "core/Error.h"

#include "vtkCallbackCommand.h"
#include "vtkCommand.h"
#include "vtkDataCompressor.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkXMLDataElement.h"

#include <dlfcn.h>

#include <new>
#include <string_view>

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
    set(parser, 0);
}

/// Keeps in mind, in the place of printing it, that somebody told of a fault.
void note(vtkObject* object, bool* failed)
{
  vtkNew<vtkCallbackCommand> command;
  command->SetClientData(failed);
  command->SetCallback([](vtkObject*, unsigned long, void* flag, void*) { *static_cast<bool*>(flag) = true; });
  object->AddObserver(vtkCommand::ErrorEvent, command);
}

bool isArray(vtkXMLDataElement* element)
{
  const std::string_view name = element->GetName() == nullptr ? "" : element->GetName();
  return name == "DataArray" || name == "Array";
}

/// Unit and text of an array, which describe() has put there.
bool isDescription(vtkXMLDataElement* key)
{
  const auto is = [&](const char* attribute, std::string_view value)
  { return key->GetAttribute(attribute) != nullptr && key->GetAttribute(attribute) == value; };
  return (is("name", "UNITS_LABEL") && is("location", "vtkDataArray")) ||
    (is("name", "FIELD_NAME") && is("location", "vtkDataObject"));
}

void dropOtherKeys(vtkXMLDataElement* element)
{
  for (int i = element->GetNumberOfNestedElements() - 1; i >= 0; --i)
  {
    vtkXMLDataElement* const nested = element->GetNestedElement(i);
    if (isArray(element) && !isDescription(nested))
      element->RemoveNestedElement(nested);
    else
      dropOtherKeys(nested);
  }
}

} // namespace

vtkStandardNewMacro(GridParser);

int GridParser::ParseXML() // Expat's parser is there by now and has read nothing
{
  parseAtOnce(this->Parser);
  return this->Superclass::ParseXML();
}

int GridParser::ParseBuffer(const char* buffer, unsigned int count)
{
  constexpr unsigned int deepest = 64; // elements are taken apart by functions that call themselves
  return this->NumberOfOpenElements <= deepest && this->Superclass::ParseBuffer(buffer, count) != 0 ? 1 : 0;
}

void GridParser::CharacterDataHandler(const char* data, int length)
{
  if (this->NumberOfOpenElements > 0 && !isArray(this->OpenElements[this->NumberOfOpenElements - 1]))
    this->Superclass::CharacterDataHandler(data, length);
}

GridParser::GridParser()
{
  note(this, &this->Failed);
}

void GridParser::SetCompressor(vtkDataCompressor* compressor)
{
  this->Superclass::SetCompressor(compressor);
  if (compressor != nullptr)
    note(compressor, &this->Failed); // LZMA tells of a fault and goes on
}

int GridParser::Parse()
{
  this->Fault = nullptr;
  this->Failed = false;
  try
  {
    if (this->Superclass::Parse() == 0)
    {
      const std::string ending = this->Kind == "ImageData" ? ".vti" : this->Kind == "PolyData" ? ".vtp" : ".vtu";
      throw lamella::InputError(
        "'" + this->Path + "' is a " + ending + " file that is damaged or cut short", "make or copy it again");
    }
    lamella::requireSoundXml(this, this->Kind, this->Path);
    dropOtherKeys(this->GetRootElement());
  }
  catch (const lamella::Error&)
  {
    this->Fault = std::current_exception();
    return 0;
  }
  catch (const std::bad_alloc&)
  {
    this->Fault = std::current_exception();
    return 0;
  }
  this->GetStream()->clear();
  return 1;
}
