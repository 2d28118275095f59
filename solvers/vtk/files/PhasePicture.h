#pragma once

#include "lattice/GreyRanges.h"
#include "lattice/Phases.h"
#include "pictures/Picture.h"
#include "segmentation/Segmentation.h"
#include "segmentation/VolumeSegmentation.h"

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
  /// Finds phases in a raw scan. Of a picture lumens and walls, in the whole scan, before the window is cut; `greys`
  /// has to be empty then. Of a volume void and solid, or what `greys` names, in the window
  /// (micrograph::segmentVolume); of these options `lumen` and `threshold` count there.
  std::optional<micrograph::SegmentOptions> segment;
  GreyRanges greys;             ///< none given: every grey value is a phase of its own, named by its value
  std::optional<Window> window; ///< cut out first, or when the scan has been segmented; not `read.window`
  int refine = 1;               ///< then each pixel into n × n
  std::string array;            ///< .vti: the array to read; empty: `phase`, else the first array of whole numbers
};

struct PhasePicture
{
  PhaseImage image;
  std::string pixelSizeSource;        ///< "option", what the file calls it, or "none" (spacing 1)
  std::vector<std::string> warnings;  ///< what a user should know, each one line
  std::vector<std::string> notes;     ///< how its greys were parted, a line a step
  vtkSmartPointer<vtkImageData> file; ///< a .vti read at its points, with all it holds, before the window; else null
};

/// Reads pictures, stacks, raw volumes, MetaImage and NRRD (micrograph::readPicture) and VTK image files (.vti), with
/// values at points (nodes) or cells (a node is made of every cell; a file with both is read at the points unless
/// `array` names a cell array). A .vti file of phases keeps its names when no grey map is given.
/// @throws InputError, ParameterError, MemoryError
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT PhasePicture readPhases(
  const std::filesystem::path& path, const PictureOptions& options = {});

/// The same as grey values: what readPhases() looks at before it names phases.
/// @param file where to put a .vti that is read at its points, with all it holds; may be null
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT micrograph::Picture readGreys(const std::filesystem::path& path,
  const micrograph::ReadOptions& options = {}, const std::string& array = {},
  vtkSmartPointer<vtkImageData>* file = nullptr);

/// Gives an image what else the file that it was made from holds of its nodes. A finer lattice gets what belongs to the
/// pixel as the phase does, its grain and the direction of its wall, and no fields, which were solved on the coarser
/// one.
/// @param window of the file that the image shows
/// @param refine pixels were split in so many along each axis
/// @param names of arrays; empty: all
VTKLAMELLASOLVERSVTK_EXPORT void carryAlong(vtkImageData* image, vtkImageData* file,
  const std::optional<Window>& window, int refine, const std::vector<std::string>& names = {});

} // namespace lamella
