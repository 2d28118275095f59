#pragma once

#include "convert/RawFile.h"
#include "convert/VtkFiles.h"
#include "session/OutputFile.h"

#include <string>
#include <vector>

/// The formats of `lamella convert`: what each can hold, and how it is read and written. A new format is a line of the
/// table in Formats.cpp.
namespace lamella::cli
{

/// What the command line says about reading.
struct Reading
{
  RawOptions raw;                  ///< with what is said of pictures: FILE, --pixel-size
  std::vector<std::string> arrays; ///< --array; empty: all
  bool lossy = false;
  std::vector<std::string> warnings{};
};

/// What a file can hold.
enum Kind : unsigned
{
  Picture2D = 1,
  Volume3D = 2,
  Image = Picture2D | Volume3D,
  Poly = 4,
  Mesh = 8,
  Points = Poly | Mesh,
  Numbers = 16, ///< without a place
  Surface = 32  ///< polygons and nothing else
};

/// A step that is to be written, and where. Files stand in the order of Format::files.
struct Writing
{
  Session& session;
  Step& step;
  std::vector<OutputFile>& files;
};

struct Format
{
  const char* name;
  std::vector<std::string> endings;
  unsigned reads;     ///< kinds
  unsigned writes;    ///< kinds
  const char* values; ///< types, in words
  bool manyArrays;
  bool slabs;        ///< images may be larger than memory
  bool slices;       ///< a volume takes a file a layer
  const char* where; ///< names, units, place, field data and provenance are kept: in the file, or beside it
  /// Can it hold arrays of this type, with so many values a pixel or point?
  bool (*holds)(int type, int components);
  Step (*open)(const std::string& path, Reading& reading); ///< null: only written
  /// The files that one step takes: the named one first.
  std::vector<std::string> (*files)(const std::string& output, Step& step);
  void (*write)(const Writing& writing);
};

[[nodiscard]] const std::vector<Format>& formats();

/// By the ending of a name. @throws ParameterError, which says what was probably meant, when there is none
[[nodiscard]] const Format& formatOf(const std::string& option, const std::string& path);

/// The table of formats as Markdown.
[[nodiscard]] std::string formatsText();

/// NAME with a number in place of its %d; the name itself where it has none.
[[nodiscard]] std::string numbered(const std::string& pattern, std::size_t number);
[[nodiscard]] bool isPattern(const std::string& name);

} // namespace lamella::cli
