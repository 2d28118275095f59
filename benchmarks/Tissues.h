#pragma once

#include "Shapes.h"

#include "generators/Generators.h"
#include "lattice/Phases.h"
#include "lattice/SubWindows.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

/// Large samples of random materials to cut windows out of: phases 0 and 1, lumen and wall or matrix and inclusion.
namespace lamella::benchmark
{

/// Phase 1 where `inside` holds of a pixel's centre, in pixels.
template <class Inside>
PhaseImage painted(int dimension, std::int64_t n, Inside&& inside)
{
  PhaseImage image;
  image.lattice = makeLattice(n, n, dimension == 3 ? n : 1, dimension, 1e-6);
  image.phases = PhaseTable({ "lumen", "wall" });
  image.phase.reserve(static_cast<std::size_t>(image.lattice.count()));
  for (std::int64_t z = 0; z < image.lattice.size[2]; ++z)
    for (std::int64_t y = 0; y < n; ++y)
      for (std::int64_t x = 0; x < n; ++x)
        image.phase.push_back(inside(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5) ? 1 : 0);
  return image;
}

/// Voronoi cells of one seed a box of `cell` pixels, between walls of one thickness.
inline PhaseImage foam(std::int64_t n, double cell, double wall, std::uint64_t seed)
{
  Random random(seed);
  const auto boxes = static_cast<std::int64_t>(static_cast<double>(n) / cell);
  const double edge = static_cast<double>(n) / static_cast<double>(boxes);
  std::vector<Spot> sites;
  for (std::int64_t j = 0; j < boxes; ++j)
    for (std::int64_t i = 0; i < boxes; ++i)
      sites.push_back({ (static_cast<double>(i) + uniform(random, 0.1, 0.9)) * edge,
        (static_cast<double>(j) + uniform(random, 0.1, 0.9)) * edge, 0 });
  return painted(2, n,
    [&](double x, double y)
    {
      const auto bi = static_cast<std::int64_t>(x / edge);
      const auto bj = static_cast<std::int64_t>(y / edge);
      double nearest = 1e300;
      double next = 1e300;
      Spot a;
      Spot b;
      for (std::int64_t j = std::max<std::int64_t>(0, bj - 2); j <= std::min(boxes - 1, bj + 2); ++j)
        for (std::int64_t i = std::max<std::int64_t>(0, bi - 2); i <= std::min(boxes - 1, bi + 2); ++i)
        {
          const Spot s = sites[static_cast<std::size_t>(j * boxes + i)];
          const double d = (s.x - x) * (s.x - x) + (s.y - y) * (s.y - y);
          if (d < nearest)
          {
            next = nearest;
            b = a;
            nearest = d;
            a = s;
          }
          else if (d < next)
          {
            next = d;
            b = s;
          }
        }
      return (next - nearest) / (2 * std::hypot(a.x - b.x, a.y - b.y)) < wall / 2; // from their bisector
    });
}

/// Disks (spheres) at random places, as much of them as `share` of the box, each counted alone; those that do not
/// overlap keep 3 % apart.
inline PhaseImage balls(
  int dimension, std::int64_t n, double smallest, double largest, double share, bool overlap, std::uint64_t seed)
{
  Random random(seed);
  PhaseImage image = painted(dimension, n, [](double, double) { return false; });
  const double edge = static_cast<double>(n);
  const double bin = 2.1 * largest;
  const auto bins = static_cast<std::int64_t>((edge + 2 * largest) / bin) + 1;
  struct Ball
  {
    Spot at;
    double radius;
  };
  std::vector<std::vector<Ball>> near(static_cast<std::size_t>(dimension == 3 ? bins * bins * bins : bins * bins));
  const auto binOf = [&](double p)
  { return std::clamp<std::int64_t>(static_cast<std::int64_t>((p + largest) / bin), 0, bins - 1); };
  const double box = std::pow(edge + 2 * largest, dimension);
  double filled = 0;
  for (std::int64_t tries = 0; filled < share * box && tries < 50'000'000; ++tries)
  {
    const auto place = [&] { return uniform(random, -largest, edge + largest); };
    const Spot at{ place(), place(), dimension == 3 ? place() : 0.5 };
    const double r = uniform(random, smallest, largest);
    const std::array<std::int64_t, 3> b{ binOf(at.x), binOf(at.y), dimension == 3 ? binOf(at.z) : 0 };
    bool free = true;
    for (std::int64_t k = std::max<std::int64_t>(0, b[2] - 1); !overlap && k <= b[2] + 1; ++k)
      for (std::int64_t j = std::max<std::int64_t>(0, b[1] - 1); j <= std::min(bins - 1, b[1] + 1); ++j)
        for (std::int64_t i = std::max<std::int64_t>(0, b[0] - 1); i <= std::min(bins - 1, b[0] + 1); ++i)
          if (k < (dimension == 3 ? bins : 1))
            for (const Ball& o : near[static_cast<std::size_t>(i + bins * (j + bins * k))])
              free = free &&
                std::hypot(at.x - o.at.x, at.y - o.at.y, dimension == 3 ? at.z - o.at.z : 0) > 1.03 * (r + o.radius);
    if (!free)
      continue;
    near[static_cast<std::size_t>(b[0] + bins * (b[1] + bins * b[2]))].push_back({ at, r });
    filled += dimension == 3 ? 4.0 / 3 * std::numbers::pi * r * r * r : std::numbers::pi * r * r;
    const auto low = [&](double p) { return std::max<std::int64_t>(0, static_cast<std::int64_t>(p - r)); };
    const auto high = [&](double p) { return std::min<std::int64_t>(n - 1, static_cast<std::int64_t>(p + r)); };
    for (std::int64_t z = dimension == 3 ? low(at.z) : 0; z <= (dimension == 3 ? high(at.z) : 0); ++z)
      for (std::int64_t y = low(at.y); y <= high(at.y); ++y)
        for (std::int64_t x = low(at.x); x <= high(at.x); ++x)
          if (std::hypot(static_cast<double>(x) + 0.5 - at.x, static_cast<double>(y) + 0.5 - at.y,
                dimension == 3 ? static_cast<double>(z) + 0.5 - at.z : 0) < r)
            image.phase[static_cast<std::size_t>(image.lattice.index(x, y, z))] = 1;
  }
  return image;
}

inline PhaseImage softwood(std::int64_t n, double spacing, double ring, double solid, std::uint64_t seed)
{
  generators::SoftwoodOptions o;
  o.size = { n, n, 1 };
  o.spacing = spacing;
  o.ringPosition0 = o.ringPosition1 = ring;
  o.solidFraction = solid;
  o.seed = seed;
  return generators::softwood(o);
}

inline PhaseImage hardwood(std::int64_t n, std::uint64_t seed)
{
  generators::HardwoodOptions o;
  o.size = { n, n, 1 };
  o.spacing = 1.6e-6;
  o.solidFraction = 0.45;
  o.seed = seed;
  return generators::hardwood(o);
}

/// A material, a large sample of which is made.
struct Tissue
{
  std::string kind;
  int dimension = 2;
  std::int64_t large = 1200;         ///< nodes along an edge of the large sample
  std::vector<std::int64_t> windows; ///< nodes along an edge of the pictures
  int connected = 1;                 ///< the phase that leads across
  std::function<PhaseImage(std::int64_t, std::uint64_t)> make;
};

/// Those of docs/benchmarks/window.md.
inline std::vector<Tissue> tissues()
{
  using Size = std::int64_t;
  using Seed = std::uint64_t;
  return {
    { "earlywood", 2, 1200, { 192, 288 }, 1, [](Size n, Seed s) { return softwood(n, 2e-6, 0, 0.38, s); } },
    { "latewood", 2, 1200, { 192, 288 }, 1, [](Size n, Seed s) { return softwood(n, 1.5e-6, 0.8, 0.7, s); } },
    { "hardwood", 2, 1200, { 192, 288 }, 1, [](Size n, Seed s) { return hardwood(n, s); } },
    { "foam", 2, 1200, { 96, 192 }, 1, [](Size n, Seed s) { return foam(n, 16, 3, s); } },
    { "aggregate", 2, 1200, { 96, 192 }, 0, [](Size n, Seed s) { return balls(2, n, 4, 9, 0.42, false, s); } },
    { "overlapping disks", 2, 1200, { 96, 192 }, 0, [](Size n, Seed s) { return balls(2, n, 6, 6, 0.6, true, s); } },
    { "overlapping spheres", 3, 160, { 32, 48 }, 0, [](Size n, Seed s) { return balls(3, n, 4, 4, 0.4, true, s); } },
  };
}

/// A window of a large sample, anywhere.
inline PhaseImage someWindow(const PhaseImage& large, std::int64_t edge, Random& random)
{
  SubWindow window;
  for (std::size_t a = 0; a < 3; ++a)
    if (large.lattice.size[a] > 1)
    {
      window.size[a] = edge;
      window.first[a] =
        static_cast<std::int64_t>(uniform(random, 0, static_cast<double>(large.lattice.size[a] - edge + 1)));
    }
  return cut(large, window);
}

} // namespace lamella::benchmark
