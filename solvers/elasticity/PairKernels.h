#pragma once

#include "elasticity/ElasticKernels.h"

#include <cstddef>
#include <cstdint>

/// What pairs of fields of the same elements have in common: the parts of ∫ ε_i : C : ε_j that each modulus is the
/// factor of, phase by phase. Compiled as ElasticKernels.
namespace lamella::elasticity
{

/// Parts of a pair: those of λ in the mean strain, of λ in the strains that vary over an element, of μ; or axial ones,
/// as axialSize tells.
constexpr int pairParts(bool axial)
{
  return axial ? axialSize : 3;
}
constexpr int pairsOf(int fields)
{
  return fields * (fields + 1) / 2;
}

/// A row of elements and their fields.
template <int D, class Real>
struct PairRow
{
  const ElasticRow<D, Real>* fields; ///< moduli and `initial` do not count; stretchX is not null
  const std::uint8_t* phase;         ///< of each element
  const std::int16_t* slot;          ///< by phase id: whose sums they add to; below 0: none's
  const float* axis;                 ///< of each element, three numbers of any length; of axial parts alone
  void* scratch;                     ///< pairScratch bytes a sum, zeros before and after
};
inline constexpr std::size_t pairScratch = 64;

/// Adds to sums[(slot * parts + part) * pairs + triangle(fields, i, j)], in the kernels' unit of strain.
template <int D, class Real>
using PairKernel = void (*)(const PairRow<D, Real>& row, double* sums);

/// [one field or voigtSize(D) of them][axial]
struct PairKernels
{
  PairKernel<2, float> plane[2][2];
  PairKernel<2, double> planeDouble[2][2];
  PairKernel<3, float> space[2][2];
  PairKernel<3, double> spaceDouble[2][2];
};

/// The fastest set that this processor can run.
[[nodiscard]] const PairKernels& pairKernels();

} // namespace lamella::elasticity
