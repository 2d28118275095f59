#include "outlines/LamellaNetwork.h"

#include "core/Communicator.h"
#include "outlines/LamellaPhases.h"
#include "pores/PoreLabelling.h"

#include <algorithm>
#include <vector>

namespace lamella::micrograph
{
namespace
{

/// Calls `visit(node, next)` for links between nodes of two cells.
template <typename Visit>
void forLinks(const Lattice& lattice, const std::vector<std::int32_t>& grain, const Visit& visit)
{
  const auto nx = static_cast<std::size_t>(lattice.size[0]);
  const std::size_t count = grain.size();
  for (std::size_t row = 0; row < count; row += nx)
  {
    const bool last = row + nx == count;
    for (std::size_t node = row; node < row + nx; ++node)
    {
      if (node + 1 < row + nx && grain[node] != grain[node + 1])
        visit(node, node + 1);
      if (!last && grain[node] != grain[node + nx])
        visit(node, node + nx);
    }
  }
}

/// How a cell hangs on the lamella.
enum LumenTouch : std::uint8_t
{
  Untouched,
  Enclosed, ///< by a part that ends in the picture
  Leaving,  ///< by a part that leaves the picture, apart from the largest, which does too
  Largest
};

/// Numbers of the lumens that have nodes, rising.
std::vector<std::int32_t> lumensOn(const ContourLattice& lattice, const WallDirections& directions)
{
  const std::vector<std::uint8_t>& wall = lattice.image.phase;
  std::vector<std::int32_t> cells;
  for (std::size_t node = 0; node < wall.size(); ++node)
    if (wall[node] == 0 && (cells.empty() || cells.back() != directions.grain[node]))
      cells.push_back(directions.grain[node]);
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return cells;
}

} // namespace

std::int64_t joinLamella(const ContourLattice& lattice, const WallDirections& directions, std::span<std::uint8_t> phase)
{
  const std::vector<std::uint8_t>& wall = lattice.image.phase;
  const auto beside = [&](std::size_t node) { return directions.second[node] - directions.nearest[node]; };
  std::int64_t joined = 0;
  forLinks(lattice.image.lattice, directions.grain,
    [&](std::size_t a, std::size_t b)
    {
      const std::size_t nearer = wall[a] == 0 ? b : wall[b] == 0 ? a : beside(b) < beside(a) ? b : a;
      if (phase[nearer] == kSecondary)
      {
        phase[nearer] = kLamella;
        ++joined;
      }
    });
  return joined;
}

std::int64_t lostWalls(const ContourLattice& lattice, const WallDirections& directions)
{
  const std::vector<std::uint8_t>& wall = lattice.image.phase;
  std::int64_t lost = 0;
  forLinks(lattice.image.lattice, directions.grain,
    [&](std::size_t a, std::size_t b) { lost += wall[a] == 0 && wall[b] == 0; });
  return lost;
}

void countNetworks(const ContourLattice& lattice, const WallDirections& directions, MiddleLamella& result)
{
  pores::LabelOptions options;
  options.connectivity = 8;
  const pores::PoreLabelling labelling(result.image.lattice, Communicator(), result.image.phase, kLamella, options);
  const pores::PoreSummary& summary = labelling.summary();
  result.networks = summary.count;
  result.largestNetwork =
    summary.total > 0 ? static_cast<double>(summary.largest) / static_cast<double>(summary.total) : 0;
  std::vector<std::int32_t> labels(result.image.phase.size());
  labelling.labels(labels);
  const auto parts = labelling.pores();
  const bool leaves = !parts.empty() && parts[0].touches != 0;
  const auto kind = [&](std::int32_t label)
  {
    return label == 0                                                     ? Untouched
      : label == 1                                                        ? Largest
      : leaves && parts[static_cast<std::size_t>(label) - 1].touches != 0 ? Leaving
                                                                          : Enclosed;
  };

  const std::vector<std::int32_t> cells = lumensOn(lattice, directions);
  std::vector<LumenTouch> touch(cells.size(), Untouched);
  forLinks(
    result.image.lattice, directions.grain,
    [&](std::size_t a, std::size_t b)
    {
      const LumenTouch best = std::max(kind(labels[a]), kind(labels[b]));
      for (const std::size_t node : { a, b })
      {
        const auto cell = std::lower_bound(cells.begin(), cells.end(), directions.grain[node]);
        if (cell != cells.end() && *cell == directions.grain[node])
        {
          LumenTouch& known = touch[static_cast<std::size_t>(cell - cells.begin())];
          known = std::max(known, best);
        }
      }
    });
  const auto count = [&](const auto& counts) { return std::count_if(touch.begin(), touch.end(), counts); };
  result.cells = static_cast<std::int64_t>(cells.size());
  result.cellsTouched = count([](LumenTouch t) { return t >= Leaving; });
  result.cellsCutOff = count([](LumenTouch t) { return t == Leaving; });
}

} // namespace lamella::micrograph
