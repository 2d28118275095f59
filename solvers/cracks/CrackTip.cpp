#include "cracks/CrackTip.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <queue>
#include <utility>

namespace lamella::cracks
{
namespace
{

constexpr double farAway = std::numeric_limits<double>::infinity();

/// The paths of a crack between the places where they end; paths that meet share a place.
class Branches
{
public:
  Branches(const CrackPaths& paths, const Crack& crack)
  {
    for (const std::size_t p : crack.paths)
    {
      const CrackPath& path = paths.paths[p];
      const std::array<std::size_t, 2> at{ vertex(path.points.front().place), vertex(path.points.back().place) };
      branches_.push_back({ &path, at });
      for (std::size_t end = 0; end < 2; ++end)
      {
        links_[at[end]].push_back({ path.length, at[1 - end] });
        if (path.ends[end] != ChainEnd::Junction && path.ends[end] != ChainEnd::None)
          ends_.push_back({ at[end], path.ends[end] });
      }
    }
  }

  struct End
  {
    std::size_t vertex;
    ChainEnd kind;
  };
  [[nodiscard]] const std::vector<End>& ends() const noexcept { return ends_; }
  [[nodiscard]] const Place& place(const End& end) const { return places_[end.vertex]; }

  /// A point of the crack.
  struct Spot
  {
    Place place;
    std::array<std::size_t, 2> vertices; ///< the ends of its path
    std::array<double, 2> away;          ///< how farAway these are
  };
  /// Where it broke first.
  [[nodiscard]] std::vector<Spot> starts() const
  {
    std::int64_t first = std::numeric_limits<std::int64_t>::max();
    for (const Branch& branch : branches_)
      for (const CrackPoint& point : branch.path->points)
        first = std::min(first, point.event);
    std::vector<Spot> spots;
    for (const Branch& branch : branches_)
    {
      double along = 0;
      const std::vector<CrackPoint>& points = branch.path->points;
      for (std::size_t i = 0; i < points.size(); ++i)
      {
        along += i > 0 ? distance(points[i - 1].place, points[i].place) : 0;
        if (points[i].event == first)
          spots.push_back({ points[i].place, branch.vertices, { along, std::max(0.0, branch.path->length - along) } });
      }
    }
    return spots;
  }
  /// @param reached as distancesFrom() gives them
  [[nodiscard]] static double lengthTo(const Spot& spot, const std::vector<double>& reached)
  {
    return std::min(reached[spot.vertices[0]] + spot.away[0], reached[spot.vertices[1]] + spot.away[1]);
  }

  /// How farAway all vertices are from one, along the paths.
  [[nodiscard]] std::vector<double> distancesFrom(std::size_t vertex) const
  {
    std::vector<double> reached(places_.size(), farAway);
    using Entry = std::pair<double, std::size_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    reached[vertex] = 0;
    queue.push({ 0, vertex });
    while (!queue.empty())
    {
      const auto [length, here] = queue.top();
      queue.pop();
      if (length > reached[here])
        continue;
      for (const auto& [more, there] : links_[here])
        if (length + more < reached[there])
        {
          reached[there] = length + more;
          queue.push({ reached[there], there });
        }
    }
    return reached;
  }

private:
  struct Branch
  {
    const CrackPath* path;
    std::array<std::size_t, 2> vertices;
  };

  std::size_t vertex(const Place& place)
  {
    const auto [known, added] = known_.try_emplace(place, places_.size());
    if (added)
    {
      places_.push_back(place);
      links_.emplace_back();
    }
    return known->second;
  }

  std::vector<Branch> branches_;
  std::vector<End> ends_;
  std::vector<Place> places_;
  std::vector<std::vector<std::pair<double, std::size_t>>> links_;
  std::map<Place, std::size_t> known_;
};

} // namespace

CrackTip crackTip(const CrackPaths& paths, std::size_t crack, double horizon)
{
  const Branches branches(paths, paths.cracks.at(crack));
  const std::vector<Branches::End>& ends = branches.ends();
  const std::vector<Branches::Spot> starts = branches.starts();
  std::vector<std::vector<double>> reached; // from each end
  CrackTip found;
  std::size_t tip = 0;
  const Branches::Spot* start = nullptr;
  for (const Branches::End& end : ends)
  {
    reached.push_back(branches.distancesFrom(end.vertex));
    for (const Branches::Spot& spot : starts)
      if (const double length = Branches::lengthTo(spot, reached.back()); start == nullptr || length > found.extension)
      {
        start = &spot;
        tip = reached.size() - 1;
        found = { true, spot.place, branches.place(end), end.kind, length };
      }
  }
  double nearest = horizon;
  for (std::size_t e = 0; start != nullptr && e < ends.size(); ++e)
    if (const double length = e == tip ? farAway : Branches::lengthTo(*start, reached[e]); length <= nearest)
    {
      nearest = length;
      found.start = branches.place(ends[e]);
      found.extension = reached[tip][ends[e].vertex];
    }
  return found;
}

} // namespace lamella::cracks
