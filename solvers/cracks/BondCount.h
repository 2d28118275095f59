#pragma once

#include "cracks/CutBond.h"

#include <array>
#include <cstdint>
#include <map>
#include <span>

namespace lamella::cracks
{

/// How large cracks are, from nothing but how many bonds of each direction and length they cut: Cauchy and Crofton's
/// formula for a lattice. A crack element of size dA and normal n cuts |ξ · n| dA bonds of step ξ, for there is one
/// such bond a node. With weights for which Σ w(ξ) |ξ · n| = 1 for all n, the sum over the steps of one half of the
/// stencil, a smooth crack that cut all bonds across it has the size Σ w(ξ) over its broken bonds, whatever its shape.
/// On a lattice of few directions that holds but nearly; anisotropy() says how nearly.
class BondCount
{
public:
  /// The weights are nearest to being proportional to 1/|ξ| among those that make the sum 1 in the least-squares sense
  /// over all n, equal for steps that symmetries of the lattice turn into each other.
  /// @throws ParameterError as peridynamics::Stencil
  BondCount(int dimension, double horizon);

  /// In spacings; of a step or its opposite. 0 for a step beyond the horizon.
  [[nodiscard]] double weight(const std::array<int, 3>& step) const;
  /// Largest |Σ w(ξ) |ξ · n| − 1| over all n.
  [[nodiscard]] double anisotropy() const noexcept { return anisotropy_; }
  /// Length in spacings, in space area in squares of them.
  [[nodiscard]] double size(std::span<const CutBond> bonds) const;
  /// Mean of n ⊗ n over the cracks, by rows: (d + 1)/A Σ w(ξ) e ⊗ e − 1, with e = ξ/|ξ|; its trace is 1. Zero without
  /// bonds.
  [[nodiscard]] std::array<double, 9> normals(std::span<const CutBond> bonds) const;

private:
  int dimension_;
  std::map<std::array<int, 3>, double> weights_; ///< by the steps' absolute values in order
  double anisotropy_ = 0;
};

} // namespace lamella::cracks
