#include "peridynamics/BreakSensitivity.h"

#include "peridynamics/BondForces.h"
#include "peridynamics/PairTable.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace lamella::peridynamics
{
namespace
{

// Of a field that errs by a thousandth derivatives err by about as much: it tells what an input's uncertainty, known to
// a digit or two, leaves.
constexpr double sensitivityPart = 1e-3;

/// Where a node of the whole lattice, or beyond a periodic side, lies here if this rank has it.
std::optional<std::int64_t> ownPlace(const NodeLayout& l, std::array<std::int64_t, 3> node)
{
  for (std::size_t a = 0; a < 3; ++a)
    node[a] = (node[a] + l.global[a]) % l.global[a];
  return l.ownedIndex(node);
}

/// ∂ log s/∂u of a bond, at its two ends, and its kind.
int pullBond(const BondLattice& bonds, const NodeField<double>& u, const Bond& bond, NodeField<double>& load)
{
  const NodeLayout& l = bonds.layout();
  const Offset& o = bonds.stencil().half()[static_cast<std::size_t>(bond.offset)];
  std::array<std::int64_t, 3> second = bond.node;
  for (std::size_t a = 0; a < 3; ++a)
    second[a] += o.step[a];
  std::array<double, 2> found{}; // s, kind: of the rank that has the first node
  if (const auto i = ownPlace(l, bond.node))
  {
    const double length = o.length * bonds.spacing();
    for (int c = 0; c < l.dimension; ++c)
      found[0] += o.step[static_cast<std::size_t>(c)] * bonds.spacing() *
        (u.component(c)[*i + bonds.jump(bond.offset)] - u.component(c)[*i]) / (length * length);
    found[1] = bonds.kind(*i, bond.offset);
  }
  bonds.communicator().sum(found);
  for (const auto& [node, sign] : { std::pair{ bond.node, -1.0 }, std::pair{ second, 1.0 } })
    if (const auto i = ownPlace(l, node))
      for (int c = 0; c < l.dimension; ++c)
        load.component(c)[*i] +=
          sign * o.step[static_cast<std::size_t>(c)] / (o.length * o.length * bonds.spacing() * found[0]);
  bonds.exchange(load);
  return static_cast<int>(found[1]);
}

} // namespace

BreakSensitivity breakSensitivity(const BondLattice& bonds, Equilibrium& equilibrium, const LoadedSample& sample,
  const NodeField<double>& u, const Bond& bond, int axis, int across, double force)
{
  const NodeLayout& l = bonds.layout();
  NodeField<double> adjoint(l);
  if (force != 0)
    for (std::int64_t z = 0; z < l.size[2]; ++z)
      for (std::int64_t y = 0; y < l.size[1]; ++y)
        for (std::int64_t x = 0; x < l.size[0]; ++x)
        {
          const std::array<std::int64_t, 3> node{ x + l.start[0], y + l.start[1], z + l.start[2] };
          const std::int64_t i = l.index(x, y, z);
          if (node[static_cast<std::size_t>(axis)] >= sample.highLayers[0] && bonds.solid(i))
            adjoint.component(across)[i] = 1 / force;
        }
  bonds.exchange(adjoint);
  NodeField<double> load(l);
  BreakSensitivity result;
  result.kind = pullBond(bonds, u, bond, load);
  equilibrium.setDoubt({});
  equilibrium.setTolerance(
    std::max(equilibrium.tolerance(), std::min(sensitivityPart, 1000 * equilibrium.tolerance())));
  result.iterations = equilibrium.solve(adjoint, &load).iterations;
  result.stiffness = mutualEnergy(bonds, adjoint, u);
  result.stiffness.erase(result.stiffness.begin());
  return result;
}

double relativeChange(const BreakSensitivity& sensitivity, const PairNumber& number)
{
  double sum = number.stretch.at(static_cast<std::size_t>(sensitivity.kind - 1));
  for (std::size_t i = 0; i < number.young.size(); ++i)
    sum += sensitivity.stiffness.at(i) * number.young[i];
  return sum;
}

} // namespace lamella::peridynamics
