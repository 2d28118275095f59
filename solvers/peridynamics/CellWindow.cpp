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

std::size_t within(const Block& b, std::int64_t x, std::int64_t y, std::int64_t z)
{
  return static_cast<std::size_t>(x - b.start[0] + b.size[0] * (y - b.start[1] + b.size[1] * (z - b.start[2])));
}

Block common(const Block& a, const Block& b)
{
  Block both;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    both.start[axis] = std::max(a.start[axis], b.start[axis]);
    both.size[axis] = std::max<std::int64_t>(
      0, std::min(a.start[axis] + a.size[axis], b.start[axis] + b.size[axis]) - both.start[axis]);
  }
  return both;
}

template <class T>
std::vector<T> collectValues(const Block& slab, std::span<const T> values, const Block& part, const Communicator& comm)
{
  std::vector<double> all(static_cast<std::size_t>(part.count()), 0.0); // whole numbers are exact in it
  forBlock(common(slab, part),
    [&](std::int64_t x, std::int64_t y, std::int64_t z)
    { all[within(part, x, y, z)] = static_cast<double>(values[within(slab, x, y, z)]); });
  comm.sum(all);
  std::vector<T> result(all.size());
  std::transform(all.begin(), all.end(), result.begin(), [](double v) { return static_cast<T>(v); });
  return result;
}

template <class T>
std::vector<T> splitValues(const Lattice& from, const std::vector<T>& values, int n, const Block& slab)
{
  std::vector<T> fine(values.empty() ? 0 : static_cast<std::size_t>(slab.count()));
  if (!fine.empty())
    forBlock(slab,
      [&](std::int64_t x, std::int64_t y, std::int64_t z)
      {
        fine[within(slab, x, y, z)] =
          values[static_cast<std::size_t>(from.index(x / n, y / n, from.dimension == 3 ? z / n : 0))];
      });
  return fine;
}

} // namespace

Block centredPart(const Lattice& lattice, std::int64_t most)
{
  Block part{ { 0, 0, 0 }, lattice.size };
  if (lattice.count() <= most)
    return part;
  const double share =
    std::pow(static_cast<double>(most) / static_cast<double>(lattice.count()), 1.0 / lattice.dimension);
  for (std::size_t a = 0; a < static_cast<std::size_t>(lattice.dimension); ++a)
  {
    const std::int64_t full = lattice.size[a];
    const auto size = static_cast<std::int64_t>(share * static_cast<double>(full));
    const std::int64_t multiple = size >= 64 ? 16 : 2;
    part.size[a] = std::max<std::int64_t>(std::min<std::int64_t>(2, full), size / multiple * multiple);
    part.start[a] = (full - part.size[a]) / 2;
  }
  return part;
}

CellWindow collect(const Lattice& lattice, const Block& slab, std::span<const std::uint8_t> phase,
  std::span<const std::int32_t> grain, const Block& part, const Communicator& comm)
{
  CellWindow window;
  window.lattice = lattice;
  window.lattice.size = part.size;
  for (std::size_t a = 0; a < static_cast<std::size_t>(lattice.dimension); ++a)
    window.lattice.origin[a] += lattice.spacing * static_cast<double>(part.start[a]);
  window.phase = collectValues(slab, phase, part, comm);
  if (comm.any(!grain.empty()))
    window.grain = collectValues(slab, grain, part, comm);
  return window;
}

Lattice split(const Lattice& lattice, int n)
{
  Lattice fine = lattice;
  fine.spacing = lattice.spacing / n;
  for (std::size_t a = 0; a < static_cast<std::size_t>(lattice.dimension); ++a)
  {
    fine.size[a] *= n;
    fine.origin[a] += 0.5 * (fine.spacing - lattice.spacing);
  }
  return fine;
}

CellWindow split(const CellWindow& window, int n, const Block& slab)
{
  return { split(window.lattice, n), splitValues(window.lattice, window.phase, n, slab),
    splitValues(window.lattice, window.grain, n, slab) };
}

} // namespace lamella::peridynamics
