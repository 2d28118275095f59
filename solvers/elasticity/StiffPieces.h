#pragma once

#include "elasticity/ElasticOperator.h"

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
/// rigid motions, which coarse elements that hold several pieces do not know. What it corrects is added to what
/// multigrid corrects: deflation by rigid bodies as Jönsthövel, van Gijzen, Vuik, Kasbergen & Scarpas, Comput. Mech. 49
/// (2012) 757, but additive.
///
/// Memory: 4 bytes a node.
template <int D>
class StiffPieces
{
public:
  static constexpr int corners = 1 << D;
  static constexpr int motions = D == 3 ? 6 : 3;
  using ElementMatrix = Eigen::Matrix<double, D * corners, D * corners>; ///< component by component, corners as bits

  /// @param stiff   by phase id
  /// @param element by phase id: the stiffness of an element of that phase
  StiffPieces(const ElasticGrid<D>& grid, std::span<const std::uint8_t> phase, const std::vector<bool>& stiff,
    const std::function<ElementMatrix(std::uint8_t id)>& element);

  [[nodiscard]] std::int64_t pieces() const noexcept { return static_cast<std::int64_t>(pieces_.size()); }
  /// z += Z (Zᵀ A Z)⁻¹ Zᵀ r.
  void add(const float* r, float* z, int threads) const;
  [[nodiscard]] std::size_t bytes() const noexcept { return owner_.size() * sizeof(owner_[0]); }

private:
  struct Piece
  {
    std::array<double, 3> centre{};
    std::int64_t first = 0; ///< unknown
    int motions = D;        ///< translations alone where it meets itself again, or reaches through half of the box
  };
  using Basis = Eigen::Matrix<double, D, motions>;

  void findOwners(std::span<const std::uint8_t> phase, const std::vector<bool>& stiff);
  void assemble(std::span<const std::uint8_t> phase, const std::function<ElementMatrix(std::uint8_t)>& element);
  /// Displacements of a place by a piece's motions.
  [[nodiscard]] Basis basis(const Piece& piece, const std::array<double, 3>& place) const;
  [[nodiscard]] std::int64_t node(std::int64_t x, std::int64_t y, std::int64_t z) const;

  ElasticGrid<D> grid_;
  std::array<double, 3> period_{};  ///< 0: none
  std::vector<std::int32_t> owner_; ///< by node of its own, x fastest: number of its piece, −1: none
  std::vector<Piece> pieces_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
};

} // namespace lamella::elasticity
