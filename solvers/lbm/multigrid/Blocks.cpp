// Coarse nodes that are blocks of 2 × 2 × 2 nodes: their links, and what goes to and fro between them and their nodes.
#include "lbm/multigrid/Multigrid.h"

#include <algorithm>
#include <array>

namespace lamella::lbm
{
namespace
{

// Of the links between two blocks a coarse link is at least this part.
constexpr float least = 0.5F;

std::array<std::int64_t, 3> sizeOf(const Grid& g)
{
  return { g.nx, g.ny, g.nz };
}

// The links along one direction of all blocks.
class BlockLinks
{
public:
  BlockLinks(const Level& fine, const LinkRow& links, Level& coarse, int d)
    : fine_(fine)
    , links_(links)
    , coarse_(coarse)
    , d_(d)
  {
  }

  // Σ of the links inside each block of a row, along d: what half of lies on the way to either neighbour.
  void inside(std::int64_t cy, std::int64_t cz)
  {
    const std::array<std::int64_t, 3> block{ 0, cy, cz };
    const auto d = static_cast<std::size_t>(d_);
    if (d_ == 0)
      add(block, 0, 1, coarse_.u);
    else if (2 * block[d] + 1 < sizeOf(fine_.grid)[d])
      add(block, 2 * block[d], 0, coarse_.u);
  }

  // The links between the blocks of a row, −1 for the wall below the first, and the next ones along d.
  void between(std::int64_t cy, std::int64_t cz)
  {
    const Grid& c = coarse_.grid;
    const std::array<std::int64_t, 3> block{ 0, cy, cz };
    const auto d = static_cast<std::size_t>(d_);
    FloatArray& across = coarse_.links[d];
    if (d_ == 0)
      add(block, 0, 2, across);
    else
      add(block, block[d] < 0 ? -1 : std::min(2 * block[d] + 1, sizeOf(fine_.grid)[d] - 1), 0, across);
    float* q = across.data() + c.row(cy, cz);
    const float* here = coarse_.u.data() + c.row(cy, cz);
    const float* next = coarse_.u.data() + c.row(cy + (d_ == 1 ? 1 : 0), cz + (d_ == 2 ? 1 : 0));
    for (std::int64_t x = d_ == 0 ? -1 : 0; x < c.nx; ++x)
    {
      float& g = q[c.node(x)];
      if (g > 0)
        g = std::max(least * g, 1 / (half(here[c.node(x)]) + 1 / g + half(next[c.node(d_ == 0 ? x + 1 : x)])));
    }
  }

private:
  static float half(float inside) { return inside > 0 ? 0.5F / inside : 0.0F; }

  // Adds up the links of the rows of a block row. Across x: of both nodes of a pair, at position `from` of d; along x:
  // of one link a block, what = 1: inside, 2: behind it.
  void add(const std::array<std::int64_t, 3>& block, std::int64_t from, int what, FloatArray& out)
  {
    const Grid& g = fine_.grid;
    const Grid& c = coarse_.grid;
    std::vector<float> row(static_cast<std::size_t>(g.nx + 1));
    float* sum = out.data() + c.row(block[1], block[2]);
    for (std::int64_t z = d_ == 2 ? from : 2 * block[2]; z < (d_ == 2 ? from + 1 : std::min(2 * block[2] + 2, g.nz));
         ++z)
      for (std::int64_t y = d_ == 1 ? from : 2 * block[1]; y < (d_ == 1 ? from + 1 : std::min(2 * block[1] + 2, g.ny));
           ++y)
      {
        links_(d_, y, z, row.data());
        const float* at = row.data() + 1;
        if (what == 2)
          sum[c.node(-1)] += at[-1];
        for (std::int64_t x = 0; x < c.nx; ++x)
        {
          const std::int64_t last = std::min(2 * x + 1, g.nx - 1);
          float& s = sum[c.node(x)];
          if (what == 2)
            s += at[last];
          else if (what == 0 || last > 2 * x)
            s += at[2 * x] + (what == 0 && last > 2 * x ? at[last] : 0.0F);
        }
      }
  }

