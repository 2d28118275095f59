#pragma once

#include "lattice/Lattice.h"
#include "peridynamics/BondModel.h"

#include <array>
#include <cstdint>
#include <vector>

namespace lamella::peridynamics
{

/// A notch in units of the lattice, with its images across periodic sides.
class NotchCut
{
public:
  /// @param number for messages, from 1
  /// @throws ParameterError: no length (no area), a value that is not finite, wholly outside the sample
  NotchCut(const Notch& notch, std::size_t number, const Lattice& lattice, const std::array<bool, 3>& periodic);

  /// Could a bond of a node cross it?
  [[nodiscard]] bool near(const std::array<std::int64_t, 3>& node, int reach) const noexcept;
  /// Does the bond from a node to the one `step` further?
  [[nodiscard]] bool crosses(const std::array<std::int64_t, 3>& node, const std::array<int, 3>& step) const noexcept;

private:
  using Vector = std::array<double, 3>;

  int dimension_;
  std::vector<Vector> corners_; ///< of the images, in node numbers
  Vector along_{};
  Vector across_{}; ///< in 2D along z
  Vector normal_{};
  Vector low_{}; ///< box of all images
  Vector high_{};
};

} // namespace lamella::peridynamics
