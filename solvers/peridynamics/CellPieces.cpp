#include "peridynamics/CellPieces.h"

#include "peridynamics/BondSets.h"
#include "peridynamics/RimExchange.h"

#include <algorithm>
#include <map>
#include <set>
#include <vector>

namespace lamella::peridynamics
{
namespace
{

/// Whole cells along x, y, z.
using Shift = std::array<std::int64_t, 3>;

Shift operator+(const Shift& a, const Shift& b)
{
  return { a[0] + b[0], a[1] + b[1], a[2] + b[2] };
}

Shift operator-(const Shift& a, const Shift& b)
{
  return { a[0] - b[0], a[1] - b[1], a[2] - b[2] };
}

/// The cell in which a position of the layout lies, seen from the box.
Shift cellOf(const NodeLayout& l, std::int64_t index)
{
  Shift cell{};
  const std::array<std::int64_t, 3> node = l.node(index);
  for (std::size_t a = 0; a < static_cast<std::size_t>(l.dimension); ++a)
  {
    const std::int64_t n = node[a] + l.start[a];
    cell[a] = n >= 0 ? n / l.global[a] : -((-n + l.global[a] - 1) / l.global[a]);
  }
  return cell;
}

/// Parts of all ranks, joined to pieces; each part has a place relative to the first of its piece.
class Places
{
public:
  /// Part `b` lies `shift` cells further than part `a`.
  void join(std::int64_t a, std::int64_t b, const Shift& shift)
  {
    const auto [rootA, placeA] = find(a);
    const auto [rootB, placeB] = find(b);
    const Shift gap = placeA + shift - placeB; // of root B from root A, by this way
    if (rootA == rootB)
    {
      if (gap != Shift{})
        add(rootA, gap);
      return;
    }
    // the lesser stands for both, so that all ranks agree
    const bool firstStays = rootA < rootB;
    const std::int64_t root = firstStays ? rootA : rootB;
    const std::int64_t other = firstStays ? rootB : rootA;
    up_[other] = { root, firstStays ? gap : Shift{} - gap };
    std::array<bool, 3>& ways = around_[root];
    if (const auto found = around_.find(other); found != around_.end())
      for (std::size_t axis = 0; axis < 3; ++axis)
        ways[axis] = ways[axis] || found->second[axis];
  }

  [[nodiscard]] std::int64_t root(std::int64_t part) { return find(part).first; }

  /// Along which axes the piece of this root has gone around.
  [[nodiscard]] std::array<bool, 3> around(std::int64_t root) const
  {
    const auto found = around_.find(root);
    return found == around_.end() ? std::array<bool, 3>{} : found->second;
  }

private:
  /// The root of a part, and where the part lies from it; the way there is made short.
  std::pair<std::int64_t, Shift> find(std::int64_t part)
  {
    std::vector<std::int64_t> way;
    Shift place{};
    std::int64_t at = part;
    for (auto next = up_.find(at); next != up_.end(); next = up_.find(at))
    {
      way.push_back(at);
      place = place + next->second.second;
      at = next->second.first;
    }
    Shift left = place;
    for (const std::int64_t p : way)
    {
      auto& entry = up_[p];
      const Shift step = entry.second;
      entry = { at, left };
      left = left - step;
    }
    return { at, place };
  }

  void add(std::int64_t root, const Shift& shift)
  {
    for (std::size_t axis = 0; axis < 3; ++axis)
      around_[root][axis] = around_[root][axis] || shift[axis] != 0;
  }

  std::map<std::int64_t, std::pair<std::int64_t, Shift>> up_;
  std::map<std::int64_t, std::array<bool, 3>> around_;
};

template <class F>
void forOwnSolid(const BondLattice& bonds, F&& f)
{
  const NodeLayout& l = bonds.layout();
  for (std::int64_t z = 0; z < l.size[2]; ++z)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
      for (std::int64_t i = l.index(0, y, z); i < l.index(l.size[0], y, z); ++i)
        if (bonds.solid(i))
          f(i);
}

} // namespace

CellPieces findCellPieces(const BondLattice& bonds)
{
  const NodeLayout& l = bonds.layout();
  const Communicator& comm = bonds.communicator();
  Sets sets = joinBonds(bonds);
  // parts of this rank, numbered after those of the ranks before it
  AlignedArray<double> part(l.count()); // whole numbers are exact in it
  std::vector<std::int64_t> number(static_cast<std::size_t>(l.count()), -1);
  std::int64_t parts = 0;
  for (std::int64_t i = 0; i < l.count(); ++i)
    if (bonds.solid(i))
      if (std::int64_t& n = number[static_cast<std::size_t>(sets.find(i))]; n < 0)
        n = parts++;
  const std::int64_t first = comm.sumBefore(parts);
  const auto partOf = [&](std::int64_t i) { return first + number[static_cast<std::size_t>(sets.find(i))]; };
  for (std::int64_t i = 0; i < l.count(); ++i)
    part[i] = bonds.solid(i) ? static_cast<double>(partOf(i)) : -1;
  exchangeRim(l, bonds.periodic(), comm, part.data());

  // where a node of the rim is in this rank's part, and in its owner's: the same place up to whole cells
  std::set<std::array<std::int64_t, 5>> mine;
  for (std::int64_t i = 0; i < l.count(); ++i)
    if (bonds.solid(i) && part[i] >= 0 && !l.ownedNode(l.node(i)))
    {
      const Shift cell = cellOf(l, i);
      mine.insert({ static_cast<std::int64_t>(part[i]), partOf(i), -cell[0], -cell[1], -cell[2] });
    }
  std::vector<std::int64_t> flat;
  for (const auto& link : mine)
    flat.insert(flat.end(), link.begin(), link.end());
  flat = gather(comm, flat, 5);
  Places places;
  for (std::size_t k = 0; k < flat.size(); k += 5)
    places.join(flat[k], flat[k + 1], { flat[k + 2], flat[k + 3], flat[k + 4] });

  std::map<std::int64_t, std::int64_t> nodes; // of roots
  std::int64_t lastPart = -1;
  std::int64_t* last = nullptr;
  forOwnSolid(bonds,
    [&](std::int64_t i)
    {
      if (const std::int64_t p = partOf(i); p != lastPart)
      {
        lastPart = p;
        last = &nodes[places.root(p)];
      }
      ++*last;
    });
  flat.clear();
  for (const auto& [root, count] : nodes)
    flat.insert(flat.end(), { root, count });
  flat = gather(comm, flat, 2);
  nodes.clear();
  for (std::size_t k = 0; k < flat.size(); k += 2)
    nodes[flat[k]] += flat[k + 1];

  CellPieces result;
  result.pieces = static_cast<std::int64_t>(nodes.size());
  for (const auto& [root, count] : nodes)
  {
    const std::array<bool, 3> around = places.around(root);
    if (around == std::array<bool, 3>{})
    {
      ++result.loosePieces;
      result.looseNodes += count;
    }
    for (std::size_t axis = 0; axis < 3; ++axis)
      result.crosses[axis] = result.crosses[axis] || around[axis];
  }
  result.loose = AlignedArray<std::uint8_t>(l.count());
  if (result.loosePieces > 0)
    forOwnSolid(bonds,
      [&](std::int64_t i)
      { result.loose[i] = places.around(places.root(partOf(i))) == std::array<bool, 3>{} ? 1 : 0; });
  exchangeRim(l, bonds.periodic(), comm, result.loose.data());
  return result;
}

} // namespace lamella::peridynamics
