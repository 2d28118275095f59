#pragma once

#include "core/Communicator.h"
#include "peridynamics/NodeField.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lamella::peridynamics
{

/// How ranks share out the work on a lattice that each of them holds whole: every one computes its own layers along the
/// slowest axis (y in 2D, z in 3D), and takes others' layers from those who did them. What a layer comes to does not
/// depend on who computes it, and sums are taken in the order of rows: results are the same to the last bit on any
/// number of ranks. Members with a field or sums are collective; alone all layers are own ones and nothing is sent.
class LayerShare
{
public:
  /// Alone.
  LayerShare() = default;
  /// Even parts of so many layers. @param comm must outlive this
  LayerShare(std::int64_t layers, const Communicator& comm);

  /// Is there anybody else?
  [[nodiscard]] bool parallel() const noexcept { return comm_ != nullptr; }
  /// Own layers: first ≤ layer < last, where there is anybody else. Those of all ranks together are all.
  [[nodiscard]] std::int64_t first() const noexcept { return begins_[rank()]; }
  [[nodiscard]] std::int64_t last() const noexcept { return begins_[rank() + 1]; }
  /// Layers of the part that has the fewest.
  [[nodiscard]] std::int64_t fewest() const noexcept;

  /// The same parts of the next coarser lattice: what a part is interpolated from, or restricted to, lies at most one
  /// layer beyond the other's.
  /// @param layers that it has
  [[nodiscard]] LayerShare halved(std::int64_t layers) const;

  /// Takes the layers next to the own ones from the neighbours. @param depth of them; at most fewest()
  template <class Real>
  void exchange(NodeField<Real>& field, std::int64_t depth) const;
  /// Takes all that others have done.
  template <class Real>
  void gather(NodeField<Real>& field) const;
  /// Of the layers from ≤ layer < to.
  template <class Real>
  void gather(NodeField<Real>& field, std::int64_t from, std::int64_t to) const;
  /// The same of some values for each layer, in order: of sums of rows, of tiles.
  template <class T>
  void gather(std::vector<T>& values) const;

private:
  [[nodiscard]] std::size_t rank() const noexcept
  {
    return comm_ != nullptr ? static_cast<std::size_t>(comm_->rank()) : 0;
  }
  void gatherBytes(std::byte* data, std::int64_t layer, std::int64_t from, std::int64_t to) const;

  const Communicator* comm_ = nullptr; ///< where there are others
  std::vector<std::int64_t> begins_{ 0, 0 };
};

/// Layers of a lattice along its slowest axis.
[[nodiscard]] inline std::int64_t layersOf(const NodeLayout& l) noexcept
{
  return l.size[l.dimension == 3 ? 2 : 1];
}

} // namespace lamella::peridynamics
