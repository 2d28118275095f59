#pragma once

#include <array>
#include <string>
#include <vector>

namespace lamella::statistics
{

/// A number of a stress tensor.
enum class StressMeasure
{
  XX,
  YY,
  ZZ,
  XY,
  YZ,
  XZ,
  Mean,       ///< a third of the trace
  VonMises,   ///< √(3/2 s:s) with s the deviator
  Principal1, ///< the largest principal value
  Principal2,
  Principal3 ///< the smallest
};

/// xx, yy, zz, xy, yz, xz: VTK's order.
using SymmetricTensor = std::array<double, 6>;

/// Its components must be finite.
[[nodiscard]] double measure(const SymmetricTensor& stress, StressMeasure what);

/// "yy", "mean", "von-mises", "principal-1", ..., in the order of StressMeasure.
[[nodiscard]] const std::vector<std::string>& stressMeasureNames();

} // namespace lamella::statistics
