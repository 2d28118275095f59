#pragma once

#include <cstdint>

/// The loops of the multigrid preconditioner, one row at a time, compiled once for every instruction set and chosen at
/// run time. Single precision, but for the factors of the coarsest level. Rows are split by the parity of x: the even
/// nodes first, then, `half` floats on, the odd ones; so every colour of a multicolour sweep, and every coarse node, is
/// contiguous.
///
/// No standard library type crosses this interface or appears in the implementation: a template instantiated there
/// with wide instructions could be picked by the linker for the whole program.
namespace lamella::lbm
{

/// Largest number of links from a node into one half of the directions (27-point stencil).
inline constexpr int maxForward = 13;

/// Interpolation weights of one row of coarse cells, as shares of 65535: an array of `cells` values for each pair of
/// (kind of fine node, corner of the cell). Kinds by parity bits x + 2y + 4z, 1 … 7; corners likewise, 0 … 7. Corners
/// that a kind does not reach have no array.
struct CellWeights
{
  const std::uint16_t* w[8][8];
};

/// Links within one row of coarse cells, for the Galerkin product: rows of the fine lattice at (b, c), b, c = 0, 1, 2;
/// forward link arrays of each; null where nothing is stored.
struct CellLinks
{
  const float* link[3][3][maxForward]; ///< [b][c][direction]: start of the split row
};

struct Kernels
{
  /// u = (f + Σ g v) / Σ g over 2·dimension straight links, for one half-row of n nodes.
  /// links and neighbours: west, east, south, north, bottom, top.
  void (*relaxStraight)(
    int count, std::int64_t n, float* u, const float* f, const float* const* g, const float* const* v);
  /// The same from zero: u = f / Σ g.
  void (*relaxStraightFromZero)(int count, std::int64_t n, float* u, const float* f, const float* const* g);
  /// r = f − Σ g (u − v).
  void (*residualStraight)(
    int count, std::int64_t n, float* r, const float* f, const float* u, const float* const* g, const float* const* v);
  /// q = Σ g (p − v); returns Σ p q.
  double (*applyStraight)(
    int count, std::int64_t n, float* q, const float* p, const float* const* g, const float* const* v);
  /// The same with `inverse` = 1 / Σ g at hand, for 8 or 26 links.
  void (*relaxGeneral)(int count, std::int64_t n, float* u, const float* f, const float* inverse, const float* const* g,
    const float* const* v);
  void (*residualGeneral)(
    int count, std::int64_t n, float* r, const float* f, const float* u, const float* const* g, const float* const* v);
  double (*applyGeneral)(
    int count, std::int64_t n, float* q, const float* p, const float* const* g, const float* const* v);
  /// inverse = 1 / Σ g.
  void (*inverseSum)(int count, std::int64_t n, float* inverse, const float* const* g);

  /// y += a x.
  void (*axpy)(std::int64_t n, float a, const float* x, float* y);
  /// p = z + b p.
  void (*xpby)(std::int64_t n, const float* z, float b, float* p);
  double (*dot)(std::int64_t n, const float* x, const float* y);

  /// out[i] += w[i] x[i] / 65535.
  void (*addWeighted)(std::int64_t n, float* out, const std::uint16_t* w, const float* x);
  /// split row → natural order (n nodes) and back.
  void (*merge)(std::int64_t n, std::int64_t half, const float* split, float* natural);
  void (*split)(std::int64_t n, std::int64_t half, const float* natural, float* splitRow);

  /// Galerkin product of one row of coarse cells, first … last − 1: adds −g dₖdₗ of every fine link to the coarse
  /// links, dₖ being the difference of its ends' weights of corner k.
  /// weights[b/2][c/2]: of the cell rows that hold the fine rows b, c = 0 … 2; values at cell i + 1 are read too.
  /// out[b][c][direction]: coarse rows in natural order, at b, c = 0, 1.
  void (*galerkin)(int dimension, bool straight, std::int64_t first, std::int64_t last, std::int64_t half,
    const CellLinks& links, const CellWeights (*weights)[2], float* const (*out)[2][maxForward]);

  /// L D Lᵀ in place of a symmetric matrix of n columns, each its diagonal and the `width` elements below that: a
  /// column becomes that of 1 / D and, below, D times that of L. False where the matrix is not positive definite.
  bool (*factorizeBand)(std::int64_t n, std::int64_t width, double* band);
  /// Right-hand side in, solution out.
  void (*solveBand)(std::int64_t n, std::int64_t width, const double* band, double* x);

  const char* name; ///< of the instruction set: "x86-64", "x86-64-v3" (AVX2), "x86-64-v4" (AVX-512), "generic"
};

/// The fastest set that this processor can run.
[[nodiscard]] const Kernels& kernels();

/// Forward directions in the order of the link arrays; the first 2 (2D) or 3 (3D) are the straight ones.
inline constexpr int directions2[4][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 1, 1, 0 }, { -1, 1, 0 } };
inline constexpr int directions3[13][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 1, 1, 0 }, { -1, 1, 0 },
  { 1, 0, 1 }, { -1, 0, 1 }, { 0, 1, 1 }, { 0, -1, 1 }, { 1, 1, 1 }, { -1, 1, 1 }, { 1, -1, 1 }, { -1, -1, 1 } };

} // namespace lamella::lbm
