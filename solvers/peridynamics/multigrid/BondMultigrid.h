#pragma once

#include "peridynamics/BondLattice.h"
#include "peridynamics/multigrid/CoarsestLevel.h"
#include "peridynamics/multigrid/Galerkin.h"
#include "peridynamics/multigrid/Level.h"
#include "peridynamics/multigrid/MultigridOptions.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace lamella::peridynamics
{

/// Where a bond is felt: k/|ξ| (Σ c u·e)² is twice its energy, with the weights c of a level's nodes.
struct SpringWeights
{
  struct Node
  {
    std::array<std::int64_t, 3> node{}; ///< of the level
    double weight = 0;
  };
  double stiffness = 0;              ///< k/|ξ|
  std::array<double, 3> direction{}; ///< e
  std::vector<std::vector<Node>> levels;
};

/// Symmetric multigrid cycle for the linearised equilibrium of a bond lattice, in single precision: a preconditioner
/// for conjugate gradients.
///
/// The finest level has no matrix: its product goes through the bonds. Coarser ones are Galerkin products with bilinear
/// (trilinear) interpolation, so they know of every void, notch and broken bond there was when they were made; blocks
/// of a node that has no stiffness in some direction (a hinge, a hanging node) are inverted where they can be.
/// Smoothing is by Chebyshev polynomials of the fourth kind (Lottes, Numer. Linear Algebra Appl. 30 (2023) e2518) of
/// D⁻¹A with the blocks D of the nodes. The coarsest level is solved with the pseudo-inverse of its matrix.
class BondMultigrid
{
public:
  static constexpr std::size_t maxLevels = 32;

  /// @param fixed see FixedComponents; must outlive this, as must the bonds
  /// @param work a field of the bonds' layout that this may overwrite at any time, in place of one of its own; must
  /// outlive this where it is given
  BondMultigrid(const BondLattice& bonds, const FixedComponents& fixed, const MultigridOptions& options = {},
    NodeField<float>* work = nullptr);
  ~BondMultigrid(); // where its memory comes from: Eigen may be set otherwise elsewhere
  BondMultigrid(const BondMultigrid&) = delete;
  BondMultigrid& operator=(const BondMultigrid&) = delete;

  /// x = M r: `input` is taken as zero where components are fixed. The rim of the result is not filled. Collective.
  /// Not of a lean one.
  const NodeField<float>& apply(const NodeField<double>& input, double scale);
  /// The same of a field of single precision.
  const NodeField<float>& apply(const NodeField<float>& input);

  // Bonds that break, on one rank and with no periodic side.
  /// @param index position of the first node of a bond that there is
  [[nodiscard]] SpringWeights weights(std::int64_t index, int offset) const;
  /// Takes a bond out of the matrices of all levels, which it changes by rank one: exact up to round-off. It must have
  /// been taken out of the bonds by then.
  void subtract(const SpringWeights& spring);
  /// From now on apply() is done together by ranks that all have the same bonds, whole: each does its layers of the
  /// finest levels, of the result too; what it is given must be up to date there alone. Coarse levels every rank does
  /// for itself.
  void shareOut(const LayerShare& layers);

  /// For those who relax on parts of the levels: the matrix, and x, r and d, which apply() overwrites; the finest level
  /// of a lean one has x alone.
  [[nodiscard]] Level& level(std::size_t index) noexcept { return *levels_[index]; }
  [[nodiscard]] const Level& level(std::size_t index) const noexcept { return *levels_[index]; }
  /// x = A⁺ r of the coarsest level.
  void solveCoarsest() { coarsest_->solve(*levels_.back()); }

  [[nodiscard]] std::size_t levelCount() const noexcept { return levels_.size(); }
  [[nodiscard]] std::int64_t bytes() const noexcept;
  /// Nodes of all ranks whose bonds leave some direction free.
  [[nodiscard]] std::int64_t hinges() const noexcept { return hinges_; }
  /// Products with the finest level's matrix so far, setting up included.
  [[nodiscard]] std::int64_t products() const noexcept { return products_; }

private:
  /// @return the diagonal blocks
  NodeField<float> buildFinest();
  /// Whatever its slabs are like.
  [[nodiscard]] bool halvable(const Level& level) const;
  /// The last level, as it is cut. Collective over those who have it.
  [[nodiscard]] bool coarsenable() const;
  [[nodiscard]] int reach(const Level& level) const;
  void coarsen(const MatrixRows& rows);
  void balance(const MatrixRows& rows, Level& coarse);
  void translate(const MatrixRows& rows);
  void gather();
  void addLevel(std::unique_ptr<Level> level);
  /// @param first, count components
  /// @param out of the next level; null where this rank has none
  void gatherField(const Level& part, const NodeField<float>& field, int first, int count, NodeField<float>* out) const;
  void estimateSpectrum(std::size_t index);

  /// x = M r of the finest level, after row(i, c) has filled r: of component c, from position i on.
  template <class F>
  const NodeField<float>& applyTo(F&& row);
  /// x = M r of a lean finest level
  void leanCycle(const NodeField<float>& input);
  /// force = input − A x of the finest level, zero where components are fixed
  void leanResidual(const NodeField<float>& input);
  /// force = −A u of the finest level
  void multiply(NodeField<float>& u);
  /// x += M r of a level, or x = M r
  void cycle(std::size_t index, bool fromZero);
  void visit(std::size_t index);
  void visitGathered(std::size_t index);
  void smooth(std::size_t index, bool first);
  void chebyshev(Level& level, const NodeField<float>& residual, float a, float b, bool first);
  /// r −= A d of a level, after filling the rim of d
  void subtract(std::size_t index);
  void restrictResidual(std::size_t index, NodeField<float>& residual);
  /// correction of the next level into d of this one, where it has one, and onto x
  void interpolate(std::size_t index);
  void invertFinest(std::int64_t index);
  /// zero where components are fixed
  void release(NodeField<float>& field) const;

  const BondLattice& bonds_;
  const FixedComponents& fixed_;
  MultigridOptions options_;
  Communicator alone_;
  std::vector<std::unique_ptr<Level>> levels_;
  std::vector<std::int64_t> fixedNodes_; ///< own positions with a fixed component
  NodeField<float> ownForce_;            ///< where no field was given
  NodeField<float>& force_;              ///< of the finest level
  std::vector<NodeField<float>> traces_; ///< of the coarse levels' diagonal blocks before the first bond broke
  NodeField<float> translation_;         ///< A (1, …, 1) by entries, of the last level while there are more to come
  std::optional<CoarsestLevel> coarsest_;
  std::int64_t products_ = 0;
  std::int64_t hinges_ = 0;
};

} // namespace lamella::peridynamics
