#pragma once

#include <cstdint>

/// The loops over a row of elements, compiled once for every instruction set and chosen at run time: as Kernels.h of
/// the multigrid, whose rules hold here too.
namespace lamella::lbm
{

/// A row of elements along x and the four rows of nodes that it lies between: y and z low, y high, z high, both high.
/// Values are trilinear, u = Σ m_abc x^a y^b z^c over the unit cube around an element's centre; a gradient's
/// polynomials are orthogonal there, so an element is applied in its seven coefficients.
template <class Real>
struct ElementRow
{
  std::int64_t count;     ///< elements
  const Real* u[4];       ///< count + 1 nodes each
  const float* tensor[6]; ///< xx, yy, zz, xy, xz, yz of each element, over its edges: volume K_ab / (h_a h_b)
  double gradient[3];     ///< mean drop over an element, of the profile that u is the rest of; what rises is positive
};

struct ElementKernels
{
  /// out[k][i] += a(u, hat function of node i of row k), of this row of elements. `buffer`: 8 (count + 1) numbers.
  void (*applySingle)(const ElementRow<float>& row, float* const out[4], float* buffer);
  void (*applyDouble)(const ElementRow<double>& row, double* const out[4], double* buffer);
  /// Adds to `diagonal[k][i]` what this row gives of a(hat function, itself).
  void (*diagonal)(const ElementRow<float>& row, float* const out[4]);
  /// Mean flux of each element, that is tensor × mean gradient, and what it adds to the energy.
  void (*fluxes)(const ElementRow<double>& row, double* const flux[3], double* energy);
};

/// The fastest set that this processor can run.
[[nodiscard]] const ElementKernels& elementKernels();

} // namespace lamella::lbm
