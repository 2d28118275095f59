#include "outlines/WallDirection.h"

#include "core/Error.h"
#include "core/Memory.h"
#include "outlines/NearestContours.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lamella::micrograph
{
namespace
{

constexpr double kCorner = std::numbers::pi / 6;

/// Tangents along a segment as (cos 2θ, sin 2θ): at its middle, and at its ends, where they turn towards the
/// neighbours.
struct Tangent
{
  Point middle{ 1, 0 };
  std::array<Point, 2> end{};
  std::array<double, 2> over{ 0, 0 }; ///< the length over which they turn to the end's; 0: they do not
  std::array<bool, 2> corner{ false, false };
  Point normal{ 0, 0 }; ///< unit, from lumen to wall
  double length = 0;
};

Point doubledAngle(double angle)
{
  return { std::cos(2 * angle), std::sin(2 * angle) };
}

std::vector<Tangent> tangentsOf(const ContourSet& contours, std::span<const Segment> segments)
{
  std::vector<Tangent> tangents(segments.size());
  std::vector<double> angles(segments.size());
  for (std::size_t i = 0; i < segments.size(); ++i)
  {
    const Segment& s = segments[i];
    const double dx = s.to[0] - s.from[0];
    const double dy = s.to[1] - s.from[1];
    Tangent& tangent = tangents[i];
    angles[i] = std::atan2(dy, dx);
    tangent.length = std::hypot(dx, dy);
    tangent.normal = { dy / tangent.length, -dx / tangent.length };
    tangent.middle = doubledAngle(angles[i]);
  }
  for (std::size_t begin = 0, end = 0; begin < segments.size(); begin = end)
  {
    while (end < segments.size() && segments[end].chain == segments[begin].chain)
      ++end;
    const bool closed = contours.contours[static_cast<std::size_t>(segments[begin].chain)].closed;
    for (std::size_t i = begin; i < end; ++i)
    {
      const std::size_t next = i + 1 < end ? i + 1 : begin;
      if (next == begin && !closed)
        continue;
      Tangent& before = tangents[i];
      Tangent& after = tangents[next];
      const double turn = std::remainder(angles[next] - angles[i], 2 * std::numbers::pi);
      if (std::abs(turn) > kCorner)
      {
        before.corner[1] = after.corner[0] = true;
        continue;
      }
      before.over[1] = after.over[0] = std::min(before.length, after.length) / 2;
      before.end[1] = after.end[0] = doubledAngle(angles[i] + turn / 2);
    }
  }
  return tangents;
}

/// A node's way from an outline: its foot's tangent, and the unit vector from the foot to the node.
struct WallSide
{
  Point doubled{ 0, 0 }; ///< (cos 2θ, sin 2θ)
  Point away{ 0, 0 };
  double distance = 0;
};

double dot(const Point& a, const Point& b)
{
  return a[0] * b[0] + a[1] * b[1];
}

Point blend(const Point& a, const Point& b, double share)
{
  return { a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]) };
}

WallSide sideOf(const Segment& segment, const Tangent& tangent, double squared, const Point& point)
{
  WallSide side;
  side.distance = std::sqrt(squared);
  const Point& normal = tangent.normal;
  const Point way{ point[0] - segment.from[0], point[1] - segment.from[1] };
  const double along = std::clamp(way[1] * normal[0] - way[0] * normal[1], 0.0, tangent.length);
  // On the outline itself the normal of the segment.
  const double inverse = 1 / side.distance;
  side.away = side.distance > 1e-9 * tangent.length
    ? Point{ (way[0] + along * normal[1]) * inverse, (way[1] - along * normal[0]) * inverse }
    : normal;
  side.doubled = tangent.middle;
  const std::array<double, 2> toEnd{ along, std::max(0.0, tangent.length - along) };
  for (const std::size_t end : { 0U, 1U })
  {
    if (toEnd[end] < tangent.over[end])
    {
      side.doubled = blend(tangent.end[end], tangent.middle, toEnd[end] / tangent.over[end]);
      const double scale = 1 / std::sqrt(dot(side.doubled, side.doubled));
      side.doubled = { side.doubled[0] * scale, side.doubled[1] * scale };
    }
    else if (tangent.corner[end] && toEnd[end] <= 1e-9 * tangent.length)
    {
      const Point& away = side.away;
      side.doubled = { away[1] * away[1] - away[0] * away[0], -2 * away[0] * away[1] };
    }
  }
  return side;
}

/// The unit vector of half the angle.
std::array<float, 2> halved(const Point& doubled)
{
  const double length = std::sqrt(dot(doubled, doubled));
  const double c = doubled[0] / length;
  const double s = doubled[1] / length;
  if (c >= 0)
  {
    const double x = std::sqrt((1 + c) / 2);
    return { static_cast<float>(x), static_cast<float>(s / (2 * x)) };
  }
  const double y = std::sqrt((1 - c) / 2);
  return { static_cast<float>(s / (2 * y)), static_cast<float>(y) };
}

