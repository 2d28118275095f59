#include "files/GridFile.h"

#include "core/Lower.h"

#include "files/ArrayRanges.h"
#include "session/Workspace.h"

#include "GridChecks.h"
#include "GridReaders.h"
#include "vtkLatticeConversion.h"

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkDataObject.h>
#include <vtkDataSet.h>
#include <vtkErrorCode.h>
#include <vtkFieldData.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkLogger.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLImageDataReader.h>
#include <vtkXMLImageDataWriter.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLPolyDataWriter.h>
#include <vtkXMLUnstructuredGridReader.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <type_traits>
#include <utility>

namespace fs = std::filesystem;

namespace
{

/// Collects messages instead of printing them. Filters may report from several threads.
class MessageWindow : public vtkOutputWindow
{
public:
  static MessageWindow* New();
  vtkTypeMacro(MessageWindow, vtkOutputWindow);

  void DisplayText(const char*) override {}
  void DisplayErrorText(const char* text) override { this->Keep(this->Errors, text); }
  void DisplayWarningText(const char* text) override { this->Keep(this->Warnings, text); }
  void DisplayGenericWarningText(const char* text) override { this->Keep(this->Warnings, text); }
  void DisplayDebugText(const char*) override {}

  std::vector<std::string> Take(std::vector<std::string>& list)
  {
    const std::lock_guard<std::mutex> lock(this->Mutex);
    return std::exchange(list, {});
  }

  std::vector<std::string> Errors;
  std::vector<std::string> Warnings;

private:
  void Keep(std::vector<std::string>& list, const char* text)
  {
    // "ERROR: In file.cxx, line 12\nvtkClass (0x55): what happened\n\n": the last part is for people.
    std::string message = text == nullptr ? "" : text;
    if (const std::size_t line = message.find('\n'); message.find(", line ") < line && line != std::string::npos)
      message.erase(0, line + 1);
    if (const std::size_t end = message.find("): "); message.find(" (0x") < end && end != std::string::npos)
      message.erase(0, end + 3);
    while (!message.empty() && (message.back() == '\n' || message.back() == ' '))
      message.pop_back();
    const std::lock_guard<std::mutex> lock(this->Mutex);
    list.push_back(std::move(message));
  }

  std::mutex Mutex;
};
vtkStandardNewMacro(MessageWindow);

MessageWindow* window()
{
  return MessageWindow::SafeDownCast(vtkOutputWindow::GetInstance());
}

} // namespace

namespace lamella::cli
{

VtkMessages::VtkMessages()
  : before_(vtkOutputWindow::GetInstance())
  , verbosity_(vtkLogger::GetCurrentVerbosityCutoff())
{
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF); // it would print them as well
  vtkNew<MessageWindow> messages;
  vtkOutputWindow::SetInstance(messages);
}

VtkMessages::~VtkMessages()
{
  vtkOutputWindow::SetInstance(before_);
  vtkLogger::SetStderrVerbosity(static_cast<vtkLogger::Verbosity>(verbosity_));
}

std::vector<std::string> VtkMessages::takeErrors()
{
  MessageWindow* messages = window();
  return messages == nullptr ? std::vector<std::string>() : messages->Take(messages->Errors);
}

std::vector<std::string> VtkMessages::takeWarnings()
{
  MessageWindow* messages = window();
  return messages == nullptr ? std::vector<std::string>() : messages->Take(messages->Warnings);
}

void throwVtkErrors(const std::string& doing)
{
  const std::vector<std::string> errors = VtkMessages::takeErrors();
  std::string message = errors.empty() ? "no reason was given" : errors.front();
  std::string hint = "check the input with: lamella info FILE";
  // Our filters put the remedy on a second line or after "; hint: ".
  for (const char* mark : { "\nhint: ", "; hint: ", "\n" })
  {
    if (const std::size_t at = message.find(mark); at != std::string::npos)
    {
      hint = message.substr(at + std::strlen(mark));
      message.erase(at);
      break;
    }
  }
  // What VTK's classes and the standard library say where memory is short.
  for (const char* const words : { "bad_alloc", "Unable to allocate", "ailed to allocate" })
    if (message.find(words) != std::string::npos)
      throw MemoryError("there is not enough memory", "take a smaller --window or --refine, or free memory");
  throw InputError(doing.empty() ? message : doing + ": " + message, hint);
}

