#include "cracks/ThroughPath.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <queue>
#include <unordered_map>

namespace lamella::cracks
{
namespace
{

constexpr double far = std::numeric_limits<double>::infinity();

double distance(const Place& a, const Place& b)
{
  return std::hypot(a[0] - b[0], a[1] - b[1]);
}

/// Void regions in which paths end, nodes at corners of each other included.
class Voids
{
public:
  Voids(const Lattice& lattice, std::span<const std::uint8_t> solid)
    : lattice_(lattice)
    , solid_(solid)
  {
  }

  struct Region
  {
    std::array<bool, 4> touches{}; ///< low x, high x, low y, high y
  };

  /// The region beside a place; −1: there is none.
  int at(const Place& place)
  {
    double nearest = 1.5;
    std::int64_t start = -1;
    for (std::int64_t y = std::llround(place[1]) - 1; y <= std::llround(place[1]) + 1; ++y)
      for (std::int64_t x = std::llround(place[0]) - 1; x <= std::llround(place[0]) + 1; ++x)
        if (isVoid(x, y))
          if (const double d = distance(place, { static_cast<double>(x), static_cast<double>(y) }); d < nearest)
          {
            nearest = d;
            start = lattice_.index(x, y);
          }
    if (start < 0)
      return -1;
    const auto known = region_.find(start);
    return known != region_.end() ? known->second : flood(start);
  }
  [[nodiscard]] const Region& operator[](int region) const { return regions_[static_cast<std::size_t>(region)]; }

private:
  [[nodiscard]] bool isVoid(std::int64_t x, std::int64_t y) const
  {
    return !solid_.empty() && x >= 0 && y >= 0 && x < lattice_.size[0] && y < lattice_.size[1] &&
      solid_[static_cast<std::size_t>(lattice_.index(x, y))] == 0;
  }

  int flood(std::int64_t start)
  {
    const auto number = static_cast<int>(regions_.size());
    Region region;
    std::vector<std::int64_t> stack{ start };
    region_[start] = number;
    while (!stack.empty())
    {
      const std::int64_t node = stack.back();
      stack.pop_back();
      const std::int64_t x = node % lattice_.size[0];
      const std::int64_t y = node / lattice_.size[0];
      const std::array<bool, 4> here{ x == 0, x == lattice_.size[0] - 1, y == 0, y == lattice_.size[1] - 1 };
      for (std::size_t side = 0; side < 4; ++side)
        region.touches[side] = region.touches[side] || here[side];
      for (std::int64_t m = y - 1; m <= y + 1; ++m)
        for (std::int64_t n = x - 1; n <= x + 1; ++n)
          if (isVoid(n, m) && region_.try_emplace(lattice_.index(n, m), number).second)
            stack.push_back(lattice_.index(n, m));
    }
    regions_.push_back(region);
    return number;
  }

  const Lattice& lattice_;
  std::span<const std::uint8_t> solid_;
  std::unordered_map<std::int64_t, int> region_;
  std::vector<Region> regions_;
};

/// Ends of paths, and how one gets from one to another.
class Network
{
public:
  Network(const CrackPaths& paths, const Lattice& lattice, std::span<const std::uint8_t> solid, int axis)
    : lattice_(lattice)
    , axis_(static_cast<std::size_t>(axis))
    , voids_(lattice, solid)
  {
    for (std::size_t p = 0; p < paths.paths.size(); ++p)
    {
      const CrackPath& path = paths.paths[p];
      const std::size_t a = end(path.points.front().place, path.ends[0]);
      const std::size_t b = end(path.points.back().place, path.ends[1]);
      links_[a].push_back({ b, path.length, static_cast<std::int64_t>(p) });
      links_[b].push_back({ a, path.length, static_cast<std::int64_t>(p) });
    }
    for (std::size_t a = 0; a < places_.size(); ++a)
      for (std::size_t b = 0; b < a; ++b)
        if (region_[a] >= 0 && region_[a] == region_[b])
        {
          const double across = distance(places_[a], places_[b]);
          links_[a].push_back({ b, across, -1 });
          links_[b].push_back({ a, across, -1 });
        }
  }

  /// How far it is from an end to a side straight across its void; 0 at the side, infinite where it does not lead
  /// there.
  [[nodiscard]] double toSide(std::size_t i, bool high) const
  {
    const double side = high ? static_cast<double>(lattice_.size[axis_]) - 0.5 : -0.5;
    const double away = std::abs(places_[i][axis_] - side);
    if (kinds_[i] == ChainEnd::Border && away < 1e-6)
      return 0;
    return region_[i] >= 0 && voids_[region_[i]].touches[2 * axis_ + (high ? 1 : 0)] ? away : far;
  }

  /// Dijkstra's algorithm from the low side to the high one.
  [[nodiscard]] ThroughPath shortest() const
  {
    const std::size_t n = places_.size();
    std::vector<double> reached(n, far);
    std::vector<Link> back(n); // where from
    std::vector<bool> first(n, false);
    using Entry = std::pair<double, std::size_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    for (std::size_t i = 0; i < n; ++i)
      if (const double d = toSide(i, false); d < far)
      {
        reached[i] = d;
        first[i] = true;
        queue.push({ d, i });
      }
    while (!queue.empty())
    {
      const auto [d, i] = queue.top();
      queue.pop();
      if (d > reached[i])
        continue;
      for (const Link& link : links_[i])
        if (d + link.length < reached[link.to])
        {
          reached[link.to] = d + link.length;
          back[link.to] = { i, link.length, link.path };
          first[link.to] = false;
          queue.push({ reached[link.to], link.to });
        }
    }
    std::size_t last = n;
    double least = far;
    for (std::size_t i = 0; i < n; ++i)
      if (reached[i] + toSide(i, true) < least)
      {
        least = reached[i] + toSide(i, true);
        last = i;
      }
    ThroughPath way;
    if (last == n)
      return way;
    way.length = least;
    way.inVoids = toSide(last, true);
    std::size_t i = last;
    for (; !first[i]; i = back[i].to)
      if (back[i].path >= 0)
        way.paths.insert(way.paths.begin(), static_cast<std::size_t>(back[i].path));
      else
        way.inVoids += back[i].length;
    way.inVoids += toSide(i, false);
    way.found = !way.paths.empty();
    Place from = places_[i];
    Place to = places_[last];
    from[axis_] = -0.5;
    to[axis_] = static_cast<double>(lattice_.size[axis_]) - 0.5;
    way.chord = distance(from, to);
    return way;
  }

private:
  struct Link
  {
    std::size_t to = 0;
    double length = 0;
    std::int64_t path = -1; ///< −1: across a void
  };

  std::size_t end(const Place& place, ChainEnd kind)
  {
    const auto [known, fresh] = number_.try_emplace(place, places_.size());
    if (fresh)
    {
      places_.push_back(place);
      kinds_.push_back(kind);
      region_.push_back(kind == ChainEnd::Void ? voids_.at(place) : -1);
      links_.emplace_back();
    }
    return known->second;
  }

  const Lattice& lattice_;
  std::size_t axis_;
  Voids voids_;
  std::map<Place, std::size_t> number_;
  std::vector<Place> places_;
  std::vector<ChainEnd> kinds_;
  std::vector<int> region_;
  std::vector<std::vector<Link>> links_;
};

} // namespace

ThroughPath throughPath(const CrackPaths& paths, const Lattice& lattice, std::span<const std::uint8_t> solid, int axis)
{
  return Network(paths, lattice, solid, axis).shortest();
}

} // namespace lamella::cracks
