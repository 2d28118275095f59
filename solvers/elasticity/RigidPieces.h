#pragma once

#include "elasticity/PieceMotions.h"

#include <Eigen/Dense>

#include <vector>

namespace lamella::elasticity
{

/// Pieces that do not strain: their nodes move as bodies. A constraint, kept by projecting what conjugate gradients
/// work with; the pieces' elements have no stiffness of their own in the product.
template <int D>
class RigidPieces
{
public:
  /// @param rigid by phase id
  /// @throws ParameterError where one goes through the whole of a periodic box, or touches a side that is held
  RigidPieces(const ElasticGrid<D>& grid, std::span<const std::uint8_t> phase, const std::vector<bool>& rigid);

  [[nodiscard]] std::size_t bytes() const noexcept { return motion_.bytes(); }
  /// u = −E d of the pieces' nodes: with the mean strain E they rest.
  template <class Real>
  void start(const std::array<double, 6>& strain, int threads, Real* u) const;
  /// v becomes Z (Zᵀ Z)⁻¹ Zᵀ v on the pieces' nodes.
  template <class Real>
  void project(Real* v, int threads) const;
  /// Σ −f ⊗ d of forces f that hold the pieces' nodes, symmetric part, Voigt's order: what the pieces' stresses sum to.
  template <class Real>
  [[nodiscard]] std::array<double, voigtSize(D)> stress(const Real* forces) const;

private:
  PieceMotions<D> motion_;
  std::vector<Eigen::Matrix<double, PieceMotions<D>::motions, PieceMotions<D>::motions>> inverse_;
};

} // namespace lamella::elasticity
