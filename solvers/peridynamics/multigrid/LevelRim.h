#pragma once

#include "core/Communicator.h"
#include "peridynamics/NodeField.h"

#include <array>

namespace lamella::peridynamics
{

/// Fills the rim of fields, and adds up what was summed into it: images at periodic sides, and the rows of the slabs
/// next to this rank's along the slowest axis (y in 2D, z in 3D).
class LevelRim
{
public:
  LevelRim() = default;
  /// @param comm must outlive this; ranks hold the slabs in order
  LevelRim(const NodeLayout& layout, const std::array<bool, 3>& periodic, const Communicator& comm);

  /// See exchangeRim(). Collective.
  template <class Real>
  void fill(NodeField<Real>& field) const;

  /// Adds what lies in the rim to the nodes whose images those are: all of the rim, but of the slowest axis only the
  /// first layer beyond the last own one. Collective. The rim keeps what was in it.
  template <class Real>
  void addBack(NodeField<Real>& field) const;

private:
  [[nodiscard]] int slowest() const noexcept { return layout_.dimension - 1; }

  NodeLayout layout_;
  std::array<bool, 3> periodic_{};
  const Communicator* comm_ = nullptr;
  int below_ = -1; ///< rank of the slab before this one, itself when periodic and alone; -1: none
  int above_ = -1;
};

} // namespace lamella::peridynamics
