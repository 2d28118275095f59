#include "generators/Selection.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>

namespace lamella::generators
{
namespace
{

/// The bits of a float that is not negative sort as the float does.
std::uint32_t rank(float key)
{
  return std::bit_cast<std::uint32_t>(key + 0.0F); // −0 becomes +0
}

/// The bin in which the `count`-th entry of a histogram falls; `count` is left as its place within that bin.
std::uint32_t binOf(const std::vector<std::int64_t>& histogram, std::int64_t& count)
{
  std::uint32_t bin = 0;
  while (count > histogram[bin])
    count -= histogram[bin++];
  return bin;
}

} // namespace

std::vector<std::uint8_t> markSmallest(std::span<const float> keys, std::int64_t count)
{
  std::vector<std::uint8_t> marked(keys.size(), 0);
  if (count <= 0)
    return marked;
  // The count-th smallest key in two passes: its upper 16 bits, then its lower ones.
  std::vector<std::int64_t> histogram(65536, 0);
  for (const float key : keys)
    ++histogram[rank(key) >> 16];
  const std::uint32_t high = binOf(histogram, count);
  histogram.assign(65536, 0);
  for (const float key : keys)
  {
    const std::uint32_t bits = rank(key);
    histogram[bits & 0xffffU] += bits >> 16 == high;
  }
  const std::uint32_t low = binOf(histogram, count);
  const std::uint32_t limit = high << 16 | low;

  for (std::size_t node = 0; node < keys.size(); ++node)
  {
    const std::uint32_t bits = rank(keys[node]);
    if (bits < limit)
    {
      marked[node] = 1;
    }
    else if (bits == limit && count > 0)
    {
      marked[node] = 1;
      --count;
    }
  }
  return marked;
}

std::int64_t closeWalls(std::span<float> key, std::span<const std::int32_t> cell, std::int64_t nx, std::int64_t ny)
{
  std::int64_t closed = 0;
  for (std::int64_t y = 0; y < ny; ++y)
  {
    const std::int64_t up = y + 1 < ny ? nx : 0;
    for (std::int64_t x = 0; x < nx; ++x)
    {
      const std::int64_t right = x + 1 < nx ? 1 : 0;
      const std::int64_t node = x + nx * y;
      const auto at = [&](std::int64_t n) { return cell[static_cast<std::size_t>(n)]; };
      if (at(node + right) != at(node) || at(node + up) != at(node) || at(node + up + right) != at(node))
      {
        key[static_cast<std::size_t>(node)] = 0;
        ++closed;
      }
    }
  }
  return closed;
}

std::int64_t solidNodes(double solidFraction, double spacing, std::int64_t nodes, std::int64_t closed)
{
  const auto all = static_cast<double>(nodes);
  const std::int64_t solid = std::llround(solidFraction * all);
  if (closed > solid)
  {
    throw ParameterError(
      fmt::format(
        "a solid fraction of {} is too little for closed walls on this lattice: walls one node thick make {:.3f}",
        solidFraction, static_cast<double>(closed) / all),
      fmt::format("take a spacing of {:.2g} m or less, or larger cells",
        spacing * 0.9 * solidFraction * all / static_cast<double>(closed)));
  }
  return solid;
}

} // namespace lamella::generators
