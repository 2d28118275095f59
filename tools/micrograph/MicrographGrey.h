#pragma once

#include "micrograph/MicrographOptions.h"

#include "pictures/Picture.h"

#include <vtkImageData.h>
#include <vtkSmartPointer.h>

#include <optional>
#include <string>
#include <vector>

namespace lamella::cli
{

/// A picture whose greys are smooth, or lumen's shares of the pixels.
struct GreyPicture
{
  vtkSmartPointer<vtkImageData> image;        ///< with the numbers at its points, the window alone
  std::string array;                          ///< their name
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
