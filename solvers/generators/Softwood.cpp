#include "generators/Checks.h"
#include "generators/Generators.h"
#include "generators/Selection.h"
#include "generators/SoftwoodLayout.h"

#include "core/Error.h"
#include "core/Memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

/// Puts a SoftwoodLayout on a lattice. Every node gets a key: the wall thickness of earlywood at which it would just be
/// wall. The nodes of smallest key are then made wall, as many as the solid fraction asks for.
namespace lamella::generators
{
namespace
{

constexpr double rayCellHeight = 0.6; // of a tangential diameter
constexpr int rayRowsMean = 8;        // ray cells one above the other in a ray
constexpr double rayGap = 2.5;        // between two rays one above the other, in tangential diameters
constexpr double taper = 1.2;         // slope of a tracheid's end, a chisel's edge in the tangential section
constexpr std::size_t maxSides = 24;  // a cell with more sides than this does not occur

/// What does not change along z at one node of a row.
struct Column
{
  const CellShape* cell = nullptr;
  std::uint32_t number = 0; ///< of the cell
  std::uint32_t count = 0;
  double distances[maxSides]; ///< to the sides shared with tracheids
  int ray[2] = { -1, -1 };    ///< rays beyond a side, and how far their centre lines are
  double rayDistance[2] = { 0, 0 };
  double raySide[2] = { 1, 1 }; ///< −1: the ray is at smaller y
};

/// Which cell every node of the cross-section is in: the one whose nearest side is farthest away.
std::vector<std::int32_t> assign(const SoftwoodLayout& layout, std::int64_t nx, std::int64_t ny)
{
  std::vector<std::int32_t> cellOf(static_cast<std::size_t>(nx * ny), 0);
  std::vector<float> inside(cellOf.size(), std::numeric_limits<float>::lowest());
  for (std::size_t i = 0; i < layout.cells().size(); ++i)
  {
    const CellShape& cell = layout.cells()[i];
    const auto sides = layout.sides(cell);
    const auto from = [](double low) { return std::max<std::int64_t>(0, static_cast<std::int64_t>(low) - 2); };
    const auto to = [](double high, std::int64_t n) { return std::min(n, static_cast<std::int64_t>(high) + 2); };
    for (std::int64_t y = from(cell.yMin); y < to(cell.yMax, ny); ++y)
    {
      for (std::int64_t x = from(cell.xMin); x < to(cell.xMax, nx); ++x)
      {
        double d = std::numeric_limits<double>::max();
        for (const CellSide& side : sides)
          d = std::min(d, side.distance(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5));
        const auto node = static_cast<std::size_t>(x + nx * y);
        if (static_cast<float>(d) > inside[node])
        {
          inside[node] = static_cast<float>(d);
          cellOf[node] = static_cast<std::int32_t>(i);
        }
      }
    }
  }
  return cellOf;
}

/// Where the tracheids of a column end along z.
struct Ends
{
  std::vector<double> z; ///< rising, beyond the box on both sides; at the middle of the column
  double slope = 0;      ///< of the end wall along y
  double cosine = 1;
  std::int32_t firstLabel = 0;
};

/// A ray: where it stands along z, and its cells.
struct Ray
{
  struct Row
  {
    double low, high;                 ///< along z
    std::vector<float> before, after; ///< by node along x: distance to the cross walls before and after
    std::vector<std::int32_t> label;
  };
  std::vector<double> low, high; ///< lower and upper end of the rays one above the other
  std::vector<Row> rows;         ///< rising
};

class Rasteriser
{
public:
  explicit Rasteriser(const SoftwoodOptions& options)
    : options_(options)
    , random_(options.seed)
    , layout_(options)
    , nx_(options.size[0])
    , ny_(options.size[1])
    , nz_(options.size[2])
    , solid3D_(options.dimension == 3)
    , cellOf_(assign(layout_, nx_, ny_))
  {
    layEnds();
    layRays();
  }

