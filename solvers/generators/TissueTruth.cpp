#include "generators/TissueTruth.h"

#include "generators/Checks.h"
#include "generators/HardwoodLayout.h"
#include "generators/LumenTrace.h"
#include "generators/SoftwoodLayout.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lamella::generators
{
namespace
{

using micrograph::Point;

/// A cell in the units of its layout: its outline, and its lumen for any thickness of the usual wall.
struct Traced
{
  CellKind kind;
  std::vector<Point> outline;
  std::function<std::vector<Point>(double wall, double tolerance)> lumen;
};

std::vector<Point> scaled(std::vector<Point> points, double unit)
{
  for (Point& point : points)
  {
    point[0] *= unit;
    point[1] *= unit;
  }
  return points;
}

/// Finds the wall that leaves the solid fraction and puts all together.
/// @param size of the box, in the layout's units; @param unit of the layout [m]
TissueTruth assemble(
  std::span<const Traced> cells, std::array<double, 2> size, double unit, double solidFraction, double tolerance)
{
  const double wanted = (1 - solidFraction) * size[0] * size[1];
  const auto excess = [&](double wall)
  {
    double area = -wanted;
    for (const Traced& cell : cells)
      area += areaShown(cell.lumen(wall, tolerance), size);
    return area;
  };
  // Regula falsi, the kept end's value halved (the Illinois rule): lumens shrink as walls grow.
  double low = 0;
  double atLow = excess(0);
  double high = size[0] * size[1] / (1 + static_cast<double>(cells.size()));
  high = 0.05 * std::sqrt(high);
  double atHigh = excess(high);
  while (atHigh > 0 && high < 1e6)
  {
    low = high;
    atLow = atHigh;
    high *= 2;
    atHigh = excess(high);
  }
  double wall = high;
  int kept = 0;
  for (int step = 0; step < 60 && high - low > 1e-12 * high; ++step)
  {
    wall = low + (high - low) * std::clamp(atLow / (atLow - atHigh), 0.01, 0.99);
    const double value = excess(wall);
    if (std::abs(value) < 1e-7 * wanted)
      break;
    if (value > 0)
    {
      low = wall;
      atLow = value;
      atHigh *= kept == 1 ? 0.5 : 1.0;
      kept = 1;
    }
    else
    {
      high = wall;
      atHigh = value;
      atLow *= kept == -1 ? 0.5 : 1.0;
      kept = -1;
    }
  }

  TissueTruth truth;
  truth.doubleWall = 2 * wall * unit;
  truth.lumens.size = truth.cells.size = { size[0] * unit, size[1] * unit };
  for (const Traced& cell : cells)
  {
    const auto number = static_cast<std::int32_t>(truth.kinds.size() + 1);
    if (addShown(truth.cells, scaled(cell.outline, unit), number))
    {
      truth.kinds.push_back(cell.kind);
      addShown(truth.lumens, scaled(cell.lumen(wall, tolerance), unit), number);
    }
  }
  return truth;
}

void checkTolerance(double tolerance)
{
  if (!(tolerance >= 1e-10) || !(tolerance <= 1e-6))
  {
    throw ParameterError(
      fmt::format("a tolerance of {} m for outlines", tolerance), "it runs from 1e-10 to 1e-6 m, such as 2e-9");
  }
}

std::vector<Point> pointsOf(std::span<const Corner> corners)
{
  std::vector<Point> points;
  for (const Corner& corner : corners)
    points.push_back({ corner.x, corner.y });
  return points;
}

/// A piece of a ray's centre line as the tracheids on one side of it see it.
struct LinePiece
{
  double from, to; ///< along x
  CellSide side;
};

struct RayLine
{
  std::vector<LinePiece> above, below; ///< rising

  [[nodiscard]] static const CellSide* at(const std::vector<LinePiece>& pieces, double x)
  {
    if (pieces.empty())
      return nullptr;
    auto piece =
      std::upper_bound(pieces.begin(), pieces.end(), x, [](double v, const LinePiece& p) { return v < p.from; });
    return piece == pieces.begin() ? &piece->side : &(piece - 1)->side;
  }
  /// Distance of a point from the line.
  [[nodiscard]] double off(double x, double y) const
  {
    const CellSide* const up = at(above, x);
    const CellSide* const down = at(below, x);
    return std::max({ 0.0, up != nullptr ? up->distance(x, y) : 0.0, down != nullptr ? down->distance(x, y) : 0.0 });
  }
  /// Height of the line.
  [[nodiscard]] double height(double x) const
  {
    double sum = 0;
    int count = 0;
    for (const CellSide* const side : { at(above, x), at(below, x) })
    {
      if (side != nullptr)
      {
        sum += -(side->c + side->nx * x) / side->ny;
        ++count;
      }
    }
    return sum / std::max(1, count);
  }
};

Traced rayCell(const SoftwoodLayout& layout, const RayLine& line, double from, double to)
{
  const double half = layout.rayHalfWidth();
  Traced cell{ CellKind::Ray, {}, {} };
  constexpr int parts = 12;
  for (int i = 0; i <= parts; ++i)
  {
    const double x = from + (to - from) * i / parts;
    cell.outline.push_back({ x, line.height(x) - half });
  }
  for (int i = parts; i >= 0; --i)
  {
    const double x = from + (to - from) * i / parts;
    cell.outline.push_back({ x, line.height(x) + half });
  }
  cell.lumen = [&layout, &line, from, to, half](double wall, double tolerance)
  {
    const double fillet = softwoodRayFillet * half;
    const std::array<double, 2> both{ half, half };
    const double deepest = wallDepth(both, fillet);
    const auto inside = [&](double x, double y)
    {
      const double off = line.off(x, y);
      const std::array<double, 4> distances{ half - off, half + off, x - from, to - x };
      return widened(wallDepth(distances, fillet), deepest) > wall * softwoodRayThickness * layout.thickness(x);
    };
    const double x = (from + to) / 2;
    const double y = line.height(x);
    if (!inside(x, y))
      return std::vector<Point>{};
    const auto radius = [&](double dx, double dy)
    {
      double low = 0;
      double high = to - from + 2 * half;
      for (int step = 0; step < 44; ++step)
      {
        const double middle = (low + high) / 2;
        (inside(x + middle * dx, y + middle * dy) ? low : high) = middle;
      }
      return low;
    };
    return trace(x, y, radius, tolerance);
  };
  return cell;
}

} // namespace

TissueTruth hardwoodTruth(const HardwoodOptions& options, double tolerance)
{
  check(options);
  checkTolerance(tolerance);
  const HardwoodLayout layout(options);
  std::vector<Traced> cells;
  const double unit = options.fibreDiameter;
  for (const ConvexCell& cell : layout.cells())
  {
    cells.push_back({ cell.kind, pointsOf(layout.corners(cell)),
      [&layout, &cell, unit](double wall, double chord)
      {
        return traceConvex(layout.sides(cell), cell.fillet, depthOfWidened(wall * cell.thickness, cell.depth),
          cell.centreX, cell.centreY, chord / unit);
      } });
  }
  return assemble(cells, { layout.width(), layout.height() }, unit, options.solidFraction, tolerance);
}

TissueTruth softwoodTruth(const SoftwoodOptions& options, double tolerance)
{
  check(options);
  checkTolerance(tolerance);
  if (options.dimension != 2)
    throw ParameterError("outlines of a softwood sample of 3 dimensions", "outlines are those of a cross-section: 2");
  const SoftwoodLayout layout(options);
  const double unit = options.spacing;
  const double chord = tolerance / unit;
  const double half = layout.rayHalfWidth();
  std::vector<Traced> cells;
  std::vector<RayLine> lines(layout.rays());
  std::vector<Corner> polygon;
  std::vector<Corner> spare;
  for (const CellShape& cell : layout.cells())
  {
    const auto sides = layout.sides(cell);
    const auto cut = [&](double offRay)
    {
      polygon = { { cell.xMin - 1, cell.yMin - 1 }, { cell.xMax + 1, cell.yMin - 1 }, { cell.xMax + 1, cell.yMax + 1 },
        { cell.xMin - 1, cell.yMax + 1 } };
      for (std::size_t i = 0; i < sides.size(); ++i)
      {
        const CellSide& side = sides[i];
        clip(polygon, spare, side.nx, side.ny, side.c - (side.ray >= 0 ? offRay : 0.0), static_cast<int>(i));
      }
    };
    cut(0);
    for (std::size_t k = 0; k < polygon.size(); ++k)
    {
      if (polygon[k].side >= 0 && sides[static_cast<std::size_t>(polygon[k].side)].ray >= 0)
      {
        const CellSide& side = sides[static_cast<std::size_t>(polygon[k].side)];
        const auto [low, high] = std::minmax(polygon[k].x, polygon[(k + 1) % polygon.size()].x);
        RayLine& line = lines[static_cast<std::size_t>(side.ray)];
        (side.rayBelow ? line.above : line.below).push_back({ low, high, side });
      }
    }
    cut(half);
    std::vector<CellSide> inner(sides.begin(), sides.end());
    for (CellSide& side : inner)
      side.c -= side.ray >= 0 ? half : 0.0;
    cells.push_back({ CellKind::Tracheid, pointsOf(polygon),
      [inner, &cell, chord](double wall, double)
      {
        return traceConvex(
          inner, cell.fillet, depthOfWidened(wall * cell.thickness, cell.depth), cell.centreX, cell.centreY, chord);
      } });
  }
  const double width = static_cast<double>(options.size[0]);
  const double height = static_cast<double>(options.size[1]);
  for (std::size_t r = 0; r < lines.size(); ++r)
  {
    RayLine& line = lines[r];
    const auto rising = [](const LinePiece& a, const LinePiece& b) { return a.from < b.from; };
    std::sort(line.above.begin(), line.above.end(), rising);
    std::sort(line.below.begin(), line.below.end(), rising);
    if (line.above.empty() && line.below.empty())
      continue;
    const std::vector<double> walls = layout.crossWalls(softwoodRayCell, 64 * static_cast<std::int64_t>(r));
    for (std::size_t i = 1; i < walls.size(); ++i)
    {
      const double middle = line.height((walls[i - 1] + walls[i]) / 2);
      if (walls[i] > 0 && walls[i - 1] < width && middle > -4 * half - 2 && middle < height + 4 * half + 2)
      {
        cells.push_back(rayCell(layout, line, walls[i - 1], walls[i]));
        const auto lumen = cells.back().lumen;
        cells.back().lumen = [lumen, chord](double wall, double) { return lumen(wall, chord); };
      }
    }
  }
  return assemble(cells, { width, height }, unit, options.solidFraction, tolerance);
}

} // namespace lamella::generators
