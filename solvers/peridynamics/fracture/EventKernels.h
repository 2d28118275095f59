#pragma once

#include "peridynamics/multigrid/LevelKernels.h"

#include <cstdint>

/// Row loops of the local corrections around broken bonds, in single precision, compiled for several instruction sets.
namespace lamella::peridynamics
{

/// Nodes of a row are visited by so many at a time.
inline constexpr std::int64_t eventLanes = 8;

/// The springs of a window on the finest level, by its first row.
struct SpringRows
{
  int count = 0;              ///< bonds of the half stencil
  const float* const* spring; ///< k/|ξ| of the bonds that begin in the row
  const float* const* back;   ///< of those that end there, at their first nodes, moved to the second's place
  std::int64_t springRow = 0; ///< from a row to the next
  const float* direction[3];  ///< e; `count` values each
};

/// Rows of a window for a step of conjugate gradients, by their first nodes.
struct StepRows
{
  std::int64_t rows = 0;
  std::int64_t n = 0;
  float* r[3]{};             ///< residual
  float* p[3]{};             ///< direction
  float* q[3]{};             ///< −A p, then D⁻¹ r
  std::int64_t workRow = 0;  ///< of these
  const float* inverse[6]{}; ///< entries of D⁻¹
  float* moved[2][3]{};      ///< what is moved along p, none to two fields
  std::int64_t levelRow = 0; ///< of these
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
  /// out = plus − A u. Returns u·out, rows added up in double precision.
  double (*springs)(int dimension, const WindowRows& rows, const SpringRows& springs);
  /// p = D⁻¹ r. Returns r·p.
  double (*precondition)(int dimension, const StepRows& rows);
  /// Moves by a p; r += a q; q = D⁻¹ r. Returns r·q.
  double (*step)(int dimension, const StepRows& rows, float a);
  /// p = q + b p.
  void (*turn)(int dimension, const StepRows& rows, float b);
  /// to += a from.
  void (*addRows)(
    std::int64_t rows, std::int64_t n, float a, const float* from, std::int64_t fromRow, float* to, std::int64_t toRow);
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
