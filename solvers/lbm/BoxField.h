#pragma once

#include "lbm/Backend.h"
#include "lbm/PhaseRows.h"
#include "lbm/PlaneBalance.h"
#include "lbm/multigrid/StaggeredAllocator.h"

#include <functional>
#include <vector>

namespace lamella::lbm
{

/// The field of a box in which every node conducts, in double precision, and all that is asked of it exactly: the
/// residual of the link system, its energy, the flux through the faces, the flux at the nodes. Conductances come from
/// a small table of phase pairs; nothing but the field is stored (8 bytes a node, and the ghost rows' phases).
class BoxField
{
public:
  explicit BoxField(const Problem& problem);

  /// Values of a row, with one ghost on either side: rowValues(y, z)[-1 … nx].
  [[nodiscard]] double* rowValues(std::int64_t y, std::int64_t z) noexcept
  {
    return u_.data() + halo_.row(y, z) * stride_ + 1;
  }
  /// Linear from 1 to 0 between fixed faces, 0 in a periodic cell.
  void setLinearProfile();
  void setLinearProfile(std::int64_t y, std::int64_t z); ///< of a row

  /// Receives b − A u of one row: nx values.
  using RowSink = std::function<void(std::int64_t y, std::int64_t z, const double* residual)>;
  /// Residual of every row and the sums over all ranks; those over planes too when asked for.
  FieldSums evaluate(const RowSink& sink, PlaneSums* planes = nullptr);
  /// Makes the flux through all planes the same; see PlaneBalance.
  void apply(const PlaneBalance& balance);

  /// Of a periodic cell, all ranks; 0 of others. Collective.
  [[nodiscard]] double mean() const;
  /// @param mean what mean() told
  void value(std::span<double> out, Layers layers, double mean) const;
  /// Needs an evaluate() after the last change of the field (its ghosts).
  void flux(std::span<double> out, Layers layers) const;

  /// FieldEnergies::links. Needs its ghosts, as flux() does; nodes that are NaN have no links.
  [[nodiscard]] std::vector<double> linkEnergies() const;
  /// Takes what value() gave.
  void setValue(std::span<const double> value);
  void fillGhosts();

  /// Planes across the direction: PlaneSums.
  [[nodiscard]] std::size_t planeCount() const noexcept;
  [[nodiscard]] const Links& links() const noexcept { return links_; }
  [[nodiscard]] const std::uint8_t* rowPhase(std::int64_t y, std::int64_t z) const noexcept { return phases_(y, z); }
  [[nodiscard]] const Halo& halo() const noexcept { return halo_; }
  [[nodiscard]] std::size_t bytes() const noexcept { return u_.size() * 8 + phases_.bytes(); }

private:
  void addToPlanes(std::int64_t y, std::int64_t z, PlaneSums& planes) const;
  template <class F>
  void rowLinks(std::int64_t y, std::int64_t z, const Direction& d, F&& f) const;
  template <class F, class Run>
  void rowLinks(std::int64_t y, std::int64_t z, const Direction& d, F&& f, Run&& run) const;

  Problem problem_;
  Block block_;
  Links links_;
  Halo halo_;
  PhaseRows phases_;
  std::int64_t stride_;
  std::vector<double, StaggeredAllocator<double>> u_;
};

} // namespace lamella::lbm
