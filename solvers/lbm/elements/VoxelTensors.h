#pragma once

#include "lbm/Backend.h"
#include "lbm/DirectedDiffusivity.h"
#include "lbm/elements/ElementShare.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lamella::lbm
{

/// The tensors of a block of voxels, over the largest diffusivity, and of unlike edges by (δ_x / δ_a)(δ_x / δ_b); in
/// the elements' axes.
class VoxelTensors
{
public:
  /// @param phase of the block's voxels, in the lattice's order; outlives this
  /// @param axis  likewise, of the lattice, any length; empty where no phase has two values
  /// @param own   likewise, tensors of nodes; empty where no phase's nodes have their own
  VoxelTensors(const Problem& problem, double scale, const ElementShare& share, const Block& block,
    std::span<const std::uint8_t> phase, std::vector<std::array<float, 3>>&& axis,
    std::vector<SymmetricTensor<float>>&& own);

  /// Of a row of elements, as TensorRows.
  void row(std::int64_t y, std::int64_t z, float* const tensor[6]) const;
  /// The place of a row's first voxel in the lattice's order.
  [[nodiscard]] std::size_t first(std::int64_t y, std::int64_t z) const noexcept
  {
    return static_cast<std::size_t>(strideY_ * y + strideZ_ * z);
  }
  /// Of length 1; 0: the voxel conducts the same in every direction.
  [[nodiscard]] std::array<float, 3> axis(std::size_t voxel) const
  {
    return axis_.empty() || along_[phase_[voxel]] == across_[phase_[voxel]] ? std::array<float, 3>{} : axis_[voxel];
  }
  /// Of a voxel, over the largest diffusivity: xx, yy, zz, xy, xz, yz of the elements' axes.
  [[nodiscard]] std::array<float, 6> tensor(std::size_t voxel) const;
  /// Has this voxel's phase a tensor, its own or that of its nodes?
  [[nodiscard]] bool general(std::size_t voxel) const { return general_[phase_[voxel]] != 0; }
  /// Largest principal value of a phase with tensors, over the largest diffusivity.
  [[nodiscard]] float largest(std::size_t voxel) const { return along_[phase_[voxel]]; }
  [[nodiscard]] std::uint8_t phase(std::size_t voxel) const { return phase_[voxel]; }
  [[nodiscard]] bool conducts(std::size_t voxel) const
  {
    return along_[phase_[voxel]] > 0 || across_[phase_[voxel]] > 0;
  }
  [[nodiscard]] std::size_t bytes() const noexcept
  {
    return axis_.size() * sizeof(axis_[0]) + own_.size() * sizeof(own_[0]);
  }

private:
  std::int64_t nx_;
  std::int64_t strideY_;
  std::int64_t strideZ_;
  std::span<const std::uint8_t> phase_;
  std::vector<float> along_;
  std::vector<float> across_;
  std::vector<std::uint8_t> general_;      ///< by id: 0: along and across; 1: base_; 2: own_
  std::vector<std::array<float, 6>> base_; ///< by id, in the elements' axes: what needs no axis
  std::array<float, 6> factor_{};
  std::vector<std::array<float, 3>> axis_; ///< of length 1 or 0
  std::vector<std::array<float, 6>> own_;  ///< in the elements' axes
};

/// Does some phase conduct differently along and across?
[[nodiscard]] bool hasDirections(const Problem& problem);
/// Has some phase a tensor for each node?
[[nodiscard]] bool hasOwnTensors(const Problem& problem);

} // namespace lamella::lbm
