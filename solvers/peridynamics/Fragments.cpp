#include "peridynamics/Fragments.h"

#include "peridynamics/RimExchange.h"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

namespace lamella::peridynamics
{
namespace
{

/// Disjoint sets of positions; the least of a set stands for it.
class Sets
{
public:
  explicit Sets(std::int64_t count)
    : parent_(static_cast<std::size_t>(count))
  {
    std::iota(parent_.begin(), parent_.end(), std::int64_t{ 0 });
  }
  std::int64_t find(std::int64_t i)
  {
    while (at(i) != i)
    {
      at(i) = at(at(i));
      i = at(i);
    }
    return i;
  }
  void join(std::int64_t a, std::int64_t b)
  {
    a = find(a);
    b = find(b);
    if (a < b)
      at(b) = a;
    else
      at(a) = b;
  }
  /// Every entry becomes the one that stands for its set.
  void flatten()
  {
    for (std::size_t i = 0; i < parent_.size(); ++i) // the least of a set comes first
      parent_[i] = parent_[static_cast<std::size_t>(parent_[i])];
  }
  [[nodiscard]] std::int64_t& at(std::int64_t i) { return parent_[static_cast<std::size_t>(i)]; }

private:
  std::vector<std::int64_t> parent_;
};

constexpr double nearby = 1.5; // spacings

template <class F>
void eachRow(const NodeLayout& l, F&& f)
{
  for (std::int64_t z = -l.ghostZ(); z < l.size[2] + l.ghostZ(); ++z)
    for (std::int64_t y = -l.ghost; y < l.size[1] + l.ghost; ++y)
      f(l.row(y, z));
}

// Bonds to the next nodes join nearly all.
void joinNeighbours(const BondLattice& bonds, Sets& sets)
{
  const NodeLayout& l = bonds.layout();
  const auto& half = bonds.stencil().half();
  std::vector<int> offsets;
  for (std::size_t o = 0; o < half.size(); ++o)
    if (half[o].length < nearby)
      offsets.push_back(static_cast<int>(o));
  eachRow(l,
    [&](std::int64_t row)
    {
      const std::uint8_t* strips = bonds.stripsOf(row);
      for (std::int64_t s = 0; s < l.pitch / 16; ++s)
      {
        if (strips[s] == 0)
          continue;
        for (std::int64_t i = row * l.pitch + 16 * s; i < row * l.pitch + 16 * (s + 1); ++i)
          for (const int o : offsets)
            if ((strips[s] != 255 || bonds.kind(i, o) != 0) && sets.at(i) != sets.at(i + bonds.jump(o)))
              sets.join(i, i + bonds.jump(o));
      }
    });
}

// The longer ones are looked at where they lead from one set to another.
void joinFar(const BondLattice& bonds, Sets& sets)
{
  const NodeLayout& l = bonds.layout();
  const auto& half = bonds.stencil().half();
  eachRow(l,
    [&](std::int64_t row)
    {
      const std::uint8_t* strips = bonds.stripsOf(row);
      for (std::int64_t s = 0; s < l.pitch / 16; ++s)
      {
        if (strips[s] == 0)
          continue;
        const std::int64_t begin = row * l.pitch + 16 * s;
        for (std::size_t o = 0; o < half.size(); ++o)
        {
          if (half[o].length < nearby)
            continue;
          const std::int64_t* from = &sets.at(begin);
          const std::int64_t* to = from + bonds.jump(static_cast<int>(o));
          std::int64_t differ = 0;
          for (int i = 0; i < 16; ++i)
            differ |= from[i] ^ to[i];
          for (std::int64_t i = begin; differ != 0 && i < begin + 16; ++i)
            if (bonds.kind(i, static_cast<int>(o)) != 0)
              sets.join(i, i + bonds.jump(static_cast<int>(o)));
        }
      }
    });
}

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

} // namespace

Fragments findFragments(const BondLattice& bonds, const AlignedArray<std::uint8_t>* fixed)
{
  const NodeLayout& l = bonds.layout();
  Sets sets(l.count());
  joinNeighbours(bonds, sets);
  sets.flatten();
  joinFar(bonds, sets);
  sets.flatten();

  // pieces of this rank by their first node, and what ranks and periodic sides join
  std::vector<std::int64_t> name(static_cast<std::size_t>(l.count()), -1); // of roots
  const auto touches = [&](std::int64_t i) { return bonds.solid(i); };
  for (std::int64_t i = 0; i < l.count(); ++i)
    if (touches(i))
    {
      std::int64_t& n = name[static_cast<std::size_t>(sets.find(i))];
      const std::int64_t g = globalNode(bonds, i);
      n = n < 0 ? g : std::min(n, g);
    }
  const auto nameOf = [&](std::int64_t i) { return name[static_cast<std::size_t>(sets.find(i))]; };
  AlignedArray<double> field(l.count()); // node numbers are exact in it
  for (std::int64_t i = 0; i < l.count(); ++i)
    field[i] = touches(i) ? static_cast<double>(nameOf(i)) : -1;
  exchangeRim(l, bonds.periodic(), bonds.communicator(), field.data());
  std::vector<std::int64_t> pairs;
  for (std::int64_t i = 0; i < l.count(); ++i)
    if (touches(i) && field[i] >= 0)
      if (const auto other = static_cast<std::int64_t>(field[i]); other != nameOf(i))
        pairs.insert(pairs.end(), { nameOf(i), other });
  const std::vector<std::int64_t> all = gather(bonds.communicator(), pairs, 2);
  std::map<std::int64_t, std::int64_t> joined;
  const auto final = [&](std::int64_t n)
  {
    for (auto f = joined.find(n); f != joined.end() && f->second != n; f = joined.find(n))
      n = f->second;
    return n;
  };
  for (std::size_t i = 0; i < all.size(); i += 2)
  {
    const std::int64_t a = final(all[i]);
    const std::int64_t b = final(all[i + 1]);
    if (a != b)
      joined[std::max(a, b)] = std::min(a, b);
  }

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
        last = &mine[final(name[static_cast<std::size_t>(root)])];
      }
      ++last->nodes;
      if (fixed != nullptr)
        last->fixed |= (*fixed)[i];
    });
  std::vector<std::int64_t> counts;
  for (const auto& [first, piece] : mine)
    counts.insert(counts.end(), { first, piece.nodes, piece.fixed });
  counts = gather(bonds.communicator(), counts, 3);
  std::map<std::int64_t, Fragment> whole;
  for (std::size_t i = 0; i < counts.size(); i += 3)
  {
    Fragment& f = whole[counts[i]];
    f.first = counts[i];
    f.nodes += counts[i + 1];
    f.fixed = static_cast<std::uint8_t>(f.fixed | counts[i + 2]);
  }
  Fragments result;
  std::map<std::int64_t, std::int32_t> number;
  for (const auto& [first, piece] : whole)
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
        lastNumber = number[final(name[static_cast<std::size_t>(root)])];
      }
      result.piece[i] = lastNumber;
    });
  return result;
}

} // namespace lamella::peridynamics
