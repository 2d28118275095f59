#include "lbm/multigrid/BandCholesky.h"

#include "lbm/multigrid/Kernels.h"

namespace lamella::lbm
{

BandCholesky::BandCholesky(std::int64_t size, std::int64_t width)
  : size_(size)
  , width_(width)
  , band_(static_cast<std::size_t>(size * (width + 1)), 0.0)
{
}

bool BandCholesky::factorize()
{
  return kernels().factorizeBand(size_, width_, band_.data());
}

void BandCholesky::solve(std::span<double> x) const
{
  kernels().solveBand(size_, width_, band_.data(), x.data());
}

} // namespace lamella::lbm
