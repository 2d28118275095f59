#include "peridynamics/fracture/LoosePieces.h"

#include <algorithm>
#include <limits>

namespace lamella::peridynamics
{

std::vector<Bond> bondsOfLoosePieces(const BondLattice& bonds, const Fragments& fragments)
{
  const NodeLayout& l = bonds.layout();
  std::vector<Bond> loose;
  for (std::int64_t z = 0; z < l.size[2]; ++z)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
      bonds.forEachBond(y, z,
        [&](std::int64_t i, std::int64_t, int o, int)
        {
          if (l.ownedNode(l.node(i)) &&
            (fragments.pieces[static_cast<std::size_t>(fragments.piece[i])].fixed & 4U) == 0)
            loose.push_back(bonds.bond(i, o));
        });
  return loose;
}

LoosePieces::LoosePieces(const BondLattice& bonds, const LoadedSample& sample, const PlatenForce& platens)
  : bonds_(bonds)
  , graph_(bonds)
  , marks_(platens.marks(bonds, sample))
  , seen_(bonds.layout().count())
{
  for (const Fragment& f : findFragments(bonds, &marks_).pieces)
    bridges_ += (f.fixed & 3U) == 3 ? 1 : 0;
}

void LoosePieces::begin(Flood& flood, std::int64_t node)
{
  flood.nodes.push_back(node);
  flood.mark = ++floods_;
  flood.platens = marks_[node];
  seen_[node] = flood.mark;
}

bool LoosePieces::grow(Flood& flood, std::uint16_t other)
{
  const std::int64_t node = flood.nodes[flood.next++];
  return graph_.anyNeighbour(node,
    [&](std::int64_t n, const std::array<int, 3>&)
    {
      if (seen_[n] == flood.mark)
        return false;
      if (other != 0 && seen_[n] == other)
        return true;
      seen_[n] = flood.mark;
      flood.platens |= marks_[n];
      flood.nodes.push_back(n);
      return false;
    });
}

std::vector<std::int64_t> LoosePieces::after(std::int64_t index, int offset)
{
  const auto& step = bonds_.stencil().half()[static_cast<std::size_t>(offset)].step;
  if (graph_.shareNeighbour(index, step))
    return {};
  ++searches_;
  if (floods_ > std::numeric_limits<std::uint16_t>::max() - 4)
  {
    seen_ = AlignedArray<std::uint16_t>(bonds_.layout().count());
    floods_ = 0;
  }
  Flood first;
  Flood second;
  begin(first, index);
  begin(second, index + bonds_.jump(offset));
  while (first.next < first.nodes.size() && second.next < second.nodes.size())
    if (grow(first, second.mark) || grow(second, first.mark))
      return {};
  Flood& piece = first.next < first.nodes.size() ? second : first; // the one that is exhausted
  Flood& rest = first.next < first.nodes.size() ? first : second;
  if ((piece.platens & 4U) == 0)
  {
    std::sort(piece.nodes.begin(), piece.nodes.end());
    return std::move(piece.nodes);
  }
  // it hangs on a platen: was it a piece between both that came apart?
  while ((rest.platens & 3U) != 3 && rest.next < rest.nodes.size())
    (void)grow(rest, 0);
  const int parts = ((piece.platens & 3U) == 3 ? 1 : 0) + ((rest.platens & 3U) == 3 ? 1 : 0);
  if (((piece.platens | rest.platens) & 3U) == 3)
    bridges_ += parts - 1;
  if ((rest.platens & 4U) == 0) // then it has been followed to its end
  {
    std::sort(rest.nodes.begin(), rest.nodes.end());
    return std::move(rest.nodes);
  }
  return {};
}

} // namespace lamella::peridynamics
