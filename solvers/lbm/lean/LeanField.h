#pragma once

#include "lbm/Backend.h"
#include "lbm/Links.h"
#include "lbm/PhaseRows.h"
#include "lbm/PlaneBalance.h"
#include "lbm/lean/PhaseKernels.h"
#include "lbm/multigrid/Level.h"

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace lamella::lbm
{

/// The field of the lean solver on its finest level: the picture, where it is, and one float a node. Links come from
/// the two bytes at their ends, the right-hand side from the mean gradient, and no residual is ever stored.
///
/// v is what is left of the values when the linear profile is taken off, in units of the profile's drop from a node to
/// the next: so single precision is enough for a flux to 1e-8. 7-point links.
class LeanField
{
public:
  explicit LeanField(const Problem& problem);

  /// Grid, sides and communication of this level; no links, no vectors.
  [[nodiscard]] Level& level() noexcept { return level_; }
  [[nodiscard]] const Level& level() const noexcept { return level_; }
  /// Red–black Gauss–Seidel sweeps; backwards: black first.
  void relax(int sweeps, bool forward);
  /// Residual, summed over blocks of 2 × 2 × 2 nodes; right after forward sweeps.
  void restrictTo(Level& coarse) const;
  /// Adds the correction of a block to its nodes.
  void addFrom(const Level& coarse);
  /// Links along d of a row, from x = −1 on: nx + 1 of them.
  void linkRow(int d, std::int64_t y, std::int64_t z, float* out) const;

  /// Adds to out[i] the residual of the i-th node of a row's even (0) or odd (1) nodes.
  void addResidual(std::int64_t y, std::int64_t z, int part, float* out) const;
  /// v of the even or the odd nodes of a row.
  [[nodiscard]] float* halfRow(std::int64_t y, std::int64_t z, int part) noexcept;
  /// Ghost rows, after a change of v.
  void exchange();

  [[nodiscard]] std::array<std::int64_t, 3> size() const noexcept { return block_.size; }
  [[nodiscard]] std::array<bool, 3> periodic() const noexcept { return level_.periodic; }
  [[nodiscard]] int axis() const noexcept { return problem_.axis; }
  [[nodiscard]] const std::uint8_t* phaseRow(std::int64_t y, std::int64_t z) const noexcept { return phases_(y, z); }
  /// The phases that occur, on all ranks.
  [[nodiscard]] std::span<const std::uint8_t> ids() const noexcept { return ids_; }

  /// Sums over all ranks, and those over planes; through faces, and along the direction, only where they are fixed.
  [[nodiscard]] FieldSums sums(PlaneSums& planes) const;
  /// What the round-off of v adds to the energy, as sums() tells that; about.
  [[nodiscard]] double roundOff() const;
  void apply(const PlaneBalance& balance);

  /// From now on the field is the correction of another one, u, whose residual takes the place of the mean gradient;
  /// it begins at 0. Four bytes a node more.
  void startCorrection();
  void setResidual(std::int64_t y, std::int64_t z, const double* residual);
  /// u[x] += unit × v of a row.
  void addRow(std::int64_t y, std::int64_t z, double unit, double* u) const;

  [[nodiscard]] double mean() const; ///< BoxField::mean, of v
  void value(std::span<double> out, Layers layers, double mean) const;
  void plane(std::int64_t z, double* out) const; ///< Backend::plane
  void flux(std::span<double> out, Layers layers) const;
  [[nodiscard]] std::vector<double> linkEnergies() const; ///< as BoxField's, from single precision
  [[nodiscard]] const Links& links() const noexcept { return links_; }
  [[nodiscard]] std::size_t bytes() const noexcept;

private:
  using RowFunction = std::function<void(std::int64_t y, std::int64_t z, std::size_t tile)>;
  /// Rows in tiles whose planes stay in cache, over the threads; tiles do not depend on how many threads there are.
  void forEachRow(const RowFunction& f) const;
  [[nodiscard]] std::size_t tiles() const noexcept;
  /// Those that are worth their waiting.
  [[nodiscard]] int threads() const noexcept;
  [[nodiscard]] PhaseRow row(std::int64_t y, std::int64_t z, int part) const;
  [[nodiscard]] RowSide side(std::int64_t y, std::int64_t z, int part, int axis, int step) const;
  [[nodiscard]] std::int64_t along(std::int64_t y, std::int64_t z) const noexcept;
  void countConductance();

  Problem problem_;
  Block block_;
  Links links_;
  Level level_;
  PhaseRows phases_;
  std::vector<std::uint8_t> ids_;
  std::vector<double> pairs_; ///< links by both ids, 256 a row, by axis as links_ has them; empty where there are two
  std::vector<float> pairsSingle_;
  PhaseLinks table_;
  FloatArray v_;
  FloatArray source_;               ///< empty: the mean gradient alone
  FloatArray nothing_;              ///< a row of zeros, the value of walls
  std::vector<double> conductance_; ///< of each plane across the direction, all ranks
  std::int64_t tileY_ = 1;
  std::int64_t tileZ_ = 1;
};

} // namespace lamella::lbm
