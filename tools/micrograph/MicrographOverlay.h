#pragma once

#include "outlines/Contour.h"
#include "pictures/Picture.h"
#include "segmentation/SegmentTypes.h"

#include <vtkImageData.h>

#include <vector>

namespace lamella::cli
{

/// What is drawn over a micrograph. Null or empty: not there.
struct OverlayParts
{
  const micrograph::ContourSet* contours = nullptr;
  const micrograph::Picture* scan = nullptr; ///< of the same picture; else lumens white, walls grey
  vtkImageData* lattice = nullptr;           ///< of them, as vtkMicrographLattice makes it
  bool lamella = false;                      ///< it has a middle lamella
  double wall = 0;                           ///< median thickness of the walls [m]
  std::vector<bool> vessel;                  ///< by lumen − 1
  bool cells = true;                         ///< the large lumens are called vessels
  std::vector<micrograph::Mark> marks;
  double pixel = 0; ///< of the marks [m]
  int width = 0;    ///< of the picture [pixels]; 0: as fits
};

/// Pixels across that a picture of this size is drawn with.
[[nodiscard]] int overlayWidth(const OverlayParts& parts);

/// The picture with lamella and vessels tinted, outlines and strokes along the walls, and below it a scale bar and what
/// the colours mean. Lines are as wide as the picture's size asks for, and drawn at twice the resolution.
[[nodiscard]] micrograph::Picture drawOverlay(const OverlayParts& parts);

} // namespace lamella::cli
