#pragma once

#include "core/Communicator.h"
#include "mpm/BackgroundGrid.h"
#include "mpm/BodyContact.h"
#include "mpm/MaterialPoints.h"
#include "mpm/PointLaw.h"

#include <functional>
#include <optional>
#include <vector>

namespace lamella::mpm
{

/// How fast the fastest oscillation of points on quadratic splines with lumped mass is: ω² = κ a/(ρ h²), with a the
/// stiffness of waves and h the smallest spacing. κ is the greatest eigenvalue of M⁻¹K h²/a, K = Σ m/ρ Bᵀ C B and
/// M = Σ m N over the points, C isotropic with the law's resistance to a change of volume. It depends on where the
/// points lie in their cells: evenly filled ones have 3 or so, outlines of tissue up to 5.
template <int Dim>
class WaveFactor
{
public:
  /// @param bulk greatest eigenvalue of C over a: see bulkRatio()
  explicit WaveFactor(double bulk);
  /// Power iteration, from where the last call ended. Comes near from below: within 6 % after 24 passes.
  /// @param points of this rank  @param grid of all: each rank takes 8 (3 Dim + 1) bytes a node and body
  /// @param bodies that are not joined
  /// @param stop asked before each pass, the same on all ranks  @return none where it stopped: it is then as before.
  /// Collective
  [[nodiscard]] std::optional<double> measure(const MaterialPoints<Dim>& points, const BackgroundGrid<Dim>& grid,
    const Bodies& bodies, int passes, const Communicator& comm, const std::function<bool()>& stop);
  /// By node of the last grid, where the last call ended; nothing before the first.
  [[nodiscard]] const std::vector<double>& field() const noexcept { return field_; }
  /// Goes on from there. @param field of another number of nodes counts for nothing
  void takeBack(std::vector<double> field) { field_ = std::move(field); }

private:
  double lame_;               ///< λ/a
  double shear_;              ///< μ/a
  std::vector<double> field_; ///< by node, the eigenvector times the root of its mass
};

/// The greatest resistance of a law at rest against a strain of any form, over that against waves (stiffness()): the
/// greatest eigenvalue of C. 1/(1 − ν) or so in a plane, (1 + ν)/(1 − ν) in space. Of all phases.
template <int Dim>
[[nodiscard]] double bulkRatio(const PointLaw<Dim>& law);

/// The least resistance of a phase at rest against a strain of any form: the least eigenvalue of C [Pa], 2 μ of most.
template <int Dim>
[[nodiscard]] double leastResistance(const PointLaw<Dim>& law, std::size_t phase);

extern template class WaveFactor<2>;
extern template class WaveFactor<3>;

} // namespace lamella::mpm
