#include "outlines/ContourLattice.h"

#include "core/Error.h"
#include "core/Memory.h"
#include "outlines/CellSums.h"
#include "outlines/LinkCutting.h"
#include "outlines/WallThickness.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lamella::micrograph
{
namespace
{

constexpr std::uint8_t kLumen = 0;
constexpr std::uint8_t kWall = 1;

struct SideCrossing
{
  double x = 0;
  std::int32_t sign = 0; ///< 1: lumen begins
  std::int32_t lumen = 0;
};

/// Where each row of nodes crosses the outlines, sorted along it: of row j those from first[j] to first[j + 1].
struct RowCrossings
{
  std::vector<std::size_t> first;
  std::vector<SideCrossing> all;
};

template <typename Visit>
void forRows(const ContourEdge& edge, std::int64_t rows, const Visit& visit)
{
  const double least = std::min(edge.from[1], edge.to[1]);
  const double most = std::max(edge.from[1], edge.to[1]);
  // The row of nodes at y = j + ½ with least <= y < most.
  const auto rowAfter = [&](double y)
  {
    return std::clamp(static_cast<std::int64_t>(std::ceil(std::clamp(y - 0.5, -1.0, static_cast<double>(rows)))),
      std::int64_t{ 0 }, rows);
  };
  for (std::int64_t row = rowAfter(least); row < rowAfter(most); ++row)
    visit(row);
}

RowCrossings crossRows(std::span<const ContourEdge> edges, std::int64_t rows)
{
  RowCrossings crossings;
  crossings.first.assign(static_cast<std::size_t>(rows) + 2, 0);
  for (const ContourEdge& edge : edges)
    forRows(edge, rows, [&](std::int64_t row) { ++crossings.first[static_cast<std::size_t>(row) + 2]; });
  for (std::size_t row = 2; row < crossings.first.size(); ++row)
    crossings.first[row] += crossings.first[row - 1];
  crossings.all.resize(crossings.first.back());
  for (const ContourEdge& edge : edges)
  {
    const double slope = (edge.to[0] - edge.from[0]) / (edge.to[1] - edge.from[1]);
    forRows(edge, rows,
      [&](std::int64_t row)
      {
        const double x = edge.from[0] + (static_cast<double>(row) + 0.5 - edge.from[1]) * slope;
        crossings.all[crossings.first[static_cast<std::size_t>(row) + 1]++] = { x, edge.to[1] < edge.from[1] ? 1 : -1,
          edge.lumen };
      });
  }
  for (std::size_t row = 0; row < static_cast<std::size_t>(rows); ++row)
  {
    const auto place = [&](std::size_t i) { return crossings.all.begin() + static_cast<std::ptrdiff_t>(i); };
    std::sort(place(crossings.first[row]), place(crossings.first[row + 1]),
      [](const SideCrossing& a, const SideCrossing& b) {
        return a.x != b.x ? a.x < b.x : a.sign != b.sign ? a.sign < b.sign : a.lumen < b.lumen;
      });
  }
  return crossings;
}

void fillNodes(const RowCrossings& crossings, ContourLattice& result)
{
  const std::int64_t nx = result.image.lattice.size[0];
  const auto nodeAfter = [&](double x)
  { return static_cast<std::int64_t>(std::ceil(std::clamp(x - 0.5, 0.0, static_cast<double>(nx)))); };
  for (std::int64_t row = 0; row < result.image.lattice.size[1]; ++row)
  {
    int depth = 0;
    std::int32_t lumen = 0;
    for (std::size_t i = crossings.first[static_cast<std::size_t>(row)];
         i < crossings.first[static_cast<std::size_t>(row) + 1]; ++i)
    {
      const SideCrossing& crossing = crossings.all[i];
      depth += crossing.sign;
      lumen = crossing.sign > 0 ? crossing.lumen : lumen;
      const std::int64_t begin = nodeAfter(crossing.x);
      const bool last = i + 1 == crossings.first[static_cast<std::size_t>(row) + 1];
      const std::int64_t end = last ? nx : nodeAfter(crossings.all[i + 1].x);
      if (depth > 0 && end > begin)
      {
        const auto at = static_cast<std::ptrdiff_t>(result.image.lattice.index(begin, row));
        std::fill_n(result.image.phase.begin() + at, end - begin, kLumen);
        if (!result.grain.empty())
          std::fill_n(result.grain.begin() + at, end - begin, lumen);
      }
    }
  }
}

void sharePixels(const CellSums& cells, ContourLattice& result)
{
  const CellFrame& frame = cells.frame();
  double total = 0;
  for (std::int64_t row = 0; row < frame.size[1]; ++row)
  {
    double cover = 0;
    double sum = 0;
    float* out = result.lumenShare.data() + row * frame.size[0];
    for (std::int64_t column = 0; column < frame.size[0]; ++column)
    {
      const std::int32_t slot = cells.slot(column, row);
      double share = std::round(cover);
      if (slot >= 0)
      {
        share = std::clamp(cover + cells.sum(slot).area, 0.0, 1.0);
        cover += cells.sum(slot).cover;
      }
      out[column] = static_cast<float>(share);
      sum += share;
    }
    total += sum;
  }
  result.lumenFraction = total / static_cast<double>(frame.size[0] * frame.size[1]);
}

/// Cells that edges pass at most, in one frame.
double mostCells(std::span<const ContourEdge> edges)
{
  double cells = 0;
  for (const ContourEdge& edge : edges)
    cells += edge.border ? 0 : std::abs(edge.to[0] - edge.from[0]) + std::abs(edge.to[1] - edge.from[1]);
  return cells;
}

void checkMemory(const Lattice& lattice, std::span<const ContourEdge> edges, const ContourLatticeOptions& options)
{
  const double nodes = static_cast<double>(lattice.size[0]) * static_cast<double>(lattice.size[1]);
  const double lines = options.lines * (options.across ? 2 : 1);
  const double cut = options.lines > 0 ? 2 * 1.3 * mostCells(edges) * (20 + 4 * lines) : 0;
  const double atWork = 4 * nodes + 1.3 * mostCells(edges) * (72 + 6 * lines);
  const double bytes = (options.grain ? 9 : 5) * nodes + cut + atWork;
  if (const auto available = static_cast<double>(availableMemory()); bytes > available)
  {
    throw MemoryError(fmt::format("a lattice of {} x {} nodes takes {}, and {} are free", lattice.size[0],
                        lattice.size[1], bytesText(bytes), bytesText(available)),
      "take a larger spacing or a part of the picture");
  }
}

void warnOfThinWalls(ContourLattice& result)
{
  const double nodes = result.thickness.low / result.image.lattice.spacing;
  if (result.thickness.low > 0 && nodes < 2)
  {
    const double median = result.thickness.median / result.image.lattice.spacing;
    result.warnings.push_back(fmt::format(
      "walls are {:.2g} nodes thick in 5 % of their length (median {:.2g}){}: take a spacing of {:.2g} m or "
      "less",
      nodes, median, median < 1 ? ", so that errors may exceed what is told" : "", result.thickness.low / 4));
  }
}

} // namespace

namespace
{

/// Nodes along x and y, of which those along y fill the height or leave a rest. @throws as latticeOf()
Lattice latticeOver(const std::array<double, 2>& size, double spacing, int multiple, bool crops)
{
  if (!(spacing > 0) || !std::isfinite(spacing))
    throw ParameterError(fmt::format("a spacing of {} m", spacing), "give it in metres, such as 1e-6");
  if (multiple < 1)
    throw ParameterError(fmt::format("nodes in multiples of {}", multiple), "give 1 or more");
  const double columns = multiple * std::round(size[0] / spacing / multiple);
  const double fitted = size[0] / columns;
  // A part in a thousand million of the height is round-off.
  const double filled = size[1] / fitted / multiple;
  const double rows = multiple * (crops ? std::floor(filled * (1 + 1e-9)) : std::round(filled));
  if (!(columns >= 1) || !(rows >= 1))
  {
    throw ParameterError(
      fmt::format("a spacing of {:.4g} m in a picture of {:.4g} by {:.4g} m", spacing, size[0], size[1]),
      fmt::format("give {:.4g} m or less", std::min(size[0], size[1]) / multiple));
  }
  if (columns * rows > 1e15)
  {
    throw MemoryError(fmt::format("a spacing of {:.4g} m makes {:.3g} nodes", spacing, columns * rows),
      "take a larger spacing or a part of the picture");
  }
  return makeLattice(static_cast<std::int64_t>(columns), static_cast<std::int64_t>(rows), 1, 2, fitted);
}

} // namespace

Lattice latticeOf(const std::array<double, 2>& size, double spacing)
{
  return latticeOver(size, spacing, 1, true);
}

FittedContours fitContours(const ContourSet& contours, double spacing, int multiple)
{
  FittedContours fitted{ contours, latticeOver(contours.size, spacing, multiple, false), 1 };
  ContourSet& set = fitted.contours;
  fitted.stretch = fitted.lattice.length(1) / set.size[1];
  set.size = { fitted.lattice.length(0), fitted.lattice.length(1) };
  for (Contour& contour : set.contours)
    for (Point& point : contour.points)
      point[1] *= fitted.stretch;
  return fitted;
}

ContourLattice contourLattice(const ContourSet& contours, const ContourLatticeOptions& options)
{
  if (options.lines < 0 || options.lines > 16)
    throw ParameterError(fmt::format("{} lines across a link", options.lines), "give 1 to 16, or 0 for no links");
  checkContours(contours);
  const Lattice lattice = latticeOf(contours.size, options.spacing);
  const std::vector<ContourEdge> edges = closedEdges(contours, 1 / lattice.spacing);
  checkMemory(lattice, edges, options);

  ContourLattice result{ { lattice, {}, PhaseTable({ "lumen", "wall" }) }, {}, {}, {}, {}, {}, {}, {} };
  const auto nodes = static_cast<std::size_t>(lattice.count());
  result.cropped = std::max(0.0, contours.size[1] - lattice.length(1));
  result.image.phase.assign(nodes, kWall);
  result.grain.assign(options.grain ? nodes : 0, 0);
  result.lumenShare.resize(nodes);
  fillNodes(crossRows(edges, lattice.size[1]), result);
  {
    CellSums pixels(CellFrame(lattice.size[0], lattice.size[1]));
    pixels.addAreas(edges);
    sharePixels(pixels, result);
  }
  for (const int axis : { 0, 1 })
    if (options.lines > 0)
      result.links[static_cast<std::size_t>(axis)] = cutLinks(edges, result.image, options, axis);
  result.thickness = wallThickness(contours);
  warnOfThinWalls(result);
  return result;
}

} // namespace lamella::micrograph
