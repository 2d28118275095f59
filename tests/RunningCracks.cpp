#include "RunningCracks.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

namespace lamella::peridynamics
{

PlanePoint middleOf(const Bond& bond, const Stencil& stencil, const Lattice& lattice)
{
  const auto& step = stencil.half()[static_cast<std::size_t>(bond.offset)].step;
  PlanePoint p{};
  for (std::size_t a = 0; a < 2; ++a)
    p[a] = lattice.origin[a] + (static_cast<double>(bond.node[a]) + 0.5 * step[a]) * lattice.spacing;
  return p;
}

Bond mirrored(const Bond& bond, const Stencil& stencil, const Lattice& lattice)
{
  const auto& half = stencil.half();
  auto step = half[static_cast<std::size_t>(bond.offset)].step;
  Bond image = bond;
  // The end that is first after the mirror: the other one, unless the bond lies along the mirror.
  if (step[1] != 0)
  {
    image.node[0] += step[0];
    image.node[1] += step[1];
    step[0] = -step[0];
  }
  image.node[1] = lattice.size[1] - 1 - image.node[1];
  const auto found = std::find_if(half.begin(), half.end(), [&](const Offset& o) { return o.step == step; });
  image.offset = static_cast<int>(found - half.begin());
  return image;
}

MirrorSymmetry mirrorSymmetry(std::span<const DynamicBreak> broken, const Stencil& stencil, const Lattice& lattice)
{
  std::map<Bond, std::int64_t> steps;
  for (const DynamicBreak& b : broken)
    steps[b.bond] = b.step;
  MirrorSymmetry m;
  if (broken.empty())
    return m;
  std::int64_t both = 0;
  std::int64_t same = 0;
  m.until = broken.back().time;
  bool odd = false;
  for (const DynamicBreak& b : broken)
  {
    const auto image = steps.find(mirrored(b.bond, stencil, lattice));
    const bool paired = image != steps.end() && image->second == b.step;
    both += image != steps.end() ? 1 : 0;
    same += paired ? 1 : 0;
    if (!paired && !odd)
    {
      odd = true;
      m.until = b.time - b.time / static_cast<double>(std::max<std::int64_t>(1, b.step));
    }
  }
  m.share = static_cast<double>(both) / static_cast<double>(broken.size());
  m.sameStep = both > 0 ? static_cast<double>(same) / static_cast<double>(both) : 0;
  return m;
}

FittedLine fitLine(std::span<const PlanePoint> points)
{
  if (points.size() < 2)
    throw ParameterError(fmt::format("a line through {} points", points.size()), "give at least two");
  FittedLine line;
  const auto n = static_cast<double>(points.size());
  for (const PlanePoint& p : points)
    for (std::size_t a = 0; a < 2; ++a)
      line.centre[a] += p[a] / n;
  double xx = 0;
  double yy = 0;
  double xy = 0;
  for (const PlanePoint& p : points)
  {
    const double x = p[0] - line.centre[0];
    const double y = p[1] - line.centre[1];
    xx += x * x / n;
    yy += y * y / n;
    xy += x * y / n;
  }
  line.angle = 0.5 * std::atan2(2 * xy, xx - yy);
  line.deviation = std::sqrt(std::max(0.0, (xx + yy) / 2 - std::hypot((xx - yy) / 2, xy)));
  const auto along = [&](const PlanePoint& p) { return p[0] * std::cos(line.angle) + p[1] * std::sin(line.angle); };
  const auto [first, last] = std::minmax_element(
    points.begin(), points.end(), [&](const auto& a, const auto& b) { return along(a) < along(b); });
  line.length = along(*last) - along(*first);
  return line;
}

std::vector<TipPoint> tipAdvance(std::span<const DynamicBreak> broken, const Stencil& stencil, const Lattice& lattice,
  const PlanePoint& direction, double reach)
{
  const double norm = std::hypot(direction[0], direction[1]);
  // Cells of the size of the reach: a neighbour lies in the same one or the next.
  std::map<std::pair<std::int64_t, std::int64_t>, std::vector<PlanePoint>> cells;
  const auto cellOf = [&](double x) { return static_cast<std::int64_t>(std::floor(x / reach)); };
  const auto joined = [&](const PlanePoint& p)
  {
    int near = 0; // itself too
    for (std::int64_t x = cellOf(p[0]) - 1; x <= cellOf(p[0]) + 1; ++x)
      for (std::int64_t y = cellOf(p[1]) - 1; y <= cellOf(p[1]) + 1; ++y)
        if (const auto cell = cells.find({ x, y }); cell != cells.end())
          for (const PlanePoint& q : cell->second)
            if (std::hypot(p[0] - q[0], p[1] - q[1]) <= reach && ++near == 2)
              return true;
    return false;
  };
  std::vector<TipPoint> tip;
  for (std::size_t begin = 0; begin < broken.size();)
  {
    std::vector<PlanePoint> fresh; // of a step: their order says nothing
    std::size_t end = begin;
    for (; end < broken.size() && broken[end].step == broken[begin].step; ++end)
    {
      fresh.push_back(middleOf(broken[end].bond, stencil, lattice));
      cells[{ cellOf(fresh.back()[0]), cellOf(fresh.back()[1]) }].push_back(fresh.back());
    }
    TipPoint most{ broken[begin].time, tip.empty() ? -std::numeric_limits<double>::infinity() : tip.back().position };
    const double before = most.position;
    for (const PlanePoint& p : fresh)
      if (const double position = (p[0] * direction[0] + p[1] * direction[1]) / norm;
          position > most.position && joined(p))
        most.position = position;
    if (most.position > before)
      tip.push_back(most);
    begin = end;
  }
  return tip;
}

std::vector<TipSpeed> tipSpeeds(std::span<const TipPoint> tip, double window)
{
  std::vector<TipSpeed> speeds;
  if (tip.empty())
    return speeds;
  const double start = tip.front().time;
  for (std::size_t k = 0; k < tip.size();)
  {
    const double begin = start + static_cast<double>(speeds.size()) * window;
    double n = 0;
    double t = 0;
    double x = 0;
    double tt = 0;
    double tx = 0;
    for (; k < tip.size() && tip[k].time < begin + window; ++k)
    {
      const double dt = tip[k].time - begin;
      const double dx = tip[k].position - tip.front().position;
      n += 1;
      t += dt;
      x += dx;
      tt += dt * dt;
      tx += dt * dx;
    }
    const double spread = n * tt - t * t;
    speeds.push_back({ begin + window / 2, spread > 1e-12 * n * tt ? (n * tx - t * x) / spread : 0 });
  }
  return speeds;
}

std::vector<ColumnCracks> cracksByColumn(
  std::span<const DynamicBreak> broken, const Stencil& stencil, const Lattice& lattice, double width, double gap)
{
  std::map<std::int64_t, std::vector<double>> columns;
  for (const DynamicBreak& b : broken)
  {
    const PlanePoint p = middleOf(b.bond, stencil, lattice);
    columns[static_cast<std::int64_t>(std::floor(p[0] / width))].push_back(p[1]);
  }
  // Bonds of a node that cross a line along x, one after the other: |ξ_y| lines each.
  double across = 0;
  for (const Offset& o : stencil.half())
    across += std::abs(o.step[1]);
  const double least = 0.25 * across * width / lattice.spacing;
  std::vector<ColumnCracks> cracks;
  for (auto& [number, heights] : columns)
  {
    std::sort(heights.begin(), heights.end());
    ColumnCracks column{ (static_cast<double>(number) + 0.5) * width, {} };
    for (std::size_t begin = 0; begin < heights.size();)
    {
      std::size_t end = begin + 1;
      while (end < heights.size() && heights[end] - heights[end - 1] <= gap)
        ++end;
      const auto count = static_cast<double>(end - begin);
      if (count >= least)
        column.heights.push_back(std::accumulate(heights.begin() + static_cast<std::ptrdiff_t>(begin),
                                   heights.begin() + static_cast<std::ptrdiff_t>(end), 0.0) /
          count);
      begin = end;
    }
    cracks.push_back(std::move(column));
  }
  return cracks;
}

double rayleighSpeed(double youngsModulus, double poissonsRatio, double density) noexcept
{
  const double shear = std::sqrt(youngsModulus / (2 * (1 + poissonsRatio) * density));
  return shear * (0.862 + 1.14 * poissonsRatio) / (1 + poissonsRatio);
}

} // namespace lamella::peridynamics
