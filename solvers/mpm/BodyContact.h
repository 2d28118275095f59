#pragma once

#include "mpm/BackgroundGrid.h"
#include "mpm/MaterialPoints.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lamella::mpm
{

template <int Dim>
class SharedRows;

/// Bodies that touch without being joined: each has velocities of its own on the grid, and where two meet at a node
/// they neither pass through each other nor hold each other (Bardenhagen, Guilkey, Roessig, Brackbill, Witzel and
/// Foster, CMES 2 (2001) 509). Phases of one body are joined, and so is a body to itself where it folds.
struct Bodies
{
  int count = 1;
  std::vector<std::uint8_t> ofPhase{}; ///< body of each phase, 0 … count − 1; of one body nothing is needed
  std::vector<double> friction{};      ///< Coulomb's coefficients by pair, count × count, symmetric
  std::vector<double> density{};       ///< of each body, mass over volume [kg/m³]; PointDynamics finds it

  [[nodiscard]] std::size_t of(std::size_t phase) const noexcept { return count == 1 ? 0 : ofPhase[phase]; }
  [[nodiscard]] double frictionOf(int a, int b) const
  {
    return friction[static_cast<std::size_t>(a) * static_cast<std::size_t>(count) + static_cast<std::size_t>(b)];
  }
};

/// Impulses between bodies at the nodes that several reach: where two touch and approach, the one that takes their
/// approach away, and across it friction, at most the coefficient times as much and no more than stops the sliding.
/// Keeps the momentum of every node; the kinetic energy of the nodes never grows. Bodies that part let go. With three
/// and more bodies at a node pairs are gone through three times.
///
/// Two bodies touch where the points of theirs that reach the node leave no gap along the normal, each taken for the
/// parallelepiped that F has made of its cube. The normal is one of three: the slope of one body's share of space, by
/// central differences of the nodes' masses over its density; that of the other; their mean; the one along which the
/// bodies are furthest apart, or overlap least. So an edge that slides over a plane has the plane's, where a mean of
/// slopes would make it plough. Exact along planes that lie along the grid.
/// @param points whose masses and momenta are on the nodes
/// @param nodes body after body as many rows of values as grid.count(): mass and momentum, nodeValues a node, folded,
/// and with the momentum of the walls' velocities
/// @param least mass of a node [kg] up to which a body is not there
/// @param rows of a grid that several ranks share, each with its points, and nodes that have those of all: the same
/// impulses on all ranks that have a node, to the last bit but where a period's ends meet. Collective then
template <int Dim>
void meet(const BackgroundGrid<Dim>& grid, const Bodies& bodies, const MaterialPoints<Dim>& points,
  std::span<double> nodes, double least, const SharedRows<Dim>* rows = nullptr);

} // namespace lamella::mpm
