#pragma once

#include "lattice/Lattice.h"
#include "lbm/LinkTable.h"
#include "lbm/SteadyDiffusion.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lamella::lbm
{

/// Two halves of a link in series, 0 where either does not conduct. The product of two tiny values would underflow.
[[nodiscard]] inline double harmonicMean(double a, double b) noexcept
{
  return a > 0.0 && b > 0.0 ? 2.0 * (a / (a + b)) * b : 0.0;
}

/// What lies beyond the outer nodes along an axis.
enum class Boundary
{
  Fixed,     ///< value 1 half a spacing below the first node, 0 half a spacing above the last
  Insulated, ///< no flux; diagonal links are reflected specularly
  Periodic
};

struct Direction
{
  int x = 0;
  int y = 0;
  int z = 0;
  [[nodiscard]] int operator[](int axis) const noexcept { return axis == 0 ? x : axis == 1 ? y : z; }
  [[nodiscard]] int axes() const noexcept { return (x != 0) + (y != 0) + (z != 0); }
  /// Of a straight one; of others the first.
  [[nodiscard]] int axis() const noexcept { return x != 0 ? 0 : y != 0 ? 1 : 2; }
};

/// The links of the steady state of two-relaxation-time lattice Boltzmann with Λ⁺Λ⁻ = ¼: between nodes r and r' the
/// conductance 6 w_q · 2DD'/(D + D'), to a wall value half-way 12 w_q D. Straight links weigh 1 on D2Q5 and D3Q7
/// (w_q = 1/6), 2/3 on D2Q9, 1/3 on D3Q19; diagonal ones 1/6.
///
/// Where spacings differ between axes, links along a carry the factor (δ_x / δ_a)²: area over length, over that of the
/// links along x, with the volume of a voxel taken off. Straight links only.
class Links
{
public:
  /// @param table conductivities instead of the harmonic means (D2Q5; D2Q9 with diagonals), or null; it is copied
  /// @param pairs the same by the ids at both ends, or null
  Links(const Lattice& lattice, Stencil stencil, std::array<Boundary, 3> boundary, std::span<const double> diffusivity,
    const LinkTable* table = nullptr, const PairTable* pairs = nullptr);

  /// Half of the directions: each link once.
  [[nodiscard]] const std::vector<Direction>& forward() const noexcept { return forward_; }
  /// All directions.
  [[nodiscard]] const std::vector<Direction>& all() const noexcept { return all_; }
  [[nodiscard]] Boundary boundary(int axis) const noexcept { return boundary_[axis]; }
  [[nodiscard]] std::int64_t size(int axis) const noexcept { return size_[axis]; }
  [[nodiscard]] int dimension() const noexcept { return dimension_; }

  /// Share of the harmonic mean that the link in direction d from the node at global position p carries, reflections
  /// at insulated sides added to the straight links; 0 when the link leaves the box. Symmetric in its two ends.
  [[nodiscard]] double weight(const Direction& d, const std::array<std::int64_t, 3>& p) const noexcept
  {
    for (int a = 0; a < dimension_; ++a)
    {
      const std::int64_t q = p[a] + d[a];
      if ((q < 0 || q >= size_[a]) && boundary_[a] != Boundary::Periodic)
        return 0.0;
    }
    if (d.axes() == 2)
      return diagonal_;
    double w = straight_ * factor_[static_cast<std::size_t>(d.axis())];
    if (diagonal_ != 0.0)
      for (int a = 0; a < dimension_; ++a)
        if (d[a] == 0 && boundary_[a] == Boundary::Insulated)
          w += diagonal_ * ((p[a] == 0) + (p[a] == size_[a] - 1));
    return w;
  }

  /// Conductance, scaled by scale(), of the link of node (0, y) of the whole lattice in a direction, those of the nodes
  /// (x, y) x further; null without a table. Links to the faces are half as long: they carry twice that.
  [[nodiscard]] const double* given(const Direction& d, std::int64_t y) const noexcept
  {
    return given_.x.empty() ? nullptr : given_.row(d.x, d.y, y);
  }
  /// Does this node of the whole lattice have a link that conducts?
  [[nodiscard]] bool conducts(std::uint8_t phase, std::int64_t x, std::int64_t y) const noexcept
  {
    if (given_.x.empty())
      return conducts(phase);
    return std::any_of(all_.begin(), all_.end(), [&](const Direction& d) { return given(d, y)[x] > 0.0; });
  }
  /// Does the link in direction d from this node of the whole lattice conduct, provided that both its ends do?
  [[nodiscard]] bool open(const Direction& d, std::int64_t x, std::int64_t y) const noexcept
  {
    return given_.x.empty() || given(d, y)[x] > 0.0;
  }

  /// Harmonic mean of the diffusivities of two phase ids, or what the table of pairs says of links along an axis,
  /// scaled by scale().
  [[nodiscard]] double mean(std::uint8_t a, std::uint8_t b, int axis) const noexcept
  {
    return table_[table(axis) * phases_ * phases_ + static_cast<std::size_t>(a) * phases_ + b];
  }
  /// How many tables of pairs there are: one, or one an axis.
  [[nodiscard]] std::size_t tables() const noexcept { return byAxis_ ? 3 : 1; }
  /// Which of them is that of links along an axis.
  [[nodiscard]] std::size_t table(int axis) const noexcept { return byAxis_ ? static_cast<std::size_t>(axis) : 0; }
  /// Diffusivity of a phase id, scaled by scale().
  [[nodiscard]] double diffusivity(std::uint8_t a) const noexcept { return diffusivity_[a]; }
  /// Conductance of a node to the wall value on a fixed face: 12 D Σ w_q = 2 D on every stencil.
  [[nodiscard]] double wall(std::uint8_t a, int axis) const noexcept { return 2.0 * factor_[axis] * diffusivity_[a]; }
  /// The same where a table may say otherwise.
  /// @param phase of the node  @param p its position in the whole lattice  @param axis, high which face
  [[nodiscard]] double wall(
    std::uint8_t phase, const std::array<std::int64_t, 3>& p, int axis, bool high) const noexcept
  {
    if (given_.x.empty())
      return wall(phase, axis);
    const int step = high ? 1 : -1;
    return 2.0 * given_.row(axis == 0 ? step : 0, axis == 0 ? 0 : step, p[1])[p[0]];
  }
  /// (δ_x / δ_axis)²
  [[nodiscard]] double factor(int axis) const noexcept { return factor_[axis]; }
  /// Largest diffusivity: everything inside is divided by it.
  [[nodiscard]] double scale() const noexcept { return scale_; }
  [[nodiscard]] bool conducts(std::uint8_t a) const noexcept { return diffusivity_[a] > 0.0; }

private:
  int dimension_;
  bool byAxis_;
  std::array<std::int64_t, 3> size_;
  std::array<Boundary, 3> boundary_;
  std::array<double, 3> factor_{ 1, 1, 1 };
  double straight_ = 1.0;
  double diagonal_ = 0.0;
  double scale_ = 1.0;
  std::size_t phases_ = 0;
  std::vector<double> diffusivity_;
  std::vector<double> table_;
  LinkTable given_; ///< scaled; empty without one
  std::vector<Direction> forward_;
  std::vector<Direction> all_;
};

/// Sums over the links of a field, over this rank's nodes until summed over ranks. In lattice units, diffusivity
/// scaled.
struct FieldSums
{
  double energy = 0;                     ///< Σ g (Δu)², walls included
  double inlet = 0;                      ///< flux through the face of value 1 (periodic: through the low face)
  double outlet = 0;                     ///< flux through the face of value 0 (periodic: half-way across)
  std::array<double, 3> flux{ 0, 0, 0 }; ///< Σ g Δu d, the sum over nodes of the nodes' flux
  double residual2 = 0;                  ///< Σ residual²
};

} // namespace lamella::lbm
