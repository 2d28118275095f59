#include "lbm/lean/LeanField.h"

#include "lbm/BoxField.h"
#include "lbm/multigrid/Kernels.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace lamella::lbm
{
namespace
{

// Three planes of a tile's rows, picture and field, are to stay in a core's cache.
constexpr std::int64_t tileBytes = 600 * 1024;
constexpr std::int64_t tilePlanes = 48;
// Below that many nodes waiting for another thread costs more than its work.
constexpr std::int64_t threadedNodes = 100000;

Level emptyLevel(const Problem& problem)
{
  const Block& block = problem.parts.block();
  Level level;
  level.grid = Grid(problem.lattice.dimension, block.size[0], block.size[1], block.size[2]);
  level.periodic = problem.periodic();
  level.start = block.start;
  level.size = problem.lattice.size;
  level.comm = std::make_unique<Communicator>(problem.comm);
  level.parts = std::make_unique<Decomposition>(problem.parts);
  level.halo = Halo(problem.lattice.dimension, block.size, *level.parts, *level.comm, level.periodic);
  return level;
}

std::vector<std::uint8_t> idsOf(const Problem& problem)
{
  std::array<double, 256> here{};
  for (const std::uint8_t id : problem.phase)
    here[id] = 1;
  problem.comm.sum(here);
  std::vector<std::uint8_t> ids;
  for (std::size_t id = 0; id < here.size(); ++id)
    if (here[id] > 0)
      ids.push_back(static_cast<std::uint8_t>(id));
  return ids;
}

// Two phases, whose links are the same along all axes.
bool onlyTwo(const Links& links, std::span<const std::uint8_t> ids)
{
  return ids.size() <= 2 && links.tables() == 1;
}

// Of others: a row of 256 for each, table by table.
std::vector<double> pairsOf(const Links& links, std::span<const std::uint8_t> ids)
{
  std::vector<double> pairs;
  if (onlyTwo(links, ids))
    return pairs;
  const std::size_t one = (std::size_t{ ids.back() } + 1) * 256;
  pairs.assign(links.tables() * one, 0.0);
  for (std::size_t table = 0; table < links.tables(); ++table)
    for (const std::uint8_t a : ids)
      for (const std::uint8_t b : ids)
        pairs[table * one + std::size_t{ a } * 256 + b] = links.mean(a, b, static_cast<int>(table));
  return pairs;
}

PhaseLinks tableOf(const Links& links, std::span<const std::uint8_t> ids, const std::vector<double>& pairs,
  const std::vector<float>& single)
{
  PhaseLinks table;
  table.two = onlyTwo(links, ids);
  table.byAxis = links.tables() > 1;
  for (int axis = 0; axis < 3; ++axis)
  {
    const std::size_t begin = links.table(axis) * (pairs.size() / links.tables());
    table.table[axis] = pairs.data() + begin;
    table.single[axis] = single.data() + begin;
  }
  if (table.two)
  {
    table.second = ids.back();
    table.both[0] = links.mean(ids.front(), ids.front(), 0);
    table.both[1] = links.mean(ids.front(), ids.back(), 0);
    table.both[2] = links.mean(ids.back(), ids.back(), 0);
  }
  return table;
}

} // namespace

LeanField::LeanField(const Problem& problem)
  : problem_(problem)
  , block_(problem.parts.block())
  , links_(problem.links())
  , level_(emptyLevel(problem))
  , phases_(block_, level_.halo, problem.phase, problem.lattice.dimension)
  , ids_(idsOf(problem))
  , pairs_(pairsOf(links_, ids_))
  , pairsSingle_(pairs_.begin(), pairs_.end())
  , table_(tableOf(links_, ids_, pairs_, pairsSingle_))
  , v_(level_.grid.floats(), 0.0F)
  , nothing_(static_cast<std::size_t>(level_.grid.stride), 0.0F)
{
  const Grid& g = level_.grid;
  tileY_ = std::clamp<std::int64_t>(tileBytes / (3 * (5 * g.nx)), 2, g.ny);
  tileZ_ = std::min<std::int64_t>(tilePlanes, g.nz);
  countConductance();
}

std::size_t LeanField::bytes() const noexcept
{
  return (v_.size() + source_.size()) * sizeof(float) + phases_.bytes() +
    pairs_.size() * (sizeof(double) + sizeof(float));
}

std::int64_t LeanField::along(std::int64_t y, std::int64_t z) const noexcept
{
  return problem_.axis == 1 ? y + block_.start[1] : z + block_.start[2];
}

std::size_t LeanField::tiles() const noexcept
{
  const Grid& g = level_.grid;
  return static_cast<std::size_t>(((g.ny + tileY_ - 1) / tileY_) * ((g.nz + tileZ_ - 1) / tileZ_));
}

void LeanField::forEachRow(const RowFunction& f) const
{
  const Grid& g = level_.grid;
  const std::int64_t columns = (g.ny + tileY_ - 1) / tileY_;
  const auto count = static_cast<std::int64_t>(tiles());
  const int threads = this->threads();
#pragma omp parallel for num_threads(threads) if (threads > 1) schedule(dynamic)
  for (std::int64_t t = 0; t < count; ++t)
  {
    const std::int64_t y0 = t % columns * tileY_;
    const std::int64_t z0 = t / columns * tileZ_;
    for (std::int64_t z = z0; z < std::min(g.nz, z0 + tileZ_); ++z)
      for (std::int64_t y = y0; y < std::min(g.ny, y0 + tileY_); ++y)
        f(y, z, static_cast<std::size_t>(t));
  }
}

RowSide LeanField::side(std::int64_t y, std::int64_t z, int part, int axis, int step) const
{
  const Grid& g = level_.grid;
  const bool ours = axis == 1 ? (step < 0 ? y > 0 : y < g.ny - 1) : (step < 0 ? z > 0 : z < g.nz - 1);
  const bool falls = problem_.axis == axis && source_.empty();
  const float sign = step < 0 ? 1.0F : -1.0F;
  const auto factor = static_cast<float>(links_.factor(axis));
  if (ours || level_.halo.inside(axis, step))
  {
    const std::int64_t otherY = axis == 1 ? y + step : y;
    const std::int64_t otherZ = axis == 2 ? z + step : z;
    return { phases_(otherY, otherZ), v_.data() + g.row(otherY, otherZ) + g.shift(part, 0), factor, falls ? sign : 0.0F,
      false };
  }
  const bool wall = links_.boundary(axis) == Boundary::Fixed;
  return { phases_(y, z), nothing_.data(), wall ? 2.0F * factor : 0.0F, wall && falls ? 0.5F * sign : 0.0F, true };
}

PhaseRow LeanField::row(std::int64_t y, std::int64_t z, int part) const
{
  const Grid& g = level_.grid;
  const float* v = v_.data() + g.row(y, z);
  const std::uint8_t* phase = phases_(y, z);
  const bool falls = problem_.axis == 0 && source_.empty();
  PhaseRow r{ g.nx, part, phase, v + g.shift(part, -1), v + g.shift(part, 0), v + g.shift(part, 1),
    falls ? -1.0F : 0.0F, {}, {},
    { side(y, z, part, 1, -1), side(y, z, part, 1, 1), side(y, z, part, 2, -1), side(y, z, part, 2, 1) }, nullptr };
  r.low = { phase[0], 0.0F, 0.0F, 0.0F };
  r.high = { phase[g.nx - 1], 0.0F, 0.0F, 0.0F };
  if (links_.boundary(0) == Boundary::Periodic)
  {
    r.low = { phase[g.nx - 1], v[g.node(g.nx - 1)], 1.0F, falls ? 1.0F : 0.0F };
    r.high = { phase[0], v[0], 1.0F, falls ? -1.0F : 0.0F };
  }
  else if (links_.boundary(0) == Boundary::Fixed)
  {
    r.low = { phase[0], 0.0F, 2.0F, falls ? 0.5F : 0.0F };
    r.high = { phase[g.nx - 1], 0.0F, 2.0F, falls ? -0.5F : 0.0F };
  }
  r.source = source_.empty() ? nullptr : source_.data() + g.row(y, z) + g.shift(part, 0);
  return r;
}

void LeanField::addResidual(std::int64_t y, std::int64_t z, int part, float* out) const
{
  phaseKernels().addResidual(table_, row(y, z, part), out);
}

float* LeanField::halfRow(std::int64_t y, std::int64_t z, int part) noexcept
{
  return v_.data() + level_.grid.row(y, z) + level_.grid.shift(part, 0);
}

void LeanField::exchange()
{
  level_.halo.exchange(v_.data() + Grid::lead, static_cast<std::size_t>(level_.grid.stride) * sizeof(float));
}

void LeanField::relax(int sweeps, bool forward)
{
  for (int half = 0; half < 2 * sweeps; ++half)
  {
    const int colour = (half % 2 == 0) == forward ? 0 : 1;
    forEachRow(
      [&](std::int64_t y, std::int64_t z, std::size_t)
      {
        const int part = static_cast<int>((y + z + colour) & 1);
        phaseKernels().relax(table_, row(y, z, part), halfRow(y, z, part));
      });
    exchange();
  }
}

namespace
{

// f(row of blocks along y, along z)
template <class F>
void forEachBlockRow(const Grid& blocks, int threads, F&& f)
{
#pragma omp parallel for num_threads(threads) if (threads > 1) schedule(static)
  for (std::int64_t i = 0; i < blocks.ny * blocks.nz; ++i)
    f(i % blocks.ny, i / blocks.ny);
}

} // namespace

int LeanField::threads() const noexcept
{
  return block_.count() < threadedNodes ? 1 : std::max(1, problem_.options.threads);
}

void LeanField::restrictTo(Level& coarse) const
{
  const Grid& g = level_.grid;
  const Grid& c = coarse.grid;
  forEachBlockRow(c, threads(),
    [&](std::int64_t cy, std::int64_t cz)
    {
      std::vector<float> natural(static_cast<std::size_t>(c.nx + 1), 0.0F);
      for (std::int64_t z = 2 * cz; z < std::min(2 * cz + 2, g.nz); ++z)
        for (std::int64_t y = 2 * cy; y < std::min(2 * cy + 2, g.ny); ++y) // the other colour was relaxed last
          addResidual(y, z, static_cast<int>((y + z) & 1), natural.data());
      kernels().split(c.nx, c.half, natural.data(), coarse.f.data() + c.row(cy, cz));
    });
}

void LeanField::addFrom(const Level& coarse)
{
  const Grid& g = level_.grid;
  const Grid& c = coarse.grid;
  forEachBlockRow(c, threads(),
    [&](std::int64_t cy, std::int64_t cz)
    {
      std::vector<float> natural(static_cast<std::size_t>(c.nx));
      kernels().merge(c.nx, c.half, coarse.u.data() + c.row(cy, cz), natural.data());
      for (std::int64_t z = 2 * cz; z < std::min(2 * cz + 2, g.nz); ++z)
        for (std::int64_t y = 2 * cy; y < std::min(2 * cy + 2, g.ny); ++y)
        {
          float* v = v_.data() + g.row(y, z);
          phaseKernels().addToBoth(g.even, g.odd, natural.data(), v, v + g.half);
        }
    });
  exchange();
}

void LeanField::linkRow(int d, std::int64_t y, std::int64_t z, float* out) const
{
  const Grid& g = level_.grid;
  const std::uint8_t* here = phases_(y, z);
  const auto wall = [&](std::uint8_t id) { return static_cast<float>(links_.wall(id, d)); };
  const bool fixed = links_.boundary(d) == Boundary::Fixed;
  if (d == 0)
  {
    phaseKernels().links(table_, 0, g.nx - 1, here, here + 1, out + 1);
    const bool wraps = links_.boundary(0) == Boundary::Periodic;
    out[0] = wraps ? static_cast<float>(links_.mean(here[g.nx - 1], here[0], 0)) : fixed ? wall(here[0]) : 0.0F;
    out[g.nx] = wraps ? out[0] : fixed ? wall(here[g.nx - 1]) : 0.0F;
    return;
  }
  out[0] = 0;
  const std::int64_t from = d == 1 ? y : z;
  const std::int64_t rows = d == 1 ? g.ny : g.nz;
  const bool below = from < 0;
  if ((from >= 0 && from < rows - 1) || level_.halo.inside(d, below ? -1 : 1))
  {
    phaseKernels().links(table_, d, g.nx, here, d == 1 ? phases_(y + 1, z) : phases_(y, z + 1), out + 1);
    if (const auto factor = static_cast<float>(links_.factor(d)); factor != 1.0F)
      for (std::int64_t x = 0; x < g.nx; ++x)
        out[x + 1] *= factor;
  }
  else
    for (std::int64_t x = 0; x < g.nx; ++x) // beyond the box: the wall of the node next to it
      out[x + 1] = !fixed ? 0.0F : wall((below ? (d == 1 ? phases_(0, z) : phases_(y, 0)) : here)[x]);
}

void LeanField::countConductance()
{
  const Grid& g = level_.grid;
  const int axis = problem_.axis;
  const std::int64_t n = problem_.lattice.size[static_cast<std::size_t>(axis)];
  const bool periodic = links_.boundary(axis) == Boundary::Periodic;
  const std::size_t planes = static_cast<std::size_t>(periodic ? n : n + 1);
  std::vector<std::vector<double>> parts(tiles(), std::vector<double>(planes, 0.0));
  forEachRow(
    [&](std::int64_t y, std::int64_t z, std::size_t tile)
    {
      double* sum = parts[tile].data();
      const std::uint8_t* here = phases_(y, z);
      if (axis == 0)
      {
        for (std::int64_t x = 0; x + 1 < g.nx; ++x)
          sum[x + 1] += links_.mean(here[x], here[x + 1], 0);
        if (periodic)
          sum[0] += links_.mean(here[g.nx - 1], here[0], 0);
        else
        {
          sum[0] += links_.wall(here[0], axis);
          sum[n] += links_.wall(here[g.nx - 1], axis);
        }
        return;
      }
      const std::int64_t p = along(y, z);
      const auto total = [&](auto&& link)
      {
        double s = 0;
        for (std::int64_t x = 0; x < g.nx; ++x)
          s += link(x);
        return s;
      };
      if (p < n - 1 || periodic)
      {
        const std::uint8_t* there = axis == 1 ? phases_(y + 1, z) : phases_(y, z + 1);
        sum[p == n - 1 ? 0 : p + 1] +=
          total([&](std::int64_t x) { return links_.factor(axis) * links_.mean(here[x], there[x], axis); });
      }
      for (const std::int64_t face : { std::int64_t{ 0 }, n - 1 })
        if (!periodic && p == face)
          sum[face == 0 && p == 0 ? 0 : n] += total([&](std::int64_t x) { return links_.wall(here[x], axis); });
      if (!periodic && n == 1)
        sum[1] = sum[0];
    });
  conductance_.assign(planes, 0.0);
  for (const auto& part : parts)
    for (std::size_t i = 0; i < planes; ++i)
      conductance_[i] += part[i];
  problem_.comm.sum(conductance_);
}

FieldSums LeanField::sums(PlaneSums& planes) const
{
  const Grid& g = level_.grid;
  const int axis = problem_.axis;
  const std::int64_t n = problem_.lattice.size[static_cast<std::size_t>(axis)];
  const bool periodic = links_.boundary(axis) == Boundary::Periodic;
  struct Tile
  {
    PhaseSums sums;
    std::vector<double> even, odd, planes; // Σ g Δ: by node along x, or by plane across
  };
  std::vector<Tile> parts(tiles());
  forEachRow(
    [&](std::int64_t y, std::int64_t z, std::size_t t)
    {
      Tile& tile = parts[t];
      if (tile.planes.empty())
      {
        tile.planes.assign(static_cast<std::size_t>(n + 1), 0.0);
        tile.even.assign(static_cast<std::size_t>(axis == 0 ? g.even : 0), 0.0);
        tile.odd.assign(static_cast<std::size_t>(axis == 0 ? g.odd : 0), 0.0);
      }
      const PhaseSums before = tile.sums;
      for (const int part : { 0, 1 })
        if (g.count(part) > 0)
          phaseKernels().addSums(
            table_, row(y, z, part), tile.sums, axis != 0 ? nullptr : (part == 0 ? tile.even : tile.odd).data());
      if (axis == 0)
        return;
      const auto p = static_cast<std::size_t>(along(y, z));
      tile.planes[p + 1] += tile.sums.flux[axis] - before.flux[axis] + tile.sums.high - before.high;
      tile.planes[0] += tile.sums.low - before.low;
    });
  FieldSums s;
  planes = PlaneSums(conductance_.size());
  planes.conductance = conductance_;
  std::vector<double> flux(static_cast<std::size_t>(n + 1), 0.0);
  double low = 0;
  double high = 0;
  for (const Tile& tile : parts)
  {
    s.energy += tile.sums.energy;
    low += tile.sums.low;
    high += tile.sums.high;
    for (std::size_t a = 0; a < 3; ++a)
      s.flux[a] += tile.sums.flux[a];
    for (std::size_t i = 0; i < tile.planes.size(); ++i)
      flux[i] += tile.planes[i];
    for (std::size_t i = 0; i < tile.even.size(); ++i)
      flux[2 * i + 1] += tile.even[i];
    for (std::size_t i = 0; i < tile.odd.size(); ++i)
      flux[2 * i + 2] += tile.odd[i];
  }
  if (axis == 0)
  {
    flux[0] += low;
    flux[static_cast<std::size_t>(n)] += high;
  }
  // in one go
  flux.insert(flux.end(), { s.energy, low, high, s.flux[0], s.flux[1], s.flux[2] });
  problem_.comm.sum(flux);
  const double* const all = flux.data() + n + 1;
  if (periodic)
    flux[0] += flux[static_cast<std::size_t>(n)];
  // from drops of the profile to drops over the whole box
  const double unit = 1.0 / static_cast<double>(n);
  for (std::size_t i = 0; i < planes.flux.size(); ++i)
    planes.flux[i] = unit * flux[i];
  s.energy = unit * unit * all[0];
  s.inlet = unit * all[1];
  s.outlet = unit * all[2];
  for (std::size_t a = 0; a < 3; ++a)
    s.flux[a] = unit * all[3 + a];
  return s;
}

double LeanField::roundOff() const
{
  const Grid& g = level_.grid;
  std::vector<double> parts(tiles(), 0.0);
  forEachRow(
    [&](std::int64_t y, std::int64_t z, std::size_t tile)
    {
      const std::uint8_t* phase = phases_(y, z);
      const float* v = v_.data() + g.row(y, z);
      for (std::int64_t x = 0; x < g.nx; ++x)
      {
        const auto value = static_cast<double>(v[g.node(x)]);
        parts[tile] += links_.diffusivity(phase[x]) * value * value;
      }
    });
  // the variance of an even error within a unit in the last place, for each of a node's links
  constexpr double lastPlace = std::numeric_limits<float>::epsilon();
  const double unit = 1.0 / static_cast<double>(problem_.lattice.size[static_cast<std::size_t>(problem_.axis)]);
  const double total = problem_.comm.sum(std::accumulate(parts.begin(), parts.end(), 0.0));
  const double around =
    2.0 * (links_.factor(0) + links_.factor(1) + (problem_.lattice.dimension == 3 ? links_.factor(2) : 0));
  return around * lastPlace * lastPlace / 12.0 * unit * unit * total;
}

void LeanField::apply(const PlaneBalance& balance)
{
  const Grid& g = level_.grid;
  const int axis = problem_.axis;
  const double n = static_cast<double>(problem_.lattice.size[static_cast<std::size_t>(axis)]);
  const bool periodic = links_.boundary(axis) == Boundary::Periodic;
  std::vector<double> shift;
  for (std::size_t p = 0; p < balance.shift.size(); ++p)
    shift.push_back(
      n * balance.shift[p] + (periodic ? 0.0 : (balance.factor - 1) * (n - static_cast<double>(p) - 0.5)));
  forEachRow(
    [&](std::int64_t y, std::int64_t z, std::size_t)
    {
      float* v = v_.data() + g.row(y, z);
      for (const int part : { 0, 1 })
        for (std::int64_t i = 0; i < g.count(part); ++i)
        {
          const std::int64_t p = axis == 0 ? 2 * i + part : along(y, z);
          float& value = v[g.shift(part, 0) + i];
          value = static_cast<float>(balance.factor * static_cast<double>(value) + shift[static_cast<std::size_t>(p)]);
        }
    });
  exchange();
}

void LeanField::startCorrection()
{
  source_.assign(v_.size(), 0.0F);
  std::fill(v_.begin(), v_.end(), 0.0F);
}

void LeanField::setResidual(std::int64_t y, std::int64_t z, const double* residual)
{
  const Grid& g = level_.grid;
  float* out = source_.data() + g.row(y, z);
  for (std::int64_t x = 0; x < g.nx; ++x)
    out[g.node(x)] = static_cast<float>(residual[x]);
}

void LeanField::addRow(std::int64_t y, std::int64_t z, double unit, double* u) const
{
  const Grid& g = level_.grid;
  const float* v = v_.data() + g.row(y, z);
  for (std::int64_t x = 0; x < g.nx; ++x)
    u[x] += unit * static_cast<double>(v[g.node(x)]);
}

double LeanField::mean() const
{
  if (links_.boundary(problem_.axis) != Boundary::Periodic)
    return 0;
  const Grid& g = level_.grid;
  double sum = 0;
  for (std::int64_t z = 0; z < g.nz; ++z)
    for (std::int64_t y = 0; y < g.ny; ++y)
      for (std::int64_t x = 0; x < g.nx; ++x)
        sum += static_cast<double>(v_[static_cast<std::size_t>(g.row(y, z) + g.node(x))]);
  return problem_.comm.sum(sum) / static_cast<double>(problem_.lattice.count());
}

void LeanField::value(std::span<double> out, Layers layers, double mean) const
{
  const Grid& g = level_.grid;
  const int axis = problem_.axis;
  const double unit = 1.0 / static_cast<double>(problem_.lattice.size[static_cast<std::size_t>(axis)]);
  std::size_t i = 0;
  for (std::int64_t z = layers.first; z < layers.last; ++z)
    for (std::int64_t y = 0; y < g.ny; ++y)
      for (std::int64_t x = 0; x < g.nx; ++x, ++i)
      {
        const double v = static_cast<double>(v_[static_cast<std::size_t>(g.row(y, z) + g.node(x))]);
        out[i] = 1.0 + unit * (v - mean - (static_cast<double>(axis == 0 ? x : along(y, z)) + 0.5));
      }
}

void LeanField::plane(std::int64_t z, double* out) const
{
  const Grid& g = level_.grid;
  const int axis = problem_.axis;
  const double unit = 1.0 / static_cast<double>(problem_.lattice.size[static_cast<std::size_t>(axis)]);
  const bool profile = links_.boundary(axis) != Boundary::Periodic;
  for (std::int64_t y = -1; y <= g.ny; ++y, out += g.nx + 2)
  {
    const float* const v = v_.data() + g.row(y, z);
    const auto at = [&](std::int64_t p) { return profile ? 1.0 - unit * (static_cast<double>(p) + 0.5) : 0.0; };
    const double across = axis == 0 ? 0.0 : at(along(y, z));
    for (const int part : { 0, 1 })
      for (std::int64_t i = 0; i < g.count(part); ++i)
      {
        const std::int64_t x = 2 * i + part;
        out[x + 1] = (axis == 0 ? at(x) : across) + unit * static_cast<double>(v[g.shift(part, 0) + i]);
      }
    out[0] = out[g.nx];
    out[g.nx + 1] = out[1];
  }
}

// Half of what the links on either side of a node carry.
void LeanField::flux(std::span<double> out, Layers layers) const
{
  const Grid& g = level_.grid;
  const int axis = problem_.axis;
  const double n = static_cast<double>(problem_.lattice.size[static_cast<std::size_t>(axis)]);
  std::array<double, 3> unit = fluxUnits(links_, problem_.lattice);
  for (double& u : unit)
    u *= 0.5 / n;
  const std::array<std::int64_t, 3> size{ g.nx, g.ny, g.nz };
  const std::int64_t rows = g.ny * (layers.last - layers.first);
  const int threads = this->threads();
  std::fill(out.begin(), out.end(), 0.0);
#pragma omp parallel for num_threads(threads) if (threads > 1) schedule(static)
  for (std::int64_t r = 0; r < rows; ++r)
  {
    const std::int64_t y = r % g.ny;
    const std::int64_t z = r / g.ny + layers.first;
    const std::uint8_t* here = phases_(y, z);
    const float* v = v_.data() + g.row(y, z);
    double* to = out.data() + 3 * g.nx * r;
    for (std::size_t a = 0; a < (problem_.lattice.dimension == 3 ? 3U : 2U); ++a)
      for (const int step : { -1, 1 })
      {
        const int d = static_cast<int>(a);
        const std::array<std::int64_t, 3> q{ 0, y + (a == 1 ? step : 0), z + (a == 2 ? step : 0) };
        const double fall = d == axis ? step : 0.0;
        const bool inner = a == 0 || (q[a] >= 0 && q[a] < size[a]) || level_.halo.inside(d, step);
        const std::uint8_t* there = inner && a > 0 ? phases_(q[1], q[2]) : here;
        const float* w = inner && a > 0 ? v_.data() + g.row(q[1], q[2]) : v;
        const double factor = unit[a] * links_.factor(d) * step;
        for (std::int64_t x = 0; x < g.nx; ++x)
        {
          std::int64_t other = a == 0 ? x + step : x;
          const bool wraps = other < 0 || other >= g.nx;
          const double own = static_cast<double>(v[g.node(x)]);
          if (inner && (!wraps || links_.boundary(0) == Boundary::Periodic))
          {
            other = wraps ? (other + g.nx) % g.nx : other;
            to[3 * x + d] +=
              factor * links_.mean(here[x], there[other], d) * (own - static_cast<double>(w[g.node(other)]) + fall);
          }
          else if (links_.boundary(d) == Boundary::Fixed) // half a drop away
            to[3 * x + d] += unit[a] * step * links_.wall(here[x], d) * (own + 0.5 * fall);
        }
      }
  }
}

std::vector<double> LeanField::linkEnergies() const
{
  const Grid& g = level_.grid;
  const std::size_t ids = problem_.diffusivity.size();
  const std::size_t sums = table_.two ? 3 : links_.tables() * ids * ids;
  const std::int64_t rows = g.ny * g.nz;
  const std::int64_t parts = std::clamp<std::int64_t>(rows, 1, sumParts);
  std::vector<double> byPart(static_cast<std::size_t>(parts) * sums, 0.0);
  const int threads = this->threads();
#pragma omp parallel for num_threads(threads) if (threads > 1) schedule(static)
  for (std::int64_t part = 0; part < parts; ++part)
    for (std::int64_t i = part * rows / parts; i < (part + 1) * rows / parts; ++i)
      for (const int half : { 0, 1 })
        if (g.count(half) > 0)
          phaseKernels().addEnergies(
            table_, row(i % g.ny, i / g.ny, half), ids, byPart.data() + static_cast<std::size_t>(part) * sums);
  std::vector<double> all(links_.tables() * ids * ids, 0.0);
  for (std::size_t i = 0; i < byPart.size(); ++i)
  {
    const std::size_t pair = i % sums;
    std::size_t table = pair / (ids * ids);
    std::size_t a = pair / ids % ids;
    std::size_t b = pair % ids;
    if (table_.two)
    {
      table = 0;
      a = pair == 2 ? ids_.back() : ids_.front();
      b = pair == 0 ? ids_.front() : ids_.back();
    }
    all[(table * ids + std::min(a, b)) * ids + std::max(a, b)] += byPart[i];
  }
  problem_.comm.sum(all);
  return all;
}

} // namespace lamella::lbm
