#include "peridynamics/BreakSensitivity.h"

#include "peridynamics/BondForces.h"
#include "peridynamics/PairTable.h"
#include "peridynamics/RowSums.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace lamella::peridynamics
{
namespace
{

// Of the pull on the bond, where the equilibrium is found to 1e-6; in proportion elsewhere. Derivatives err by up to
// twice as much of the largest, which is less than the digit or two that an input's uncertainty is known to.
constexpr double residualShare = 4e-4;
constexpr double ofTolerance = 400;

/// Where a node of the whole lattice, or beyond a periodic side, lies here if this rank has it.
std::optional<std::int64_t> ownPlace(const NodeLayout& l, std::array<std::int64_t, 3> node)
{
  for (std::size_t a = 0; a < 3; ++a)
    node[a] = (node[a] + l.global[a]) % l.global[a];
  return l.ownedIndex(node);
}

/// ∂ log s/∂u of a bond, at its two ends.
struct Pull
{
  double size = 0; ///< norm of the load
  int kind = 0;    ///< of the bond
};

Pull pullBond(const BondLattice& bonds, const NodeField<double>& u, const Bond& bond, NodeField<double>& load)
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
  return { std::sqrt(2.0) / std::abs(o.length * bonds.spacing() * found[0]), static_cast<int>(found[1]) };
}

/// A first guess: u scaled where that is known to be near, and what fixed components are given.
NodeField<double> firstGuess(
  const BondLattice& bonds, const FixedComponents& fixed, const LoadedSample& sample, const BreakState& state)
{
  const NodeLayout& l = bonds.layout();
  NodeField<double> guess(l);
  if (state.pull == 0)
    return guess;
  const double scale = state.movement != 0 ? 1 / (state.movement * state.pull) : 0;
  forOwnRows(l,
    [&](std::int64_t y, std::int64_t z)
    {
      for (int c = 0; c < l.dimension; ++c)
        for (std::int64_t x = 0; x < l.size[0]; ++x)
        {
          const std::int64_t i = l.index(x, y, z);
          const std::array<std::int64_t, 3> node{ x + l.start[0], y + l.start[1], z + l.start[2] };
          const bool high = node[static_cast<std::size_t>(state.axis)] >= sample.highLayers[0] && bonds.solid(i);
          guess.component(c)[i] = (fixed[i] >> c & 1U) == 0 ? scale * state.u.component(c)[i]
            : high && c == state.across                     ? 1 / state.pull
                                                            : 0;
        }
    });
  bonds.exchange(guess);
  return guess;
}

/// λᵀK′u by kind of bond, K′ that of the kind: by the forces of each kind but the last, which has what the others
/// leave of all.
std::vector<double> mutualEnergies(const BondLattice& bonds, const NodeField<double>& lambda, const BreakState& state)
{
  std::vector<double> energies(bonds.kinds().size(), 0.0);
  energies.back() = -dot(bonds.communicator(), lambda, state.force);
  NodeField<double> force(bonds.layout());
  for (std::size_t k = 1; k + 1 < energies.size(); ++k)
  {
    linearForceOfKind(bonds, state.u, static_cast<int>(k), force);
    energies[k] = -dot(bonds.communicator(), lambda, force);
    energies.back() -= energies[k];
  }
  return energies;
}

} // namespace

BreakSensitivity breakSensitivity(const BondLattice& bonds, std::span<const int> pairKinds, Equilibrium& equilibrium,
  const LoadedSample& sample, const BreakState& state)
{
  NodeField<double> load(bonds.layout());
  const Pull pull = pullBond(bonds, state.u, state.bond, load);
  BreakSensitivity result;
  std::vector<double> energies{ 0, 1 }; // of one kind
  if (bonds.kinds().size() > 2)
  {
    NodeField<double> adjoint = firstGuess(bonds, equilibrium.fixed(), sample, state);
    equilibrium.setDoubt({});
    equilibrium.setTolerance(
      std::max(equilibrium.tolerance(), std::min(residualShare, ofTolerance * equilibrium.tolerance())));
    result.iterations = equilibrium.solveRoughly(adjoint, &load, pull.size).iterations;
    energies = mutualEnergies(bonds, adjoint, state);
  }
  for (std::size_t p = 0; p < pairKinds.size(); ++p)
  {
    const bool first = std::find(pairKinds.begin(), pairKinds.begin() + static_cast<std::ptrdiff_t>(p), pairKinds[p]) ==
      pairKinds.begin() + static_cast<std::ptrdiff_t>(p);
    result.stiffness.push_back(first ? energies.at(static_cast<std::size_t>(pairKinds[p])) : 0);
  }
  result.pair = static_cast<std::size_t>(std::find(pairKinds.begin(), pairKinds.end(), pull.kind) - pairKinds.begin());
  return result;
}

double relativeChange(const BreakSensitivity& sensitivity, const PairNumber& number)
{
  double sum = number.stretch.at(sensitivity.pair);
  for (std::size_t i = 0; i < number.young.size(); ++i)
    sum += sensitivity.stiffness.at(i) * number.young[i];
  return sum;
}

} // namespace lamella::peridynamics