std::array<float, 2> axisOf(std::span<const WallSide> sides)
{
  Point doubled = sides[0].doubled;
  if (sides.size() > 1)
  {
    Point other = sides[1].doubled;
    if (sides.size() > 2 && sides[2].distance < Nearest::kThird * sides[1].distance)
    {
      const double s = (sides[2].distance / sides[1].distance - 1) / (Nearest::kThird - 1);
      other = blend(other, sides[2].doubled, (1 - s * s * (3 - 2 * s)) / 2);
    }
    const double sum = sides[0].distance + sides[1].distance;
    doubled = blend(doubled, other, sum > 0 ? sides[0].distance / sum : 0.5);
  }
  return halved(dot(doubled, doubled) < 1e-20 ? sides[0].doubled : doubled);
}

/// To the nearest of the lines as far from the first lumen as from another one: the difference of the distances over
/// how fast it changes.
double toMiddle(std::span<const WallSide> sides)
{
  double middle = Nearest::kNone;
  for (std::size_t i = 1; i < sides.size(); ++i)
  {
    const Point change{ sides[0].away[0] - sides[i].away[0], sides[0].away[1] - sides[i].away[1] };
    const double slope = std::sqrt(dot(change, change));
    middle = std::min(middle, (sides[i].distance - sides[0].distance) / std::max(slope, 1e-6));
  }
  return middle;
}

/// 1: wall; 2: lumen beside it.
std::vector<std::uint8_t> wallAndRim(const ContourLattice& lattice)
{
  const std::int64_t nx = lattice.image.lattice.size[0];
  const std::int64_t ny = lattice.image.lattice.size[1];
  const std::vector<std::uint8_t>& phase = lattice.image.phase;
  std::vector<std::uint8_t> wanted = phase;
  for (std::int64_t y = 0; y < ny; ++y)
  {
    for (std::int64_t x = 0; x < nx; ++x)
    {
      const auto node = static_cast<std::size_t>(x + nx * y);
      if (phase[node] == 0)
        continue;
      for (std::int64_t v = std::max<std::int64_t>(0, y - 1); v <= std::min(ny - 1, y + 1); ++v)
      {
        for (std::int64_t u = std::max<std::int64_t>(0, x - 1); u <= std::min(nx - 1, x + 1); ++u)
        {
          std::uint8_t& other = wanted[static_cast<std::size_t>(u + nx * v)];
          other = other == 0 ? std::uint8_t{ 2 } : other;
        }
      }
    }
  }
  return wanted;
}

} // namespace

WallDirections wallDirections(const ContourSet& contours, const ContourLattice& lattice)
{
  const Lattice& nodes = lattice.image.lattice;
  const auto count = static_cast<std::size_t>(nodes.count());
  if (lattice.grain.size() != count)
  {
    throw ParameterError(
      fmt::format("wall directions on {} nodes, of which {} have a grain", count, lattice.grain.size()),
      "make the lattice with its grain");
  }
  if (const auto available = static_cast<double>(availableMemory()); 29.0 * static_cast<double>(count) > available)
  {
    throw MemoryError(fmt::format("wall directions on {} nodes take {}, and {} are free", count,
                        bytesText(29.0 * static_cast<double>(count)), bytesText(available)),
      "take a larger spacing or a part of the picture");
  }
  WallDirections result;
  result.grain = lattice.grain;
  result.axis.resize(count);
  result.neighbour.resize(count);
  result.nearest.resize(count);
  result.second.resize(count);
  result.middle.resize(count);

  const NearestContours search(segmentsOf(contours), Nearest::kMost);
  const std::vector<Tangent> tangents = tangentsOf(contours, search.segments());
  const std::vector<std::uint8_t> wanted = wallAndRim(lattice);
  search.atNodes(nodes.size[0], nodes.size[1], nodes.spacing, wanted, Nearest::kNone,
    [&](std::int64_t index, const Point& point, const Nearest& nearest)
    {
      const auto node = static_cast<std::size_t>(index);
      std::array<WallSide, Nearest::kMost> sides;
      std::size_t found = 0;
      // Mostly the third is too far away to matter.
      const double third = Nearest::kThird * Nearest::kThird * nearest.squared[1];
      while (found < sides.size() && nearest.squared[found] < (found < 2 ? Nearest::kNone : third))
      {
        const auto segment = static_cast<std::size_t>(nearest.segment[found]);
        sides[found] = sideOf(search.segments()[segment], tangents[segment], nearest.squared[found], point);
        ++found;
      }
      const std::span<const WallSide> known(sides.data(), found);
      const bool lumen = wanted[node] == 2;
      result.nearest[node] = static_cast<float>(lumen ? -sides[0].distance : sides[0].distance);
      result.second[node] = static_cast<float>(found > 1 ? sides[1].distance : Nearest::kNone);
      if (!lumen)
      {
        result.grain[node] = nearest.label[0];
        result.neighbour[node] = found > 1 ? nearest.label[1] : 0;
        result.axis[node] = axisOf(known);
        result.middle[node] = static_cast<float>(toMiddle(known));
      }
    });
  return result;
}

} // namespace lamella::micrograph
