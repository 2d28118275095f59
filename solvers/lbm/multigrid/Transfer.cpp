// Between levels: restriction of the residual, interpolation of the correction.
#include "lbm/multigrid/Multigrid.h"
#include "lbm/multigrid/WeightLayout.h"

#include <algorithm>

namespace lamella::lbm
{

void Multigrid::restrictResidual(
  Level& fine, const FloatArray& f, const FloatArray& u, Level& coarse, const LayerHook& finish) const
{
  if (coarsening_ == Coarsening::Blocks)
  {
    restrictBlocks(fine, f, u, coarse, finish);
    return;
  }
  const Grid& g = fine.grid;
  const Grid& c = coarse.grid;
  const Kernels& k = kernels();
  const WeightLayout layout(g.dimension, c.nx);
  const std::int64_t lastY = coarse.halo.inside(1, +1) ? c.ny : c.ny - 1;
  const std::int64_t lastZ = coarse.halo.inside(2, +1) ? c.nz : c.nz - 1;
  const std::int64_t planes = static_cast<std::int64_t>(fine.residual.size());
  const auto residualPlane = [&](std::int64_t z) { return fine.residual[static_cast<std::size_t>(z % planes)].data(); };

  std::int64_t ready = 0;
  for (std::int64_t cz = 0; cz <= lastZ; ++cz)
  {
    const std::int64_t upTo = std::min(2 * cz + 1, g.nz - 1);
    for (; ready <= upTo; ++ready)
    {
      if (finish)
        finish(ready + 1);
#pragma omp parallel for num_threads(threads_) if (threads_ > 1) schedule(static)
      for (std::int64_t y = 0; y < g.ny; ++y)
        residualRow(fine, f, u, y, ready, residualPlane(ready) + y * g.stride, true);
    }
#pragma omp parallel for num_threads(threads_) if (threads_ > 1) schedule(static)
    for (std::int64_t cy = 0; cy <= lastY; ++cy)
    {
      std::vector<float> natural(static_cast<std::size_t>(c.nx + 1), 0.0F);
      float* out = natural.data();
      for (int dz = -1; dz <= 1; ++dz)
        for (int dy = -1; dy <= 1; ++dy)
        {
          const std::int64_t y = 2 * cy + dy;
          const std::int64_t z = 2 * cz + dz;
          if (y < 0 || y >= g.ny || z < 0 || z >= g.nz)
            continue;
          const float* r = residualPlane(z) + y * g.stride;
          const std::int64_t cell = coarse.halo.row(cy - (dy < 0 ? 1 : 0), cz - (dz < 0 ? 1 : 0));
          const int kind = (dy != 0 ? 2 : 0) + (dz != 0 ? 4 : 0);
          const int corner = (dy < 0 ? 2 : 0) + (dz < 0 ? 4 : 0);
          if (kind == 0)
            k.axpy(g.even, 1.0F, r, out);
          else
            k.addWeighted(g.even, out, layout.at(fine.weights.data(), cell, kind, corner), r);
          k.addWeighted(g.odd, out, layout.at(fine.weights.data(), cell, kind + 1, corner), r + g.half);
          k.addWeighted(g.odd, out + 1, layout.at(fine.weights.data(), cell, kind + 1, corner + 1), r + g.half);
        }
      if (fine.periodic[0])
        out[0] += out[c.nx];
      k.split(c.nx, c.half, out, coarse.f.data() + c.row(cy, cz));
    }
  }
  coarse.halo.addHighGhosts(coarse.f.data() + Grid::lead, static_cast<std::size_t>(c.stride));
}

void Multigrid::interpolateRow(
  const Level& fine, FloatArray& u, const Level& coarse, std::int64_t cy, std::int64_t cz) const
{
  if (coarsening_ == Coarsening::Blocks)
  {
    addBlockRow(fine, u, coarse, cy, cz);
    return;
  }
  const Grid& g = fine.grid;
  const Grid& c = coarse.grid;
  const Kernels& k = kernels();
  const WeightLayout layout(g.dimension, c.nx);
  const int layers = g.dimension == 3 ? 2 : 1;
  // the four (two) coarse rows around this row of cells, in natural order, one ghost at the end
  std::vector<float> natural(static_cast<std::size_t>(4 * (c.nx + 1)));
  const auto coarseRow = [&](int by, int bz) { return natural.data() + (by + 2 * bz) * (c.nx + 1); };
  for (int bz = 0; bz < layers; ++bz)
    for (int by = 0; by < 2; ++by)
    {
      const float* source = coarse.u.data() + c.row(cy + by, cz + bz);
      k.merge(c.nx, c.half, source, coarseRow(by, bz));
      coarseRow(by, bz)[c.nx] = fine.periodic[0] ? source[0] : 0.0F;
    }
  for (int bz = 0; bz < layers; ++bz)
    for (int by = 0; by < 2; ++by)
    {
      const std::int64_t y = 2 * cy + by;
      const std::int64_t z = 2 * cz + bz;
      if (y >= g.ny || z >= g.nz)
        continue;
      float* row = u.data() + g.row(y, z);
      const std::int64_t cell = coarse.halo.row(cy, cz);
      const int kind = 2 * by + 4 * bz;
      for (int corner = 0; corner < 8; ++corner)
      {
        if ((corner & ~(kind | 1)) != 0)
          continue;
        const float* value = coarseRow((corner >> 1) & 1, (corner >> 2) & 1);
        if ((corner & 1) == 0)
        {
          if (kind == 0)
            k.axpy(g.even, 1.0F, value, row);
          else
            k.addWeighted(g.even, row, layout.at(fine.weights.data(), cell, kind, corner), value);
        }
        k.addWeighted(
          g.odd, row + g.half, layout.at(fine.weights.data(), cell, kind + 1, corner), value + (corner & 1));
      }
      if (fine.periodic[0])
        fine.wrapRow(row);
    }
}

void Multigrid::interpolateAdd(const Level& fine, FloatArray& u, const Level& coarse) const
{
  const Grid& c = coarse.grid;
  const int threads = threadsOn(fine);
#pragma omp parallel for num_threads(threads) if (threads > 1) schedule(static)
  for (std::int64_t i = 0; i < c.ny * c.nz; ++i)
    interpolateRow(fine, u, coarse, i % c.ny, i / c.ny);
  fine.halo.exchange(u.data() + Grid::lead, static_cast<std::size_t>(fine.grid.stride) * sizeof(float));
}

} // namespace lamella::lbm
