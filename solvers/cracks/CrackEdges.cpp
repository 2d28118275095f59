#include "cracks/CrackEdges.h"

#include "core/Error.h"
#include "peridynamics/Stencil.h"

#include <fmt/format.h>

#include <algorithm>
#include <bitset>
#include <tuple>
#include <unordered_map>

namespace lamella::cracks
{
namespace
{

/// Steps of at most eight along each axis.
constexpr int reach = 8;
constexpr int width = 2 * reach + 1;
using Steps = std::bitset<width * width>;

std::size_t place(int x, int y)
{
  return static_cast<std::size_t>(x + reach + width * (y + reach));
}

/// A node with bonds to both of two neighbours: its steps from either.
struct Common
{
  std::array<int, 2> fromFirst;
  std::size_t first;
  std::size_t second;
};

std::vector<Common> commonNeighbours(const peridynamics::Stencil& stencil, int axis)
{
  std::vector<std::array<int, 2>> steps{ { 0, 0 } };
  Steps known;
  known.set(place(0, 0));
  for (const peridynamics::Offset& o : stencil.half())
    for (const int sign : { 1, -1 })
    {
      steps.push_back({ sign * o.step[0], sign * o.step[1] });
      known.set(place(steps.back()[0], steps.back()[1]));
    }
  std::vector<Common> common;
  for (const auto& [x, y] : steps)
  {
    const int fromX = x - (axis == 0 ? 1 : 0);
    const int fromY = y - (axis == 1 ? 1 : 0);
    if (std::abs(fromX) <= reach && std::abs(fromY) <= reach && known.test(place(fromX, fromY)))
      common.push_back({ { x, y }, place(x, y), place(fromX, fromY) });
  }
  return common;
}

} // namespace

std::vector<CrackEdge> crackEdges(
  const Lattice& lattice, double horizon, std::span<const CutBond> bonds, std::span<const std::uint8_t> solid)
{
  if (lattice.dimension != 2)
    throw ParameterError("paths of cracks in a volume", "they are found in pictures; count the bonds instead");
  const peridynamics::Stencil stencil(2, horizon);
  const auto exists = [&](std::int64_t x, std::int64_t y)
  {
    return x >= 0 && x < lattice.size[0] && y >= 0 && y < lattice.size[1] &&
      (solid.empty() || solid[static_cast<std::size_t>(lattice.index(x, y))] != 0);
  };
  std::unordered_map<std::int64_t, Steps> lost; // by node
  lost.reserve(bonds.size());
  for (const CutBond& b : bonds)
  {
    if (std::max(std::abs(b.step[0]), std::abs(b.step[1])) > stencil.layers())
      throw ParameterError(fmt::format("a broken bond of {} and {} spacings is longer than the horizon of {:g}",
                             b.step[0], b.step[1], horizon),
        "give the horizon with which the sample was broken");
    const std::int64_t x = b.node[0] + b.step[0];
    const std::int64_t y = b.node[1] + b.step[1];
    if (!exists(b.node[0], b.node[1]) || !exists(x, y))
      continue;
    lost[lattice.index(b.node[0], b.node[1])].set(place(b.step[0], b.step[1]));
    lost[lattice.index(x, y)].set(place(-b.step[0], -b.step[1]));
  }

  const std::array<std::vector<Common>, 2> common{ commonNeighbours(stencil, 0), commonNeighbours(stencil, 1) };
  const Steps none;
  std::vector<CrackEdge> edges;
  const auto judge = [&](std::int64_t x, std::int64_t y, int axis)
  {
    const std::int64_t otherX = x + (axis == 0 ? 1 : 0);
    const std::int64_t otherY = y + (axis == 1 ? 1 : 0);
    if (!exists(x, y) || !exists(otherX, otherY))
      return;
    const auto find = [&](std::int64_t node) -> const Steps&
    {
      const auto found = lost.find(node);
      return found == lost.end() ? none : found->second;
    };
    const Steps& first = find(lattice.index(x, y));
    const Steps& second = find(lattice.index(otherX, otherY));
    int one = 0;
    int both = 0;
    for (const Common& c : common[static_cast<std::size_t>(axis)])
      if (exists(x + c.fromFirst[0], y + c.fromFirst[1]))
      {
        const int held = (first.test(c.first) ? 0 : 1) + (second.test(c.second) ? 0 : 1);
        one += held == 1 ? 1 : 0;
        both += held == 2 ? 1 : 0;
      }
    if (one > both)
      edges.push_back({ x, y, axis, static_cast<double>(one - both) / (one + both) });
  };
  for (const auto& [node, steps] : lost)
  {
    const std::int64_t x = node % lattice.size[0];
    const std::int64_t y = node / lattice.size[0];
    judge(x, y, 0);
    judge(x, y, 1);
    // a pair is judged from its first node, but for those whose first node lost nothing
    if (x > 0 && !lost.contains(node - 1))
      judge(x - 1, y, 0);
    if (y > 0 && !lost.contains(node - lattice.size[0]))
      judge(x, y - 1, 1);
  }
  std::sort(edges.begin(), edges.end(),
    [](const CrackEdge& a, const CrackEdge& b) { return std::tie(a.y, a.x, a.axis) < std::tie(b.y, b.x, b.axis); });
  return edges;
}

} // namespace lamella::cracks
