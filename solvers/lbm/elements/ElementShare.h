#pragma once

#include "lattice/PlaneParts.h"
#include "lattice/Redistribution.h"
#include "lbm/Backend.h"
#include "lbm/elements/ElementMultigrid.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lamella::lbm
{

/// How elements are shared out over ranks, and the way there and back: the blocks that ranks hold of a lattice are cut
/// along y and z, elements along one of them only, the longer one (PlaneParts). In the elements' own axes that is z:
/// order() tells which axis of the lattice each is, and back. Pictures are cut along y, their own y is one thick.
///
/// Where the lattice is small, or has less than two layers a rank, each rank has all of it.
class ElementShare
{
public:
  explicit ElementShare(const Problem& problem);

  [[nodiscard]] const std::array<int, 3>& order() const noexcept { return order_; }
  /// A triple in the other axes.
  template <class T>
  [[nodiscard]] std::array<T, 3> turned(const std::array<T, 3>& of) const
  {
    return { of[0], of[static_cast<std::size_t>(order_[1])], of[static_cast<std::size_t>(order_[2])] };
  }
  /// The elements that this rank works on, and their voxels, which lie in the lattice's order.
  [[nodiscard]] const ElementBox& box() const noexcept { return box_; }
  [[nodiscard]] const Block& slab() const noexcept { return slab_; }
  [[nodiscard]] bool moves() const noexcept { return problem_.comm.parallel(); }

  /// What this rank's block has by voxel, as those of its slab. Collective.
  template <class T>
  [[nodiscard]] std::vector<T> toSlab(std::span<const T> ofBlock) const
  {
    std::vector<T> moved(static_cast<std::size_t>(slab_.count()));
    Redistribution(3, problem_.lattice.size, blocks_, slabs_, problem_.comm, 0)
      .forward(ofBlock.data(), moved.data(), static_cast<std::size_t>(slab_.size[0]));
    return moved;
  }
  /// What all blocks have by voxel, as the lattice has it. Collective.
  template <class T>
  [[nodiscard]] std::vector<T> toAll(std::span<const T> ofBlock) const
  {
    std::vector<T> all(static_cast<std::size_t>(problem_.lattice.count()));
    const std::vector<Block> wholes(blocks_.size(), Block{ { 0, 0, 0 }, problem_.lattice.size });
    Redistribution(3, problem_.lattice.size, blocks_, wholes, problem_.comm, 0)
      .forward(ofBlock.data(), all.data(), static_cast<std::size_t>(problem_.lattice.size[0]));
    return all;
  }
  /// What the nodes of its elements have, as those at the corners of its block's voxels, in the elements' axes.
  /// Collective.
  [[nodiscard]] std::vector<double> toBlock(std::span<const double> ofNodes) const;

private:
  const Problem& problem_;
  std::array<int, 3> order_{ 0, 1, 2 };
  ElementBox box_;
  Block slab_;
  std::vector<Block> blocks_; ///< of every rank
  std::vector<Block> slabs_;
};

} // namespace lamella::lbm
