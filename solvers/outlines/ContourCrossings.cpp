// Segments that meet, through a grid of cells about as large as they are long.
#include "outlines/ContourCheck.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

namespace lamella::micrograph
{
namespace
{

struct CrossingSegment
{
  Point a, b;
  std::size_t chain;
  std::size_t place; ///< in the chain
};

[[nodiscard]] double side(const Point& o, const Point& a, const Point& b)
{
  return (a[0] - o[0]) * (b[1] - o[1]) - (b[0] - o[0]) * (a[1] - o[1]);
}

/// A point on the line through a segment: is it between the ends?
[[nodiscard]] bool between(const CrossingSegment& s, const Point& p)
{
  return std::min(s.a[0], s.b[0]) <= p[0] && p[0] <= std::max(s.a[0], s.b[0]) && std::min(s.a[1], s.b[1]) <= p[1] &&
    p[1] <= std::max(s.a[1], s.b[1]);
}

/// Do two segments have a point in common?
[[nodiscard]] bool meet(const CrossingSegment& s, const CrossingSegment& t)
{
  if (std::max(s.a[0], s.b[0]) < std::min(t.a[0], t.b[0]) || std::max(t.a[0], t.b[0]) < std::min(s.a[0], s.b[0]) ||
    std::max(s.a[1], s.b[1]) < std::min(t.a[1], t.b[1]) || std::max(t.a[1], t.b[1]) < std::min(s.a[1], s.b[1]))
    return false;
  const double ta = side(s.a, s.b, t.a);
  const double tb = side(s.a, s.b, t.b);
  const double sa = side(t.a, t.b, s.a);
  const double sb = side(t.a, t.b, s.b);
  if (((ta > 0 && tb < 0) || (ta < 0 && tb > 0)) && ((sa > 0 && sb < 0) || (sa < 0 && sb > 0)))
    return true;
  return (ta == 0 && between(s, t.a)) || (tb == 0 && between(s, t.b)) || (sa == 0 && between(t, s.a)) ||
    (sb == 0 && between(t, s.b));
}

/// Segments that follow each other in a chain share a point; they meet otherwise only if the second turns straight
/// back.
[[nodiscard]] bool turnsBack(const CrossingSegment& first, const CrossingSegment& second)
{
  return side(first.a, first.b, second.b) == 0 &&
    (first.b[0] - first.a[0]) * (second.b[0] - second.a[0]) + (first.b[1] - first.a[1]) * (second.b[1] - second.a[1]) <
    0;
}

[[nodiscard]] std::size_t segments(const Contour& c)
{
  return c.closed ? c.points.size() : c.points.size() - std::min<std::size_t>(c.points.size(), 1);
}

class SegmentGrid
{
public:
  explicit SegmentGrid(const ContourSet& set)
    : set_(set)
  {
    double length = 0;
    for (int axis = 0; axis < 2; ++axis)
    {
      low_[axis] = std::numeric_limits<double>::infinity();
      high_[axis] = -low_[axis];
    }
    for (std::size_t k = 0; k < set.contours.size(); ++k)
    {
      const Contour& c = set.contours[k];
      for (std::size_t i = 0; i < segments(c); ++i)
      {
        const CrossingSegment s{ c.points[i], c.points[i + 1 < c.points.size() ? i + 1 : 0], k, i };
        all_.push_back(s);
        length += std::hypot(s.b[0] - s.a[0], s.b[1] - s.a[1]);
        for (std::size_t axis = 0; axis < 2; ++axis)
        {
          low_[axis] = std::min({ low_[axis], s.a[axis], s.b[axis] });
          high_[axis] = std::max({ high_[axis], s.a[axis], s.b[axis] });
        }
      }
    }
    if (all_.empty())
      return;
    // Cells as large as segments are long, but not many more cells than segments.
    const double area = std::max((high_[0] - low_[0]) * (high_[1] - low_[1]), 0.0);
    const double n = static_cast<double>(all_.size());
    edge_ =
      std::max({ 1.5 * length / n, std::sqrt(area / (2 * n)), (high_[0] - low_[0]) / n, (high_[1] - low_[1]) / n });
    for (std::size_t axis = 0; axis < 2; ++axis)
      cells_[axis] = edge_ > 0 ? static_cast<std::size_t>((high_[axis] - low_[axis]) / edge_) + 1 : 1;
    fill();
  }

