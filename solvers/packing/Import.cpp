// Packings made elsewhere: checked, moved to the origin, contacts found.
#include "core/Error.h"
#include "packing/Packing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace lamella::packing
{

namespace
{

// Beyond these no length is one of a grain, in metres or in mean diameters, and squares soon leave the numbers.
constexpr double smallestRadius = 1e-15;
constexpr double largestRadius = 1e6;
constexpr double farthestCentre = 1e9;
// In mean diameters. A lattice that holds both sides of such a gap has nodes by the billion, or its grains none.
constexpr double widestGap = 1000;

/// Refuses a packing that is torn in two along an axis: what is far away is a slip of the decimal point, or of units.
void requireTogether(const Packing& p, double mean)
{
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(p.dimension); ++axis)
  {
    std::vector<std::size_t> order(p.count());
    std::iota(order.begin(), order.end(), std::size_t{ 0 });
    const auto low = [&](std::size_t i) { return p.centre[i][axis] - p.radius[i]; };
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return low(a) < low(b); });
    double end = -std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < order.size(); ++k)
    {
      const std::size_t i = order[k];
      if (k > 0 && low(i) - end > widestGap * mean)
      {
        const std::size_t few = std::min(k, order.size() - k);
        throw InputError(fmt::format("{} {} {:.3g} mean diameters away from the others, along {}",
                           few == 1 ? fmt::format("grain {}", (k == 1 ? order.front() : order.back()) + 1)
                                    : fmt::format("{} of {} grains", few, order.size()),
                           few == 1 ? "lies" : "lie", (low(i) - end) / mean, "xyz"[axis]),
          fmt::format(
            "gaps up to {:g} are taken; are its coordinates right, and in the unit of the others?", widestGap));
      }
      end = std::max(end, p.centre[i][axis] + p.radius[i]);
    }
  }
}

/// What the grains reach.
struct Extent
{
  std::array<double, 3> low{ 0, 0, 0 };
  std::array<double, 3> high{ 0, 0, 0 };
};

Extent checkedExtent(std::size_t axes, std::span<const std::array<double, 3>> centre, std::span<const double> radius)
{
  if (radius.empty())
    throw InputError("there are no grains", "give at least one centre and radius");
  if (centre.size() != radius.size())
    throw InputError(fmt::format("{} centres and {} radii", centre.size(), radius.size()), "give one radius a centre");
  Extent extent;
  auto& [low, high] = extent;
  low.fill(std::numeric_limits<double>::infinity());
  high.fill(-std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < radius.size(); ++i)
  {
    if (!(radius[i] > 0) || !std::isfinite(radius[i]))
      throw InputError(fmt::format("the radius of grain {} is {}", i + 1, radius[i]), "radii are positive numbers");
    if (radius[i] < smallestRadius || radius[i] > largestRadius)
      throw InputError(fmt::format("the radius of grain {} is {:g}", i + 1, radius[i]),
        fmt::format("radii from {:g} to {:g} are taken; give them in metres", smallestRadius, largestRadius));
    for (std::size_t a = 0; a < axes; ++a)
    {
      if (!std::isfinite(centre[i][a]))
        throw InputError(fmt::format("the centre of grain {} has the coordinate {}", i + 1, centre[i][a]),
          "coordinates are finite numbers");
      if (std::abs(centre[i][a]) > farthestCentre)
        throw InputError(fmt::format("the centre of grain {} has the coordinate {:g}", i + 1, centre[i][a]),
          fmt::format("coordinates up to {:g} are taken; give them in metres", farthestCentre));
      low[a] = std::min(low[a], centre[i][a] - radius[i]);
      high[a] = std::max(high[a], centre[i][a] + radius[i]);
    }
  }
  return extent;
}

