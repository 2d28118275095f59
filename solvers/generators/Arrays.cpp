#include "generators/Generators.h"
#include "generators/Selection.h"

#include "core/Error.h"
#include "core/Memory.h"
#include "core/Plausible.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace lamella::generators
{
namespace
{

using Size = std::array<std::int64_t, 3>;

/// An empty sample after the checks that all have in common.
PhaseImage blank(const char* what, int dimension, const Size& size, double spacing, std::vector<std::string> phases)
{
  if (dimension != 2 && dimension != 3)
    throw ParameterError(fmt::format("a {} of {} dimensions", what, dimension), "choose 2 or 3");
  for (int axis = 0; axis < 3; ++axis)
  {
    if (size[axis] < 1 || size[axis] > 1000000 || (axis == 2 && dimension == 2 && size[axis] != 1))
    {
      throw ParameterError(fmt::format("{} nodes along {} in a {}D {}", size[axis], "xyz"[axis], dimension, what),
        "give 1 to 1000000 nodes along each axis, one along z in 2D");
    }
  }
  if (!(spacing > 0 && plausible(spacing)))
    throw ParameterError(fmt::format("a spacing of {} m for a {}", spacing, what), "give it in metres, such as 1e-6");
  PhaseImage image{ makeLattice(size[0], size[1], size[2], dimension, spacing), {}, PhaseTable(std::move(phases)) };
  const double bytes = 5 * static_cast<double>(size[0]) * static_cast<double>(size[1]) * static_cast<double>(size[2]);
  if (const auto available = static_cast<double>(availableMemory()); bytes > available)
  {
    throw MemoryError(
      fmt::format("a {} of this size takes {} to make, and {} are free", what, bytesText(bytes), bytesText(available)),
      "make a smaller one");
  }
  image.phase.resize(static_cast<std::size_t>(image.lattice.count()));
  return image;
}

void checkFraction(const char* what, double fraction, double least, double most)
{
  if (!(fraction >= least) || !(fraction <= most))
  {
    throw ParameterError(fmt::format("a {} with a fraction of {}", what, fraction),
      fmt::format("it lies between {:.4g} and {:.4g}", least, most));
  }
}

void checkCells(const char* what, std::int64_t cells, std::int64_t nodes, std::int64_t nodesPerCell)
{
  if (cells < 1 || cells > nodes / nodesPerCell)
  {
    throw ParameterError(fmt::format("a {} of {} cells across {} nodes", what, cells, nodes),
      fmt::format(
        "give 1 to {} cells, at least {} nodes each", std::max<std::int64_t>(1, nodes / nodesPerCell), nodesPerCell));
  }
}

/// Sets every node from its x, y, z.
template <class F>
void fill(PhaseImage& image, F&& phaseAt)
{
  std::uint8_t* node = image.phase.data();
  for (std::int64_t z = 0; z < image.lattice.size[2]; ++z)
  {
    for (std::int64_t y = 0; y < image.lattice.size[1]; ++y)
      for (std::int64_t x = 0; x < image.lattice.size[0]; ++x)
        *node++ = static_cast<std::uint8_t>(phaseAt(x, y, z));
  }
}

/// Regular cells, stretched a little along y.
struct Comb
{
  double width = 0;  ///< of a cell [nodes]
  double height = 0; ///< of a row of cells
  std::int64_t rows = 0;
  std::int64_t columns = 0;
};

/// @return the distance from the nearest wall's middle, the bisector of the two nearest cell centres, and the cell
std::pair<double, std::int64_t> nearestCell(const Comb& comb, double atX, double atY)
{
  struct Centre
  {
    double dx, dy, squared;
    std::int64_t cell;
  };
  std::array<Centre, 9> centres{};
  std::size_t count = 0;
  const auto row = static_cast<std::int64_t>(std::floor(atY / comb.height));
  for (std::int64_t r = row - 1; r <= row + 1; ++r)
  {
    const std::int64_t wrapped = (r + comb.rows) % comb.rows;
    const double offset = wrapped % 2 == 1 ? 0.5 : 0.0;
    const auto column = static_cast<std::int64_t>(std::floor(atX / comb.width - offset));
    for (std::int64_t c = column - 1; c <= column + 1; ++c)
    {
      const double dx = (static_cast<double>(c) + 0.5 + offset) * comb.width - atX;
      const double dy = (static_cast<double>(r) + 0.5) * comb.height - atY;
      centres[count++] = { dx, dy, dx * dx + dy * dy, wrapped * comb.columns + (c + 2 * comb.columns) % comb.columns };
    }
  }
  const Centre nearest = *std::min_element(
    centres.begin(), centres.end(), [](const Centre& a, const Centre& b) { return a.squared < b.squared; });
  double distance = std::numeric_limits<double>::max();
  for (const Centre& other : centres)
  {
    const double dx = other.dx - nearest.dx;
    const double dy = other.dy - nearest.dy;
    if (dx * dx + dy * dy > 0)
      distance = std::min(distance, (other.squared - nearest.squared) / (2 * std::sqrt(dx * dx + dy * dy)));
  }
  return { std::max(0.0, distance), nearest.cell };
}

/// The thinnest closed wall: nodes with another cell to the right, above or diagonally above, around the box, get the
/// key 0. @return how many
std::int64_t closeWalls(
  const std::vector<std::int64_t>& cellOf, std::int64_t nx, std::int64_t ny, std::vector<float>& key)
{
  std::int64_t closed = 0;
  for (std::int64_t y = 0; y < ny; ++y)
  {
    for (std::int64_t x = 0; x < nx; ++x)
    {
      const std::int64_t right = (x + 1) % nx;
      const std::int64_t up = nx * ((y + 1) % ny);
      const std::int64_t own = cellOf[static_cast<std::size_t>(x + nx * y)];
      if (cellOf[static_cast<std::size_t>(right + nx * y)] != own || cellOf[static_cast<std::size_t>(x + up)] != own ||
        cellOf[static_cast<std::size_t>(right + up)] != own)
      {
        key[static_cast<std::size_t>(x + nx * y)] = 0;
        ++closed;
      }
    }
  }
  return closed;
}

} // namespace

PhaseImage honeycomb(const HoneycombOptions& options)
{
  const int dimension = options.size[2] > 1 ? 3 : 2;
  PhaseImage image = blank("honeycomb", dimension, options.size, options.spacing, { "lumen", "wall" });
  const auto [nx, ny, nz] = options.size;
  checkCells("honeycomb", options.cellsAcross, nx, 6);
  if (!(options.solidFraction > 0) || !(options.solidFraction < 1))
  {
    throw ParameterError(fmt::format("a honeycomb with a solid fraction of {}", options.solidFraction),
      "it lies between 0 and 1, such as 0.40");
  }

  // Rows of cells, every second one offset by half a cell; an even number of rows closes periodically. The cells are
  // regular where the box allows it and otherwise stretched a little along y.
  const double width = static_cast<double>(nx) / options.cellsAcross;
  const double regular = width * std::numbers::sqrt3 / 2;
  const std::int64_t rows = std::max<std::int64_t>(2, 2 * std::llround(static_cast<double>(ny) / (2 * regular)));
  const double height = static_cast<double>(ny) / static_cast<double>(rows);
  if (height < 5)
  {
    throw ParameterError(fmt::format("a honeycomb {} nodes high leaves {:.1f} nodes a row of cells", ny, height),
      "make the box higher, or take fewer cells across");
  }

  const Comb comb{ width, height, rows, options.cellsAcross };
  std::vector<float> key(static_cast<std::size_t>(nx * ny));
  std::vector<std::int64_t> cellOf(key.size());
  for (std::int64_t y = 0; y < ny; ++y)
  {
    for (std::int64_t x = 0; x < nx; ++x)
    {
      const auto node = static_cast<std::size_t>(x + nx * y);
      const auto [distance, cell] = nearestCell(comb, static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5);
      key[node] = static_cast<float>(distance);
      cellOf[node] = cell;
    }
  }
  const std::int64_t closed = closeWalls(cellOf, nx, ny, key);
  const std::int64_t solid = std::llround(options.solidFraction * static_cast<double>(nx * ny));
  if (closed > solid && options.cellsAcross > 1)
  {
    throw ParameterError(fmt::format("a solid fraction of {} is too little for closed walls on this lattice: walls one "
                                     "node thick make {:.3f}",
                           options.solidFraction, static_cast<double>(closed) / static_cast<double>(nx * ny)),
      "take fewer cells across, or more nodes");
  }
  const std::vector<std::uint8_t> layer = markSmallest(key, solid);
  for (std::int64_t z = 0; z < nz; ++z)
    std::copy(layer.begin(), layer.end(), image.phase.begin() + z * nx * ny);
  return image;
}

PhaseImage checkerboard(int dimension, Size size, double spacing, int cells)
{
  PhaseImage image = blank("checkerboard", dimension, size, spacing, { "matrix", "inclusion" });
  for (int axis = 0; axis < dimension; ++axis)
  {
    checkCells("checkerboard", cells, size[axis], 1);
    if (size[axis] % cells != 0)
    {
      const std::int64_t below = size[axis] / cells * cells;
      throw ParameterError(
        fmt::format("{} nodes along {} do not divide into {} equal fields", size[axis], "xyz"[axis], cells),
        fmt::format("take {} or {} nodes, or another number of fields", below, below + cells));
    }
  }
  const Size field{ size[0] / cells, size[1] / cells, dimension == 3 ? size[2] / cells : 1 };
  fill(image,
    [&](std::int64_t x, std::int64_t y, std::int64_t z) { return (x / field[0] + y / field[1] + z / field[2]) % 2; });
  return image;
}

PhaseImage inclusionArray(int dimension, Size size, double spacing, double fraction, int cells)
{
  const char* const what = dimension == 3 ? "sphere array" : "disk array";
  PhaseImage image = blank(what, dimension, size, spacing, { "matrix", "inclusion" });
  if (size[0] != size[1] || (dimension == 3 && size[0] != size[2]))
  {
    throw ParameterError(fmt::format("a {} in a box of {} × {} × {} nodes", what, size[0], size[1], size[2]),
      "the unit cells are squares or cubes: give as many nodes along every axis");
  }
  checkCells(what, cells, size[0], 2);
  const double touching = std::numbers::pi / (dimension == 3 ? 6 : 4);
  checkFraction(what, fraction, 0, touching);

  const double cell = static_cast<double>(size[0]) / cells;
  const double radius =
    cell * (dimension == 3 ? std::cbrt(3 * fraction / (4 * std::numbers::pi)) : std::sqrt(fraction / std::numbers::pi));
  // Squared distance along one axis from the middle of the unit cell.
  std::vector<double> squared(static_cast<std::size_t>(size[0]));
  for (std::size_t i = 0; i < squared.size(); ++i)
  {
    const double at = static_cast<double>(i) + 0.5;
    const double off = at - (std::floor(at / cell) + 0.5) * cell;
    squared[i] = off * off;
  }
  fill(image,
    [&](std::int64_t x, std::int64_t y, std::int64_t z)
    {
      const double r2 = squared[static_cast<std::size_t>(x)] + squared[static_cast<std::size_t>(y)] +
        (dimension == 3 ? squared[static_cast<std::size_t>(z)] : 0.0);
      return r2 < radius * radius;
    });
  return image;
}

PhaseImage laminate(int dimension, Size size, double spacing, int axis, double fraction, int periods)
{
  PhaseImage image = blank("laminate", dimension, size, spacing, { "matrix", "inclusion" });
  if (axis < 0 || axis >= dimension)
  {
    throw ParameterError(
      fmt::format("layers perpendicular to axis {} in {}D", axis, dimension), "0 is x, 1 is y and, in 3D, 2 is z");
  }
  checkFraction("laminate", fraction, 0, 1);
  const std::int64_t nodes = size[static_cast<std::size_t>(axis)];
  checkCells("laminate", periods, nodes, 2);

  // Rounding the sums rather than the layers keeps the whole within half a layer of nodes.
  std::vector<std::uint8_t> layer(static_cast<std::size_t>(nodes), 0);
  std::int64_t placed = 0;
  for (std::int64_t period = 0; period < periods; ++period)
  {
    const std::int64_t end = nodes * (period + 1) / periods;
    const std::int64_t wanted = std::llround(fraction * static_cast<double>(end)) - placed;
    std::fill_n(layer.begin() + (end - wanted), wanted, std::uint8_t{ 1 });
    placed += wanted;
  }
  fill(image,
    [&](std::int64_t x, std::int64_t y, std::int64_t z) {
      return layer[static_cast<std::size_t>(axis == 0 ? x : axis == 1 ? y : z)];
    });
  return image;
}

} // namespace lamella::generators
