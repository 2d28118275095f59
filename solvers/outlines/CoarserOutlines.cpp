#include "outlines/CoarserOutlines.h"

#include "core/Error.h"
#include "lattice/Subsample.h"
#include "outlines/ContourBorder.h"
#include "outlines/ContourEdit.h"

#include <cmath>
#include <numbers>

namespace lamella::micrograph
{
namespace
{

/// A side of the picture: points of it have this distance from it, positive within.
struct OutlineSide
{
  std::size_t axis = 0;
  bool high = false;

  [[nodiscard]] double depth(const Point& p, const std::array<double, 2>& size) const
  {
    return high ? size[axis] - p[axis] : p[axis];
  }
};

constexpr std::array<OutlineSide, 4> sides{ { { 1, false }, { 0, true }, { 1, true }, { 0, false } } };

/// How long a polygon runs along a side.
double alongSide(const std::vector<Point>& polygon, const OutlineSide& side, const std::array<double, 2>& size)
{
  const double near = 1e-9 * (size[0] + size[1]);
  double length = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i)
  {
    const Point& a = polygon[i];
    const Point& b = polygon[(i + 1) % polygon.size()];
    if (std::abs(side.depth(a, size)) <= near && std::abs(side.depth(b, size)) <= near)
      length += std::hypot(b[0] - a[0], b[1] - a[1]);
  }
  return length;
}

/// What of a polygon lies deeper than this (Sutherland and Hodgman, Comm. ACM 17, 1974, 32–42).
std::vector<Point> deeper(
  const std::vector<Point>& polygon, const OutlineSide& side, double depth, const std::array<double, 2>& size)
{
  std::vector<Point> inside;
  for (std::size_t i = 0; i < polygon.size(); ++i)
  {
    const Point& a = polygon[i];
    const Point& b = polygon[(i + 1) % polygon.size()];
    const double before = side.depth(a, size) - depth;
    const double after = side.depth(b, size) - depth;
    if (before >= 0)
      inside.push_back(a);
    if ((before >= 0) != (after >= 0))
    {
      const double part = before / (before - after);
      inside.push_back({ a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1]) });
    }
  }
  return inside;
}

} // namespace

std::vector<CoarserOutlines> coarserOutlines(
  const PhaseImage& image, std::uint8_t lumen, std::span<const float> level, const ExtractOptions& options)
{
  constexpr std::size_t most = 4; // of nine with every third pixel five are as good
  std::vector<CoarserOutlines> coarser;
  for (const int stride : { 2, 3 })
  {
    CoarserOutlines& outlines = coarser.emplace_back();
    outlines.stride = stride;
    for (const auto& first : subsampleStarts(image.lattice, stride, most))
    {
      const PhaseImage part = subsample(image, first, stride);
      std::vector<float> levels;
      for (std::int64_t y = first[1]; !level.empty() && y < image.lattice.size[1]; y += stride)
        for (std::int64_t x = first[0]; x < image.lattice.size[0]; x += stride)
          levels.push_back(level[static_cast<std::size_t>(image.lattice.index(x, y))]);
      try
      {
        outlines.sets.push_back(extractContours(part, lumen, levels, options).contours);
      }
      catch (const InputError&)
      {
      }
    }
  }
  return coarser;
}

ContourSet movedOutlines(const ContourSet& set, double distance)
{
  ContourSet moved = set;
  for (std::size_t c = 0; c < set.contours.size(); ++c)
  {
    const Contour& from = set.contours[c];
    const std::size_t n = from.points.size();
    for (std::size_t i = 0; i < n; ++i)
    {
      // The lumen lies on the left: the wall is where (dy, −dx) points.
      Point normal{ 0, 0 };
      const auto add = [&](std::size_t a, std::size_t b)
      {
        const Point way{ from.points[b][0] - from.points[a][0], from.points[b][1] - from.points[a][1] };
        if (const double length = std::hypot(way[0], way[1]); length > 0)
          normal = { normal[0] + way[1] / length, normal[1] - way[0] / length };
      };
      const bool first = i == 0;
      const bool last = i + 1 == n;
      if (from.closed || !first)
        add(first ? n - 1 : i - 1, i);
      if (from.closed || !last)
        add(i, last ? 0 : i + 1);
      const double length = std::hypot(normal[0], normal[1]);
      for (const std::size_t axis : { 0U, 1U })
      {
        const double at = from.points[i][axis];
        const double border = 1e-6 * set.size[axis];
        const bool stays = !from.closed && (first || last) && (at < border || at > set.size[axis] - border);
        if (length > 0 && !stays)
          moved.contours[c].points[i][axis] = at + distance * normal[axis] / length;
      }
    }
  }
  return moved;
}

ContourSet sealedOutlines(const ContourSet& set, double pixel)
{
  std::vector<std::vector<Point>> polygons;
  bool any = false;
  for (const Outline& outline : outlines(set))
  {
    std::vector<Point>& polygon = polygons.emplace_back(outline.points);
    const double longest = std::sqrt(8 * pixel * std::sqrt(polygonArea(polygon) / std::numbers::pi));
    for (const OutlineSide& side : sides)
    {
      const double cut = outline.open ? alongSide(polygon, side, set.size) : 0;
      if (cut > 0 && cut <= longest)
      {
        std::vector<Point> rest = deeper(polygon, side, pixel / 2, set.size);
        if (rest.size() >= 3)
        {
          polygon = std::move(rest);
          any = true;
        }
      }
    }
  }
  return any ? clipToWindow(polygons, { 0, 0 }, { set.size[0], set.size[1] }) : ContourSet{};
}

} // namespace lamella::micrograph
