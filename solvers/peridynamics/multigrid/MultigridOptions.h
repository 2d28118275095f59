#pragma once

#include <cstddef>
#include <cstdint>

namespace lamella::peridynamics
{

struct MultigridOptions
{
  int degree = 1;              ///< Chebyshev steps before and after the coarser levels
  std::size_t twiceFrom = 2;   ///< levels halved so often are visited twice (W-cycle),
  std::size_t twiceBelow = 5;  ///< but not so often or more: that saves no iterations, and would double the messages
  std::int64_t coarsest = 100; ///< nodes of a level that is solved directly
  std::int64_t gather = 1024;  ///< nodes of a level that is not worth distributing
  /// Nodes from which on a coarse level's matrix is stored in 16 bits an entry (Level::packed()), where nobody else has
  /// nodes of it and no side is periodic; 0: none is.
  std::int64_t packFrom = 0;
  /// The finest level keeps neither its residual nor a direction: both come from products with the whole correction.
  /// Saves two vectors there and is as fast, to round-off the same. For a degree of one, and input in single precision.
  bool lean = false;
};

} // namespace lamella::peridynamics
