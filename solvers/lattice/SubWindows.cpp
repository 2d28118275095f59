#include "lattice/SubWindows.h"

#include <algorithm>

namespace lamella
{

SubWindows subWindows(const Lattice& lattice, int parts)
{
  constexpr std::int64_t fewest = 4;
  SubWindows result;
  for (std::size_t a = 0; a < 3; ++a)
    result.counts[a] = lattice.size[a] >= fewest * parts ? static_cast<std::size_t>(parts) : 1;
  const auto edge = [&](std::size_t axis, std::size_t i)
  { return lattice.size[axis] * static_cast<std::int64_t>(i) / static_cast<std::int64_t>(result.counts[axis]); };
  for (std::size_t k = 0; k < result.counts[2]; ++k)
    for (std::size_t j = 0; j < result.counts[1]; ++j)
      for (std::size_t i = 0; i < result.counts[0]; ++i)
      {
        const std::array<std::size_t, 3> at{ i, j, k };
        SubWindow window;
        for (std::size_t a = 0; a < 3; ++a)
        {
          window.first[a] = edge(a, at[a]);
          window.size[a] = edge(a, at[a] + 1) - window.first[a];
        }
        result.windows.push_back(window);
      }
  return result;
}

Lattice latticeOf(const Lattice& from, const SubWindow& window)
{
  Lattice lattice = from;
  lattice.size = window.size;
  for (int a = 0; a < 3; ++a)
    lattice.origin[static_cast<std::size_t>(a)] +=
      from.spacingAlong(a) * static_cast<double>(window.first[static_cast<std::size_t>(a)]);
  return lattice;
}

PhaseImage cut(const PhaseImage& image, const SubWindow& window)
{
  return { latticeOf(image.lattice, window), cut<std::uint8_t>(image.lattice, image.phase, window), image.phases };
}

} // namespace lamella
