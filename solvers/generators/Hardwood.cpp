#include "generators/Checks.h"
#include "generators/Generators.h"
#include "generators/HardwoodLayout.h"
#include "generators/Selection.h"

#include "core/Error.h"
#include "core/Memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

/// Puts a HardwoodLayout on a lattice, as Softwood.cpp does: every node gets a key, the wall thickness of a usual fibre
/// at which it would just be wall, and the nodes of smallest key become wall.
namespace lamella::generators
{
namespace
{

void positive(const char* name, double value, const char* hint)
{
  if (!(value > 0) || !std::isfinite(value))
    throw ParameterError(fmt::format("the {} of a hardwood sample is {}", name, value), hint);
}

void within(const char* name, double value, double low, double high, const char* hint)
{
  if (!(value >= low) || !(value <= high))
    throw ParameterError(fmt::format("the {} of a hardwood sample is {}", name, value), hint);
}

/// Keys of all nodes and, for the thinnest walls, which cell each is in.
struct Keys
{
  std::vector<float> key;
  std::vector<std::int32_t> cell;
};

Keys keysOf(const HardwoodLayout& layout, std::int64_t nx, std::int64_t ny, double unit)
{
  Keys keys;
  keys.key.assign(static_cast<std::size_t>(nx * ny), 0);
  keys.cell.assign(keys.key.size(), -1);
  // First the cell: the one whose nearest side is farthest away. `key` holds that distance meanwhile.
  std::fill(keys.key.begin(), keys.key.end(), std::numeric_limits<float>::lowest());
  const auto nodesOf = [&](const ConvexCell& cell, auto&& visit)
  {
    const auto from = [&](double low) { return std::max<std::int64_t>(0, static_cast<std::int64_t>(low / unit) - 2); };
    const auto to = [&](double high, std::int64_t n)
    { return std::min(n, static_cast<std::int64_t>(std::max(0.0, high) / unit) + 2); };
    for (std::int64_t y = from(cell.yMin); y < to(cell.yMax, ny); ++y)
      for (std::int64_t x = from(cell.xMin); x < to(cell.xMax, nx); ++x)
        visit(static_cast<std::size_t>(x + nx * y), (static_cast<double>(x) + 0.5) * unit,
          (static_cast<double>(y) + 0.5) * unit);
  };
  const auto cells = layout.cells();
  for (std::size_t i = 0; i < cells.size(); ++i)
  {
    const auto sides = layout.sides(cells[i]);
    nodesOf(cells[i],
      [&](std::size_t node, double x, double y)
      {
        double d = std::numeric_limits<double>::max();
        for (const CellSide& side : sides)
          d = std::min(d, side.distance(x, y));
        if (static_cast<float>(d) > keys.key[node])
        {
          keys.key[node] = static_cast<float>(d);
          keys.cell[node] = static_cast<std::int32_t>(i);
        }
      });
  }
  std::vector<double> distances;
  for (std::size_t i = 0; i < cells.size(); ++i)
  {
    const ConvexCell& cell = cells[i];
    const auto sides = layout.sides(cell);
    nodesOf(cell,
      [&](std::size_t node, double x, double y)
      {
        if (keys.cell[node] != static_cast<std::int32_t>(i))
          return;
        distances.clear();
        for (const CellSide& side : sides)
          distances.push_back(side.distance(x, y));
        keys.key[node] =
          static_cast<float>(widened(wallDepth(distances, cell.fillet), cell.depth) / cell.thickness / unit);
      });
  }
  return keys;
}

} // namespace

void check(const HardwoodOptions& o)
{
  if (o.dimension != 2)
  {
    throw ParameterError(fmt::format("a hardwood sample of {} dimensions", o.dimension),
      "hardwood is a cross-section: give a width and a height; softwood can be made in 3D");
  }
  for (int axis = 0; axis < 3; ++axis)
  {
    const std::int64_t nodes = o.size[static_cast<std::size_t>(axis)];
    if (nodes < 1 || nodes > 1000000 || (axis == 2 && nodes != 1))
    {
      throw ParameterError(fmt::format("{} nodes along {} in a hardwood sample", nodes, "xyz"[axis]),
        "give 1 to 1000000 nodes along x and y, one along z");
    }
  }
  positive("spacing", o.spacing, "give it in metres, such as 1e-6");
  positive("fibre diameter", o.fibreDiameter, "give it in metres, such as 16e-6");
  if (o.fibreDiameter < 6 * o.spacing)
  {
    throw ParameterError(
      fmt::format("the fibre diameter is {:.3g} m, less than 6 nodes of {:.3g} m", o.fibreDiameter, o.spacing),
      fmt::format("take a spacing of {:.3g} m or less, or larger cells", o.fibreDiameter / 6));
  }
  positive("early vessels' diameter", o.vesselDiameterEarly, "give it in metres, such as 64e-6");
  positive("late vessels' diameter", o.vesselDiameterLate, "give it in metres, such as 40e-6");
  const double widest = std::max(o.vesselDiameterEarly, o.vesselDiameterLate);
  const double narrowest = std::min(o.vesselDiameterEarly, o.vesselDiameterLate);
  if (narrowest < 1.5 * o.fibreDiameter || widest > 30 * o.fibreDiameter)
  {
    throw ParameterError(fmt::format("vessels of {:.3g} m and {:.3g} m among fibres of {:.3g} m", o.vesselDiameterEarly,
                           o.vesselDiameterLate, o.fibreDiameter),
      "make vessels 1.5 to 30 times as wide as fibres");
  }
  if (!(o.solidFraction > 0) || !(o.solidFraction < 1))
  {
    throw ParameterError(
      fmt::format("a solid fraction of {}", o.solidFraction), "it lies between 0 and 1, such as 0.38");
  }
  within("early vessels' share", o.vesselShareEarly, 0, 0.5, "it runs from 0, none, to 0.5");
  within("late vessels' share", o.vesselShareLate, 0, 0.5, "it runs from 0, none, to 0.5");
  within("early vessels' end", o.earlyEnd, 0, 1, "it is a position in the ring from 0 to 1: 0.6, or 0.25 ring-porous");
  within("share of multiples", o.multiples, 0, 1, "it runs from 0, all vessels alone, to 1");
  within("position in the ring", o.ringPosition0, 0, 1, "it runs from 0, the ring's start, to 1, its end");
  within("position in the ring", o.ringPosition1, 0, 1, "it runs from 0, the ring's start, to 1, its end");
  within("scatter", o.scatter, 0, 0.3, "it runs from 0, regular, to 0.3");
  if (o.rayEvery != 0 && !(o.rayEvery >= 1.15 * widest + o.fibreDiameter && std::isfinite(o.rayEvery)))
  {
    throw ParameterError(fmt::format("a ray every {:.3g} m and vessels of {:.3g} m", o.rayEvery, widest),
      fmt::format("vessels lie between rays: put those {:.3g} m apart or more, or give 0 for none",
        1.15 * widest + o.fibreDiameter));
  }
  const double nodes = static_cast<double>(o.size[0]) * static_cast<double>(o.size[1]);
  if (const auto available = static_cast<double>(availableMemory()); 14 * nodes > available)
  {
    throw MemoryError(fmt::format("a sample of {:.3g} nodes takes {} to make, and {} are free", nodes,
                        bytesText(14 * nodes), bytesText(available)),
      "make a smaller one");
  }
}

PhaseImage hardwood(const HardwoodOptions& options)
{
  check(options);
  const auto [nx, ny, nz] = options.size;
  PhaseImage result{ makeLattice(nx, ny, nz, 2, options.spacing), {}, PhaseTable({ "lumen", "wall" }) };
  const HardwoodLayout layout(options);
  Keys keys = keysOf(layout, nx, ny, options.spacing / options.fibreDiameter);
  const std::int64_t closed = closeWalls(keys.key, keys.cell, nx, ny);
  const std::int64_t solid = solidNodes(options.solidFraction, options.spacing, result.lattice.count(), closed);
  result.phase = markSmallest(keys.key, solid);
  return result;
}

} // namespace lamella::generators
