#pragma once

#include <cstdint>

/// Row loops of the local corrections around broken bonds, in single precision, compiled for several instruction sets.
namespace lamella::peridynamics
{

/// Nodes of a row are visited by so many at a time.
inline constexpr std::int64_t eventLanes = 8;

/// One row of the finest level with what its product with the springs reads; pointers at the first node.
struct SpringRows
{
  int count = 0;              ///< bonds of the half stencil
  const float* here[3];       ///< of the field
  float* out[3];              ///<
  const std::int64_t* jump;   ///< from the first node of a bond to the second, in the field; `count` values
  const float* const* spring; ///< k/|ξ| of the bonds that begin in this row
  const float* const* back;   ///< of those that end here, at their first nodes, moved to the second's place
  const float* direction[3];  ///< e; `count` values each
};

/// A box of nodes whose bonds are searched for the most stretched: one strip of sixteen nodes wide.
struct TileRows
{
  int dimension = 2;
  int count = 0;            ///< bonds of the half stencil
  const float* u[3];        ///< of the row
  const std::int64_t* jump; ///< in that field
  const float* direction[3];
  const float* const* inverse; ///< 1/(s₀|ξ|) of the bonds of the row, 0 where there is none
};

struct EventKernels
{
  /// out = −A u over n nodes.
  void (*springs)(int dimension, std::int64_t n, const SpringRows& rows);
  /// z = D⁻¹ r. Returns r·z. `inverse` holds the entries of D⁻¹.
  double (*precondition)(
    int dimension, std::int64_t n, const float* const* inverse, const float* const* r, float* const* z);
  double (*dot)(std::int64_t n, const float* a, const float* b);
  /// p = z + b p.
  void (*direction)(std::int64_t n, const float* z, float b, float* p);
  /// out[x] = table[kind], the kind's bits being `bit` of planes' words.
  void (*select)(
    int planes, const std::uint32_t* const* words, int bit, const float* table, std::int64_t n, float* out);
  /// Largest s/s₀ over a strip.
  float (*stretch)(const TileRows& rows);
};

/// The fastest that this processor can run.
[[nodiscard]] const EventKernels& eventKernels();

} // namespace lamella::peridynamics
