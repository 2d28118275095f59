#pragma once

#include "convert/Volume.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

class vtkDataSet;

/// What pictures, raw volumes and tables cannot say for themselves, in one JSON object: a Record (Record.h) with more.
///
/// PNG and TIFF hold it as their description, others have a file beside them, NAME.json. Besides the keys of a record:
/// `image` (extent, spacing, origin, direction), `arrays` (name, type, components, unit, description, creator),
/// `fields` (field data by name: type, components, values).
namespace lamella::cli
{

/// The grey value that stands for each phase in such a file, where the only array of an image is its phases.
/// Empty: values are stored as they are.
[[nodiscard]] std::vector<std::uint8_t> greysFor(vtkImageData* image, const std::string& ending);

/// The notes of a grid, its provenance among them.
/// @param stored type of the values in the file (VTK_UNSIGNED_CHAR …), as they are in a raw volume
/// @param before of an image: the type that the values had before; 0: that of the array
[[nodiscard]] std::string notesOf(vtkDataSet* grid, const std::array<int, 6>& extent,
  const std::vector<std::uint8_t>& greys, int stored, int before = 0);

/// The notes beside a file; empty where there are none. @throws InputError for a file of that name that is no notes
[[nodiscard]] std::string notesBeside(const std::filesystem::path& file);

/// Does a text hold notes, or a record?
[[nodiscard]] bool isNotes(const std::string& text);

/// The values of a picture or raw volume with what its notes say: name, type, phases, place, field data.
/// Where the size in the notes is another one, the values stay as they are: the file was changed since.
[[nodiscard]] std::unique_ptr<Volume> withNotes(std::unique_ptr<Volume> values, const std::string& notes);

/// What notes say of the sizes and types of a raw volume.
struct RawNotes
{
  std::array<std::int64_t, 3> size{};
  int type = 0;
  int components = 1;
};
[[nodiscard]] std::optional<RawNotes> rawNotes(const std::string& notes);

/// What notes say of a table: field data for the grid that is made of it, its arrays, and of an image its place.
struct TableNotes
{
  struct Array
  {
    std::string name;
    int type = 0;
    int components = 1;
    std::string unit, description, creator;
  };
  std::vector<Array> arrays;
  int points = 0;                      ///< type of the places; 0: not said
  vtkSmartPointer<vtkImageData> image; ///< without arrays; none where the table was made of points
};
/// @param fields takes the field data
[[nodiscard]] TableNotes tableNotes(const std::string& notes, vtkDataSet* fields);

} // namespace lamella::cli
