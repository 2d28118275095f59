#pragma once

#include "outlines/ContourEdges.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

/// Internal: what edges leave in the cells of a grid that they pass through.
namespace lamella::micrograph
{

/// Cells of side 1 over a box of nx × ny; along an axis that is shifted they are centred between nodes, so that there
/// is one more of them and the first and last are half as wide.
struct CellFrame
{
  std::array<std::int64_t, 2> size{ 0, 0 };
  std::array<double, 2> shift{ 0, 0 }; ///< added to a position; 0 or ½
  std::array<double, 2> low{ 0, 0 };   ///< of the box, shifted
  std::array<double, 2> high{ 0, 0 };

  CellFrame(std::int64_t nx, std::int64_t ny, int shiftedAxis = -1);
  [[nodiscard]] double begin(int axis, std::int64_t cell) const noexcept
  {
    return cell == 0 ? low[axis] : static_cast<double>(cell);
  }
  [[nodiscard]] double end(int axis, std::int64_t cell) const noexcept
  {
    return cell + 1 == size[axis] ? high[axis] : static_cast<double>(cell + 1);
  }
};

/// Sums over the edges in a cell. A point's side is known from the edges to its left: going right along a row,
/// `cover` adds up to the lumen's share of the height, and `area` is what the cell's own edges add in the cell.
struct CellSum
{
  double cover = 0;
  double area = 0;
  Point normal{ 0, 0 }; ///< integral of the unit normal, from lumen to wall, along the outline
  double length = 0;    ///< of the outline
  bool cut = false;     ///< an outline passes, not only an edge along the border
};

/// Share of lumen along straight lines through the cells, parallel to an axis, at given places across it.
struct LineSums
{
  std::vector<double> place;      ///< across each cell, 0 to 1
  std::vector<float> part;        ///< #slots × lines: what crossings in the cell add there
  std::vector<std::int16_t> turn; ///< #slots × lines: what they add to the cells that follow along the line
};

/// Visits only cells that edges cross: time is proportional to the number of crossings with cell borders and lines,
/// beside 4 bytes a cell to find them.
class CellSums
{
public:
  explicit CellSums(const CellFrame& frame);

  [[nodiscard]] const CellFrame& frame() const noexcept { return frame_; }
  /// Edges in units of the spacing. What lies outside the box is clipped.
  void addAreas(std::span<const ContourEdge> edges);
  /// Lines parallel to `axis`. @param place across the cell, 0 to 1, rising
  void addLines(std::span<const ContourEdge> edges, int axis, std::span<const double> place);

  /// Number of a cell among those that edges crossed, or −1.
  [[nodiscard]] std::int32_t slot(std::int64_t column, std::int64_t row) const noexcept
  {
    return slotOf_[static_cast<std::size_t>(column + frame_.size[0] * row)];
  }
  [[nodiscard]] const CellSum& sum(std::int32_t slot) const noexcept { return sums_[static_cast<std::size_t>(slot)]; }
  [[nodiscard]] const LineSums& lines(int axis) const noexcept { return lines_[static_cast<std::size_t>(axis)]; }
  [[nodiscard]] std::size_t slots() const noexcept { return sums_.size(); }

private:
  std::int32_t take(std::int64_t column, std::int64_t row);
  void walk(Point from, Point to, bool cut);
  void piece(std::int64_t column, std::int64_t row, const Point& from, const Point& to, bool cut);

  CellFrame frame_;
  std::vector<std::int32_t> slotOf_;
  std::vector<CellSum> sums_;
  std::array<LineSums, 2> lines_;
};

} // namespace lamella::micrograph
