#pragma once

#include "lbm/Links.h"

#include <vector>

namespace lamella::lbm
{

/// Sums over the links that cross each plane between two layers of nodes, across the direction that is solved for.
/// Fixed faces: plane 0 holds the links to the low face, plane n those to the high one. Periodic: plane 0 lies between
/// the last layer and the first, and there are n.
struct PlaneSums
{
  std::vector<double> conductance; ///< Σ g
  std::vector<double> flux;        ///< Σ g Δu, positive from low to high

  explicit PlaneSums(std::size_t planes = 0)
    : conductance(planes, 0.0)
    , flux(planes, 0.0)
  {
  }
};

/// The best that can be made of a field u by a factor and by a shift of each layer of nodes: the Galerkin solution
/// among all g + θ (u − linear profile), g any profile between the same two values.
///
/// Through every plane, both faces included, it carries the same flux, which is its energy: for a Galerkin solution
/// a(w, g) = a(w, w) whichever profile g is taken, and a profile that falls in one plane only gives that plane's flux.
/// The energy exceeds the exact one by the square of the field's error. So both faces' fluxes are as good as the
/// energy, where those of u itself err like the field.
struct PlaneBalance
{
  double factor = 1;         ///< θ
  std::vector<double> shift; ///< one a layer of nodes: the field becomes θ u + shift
  double energy = 0;         ///< flux through every plane

  /// @param sums    of u, over all ranks
  /// @param energy  Σ g (Δu)² over all links
  /// @param periodic  u is then what is left of the field when the linear profile is taken off, and so is the result
  /// @param onFaces   the outer layers of nodes lie on the faces, are held, and are none of the layers; so all planes
  ///                  are one spacing wide
  PlaneBalance(const PlaneSums& sums, double energy, bool periodic, bool onFaces = false);

  /// Sums of the balanced field, from those of u and its planes; the residual's stays. (Of nodes half a spacing from
  /// the faces.)
  [[nodiscard]] FieldSums of(const FieldSums& sums, const PlaneSums& planes) const;

  /// A balance has the least energy of all fields that it chooses from, unless it chose by fluxes that are round-off.
  /// @throws DivergenceError: `after` exceeds `before` by more than `loosest`
  static void requireGain(double before, double after);
  static constexpr double loosest = 1e-3;
  static constexpr const char* beyondDouble = "a contrast near 1e16 is beyond double precision: give the phases that "
                                              "conduct least 0, or those that conduct best less";
};

} // namespace lamella::lbm
