#include "lbm/ContourDiffusion.h"

#include "core/Error.h"
#include "lbm/Links.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lamella::lbm
{
namespace
{

// The conductor of a cut link that is not lumen: the phases of its ends, or any wall where both ends lie in lumens.
double wallOf(std::uint8_t a, std::uint8_t b, std::span<const double> k)
{
  if (a != 0 && b != 0)
    return harmonicMean(k[a], k[b]);
  if (a != 0 || b != 0)
    return k[a != 0 ? a : b];
  return k[1];
}

double inSeries(double share, double lumen, double wall)
{
  if (share >= 1 || share <= 0)
    return share >= 1 ? lumen : wall;
  return wall > 0 && lumen > 0 ? 1 / (share / lumen + (1 - share) / wall) : 0.0;
}

void requireCuts(const micrograph::ContourLattice& lattice, std::span<const double> conductivity)
{
  for (const micrograph::LinkCuts& cuts : lattice.links)
    if (cuts.place.size() != 1 || cuts.across.size() != cuts.link.size() || cuts.share.size() != cuts.link.size())
      throw ParameterError(fmt::format("the lattice has {} lines a link", cuts.place.size()),
        "make it with one line along each link and one across");
  if (conductivity.size() < std::max<std::size_t>(2, lattice.image.phases.size()))
    throw ParameterError(
      fmt::format("{} conductivities for {} phases", conductivity.size(), lattice.image.phases.size()),
      "give one for the lumen, one for the wall and one for every phase more");
  for (const double k : conductivity)
    if (!std::isfinite(k) || k < 0)
      throw ParameterError(fmt::format("a conductivity of {}", k), "give finite values of at least 0");
}

/// The ends of the links of a lattice in a direction; at a face, the only one twice.
class LinkEnds
{
public:
  explicit LinkEnds(const Lattice& lattice)
    : size_{ lattice.size[0], lattice.size[1] }
  {
  }
  [[nodiscard]] std::array<std::int64_t, 2> operator()(int direction, std::int64_t link) const noexcept
  {
    const std::int64_t nx = size_[0];
    const std::int64_t across = direction == 0 ? link / (nx + 1) : link % nx;
    const std::int64_t along = direction == 0 ? link % (nx + 1) : link / nx;
    const std::int64_t low = std::max<std::int64_t>(along - 1, 0);
    const std::int64_t high = std::min(along, size_[static_cast<std::size_t>(direction)] - 1);
    return direction == 0 ? std::array{ low + nx * across, high + nx * across }
                          : std::array{ across + nx * low, across + nx * high };
  }

private:
  std::array<std::int64_t, 2> size_;
};

/// Which lumens lead across along an axis, and which part the walls from side to side.
class Carriers
{
public:
  Carriers(const micrograph::ContourLattice& lattice, int axis)
    : phase_(lattice.image.phase)
    , nx_(lattice.image.lattice.size[0])
    , ny_(lattice.image.lattice.size[1])
    , whole_{ std::vector<bool>(static_cast<std::size_t>((nx_ + 1) * ny_)),
      std::vector<bool>(static_cast<std::size_t>(nx_ * (ny_ + 1))) }
  {
    const LinkEnds ends(lattice.image.lattice);
    for (const int direction : { 0, 1 })
    {
      std::vector<bool>& whole = whole_[static_cast<std::size_t>(direction)];
      for (std::size_t i = 0; i < whole.size(); ++i)
      {
        const auto [a, b] = ends(direction, static_cast<std::int64_t>(i));
        whole[i] = isLumen(a) && isLumen(b);
      }
      const micrograph::LinkCuts& cuts = lattice.links[static_cast<std::size_t>(direction)];
      for (std::size_t c = 0; c < cuts.link.size(); ++c)
        if (cuts.share[c] < 1)
          whole[static_cast<std::size_t>(cuts.link[c])] = false;
    }
    leads_ = leading(axis);
    parts_ = leading(1 - axis);
  }

  /// Are lumen and wall in parallel at a link? They are where the better conductor leads across there: a lumen that
  /// does, or walls, which do, however thin, but where a lumen parts them.
  [[nodiscard]] bool parallel(bool lumenBetter, std::array<std::int64_t, 2> ends, int direction) const
  {
    return lumenBetter ? at(leads_, ends, direction) : !at(parts_, ends, direction);
  }

private:
  [[nodiscard]] bool isLumen(std::int64_t node) const { return phase_[static_cast<std::size_t>(node)] == 0; }

  /// Does one of the ends belong to these lumens, or where both lie in walls a node beside them?
  [[nodiscard]] bool at(const std::vector<bool>& lumens, std::array<std::int64_t, 2> ends, int direction) const
  {
    const auto has = [&](std::int64_t x, std::int64_t y)
    { return x >= 0 && x < nx_ && y >= 0 && y < ny_ && lumens[static_cast<std::size_t>(x + nx_ * y)]; };
    const bool inWalls = !isLumen(ends[0]) && !isLumen(ends[1]);
    const std::int64_t dx = inWalls ? direction : 0;
    const std::int64_t dy = inWalls ? 1 - direction : 0;
    return std::any_of(ends.begin(), ends.end(),
      [&](std::int64_t n) { return has(n % nx_ - dx, n / nx_ - dy) || has(n % nx_ + dx, n / nx_ + dy); });
  }

  /// Nodes of lumens that hang on both faces of an axis, by links that no outline cuts.
  [[nodiscard]] std::vector<bool> leading(int axis) const
  {
    std::vector<bool> found = reached(axis, false);
    const std::vector<bool> other = reached(axis, true);
    for (std::size_t i = 0; i < found.size(); ++i)
      found[i] = found[i] && other[i];
    return found;
  }
  /// On one face.
  [[nodiscard]] std::vector<bool> reached(int axis, bool high) const
  {
    std::vector<bool> found(phase_.size(), false);
    std::vector<std::int64_t> front;
    const auto visit = [&](std::int64_t node, bool whole)
    {
      if (whole && !found[static_cast<std::size_t>(node)])
      {
        found[static_cast<std::size_t>(node)] = true;
        front.push_back(node);
      }
    };
    const auto linkX = [&](std::int64_t x, std::int64_t y)
    { return whole_[0][static_cast<std::size_t>(x + (nx_ + 1) * y)]; };
    const auto linkY = [&](std::int64_t x, std::int64_t y) { return whole_[1][static_cast<std::size_t>(x + nx_ * y)]; };
    for (std::int64_t y = 0; axis == 0 && y < ny_; ++y)
      visit((high ? nx_ - 1 : 0) + nx_ * y, linkX(high ? nx_ : 0, y));
    for (std::int64_t x = 0; axis == 1 && x < nx_; ++x)
      visit(x + nx_ * (high ? ny_ - 1 : 0), linkY(x, high ? ny_ : 0));
    while (!front.empty())
    {
      const std::int64_t node = front.back();
      front.pop_back();
      const std::int64_t x = node % nx_;
      const std::int64_t y = node / nx_;
      if (x > 0)
        visit(node - 1, linkX(x, y));
      if (x + 1 < nx_)
        visit(node + 1, linkX(x + 1, y));
      if (y > 0)
        visit(node - nx_, linkY(x, y));
      if (y + 1 < ny_)
        visit(node + nx_, linkY(x, y + 1));
    }
    return found;
  }

  std::span<const std::uint8_t> phase_;
  std::int64_t nx_;
  std::int64_t ny_;
  std::array<std::vector<bool>, 2> whole_; ///< by direction: links in lumens that no outline cuts
  std::vector<bool> leads_;
  std::vector<bool> parts_;
};

} // namespace

LinkTable linksOf(const micrograph::ContourLattice& lattice, std::span<const double> conductivity, int axis)
{
  requireCuts(lattice, conductivity);
  const Carriers carriers(lattice, axis);
  const LinkEnds ends(lattice.image.lattice);
  const std::int64_t nx = lattice.image.lattice.size[0];
  const std::int64_t ny = lattice.image.lattice.size[1];
  const std::uint8_t* phase = lattice.image.phase.data();
  LinkTable table(nx, ny);
  for (const int direction : { 0, 1 })
  {
    std::vector<double>& g = direction == 0 ? table.x : table.y;
    for (std::size_t i = 0; i < g.size(); ++i)
    {
      const auto [a, b] = ends(direction, static_cast<std::int64_t>(i));
      g[i] = harmonicMean(conductivity[phase[a]], conductivity[phase[b]]);
    }
    const micrograph::LinkCuts& cuts = lattice.links[static_cast<std::size_t>(direction)];
    for (std::size_t c = 0; c < cuts.link.size(); ++c)
    {
      const auto nodes = ends(direction, cuts.link[c]);
      const double wall = wallOf(phase[nodes[0]], phase[nodes[1]], conductivity);
      const double lumen = conductivity[0];
      const double across = cuts.across[c];
      g[static_cast<std::size_t>(cuts.link[c])] = carriers.parallel(lumen > wall, nodes, direction)
        ? across * lumen + (1 - across) * wall
        : inSeries(cuts.share[c], lumen, wall);
    }
  }
  return table;
}

} // namespace lamella::lbm
