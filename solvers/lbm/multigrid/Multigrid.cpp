#include "lbm/multigrid/Multigrid.h"

#include <algorithm>
#include <utility>

namespace lamella::lbm
{
namespace
{

// Factors of more would take longer than another level: in space bands are wide.
constexpr std::int64_t coarsestPixels = 600;
constexpr std::int64_t coarsestVoxels = 150;
constexpr std::int64_t gatherNodes = 4096;
// Below that many nodes of a rank waiting for another thread costs more than its work.
constexpr std::int64_t threadedNodes = 100000;

} // namespace

void Level::allocateLinks(int count)
{
  links.assign(static_cast<std::size_t>(count), FloatArray(grid.floats(), 0.0F));
}

void Level::wrapRow(float* row) const noexcept
{
  // nodes nx and -1
  row[grid.node(grid.nx)] = row[0];
  row[grid.half - 1] = row[grid.node(grid.nx - 1)];
}

void Level::exchange(FloatArray& v) const
{
  if (periodic[0])
    for (std::int64_t z = 0; z < grid.nz; ++z)
      for (std::int64_t y = 0; y < grid.ny; ++y)
        wrapRow(v.data() + grid.row(y, z));
  halo.exchange(v.data() + Grid::lead, static_cast<std::size_t>(grid.stride) * sizeof(float));
}

bool canHalve(const std::array<std::int64_t, 3>& size, const std::array<bool, 3>& periodic)
{
  if (size[0] * size[1] * size[2] <= (size[2] > 1 ? coarsestVoxels : coarsestPixels))
    return false;
  for (int a = 0; a < 3; ++a)
    if (periodic[a] && size[a] < 3)
      return false;
  return true;
}

Multigrid::Multigrid(Level finest, int threads, Coarsening coarsening)
  : coarsening_(coarsening)
  , sweeps_(coarsening == Coarsening::Blocks ? 3 : 1)
  , threads_(std::max(1, threads))
{
  levels_.push_back(std::make_unique<Level>(std::move(finest)));
  Level& top = *levels_.front();
  top.halo = Halo(top.grid.dimension, { top.grid.nx, top.grid.ny, top.grid.nz }, *top.parts, *top.comm, top.periodic);
  build();
}

void Multigrid::build()
{
  int distributedLeft = levels_.front()->parts->levels() - levels_.front()->halvings;
  for (;;)
  {
    Level& level = *levels_.back();
    const bool parallel = level.comm->parallel();
    const bool more = canHalve(level.size, level.periodic);
    const bool small = level.depth > 0 && level.size[0] * level.size[1] * level.size[2] <= gatherNodes;
    if (parallel && more && !small && distributedLeft == 0)
      if (auto next = move(level))
      {
        distributedLeft = next->parts->levels();
        levels_.push_back(std::move(next));
        continue;
      }
    if (parallel && (!more || small || distributedLeft == 0))
    {
      level.gathered = true;
      levels_.push_back(gather(level));
      continue;
    }
    if (!more)
      break;
    levels_.push_back(coarsen(level));
    --distributedLeft;
  }
  factorize(*levels_.back());
}

int Multigrid::threadsOn(const Level& level) const noexcept
{
  return level.grid.nx * level.grid.ny * level.grid.nz < threadedNodes ? 1 : threads_;
}

std::uint64_t Multigrid::bytes() const
{
  std::uint64_t total = 0;
  for (const auto& level : levels_)
  {
    for (const auto& a : level->links)
      total += a.size() * sizeof(float);
    for (const auto& a : level->residual)
      total += a.size() * sizeof(float);
    total += (level->inverse.size() + level->u.size() + level->f.size()) * sizeof(float);
    total += level->weights.size() * sizeof(std::uint16_t);
  }
  return total;
}

void Multigrid::apply(const FloatArray& r, FloatArray& z)
{
  cycle(0, r, z, true);
}

void Multigrid::cycle(std::size_t index, const FloatArray& f, FloatArray& u, bool fromZero)
{
  Level& level = *levels_[index];
  if (index + 1 == levels_.size())
  {
    solveDirectly(level, f, u);
    return;
  }
  Level& next = *levels_[index + 1];
  if (level.gathered)
  {
    gatherVector(level, f, next, next.f);
    cycle(index + 1, next.f, next.u, fromZero);
    scatterVector(next, next.u, level, u);
    return;
  }
  if (level.moved)
  {
    const auto rowLength = static_cast<std::size_t>(level.grid.stride);
    level.moved->forward(f.data() + Grid::lead, next.f.data() + Grid::lead, rowLength);
    cycle(index + 1, next.f, next.u, fromZero);
    level.moved->backward(next.u.data() + Grid::lead, u.data() + Grid::lead, rowLength);
    level.exchange(u);
    return;
  }
  const int threads = threadsOn(level);
  // all but the last sweep before and the first after
  const auto relaxMore = [&](bool forward, bool zero)
  {
    for (int sweep = 1; sweep < sweeps_; ++sweep)
      relax(level, f, u, forward, zero && sweep == 1, threads);
  };
  // in 3D all is done plane by plane in one pass, where that is possible
  const bool byPlanes = level.grid.dimension == 3 && LayerSweep::possible(level, threads);
  relaxMore(true, fromZero);
  fromZero = fromZero && sweeps_ == 1;
  if (byPlanes)
  {
    LayerSweep sweep(level, f, u, true, fromZero);
    restrictResidual(level, f, u, next, [&](std::int64_t z) { sweep.finish(z); });
  }
  else
  {
    relax(level, f, u, true, fromZero, threads);
    restrictResidual(level, f, u, next, LayerHook());
  }
  cycle(index + 1, next.f, next.u, true);
  // in 3D the second visits begin a level further down: the first coarse level is four fifths of their cost
  const bool again = level.grid.dimension == 2 || level.depth > 0;
  for (int visit = 1; again && visit < visits_ && index + 2 < levels_.size(); ++visit)
    cycle(index + 1, next.f, next.u, false);
  if (byPlanes)
  {
    std::vector<char> done(static_cast<std::size_t>(next.grid.nz), 0);
    const auto interpolate = [&](std::int64_t z)
    {
      if (std::exchange(done[static_cast<std::size_t>(z / 2)], 1) == 0)
        for (std::int64_t cy = 0; cy < next.grid.ny; ++cy)
          interpolateRow(level, u, next, cy, z / 2);
    };
    LayerSweep(level, f, u, false, false, interpolate).finish(level.grid.nz);
    relaxMore(false, false);
    return;
  }
  interpolateAdd(level, u, next);
  relax(level, f, u, false, false, threads);
  relaxMore(false, false);
}

double Multigrid::advance(const FloatArray& z, float beta, FloatArray& p, FloatArray& q) const
{
  const Level& level = *levels_.front();
  const Grid& g = level.grid;
  const Kernels& k = kernels();
  std::vector<double> sums(static_cast<std::size_t>(g.ny * g.nz));
  const auto update = [&](std::int64_t y, std::int64_t plane)
  {
    float* row = p.data() + g.row(y, plane);
    const float* from = z.data() + g.row(y, plane);
    k.xpby(g.even, from, beta, row);
    k.xpby(g.odd, from + g.half, beta, row + g.half);
    if (level.periodic[0])
      level.wrapRow(row);
  };
  const auto multiply = [&](std::int64_t y, std::int64_t plane)
  { sums[static_cast<std::size_t>(y + g.ny * plane)] = applyRow(level, p, q, y, plane); };
  const auto exchange = [&]
  { level.halo.exchange(p.data() + Grid::lead, static_cast<std::size_t>(g.stride) * sizeof(float)); };

  if (g.dimension == 3 && threads_ == 1 && !touching(level, 1))
  {
    // one pass: the product follows a plane behind
    const bool outside = touching(level, 2);
    const auto early = [&](std::int64_t plane) { return outside && (plane == 0 || plane == g.nz - 1); };
    const auto allRows = [&](std::int64_t plane, const auto& f)
    {
      for (std::int64_t y = 0; y < g.ny; ++y)
        f(y, plane);
    };
    for (std::int64_t plane = 0; plane < g.nz; ++plane)
      if (early(plane))
        allRows(plane, update);
    exchange();
    for (std::int64_t plane = 0; plane <= g.nz; ++plane)
    {
      if (plane < g.nz && !early(plane))
        allRows(plane, update);
      if (plane > 0)
        allRows(plane - 1, multiply);
    }
  }
  else
  {
#pragma omp parallel for num_threads(threads_) if (threads_ > 1) schedule(static)
    for (std::int64_t i = 0; i < g.ny * g.nz; ++i)
      update(i % g.ny, i / g.ny);
    exchange();
#pragma omp parallel for num_threads(threads_) if (threads_ > 1) schedule(static)
    for (std::int64_t i = 0; i < g.ny * g.nz; ++i)
      multiply(i % g.ny, i / g.ny);
  }
  double total = 0;
  for (const double s : sums)
    total += s;
  return total;
}

} // namespace lamella::lbm
