#include "cracks/ThroughPath.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <queue>
#include <unordered_map>

namespace lamella::cracks
{
namespace
{

constexpr double far = std::numeric_limits<double>::infinity();
constexpr double dearer = 10; ///< to go through solid than through voids and cracks

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

  /// The void node that is nearest to a place, at most so far away.
  [[nodiscard]] std::optional<Place> nearest(const Place& place, double reach) const
  {
    std::optional<Place> found;
    const auto steps = static_cast<std::int64_t>(std::ceil(reach));
    for (std::int64_t y = std::llround(place[1]) - steps; y <= std::llround(place[1]) + steps; ++y)
      for (std::int64_t x = std::llround(place[0]) - steps; x <= std::llround(place[0]) + steps; ++x)
        if (isVoid(x, y))
        {
          const Place node{ static_cast<double>(x), static_cast<double>(y) };
          if (const double d = distance(place, node); d <= reach)
          {
            reach = d;
            found = node;
          }
        }
    return found;
  }

  /// The region beside a place; −1: there is none.
  int at(const Place& place)
  {
    const std::optional<Place> node = nearest(place, 1.5);
    if (!node)
      return -1;
    const std::int64_t start = lattice_.index(std::llround((*node)[0]), std::llround((*node)[1]));
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
  Network(const CrackPaths& paths, const Lattice& lattice, std::span<const std::uint8_t> solid, int axis, double reach)
    : lattice_(lattice)
    , axis_(static_cast<std::size_t>(axis))
    , reach_(reach)
    , voids_(lattice, solid)
  {
    for (std::size_t p = 0; p < paths.paths.size(); ++p)
    {
      const CrackPath& path = paths.paths[p];
      const std::size_t a = end(path.points.front().place, path.ends[0]);
      const std::size_t b = end(path.points.back().place, path.ends[1]);
      join(a, b, path.length, static_cast<std::int64_t>(p));
    }
    for (std::size_t a = places_.size(); a-- > 0;)
      if (kinds_[a] == ChainEnd::Tip)
        if (const std::optional<Place> node = voids_.nearest(places_[a], reach_))
          join(a, end(*node, ChainEnd::Void), distance(places_[a], *node), throughSolid);
    for (std::size_t a = 0; a < places_.size(); ++a)
      for (std::size_t b = 0; b < a; ++b)
      {
        const double across = distance(places_[a], places_[b]);
        if (region_[a] >= 0 && region_[a] == region_[b])
          join(a, b, across, throughVoid);
        else if (across <= reach_)
          join(a, b, across, throughSolid);
      }
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
      if (const Link side = toSide(i, false); side.length < far)
      {
        reached[i] = side.cost();
        first[i] = true;
        queue.push({ reached[i], i });
      }
    while (!queue.empty())
    {
      const auto [cost, i] = queue.top();
      queue.pop();
      if (cost > reached[i])
        continue;
      for (const Link& link : links_[i])
        if (const double sum = cost + link.cost(); sum < reached[link.to])
        {
          reached[link.to] = sum;
          back[link.to] = { i, link.length, link.path };
          first[link.to] = false;
          queue.push({ sum, link.to });
        }
    }
    std::size_t last = n;
    double least = far;
    for (std::size_t i = 0; i < n; ++i)
      if (const double sum = reached[i] + toSide(i, true).cost(); sum < least)
      {
        least = sum;
        last = i;
      }
    ThroughPath way;
    if (last == n)
      return way;
    const auto go = [&](const Link& link)
    {
      way.length += link.length;
      way.inVoids += link.path == throughVoid ? link.length : 0;
      way.inSolid += link.path == throughSolid ? link.length : 0;
      if (link.path >= 0)
        way.paths.insert(way.paths.begin(), static_cast<std::size_t>(link.path));
    };
    go(toSide(last, true));
    std::size_t i = last;
    for (; !first[i]; i = back[i].to)
      go(back[i]);
    go(toSide(i, false));
    way.found = !way.paths.empty();
    Place from = places_[i];
    Place to = places_[last];
    from[axis_] = -0.5;
    to[axis_] = static_cast<double>(lattice_.size[axis_]) - 0.5;
    way.chord = distance(from, to);
    return way;
  }

private:
  static constexpr std::int64_t throughVoid = -1;
  static constexpr std::int64_t throughSolid = -2;
  struct Link
  {
    std::size_t to = 0;
    double length = far;
    std::int64_t path = throughVoid; ///< which path, or through what else

    [[nodiscard]] double cost() const { return path == throughSolid ? dearer * length : length; }
  };

  /// From an end to a side: none at the side, else straight across its void or through no more solid than may be.
  [[nodiscard]] Link toSide(std::size_t i, bool high) const
  {
    const double side = high ? static_cast<double>(lattice_.size[axis_]) - 0.5 : -0.5;
    const double away = std::abs(places_[i][axis_] - side);
    if (kinds_[i] == ChainEnd::Border && away < 1e-6)
      return { 0, 0, throughVoid };
    if (region_[i] >= 0 && voids_[region_[i]].touches[2 * axis_ + (high ? 1 : 0)])
      return { 0, away, throughVoid };
    return { 0, away <= reach_ ? away : far, throughSolid };
  }

  void join(std::size_t a, std::size_t b, double length, std::int64_t path)
  {
    links_[a].push_back({ b, length, path });
    links_[b].push_back({ a, length, path });
  }

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
  double reach_;
  Voids voids_;
  std::map<Place, std::size_t> number_;
  std::vector<Place> places_;
  std::vector<ChainEnd> kinds_;
  std::vector<int> region_;
  std::vector<std::vector<Link>> links_;
};

} // namespace

ThroughPath throughPath(
  const CrackPaths& paths, const Lattice& lattice, std::span<const std::uint8_t> solid, int axis, double reach)
{
  return Network(paths, lattice, solid, axis, reach).shortest();
}

} // namespace lamella::cracks
