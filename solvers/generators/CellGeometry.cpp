#include "generators/CellGeometry.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lamella::generators
{
namespace
{

constexpr double widenedEnd = 0.98; // of the cell's depth: where widened() goes on as a straight line,
constexpr double widenedSlope = 50; // this steep

} // namespace

CellSide sideBetween(const Corner& from, const Corner& to) noexcept
{
  const double dx = to.x - from.x;
  const double dy = to.y - from.y;
  const double length = std::sqrt(dx * dx + dy * dy);
  CellSide side{ -dy / length, dx / length, 0, -1, false };
  side.c = -(side.nx * from.x + side.ny * from.y);
  return side;
}

PolygonPlace placeOf(std::span<const Corner> corners) noexcept
{
  PolygonPlace place;
  place.xMin = place.xMax = corners[0].x;
  place.yMin = place.yMax = corners[0].y;
  double area = 0;
  for (std::size_t i = 0; i < corners.size(); ++i)
  {
    const Corner& from = corners[i];
    const Corner& to = corners[(i + 1) % corners.size()];
    place.xMin = std::min(place.xMin, from.x);
    place.xMax = std::max(place.xMax, from.x);
    place.yMin = std::min(place.yMin, from.y);
    place.yMax = std::max(place.yMax, from.y);
    const double cross = from.x * to.y - to.x * from.y;
    area += cross;
    place.centreX += (from.x + to.x) * cross;
    place.centreY += (from.y + to.y) * cross;
  }
  place.centreX /= 3 * area;
  place.centreY /= 3 * area;
  return place;
}

void clip(std::vector<Corner>& polygon, std::vector<Corner>& spare, double a, double b, double c, int side)
{
  spare.clear();
  for (std::size_t i = 0; i < polygon.size(); ++i)
  {
    const Corner& from = polygon[i];
    const Corner& to = polygon[(i + 1) % polygon.size()];
    const double dFrom = a * from.x + b * from.y + c;
    const double dTo = a * to.x + b * to.y + c;
    if (dFrom >= 0)
      spare.push_back(from);
    if ((dFrom >= 0) != (dTo >= 0))
    {
      const double t = dFrom / (dFrom - dTo);
      // Leaving the half-plane, the new side starts here; entering it, the old side goes on.
      spare.push_back({ mix(from.x, to.x, t), mix(from.y, to.y, t), dFrom >= 0 ? side : from.side });
    }
  }
  polygon.swap(spare);
}

void dropShortSides(std::vector<Corner>& polygon, double least)
{
  for (std::size_t i = 0; i < polygon.size() && polygon.size() > 3;)
  {
    const Corner& to = polygon[(i + 1) % polygon.size()];
    const double dx = to.x - polygon[i].x;
    const double dy = to.y - polygon[i].y;
    if (dx * dx + dy * dy < least * least)
      polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(i));
    else
      ++i;
  }
}

double wallDepth(std::span<const double> distances, double fillet) noexcept
{
  double depth = std::numeric_limits<double>::max();
  for (const double d : distances)
    depth = std::min(depth, d);
  if (fillet <= 0)
    return depth;
  // Newton's method from above on a convex, rising function: it comes down without overshooting.
  for (int step = 0; step < 8; ++step)
  {
    double excess = -fillet * fillet;
    double slope = 0;
    for (const double d : distances)
    {
      const double reach = std::max(0.0, depth + fillet - d);
      excess += reach * reach;
      slope += 2 * reach;
    }
    if (excess <= 1e-6 * fillet * fillet)
      break;
    depth -= excess / slope;
  }
  return depth;
}

double widened(double depth, double cellDepth) noexcept
{
  const double v = std::max(0.0, depth) / cellDepth;
  const double w = std::min(v, widenedEnd);
  const double value = w / std::sqrt(std::sqrt(1 - w * w * w * w));
  return cellDepth * (value + widenedSlope * (v - w));
}

double depthOfWidened(double value, double cellDepth) noexcept
{
  const double v = std::max(0.0, value) / cellDepth;
  const double w = v / std::sqrt(std::sqrt(1 + v * v * v * v));
  if (w <= widenedEnd)
    return cellDepth * w;
  const double end = widened(widenedEnd, 1);
  return cellDepth * (widenedEnd + (v - end) / widenedSlope);
}

std::array<double, 2> onCircle(double turns) noexcept
{
  // To an eighth of a turn either side of an axis, where the series is short.
  turns -= std::floor(turns);
  const double quarters = std::floor(4 * turns + 0.5);
  const double x = (turns - quarters / 4) * 6.283185307179586476925;
  const double s = x * x;
  const double sine = x * (1 - s / 6 * (1 - s / 20 * (1 - s / 42 * (1 - s / 72 * (1 - s / 110 * (1 - s / 156))))));
  const double cosine = 1 - s / 2 * (1 - s / 12 * (1 - s / 30 * (1 - s / 56 * (1 - s / 90 * (1 - s / 132)))));
  switch (static_cast<int>(quarters) % 4)
  {
    case 0:
      return { cosine, sine };
    case 1:
      return { -sine, cosine };
    case 2:
      return { -cosine, -sine };
    default:
      return { sine, -cosine };
  }
}

} // namespace lamella::generators
