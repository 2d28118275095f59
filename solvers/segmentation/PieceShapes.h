#pragma once

#include "segmentation/SegmentTypes.h"

#include <opencv2/core.hpp>

#include <cstdint>
#include <vector>

namespace lamella::micrograph
{

/// A piece of a mask, connected through faces.
struct PieceShape
{
  std::int64_t area = 0; ///< [pixels]
  double solidity = 1;   ///< its area over that of its convex hull
  bool cut = false;      ///< touches the picture's border
  bool open = false;     ///< along more than a sixth of the border, or from one side to the opposite one
  cv::Rect box;
};

/// All pieces of at least so many pixels.
[[nodiscard]] std::vector<PieceShape> pieceShapes(const cv::Mat& mask, std::int64_t least);

/// What is said of one side of a threshold: cells are compact pieces, what surrounds them hangs together.
struct SideShape
{
  double compact = 0; ///< share of its area in pieces whose solidity is at least `compactSolidity`
  double largest = 0; ///< share of its area in the largest piece
  std::int64_t pieces = 0;
};

[[nodiscard]] SideShape sideShape(const std::vector<PieceShape>& pieces);

} // namespace lamella::micrograph
