#pragma once

#include "peridynamics/BondLattice.h"
#include "peridynamics/NodeField.h"
#include "peridynamics/multigrid/LayerShare.h"

#include <Eigen/Dense>

#include <cstdint>
#include <vector>

namespace lamella::peridynamics
{

/// Displacements that conjugate gradients were slow to find, kept to be taken out at once when they come again: a piece
/// that hangs by a few bonds turns with little force, a multigrid cycle knows nothing of it, and every break moves it.
/// Deflation with recycled vectors (Erhel and Guyomarc'h, SIAM J. Matrix Anal. Appl. 21 (2000) 1279).
///
/// With W the motions and E = Wᵀ A W: W E⁻¹ Wᵀ, an inverse of A on their span. A broken bond changes E by rank one.
class SlowMotions
{
public:
  /// @param share of the layers, by ranks that each have all the bonds; must outlive this
  SlowMotions(const BondLattice& bonds, const LayerShare& share);

  [[nodiscard]] bool empty() const noexcept { return motions_.empty(); }
  void clear();
  /// x += W E⁻¹ Wᵀ r: what the motions make of a residual force; own layers.
  void answer(const NodeField<float>& r, NodeField<float>& x);
  /// Takes another one up, zero where components are fixed, in place of the oldest where there is no room.
  /// @param motion on all layers
  /// @param work overwritten
  void keep(NodeField<float> motion, NodeField<float>& work);
  /// @param stiffness k/|ξ| of a bond that is there no longer
  void breakBond(std::int64_t index, int offset, double stiffness);
  [[nodiscard]] std::int64_t bytes() const noexcept;

private:
  /// Wᵀ r.
  [[nodiscard]] Eigen::VectorXd along(const NodeField<float>& r);

  const BondLattice& bonds_;
  const LayerShare& share_;
  std::vector<NodeField<float>> motions_;
  Eigen::MatrixXd energy_; ///< E
  Eigen::VectorXd first_;  ///< of its diagonal, when it was measured
  std::size_t oldest_ = 0;
  std::vector<double> sums_; ///< by row and motion
};

} // namespace lamella::peridynamics
