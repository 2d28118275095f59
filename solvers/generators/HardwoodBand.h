#pragma once

#include "generators/HardwoodLayout.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

/// Internal: the tissue between two rays of a hardwood, as points of a power diagram.
namespace lamella::generators
{

// Proportions of poplar.
constexpr double elongation = 1.2;     // of a vessel: radial over tangential diameter
constexpr double overlap = 0.8;        // distance of two vessels that share a wall, over the sum of their radii
constexpr double vesselScatter = 0.16; // of the vessels' diameters
constexpr double rayWidth = 0.62;      // in fibre diameters, as all that follows
constexpr double rayCellLength = 3.6;
constexpr double rayThickness = 0.8;
constexpr double lateThickness = 1.3;
constexpr double vesselThickness = 0.85;
constexpr double narrowFibres = 0.14; // share of the fibres that are cut near their tips
constexpr double defaultScatter = 0.12;
constexpr int relaxations = 3;

inline double smoothStep(double t)
{
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

inline double areaOf(std::span<const Corner> polygon)
{
  double area = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i)
  {
    const Corner& from = polygon[i];
    const Corner& to = polygon[(i + 1) % polygon.size()];
    area += from.x * to.y - to.x * from.y;
  }
  return area / 2;
}

/// A generating point of the power diagram. Distances are measured with x shortened by `elongation`.
struct HardwoodLayout::Site
{
  double x = 0;
  double y = 0;
  double weight = 0; ///< squared radius
  double radius = 0; ///< of a vessel; 0: a fibre
};

/// The tissue between two rays.
struct HardwoodLayout::Band
{
  std::int64_t number = 0;
  double low = 0, high = 0;
  std::vector<Site> sites;                      ///< vessels first, by rising x
  std::size_t vessels = 0;                      ///< how many
  std::vector<std::vector<std::uint32_t>> bins; ///< fibres by x, one unit a bin
  double from = 0;                              ///< x of the first bin

  void bin()
  {
    for (auto& list : bins)
      list.clear();
    for (std::size_t i = vessels; i < sites.size(); ++i)
      bins[binOf(sites[i].x)].push_back(static_cast<std::uint32_t>(i));
  }
  [[nodiscard]] std::size_t binOf(double x) const
  {
    return static_cast<std::size_t>(std::clamp(x - from, 0.0, static_cast<double>(bins.size()) - 1));
  }
  /// Calls f(site) for the vessels within `toVessels` along x and the fibres within `toFibres`.
  template <class F>
  void near(double x, double toVessels, double toFibres, F&& f) const
  {
    const auto end = sites.begin() + static_cast<std::ptrdiff_t>(vessels);
    auto v = std::lower_bound(sites.begin(), end, x - toVessels, [](const Site& s, double at) { return s.x < at; });
    for (; v != end && v->x <= x + toVessels; ++v)
      f(static_cast<std::size_t>(v - sites.begin()));
    for (std::size_t b = binOf(x - toFibres); b <= binOf(x + toFibres); ++b)
      for (const std::uint32_t i : bins[b])
        f(static_cast<std::size_t>(i));
  }
  void add(const Site& site)
  {
    bins[binOf(site.x)].push_back(static_cast<std::uint32_t>(sites.size()));
    sites.push_back(site);
  }
};

} // namespace lamella::generators
