#include "lattice/Subsample.h"

#include <algorithm>
#include <cassert>

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
    result.lattice.origin[axis] += from.spacing * static_cast<double>(first[axis]);
  }
  result.lattice.spacing = from.spacing * stride;
  result.phase.reserve(static_cast<std::size_t>(result.lattice.count()));
  for (std::int64_t z = first[2]; z < from.size[2]; z += stride)
  {
    for (std::int64_t y = first[1]; y < from.size[1]; y += stride)
    {
      for (std::int64_t x = first[0]; x < from.size[0]; x += stride)
      {
        result.phase.push_back(image.phase[static_cast<std::size_t>(from.index(x, y, z))]);
      }
    }
  }
  return result;
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
      {
        if ((x + 3 * y + 5 * z) % every == 0) // planes that cross all axes
        {
          starts.push_back({ x, y, z });
        }
      }
    }
  }
  return starts;
}

} // namespace lamella
