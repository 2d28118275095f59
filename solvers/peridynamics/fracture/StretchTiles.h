#pragma once

#include "peridynamics/BondForces.h"
#include "peridynamics/fracture/EventHierarchy.h"

#include <cstdint>
#include <vector>

namespace lamella::peridynamics
{

/// The largest s/s₀ of every small box of nodes (of the bonds that begin there), and how old each value is: what a
/// break far away changes is looked at only where it may matter.
class StretchTiles
{
public:
  /// @param team see EventHierarchy
  explicit StretchTiles(const BondLattice& bonds, const Communicator& team = EventHierarchy::alone());

  /// Everything has changed: all tiles anew, over the ranks and threads.
  /// @param least only those that had this share of the largest
  void refreshAll(EventHierarchy& state, double least = 0);
  /// A break has changed everything a little, and a window more than that.
  void refresh(EventHierarchy& state, const Box& window);
  /// A correction has changed a window, and with it what is far a little: tiles of the window, and those that had this
  /// share of the largest.
  void refresh(EventHierarchy& state, const Box& window, double least);
  /// The largest, of tiles that are looked at anew until the largest one is fresh.
  StretchMaximum greatest(EventHierarchy& state);
  /// s/s₀ of the bond that came second, as far as is known.
  [[nodiscard]] double second() const noexcept { return second_; }

  [[nodiscard]] std::int64_t bytes() const noexcept;

private:
  [[nodiscard]] Box boxOf(std::int64_t tile) const noexcept;
  [[nodiscard]] float measure(const EventHierarchy& state, std::int64_t tile) const;
  [[nodiscard]] StretchMaximum search(EventHierarchy& state, std::int64_t tile);

  const BondLattice& bonds_;
  int reach_;
  std::array<std::int64_t, 3> size_{ 16, 8, 1 }; ///< nodes of a tile: along x a strip of the bonds
  std::array<std::int64_t, 3> count_{ 1, 1, 1 }; ///< tiles
  std::array<std::vector<float>, 3> directions_; ///< e
  std::vector<std::vector<float>> inverse_;      ///< 1/(s₀|ξ|) by kind, of each bond of the stencil
  LayerShare share_;                             ///< of tiles
  std::vector<float> largest_;
  std::vector<std::int64_t> state_; ///< when it was looked at
  std::int64_t now_ = 0;
  double second_ = 0;
};

} // namespace lamella::peridynamics
