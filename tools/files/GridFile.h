#pragma once

#include "lattice/Phases.h"
#include "session/OutputFile.h"

#include <vtkSmartPointer.h>

#include <functional>
#include <string>
#include <vector>

class vtkDataObject;
class vtkOutputWindow;

/// VTK's files, with what VTK says about them turned into exceptions.
namespace lamella::cli
{

/// Keeps what VTK would print while it lives: its errors become ours. There is one at a time; main() makes one before
/// anything of VTK.
class VtkMessages
{
public:
  VtkMessages();
  /// VTK prints again as it did.
  ~VtkMessages();
  VtkMessages(const VtkMessages&) = delete;
  VtkMessages& operator=(const VtkMessages&) = delete;
  /// Errors since the last call, one line each, without VTK's file names and addresses.
  [[nodiscard]] static std::vector<std::string> takeErrors();
  [[nodiscard]] static std::vector<std::string> takeWarnings();

private:
  vtkSmartPointer<vtkOutputWindow> before_;
  int verbosity_; ///< of VTK's logger
};

/// What a VTK class said went wrong, as an error of ours; its hint is kept where the message holds one.
/// @throws InputError always
[[noreturn]] void throwVtkErrors(const std::string& doing);

/// Refuses a file that is missing, a folder, empty or unreadable. @throws InputError
void requireFile(const std::string& path);

/// Told the size of a file before its values are read; throws to refuse it.
using SizeKnown = std::function<void(const Lattice& whole)>;

/// @param sizeKnown of a .vti
/// @throws InputError for anything that is not a whole .vti or .vtp file; what `sizeKnown` throws
[[nodiscard]] vtkSmartPointer<vtkDataObject> readGrid(const std::string& path, const SizeKnown& sizeKnown = {});

/// The same where it must be of one kind.
/// @param wanted what the message says that the file does not hold
/// @throws InputError
template <typename Grid>
[[nodiscard]] vtkSmartPointer<Grid> readAs(const std::string& path, const char* wanted, const char* hint)
{
  vtkSmartPointer<Grid> grid = Grid::SafeDownCast(readGrid(path));
  if (grid == nullptr)
    throw InputError("'" + path + "' holds no " + wanted, hint);
  return grid;
}

/// A file to write a grid to. @throws ParameterError for another ending; OutputError
[[nodiscard]] OutputFile openGrid(
  const std::string& option, const std::string& name, const std::string& ending, bool overwrite);

/// Writes .vti or .vtp: binary, compressed. @throws OutputError when the disk is full or fails
void writeGrid(vtkDataObject* data, const OutputFile& file);

} // namespace lamella::cli
