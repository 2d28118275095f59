#include "peridynamics/BondSets.h"

#include <algorithm>

namespace lamella::peridynamics
{
namespace
{

constexpr double nearby = 1.5; // spacings

template <class F>
void eachRow(const NodeLayout& l, F&& f)
{
  for (std::int64_t z = -l.ghostZ(); z < l.size[2] + l.ghostZ(); ++z)
    for (std::int64_t y = -l.ghost; y < l.size[1] + l.ghost; ++y)
      f(l.row(y, z));
}

/// f(first position, strip) of those that have bonds.
template <class F>
void eachStrip(const BondLattice& bonds, F&& f)
{
  const NodeLayout& l = bonds.layout();
  eachRow(l,
    [&](std::int64_t row)
    {
      const std::uint8_t* strips = bonds.stripsOf(row);
      for (std::int64_t s = 0; s < l.pitch / 16; ++s)
        if (strips[s] != 0)
          f(l.begin(row) + 16 * s, strips[s]);
    });
}

// Bonds to the next nodes join nearly all.
void joinNeighbours(const BondLattice& bonds, Sets& sets)
{
  const auto& half = bonds.stencil().half();
  std::vector<int> offsets;
  for (std::size_t o = 0; o < half.size(); ++o)
    if (half[o].length < nearby)
      offsets.push_back(static_cast<int>(o));
  eachStrip(bonds,
    [&](std::int64_t begin, std::uint8_t strip)
    {
      for (std::int64_t i = begin; i < begin + 16; ++i)
        for (const int o : offsets)
          if ((strip != 255 || bonds.kind(i, o) != 0) && sets.at(i) != sets.at(i + bonds.jump(o)))
            sets.join(i, i + bonds.jump(o));
    });
}

// The longer ones are looked at where they lead from one set to another.
void joinFar(const BondLattice& bonds, Sets& sets)
{
  const std::int64_t count = bonds.layout().count();
  const auto& half = bonds.stencil().half();
  eachStrip(bonds,
    [&](std::int64_t begin, std::uint8_t)
    {
      for (std::size_t o = 0; o < half.size(); ++o)
      {
        if (half[o].length < nearby)
          continue;
        // the rim's bonds may lead out of the layout: there are none such, but they must not be looked up either
        const std::int64_t jump = bonds.jump(static_cast<int>(o));
        const std::int64_t first = std::max(begin, -jump);
        const std::int64_t end = std::min(begin + 16, count - jump);
        if (first >= end)
          continue;
        const std::int64_t* from = &sets.at(first);
        const std::int64_t* to = &sets.at(first + jump);
        std::int64_t differ = 0;
        for (std::int64_t i = 0; i < end - first; ++i)
          differ |= from[i] ^ to[i];
        for (std::int64_t i = first; differ != 0 && i < end; ++i)
          if (bonds.kind(i, static_cast<int>(o)) != 0)
            sets.join(i, i + jump);
      }
    });
}

} // namespace

Sets joinBonds(const BondLattice& bonds)
{
  Sets sets(bonds.layout().count());
  joinNeighbours(bonds, sets);
  sets.flatten();
  joinFar(bonds, sets);
  sets.flatten();
  return sets;
}

} // namespace lamella::peridynamics
