#pragma once

#include <opencv2/core.hpp>

#include <cstdint>
#include <vector>

namespace lamella::micrograph
{

/// Masks are CV_8U, 255 inside and 0 outside, unless said otherwise.
struct Pieces
{
  cv::Mat labels;                 ///< CV_32S; 0 is what the mask leaves out
  std::vector<std::int64_t> area; ///< [pixels], by label
  std::vector<bool> enclosed;     ///< does not touch the border, by label
};

/// Pieces of a mask, connected through faces, or through corners too.
[[nodiscard]] Pieces piecesOf(const cv::Mat& mask, bool corners);

/// How many pieces of at least 30 pixels do not touch the border.
[[nodiscard]] std::int64_t enclosedPieces(const cv::Mat& mask);

/// Clears pieces of a mask smaller than a limit.
/// @return how many there were
std::int64_t clearSmall(cv::Mat& mask, std::int64_t smallest, bool corners, bool enclosedOnly, std::int64_t& changed);

/// Mean length of the runs of a mask (CV_32F, 0 or 1) along rows and columns.
[[nodiscard]] double meanRun(const cv::Mat& mask);

/// Moves the outline outwards by so many pixels, inwards if negative.
void growBy(cv::Mat& mask, double pixels);

/// Opens every piece by a disk: necks and cracks narrower than the disk close, and what hung together through them
/// alone comes apart. The disk is never wider than a quarter of the piece, so that no piece vanishes for being small.
/// @param radius [pixels]
/// @return how many pixels left the mask
std::int64_t openPieces(cv::Mat& mask, double radius);

} // namespace lamella::micrograph
