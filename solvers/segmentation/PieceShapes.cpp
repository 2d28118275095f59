#include "segmentation/PieceShapes.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>

namespace lamella::micrograph
{

namespace
{

/// How many pixels of a piece are at the picture's border.
int alongBorder(const cv::Mat& labels, int label, const cv::Rect& box)
{
  int count = 0;
  for (const int row : { 0, labels.rows - 1 })
    for (int x = box.x; x < box.br().x && row >= box.y && row < box.br().y; ++x)
      count += labels.at<int>(row, x) == label;
  for (const int x : { 0, labels.cols - 1 })
    for (int row = box.y; row < box.br().y && x >= box.x && x < box.br().x; ++row)
      count += labels.at<int>(row, x) == label;
  return count;
}

} // namespace

std::vector<PieceShape> pieceShapes(const cv::Mat& mask, std::int64_t least)
{
  cv::Mat labels;
  cv::Mat stats;
  cv::Mat centres;
  const int count = cv::connectedComponentsWithStats(mask, labels, stats, centres, 4, CV_32S);
  std::vector<PieceShape> all;
  std::vector<cv::Point> corners;
  std::vector<cv::Point> hull;
  for (int label = 1; label < count; ++label)
  {
    PieceShape piece;
    piece.area = stats.at<int>(label, cv::CC_STAT_AREA);
    if (piece.area < least)
      continue;
    piece.box = cv::Rect(stats.at<int>(label, cv::CC_STAT_LEFT), stats.at<int>(label, cv::CC_STAT_TOP),
      stats.at<int>(label, cv::CC_STAT_WIDTH), stats.at<int>(label, cv::CC_STAT_HEIGHT));
    const cv::Point end = piece.box.br();
    piece.cut = piece.box.x == 0 || piece.box.y == 0 || end.x == mask.cols || end.y == mask.rows;
    const bool through =
      (piece.box.x == 0 && end.x == mask.cols) || (piece.box.y == 0 && end.y == mask.rows); // from side to side
    piece.open = through || 6 * alongBorder(labels, label, piece.box) > 2 * (mask.cols + mask.rows);
    // The corners of the pixels, so that a square has a hull of its own area.
    corners.clear();
    for (int y = piece.box.y; y < end.y; ++y)
    {
      const int* const row = labels.ptr<int>(y);
      const int* const first = std::find(row + piece.box.x, row + end.x, label);
      if (first == row + end.x)
        continue;
      const int* last = row + end.x;
      while (*(last - 1) != label)
        --last;
      for (const int* const at : { first, last })
      {
        const auto x = static_cast<int>(at - row);
        corners.insert(corners.end(), { { x, y }, { x, y + 1 } });
      }
    }
    cv::convexHull(corners, hull);
    piece.solidity = static_cast<double>(piece.area) / std::max(1.0, cv::contourArea(hull));
    all.push_back(piece);
  }
  return all;
}

SideShape sideShape(const std::vector<PieceShape>& pieces)
{
  SideShape side;
  double area = 0;
  for (const PieceShape& piece : pieces)
  {
    const auto own = static_cast<double>(piece.area);
    area += own;
    side.compact += piece.solidity >= compactSolidity ? own : 0;
    side.largest = std::max(side.largest, own);
  }
  side.pieces = static_cast<std::int64_t>(pieces.size());
  side.compact /= std::max(1.0, area);
  side.largest /= std::max(1.0, area);
  return side;
}

} // namespace lamella::micrograph
