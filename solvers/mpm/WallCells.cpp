#include "mpm/WallCells.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace lamella::mpm
{

void shortenRuns(const std::array<std::int64_t, 3>& size, std::span<const std::uint8_t> phase, std::uint8_t empty,
  int axis, std::span<std::int32_t> least)
{
  std::int64_t stride = 1;
  for (int a = 0; a < axis; ++a)
    stride *= size[static_cast<std::size_t>(a)];
  const std::int64_t length = size[static_cast<std::size_t>(axis)];
  const auto lines = length > 0 ? static_cast<std::int64_t>(phase.size()) / length : 0;
  for (std::int64_t line = 0; line < lines; ++line)
  {
    const std::int64_t first = line % stride + line / stride * stride * length;
    const auto solid = [&](std::int64_t i) { return phase[static_cast<std::size_t>(first + i * stride)] != empty; };
    for (std::int64_t begin = 0; begin < length;)
    {
      std::int64_t end = begin;
      while (end < length && solid(end))
        ++end;
      if (begin > 0 && end < length)
        for (std::int64_t i = begin; i < end; ++i)
        {
          auto& run = least[static_cast<std::size_t>(first + i * stride)];
          run = static_cast<std::int32_t>(std::min<std::int64_t>(run, end - begin));
        }
      begin = end + 1;
    }
  }
}

WallCells wallCells(std::span<const std::int64_t> nodes, std::int64_t solid, double each)
{
  WallCells result;
  const std::int64_t all = std::accumulate(nodes.begin(), nodes.end(), std::int64_t{ 0 });
  if (all == 0)
    return result;
  std::int64_t thin = 0;
  std::int64_t before = 0;
  for (std::size_t run = 0; run < nodes.size(); ++run)
  {
    const double cells = static_cast<double>(run) * each;
    // half a thousandth of a cell of play for lengths that are not round numbers
    thin += cells < leastWallCells - 5e-4 ? nodes[run] : 0;
    if (before <= all / 2 && before + nodes[run] > all / 2)
      result.median = cells;
    before += nodes[run];
  }
  result.thinShare = static_cast<double>(thin) / static_cast<double>(solid);
  return result;
}

WallCells wallCells(const Lattice& lattice, std::span<const std::uint8_t> phase, std::uint8_t empty, double spacing)
{
  const auto count = static_cast<std::size_t>(lattice.count());
  if (phase.size() != count)
    throw InputError(fmt::format("{} phases for {} nodes", phase.size(), count), "give one a node");
  if (!(std::isfinite(spacing) && spacing > 0))
    throw ParameterError(fmt::format("a grid spacing of {} m", spacing), "it is positive and finite");
  std::vector<std::int32_t> least(count, noRun);
  for (int a = 0; a < lattice.dimension; ++a)
    shortenRuns(lattice.size, phase, empty, a, least);
  std::vector<std::int64_t> nodes(
    static_cast<std::size_t>(*std::max_element(lattice.size.begin(), lattice.size.end())));
  for (const std::int32_t run : least)
    if (run != noRun)
      ++nodes[static_cast<std::size_t>(run)];
  const auto empties = std::count(phase.begin(), phase.end(), empty);
  return wallCells(nodes, static_cast<std::int64_t>(count) - empties, lattice.spacing / spacing);
}

std::string wallWarning(const WallCells& cells)
{
  if (cells.median == 0 || (cells.median >= leastWallCells - 5e-4 && cells.thinShare < 0.25))
    return {};
  return fmt::format(
    "walls are {:.2g} cells of the grid thick (median; {:.0f} % of the material is thinner than {:g}): "
    "choose a grid spacing that is smaller",
    cells.median, 100 * cells.thinShare, leastWallCells);
}

} // namespace lamella::mpm
