#pragma once

#include <cstddef>
#include <cstdint>

/// The loops of the lean solver over one half-row of nodes (those of even or of odd x), compiled once for every
/// instruction set and chosen at run time: as Kernels.h, whose rules hold here too.
namespace lamella::lbm
{

/// Link conductances by the phases at both ends, over the largest diffusivity.
struct PhaseLinks
{
  bool two = false;             ///< only two phase ids occur: the values below
  std::uint8_t second = 0;      ///< the id of the second of them
  double both[3] = { 1, 1, 1 }; ///< first with first, first with second, second with second
  /// Any ids: a link along an axis is table[axis][256 a + b].
  bool byAxis = false; ///< not one table for all axes
  const double* table[3] = { nullptr, nullptr, nullptr };
  const float* single[3] = { nullptr, nullptr, nullptr };
};

/// A node or wall beside a half-row, or nothing: weight 0. A wall: the row's own phases, values of 0, twice the weight
/// of a link.
struct RowSide
{
  const std::uint8_t* phase; ///< natural order, of x = 0
  const float* value;        ///< of the same half as the row
  float weight;
  float offset; ///< added to value there less value here
  bool wall;
};

/// What follows the first or the last node of a whole row along x.
struct RowEnd
{
  std::uint8_t phase = 0;
  float value = 0;
  float weight = 0;
  float offset = 0;
};

/// The field v is what is left of the values when the linear profile is taken off, in units of that profile's drop
/// from a node to the next.
struct PhaseRow
{
  std::int64_t nx;           ///< nodes of the whole row
  int part;                  ///< 0: the even ones, 1: the odd ones
  const std::uint8_t* phase; ///< of the whole row, natural order
  const float* west;         ///< v at x − 1 of the half's first node
  const float* own;          ///< v of the half
  const float* east;         ///< v at x + 1
  float step;                ///< offset of a link east: −1 where the profile falls along x, else 0; west the opposite
  RowEnd low;                ///< before x = 0
  RowEnd high;               ///< after x = nx − 1
  RowSide side[4];           ///< south, north, bottom, top
  const float* source;       ///< of the half, added to the residual; or null
};

/// Sums over the links east, north and top of a half-row, and over the walls whatever their side.
struct PhaseSums
{
  double energy = 0;            ///< Σ g Δ², Δ the drop along the link
  double flux[3] = { 0, 0, 0 }; ///< Σ g Δ of the links along x, y, z without walls
  double low = 0;               ///< Σ g Δ of walls below or before
  double high = 0;              ///< the same above or after
};

struct PhaseKernels
{
  /// Gauss–Seidel on a half-row: v += residual / Σ g.
  void (*relax)(const PhaseLinks& links, const PhaseRow& row, float* own);
  /// out[i] += residual of the i-th node of the half.
  void (*addResidual)(const PhaseLinks& links, const PhaseRow& row, float* out);
  /// Adds to the sums, in double. planes: null, or Σ g Δ of the link east of the i-th node of the half is added to its
  /// i-th element.
  void (*addSums)(const PhaseLinks& links, const PhaseRow& row, PhaseSums& sums, double* planes);
  /// Adds g Δ² of the links that addSums sums to those of their ends' phases a and b: sums[ids a + b] of any, which may
  /// be b's and a's too, ids² further an axis where tables differ; of two phases, sums[0], sums[1], sums[2] as
  /// PhaseLinks::both.
  void (*addEnergies)(const PhaseLinks& links, const PhaseRow& row, std::size_t ids, double* sums);
  /// out[x] = link along an axis from phase a[x] to phase b[x], n of them.
  void (*links)(
    const PhaseLinks& links, int axis, std::int64_t n, const std::uint8_t* a, const std::uint8_t* b, float* out);
  /// even[i] += coarse[i], odd[i] += coarse[i].
  void (*addToBoth)(std::int64_t evens, std::int64_t odds, const float* coarse, float* even, float* odd);
};

/// The fastest set that this processor can run.
[[nodiscard]] const PhaseKernels& phaseKernels();

} // namespace lamella::lbm