  const Level& fine_;
  const LinkRow& links_;
  Level& coarse_;
  int d_;
};

} // namespace

std::unique_ptr<Level> coarsenBlocks(const Level& fine, const LinkRow& links, int threads)
{
  auto coarse = halved(fine);
  const Grid& c = coarse->grid;
  coarse->straight = true;
  coarse->allocateLinks(c.dimension);
  coarse->u.assign(c.floats(), 0.0F);
  coarse->f.assign(c.floats(), 0.0F);
  for (int d = 0; d < c.dimension; ++d)
  {
    BlockLinks blocks(fine, links, *coarse, d);
    std::fill(coarse->u.begin(), coarse->u.end(), 0.0F);
#pragma omp parallel for num_threads(threads) if (threads > 1) schedule(static)
    for (std::int64_t i = 0; i < c.ny * c.nz; ++i)
      blocks.inside(i % c.ny, i / c.ny);
    coarse->exchange(coarse->u);
#pragma omp parallel for num_threads(threads) if (threads > 1) schedule(static)
    for (std::int64_t i = 0; i < c.ny * c.nz; ++i)
      blocks.between(i % c.ny, i / c.ny);
    // the wall below the first row, or the neighbour's last
    if (d == 1)
      for (std::int64_t z = 0; z < c.nz; ++z)
        blocks.between(-1, z);
    if (d == 2)
      for (std::int64_t y = 0; y < c.ny; ++y)
        blocks.between(y, -1);
    coarse->exchange(coarse->links[static_cast<std::size_t>(d)]);
  }
  std::fill(coarse->u.begin(), coarse->u.end(), 0.0F);
  return coarse;
}

void Multigrid::restrictBlocks(
  const Level& fine, const FloatArray& f, const FloatArray& u, Level& coarse, const LayerHook& finish) const
{
  const Grid& g = fine.grid;
  const Grid& c = coarse.grid;
  const int threads = threadsOn(fine);
  for (std::int64_t cz = 0; cz < c.nz; ++cz)
  {
    if (finish)
      finish(std::min(2 * cz + 2, g.nz));
#pragma omp parallel for num_threads(threads) if (threads > 1) schedule(static)
    for (std::int64_t cy = 0; cy < c.ny; ++cy)
    {
      std::vector<float> residual(static_cast<std::size_t>(g.stride));
      std::vector<float> natural(static_cast<std::size_t>(c.nx), 0.0F);
      for (std::int64_t z = 2 * cz; z < std::min(2 * cz + 2, g.nz); ++z)
        for (std::int64_t y = 2 * cy; y < std::min(2 * cy + 2, g.ny); ++y)
        {
          residualRow(fine, f, u, y, z, residual.data(), true);
          kernels().axpy(g.even, 1.0F, residual.data(), natural.data());
          kernels().axpy(g.odd, 1.0F, residual.data() + g.half, natural.data());
        }
      kernels().split(c.nx, c.half, natural.data(), coarse.f.data() + c.row(cy, cz));
    }
  }
}

void Multigrid::addBlockRow(
  const Level& fine, FloatArray& u, const Level& coarse, std::int64_t cy, std::int64_t cz) const
{
  const Grid& g = fine.grid;
  const Grid& c = coarse.grid;
  std::vector<float> natural(static_cast<std::size_t>(c.nx));
  kernels().merge(c.nx, c.half, coarse.u.data() + c.row(cy, cz), natural.data());
  for (std::int64_t z = 2 * cz; z < std::min(2 * cz + 2, g.nz); ++z)
    for (std::int64_t y = 2 * cy; y < std::min(2 * cy + 2, g.ny); ++y)
    {
      float* row = u.data() + g.row(y, z);
      kernels().axpy(g.even, 1.0F, natural.data(), row);
      kernels().axpy(g.odd, 1.0F, natural.data(), row + g.half);
      if (fine.periodic[0])
        fine.wrapRow(row);
    }
}

} // namespace lamella::lbm
