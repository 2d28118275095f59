#pragma once

#include "lbm/lean/LeanField.h"
#include "lbm/lean/PieceHalo.h"
#include "lbm/lean/PieceMove.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace lamella::lbm
{

/// One level of pieces: unknowns block by block, and the links between them. Of this rank's part: `other`, `coarse`
/// and `x` go on with the unknowns of its neighbours (PieceHalo); all of them are numbered within the rank.
struct PieceLevel
{
  static constexpr std::uint32_t none = ~std::uint32_t{ 0 };

  std::array<std::int64_t, 3> blocks{ 1, 1, 1 };
  std::array<std::int64_t, 3> begin{ 0, 0, 0 }; ///< of this rank's blocks in the level's
  std::array<std::int64_t, 3> all{ 1, 1, 1 };   ///< the level's
  int depth = 1;                                ///< halvings from the nodes to its blocks
  bool shared = false;                          ///< the ranks have parts of it; else each has the whole
  std::shared_ptr<const Decomposition> parts;   ///< which
  int halvings = 1;                             ///< from what `parts` shares out to its blocks
  bool gathered = false;                        ///< the next level is the same, whole on every rank
  std::unique_ptr<PieceMove> moved;             ///< the next level is the same, shared out anew
  PieceHalo halo;
  std::vector<std::uint32_t> start; ///< the first unknown of each block, and their number
  std::vector<std::uint32_t> row;   ///< an unknown's first link, and their number
  std::vector<std::uint32_t> other;
  std::vector<std::uint16_t> link;   ///< the upper half of a float: eight bits are enough for a correction
  std::vector<float> wall;           ///< links to fixed faces
  std::vector<float> inverse;        ///< 1 / Σ links and walls; 0 where there are none
  std::vector<std::uint32_t> coarse; ///< the unknown of the next level that this one is part of, or none
  std::vector<float> x;              ///< correction
  std::vector<float> b;              ///< right-hand side
  std::array<std::vector<float>, 3> work;

  [[nodiscard]] float linkAt(std::size_t e) const noexcept
  {
    return std::bit_cast<float>(static_cast<std::uint32_t>(link[e]) << 16);
  }
  /// Rounded to nearest.
  [[nodiscard]] static std::uint16_t packed(float link) noexcept
  {
    return static_cast<std::uint16_t>((std::bit_cast<std::uint32_t>(link) + 0x8000U) >> 16);
  }
  [[nodiscard]] std::size_t count() const noexcept { return start.empty() ? 0 : start.back(); }
  [[nodiscard]] std::size_t withGhosts() const noexcept { return count() + halo.count(); }
  /// Blocks that a rank has.
  [[nodiscard]] Block block(int rank) const;
  /// Frees what only relaxing takes.
  void dropMatrix();
  [[nodiscard]] std::size_t bytes() const noexcept;
};

/// How many values each rank has, and where they begin among all.
struct RankShares
{
  std::vector<int> counts;
  std::vector<int> starts; ///< and their number
};

/// Coarse levels for a lean field whose phases insulate in thin walls, or do not conduct at all: where a block of
/// 2 × 2 × 2 nodes would join what is apart, each piece of it is an unknown of its own. A piece is what strong links
/// join inside the block: on the finest level links between phases that conduct alike, further down links that are a
/// part of the strongest one at both their ends, a part that is halved from level to level; and what hangs on one other
/// piece of the block by nearly all its links. Links between pieces follow the rule of blocks (Multigrid). Each level
/// is entered twice, with two steps of conjugate gradients (K-cycle: Notay & Vassilevski, Numer. Linear Algebra Appl.
/// 15 (2008) 473).
///
/// Distributed as the lattice is, as long as every part begins at an even block; then shared out anew, or, where that
/// is not worth its messages, gathered: every rank does the rest for itself. Every number of ranks has the same pieces,
/// up to periodic sides with an odd number of blocks and to parts that can be halved but once, which have blocks of two
/// nodes along each axis where others have four. Every number of threads gives the same.
///
/// Memory: 36 bytes a piece, 6 a link, 4 a block; 0.5 to 1 byte a node of the finest level.
class PieceMultigrid
{
public:
  /// Of the finest level's blocks, in nodes.
  static constexpr std::int64_t mostEdge = 4;
  /// Collective. @param field outlives this
  PieceMultigrid(const LeanField& field, int threads);

  /// One cycle for the field's residual, added to the field. After forward sweeps.
  void correct(LeanField& field);
  [[nodiscard]] std::size_t bytes() const noexcept;
  /// Sweeps of the field that go well with it, before and after.
  [[nodiscard]] int sweeps() const noexcept { return edge_ == 2 ? 3 : 8; }
  /// Of the energy's excess a cycle may leave that much.
  [[nodiscard]] double slowest() const noexcept { return edge_ == 2 ? 0.5 : 0.75; }

private:
  /// Links of at least this part of the strongest ones join nodes; halved from level to level.
  static constexpr double strongPart = 0.25;

  /// @param edge of a block, in nodes
  void label(const LeanField& field, std::int64_t edge);
  void hangPieces(const LeanField& field, const std::array<std::int64_t, 3>& block, std::span<const int> id,
    std::span<std::uint8_t> parent) const;
  template <class Gather>
  void link(PieceLevel& level, const Gather& gather) const;
  void linkFirst(const LeanField& field);
  [[nodiscard]] bool coarsen(double strong);
  /// The same level shared out so that it can be halved again. Returns whether it can.
  [[nodiscard]] bool move();
  void gather();
  void factorize();
  [[nodiscard]] Eigen::VectorXd levelled(Eigen::VectorXd v) const;
  void cycle(std::size_t index);
  void cycleTwice(std::size_t index);
  void relax(PieceLevel& level, bool forward) const;
  [[nodiscard]] static float product(const PieceLevel& level, std::size_t i);
  /// Sums of the products of two vectors each, of this rank, in an order that no number of threads changes.
  using Vectors = std::array<const std::vector<float>*, 2>;
  template <std::size_t N>
  [[nodiscard]] std::array<double, N> products(const PieceLevel& level, const std::array<Vectors, N>& pairs) const;
  /// Over the ranks that have parts of a level.
  void sumUp(const PieceLevel& level, std::span<double> sums) const;
  /// All ranks' unknowns of a level.
  [[nodiscard]] std::int64_t total(const PieceLevel& level) const;
  /// Along which axes this rank's part of a level meets itself.
  [[nodiscard]] std::array<bool, 3> wraps(const PieceLevel& level) const;
  /// Block rows in parallel.
  template <class F>
  void forBlockRows(const std::array<std::int64_t, 3>& blocks, F&& f) const;
  /// f(bx, by, bz, place in the order of blocks)
  template <class F>
  void forBlocks(const std::array<std::int64_t, 3>& blocks, F&& f) const;

  const Level* lattice_; ///< how it is shared out
  std::array<bool, 3> periodic_;
  int axis_;
  int threads_;
  bool everyLink_ = false;            ///< only phases that do not conduct keep pieces apart
  std::int64_t edge_ = 2;             ///< of the finest level's blocks, in nodes
  std::vector<std::uint32_t> labels_; ///< of each block's nodes, four bits each; 15: it is part of no piece
  std::vector<PieceLevel> levels_;
  std::vector<std::uint32_t> places_; ///< in the gathered level, of the ranks' unknowns in their order
  std::vector<std::uint32_t> own_;    ///< the same of this rank's and its ghosts
  RankShares shares_;                 ///< of those unknowns
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> direct_;
  bool factorized_ = false;
  std::vector<std::uint32_t> free_; ///< of the coarsest unknowns: in which set whose constant is free, or none
};

} // namespace lamella::lbm