  /// Each pair of chains that meet, once.
  [[nodiscard]] std::vector<ContourFinding> crossings() const
  {
    std::map<std::pair<std::size_t, std::size_t>, Point> found;
    for (std::size_t cell = 0; cell + 1 < begin_.size(); ++cell)
    {
      for (std::size_t i = begin_[cell]; i < begin_[cell + 1]; ++i)
      {
        const CrossingSegment& s = all_[inCell_[i]];
        for (std::size_t j = i + 1; j < begin_[cell + 1]; ++j)
        {
          const CrossingSegment& t = all_[inCell_[j]];
          if (bad(s, t))
          {
            const Point at{ (s.a[0] + s.b[0] + t.a[0] + t.b[0]) / 4, (s.a[1] + s.b[1] + t.a[1] + t.b[1]) / 4 };
            found.try_emplace(std::minmax(s.chain, t.chain), at);
          }
        }
      }
    }
    std::vector<ContourFinding> findings;
    findings.reserve(found.size());
    for (const auto& [pair, at] : found)
      findings.push_back({ ContourFault::Crossing, pair.first, pair.second, at });
    return findings;
  }

private:
  [[nodiscard]] bool bad(const CrossingSegment& s, const CrossingSegment& t) const
  {
    if (s.chain == t.chain)
    {
      const Contour& c = set_.contours[s.chain];
      const std::size_t n = segments(c);
      const auto follows = [&](const CrossingSegment& a, const CrossingSegment& b)
      { return a.place + 1 == b.place || (c.closed && a.place + 1 == n && b.place == 0); };
      if (follows(s, t) || follows(t, s))
        return follows(s, t) ? turnsBack(s, t) : turnsBack(t, s);
    }
    return meet(s, t);
  }

  /// Calls visit(cell) for the cells that a segment's box covers.
  template <class Visit>
  void cover(const CrossingSegment& s, Visit visit) const
  {
    std::array<std::size_t, 2> from{};
    std::array<std::size_t, 2> to{};
    for (std::size_t axis = 0; axis < 2; ++axis)
    {
      const auto cell = [&](double x)
      {
        return edge_ > 0 ? std::min(static_cast<std::size_t>((x - low_[axis]) / edge_), cells_[axis] - 1)
                         : std::size_t{ 0 };
      };
      from[axis] = cell(std::min(s.a[axis], s.b[axis]));
      to[axis] = cell(std::max(s.a[axis], s.b[axis]));
    }
    // A long slanting segment passes few of its box's cells: row by row only those beside it.
    const bool slanting = to[0] > from[0] + 1 && to[1] > from[1] + 1;
    for (std::size_t y = from[1]; y <= to[1]; ++y)
    {
      std::size_t first = from[0];
      std::size_t last = to[0];
      if (slanting)
      {
        const double slope = (s.b[0] - s.a[0]) / (s.b[1] - s.a[1]);
        const double y0 = low_[1] + edge_ * static_cast<double>(y);
        const double x0 = s.a[0] + slope * (y0 - s.a[1]);
        const double x1 = s.a[0] + slope * (y0 + edge_ - s.a[1]);
        const double least = (std::min(x0, x1) - low_[0]) / edge_ - 0.5; // half a cell for round-off
        const double most = (std::max(x0, x1) - low_[0]) / edge_ + 0.5;
        first = std::max(first, static_cast<std::size_t>(std::max(least, 0.0)));
        last = std::min(last, static_cast<std::size_t>(std::max(most, 0.0)));
      }
      for (std::size_t x = first; x <= last; ++x)
        visit(x + cells_[0] * y);
    }
  }

  void fill()
  {
    begin_.assign(cells_[0] * cells_[1] + 1, 0);
    for (const CrossingSegment& s : all_)
      cover(s, [&](std::size_t cell) { ++begin_[cell + 1]; });
    for (std::size_t i = 1; i < begin_.size(); ++i)
      begin_[i] += begin_[i - 1];
    inCell_.resize(begin_.back());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    for (std::size_t i = 0; i < all_.size(); ++i)
      cover(all_[i], [&](std::size_t cell) { inCell_[next[cell]++] = static_cast<std::uint32_t>(i); });
  }

  const ContourSet& set_;
  std::vector<CrossingSegment> all_;
  Point low_{};
  Point high_{};
  double edge_ = 0;
  std::array<std::size_t, 2> cells_{ 1, 1 };
  std::vector<std::size_t> begin_;
  std::vector<std::uint32_t> inCell_;
};

} // namespace

std::vector<ContourFinding> findCrossings(const ContourSet& set)
{
  return SegmentGrid(set).crossings();
}

} // namespace lamella::micrograph
