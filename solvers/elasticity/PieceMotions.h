#pragma once

#include "elasticity/ElasticOperator.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lamella::elasticity
{

/// Connected pieces of some phases in a box of elements, and displacements of their nodes that are affine in each:
/// u = shift + slope · d, with d from the piece's centre. Voxels that share a node belong together.
///
/// Every rank knows all pieces; forces and displacements are those of the planes that it has.
///
/// Memory: 16 bytes a run of nodes along x, 4 more where some piece is as long as the periodic box.
template <int D>
class PieceMotions
{
public:
  static constexpr int corners = 1 << D;
  static constexpr int motions = D == 3 ? 6 : 3; ///< of a rigid body: shifts, then turns about x, y, z; or about z
  using Motions = Eigen::Matrix<double, motions, 1>;

  struct Piece
  {
    std::array<double, D> low{};    ///< its first node along each axis; below 0 of some that are longer than the box
    std::array<double, D> centre{}; ///< from there on [edges of a voxel along x]
    bool endless = false;           ///< meets itself again
    bool held = false;              ///< has nodes that sides hold
  };
  /// Of a piece, shift and slope of its displacements; or of forces on its nodes Σ f and Σ f ⊗ d.
  struct Affine
  {
    Eigen::Matrix<double, D, 1> shift = Eigen::Matrix<double, D, 1>::Zero();
    Eigen::Matrix<double, D, D> slope = Eigen::Matrix<double, D, D>::Zero();
  };
  [[nodiscard]] static Affine affineOf(const Motions& rigid);
  /// Of forces: what does their work in rigid motions.
  [[nodiscard]] static Motions workOf(const Affine& forces);

  /// @param chosen      by phase id
  /// @param leastVoxels of a piece; smaller ones are none
  /// @param mostPieces  the largest of them
  PieceMotions(const ElasticGrid<D>& grid, std::span<const std::uint8_t> phase, const std::vector<bool>& chosen,
    std::int64_t leastVoxels, std::size_t mostPieces);

  [[nodiscard]] const std::vector<Piece>& pieces() const noexcept { return pieces_; }
  [[nodiscard]] std::size_t bytes() const noexcept;

  /// Σ f and Σ f ⊗ d of each piece, in one order. Collective.
  template <class Real>
  [[nodiscard]] std::vector<Affine> moments(const Real* forces) const;
  /// The same of forces that are known row by row, each plane by one thread.
  class Sums
  {
  public:
    explicit Sums(const PieceMotions& pieces);
    /// @param forces one component after the other, of a row's nodes from the first on
    void add(std::int64_t row, std::int64_t plane, const float* const* forces);
    [[nodiscard]] std::vector<Affine> total() const; ///< collective

  private:
    const PieceMotions& pieces_;
    std::vector<std::vector<Affine>> planes_; ///< by the plane's own list of pieces
  };
  /// How many nodes each has, Σ d and Σ d ⊗ d.
  struct Inertia
  {
    double nodes = 0;
    Eigen::Matrix<double, D, 1> first = Eigen::Matrix<double, D, 1>::Zero();
    Eigen::Matrix<double, D, D> second = Eigen::Matrix<double, D, D>::Zero();
  };
  [[nodiscard]] std::vector<Inertia> inertia() const;
  /// Displacements of the pieces' nodes, instead of those that u has, or added to them; held ones excepted.
  template <class Real>
  void place(std::span<const Affine> motion, bool add, int threads, Real* u) const;
  /// Of each node of its own, x fastest: the place among all of the run that has it; −1: of no piece.
  [[nodiscard]] std::vector<std::int32_t> owners() const;
  [[nodiscard]] std::int32_t pieceOf(std::int32_t owner) const { return runs_[static_cast<std::size_t>(owner)].piece; }
  /// d of an owner's node, nodes beyond the last of a periodic axis being the first ones.
  [[nodiscard]] Eigen::Matrix<double, D, 1> fromCentre(
    std::int32_t owner, const std::array<std::int64_t, D>& node) const;

private:
  // Nodes of one piece that follow each other along x, all of them on one side of the piece's first node.
  struct Run
  {
    std::int32_t piece = 0;
    std::int32_t first = 0;
    std::int32_t count = 0;
    std::int32_t local = 0; ///< place of the piece in its plane's list
  };
  // Of pieces as long as the periodic box, whose nodes' places do not tell them apart from their neighbours' copies: by
  // voxel of the box the one that it is, counted from the piece's first.
  struct Images
  {
    std::vector<bool> along;        ///< by piece: it has some
    std::vector<std::int32_t> code; ///< by voxel, 0: of no such piece; empty: there is none
  };
  void labelImages(Images& images, std::span<const std::int32_t> labels);
  template <class F>
  void forRuns(std::int64_t plane, F&& f) const;
  template <class F>
  void forRunsOfRow(std::int64_t row, std::int64_t plane, F&& f) const;
  template <class Real>
  void addMoments(
    const Run& run, const Eigen::Matrix<double, D, 1>& d, const std::array<const Real*, D>& forces, Affine& sum) const;

  ElasticGrid<D> grid_;
  std::array<double, D> edge_{};
  std::vector<Piece> pieces_;
  std::vector<Run> runs_;
  std::vector<std::int32_t> images_;             ///< by run, as Images::code; empty: all 0
  std::vector<std::size_t> begin_;               ///< of the runs of each row of nodes
  std::vector<std::vector<std::int32_t>> lists_; ///< the pieces of each plane
};

} // namespace lamella::elasticity