void requireFile(const std::string& path)
{
  if (Workspace::holds(path))
  {
    (void)Workspace::find(path);
    return;
  }
  std::error_code failed;
  const auto status = fs::status(path, failed);
  if (!fs::exists(status))
    throw InputError("there is no file '" + path + "'", "check the name and the folder");
  if (fs::is_directory(status))
    throw InputError("'" + path + "' is a folder, not a file", "give the name of a file in it");
  std::ifstream file(path, std::ios::binary);
  if (!file)
    throw InputError("cannot read '" + path + "': " + std::strerror(errno), "check its permissions");
  if (file.peek() == std::ifstream::traits_type::eof())
    throw InputError("'" + path + "' is empty", "the file holds no data at all: make or copy it again");
}

namespace
{

template <typename Reader>
vtkSmartPointer<vtkDataObject> read(const vtkSmartPointer<Reader>& reader, const std::string& path, const char* kind,
  [[maybe_unused]] const SizeKnown& sizeKnown = {})
{
  (void)VtkMessages::takeErrors();
  if (reader->CanReadFile(path.c_str()) == 0)
  {
    (void)VtkMessages::takeErrors();
    throw InputError("'" + path + "' is not a " + kind + " file, or is cut short",
      std::string("give a whole ") + kind + " file; make or copy it again");
  }
  reader->SetFileName(path.c_str());
  requireReadable(reader, path);
  if constexpr (std::is_same_v<Reader, vtkXMLImageDataReader>)
  {
    if (const auto lattice = sizeKnown ? latticeInFile(reader) : std::nullopt)
      sizeKnown(*lattice);
  }
  update(reader, path);
  return reader->GetOutput();
}

} // namespace

vtkSmartPointer<vtkDataObject> readGrid(const std::string& path, const SizeKnown& sizeKnown)
{
  if (Workspace::holds(path))
  {
    const auto data = Workspace::find(path);
    if (auto* const image = vtkImageData::SafeDownCast(data); image != nullptr && sizeKnown)
      sizeKnown(latticeOf(image, Voxels::Any));
    return data;
  }
  requireFile(path);
  if (endingOf(path) == ".vtp")
    return read(newPolyDataReader(), path, ".vtp");
  if (endingOf(path) == ".vtu")
    return read(newUnstructuredGridReader(), path, ".vtu");
  if (endingOf(path) == ".vti")
    return read(newImageReader(), path, ".vti", sizeKnown);
  throw InputError(
    "'" + path + "' is not a .vti or .vtp file", "make one first: lamella diffusion PICTURE ... -o FILE.vti");
}

namespace
{

void forgetRanges(vtkFieldData* data)
{
  for (int i = 0; i < data->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* array = data->GetAbstractArray(i);
    if (array->HasInformation())
    {
      array->GetInformation()->Remove(vtkDataArray::L2_NORM_RANGE());
      array->GetInformation()->Remove(vtkDataArray::L2_NORM_FINITE_RANGE());
    }
  }
}

} // namespace

OutputFile openGrid(const std::string& option, const std::string& name, const std::string& ending, bool overwrite)
{
  if (std::filesystem::path(name).extension() != ending)
    throw ParameterError(option + " '" + name + "': it is written as " + ending, "end the name in " + ending);
  return OutputFile(name, overwrite);
}

void forgetRanges(vtkDataObject* data)
{
  forgetRanges(data->GetFieldData());
  if (auto* set = vtkDataSet::SafeDownCast(data))
  {
    forgetRanges(set->GetPointData());
    forgetRanges(set->GetCellData());
  }
}

void writeGrid(vtkDataObject* data, const OutputFile& file)
{
  if (file.inMemory())
  {
    Workspace::keep(file.path(), data);
    return;
  }
  forgetRanges(data);
  (void)VtkMessages::takeErrors();
  const auto write = [&](auto& writer)
  {
    writer->SetInputDataObject(data);
    writer->SetDataModeToBinary();    // inline: GridReaders.h says why not appended
    writer->SetCompressorTypeToLZ4(); // a fifth of zlib's time for nearly its size
    if (writer->Write() != 1 || writer->GetErrorCode() != vtkErrorCode::NoError)
      file.failed();
  };
  if (vtkPolyData::SafeDownCast(data) != nullptr)
  {
    // By way of memory: when the disk is full, VTK 9.2's writer of inline poly data frees what it never allocated.
    vtkNew<vtkXMLPolyDataWriter> writer;
    writer->WriteToOutputStringOn();
    write(writer);
    file.write(writer->GetOutputString());
  }
  else if (vtkUnstructuredGrid::SafeDownCast(data) != nullptr)
  {
    vtkNew<vtkXMLUnstructuredGridWriter> writer;
    writer->WriteToOutputStringOn();
    write(writer);
    file.write(writer->GetOutputString());
  }
  else
  {
    vtkNew<vtkXMLImageDataWriter> writer;
    writer->SetFileName(file.temporary().c_str());
    write(writer);
  }
}

} // namespace lamella::cli
