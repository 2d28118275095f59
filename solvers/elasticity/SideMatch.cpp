#include "elasticity/SideMatch.h"

#include <fmt/format.h>

#include <algorithm>

namespace lamella::elasticity
{

std::array<SideMatch, 3> sideMatch(const Lattice& lattice, std::span<const std::uint8_t> phase)
{
  std::array<SideMatch, 3> match;
  const auto& size = lattice.size;
  std::int64_t stride = 1;
  for (std::size_t a = 0; a < static_cast<std::size_t>(lattice.dimension); stride *= size[a++])
  {
    // pairs that differ, by the layer before them; the last is the seam
    std::vector<std::int64_t> differ(static_cast<std::size_t>(size[a]), 0);
    for (std::int64_t i = 0; i < lattice.count(); ++i)
    {
      const std::int64_t layer = i / stride % size[a];
      const std::int64_t next = layer + 1 == size[a] ? i - layer * stride : i + stride;
      differ[static_cast<std::size_t>(layer)] +=
        phase[static_cast<std::size_t>(i)] != phase[static_cast<std::size_t>(next)] ? 1 : 0;
    }
    const double section = static_cast<double>(lattice.count() / size[a]);
    match[a].across = static_cast<double>(differ.back()) / section;
    if (size[a] > 1)
      match[a].inside = static_cast<double>(*std::max_element(differ.begin(), differ.end() - 1)) / section;
  }
  return match;
}

std::vector<std::string> sideWarnings(const std::array<SideMatch, 3>& match, int dimension)
{
  constexpr double worse = 1.5;
  constexpr double few = 0.02;
  std::vector<std::string> warnings;
  for (std::size_t a = 0; a < static_cast<std::size_t>(dimension); ++a)
    if (match[a].across > worse * match[a].inside + few)
      warnings.push_back(fmt::format(
        "the sample is taken as a cell that repeats, but its sides do not fit together along {}: {:.0f} % of the nodes "
        "meet another phase there, and at most {:.0f} % in any layer within. The seam is part of the answer; a larger "
        "sample has less of it",
        "xyz"[a], 100 * match[a].across, 100 * match[a].inside));
  return warnings;
}

} // namespace lamella::elasticity
