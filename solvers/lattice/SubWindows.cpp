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

PhaseImage cut(const PhaseImage& image, const SubWindow& window)
{
  const Lattice& from = image.lattice;
  PhaseImage result{ from, {}, image.phases };
  result.lattice.size = window.size;
  for (int a = 0; a < 3; ++a)
    result.lattice.origin[static_cast<std::size_t>(a)] +=
      from.spacingAlong(a) * static_cast<double>(window.first[static_cast<std::size_t>(a)]);
  result.phase.reserve(static_cast<std::size_t>(result.lattice.count()));
  for (std::int64_t z = 0; z < window.size[2]; ++z)
    for (std::int64_t y = 0; y < window.size[1]; ++y)
    {
      const auto row = image.phase.begin() + from.index(window.first[0], window.first[1] + y, window.first[2] + z);
      result.phase.insert(result.phase.end(), row, row + window.size[0]);
    }
  return result;
}

} // namespace lamella
