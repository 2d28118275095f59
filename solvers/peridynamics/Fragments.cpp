#include "peridynamics/Fragments.h"

#include "peridynamics/BondSets.h"
#include "peridynamics/RimExchange.h"

#include <algorithm>
#include <limits>
#include <map>

namespace lamella::peridynamics
{
namespace
{

/// Node in the whole lattice that a position holds, images at periodic sides taken back into the box.
std::int64_t globalNode(const BondLattice& bonds, std::int64_t index)
{
  const NodeLayout& l = bonds.layout();
  std::array<std::int64_t, 3> n = l.node(index);
  for (std::size_t a = 0; a < 3; ++a)
  {
    n[a] += l.start[a];
    if (bonds.periodic()[a])
      n[a] = ((n[a] % l.global[a]) + l.global[a]) % l.global[a];
  }
  return n[0] + l.global[0] * (n[1] + l.global[1] * n[2]);
}

/// Which pieces are one, by their first nodes.
class Joined
{
public:
  /// The first node of all that a piece is part of.
  [[nodiscard]] std::int64_t final(std::int64_t n) const
  {
    for (auto f = lower_.find(n); f != lower_.end() && f->second != n; f = lower_.find(n))
      n = f->second;
    return n;
  }
  void add(std::int64_t one, std::int64_t other)
  {
    const std::int64_t a = final(one);
    const std::int64_t b = final(other);
    if (a != b)
      lower_[std::max(a, b)] = std::min(a, b);
  }

private:
  std::map<std::int64_t, std::int64_t> lower_;
};

/// What ranks and periodic sides join. @param name of the pieces of this rank, by root
Joined joinRanks(const BondLattice& bonds, Sets& sets, const std::vector<std::int64_t>& name)
{
  const NodeLayout& l = bonds.layout();
  const auto nameOf = [&](std::int64_t i) { return name[static_cast<std::size_t>(sets.find(i))]; };
  AlignedArray<double> field(l.count()); // node numbers are exact in it
  for (std::int64_t i = 0; i < l.count(); ++i)
    field[i] = bonds.solid(i) ? static_cast<double>(nameOf(i)) : -1;
  exchangeRim(l, bonds.periodic(), bonds.communicator(), field.data());
  std::vector<std::int64_t> pairs;
  for (std::int64_t i = 0; i < l.count(); ++i)
    if (bonds.solid(i) && field[i] >= 0)
      if (const auto other = static_cast<std::int64_t>(field[i]); other != nameOf(i))
        pairs.insert(pairs.end(), { nameOf(i), other });
  const std::vector<std::int64_t> all = gather(bonds.communicator(), pairs, 2);
  Joined joined;
  for (std::size_t i = 0; i < all.size(); i += 2)
    joined.add(all[i], all[i + 1]);
  return joined;
}

/// The pieces of all ranks, by their first nodes.
std::map<std::int64_t, Fragment> gathered(const Communicator& comm, const std::map<std::int64_t, Fragment>& mine)
{
  std::vector<std::int64_t> counts;
  for (const auto& [first, piece] : mine)
    counts.insert(counts.end(), { first, piece.nodes, piece.fixed });
  counts = gather(comm, counts, 3);
  std::map<std::int64_t, Fragment> whole;
  for (std::size_t i = 0; i < counts.size(); i += 3)
  {
    Fragment& f = whole[counts[i]];
    f.first = counts[i];
    f.nodes += counts[i + 1];
    f.fixed = static_cast<std::uint8_t>(f.fixed | counts[i + 2]);
  }
  return whole;
}

} // namespace

Fragments findFragments(const BondLattice& bonds, const AlignedArray<std::uint8_t>* fixed)
{
  const NodeLayout& l = bonds.layout();
  Sets sets = joinBonds(bonds);

  // pieces of this rank by their first node
  std::vector<std::int64_t> name(static_cast<std::size_t>(l.count()), -1); // of roots
  for (std::int64_t i = 0; i < l.count(); ++i)
    if (bonds.solid(i))
    {
      std::int64_t& n = name[static_cast<std::size_t>(sets.find(i))];
      const std::int64_t g = globalNode(bonds, i);
      n = n < 0 ? g : std::min(n, g);
    }
  const Joined joined = joinRanks(bonds, sets, name);

  // numbers, sizes and fixed components of all
  std::map<std::int64_t, Fragment> mine;
  const auto eachOwn = [&](const auto& f)
  {
    for (std::int64_t z = 0; z < l.size[2]; ++z)
      for (std::int64_t y = 0; y < l.size[1]; ++y)
        for (std::int64_t i = l.index(0, y, z); i < l.index(l.size[0], y, z); ++i)
          if (bonds.solid(i))
            f(i);
  };
  std::int64_t lastRoot = -1;
  Fragment* last = nullptr;
  eachOwn(
    [&](std::int64_t i)
    {
      const std::int64_t root = sets.find(i);
      if (root != lastRoot)
      {
        lastRoot = root;
        last = &mine[joined.final(name[static_cast<std::size_t>(root)])];
      }
      ++last->nodes;
      if (fixed != nullptr)
        last->fixed |= (*fixed)[i];
    });
  Fragments result;
  std::map<std::int64_t, std::int32_t> number;
  for (const auto& [first, piece] : gathered(bonds.communicator(), mine))
  {
    number[first] = static_cast<std::int32_t>(result.pieces.size());
    result.pieces.push_back(piece);
  }
  result.piece = AlignedArray<std::int32_t>(l.count());
  std::fill_n(result.piece.data(), l.count(), -1);
  lastRoot = -1;
  std::int32_t lastNumber = -1;
  eachOwn(
    [&](std::int64_t i)
    {
      const std::int64_t root = sets.find(i);
      if (root != lastRoot)
      {
        lastRoot = root;
        lastNumber = number[joined.final(name[static_cast<std::size_t>(root)])];
      }
      result.piece[i] = lastNumber;
    });
  return result;
}

} // namespace lamella::peridynamics
