#pragma once

#include "mpm/BackgroundGrid.h"
#include "mpm/BodyContact.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace lamella::mpm
{

/// A wall at an end of an axis, or the far end of a period.
struct Wall
{
  bool straight = false; ///< moves as it must for its force to vanish: stiff, without mass
  bool sticks =
    false; ///< holds what touches it along itself too; else it is frictionless. A frame of reference at rest
  double velocity = 0; ///< along the axis [m/s]: given, or of a straight wall what was found
  /// Coulomb's coefficient, 0 or above: of a wall that is neither straight nor sticks.
  double friction = 0;
  double force = 0; ///< of the body on it, along the axis, when the last step began [N], [N/m] in 2D
};

/// Lower (0) and upper (1) of every axis. Of a periodic axis the upper one says how fast the period grows.
template <int Dim>
struct Walls
{
  std::array<std::array<Wall, 2>, Dim> wall{};
  /// Mass of a node [kg], up to which its velocity is set to 0: sums over whole cells have lost it in round-off.
  double least = 1e-300;
  Bodies bodies{}; ///< that are between them

  Wall& operator()(int axis, int side) { return wall[static_cast<std::size_t>(axis)][static_cast<std::size_t>(side)]; }
  const Wall& operator()(int axis, int side) const
  {
    return wall[static_cast<std::size_t>(axis)][static_cast<std::size_t>(side)];
  }
};

/// A row of values a node: mass, then one a component, padded to four.
inline constexpr int nodeValues = 4;
inline constexpr double leastMass = 1e-300; ///< of a node; below it it has none: its velocity would overflow

/// A node whose velocity along a component follows from another's: v_ghost = sign · v_master + jump · V, V the wall's.
struct MirrorPair
{
  int ghost;
  int master;
  double sign;
  double jump;
};

/// The pairs of one end of an axis for one component: none where it is open.
struct MirrorPairs
{
  int count = 0;
  std::array<MirrorPair, 3> pair{};
};

/// Mirrors: beyond a wall the velocity is odd across it along the normal (and along a wall that sticks), even along one
/// that does not. So the velocity that splines make of it is V at the wall. Periodic: the nodes 0 … cells − 1 are
/// masters of those that coincide with them, a period away.
template <int Dim>
[[nodiscard]] MirrorPairs mirrorPairs(
  const BackgroundGrid<Dim>& grid, const Walls<Dim>& walls, int axis, int side, int c);

/// Lines of nodes along an axis.
enum class Lines : std::uint8_t
{
  All,
  Real, ///< that are no images of others across the ends of the other axes
  Own   ///< of those, each on one rank only where several share a grid
};

/// Calls f(position in memory of the first node) for every such line.
template <int Dim, class F>
void forEachLine(const BackgroundGrid<Dim>& grid, int axis, Lines lines, F&& f)
{
  const int b = axis == 0 ? 1 : 0;
  const int d = Dim == 3 ? 3 - axis - b : b;
  const auto rim = [&](int a, int side) // what is left out at an end
  {
    const GridAxis& g = grid.axis(a);
    if (lines == Lines::All || (lines == Lines::Real && g.isCut(side)))
      return 0;
    return (g.end(side) == Edge::Periodic ? side == 1 : g.isCut(side)) ? 2 : 1;
  };
  const auto end = [&](int a) { return grid.nodes(a) - rim(a, 1); };
  for (int k = Dim == 3 ? rim(d, 0) : 0; k < (Dim == 3 ? end(d) : 1); ++k)
    for (int j = rim(b, 0); j < end(b); ++j)
      f(j * grid.stride(b) + (Dim == 3 ? k * grid.stride(d) : 0));
}

/// Mass μ and momentum π that a wall moves.
struct WallSums
{
  double mass = 0;
  double momentum = 0;
};

template <int Dim>
class SharedRows;

/// Turns mass and momentum of the nodes into their velocities, walls obeyed: Galerkin's projection of the lumped
/// equations upon the fields that the walls allow. What points spread beyond walls is folded back; straight walls get
/// the velocity at which the momentum that they add vanishes, which is linear in it:
/// added = μ V − π, μ = Σ m₀ + Σ j² m_g (1 − m_g/M), π = Σ p₀ + Σ j (p_g − s m_g P/M),
/// over the nodes on the wall (m₀, p₀) and its pairs (ghost m_g, p_g; folded master M, P; sign s, jump j).
///
/// Where bodies meet, and walls have friction, impulses come in between, and straight walls are found anew. Friction of
/// a wall acts where each line of nodes meets it, on the velocity that splines have there, ¾ v₀ + ¼ v₁ = u: the impulse
/// −λ u/|u| on it is what stops it, and at most the coefficient times the one that presses the line's nodes on the
/// wall. So it never adds energy, and adds up to the coefficient times the wall's force wherever all lines are pressed
/// on it and slide.
/// @param nodes mass and momentum, nodeValues a node, of one body after another; then folded mass and velocity
/// @param kick over which the momentum was changed [s]: forces are momentum over it
/// @param find whether straight walls' velocities are to be found, and impulses of contact and friction; else all are
/// taken as they are, and bodies as if they did not meet
/// @param rows of a grid that several ranks share: each gives what its own points have given; collective then
/// @param points that gave to the nodes, where several bodies are to meet
template <int Dim>
void constrain(const BackgroundGrid<Dim>& grid, Walls<Dim>& walls, std::span<double> nodes, double kick, bool find,
  SharedRows<Dim>* rows = nullptr, const MaterialPoints<Dim>* points = nullptr);

/// Adds ghosts to their masters with their sign: mass (component −1) or a component, linear (V = 0).
template <int Dim>
void fold(const BackgroundGrid<Dim>& grid, const Walls<Dim>& walls, std::span<double> nodes);

/// Velocities beyond the ends from those within.
template <int Dim>
void mirror(const BackgroundGrid<Dim>& grid, const Walls<Dim>& walls, std::span<double> nodes);

} // namespace lamella::mpm
