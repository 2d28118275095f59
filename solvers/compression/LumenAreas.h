#pragma once

#include "compression/CornerMotion.h"
#include "lattice/Lattice.h"
#include "pores/PoreLabelling.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lamella::compression
{

struct LumenOptions
{
  std::uint8_t empty = 0;       ///< phase that lumens are of, and that has no points
  int connectivity = 0;         ///< as of PoreLabelling; 0: over sides (4), over faces (6)
  std::int64_t minimumSize = 1; ///< smaller ones are left out [nodes]
};

/// How large every lumen of a tissue is while it is deformed: its area, in space its volume, by the divergence theorem
/// over the edges of pixels (faces of voxels) between it and the wall, whose corners the walls' points carry along
/// (CornerMotion). So an affine deformation gives exact areas, a rotation leaves them as they are, and a lumen that is
/// turned inside out counts negative.
///
/// A lumen that the sample's rim cuts is closed there by the straight line (plane) that fits best, by least squares,
/// the wall's corners on that side: that of the platen, where one holds them.
///
/// Memory beside the labels (4 bytes a node): in 2D about 30 bytes an edge, in 3D about 47 a face; bytes() tells. While
/// it is made 4 bytes a corner of the lattice more. Time of areas(): a pass over the ids, and a few operations an edge.
class LumenAreas
{
public:
  /// @param phase lattice.count() phases
  /// @throws ParameterError: a connectivity that does not fit the dimension, a minimum size below 0
  /// @throws InputError: another number of phases; no wall; no lumen that is large enough; more than 2²⁹ corners
  LumenAreas(const Lattice& lattice, std::span<const std::uint8_t> phase, const LumenOptions& options);

  [[nodiscard]] const Lattice& lattice() const noexcept { return lattice_; }
  /// Label i + 1 is lumens()[i]; the largest first.
  [[nodiscard]] std::span<const pores::Pore> lumens() const noexcept { return lumens_; }
  /// By node, 0 in walls and in lumens that are too small.
  [[nodiscard]] std::span<const std::int32_t> labels() const noexcept { return labels_; }
  /// At the start, by lumen [m²], [m³] in 3D.
  [[nodiscard]] std::span<const double> initial() const noexcept { return initial_; }
  /// Whether the sample's rim cuts the lumen.
  [[nodiscard]] bool cut(std::size_t lumen) const noexcept { return lumens_[lumen].touches != 0; }
  /// Edges of pixels, faces of voxels.
  [[nodiscard]] std::size_t edges() const noexcept { return corners_.size() / cornersOfEdge(); }
  [[nodiscard]] std::size_t bytes() const noexcept;

  /// Areas [m²], volumes [m³] of a state, by lumen; NaN where the rim cuts a lumen on a side that no wall touches.
  /// @param areas lumens().size()
  /// @throws InputError as CornerMotion::places()
  void areas(const PointState& state, std::span<double> areas) const;

private:
  [[nodiscard]] std::size_t cornersOfEdge() const noexcept { return lattice_.dimension == 2 ? 2 : 4; }

  Lattice lattice_;
  std::vector<pores::Pore> lumens_;
  std::vector<std::int32_t> labels_;
  std::vector<double> initial_;
  CornerMotion motion_;
  std::vector<std::size_t> first_;     ///< of each lumen in corners_, and the end
  std::vector<std::uint32_t> corners_; ///< of its edges, two each: the lumen lies to the left; in 3D four around a face
};

} // namespace lamella::compression
