#include "peridynamics/multigrid/LevelSizes.h"

#include "peridynamics/multigrid/Galerkin.h"

#include <algorithm>

namespace lamella::peridynamics
{
namespace
{

std::int64_t nodesOf(const std::array<std::int64_t, 3>& size)
{
  return size[0] * size[1] * size[2];
}

} // namespace

std::vector<NodeLayout> levelLayouts(const NodeLayout& finest, bool parallel)
{
  constexpr MultigridOptions options;
  std::vector<NodeLayout> levels{ finest };
  while (nodesOf(levels.back().global) > options.coarsest)
  {
    if (parallel && nodesOf(levels.back().global) <= options.gather)
    {
      parallel = false; // from here on whole on every rank
      levels.push_back(NodeLayout::make(
        finest.dimension, levels.back().ghost, levels.back().global, {}, levels.back().global, finest.before > 0));
    }
    const NodeLayout fine = levels.back();
    std::array<std::int64_t, 3> size = fine.size;
    std::array<std::int64_t, 3> global = fine.global;
    const auto slowest = static_cast<std::size_t>(fine.dimension - 1);
    for (std::size_t a = 0; a < static_cast<std::size_t>(fine.dimension); ++a)
    {
      size[a] = size[a] / 2 + 1;
      global[a] = global[a] / 2 + 1;
    }
    if (parallel) // slabs that were too thin are thicker on fewer ranks
      size[slowest] = std::max(size[slowest], std::min<std::int64_t>(global[slowest], 8 * coarseReach(fine.ghost)));
    if (nodesOf(global) >= nodesOf(fine.global))
      break;
    levels.push_back(NodeLayout::make(fine.dimension, coarseReach(fine.ghost), size, {}, global, finest.before > 0));
  }
  return levels;
}

MultigridBytes multigridBytes(const std::vector<NodeLayout>& levels, bool rim, const MultigridOptions& options)
{
  const int d = levels.front().dimension;
  const double entries = blockEntries(d);
  const auto finest = static_cast<double>(levels.front().count());
  // inverses and three vectors of each; of the finest the force, of the others diagonal blocks, traces and the matrix
  double floats = finest * (entries + (options.lean ? 2 : 4) * d);
  double largest = 0; // matrix: it is there twice while it is put in order
  for (std::size_t k = 1; k < levels.size(); ++k)
  {
    const auto nodes = static_cast<double>(levels[k].count());
    const double stored = rim ? nodes : static_cast<double>(Level::rimlessNodes(levels[k]));
    const double matrix = stored * entries * static_cast<double>(forwardNeighbours(d, levels[k].ghost).size());
    const bool packed = !rim && options.packFrom > 0 && levels[k].owned() >= options.packFrom; // and a scale
    floats += nodes * (2 * entries + 1 + 3 * d) + (packed ? 0.5 * matrix + nodes : matrix);
    largest = rim ? std::max(largest, matrix) : 0;
  }
  const double unknowns = static_cast<double>(levels.back().owned()) * d; // of the level that is solved directly
  return { 4 * floats + 12 * unknowns * unknowns, 4 * (largest + 2 * entries * finest) };
}

} // namespace lamella::peridynamics
