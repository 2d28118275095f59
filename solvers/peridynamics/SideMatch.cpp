#include "peridynamics/SideMatch.h"

#include <algorithm>

namespace lamella::peridynamics
{

std::array<elasticity::SideMatch, 3> sideMatch(const BondLattice& bonds, std::span<const std::uint8_t> phase)
{
  const NodeLayout& l = bonds.layout();
  const NodeField<float> ids = bonds.fieldOf(phase);
  std::array<elasticity::SideMatch, 3> match;
  for (std::size_t a = 0; a < static_cast<std::size_t>(l.dimension); ++a)
  {
    // pairs that differ, by the layer before them; the last is the seam
    std::vector<double> differ(static_cast<std::size_t>(l.global[a]), 0.0);
    std::array<std::int64_t, 3> step{};
    step[a] = 1;
    for (std::int64_t z = 0; z < l.size[2]; ++z)
      for (std::int64_t y = 0; y < l.size[1]; ++y)
        for (std::int64_t x = 0; x < l.size[0]; ++x)
          if (ids.at(0, x, y, z) != ids.at(0, x + step[0], y + step[1], z + step[2]))
            differ[static_cast<std::size_t>(std::array{ x, y, z }[a] + l.start[a])] += 1;
    bonds.communicator().sum(differ);
    const double section = static_cast<double>(l.global[0] * l.global[1] * l.global[2] / l.global[a]);
    match[a].across = differ.back() / section;
    match[a].inside = *std::max_element(differ.begin(), differ.end() - 1) / section;
  }
  return match;
}

} // namespace lamella::peridynamics
