#pragma once

#include "lattice/Phases.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

/// Known geometries in a box 1 wide that repeats, and how they are drawn with n pixels across: for the benchmarks that
/// ask whether error bars hold.
namespace lamella::benchmark
{

using Random = std::mt19937_64;

inline double uniform(Random& random, double low, double high)
{
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

template <class T>
T pick(Random& random, std::initializer_list<T> values)
{
  return values.begin()[random() % values.size()];
}

struct Spot
{
  double x = 0, y = 0, z = 0;
};

using Shape = std::function<bool(Spot)>;

/// Sampled at the centres of pixels. @param height of the box over its width
inline PhaseImage sampled(int dimension, std::array<std::int64_t, 3> size, const Shape& inside, double height = 0)
{
  PhaseImage image;
  image.lattice = makeLattice(size[0], size[1], size[2], dimension, 1.0 / static_cast<double>(size[0]));
  image.phases = PhaseTable({ "matrix", "inclusion" });
  const double h = 1.0 / static_cast<double>(size[0]);
  const double along = height > 0 ? height / static_cast<double>(size[1]) : h;
  for (std::int64_t z = 0; z < size[2]; ++z)
    for (std::int64_t y = 0; y < size[1]; ++y)
      for (std::int64_t x = 0; x < size[0]; ++x)
        image.phase.push_back(inside({ (static_cast<double>(x) + 0.5) * h, (static_cast<double>(y) + 0.5) * along,
                                dimension == 3 ? (static_cast<double>(z) + 0.5) * h : 0.0 })
            ? 1
            : 0);
  return image;
}

inline std::array<std::int64_t, 3> cube(int n, int dimension)
{
  return { n, n, dimension == 3 ? n : 1 };
}

inline double wrapped(double d)
{
  return d - std::round(d);
}

inline double near2(Spot p, Spot q)
{
  const double x = wrapped(p.x - q.x);
  const double y = wrapped(p.y - q.y);
  const double z = wrapped(p.z - q.z);
  return x * x + y * y + z * z;
}

/// Centres of the balls of a cell: simple, body-centred and face-centred cubic.
inline std::vector<Spot> cubicLattice(int kind)
{
  const std::vector<std::vector<Spot>> bases{ { {} }, { {}, { .5, .5, .5 } },
    { {}, { .5, .5, 0 }, { .5, 0, .5 }, { 0, .5, .5 } } };
  return bases[static_cast<std::size_t>(kind)];
}

/// Balls (in the plane disks) around centres that are moved together.
inline Shape balls(std::vector<Spot> centres, Spot shift, double radius)
{
  for (Spot& c : centres)
    c = { c.x + shift.x, c.y + shift.y, c.z + shift.z };
  return [=](Spot p) { return std::ranges::any_of(centres, [&](Spot c) { return near2(p, c) < radius * radius; }); };
}

/// Regular polygons of three to seven corners, turned at random, that do not overlap; in space boxes.
inline Shape randomPolygons(Random& random, int dimension)
{
  struct Grain
  {
    Spot centre;
    double radius;
    int corners;
    double turn;
    double tilt;
  };
  std::vector<Grain> grains;
  const int count = dimension == 2 ? static_cast<int>(6 + random() % 25) : static_cast<int>(3 + random() % 5);
  const double radius = dimension == 2 ? 0.42 / std::sqrt(count) : 0.40 / std::cbrt(count);
  for (int tries = 0; tries < 100000 && static_cast<int>(grains.size()) < count; ++tries)
  {
    const Grain g{ { uniform(random, 0, 1), uniform(random, 0, 1), dimension == 3 ? uniform(random, 0, 1) : 0 },
      radius * uniform(random, 0.8, 1.2), static_cast<int>(3 + random() % 5), uniform(random, 0, std::numbers::pi),
      uniform(random, 0, std::numbers::pi) };
    if (std::ranges::all_of(grains,
          [&](const Grain& o) { return near2(o.centre, g.centre) > std::pow(1.02 * (o.radius + g.radius), 2); }))
      grains.push_back(g);
  }
  return [=](Spot p)
  {
    return std::ranges::any_of(grains,
      [&](const Grain& g)
      {
        const double x = wrapped(p.x - g.centre.x);
        const double y = wrapped(p.y - g.centre.y);
        const double z = wrapped(p.z - g.centre.z);
        const double u = x * std::cos(g.turn) + y * std::sin(g.turn);
        const double v = -x * std::sin(g.turn) + y * std::cos(g.turn);
        if (dimension == 3)
        {
          const double v2 = v * std::cos(g.tilt) + z * std::sin(g.tilt);
          const double w = -v * std::sin(g.tilt) + z * std::cos(g.tilt);
          return std::max({ std::abs(u), std::abs(v2), std::abs(w) }) < g.radius / std::sqrt(3.0);
        }
        const double sector = 2 * std::numbers::pi / g.corners;
        const double angle = std::atan2(v, u);
        const double off = angle - sector * std::round(angle / sector);
        return std::hypot(u, v) * std::cos(off) < g.radius * std::cos(sector / 2);
      });
  };
}

} // namespace lamella::benchmark
