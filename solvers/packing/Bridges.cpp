#include "packing/Bridges.h"

#include "core/Error.h"
#include "core/Memory.h"
#include "packing/LineSections.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace lamella::packing
{
namespace
{

constexpr double widest = 2;
// Lines a voxel, along each axis across x, by which its shares are measured.
constexpr int shareLines[] = { 0, 0, 16, 8 };

void checkWidth(double width)
{
  if (!(width >= 0 && width <= widest))
    throw ParameterError(fmt::format("the width of the bridges is {}", width),
      "it is a share of the grains' diameter, from 0 (no bridges) to 2");
}

std::vector<double> midpoints(double length, std::int64_t count)
{
  std::vector<double> at(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < at.size(); ++i)
    at[i] = (static_cast<double>(i) + 0.5) * length / static_cast<double>(count);
  return at;
}

// The union of sorted sections.
std::vector<Section> merged(const std::vector<Section>& sections)
{
  std::vector<Section> whole;
  double end = -std::numeric_limits<double>::infinity();
  for (const Section& s : sections)
    if (s.low > end)
    {
      whole.push_back(s);
      end = s.high;
    }
    else if (s.high > end)
      end = whole.back().high = s.high;
  return whole;
}

// f(low, high) of the union of `parts` (sorted), less what `holes` cover, which are merged.
template <class F>
void forUncovered(const std::vector<Section>& parts, const std::vector<Section>& holes, F&& f)
{
  std::size_t hole = 0;
  double end = -std::numeric_limits<double>::infinity();
  for (const Section& p : parts)
  {
    double from = std::max(p.low, end);
    end = std::max(end, p.high);
    while (hole < holes.size() && holes[hole].high <= from)
      ++hole;
    for (std::size_t k = hole; from < p.high; ++k)
    {
      if (k >= holes.size() || holes[k].low >= p.high)
      {
        f(from, p.high);
        break;
      }
      if (holes[k].low > from)
        f(from, holes[k].low);
      from = std::max(from, holes[k].high);
    }
  }
}

MatrixFractions fractionsOf(double grains, double matrix)
{
  MatrixFractions f;
  f.grains = grains;
  f.matrix = matrix;
  f.voids = std::max(0.0, 1 - grains - matrix);
  f.saturation = matrix + f.voids > 0 ? matrix / (matrix + f.voids) : 0;
  return f;
}

} // namespace

std::vector<Bridge> findBridges(const Packing& packing, double reach, bool walls)
{
  if (!(reach >= 1 && reach <= 2))
    throw ParameterError(fmt::format("the reach of the bridges is {}", reach),
      "bridged are pairs nearer than this times the sum of their radii, from 1 (those that touch) to 2");
  const auto axes = static_cast<std::size_t>(packing.dimension);
  const std::size_t last = axes - 1;
  if (walls && packing.periodic[last])
    throw ParameterError("bridges to the walls of a packing that has none: its last axis is periodic",
      "leave them out, or make a packing between walls");
  const double largest = *std::max_element(packing.radius.begin(), packing.radius.end());
  for (std::size_t a = 0; a < axes; ++a)
    if (packing.periodic[a] && packing.size[a] < 2 * reach * largest) // its own and second images would be as near
      throw ParameterError(
        fmt::format("bridges up to {:g} long in a periodic box {:g} wide", 2 * reach * largest, packing.size[a]),
        fmt::format("a reach below {:.3g}, or a box of more grains", packing.size[a] / (2 * largest)));
  struct Image
  {
    std::int32_t grain;
    std::array<double, 3> shift;
    std::array<double, 3> centre;
    bool original;
  };
  std::vector<Image> images;
  for (std::size_t i = 0; i < packing.count(); ++i)
  {
    std::array<int, 3> most{ 0, 0, 0 };
    for (std::size_t a = 0; a < axes; ++a)
      most[a] = packing.periodic[a] ? 1 : 0;
    for (int z = -most[2]; z <= most[2]; ++z)
      for (int y = -most[1]; y <= most[1]; ++y)
        for (int x = -most[0]; x <= most[0]; ++x)
        {
          Image image{ static_cast<std::int32_t>(i), { 0, 0, 0 }, packing.centre[i], x == 0 && y == 0 && z == 0 };
          const std::array<int, 3> step{ x, y, z };
          bool near = true;
          for (std::size_t a = 0; a < axes; ++a)
          {
            image.shift[a] = step[a] * packing.size[a];
            image.centre[a] += image.shift[a];
            near =
              near && image.centre[a] > -2 * reach * largest && image.centre[a] < packing.size[a] + 2 * reach * largest;
          }
          if (near)
            images.push_back(image);
        }
  }
  std::sort(
    images.begin(), images.end(), [&](const Image& a, const Image& b) { return a.centre[last] < b.centre[last]; });
  std::vector<Bridge> bridges;
  for (std::size_t m = 0; m < images.size(); ++m)
    for (std::size_t k = m + 1;
         k < images.size() && images[k].centre[last] - images[m].centre[last] < 2 * reach * largest; ++k)
    {
      const Image& a = images[m].grain < images[k].grain ? images[m] : images[k];
      const Image& b = images[m].grain < images[k].grain ? images[k] : images[m];
      if (a.grain == b.grain || !a.original)
        continue;
      double square = 0;
      for (std::size_t axis = 0; axis < axes; ++axis)
        square += (a.centre[axis] - b.centre[axis]) * (a.centre[axis] - b.centre[axis]);
      const double most =
        reach * (packing.radius[static_cast<std::size_t>(a.grain)] + packing.radius[static_cast<std::size_t>(b.grain)]);
      if (square < most * most)
        bridges.push_back({ a.grain, b.grain, b.shift });
    }
  for (std::size_t i = 0; walls && i < packing.count(); ++i)
    for (const double wall : { 0.0, packing.size[last] })
      if (const double away = wall - packing.centre[i][last]; away != 0 && std::abs(away) < reach * packing.radius[i])
      {
        Bridge bridge{ static_cast<std::int32_t>(i), static_cast<std::int32_t>(i) };
        bridge.shift[last] = 2 * away;
        bridges.push_back(bridge);
      }
  std::sort(bridges.begin(), bridges.end(),
    [](const Bridge& a, const Bridge& b)
    { return std::tie(a.first, a.second, a.shift) < std::tie(b.first, b.second, b.shift); });
  return bridges;
}

MatrixFractions matrixFractions(
  const Packing& packing, std::span<const Bridge> bridges, double width, bool filled, int lines)
{
  checkWidth(width);
  const int dimension = packing.dimension;
  const auto last = static_cast<std::size_t>(dimension - 1);
  const double smallest = 2 * *std::min_element(packing.radius.begin(), packing.radius.end());
  const auto number = [&](std::size_t axis) -> std::int64_t
  {
    if (lines > 0)
      return lines;
    const double perDiameter = dimension == 2 ? 400 : 20;
    return std::clamp<std::int64_t>(
      static_cast<std::int64_t>(std::ceil(perDiameter * packing.size[axis] / smallest)), 100, 100'000);
  };
  // In space a grain that is tiny beside the box would ask for more lines than anybody can wait for.
  constexpr double mostLines = 4e6;
  const double asked = dimension == 3 ? static_cast<double>(number(last)) * static_cast<double>(number(1)) : 1;
  const double fewer = lines > 0 || asked <= mostLines ? 1 : std::sqrt(mostLines / asked);
  const auto count = [&](std::size_t axis)
  { return std::max<std::int64_t>(1, static_cast<std::int64_t>(fewer * static_cast<double>(number(axis)))); };
  const std::vector<double> planes = midpoints(packing.size[last], count(last));
  const std::vector<double> rows = dimension == 3 ? midpoints(packing.size[1], count(1)) : std::vector<double>{ 0 };
  double grains = 0;
  double matrix = 0;
  forEachLine(packing, bridges, filled ? 0 : width, rows, planes,
    [&](std::size_t, std::size_t, const LineSections& line)
    {
      const std::vector<Section> whole = merged(line.grains);
      for (const Section& s : whole)
        grains += s.high - s.low;
      forUncovered(line.bridges, whole, [&](double low, double high) { matrix += high - low; });
    });
  const double all = packing.size[0] * static_cast<double>(rows.size()) * static_cast<double>(planes.size());
  return fractionsOf(grains / all, filled ? 1 - grains / all : matrix / all);
}

double widthForSaturation(const Packing& packing, std::span<const Bridge> bridges, double saturation, int lines)
{
  const auto at = [&](double width) { return matrixFractions(packing, bridges, width, false, lines).saturation; };
  double high = widest;
  double errorHigh = at(high) - saturation;
  if (!(saturation >= 0) || errorHigh < 0)
    throw ParameterError(fmt::format("a saturation of {} cannot be reached with bridges", saturation),
      fmt::format("bridges between these grains reach from 0 to {:.3f}; a wider reach gives more, and filled is 1",
        errorHigh + saturation));
  double low = 0;
  double errorLow = -saturation;
  // false position, halving the weight of an end that stays (Illinois)
  int stays = 0;
  for (int i = 0; i < 60 && errorLow != 0; ++i)
  {
    const double middle = low + (high - low) * -errorLow / (errorHigh - errorLow);
    const double error = at(middle) - saturation;
    if (std::abs(error) <= 1e-6 * saturation || high - low < 1e-12)
      return middle;
    if (error < 0)
    {
      low = middle;
      errorLow = error;
      if (stays < 0)
        errorHigh *= 0.5;
      stays = -1;
    }
    else
    {
      high = middle;
      errorHigh = error;
      if (stays > 0)
        errorLow *= 0.5;
      stays = 1;
    }
  }
  return errorLow == 0 ? 0 : low;
}

namespace
{

/// What of a sample is doubtful.
std::vector<std::string> doubts(
  const Packing& packing, std::span<const Bridge> bridges, const CementedSample& sample, const BridgeOptions& options)
{
  std::vector<std::string> found;
  if (options.saturation && std::abs(sample.fractions.saturation - *options.saturation) > 1e-4 * *options.saturation)
    found.push_back(
      fmt::format("the saturation is {:.5g} in place of {:.5g}: so few bridges, along x, grow in steps of the "
                  "lines by which shares are measured",
        sample.fractions.saturation, *options.saturation));
  double overlap = 0; // over the smaller one's diameter
  double thinnest = std::numeric_limits<double>::infinity();
  for (const Bridge& b : bridges)
  {
    const auto i = static_cast<std::size_t>(b.first);
    const auto j = static_cast<std::size_t>(b.second);
    const double smaller = std::min(packing.radius[i], packing.radius[j]);
    thinnest = std::min(thinnest, 2 * sample.width * smaller);
    if (i == j) // to a wall, or an image of its own
      continue;
    double square = 0;
    for (std::size_t a = 0; a < 3; ++a)
    {
      const double r = packing.centre[j][a] + b.shift[a] - packing.centre[i][a];
      square += r * r;
    }
    overlap = std::max(overlap, 0.5 * (packing.radius[i] + packing.radius[j] - std::sqrt(square)) / smaller);
  }
  if (overlap > 0.02)
    found.push_back(
      fmt::format("grains overlap by up to {:.1f} % of the smaller one's diameter: shares are those of their union",
        100 * overlap));
  const double spacing = sample.image.lattice.spacing;
  if (sample.width > 0 && thinnest < 2 * spacing)
    found.push_back(
      fmt::format("the thinnest bridges are {:.2g} nodes wide at their ends, and the lattice may miss them; "
                  "take more nodes across",
        thinnest / spacing));
  const auto off = [](double a, double b) { return std::abs(a - b) > 0.02; };
  const MatrixFractions& exact = sample.fractions;
  const MatrixFractions& nodes = sample.onLattice;
  if (off(exact.grains, nodes.grains) || off(exact.matrix, nodes.matrix) || off(exact.saturation, nodes.saturation))
    found.push_back(
      fmt::format("the lattice is too coarse: grains {:.1f} % of it, {:.1f} % of the box; saturation {:.1f} "
                  "%, and {:.1f} % of the geometry; take more nodes across",
        100 * nodes.grains, 100 * exact.grains, 100 * nodes.saturation, 100 * exact.saturation));
  return found;
}

void check(const Packing& packing, const BridgeOptions& options, const RasterOptions& raster)
{
  checkWidth(options.width);
  if (options.saturation && !(*options.saturation >= 0 && *options.saturation <= 1))
    throw ParameterError(fmt::format("the saturation is {}", *options.saturation),
      "it is the share of the space between the grains that is matrix, from 0 to 1");
  if (raster.nodesAcross < 2 || raster.nodesAcross > 1'000'000)
    throw ParameterError(fmt::format("{} nodes across", raster.nodesAcross), "from 2 to 1000000");
  if (!(raster.platen >= 0) || !std::isfinite(raster.platen))
    throw ParameterError(fmt::format("the platens are {} thick", raster.platen), "0 (none) or a length");
  if (packing.count() == 0 || !(packing.volume() > 0))
    throw InputError("the packing has no grains", "make or read one first");
}

/// Grains, and bridges where the width is above 0, on the nodes between the platens.
/// @param inner nodes between the platens along the last axis @param plate nodes in a platen @return of grains, of
/// matrix
std::pair<std::int64_t, std::int64_t> drawLines(const Packing& packing, const std::vector<Bridge>& bridges,
  double width, std::int64_t inner, std::int64_t plate, CementedSample& sample)
{
  PhaseImage& image = sample.image;
  const std::array<std::int64_t, 3>& size = image.lattice.size;
  const int dimension = image.lattice.dimension;
  const double spacing = image.lattice.spacing;
  const auto centres = [&](std::int64_t n)
  {
    std::vector<double> at(static_cast<std::size_t>(n));
    for (std::size_t i = 0; i < at.size(); ++i)
      at[i] = (static_cast<double>(i) + 0.5) * spacing;
    return at;
  };
  const std::vector<double> planes = centres(inner);
  const std::vector<double> rows = dimension == 3 ? centres(size[1]) : std::vector<double>{ 0 };
  std::int64_t grainNodes = 0;
  std::int64_t matrixNodes = 0;
  forEachLine(packing, bridges, width, rows, planes,
    [&](std::size_t row, std::size_t plane, const LineSections& line)
    {
      const auto p = static_cast<std::int64_t>(plane) + plate;
      const std::int64_t start =
        dimension == 3 ? image.lattice.index(0, static_cast<std::int64_t>(row), p) : image.lattice.index(0, p);
      const auto fill = [&](const Section& s, const auto& set)
      {
        const auto from = std::max<std::int64_t>(0, static_cast<std::int64_t>(std::ceil(s.low / spacing - 0.5)));
        const auto to = std::min(size[0] - 1, static_cast<std::int64_t>(std::floor(s.high / spacing - 0.5)));
        for (std::int64_t x = from; x <= to; ++x)
          set(static_cast<std::size_t>(start + x));
      };
      for (const Section& s : line.bridges)
        fill(s, [&](std::size_t i) { image.phase[i] = 1; });
      for (const Section& s : line.grains)
        fill(s,
          [&](std::size_t i)
          {
            image.phase[i] = 2;
            sample.grain[i] = s.grain + 1;
          });
      for (std::int64_t x = 0; x < size[0]; ++x)
      {
        const std::uint8_t phase = image.phase[static_cast<std::size_t>(start + x)];
        grainNodes += phase == 2 ? 1 : 0;
        matrixNodes += phase == 1 ? 1 : 0;
      }
    });
  return { grainNodes, matrixNodes };
}

// How much of each voxel is grain, and how much solid: exact along x, by a few lines across.
void measureShares(const Packing& packing, const std::vector<Bridge>& bridges, bool filled, std::int64_t inner,
  std::int64_t plate, CementedSample& sample)
{
  const Lattice& lattice = sample.image.lattice;
  const int each = shareLines[lattice.dimension];
  const auto lines = [&](std::int64_t n) { return midpoints(lattice.spacing * static_cast<double>(n), n * each); };
  const std::vector<double> planes = lines(inner);
  const std::vector<double> rows = lattice.dimension == 3 ? lines(lattice.size[1]) : std::vector<double>{ 0 };
  const auto part = static_cast<float>(lattice.dimension == 3 ? 1.0 / (each * each) : 1.0 / each);
  sample.grainShare.assign(sample.grain.size(), 0.0F);
  sample.solidShare.assign(sample.grain.size(), filled ? 1.0F : 0.0F);
  forEachLine(packing, bridges, filled ? 0 : sample.width, rows, planes,
    [&](std::size_t row, std::size_t plane, const LineSections& line)
    {
      const auto p = static_cast<std::int64_t>(plane) / each + plate;
      const auto r = static_cast<std::int64_t>(row) / each;
      const std::int64_t start = lattice.dimension == 3 ? lattice.index(0, r, p) : lattice.index(0, p);
      const auto add = [&](std::vector<float>& share, double low, double high)
      {
        low = std::max(low / lattice.spacing, 0.0);
        high = std::min(high / lattice.spacing, static_cast<double>(lattice.size[0]));
        for (auto x = static_cast<std::int64_t>(low); static_cast<double>(x) < high; ++x)
        {
          const double length = std::min(high, static_cast<double>(x + 1)) - std::max(low, static_cast<double>(x));
          share[static_cast<std::size_t>(start + x)] += part * static_cast<float>(length);
        }
      };
      const std::vector<Section> grains = merged(line.grains);
      for (const Section& s : grains)
      {
        add(sample.grainShare, s.low, s.high);
        if (!filled)
          add(sample.solidShare, s.low, s.high);
      }
      if (!filled)
        forUncovered(line.bridges, grains, [&](double low, double high) { add(sample.solidShare, low, high); });
    });
  for (std::vector<float>* const share : { &sample.grainShare, &sample.solidShare })
    for (float& value : *share)
      value = std::min(value, 1.0F); // sums of 4-byte numbers
}

} // namespace

CementedSample cement(const Packing& packing, const BridgeOptions& options, const RasterOptions& raster)
{
  check(packing, options, raster);
  const std::vector<Bridge> bridges = findBridges(packing, options.reach, options.walls);
  CementedSample sample;
  sample.bridges = static_cast<std::int64_t>(bridges.size());
  sample.width = options.width;
  const bool filled = options.filled || (options.saturation && *options.saturation == 1);
  if (options.saturation && !filled)
    sample.width = widthForSaturation(packing, bridges, *options.saturation);
  sample.fractions = matrixFractions(packing, bridges, sample.width, filled);

  const int dimension = packing.dimension;
  const double spacing = packing.size[0] / static_cast<double>(raster.nodesAcross);
  const auto along = [&](double length)
  { return std::max<std::int64_t>(1, static_cast<std::int64_t>(std::llround(length / spacing))); };
  const std::int64_t plate = raster.platen > 0 ? along(raster.platen) : 0;
  std::array<std::int64_t, 3> size{ raster.nodesAcross, along(packing.size[1]),
    dimension == 3 ? along(packing.size[2]) : 1 };
  const auto last = static_cast<std::size_t>(dimension - 1);
  const std::int64_t inner = size[last];
  size[last] += 2 * plate;
  const double bytes = (raster.shares ? 13.0 : 5.0) * static_cast<double>(size[0]) * static_cast<double>(size[1]) *
    static_cast<double>(size[2]);
  if (bytes > static_cast<double>(availableMemory()))
    throw MemoryError(fmt::format("a sample of {} × {} × {} nodes needs {}, and {} are free", size[0], size[1], size[2],
                        bytesText(bytes), bytesText(static_cast<double>(availableMemory()))),
      "take fewer nodes across");

  PhaseImage& image = sample.image;
  image.lattice = makeLattice(size[0], size[1], size[2], dimension, spacing);
  image.phases = PhaseTable({ "void", "matrix", "grain" });
  const std::size_t count = static_cast<std::size_t>(image.lattice.count());
  image.phase.assign(count, filled ? 1 : 0);
  sample.grain.assign(count, 0);

  const auto [grainNodes, matrixNodes] = drawLines(packing, bridges, filled ? 0 : sample.width, inner, plate, sample);
  const double nodes = static_cast<double>(count) * static_cast<double>(inner) / static_cast<double>(size[last]);
  sample.onLattice = fractionsOf(static_cast<double>(grainNodes) / nodes, static_cast<double>(matrixNodes) / nodes);

  if (raster.shares)
    measureShares(packing, bridges, filled, inner, plate, sample);
  const std::size_t layer = count / static_cast<std::size_t>(size[last]) * static_cast<std::size_t>(plate);
  for (const std::size_t begin : { std::size_t{ 0 }, count - layer })
  {
    for (std::vector<float>* const share : { &sample.grainShare, &sample.solidShare })
      if (raster.shares)
        std::fill_n(share->begin() + static_cast<std::ptrdiff_t>(begin), layer, 1.0F);
    std::fill_n(image.phase.begin() + static_cast<std::ptrdiff_t>(begin), layer, std::uint8_t{ 2 });
    std::fill_n(sample.grain.begin() + static_cast<std::ptrdiff_t>(begin), layer, -1);
  }
  if (filled)
    sample.width = 0; // there are none
  sample.warnings = doubts(packing, bridges, sample, options);
  sample.width = filled ? options.width : sample.width;
  return sample;
}

} // namespace lamella::packing
