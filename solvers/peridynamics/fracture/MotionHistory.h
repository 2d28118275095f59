#pragma once

#include "peridynamics/fracture/DynamicsStudy.h"

#include <vector>

namespace lamella::peridynamics
{

/// The points of a history as they come, and in a checkpoint.
class MotionHistory
{
public:
  void add(const MotionPoint& point);
  [[nodiscard]] const std::vector<MotionPoint>& points() const noexcept { return points_; }
  [[nodiscard]] double peak() const noexcept { return peak_; } ///< the largest stress, or 0 [Pa]

  void put(io::Checkpoint& checkpoint) const;
  /// @throws InputError for a checkpoint without a history
  void take(const io::Checkpoint& checkpoint);

private:
  std::vector<MotionPoint> points_;
  double peak_ = 0;
};

} // namespace lamella::peridynamics
