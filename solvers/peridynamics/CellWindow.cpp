#include "peridynamics/CellWindow.h"

#include <algorithm>
#include <cmath>

namespace lamella::peridynamics
{
namespace
{

template <class F>
void forBlock(const Block& b, F&& f)
{
  for (std::int64_t z = b.start[2]; z < b.start[2] + b.size[2]; ++z)
    for (std::int64_t y = b.start[1]; y < b.start[1] + b.size[1]; ++y)
      for (std::int64_t x = b.start[0]; x < b.start[0] + b.size[0]; ++x)
        f(x, y, z);
}

/// For each node of the picture along an axis the one of the sample that it is.
std::vector<std::int64_t> nodesAlong(std::size_t axis, const Lattice& picture, const CellThinning& t)
{
  std::vector<std::int64_t> nodes;
  for (std::int64_t i = 0; i < picture.size[axis]; ++i)
    nodes.push_back(t.pixels.node(axis, i / t.split % t.pixels.size[axis], t.first[axis]) * t.split + i % t.split);
  return nodes;
}

template <class T>
std::vector<T> taken(
  const Block& slab, std::span<const T> values, const Lattice& picture, const CellThinning& t, const Communicator& comm)
{
  std::array<std::vector<std::int64_t>, 3> from;
  for (std::size_t a = 0; a < 3; ++a)
    from[a] =
      a < static_cast<std::size_t>(picture.dimension) ? nodesAlong(a, picture, t) : std::vector<std::int64_t>{ 0 };
  std::vector<double> all(comm.parallel() ? static_cast<std::size_t>(picture.count()) : 0, 0.0);
  std::vector<T> result(static_cast<std::size_t>(picture.count()));
  const auto within = [&](std::size_t a, std::int64_t i)
  { return i >= slab.start[a] && i < slab.start[a] + slab.size[a]; };
  std::size_t to = 0;
  for (const std::int64_t z : from[2])
    for (const std::int64_t y : from[1])
      for (const std::int64_t x : from[0])
      {
        if (within(0, x) && within(1, y) && within(2, z))
        {
          const T value = values[static_cast<std::size_t>(
            x - slab.start[0] + slab.size[0] * (y - slab.start[1] + slab.size[1] * (z - slab.start[2])))];
          result[to] = value;
          if (comm.parallel())
            all[to] = static_cast<double>(value); // whole numbers are exact in it
        }
        ++to;
      }
  if (comm.parallel())
  {
    comm.sum(all);
    std::transform(all.begin(), all.end(), result.begin(), [](double v) { return static_cast<T>(v); });
  }
  return result;
}

template <class T>
std::vector<T> partOf(const Lattice& lattice, const std::vector<T>& values, const Block& slab)
{
  std::vector<T> part;
  if (values.empty())
    return part;
  part.reserve(static_cast<std::size_t>(slab.count()));
  forBlock(slab,
    [&](std::int64_t x, std::int64_t y, std::int64_t z)
    { part.push_back(values[static_cast<std::size_t>(lattice.index(x, y, z))]); });
  return part;
}

} // namespace

Lattice thinned(const Lattice& lattice, const CellThinning& t)
{
  Lattice result = lattice;
  result.spacing = lattice.spacing * t.pixels.stride;
  for (std::size_t a = 0; a < static_cast<std::size_t>(lattice.dimension); ++a)
    result.size[a] = t.pixels.size[a] * t.split * t.times[a];
  return result;
}

CellWindow thinned(const Lattice& lattice, const Block& slab, std::span<const std::uint8_t> phase,
  std::span<const std::int32_t> grain, const CellThinning& thinning, const Communicator& comm)
{
  CellWindow window;
  window.lattice = thinned(lattice, thinning);
  window.phase = taken(slab, phase, window.lattice, thinning, comm);
  if (comm.any(!grain.empty()))
    window.grain = taken(slab, grain, window.lattice, thinning, comm);
  return window;
}

CellWindow partOf(const CellWindow& whole, const Block& slab)
{
  return { whole.lattice, partOf(whole.lattice, whole.phase, slab), partOf(whole.lattice, whole.grain, slab) };
}

} // namespace lamella::peridynamics
