#pragma once

#include "peridynamics/fracture/SlowMotions.h"
#include "peridynamics/fracture/SpringWindow.h"
#include "peridynamics/multigrid/BondMultigrid.h"

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

namespace lamella::peridynamics
{

/// Displacements as a sum over the levels of a multigrid hierarchy, which breaks and corrections around them change on
/// small parts of each level:
///
///   u = base + U₀,   U_l = w_l + P U_{l+1},   g_{l+1} = Pᵀ(g_l − A_l w_l),
///
/// with A_l the Galerkin matrices, P interpolation, and g₀ the residual force of the base. The residual of level l, g_l
/// − A_l U_l, is then the restriction of the finest one's, whatever the parts; this is kept through every change. In
/// space there is no w₀: what the finest level is moved by goes into the base, and its force into g₀, at once.
///
/// The whole lattice on every rank, no periodic side. All in single precision but the base; the local part runs on one
/// thread.
class EventHierarchy
{
public:
  /// Solves the first equilibrium to a tolerance.
  /// @param displacement what fixed components are given, and a first guess
  /// @param bonds, fixed must outlive this
  /// @param progress told the share that is done after every iteration; true throws Cancelled
  /// @param team ranks that all call this with the same bonds, whole, and go on alike: they share out global
  /// corrections, and come to the same to the last bit as one alone; must outlive this
  EventHierarchy(BondLattice& bonds, const FixedComponents& fixed, const NodeField<double>& displacement,
    double tolerance, const std::function<bool(double)>& progress = {}, const Communicator& team = alone());

  /// What renew() left of another one.
  struct Renewed
  {
    NodeField<double> base;
    double reference = 1;
  };
  EventHierarchy(BondLattice& bonds, const FixedComponents& fixed, Renewed state, const Communicator& team = alone());
  [[nodiscard]] static const Communicator& alone();
  /// How the matrices of the levels are made.
  [[nodiscard]] static MultigridOptions multigridOptions(int dimension) noexcept;
  /// Collapses all into the base, and makes matrices and residuals anew: all that follows depends on the bonds, the
  /// base and the reference alone. As much work as some ten iterations of a global correction.
  void renew();
  [[nodiscard]] double reference() const noexcept { return reference_; }

  /// Elongation u·e of a bond in metres.
  [[nodiscard]] double elongation(std::int64_t index, int offset);
  /// Takes a bond out of the lattice and of all levels, and what it pulled with into the residuals.
  /// @return k/|ξ|
  double breakBond(std::int64_t index, int offset);
  /// r·D⁻¹r of the force that a broken bond leaves, were it all the residual that there is.
  [[nodiscard]] double dipole(std::int64_t index, int offset, double force) const;

  struct Local
  {
    int cycles = 0;
    double residual = 0; ///< r·D⁻¹r on the finest level after the last
    Box window;          ///< of the finest level: where w₀ changed
    std::int64_t visited = 0;
  };
  /// Relaxes on nested windows around a box of the finest level, the coarsest level being solved whole, until
  /// r·D⁻¹r falls below the target.
  Local correct(const Box& box, int radius, int coarseRadius, double target, int maxCycles);

  struct Goal
  {
    double tolerance; ///< of the residual force over the reference
    int iterations;   ///< at most
  };
  struct Reached
  {
    int iterations;
    double tolerance; ///< that was asked for
  };
  /// Conjugate gradients on the whole lattice, after slow motions have been taken out.
  /// @param further the goal instead, where the first one is reached already
  /// @param progress as the constructor's
  Reached correctGlobally(
    const Goal& goal, const std::optional<Goal>& further = {}, const std::function<bool(double)>& progress = {});
  /// The same from a residual in double precision, again and again until that is as small. Collapses all into the base.
  int solve(double tolerance, const std::function<bool(double)>& progress = {});

  /// u − base on a box of the finest level becomes what correction() holds.
  void evaluate(const Box& box) { evaluate(0, box); }
  [[nodiscard]] const NodeField<float>& correction() const noexcept { return levels_.front().total; }
  [[nodiscard]] const NodeField<double>& base() const noexcept { return base_; }
  /// How ranks share out the layers.
  [[nodiscard]] const LayerShare& share() const noexcept { return share_; }
  /// The last global correction found nothing to do.
  [[nodiscard]] bool looked() const noexcept { return looked_; }
  /// The last global correction had hardly more to do than was asked for, in space.
  [[nodiscard]] bool little() const noexcept { return little_; }
  /// Of the reference: what breaks have left of the residual force since it was last measured, by what they left
  /// before. In the plane twice that; in space what one leaves is rough and lies in the whole lattice, so that squares
  /// add up.
  [[nodiscard]] double expectedResidual() const noexcept;
  /// Forces on all nodes, after a global correction only: those on fixed components are reactions.
  [[nodiscard]] const NodeField<float>& force() const noexcept
  {
    return looked_ ? levels_.front().change : levels_.front().g;
  }
  /// Largest |Pᵀρ_l − ρ_{l+1}| over the largest |ρ₀|, ρ the residuals: round-off. For tests; visits everything.
  [[nodiscard]] double inconsistency();
  [[nodiscard]] std::int64_t bytes() const noexcept;

private:
  static constexpr double unmeasured = std::numeric_limits<double>::infinity();

