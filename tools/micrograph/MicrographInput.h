#pragma once

#include "micrograph/MicrographOptions.h"

#include "outlines/Contour.h"
#include "pictures/Picture.h"
#include "segmentation/Segmentation.h"

#include <vtkImageData.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lamella::cli
{

class Session;

enum class MicrographKind
{
  Scan,
  Labels,
  Polygons,
  Grey ///< a picture whose greys are smooth, or shares
};

/// A file as outlines, with what they were made from.
struct Micrograph
{
  MicrographKind kind = MicrographKind::Scan;
  vtkSmartPointer<vtkPolyData> outlines;
  vtkSmartPointer<vtkImageData> picture; ///< that they were found in; null of polygons
  micrograph::ContourSet contours;       ///< the outlines
  double pixel = 0;                      ///< [m]; 0: there are no pixels
  std::string pixelSizeSource;
  std::array<std::int64_t, 3> size{}; ///< pixels, after the window
  double unit = 0;                    ///< of polygons [m]
  std::optional<micrograph::Picture> scan;
  std::shared_ptr<const PhaseImage> labels;
  std::optional<micrograph::SegmentReport> segmentation;
  std::vector<micrograph::Mark> marks; ///< in pixels of the window
  std::string provenance;              ///< of the file
  std::vector<std::string> warnings;
};

/// @throws ParameterError, InputError, MemoryError
[[nodiscard]] Micrograph loadMicrograph(Session& session, const MicrographOptions& options);

/// .json, .json.gz or .vtp
[[nodiscard]] bool isOutlineFile(const std::string& path);

} // namespace lamella::cli
