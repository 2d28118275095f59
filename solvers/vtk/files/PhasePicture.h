#pragma once

#include "lattice/GreyRanges.h"
#include "lattice/Phases.h"
#include "pictures/Picture.h"
#include "pictures/PictureRecord.h"
#include "segmentation/Segmentation.h"
#include "segmentation/VolumeSegmentation.h"

#include "vtkLamellaSolversVTKModule.h" // for the export macro

#include "vtkSmartPointer.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
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
  GreyRanges greys; ///< none given: what the file calls its greys, else `unnamed`
  /// Told a picture whose phases neither the user nor the file names; throws to refuse it. Not given or returning:
  /// every grey value is a phase of its own, named by its value.
  std::function<void(const micrograph::Picture&)> unnamed;
  std::optional<Window> window; ///< cut out first, or when the scan has been segmented; not `read.window`
  int refine = 1;               ///< then each pixel into n × n
  std::string array;            ///< .vti: the array to read; empty: `phase`, else the first array of whole numbers
  vtkImageData* data = nullptr; ///< what stands in memory for a .vti file, its path a name alone
};

/// A sample as the solvers take it: window cut out, greys named.
struct PhasePicture
{
  PhaseImage image;
  std::array<std::int64_t, 3> fileSize{}; ///< before the window
  std::optional<Window> window;
  std::string pixelSizeSource;                           ///< "option", what the file calls it, or "none" (spacing 1)
  std::vector<std::string> warnings;                     ///< what a user should know, each one line
  std::vector<std::string> notes;                        ///< how its greys were parted, a line a step
  std::optional<micrograph::SegmentReport> segmentation; ///< of a picture
  std::optional<micrograph::VolumeReport> volumeSegmentation; ///< of a volume
  /// How far surfaces between phases may lie from where they were put, in the image's pixels, where that is known.
  std::optional<double> surfaceDoubt;
  std::string provenance;             ///< of the file, where it carries one: JSON text
  vtkSmartPointer<vtkImageData> file; ///< a .vti read at its points, with all it holds, before the window; else null
};

/// Reads pictures, stacks, raw volumes, MetaImage and NRRD (micrograph::readPicture) and VTK image files (.vti), with
/// values at points (nodes) or cells (a node is made of every cell; a file with both is read at the points unless
/// `array` names a cell array). A .vti file of phases and a picture that lamella wrote keep their names when no greys
/// are named.
/// @throws InputError, ParameterError, MemoryError
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT PhasePicture readPhases(
  const std::filesystem::path& path, const PictureOptions& options = {});

/// The grey values of a picture, volume or .vti, with what lamella recorded in it, if lamella wrote it.
struct PictureFile
{
  micrograph::Picture picture; ///< its pixel size exact where the record tells it
  std::optional<micrograph::PictureRecord> record;
  vtkSmartPointer<vtkImageData> file; ///< as that of PhasePicture
};
/// What readPhases() looks at before it names phases.
/// @param data as that of PictureOptions
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT PictureFile readPictureFile(const std::filesystem::path& path,
  micrograph::ReadOptions options = {}, const std::string& array = {}, vtkImageData* data = nullptr);

/// Gives an image what else the file that it was made from holds of its nodes. A finer lattice gets what belongs to the
/// pixel as the phase does, its grain and the direction of its wall, and no fields, which were solved on the coarser
/// one.
/// @param window of the file that the image shows
/// @param refine pixels were split in so many along each axis
/// @param names of arrays; empty: all
VTKLAMELLASOLVERSVTK_EXPORT void carryAlong(vtkImageData* image, vtkImageData* file,
  const std::optional<Window>& window, int refine, const std::vector<std::string>& names = {});

} // namespace lamella
