#pragma once

#include <vtkSmartPointer.h>

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

class vtkDataObject;

/// What a scene hands from command to command instead of files.
namespace lamella::cli
{

/// Data under names such as `memory:fracture.vti`. To commands such a name is a file like any other: what reads and
/// writes files (GridFile.h, OutputFile.h, ResultFiles.h) looks here for it, and nothing touches the disk. So a scene
/// runs the very code of the command line.
///
/// There is one at a time, as there is one file system; outside of scenes there is none.
class Workspace
{
public:
  /// From here on names are looked up in this one.
  Workspace();
  ~Workspace();
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;

  /// The one that there is, or null.
  [[nodiscard]] static Workspace* current() noexcept;
  /// Is this such a name?
  [[nodiscard]] static bool holds(const std::filesystem::path& path);
  /// The name of data: "fracture" and ".vti" → "memory:fracture.vti".
  [[nodiscard]] static std::string nameOf(const std::string& data, const std::string& ending);

  /// Keeps data; what had the name goes. Arrays are shared, not copied.
  void put(const std::filesystem::path& name, vtkDataObject* data);
  /// Data of its own that shares the arrays: what the reader adds or takes away changes nothing here.
  /// @throws InputError when there is none such
  [[nodiscard]] vtkSmartPointer<vtkDataObject> get(const std::filesystem::path& name) const;
  [[nodiscard]] bool has(const std::filesystem::path& name) const;
  void clear();
  void erase(const std::filesystem::path& name);
  [[nodiscard]] std::vector<std::string> names() const;

  /// Told each state that a run comes to, where somebody waits for them; what it throws ends the run.
  std::function<void(vtkDataObject*)> onStep;
  /// Whether the command that runs need keep no state but the last.
  bool lastStateOnly = false;
  /// Arrays of states that somebody wants besides phases; nothing: all that there are.
  std::optional<std::set<std::string>> wantedArrays;
  [[nodiscard]] bool wants(const std::string& array) const { return !wantedArrays || wantedArrays->contains(array); }
  /// Wall time between two checkpoints of the command that runs [s].
  double checkpointSeconds = 0;
  /// JSON text that goes into the provenance of all that is made, or empty.
  std::string record;

private:
  std::map<std::string, vtkSmartPointer<vtkDataObject>> data_;
};

} // namespace lamella::cli
