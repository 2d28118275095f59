#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

namespace lamella::cracks
{

using Place = std::array<double, 2>;

[[nodiscard]] inline double distance(const Place& a, const Place& b)
{
  return std::hypot(a[0] - b[0], a[1] - b[1]);
}

/// A chain of parted pairs as it is to be smoothed.
struct StairCase
{
  std::vector<Place> middles; ///< of the pairs: somewhere within half a spacing of it along `axes` the crack runs
  std::vector<int> axes;      ///< along which the two nodes of each pair lie
  bool closed = false;
  std::array<std::optional<Place>, 2> anchors{}; ///< where the curve is to begin and end, if that is known
};

/// The smoothest curve that still passes between the two nodes of every pair: one point a pair.
///
/// The points minimise Σ w |p − m|² + Σ λ |p″|², m the middles and w the inverse variance of where on a pair a crack
/// may cross, across it. λ begins so large that the whole chain is a line and is lowered around every pair that the
/// curve misses by more than a twentieth of a spacing, as far as it reaches there; so a straight part stays straight to
/// its end, however slowly its stairs climb, while a bend is followed. What smoothing takes off bends is given back by
/// smoothing the remainder once more (Tukey's twicing). Stairs are not counted as length.
[[nodiscard]] std::vector<Place> smooth(const StairCase& stairs);

} // namespace lamella::cracks
