#pragma once

#include "convert/Volume.h"
#include "session/OutputFile.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

/// Pictures, folders and patterns of pictures, TIFF files of several pages: as images of grey values or colours.
namespace lamella::cli
{

struct PictureReading
{
  std::optional<double> pixelSize; ///< wins over what the file says
  bool lossy = false;              ///< transparency may be left out, gaps in a stack closed
  std::vector<std::string> warnings{};
};

/// Opens a picture or a stack: grey values (`grey`) or red, green and blue (`colour`) as many bits as the file has, or
/// what its notes say (Notes.h). A picture is turned upright, a stack keeps the order of its file.
/// @throws InputError: missing, damaged; slices of different sizes or kinds; what would be lost unless `lossy`
[[nodiscard]] std::unique_ptr<Volume> openPictures(const std::string& path, PictureReading& reading);

/// Can PNG hold values of this type, and so many a pixel?
[[nodiscard]] bool pngHolds(int type, int components);

/// Writes a PNG, or of a volume one a layer. @param files as many as there are layers
/// @throws OutputError; Cancelled
void writePngs(Session& session, Volume& volume, std::vector<OutputFile>& files, const std::string& notes);

} // namespace lamella::cli
