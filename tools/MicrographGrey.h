#pragma once

#include "MicrographOptions.h"

#include "ContourField.h"
#include "micrograph/Picture.h"

#include <optional>
#include <string>
#include <vector>

namespace lamella::cli
{

/// A picture whose greys are smooth, or lumen's shares of the pixels, as outlines take it.
struct GreyPicture
{
  ContourField field;
  std::optional<micrograph::Picture> picture; ///< not of a .vti
  std::string pixelSizeSource;                ///< "none": not known
  std::string provenance;                     ///< of the file
  std::vector<std::string> warnings;
};

/// @throws ParameterError, InputError
[[nodiscard]] GreyPicture readGreyPicture(const MicrographOptions& options);

/// @throws InputError for a lattice of three dimensions
void refuseVolume(const Lattice& whole);

} // namespace lamella::cli
