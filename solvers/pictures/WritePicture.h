#pragma once

#include "lattice/Phases.h"
#include "pictures/Picture.h"

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace lamella::micrograph
{

/// Writes phases as greys: PNG (.png) in 2D, TIFF (.tif, .tiff; packed without loss) in 2D or, one page a slice, in 3D.
/// Pixel size and description go into the file (PNG: pHYs and Description; TIFF: resolution and ImageDescription), so
/// that readPicture() gives the same lattice back, to 1e-7 of the spacing.
/// @param grey a grey for each phase id; as many as image.phases.size(). Empty: spread evenly over 0 … 255 by id.
/// @param hasPixelSize false leaves the pixel size out (a lattice of spacing 1 that stands for "unknown")
/// @throws ParameterError for an ending other than these, greys that are missing or alike; Error as writeWhole() of
/// core/WholeFile.h
void writeLabels(const PhaseImage& image, const std::filesystem::path& path, std::span<const std::uint8_t> grey = {},
  std::string_view description = {}, bool hasPixelSize = true);

/// Writes a picture as PNG of 8 or 16 bits, in colour where it has any; pixel size (unless its source is "none") and
/// description as writeLabels().
/// @param effort of packing, 0 to 9: 1 is several times as fast as 9
/// @throws ParameterError for another ending or a volume; Error as writeWhole()
void writePicture(
  const Picture& picture, const std::filesystem::path& path, std::string_view description = {}, int effort = 9);

} // namespace lamella::micrograph