/// @param gap largest between two that touch
void findContacts(Packing& p, double gap)
{
  const auto axes = static_cast<std::size_t>(p.dimension);
  // Sorted along the last axis, a grain meets only those within its reach.
  const std::size_t axis = axes - 1;
  std::vector<std::size_t> order(p.count());
  std::iota(order.begin(), order.end(), std::size_t{ 0 });
  std::sort(
    order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return p.centre[a][axis] < p.centre[b][axis]; });
  const double largest = *std::max_element(p.radius.begin(), p.radius.end());
  for (std::size_t m = 0; m < order.size(); ++m)
    for (std::size_t k = m + 1; k < order.size(); ++k)
    {
      const std::size_t i = std::min(order[m], order[k]);
      const std::size_t j = std::max(order[m], order[k]);
      if (p.centre[order[k]][axis] - p.centre[order[m]][axis] > p.radius[order[m]] + largest + gap)
        break;
      Contact c{ static_cast<std::int32_t>(i), static_cast<std::int32_t>(j), {}, {}, {}, 0 };
      double square = 0;
      for (std::size_t a = 0; a < axes; ++a)
      {
        c.branch[a] = p.centre[j][a] - p.centre[i][a];
        square += c.branch[a] * c.branch[a];
      }
      const double distance = std::sqrt(square);
      c.overlap = p.radius[i] + p.radius[j] - distance;
      if (c.overlap < -gap)
        continue;
      if (c.overlap > 0.04 * std::min(p.radius[i], p.radius[j]))
        throw InputError(fmt::format("grains {} and {} overlap by {:.3g}, {:.0f} % of the smaller one's diameter",
                           i + 1, j + 1, c.overlap, 50 * c.overlap / std::min(p.radius[i], p.radius[j])),
          "up to 2 % is taken; are the radii perhaps diameters, or in another unit?");
      for (std::size_t a = 0; a < axes; ++a)
        c.normal[a] = c.branch[a] / distance;
      p.contacts.push_back(c);
    }
  std::sort(p.contacts.begin(), p.contacts.end(),
    [](const Contact& a, const Contact& b) { return std::pair(a.first, a.second) < std::pair(b.first, b.second); });
}

void warnOfGrainsOutside(Packing& p)
{
  const auto axes = static_cast<std::size_t>(p.dimension);
  std::int64_t out = 0;
  for (std::size_t i = 0; i < p.count(); ++i)
  {
    double farthest = 0;
    for (std::size_t a = 0; a < axes; ++a)
      farthest = std::max({ farthest, p.radius[i] - p.centre[i][a], p.radius[i] + p.centre[i][a] - p.size[a] });
    out += farthest > 0.04 * p.radius[i] ? 1 : 0;
  }
  if (out > 0)
    p.warnings.push_back(
      fmt::format("{} of {} grains stick out of the box: the packing fraction counts all of them", out, p.count()));
}

void findWallContacts(Packing& p, double gap)
{
  const auto axes = static_cast<std::size_t>(p.dimension);
  for (std::size_t i = 0; i < p.count(); ++i)
    for (std::size_t a = 0; a < axes; ++a)
      for (const int side : { 0, 1 })
      {
        const double toWall = side == 0 ? p.centre[i][a] : p.size[a] - p.centre[i][a];
        if (p.radius[i] - toWall < -gap)
          continue;
        Contact c{ static_cast<std::int32_t>(i), -1 - static_cast<std::int32_t>(2 * a) - side, {}, {}, {},
          p.radius[i] - toWall };
        c.normal[a] = side == 0 ? -1 : 1;
        c.branch[a] = c.normal[a] * toWall;
        p.contacts.push_back(c);
      }
}

} // namespace

Packing packingOf(int dimension, std::span<const std::array<double, 3>> centre, std::span<const double> radius,
  std::optional<std::array<double, 3>> size, double touching)
{
  if (dimension != 2 && dimension != 3)
    throw ParameterError(fmt::format("grains in {} dimensions", dimension), "2: disks, 3: spheres");
  const auto axes = static_cast<std::size_t>(dimension);
  const auto [low, high] = checkedExtent(axes, centre, radius);
  Packing p;
  p.dimension = dimension;
  std::array<double, 3> origin{ 0, 0, 0 };
  for (std::size_t a = 0; a < axes; ++a)
  {
    origin[a] = size ? 0 : low[a];
    p.size[a] = size ? (*size)[a] : high[a] - low[a];
  }
  const double mean = 2 * std::accumulate(radius.begin(), radius.end(), 0.0) / static_cast<double>(radius.size());
  for (std::size_t i = 0; i < radius.size(); ++i)
  {
    std::array<double, 3> c{ 0, 0, 0 };
    for (std::size_t a = 0; a < axes; ++a)
    {
      c[a] = centre[i][a] - origin[a];
      if (c[a] < 0 || c[a] > p.size[a])
        throw InputError(fmt::format("the centre of grain {} lies outside the box: {:g} of 0 to {:g} along {}", i + 1,
                           c[a], p.size[a], "xyz"[a]),
          "give a larger box, or none: then it is as large as the grains need");
    }
    p.centre.push_back(c);
    p.radius.push_back(radius[i]);
  }
  requireTogether(p, mean);
  findContacts(p, touching * mean);
  warnOfGrainsOutside(p);
  findWallContacts(p, touching * mean);
  return p;
}

} // namespace lamella::packing
