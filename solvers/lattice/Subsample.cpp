#include "lattice/Subsample.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace lamella
{

PhaseImage subsample(const PhaseImage& image, std::array<std::int64_t, 3> first, int stride)
{
  const Lattice& from = image.lattice;
  PhaseImage result{ from, {}, image.phases };
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    assert(first[axis] >= 0 && first[axis] < from.size[axis]);
    result.lattice.size[axis] = (from.size[axis] - first[axis] + stride - 1) / stride;
    result.lattice.origin[axis] += from.spacingAlong(axis) * static_cast<double>(first[axis]);
  }
  result.lattice.spacing = from.spacing * stride;
  result.phase.reserve(static_cast<std::size_t>(result.lattice.count()));
  for (std::int64_t z = first[2]; z < from.size[2]; z += stride)
  {
    for (std::int64_t y = first[1]; y < from.size[1]; y += stride)
      for (std::int64_t x = first[0]; x < from.size[0]; x += stride)
        result.phase.push_back(image.phase[static_cast<std::size_t>(from.index(x, y, z))]);
  }
  return result;
}

PeriodicThinning periodicThinning(const Lattice& lattice, int stride, std::array<bool, 3> matters)
{
  PeriodicThinning best;
  double least = std::numeric_limits<double>::infinity();
  const auto sizesFor = [&](double q)
  {
    PeriodicThinning t;
    t.from = lattice.size;
    double most = 0; // of the logarithms of the axes' strides
    double lowest = 0;
    double sum = 0;
    int count = 0;
    for (std::size_t a = 0; a < 3; ++a)
    {
      const auto n = static_cast<double>(lattice.size[a]);
      t.size[a] = std::max<std::int64_t>(1, std::llround(n / q));
      if (lattice.size[a] == 1 || !matters[a])
        continue;
      const double own = std::log(n / static_cast<double>(t.size[a]));
      most = count == 0 ? own : std::max(most, own);
      lowest = count == 0 ? own : std::min(lowest, own);
      sum += own;
      ++count;
    }
    t.stride = count == 0 ? stride : std::exp(sum / count);
    constexpr double roundOff = 1e-12;
    if (std::abs(t.stride - stride) < roundOff * stride)
      t.stride = stride;
    // distorted pixels are worse than another stride
    const double bad = 10 * (most - lowest) + std::abs(std::log(t.stride / stride));
    if (bad < least)
    {
      least = bad;
      best = t;
    }
  };
  sizesFor(stride);
  for (const std::int64_t n : lattice.size)
    for (std::int64_t m = n / stride; n > 1 && m <= (n + stride - 1) / stride; ++m)
      if (m > 0)
        sizesFor(static_cast<double>(n) / static_cast<double>(m));
  return best;
}

std::vector<std::array<std::int64_t, 3>> subsampleStarts(const Lattice& lattice, int stride, std::size_t most)
{
  std::array<std::int64_t, 3> ways{};
  std::ranges::transform(lattice.size, ways.begin(), [&](std::int64_t n) { return std::min<std::int64_t>(n, stride); });
  const std::int64_t all = ways[0] * ways[1] * ways[2];
  const std::int64_t every = std::max<std::int64_t>(1, all / static_cast<std::int64_t>(most));
  std::vector<std::array<std::int64_t, 3>> starts;
  for (std::int64_t z = 0; z < ways[2]; ++z)
  {
    for (std::int64_t y = 0; y < ways[1]; ++y)
    {
      for (std::int64_t x = 0; x < ways[0]; ++x)
        if ((x + 3 * y + 5 * z) % every == 0) // planes that cross all axes
          starts.push_back({ x, y, z });
    }
  }
  return starts;
}

} // namespace lamella
