#pragma once

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

/// Internal: symmetric matrices of grains that touch their neighbours and of the box around all of them, and their
/// Cholesky factors. Entries are blocks of Dim × Dim, so that a grain is one index, not Dim.
namespace lamella::packing
{

/// Lower triangle by blocks. Unknowns: Dim a grain, then up to Dim of the box.
template <int Dim>
struct BlockMatrix
{
  using Block = Eigen::Matrix<double, Dim, Dim>;

  std::vector<Block> diagonal;                    ///< #grains
  std::vector<std::array<std::int32_t, 2>> links; ///< of coupled grains, the first below the second, each pair once
  std::vector<Block> coupling;                    ///< #links: rows of the second, columns of the first
  std::vector<Block> border;                      ///< #grains: rows of the grain, columns of the box
  Block corner = Block::Identity();               ///< of the box; the identity for unknowns that it does not have
};

template <int Dim>
class BlockCholesky
{
public:
  using Block = typename BlockMatrix<Dim>::Block;

  /// Where the factors of a matrix with these links have entries. The order of elimination (minimum degree) is kept
  /// from one set of links to the next as long as it makes few entries.
  void analyse(std::size_t grains, const std::vector<std::array<std::int32_t, 2>>& links);

  /// Factors of matrix + shift × identity, whose links are those of analyse(). The border is eliminated last.
  /// @returns false: it is not positive definite
  [[nodiscard]] bool factorise(const BlockMatrix<Dim>& matrix, double shift);

  /// @param right Dim a grain, then `box` unknowns, Dim at most
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& right, Eigen::Index box) const;

  /// Blocks of the factors below their diagonal.
  [[nodiscard]] std::size_t entries() const noexcept { return row_.size(); }

private:
  void order(std::size_t grains, const std::vector<std::array<std::int32_t, 2>>& links);
  void findEntries(std::size_t grains, const std::vector<std::array<std::int32_t, 2>>& links);

  std::vector<std::int32_t> place_; ///< by grain: when it is eliminated
  std::vector<std::int32_t> grain_; ///< by place
  std::size_t entriesWhenOrdered_ = 0;
  std::vector<std::int32_t> begin_;  ///< by column, and the end: into row_ and value_
  std::vector<std::int32_t> row_;    ///< of the blocks below the diagonal, rising within a column
  std::vector<std::int32_t> slot_;   ///< by link: where its block goes
  std::vector<std::uint8_t> turned_; ///< by link: the second is eliminated before the first
  std::vector<Block> value_;
  std::vector<Block> inverse_; ///< by column: of the triangular block on the diagonal
  std::vector<Block> border_;  ///< by column: its rows of L⁻¹ × border
  Block corner_ = Block::Identity();
  std::vector<Block> work_;
  std::vector<std::int32_t> next_;
  std::vector<std::int32_t> nextColumn_;
  std::vector<std::int32_t> firstColumn_;
};

extern template class BlockCholesky<2>;
extern template class BlockCholesky<3>;

} // namespace lamella::packing
