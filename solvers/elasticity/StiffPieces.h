#pragma once

#include "elasticity/PieceMotions.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace lamella::elasticity
{

/// A coarse space for stiff pieces in a soft matrix (grains in cement, filled cells between thin walls): each piece's
/// rigid motions, which coarse elements that hold several pieces do not know: deflation by rigid bodies (Jönsthövel,
/// van Gijzen, Vuik, Kasbergen & Scarpas, Comput. Mech. 49 (2012) 757), after multigrid and from a start without forces
/// on the pieces (A-DEF2 of Tang, Nabben, Vuik & Erlangga, J. Sci. Comput. 39 (2009) 340).
template <int D>
class StiffPieces
{
public:
  static constexpr int corners = 1 << D;
  static constexpr int bodyMotions = PieceMotions<D>::motions;
  using ElementMatrix = Eigen::Matrix<double, D * corners, D * corners>; ///< component by component, corners as bits

  /// @param stiff   by phase id
  /// @param element by phase id: the stiffness of an element of that phase
  StiffPieces(const ElasticGrid<D>& grid, std::span<const std::uint8_t> phase, const std::vector<bool>& stiff,
    const std::function<ElementMatrix(std::uint8_t id)>& element);

  [[nodiscard]] std::size_t pieces() const noexcept { return motion_.pieces().size(); }
  /// u += Z (Zᵀ A Z)⁻¹ Zᵀ f.
  template <class Real>
  void add(std::vector<typename PieceMotions<D>::Affine> forces, int threads, Real* u) const;
  /// Forces on each piece.
  [[nodiscard]] std::vector<typename PieceMotions<D>::Affine> forces(const float* r) const
  {
    return motion_.moments(r);
  }
  [[nodiscard]] const PieceMotions<D>& motions() const noexcept { return motion_; }
  [[nodiscard]] std::size_t bytes() const noexcept { return motion_.bytes(); }

private:
  void assemble(std::span<const std::uint8_t> phase, const std::vector<bool>& stiff,
    const std::function<ElementMatrix(std::uint8_t)>& element);
  /// How many motions of a piece are used: shifts alone where it meets itself again.
  [[nodiscard]] int motionsOf(std::size_t piece) const { return motion_.pieces()[piece].endless ? D : bodyMotions; }

  ElasticGrid<D> grid_;
  PieceMotions<D> motion_;
  std::vector<std::int64_t> first_; ///< unknown of each piece; last: how many there are
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
};

} // namespace lamella::elasticity