  PhaseImage image();

private:
  void layEnds();
  void layRays();
  [[nodiscard]] Column column(std::int64_t x, std::int64_t y) const;
  [[nodiscard]] double rayHalfWidth(int ray, double z) const;
  void fillRow(std::int64_t y, std::int64_t z, std::span<const Column> columns, float* key, std::int32_t* label) const;
  [[nodiscard]] float rayKey(
    const Column& column, int which, double halfWidth, std::int64_t x, double z, std::int32_t& label) const;
  std::int64_t closeWalls(float* key, const std::int32_t* here, const std::int32_t* above) const;

  const SoftwoodOptions& options_;
  Random random_;
  SoftwoodLayout layout_;
  std::int64_t nx_, ny_, nz_;
  bool solid3D_;
  std::vector<std::int32_t> cellOf_;
  std::vector<Ends> ends_;
  std::vector<Ray> rays_;
};

void Rasteriser::layEnds()
{
  ends_.resize(layout_.cells().size());
  std::int32_t label = 0;
  const double length = options_.tracheidLength / options_.spacing;
  const double width = options_.tangentialDiameter / options_.spacing;
  const double disorder = std::min(1.0, options_.scatter / 0.12);
  for (std::size_t i = 0; i < ends_.size(); ++i)
  {
    const CellShape& cell = layout_.cells()[i];
    Ends& ends = ends_[i];
    ends.firstLabel = label;
    if (solid3D_)
    {
      // The cells of a file come from one mother cell, so they end at nearly the same height; the files are staggered
      // by the golden section.
      const auto file = cell.file % 2048 + 5 * (cell.file / 2048);
      const double phase = 0.6180339887498949 * static_cast<double>(file) +
        0.25 * random_.uniform(RandomUse::TracheidPhase, cell.file) +
        0.08 * disorder * random_.normal(RandomUse::TracheidPhase, cell.file, cell.number);
      const double sense = random_.bits(RandomUse::TracheidTaper, cell.file) & 1U ? 1.0 : -1.0;
      ends.slope = sense * std::min(taper, 0.3 * length / width);
      ends.cosine = 1 / std::sqrt(1 + ends.slope * ends.slope);
      double z = (phase - std::floor(phase) - 2.5) * length;
      for (std::int64_t m = 0; z < static_cast<double>(nz_) + 1.5 * length; ++m)
      {
        ends.z.push_back(z);
        const double scatter = options_.scatter * random_.normal(RandomUse::TracheidLength, cell.file, m);
        z += length * std::clamp(1 + scatter, 0.7, 1.3);
      }
    }
    label += static_cast<std::int32_t>(ends.z.size()) + 1;
  }
}

void Rasteriser::layRays()
{
  rays_.resize(layout_.rays());
  std::int32_t label =
    ends_.empty() ? 0 : ends_.back().firstLabel + static_cast<std::int32_t>(ends_.back().z.size()) + 1;
  const double width = options_.tangentialDiameter / options_.spacing;
  const double height = rayCellHeight * width;
  for (std::size_t r = 0; r < rays_.size(); ++r)
  {
    Ray& ray = rays_[r];
    const auto id = static_cast<std::int64_t>(r);
    // In 2D the section runs through the middle of every ray.
    double z =
      solid3D_ ? -(rayRowsMean * height + rayGap * width) * (0.5 + random_.uniform(RandomUse::RayPhase, id)) : -0.5;
    std::int64_t rowNumber = 0;
    for (std::int64_t n = 0; z < static_cast<double>(nz_); ++n)
    {
      const auto rows =
        solid3D_ ? rayRowsMean - 3 + static_cast<int>(7 * random_.uniform(RandomUse::RayRow, id, n)) : 1;
      ray.low.push_back(z);
      for (int row = 0; row < rows; ++row, ++rowNumber)
      {
        Ray::Row cells;
        cells.low = z;
        cells.high = solid3D_ ? z + height : 2.5;
        z = cells.high;
        if (cells.high > 0 && cells.low < static_cast<double>(nz_))
        {
          const std::vector<double> walls = layout_.crossWalls(softwoodRayCell, 64 * id + rowNumber);
          std::size_t next = 1;
          for (std::int64_t x = 0; x < nx_; ++x)
          {
            const double at = static_cast<double>(x) + 0.5;
            while (next + 1 < walls.size() && walls[next] < at)
              ++next;
            cells.before.push_back(static_cast<float>(at - walls[next - 1]));
            cells.after.push_back(static_cast<float>(walls[next] - at));
            cells.label.push_back(label + static_cast<std::int32_t>(next));
          }
          label += static_cast<std::int32_t>(walls.size()) + 1;
          ray.rows.push_back(std::move(cells));
        }
      }
      ray.high.push_back(z);
      z += rayGap * width * (0.5 + random_.uniform(RandomUse::RayRow, id, n, 1));
    }
  }
}

double Rasteriser::rayHalfWidth(int ray, double z) const
{
  const double full = layout_.rayHalfWidth();
  if (!solid3D_)
    return full;
  // Spindle-shaped in the tangential section: full in the middle, closing over the last cell at each end.
  const Ray& stack = rays_[static_cast<std::size_t>(ray)];
  const double closing = 1.5 * rayCellHeight * options_.tangentialDiameter / options_.spacing;
  for (std::size_t n = 0; n < stack.low.size(); ++n)
  {
    if (z > stack.low[n] && z < stack.high[n])
    {
      const double t = std::min(1.0, std::min(z - stack.low[n], stack.high[n] - z) / closing);
      return full * std::sqrt(t * (2 - t));
    }
  }
  return 0;
}

Column Rasteriser::column(std::int64_t x, std::int64_t y) const
{
  Column result;
  result.number = static_cast<std::uint32_t>(cellOf_[static_cast<std::size_t>(x + nx_ * y)]);
  result.cell = &layout_.cells()[result.number];
  int rays = 0;
  for (const CellSide& side : layout_.sides(*result.cell))
  {
    const double d = side.distance(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5);
    if (side.ray >= 0 && rays < 2)
    {
      result.ray[rays] = side.ray;
      result.rayDistance[rays] = std::max(0.0, d);
      result.raySide[rays] = side.rayBelow ? -1 : 1;
      ++rays;
    }
    else if (result.count < maxSides - 4) // room for two rays and two ends
    {
      result.distances[result.count++] = d;
    }
  }
  return result;
}

float Rasteriser::rayKey(
  const Column& column, int which, double halfWidth, std::int64_t x, double z, std::int32_t& label) const
{
  const Ray& ray = rays_[static_cast<std::size_t>(column.ray[which])];
  auto row = ray.rows.begin();
  while (row + 1 != ray.rows.end() && z >= row->high)
    ++row;
  const auto node = static_cast<std::size_t>(x);
  label = row->label[node];
  const double off = column.rayDistance[which];
  const double distances[6] = { halfWidth - off, halfWidth + off, row->before[node], row->after[node],
    solid3D_ ? z - row->low : 1e9, solid3D_ ? row->high - z : 1e9 };
  const double fillet = softwoodRayFillet * layout_.rayHalfWidth();
  const double middle[2] = { layout_.rayHalfWidth(), layout_.rayHalfWidth() };
  const double thickness = softwoodRayThickness * layout_.thickness(static_cast<double>(x));
  return static_cast<float>(widened(wallDepth(distances, fillet), wallDepth(middle, fillet)) / thickness);
}

void Rasteriser::fillRow(
  std::int64_t y, std::int64_t z, std::span<const Column> columns, float* key, std::int32_t* label) const
{
  const double atY = static_cast<double>(y) + 0.5;
  const double atZ = static_cast<double>(z) + 0.5;
  for (std::int64_t x = 0; x < nx_; ++x)
  {
    const Column& column = columns[static_cast<std::size_t>(x)];
    double distances[maxSides];
    std::copy_n(column.distances, column.count, distances);
    std::size_t count = column.count;
    bool inRay = false;
    for (int which = 0; which < 2 && column.ray[which] >= 0 && !inRay; ++which)
    {
      const double halfWidth = rayHalfWidth(column.ray[which], atZ);
      if (column.rayDistance[which] < halfWidth)
      {
        inRay = true;
        key[x] = rayKey(column, which, halfWidth, x, atZ, label[x]);
      }
      else
      {
        distances[count++] = column.rayDistance[which] - halfWidth;
      }
    }
    if (inRay)
      continue;
    const CellShape& cell = *column.cell;
    const Ends& ends = ends_[column.number];
    label[x] = ends.firstLabel;
    if (solid3D_)
    {
      const double level = atZ - ends.slope * (atY - cell.centreY);
      std::size_t above = 1;
      while (above + 1 < ends.z.size() && ends.z[above] < level)
        ++above;
      label[x] += static_cast<std::int32_t>(above);
      distances[count++] = (level - ends.z[above - 1]) * ends.cosine;
      distances[count++] = (ends.z[above] - level) * ends.cosine;
    }
    key[x] = static_cast<float>(widened(wallDepth({ distances, count }, cell.fillet), cell.depth) / cell.thickness);
  }
}

/// Nodes with another cell before them along any axis or diagonal of the lattice are wall whatever its thickness: this
/// thinnest wall is connected through faces and lets no lumen touch another, not even at a corner.
/// @return how many they are
std::int64_t Rasteriser::closeWalls(float* key, const std::int32_t* here, const std::int32_t* above) const
{
  std::int64_t closed = 0;
  for (std::int64_t y = 0; y < ny_; ++y)
  {
    const std::int64_t up = y + 1 < ny_ ? nx_ : 0;
    for (std::int64_t x = 0; x < nx_; ++x)
    {
      const std::int64_t right = x + 1 < nx_ ? 1 : 0;
      const std::int64_t node = x + nx_ * y;
      const std::int32_t own = here[node];
      bool differs = here[node + right] != own || here[node + up] != own || here[node + up + right] != own;
      if (above != nullptr)
      {
        differs = differs || above[node] != own || above[node + right] != own || above[node + up] != own ||
          above[node + up + right] != own;
      }
      if (differs)
      {
        key[node] = 0;
        ++closed;
      }
    }
  }
  return closed;
}

PhaseImage Rasteriser::image()
{
  PhaseImage result{ makeLattice(nx_, ny_, nz_, options_.dimension, options_.spacing), {},
    PhaseTable({ "lumen", "wall" }) };
  const std::int64_t slice = nx_ * ny_;
  std::vector<float> key(static_cast<std::size_t>(slice * nz_));
  std::vector<std::int32_t> label(static_cast<std::size_t>(slice));
  std::vector<std::int32_t> below(solid3D_ ? label.size() : 0);
  std::vector<Column> columns(static_cast<std::size_t>(solid3D_ ? slice : nx_));
  std::int64_t closed = 0;
  for (std::int64_t z = 0; z < nz_; ++z)
  {
    for (std::int64_t y = 0; y < ny_; ++y)
    {
      Column* const row = columns.data() + (solid3D_ ? y * nx_ : 0);
      for (std::int64_t x = 0; x < nx_ && z == 0; ++x)
        row[x] = column(x, y);
      fillRow(y, z, { row, static_cast<std::size_t>(nx_) }, key.data() + z * slice + y * nx_, label.data() + y * nx_);
    }
    if (z > 0)
      closed += closeWalls(key.data() + (z - 1) * slice, below.data(), label.data());
    if (z + 1 == nz_)
      closed += closeWalls(key.data() + z * slice, label.data(), nullptr);
    label.swap(below); // 2D: one slice only, so both are done with
  }

  const std::int64_t solid = solidNodes(options_.solidFraction, options_.spacing, result.lattice.count(), closed);
  result.phase = markSmallest(key, solid);
  return result;
}

} // namespace

void check(const SoftwoodOptions& o)
{
  const auto positive = [](const char* name, double value, const char* hint)
  {
    if (!(value > 0) || !std::isfinite(value))
      throw ParameterError(fmt::format("the {} of a softwood sample is {}", name, value), hint);
  };
  if (o.dimension != 2 && o.dimension != 3)
    throw ParameterError(fmt::format("a softwood sample of {} dimensions", o.dimension), "choose 2 or 3");
  for (int axis = 0; axis < 3; ++axis)
  {
    const std::int64_t nodes = o.size[axis];
    if (nodes < 1 || nodes > 1000000 || (axis == 2 && o.dimension == 2 && nodes != 1))
    {
      throw ParameterError(fmt::format("{} nodes along {} in a {}D softwood sample", nodes, "xyz"[axis], o.dimension),
        "give 1 to 1000000 nodes along each axis, one along z in 2D");
    }
  }
  positive("spacing", o.spacing, "give it in metres, such as 1e-6");
  for (const auto& [name, value] : { std::pair{ "tangential diameter", o.tangentialDiameter },
         std::pair{ "radial diameter in earlywood", o.radialDiameterEarly },
         std::pair{ "radial diameter in latewood", o.radialDiameterLate } })
  {
    positive(name, value, "give it in metres, such as 30e-6");
    if (value < 6 * o.spacing)
    {
      throw ParameterError(fmt::format("the {} is {:.3g} m, less than 6 nodes of {:.3g} m", name, value, o.spacing),
        fmt::format("take a spacing of {:.3g} m or less, or larger cells", value / 6));
    }
  }
  if (!(o.solidFraction > 0) || !(o.solidFraction < 1))
  {
    throw ParameterError(
      fmt::format("a solid fraction of {}", o.solidFraction), "it lies between 0 and 1, such as 0.40");
  }
  for (const double position : { o.ringPosition0, o.ringPosition1 })
  {
    if (!(position >= 0) || !(position <= 1))
    {
      throw ParameterError(
        fmt::format("a position of {} in the ring", position), "it runs from 0, earlywood, to 1, latewood");
    }
  }
  if (!(o.scatter >= 0) || !(o.scatter <= 0.3))
    throw ParameterError(fmt::format("a scatter of {}", o.scatter), "it runs from 0, regular, to 0.3");
  if (o.rayEvery != 0 && !(o.rayEvery >= 2 * o.tangentialDiameter && std::isfinite(o.rayEvery)))
  {
    throw ParameterError(
      fmt::format("a ray every {:.3g} m between tracheids of {:.3g} m", o.rayEvery, o.tangentialDiameter),
      "leave at least two tangential diameters between rays, or 0 for none");
  }
  if (o.dimension == 3 && !(o.tracheidLength >= 1.5 * o.tangentialDiameter && std::isfinite(o.tracheidLength)))
  {
    throw ParameterError(
      fmt::format("tracheids {:.3g} m long and {:.3g} m wide", o.tracheidLength, o.tangentialDiameter),
      "make them at least one and a half times as long as wide");
  }
  const double nodes = static_cast<double>(o.size[0]) * static_cast<double>(o.size[1]) * static_cast<double>(o.size[2]);
  const double bytes =
    o.dimension == 3 ? 5 * nodes + 350 * static_cast<double>(o.size[0]) * static_cast<double>(o.size[1]) : 17 * nodes;
  if (const auto available = static_cast<double>(availableMemory()); bytes > available)
  {
    throw MemoryError(fmt::format("a sample of {:.3g} nodes takes {} to make, and {} are free", nodes, bytesText(bytes),
                        bytesText(available)),
      "make a smaller one");
  }
}

PhaseImage softwood(const SoftwoodOptions& options)
{
  check(options);
  return Rasteriser(options).image();
}

} // namespace lamella::generators
