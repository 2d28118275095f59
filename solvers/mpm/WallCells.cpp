#include "mpm/WallCells.h"

#include "lattice/Error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace lamella::mpm
{

WallCells wallCells(const Lattice& lattice, std::span<const std::uint8_t> phase, std::uint8_t empty, double spacing)
{
  const auto count = static_cast<std::size_t>(lattice.count());
  if (phase.size() != count)
    throw InputError(fmt::format("{} phases for {} nodes", phase.size(), count), "give one a node");
  if (!(std::isfinite(spacing) && spacing > 0))
    throw ParameterError(fmt::format("a grid spacing of {} m", spacing), "it is positive and finite");
  constexpr std::int64_t unseen = std::numeric_limits<std::int32_t>::max();
  std::vector<std::int32_t> least(count, static_cast<std::int32_t>(unseen));
  std::int64_t stride = 1;
  for (int a = 0; a < lattice.dimension; ++a)
  {
    const std::int64_t length = lattice.size[static_cast<std::size_t>(a)];
    for (std::int64_t line = 0; line < lattice.count() / length; ++line)
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
    stride *= length;
  }
  std::vector<std::int32_t> runs;
  for (const std::int32_t run : least)
    if (run != unseen)
      runs.push_back(run);
  WallCells result;
  if (runs.empty())
    return result;
  const double each = lattice.spacing / spacing;
  const auto solid = count - static_cast<std::size_t>(std::count(phase.begin(), phase.end(), empty));
  // half a thousandth of a cell of play for lengths that are not round numbers
  const auto thin =
    std::count_if(runs.begin(), runs.end(), [&](std::int32_t r) { return r * each < leastWallCells - 5e-4; });
  result.thinShare = static_cast<double>(thin) / static_cast<double>(solid);
  const auto middle = runs.begin() + static_cast<std::ptrdiff_t>(runs.size() / 2);
  std::nth_element(runs.begin(), middle, runs.end());
  result.median = *middle * each;
  return result;
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
