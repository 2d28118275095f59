#pragma once

#include "lbm/multigrid/BandCholesky.h"
#include "lbm/multigrid/Level.h"
#include "lbm/multigrid/Smoothing.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace lamella::lbm
{

/// How a level follows from the one below it.
enum class Coarsening
{
  Operator, ///< coarse nodes are even nodes, interpolation follows the operator: 27-point Galerkin products
  Blocks    ///< coarse nodes are blocks of 2 × 2 × 2 nodes, interpolation is constant: straight links, three floats
};

/// Of the links between two blocks (or pieces of them) a coarse link is at least this part. Measured on tissue, balls,
/// noise and sandstone, contrasts 3 to 1e5: 0.3 to 0.4 take the fewest cycles, 0.25 and 0.6 fail on some.
inline constexpr float leastBlockLink = 0.375F;

/// Links along direction d of a row, from x = −1 to nx − 1.
using LinkRow = std::function<void(int d, std::int64_t y, std::int64_t z, float* out)>;

/// Symmetric V- or W-cycle with one multicolour Gauss–Seidel sweep before and one, reversed, after: a preconditioner
/// for conjugate gradients.
///
/// Coarse nodes lie at even positions. Interpolation follows the operator (Dendy, J. Comput. Phys. 48 (1982) 366: links
/// across a coarse line are collapsed onto it; nodes between lines take the weighted mean of what surrounds them);
/// coarse operators are Galerkin products, kept as links: 9 in 2D, 27 points in 3D. Weights are 16-bit fractions.
/// The coarsest level is solved by Cholesky factors, of its band or, where it wraps, sparse ones (Eigen).
///
/// Or, for a fifth of the memory: coarse nodes are blocks, with three sweeps in the place of one. A coarse link is half
/// of each block's own links in series with those between them, after those side by side are added up; and at least
/// a part of the latter, or a constant correction would overshoot where a thin conducting wall straddles two blocks.
/// Thin walls that insulate are more than this can see.
///
/// Distributed as the lattice is, as long as every part begins at an even row; then a large level is shared out anew,
/// and a small one gathered: every rank does the rest for itself. Every rank count gives the same cycle.
class Multigrid
{
public:
  /// @param finest  links, grid and communication filled in; 5/7 or 9/19 points
  explicit Multigrid(Level finest, int threads, Coarsening coarsening = Coarsening::Operator);

  /// z = M r on the finest level's layout; the ghosts of r need not be set, those of z are.
  void apply(const FloatArray& r, FloatArray& z);
  /// p = z + β p, then q = A p; returns this rank's p·q. q may be z. Ghosts of p are filled.
  double advance(const FloatArray& z, float beta, FloatArray& p, FloatArray& q) const;

  /// 1: V-cycle, 2: W-cycle. Takes effect at the next apply().
  void setVisits(int visits) noexcept { visits_ = visits; }
  [[nodiscard]] int visits() const noexcept { return visits_; }

  [[nodiscard]] Level& finest() noexcept { return *levels_.front(); }
  [[nodiscard]] const Level& finest() const noexcept { return *levels_.front(); }
  [[nodiscard]] std::size_t levelCount() const noexcept { return levels_.size(); }
  [[nodiscard]] std::uint64_t bytes() const;

private:
  void build();
  void computeWeights(Level& fine, const Level& coarse) const;
  std::unique_ptr<Level> coarsen(Level& fine) const;
  /// The threads that are worth their waiting on a level.
  [[nodiscard]] int threadsOn(const Level& level) const noexcept;
  std::unique_ptr<Level> gather(const Level& part) const;
  /// The same lattice, shared out so that it can be halved again; null where it cannot.
  std::unique_ptr<Level> move(Level& part) const;
  void factorize(const Level& coarsest);

  void cycle(std::size_t level, const FloatArray& f, FloatArray& u, bool fromZero);
  /// @param finish  makes u final up to a plane of the fine level, before the residual there is taken
  void restrictResidual(
    Level& fine, const FloatArray& f, const FloatArray& u, Level& coarse, const LayerHook& finish) const;
  void interpolateAdd(const Level& fine, FloatArray& u, const Level& coarse) const;
  void restrictBlocks(
    const Level& fine, const FloatArray& f, const FloatArray& u, Level& coarse, const LayerHook& finish) const;
  void addBlockRow(const Level& fine, FloatArray& u, const Level& coarse, std::int64_t cy, std::int64_t cz) const;
  /// From row cy of plane cz of the coarse level to the fine rows of its cells; ghosts stay as they are.
  void interpolateRow(const Level& fine, FloatArray& u, const Level& coarse, std::int64_t cy, std::int64_t cz) const;
  void solveDirectly(const Level& coarsest, const FloatArray& f, FloatArray& u) const;
  void gatherVector(const Level& part, const FloatArray& v, Level& whole, FloatArray& out) const;
  void scatterVector(const Level& whole, const FloatArray& v, const Level& part, FloatArray& out) const;

  std::vector<std::unique_ptr<Level>> levels_;
  Coarsening coarsening_;
  int sweeps_ = 1;
  int visits_ = 1;
  int threads_ = 1;
  BandCholesky band_; ///< of the coarsest level, or empty
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> direct_;
};

/// The lattice of half the size, without links and vectors.
[[nodiscard]] std::unique_ptr<Level> halved(const Level& fine);
/// Its level of blocks, with vectors. @param links of the fine level
[[nodiscard]] std::unique_ptr<Level> coarsenBlocks(const Level& fine, const LinkRow& links, int threads);

/// By how much more than its even share a part of a level may hold where that is shared out anew: a twentieth of what
/// one of the finest level does, which has 8 (in 2D 4) times the nodes at each step up, and at most as much again.
/// Better that than all of the level on every rank.
[[nodiscard]] double unevennessAt(int dimension, int depth);

/// Can a lattice of this size be halved once more, and is that worth while?
[[nodiscard]] bool canHalve(const std::array<std::int64_t, 3>& size, const std::array<bool, 3>& periodic);

} // namespace lamella::lbm
