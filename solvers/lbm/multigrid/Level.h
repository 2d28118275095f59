#pragma once

#include "lattice/Decomposition.h"
#include "lattice/Redistribution.h"
#include "lbm/multigrid/Grid.h"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace lamella::lbm
{

/// One level: links to the forward half of the neighbours, and the work vectors of the cycle.
///
/// What lies beyond a fixed face is a layer of ghost nodes of value zero, linked like any others: so no level needs to
/// know about walls, and a row of the matrix always sums to zero.
struct Level
{
  Grid grid;
  std::array<bool, 3> periodic{ false, false, false };
  bool straight = true;             ///< 5- or 7-point, the diagonal computed on the fly
  std::vector<FloatArray> links;    ///< one array a forward direction
  FloatArray inverse;               ///< 1 / Σ links; empty when straight
  FloatArray u;                     ///< correction (coarse levels)
  FloatArray f;                     ///< right-hand side (coarse levels)
  std::vector<FloatArray> residual; ///< planes, used in turn
  std::vector<std::uint16_t, StaggeredAllocator<std::uint16_t>>
    weights; ///< interpolation from the next level, see WeightLayout
  std::unique_ptr<Communicator> comm;
  std::unique_ptr<Decomposition> parts;
  Halo halo;
  std::array<std::int64_t, 3> start{ 0, 0, 0 }; ///< of this block in the level's lattice
  std::array<std::int64_t, 3> size{ 1, 1, 1 };  ///< of the level's lattice
  int depth = 0;                                ///< halvings from the finest level
  int halvings = 0;                             ///< of the lattice that `parts` shares out
  bool gathered = false;                        ///< the next level is the same lattice, whole on every rank
  std::unique_ptr<Redistribution> moved;        ///< the next level is the same lattice, shared out anew

  [[nodiscard]] int directions() const noexcept { return static_cast<int>(links.size()); }
  void allocateLinks(int count);
  /// Fills ghost ends of rows (periodic x) and ghost rows.
  void exchange(FloatArray& v) const;
  /// The same for ghost ends only, of one part of one row.
  void wrapRow(float* row) const noexcept;
};

} // namespace lamella::lbm