  struct EventLevel
  {
    EventLevel(const NodeLayout& layout, bool part)
      : w(part ? NodeField<float>(layout) : NodeField<float>())
      , g(layout)
      , total(layout)
      , change(layout)
    {
    }
    NodeField<float> w;     ///< this level's part; none where it goes into the base
    NodeField<float> g;     ///< what A_l U_l is to be
    NodeField<float> total; ///< U_l where it was evaluated; the direction of global corrections
    /// Of the residual, not yet handed to the next level; zero between cycles. Products of global corrections.
    NodeField<float> change;
  };

  void prepare();
  void build();
  void clearDirections();
  void evaluate(std::size_t level, const Box& box);
  void evaluateFrom(std::size_t level, const Box& box); ///< where the next level's is known
  void nest(const Box& box, int radius, int coarseRadius);
  /// @param known the level's r is the residual of its window already
  /// @param evaluated whether U_l is to stay known
  double relax(std::size_t level, int steps, bool known, bool evaluated);
  /// out = plus − A u on the rows of a box; plus may be null. Returns u·out.
  double product(std::size_t level, const Box& box, const WindowField& u, const WindowField& out,
    const NodeField<float>* plus = nullptr);
  double packedProduct(
    std::size_t level, const Box& box, const WindowField& u, const WindowField& out, const NodeField<float>* plus);
  void makeRoom(std::size_t level);
  /// Is the level's window so small that fields of its own pay?
  [[nodiscard]] bool isSmall(std::size_t level) const;
  WindowField changeOf(std::size_t level);
  /// Residual, direction, product: 0, 1, 2.
  WindowField work(std::size_t level, std::size_t which);
  /// @param nextChange, nextResidual what else it is added to; null: nothing
  void restrictChange(std::size_t level, const WindowField& change, const Box& box, const WindowField* nextChange,
    const WindowField* nextResidual);
  void restrictChange(std::size_t level); ///< all of it
  /// Of the level's window. @param known the residual of the next level's, too
  void restrictWindow(std::size_t level, bool known);
  static void addForce(const Box& box, float a, const WindowField& force, const WindowField& to);
  void relaxCoarsest();
  void measureResidual();
  void learn(double size);
  void collapse();
  void restrictAll();
  void residualInDouble();
  void takeOutSlowMotions();
  /// Moves a row of the finest level by a p, in a global correction.
  void move(float a, const NodeField<float>& p, std::int64_t y, std::int64_t z);
  /// u += a p over n nodes.
  static void addToBase(std::int64_t n, float a, const float* p, double* u);
  void maskRow(const WindowField& field, std::int64_t y, std::int64_t z, std::int64_t x0, std::int64_t x1) const;
  [[nodiscard]] double dot(const NodeField<float>& a, const NodeField<float>& b); ///< of the finest level
  [[nodiscard]] double freeNorm(const NodeField<float>& r);
  /// Of a row: the squares of what is not fixed.
  [[nodiscard]] double freeSquare(const NodeField<float>& r, std::int64_t y, std::int64_t z) const;
  template <class F>
  double rowSum(F&& f);

  /// On own layers of the finest level.
  template <class F>
  void forShare(F&& f) const
  {
    forLayers(bonds_.layout(), share_.first(), share_.last(), f);
  }
  /// Nodes of the own layers, and of so many to either side.
  [[nodiscard]] Box shareBox(std::int64_t around) const;

  BondLattice& bonds_;
  const FixedComponents& fixed_;
  LayerShare share_;
  std::unique_ptr<BondMultigrid> multigrid_;
  std::vector<EventLevel> levels_;
  const bool inBase_; ///< is there no w₀?
  NodeField<double> base_;
  SlowMotions slow_;
  std::vector<char> rowFixed_; ///< by ordinal of the row: does it have a fixed component?
  std::vector<double> sums_;   ///< of rows
  double reference_ = 1;       ///< norm of the forces on free components, were they held
  int sinceDouble_ = 0;        ///< global corrections that changed something
  int looks_ = 0;              ///< those since that did not
  bool looked_ = false;        ///< the last one was such
  bool little_ = false;        ///< see little()
  double size_ = unmeasured;   ///< norm of the residual force after that
  double freed_ = 0;           ///< force of the bonds that have broken since, added up; in space its squares
  double left_ = unmeasured;   ///< share of it that local corrections leave; in space of the root

  std::vector<Box> inner_; ///< windows of the levels
  std::vector<Box> outer_; ///< what their product reaches
  SpringWindow springs_;
  NodeField<float> motion_; ///< of a global correction that takes more than one iteration, where w₀ goes into the base
  /// Residual, direction, product and change of small windows, close together; with the reach of a product around. Not
  /// where matrices are packed, whose scales lie as the level's fields do. The first three also where the level has
  /// none.
  std::vector<std::array<NodeField<float>, 4>> work_;
  std::vector<std::int64_t> jumps_;           ///< of a product
  std::vector<const std::uint8_t*> mirrored_; ///<
};

} // namespace lamella::peridynamics
