#pragma once

#include "mpm/BackgroundGrid.h"
#include "mpm/Tensor.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lamella::mpm
{

/// The velocities of the grid that moved points last. A point that has kept its velocity v came from x − Δt v, and what
/// splines spread of the grid's velocities there is its affine velocity C: the points need not store it. (The round-off
/// of x, of some 10⁻¹⁴ spacings, is what C is off by, times the second derivative of the velocity.)
template <int Dim>
class PastVelocity
{
public:
  [[nodiscard]] bool known() const noexcept { return known_; }
  void forget() noexcept { known_ = false; }
  /// @param dt by which the points moved [s]
  void set(const BackgroundGrid<Dim>& grid, double dt);
  /// What a change of the points' velocities, from v to keep v + rate (x − still) along an axis, makes of it; x is
  /// where they are now.
  /// @param nodes as affine() takes them, of all bodies
  void change(double keep, int axis, double rate, double still, std::span<double> nodes);
  /// C of a point [1/s]; 0 of one that is not finite or so far off that no step can have brought it.
  /// @param nodes of its body: four values each, the first unused, then the velocity [m/s]
  [[nodiscard]] Matrix<Dim> affine(const Vector<Dim>& x, const Vector<Dim>& v, const double* nodes) const;

  /// As numbers for a checkpoint: of each axis five, then Δt.
  [[nodiscard]] std::vector<double> numbers() const;
  /// @return whether they fit a grid of as many nodes
  bool take(std::span<const double> numbers, std::int64_t nodes);

private:
  bool known_ = false;
  BackgroundGrid<Dim> grid_;
  double move_ = 0;    ///< x − move (v − rate x − offset) is where a point was
  Vector<Dim> rate_{}; ///< of what was added to the points' velocities since
  Vector<Dim> offset_{};
};

extern template class PastVelocity<2>;
extern template class PastVelocity<3>;

} // namespace lamella::mpm
