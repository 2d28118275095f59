#include "peridynamics/fracture/Fracture.h"

#include "core/Error.h"
#include "peridynamics/RimExchange.h"

#include <fmt/format.h>

namespace lamella::peridynamics
{

std::vector<BondEnds> endsOf(const BondLattice& bonds, const std::vector<BrokenBond>& broken,
  std::span<const std::uint8_t> phase, std::span<const std::int32_t> grain)
{
  const NodeLayout& l = bonds.layout();
  const auto owned = static_cast<std::size_t>(l.owned());
  if (phase.size() != owned || (!grain.empty() && grain.size() != owned))
    throw InputError(fmt::format("{} phases and {} grains for {} nodes", phase.size(), grain.size(), owned),
      "give the arrays that the bonds were made of");
  NodeField<double> ids(l, 2); // exact in it
  std::size_t k = 0;
  for (std::int64_t z = 0; z < l.size[2]; ++z)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
      for (std::int64_t x = 0; x < l.size[0]; ++x, ++k)
      {
        ids.at(0, x, y, z) = phase[k];
        ids.at(1, x, y, z) = grain.empty() ? 0 : grain[k];
      }
  bonds.exchange(ids);
  std::vector<std::int64_t> mine;
  for (std::size_t b = 0; b < broken.size(); ++b)
  {
    const auto own = l.ownedIndex(broken[b].bond.node);
    if (!own)
      continue;
    const std::int64_t i = *own;
    const std::int64_t j = i + bonds.jump(broken[b].bond.offset);
    const auto id = [&](int c, std::int64_t at) { return static_cast<std::int64_t>(ids.component(c)[at]); };
    mine.insert(mine.end(),
      { static_cast<std::int64_t>(b), std::min(id(0, i), id(0, j)), std::max(id(0, i), id(0, j)),
        id(1, i) != 0 && id(1, j) != 0 && id(1, i) != id(1, j) ? 1 : 0 });
  }
  const std::vector<std::int64_t> all = gather(bonds.communicator(), mine, 4);
  std::vector<BondEnds> ends(broken.size());
  for (std::size_t at = 0; at < all.size(); at += 4)
    ends[static_cast<std::size_t>(all[at])] = { static_cast<std::uint8_t>(all[at + 1]),
      static_cast<std::uint8_t>(all[at + 2]), all[at + 3] != 0 };
  return ends;
}

} // namespace lamella::peridynamics
