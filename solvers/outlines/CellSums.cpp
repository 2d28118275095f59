#include "outlines/CellSums.h"

#include <algorithm>
#include <cmath>

namespace lamella::micrograph
{
namespace
{

/// Point of an edge where coordinate `axis` has a value; exactly that value.
Point at(const Point& from, const Point& to, int axis, double value)
{
  const int other = 1 - axis;
  const double share = (value - from[axis]) / (to[axis] - from[axis]);
  Point point;
  point[axis] = value;
  point[other] = from[other] + share * (to[other] - from[other]);
  return point;
}

std::int64_t cellOf(double position, std::int64_t size)
{
  return std::clamp(static_cast<std::int64_t>(std::floor(position)), std::int64_t{ 0 }, size - 1);
}

} // namespace

CellFrame::CellFrame(std::int64_t nx, std::int64_t ny, int shiftedAxis)
  : size{ nx, ny }
  , high{ static_cast<double>(nx), static_cast<double>(ny) }
{
  if (shiftedAxis >= 0)
  {
    ++size[shiftedAxis];
    shift[shiftedAxis] = low[shiftedAxis] = 0.5;
    high[shiftedAxis] += 0.5;
  }
}

CellSums::CellSums(const CellFrame& frame)
  : frame_(frame)
  , slotOf_(static_cast<std::size_t>(frame.size[0] * frame.size[1]), -1)
{
}

std::int32_t CellSums::take(std::int64_t column, std::int64_t row)
{
  std::int32_t& slot = slotOf_[static_cast<std::size_t>(column + frame_.size[0] * row)];
  if (slot < 0)
  {
    slot = static_cast<std::int32_t>(sums_.size());
    sums_.emplace_back();
    for (LineSums& lines : lines_)
    {
      lines.part.resize(sums_.size() * lines.place.size(), 0);
      lines.turn.resize(sums_.size() * lines.place.size(), 0);
    }
  }
  return slot;
}

void CellSums::piece(std::int64_t column, std::int64_t row, const Point& from, const Point& to, bool cut)
{
  CellSum& sum = sums_[static_cast<std::size_t>(take(column, row))];
  const double dx = to[0] - from[0];
  const double dy = to[1] - from[1];
  sum.cover -= dy;
  sum.area -= dy * (frame_.end(0, column) - (from[0] + to[0]) / 2);
  if (cut)
  {
    sum.normal[0] += dy;
    sum.normal[1] -= dx;
    sum.length += std::sqrt(dx * dx + dy * dy);
    sum.cut = true;
  }
}

/// Through the cells one after another; both ends lie in the box.
void CellSums::walk(Point from, Point to, bool cut)
{
  std::array<std::int64_t, 2> cell{ cellOf(from[0], frame_.size[0]), cellOf(from[1], frame_.size[1]) };
  const std::array<std::int64_t, 2> last{ cellOf(to[0], frame_.size[0]), cellOf(to[1], frame_.size[1]) };
  const std::array<int, 2> step{ to[0] >= from[0] ? 1 : -1, to[1] >= from[1] ? 1 : -1 };
  const Point begin = from;
  std::array<std::int64_t, 2> left{ std::abs(last[0] - cell[0]), std::abs(last[1] - cell[1]) };
  while (left[0] + left[1] > 0)
  {
    std::array<double, 2> border{};
    std::array<double, 2> when{ 2, 2 };
    for (const int axis : { 0, 1 })
    {
      if (left[axis] > 0)
      {
        border[axis] = static_cast<double>(step[axis] > 0 ? cell[axis] + 1 : cell[axis]);
        when[axis] = (border[axis] - begin[axis]) / (to[axis] - begin[axis]);
      }
    }
    const int axis = when[0] <= when[1] ? 0 : 1;
    Point leave = at(begin, to, axis, border[axis]);
    // Round-off must not lead out of the cell.
    const int other = 1 - axis;
    leave[other] = std::clamp(leave[other], frame_.begin(other, cell[other]), frame_.end(other, cell[other]));
    piece(cell[0], cell[1], from, leave, cut);
    from = leave;
    cell[axis] += step[axis];
    --left[axis];
  }
  piece(cell[0], cell[1], from, to, cut);
}

void CellSums::addAreas(std::span<const ContourEdge> edges)
{
  const Point& low = frame_.low;
  const Point& high = frame_.high;
  const auto inside = [&](const Point& p)
  { return p[0] >= low[0] && p[0] <= high[0] && p[1] >= low[1] && p[1] <= high[1]; };
  for (const ContourEdge& edge : edges)
  {
    Point from{ edge.from[0] + frame_.shift[0], edge.from[1] + frame_.shift[1] };
    Point to{ edge.to[0] + frame_.shift[0], edge.to[1] + frame_.shift[1] };
    if (inside(from) && inside(to))
    {
      walk(from, to, !edge.border);
      continue;
    }
    if (std::max(from[1], to[1]) <= low[1] || std::min(from[1], to[1]) >= high[1])
      continue;
    const Point begin = from;
    const Point end = to;
    for (const double side : { low[1], high[1] })
    {
      const bool above = side == high[1];
      Point& out = (above ? from[1] > to[1] : from[1] < to[1]) ? from : to;
      if (above ? out[1] > side : out[1] < side)
        out = at(begin, end, 1, side);
    }
    // Cut at the left and right sides into pieces, of which the left one is moved onto the side: it covers all of its
    // height there.
    std::array<Point, 4> points{ from, from, to, to };
    const bool rising = to[0] > from[0];
    const std::array<double, 2> sides{ rising ? low[0] : high[0], rising ? high[0] : low[0] };
    for (const std::size_t i : { 0U, 1U })
    {
      const bool between = std::min(from[0], to[0]) < sides[i] && std::max(from[0], to[0]) > sides[i];
      points[i + 1] = between ? at(from, to, 0, sides[i]) : ((sides[i] > from[0]) == rising ? to : from);
    }
    for (std::size_t i = 0; i < 3; ++i)
    {
      Point a = points[i];
      Point b = points[i + 1];
      const double middle = (a[0] + b[0]) / 2;
      if (middle > high[0] || a == b)
        continue;
      const bool outside = middle < low[0];
      for (Point* p : { &a, &b })
      {
        (*p)[0] = outside ? low[0] : std::clamp((*p)[0], low[0], high[0]);
        (*p)[1] = std::clamp((*p)[1], low[1], high[1]);
      }
      walk(a, b, !edge.border && !outside);
    }
  }
}

void CellSums::addLines(std::span<const ContourEdge> edges, int axis, std::span<const double> place)
{
  LineSums& lines = lines_[static_cast<std::size_t>(axis)];
  const std::size_t count = place.size();
  lines.place.assign(place.begin(), place.end());
  lines.part.assign(sums_.size() * count, 0);
  lines.turn.assign(sums_.size() * count, 0);
  const int across = 1 - axis;
  for (const ContourEdge& edge : edges)
  {
    const double begin = edge.from[across] + frame_.shift[across];
    const double end = edge.to[across] + frame_.shift[across];
    const double least = std::min(begin, end);
    const double most = std::max(begin, end);
    if (most <= frame_.low[across] || least >= frame_.high[across] || least == most)
      continue;
    // Rightwards of an edge that goes down, and above one that goes right, lies lumen.
    const int sign = (end > begin) == (axis == 1) ? 1 : -1;
    const double slope = (edge.to[axis] - edge.from[axis]) / (end - begin);
    const double base = edge.from[axis] + frame_.shift[axis];
    const std::int64_t last = cellOf(most, frame_.size[across]);
    for (std::int64_t row = cellOf(least, frame_.size[across]); row <= last; ++row)
    {
      const double low = frame_.begin(across, row);
      const double wide = frame_.end(across, row) - low;
      for (std::size_t k = 0; k < count; ++k)
      {
        const double line = low + place[k] * wide;
        if (line < least || line >= most)
          continue;
        const double where = std::max(base + (line - begin) * slope, frame_.low[axis]);
        if (where >= frame_.high[axis])
          continue;
        const std::int64_t cell = cellOf(where, frame_.size[axis]);
        const std::size_t slot = static_cast<std::size_t>(axis == 0 ? take(cell, row) : take(row, cell));
        const double stop = frame_.end(axis, cell);
        lines.part[slot * count + k] += static_cast<float>(sign * (stop - where) / (stop - frame_.begin(axis, cell)));
        lines.turn[slot * count + k] = static_cast<std::int16_t>(lines.turn[slot * count + k] + sign);
      }
    }
  }
}

} // namespace lamella::micrograph
