#pragma once

#include "convert/Formats.h"
#include "files/JsonReport.h"
#include "session/Session.h"

#include "io/Provenance.h"

#include <vtkDataObject.h>
#include <vtkSmartPointer.h>

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

/// Conversions as `lamella convert` and Python's `lamella.convert` make them.
namespace lamella::cli
{

/// What is to be done: the settings of vtkFileConverter.
struct ConversionWords
{
  RawOptions raw; ///< the file and what is said of pictures and raw volumes
  std::string output;
  std::vector<std::string> arrays; ///< empty: all
  std::optional<int> step;         ///< else all
  std::string type;                ///< of numbers; empty: as they are
  std::optional<std::array<double, 2>> range;
  std::vector<std::string> phases; ///< whose surface is wanted in place of the volume
  int smoothing = 0;               ///< iterations, of that surface
  bool lossy = false;
  bool overwrite = false;
};

struct Converted
{
  Json report; ///< what docs/commands/convert.md lists, but for the keys of the run
  io::Provenance run;
};

/// Reads a file, or takes data, and writes files: all of them, or none.
/// @param command for the record
/// @param data instead of FILE, which then is what messages call it; null: FILE is read
/// @throws ParameterError, InputError, MemoryError, OutputError; Cancelled
[[nodiscard]] Converted convert(
  Session& session, const ConversionWords& words, const std::string& command, vtkDataObject* data = nullptr);

struct Loaded
{
  vtkSmartPointer<vtkDataObject> data; ///< an image, poly data, an unstructured grid or a table
  std::size_t steps = 1;               ///< that the source has
  std::vector<double> times;           ///< of all of them, where the source tells them
};

/// One step as data in memory, with its own provenance. -o is not looked at. @throws as convert()
[[nodiscard]] Loaded load(Session& session, const ConversionWords& words);

} // namespace lamella::cli
