#pragma once

#include "lattice/Phases.h"
#include "micrograph/Picture.h"
#include "micrograph/Segmentation.h"

#include "vtkLamellaSolversVTKModule.h" // for the export macro

#include "vtkSmartPointer.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

class vtkImageData;

namespace lamella
{

/// How a picture, volume or .vti file becomes phases.
struct PictureOptions
{
  micrograph::ReadOptions read;
  /// Finds lumens and walls in a raw scan; the grey map is not used then. The whole scan, before the window is cut.
  std::optional<micrograph::SegmentOptions> segment;
  GreyMap greys;                ///< none given: every grey value is a phase of its own, named by its value
  std::optional<Window> window; ///< cut out first, or when the scan has been segmented; not `read.window`
  int refine = 1;               ///< then each pixel into n × n
  std::string array;            ///< .vti: the array to read; empty: `phase`, else the first array of whole numbers
};

struct PhasePicture
{
  PhaseImage image;
  std::string pixelSizeSource;        ///< "option", what the file calls it, or "none" (spacing 1)
  std::vector<std::string> warnings;  ///< what a user should know, each one line
  vtkSmartPointer<vtkImageData> file; ///< a .vti read at its points, with all it holds, before the window; else null
};

/// Reads PNG, JPEG, TIFF, stacks, raw volumes (micrograph::readPicture) and VTK image files (.vti), with values at
/// points (nodes) or cells (a node is made of every cell; a file with both is read at the points unless `array` names a
/// cell array). A .vti file of phases keeps its names when no grey map is given.
/// @throws InputError, ParameterError, MemoryError
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT PhasePicture readPhases(
  const std::filesystem::path& path, const PictureOptions& options = {});

/// The same as grey values: what readPhases() looks at before it names phases.
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT micrograph::Picture readGreys(
  const std::filesystem::path& path, const micrograph::ReadOptions& options = {}, const std::string& array = {});

} // namespace lamella
