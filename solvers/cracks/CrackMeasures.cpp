#include "cracks/CrackMeasures.h"

#include "peridynamics/Stencil.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <tuple>

namespace lamella::cracks
{
namespace
{

auto keyOf(const PairShare& s)
{
  return std::make_tuple(s.phases, s.betweenGrains);
}

PairShare& shareOf(std::vector<PairShare>& list, const std::array<std::uint8_t, 2>& phases, bool between)
{
  PairShare wanted;
  wanted.phases = phases;
  wanted.betweenGrains = between;
  const auto at = std::lower_bound(
    list.begin(), list.end(), wanted, [](const PairShare& a, const PairShare& b) { return keyOf(a) < keyOf(b); });
  return at != list.end() && keyOf(*at) == keyOf(wanted) ? *at : *list.insert(at, wanted);
}

double segment(const CrackPath& path, std::size_t i)
{
  const Place& a = path.points[i].place;
  const Place& b = path.points[i + 1].place;
  return std::hypot(b[0] - a[0], b[1] - a[1]);
}

/// Points that no bond tells of are as the nearest one that one does.
template <class Known, class Copy>
void fillGaps(std::size_t count, const Known& known, const Copy& copy)
{
  std::vector<std::size_t> from(count, count);
  const auto nearer = [&](std::size_t i, std::size_t last)
  {
    const auto gap = [&](std::size_t a) { return a > i ? a - i : i - a; };
    if (last < count && (from[i] == count || gap(last) < gap(from[i])))
      from[i] = last;
  };
  std::size_t last = count;
  for (std::size_t i = 0; i < count; ++i)
    nearer(i, last = known(i) ? i : last);
  last = count;
  for (std::size_t i = count; i-- > 0;)
    nearer(i, last = known(i) ? i : last);
  for (std::size_t i = 0; i < count; ++i)
    if (from[i] < count && from[i] != i)
      copy(from[i], i);
}

/// When half of the bonds at each point were broken.
void setEvents(CrackPath& path, std::span<const CutBond> bonds, std::span<const OwnBond> own)
{
  const std::size_t n = path.points.size();
  std::vector<std::vector<std::size_t>> at(n);
  for (const OwnBond& o : own)
    at[o.point].push_back(o.bond);
  for (std::size_t i = 0; i < n; ++i)
    if (std::vector<std::size_t>& list = at[i]; !list.empty())
    {
      std::sort(list.begin(), list.end()); // the order in which they broke
      const CutBond& middle = bonds[list[(list.size() - 1) / 2]];
      path.points[i].event = middle.event;
      path.points[i].when = middle.when;
    }
  fillGaps(
    n, [&](std::size_t i) { return !at[i].empty(); },
    [&](std::size_t from, std::size_t to)
    {
      path.points[to].event = path.points[from].event;
      path.points[to].when = path.points[from].when;
    });
}

/// The phases of the two nodes that the crack parts: as the image has them, or as the bond between them says; where
/// that is missing, the shortest broken bond there.
void setPhases(CrackPath& path, std::span<const CutBond> bonds, std::span<const OwnBond> own, const Lattice& lattice,
  std::span<const std::uint8_t> phase)
{
  const std::size_t n = path.points.size();
  const auto square = [&](std::size_t b)
  { return bonds[b].step[0] * bonds[b].step[0] + bonds[b].step[1] * bonds[b].step[1]; };
  constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> teller(n, none);
  std::map<std::tuple<std::int64_t, std::int64_t, int>, std::size_t> direct;
  for (const OwnBond& o : own)
  {
    const CutBond& b = bonds[o.bond];
    if (square(o.bond) == 1)
      direct[{ b.node[0] + std::min(b.step[0], 0), b.node[1] + std::min(b.step[1], 0), b.step[0] != 0 ? 0 : 1 }] =
        o.bond;
    if (teller[o.point] == none || square(o.bond) < square(teller[o.point]))
      teller[o.point] = o.bond;
  }
  for (std::size_t k = 0; k < path.edges.size(); ++k)
    if (const auto found = direct.find({ path.edges[k].x, path.edges[k].y, path.edges[k].axis }); found != direct.end())
      teller[1 + k] = found->second;
  for (std::size_t i = 0; i < n; ++i)
    if (teller[i] != none)
    {
      path.points[i].phases = bonds[teller[i]].phases;
      path.points[i].betweenGrains = bonds[teller[i]].betweenGrains;
    }
  fillGaps(
    n, [&](std::size_t i) { return teller[i] != none; },
    [&](std::size_t from, std::size_t to)
    {
      path.points[to].phases = path.points[from].phases;
      path.points[to].betweenGrains = path.points[from].betweenGrains;
    });
  for (std::size_t k = 0; !phase.empty() && k < path.edges.size(); ++k)
  {
    const CrackEdge& e = path.edges[k];
    const std::int64_t node = lattice.index(e.x, e.y);
    const std::uint8_t a = phase[static_cast<std::size_t>(node)];
    const std::uint8_t b = phase[static_cast<std::size_t>(node + (e.axis == 0 ? 1 : lattice.size[0]))];
    path.points[1 + k].phases = { std::min(a, b), std::max(a, b) };
  }
  // no pair is parted at the ends themselves
  for (const auto& [to, from] : { std::pair{ std::size_t{ 0 }, std::size_t{ 1 } }, std::pair{ n - 1, n - 2 } })
  {
    path.points[to].phases = path.points[from].phases;
    path.points[to].betweenGrains = path.points[from].betweenGrains;
  }
}

Orientation orientation(double length, double cosine, double sine)
{
  if (!(length > 0))
    return {};
  const double r = std::min(1.0, std::hypot(cosine, sine) / length);
  return { std::atan2(sine, cosine) / 2,
    r > 0 ? std::sqrt(std::max(0.0, -2 * std::log(r))) / 2 : std::numbers::pi / 2 };
}

} // namespace

double CrackPath::tortuosity() const noexcept
{
  return chord > 0 ? length / chord : std::numeric_limits<double>::quiet_NaN();
}

void add(std::vector<PairShare>& all, std::span<const PairShare> more)
{
  for (const PairShare& s : more)
  {
    PairShare& sum = shareOf(all, s.phases, s.betweenGrains);
    sum.length += s.length;
    sum.bonds += s.bonds;
    sum.counted += s.counted;
  }
}

std::vector<PairShare> bondsByPair(std::span<const CutBond> bonds, const BondCount& count)
{
  std::vector<PairShare> list;
  for (const CutBond& b : bonds)
  {
    PairShare& s = shareOf(list, b.phases, b.betweenGrains);
    ++s.bonds;
    s.counted += count.weight(b.step);
  }
  return list;
}

Orientation orientationOf(std::span<const CrackPath> paths)
{
  double length = 0;
  double cosine = 0;
  double sine = 0;
  for (const CrackPath& path : paths)
    for (std::size_t i = 0; i + 1 < path.points.size(); ++i)
    {
      const double l = segment(path, i);
      const Place& a = path.points[i].place;
      const Place& b = path.points[i + 1].place;
      const double twice = 2 * std::atan2(b[1] - a[1], b[0] - a[0]);
      length += l;
      cosine += l * std::cos(twice);
      sine += l * std::sin(twice);
    }
  return orientation(length, cosine, sine);
}

void measure(CrackPath& path, std::span<const CutBond> bonds, std::span<const OwnBond> own, const Lattice& lattice,
  double horizon, const BondCount& count, std::span<const std::uint8_t> phase)
{
  const peridynamics::Stencil stencil(2, horizon);
  path.orientation = orientationOf(std::span(&path, 1));
  const bool closed = path.ends[0] == ChainEnd::None;
  const Place& first = path.points.front().place;
  const Place& last = path.points.back().place;
  path.chord = closed ? 0 : std::hypot(last[0] - first[0], last[1] - first[1]);
  path.bonds = static_cast<std::int64_t>(own.size());
  setEvents(path, bonds, own);
  setPhases(path, bonds, own, lattice, phase);
  path.length = 0;
  path.expectedBonds = 0;
  for (std::size_t i = 0; i + 1 < path.points.size(); ++i)
  {
    const double l = segment(path, i);
    path.length += l;
    const Place& a = path.points[i].place;
    const Place& b = path.points[i + 1].place;
    for (const peridynamics::Offset& o : stencil.half())
      path.expectedBonds += std::abs(o.step[0] * (b[1] - a[1]) - o.step[1] * (b[0] - a[0]));
    for (const std::size_t end : { i, i + 1 })
      shareOf(path.pairs, path.points[end].phases, path.points[end].betweenGrains).length += l / 2;
  }
  std::size_t earliest = bonds.size();
  std::size_t latest = 0;
  for (const OwnBond& o : own)
  {
    const CutBond& b = bonds[o.bond];
    PairShare& s = shareOf(path.pairs, b.phases, b.betweenGrains);
    ++s.bonds;
    s.counted += count.weight(b.step);
    earliest = std::min(earliest, o.bond);
    latest = std::max(latest, o.bond);
  }
  if (!own.empty())
  {
    path.events = { bonds[earliest].event, bonds[latest].event };
    path.when = { bonds[earliest].when, bonds[latest].when };
  }
}

} // namespace lamella::cracks
