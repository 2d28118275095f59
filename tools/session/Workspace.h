#pragma once

#include <vtkSmartPointer.h>

#include <filesystem>
#include <map>
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

  /// Of the one that there is: what put() and get() do.
  static void keep(const std::filesystem::path& name, vtkDataObject* data);
  [[nodiscard]] static vtkSmartPointer<vtkDataObject> find(const std::filesystem::path& name);
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

private:
  std::map<std::string, vtkSmartPointer<vtkDataObject>> data_;
};

} // namespace lamella::cli
