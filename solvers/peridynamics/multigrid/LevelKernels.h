#pragma once

#include <cstdint>

/// Row loops of the elastic multigrid, in single precision, compiled for several instruction sets.
namespace lamella::peridynamics
{

/// Entries of a symmetric d × d block: xx, yy, xy in 2D; xx, yy, zz, xy, yz, xz in 3D.
[[nodiscard]] constexpr int blockEntries(int dimension) noexcept
{
  return dimension == 3 ? 6 : 3;
}

/// One row of coarse nodes with everything that its product with a block stencil reads; [c] components, [e] entries.
struct BlockRow
{
  int half = 0;                  ///< neighbours on the forward side
  const float* here[3];          ///< of the field
  const float* diagonal[6];      ///<
  const float* block[6];         ///< entry e of the first neighbour; neighbour q lies q × blockStride further
  const std::int16_t* packed[6]; ///< the same in 16 bits, in place of `block`: to be multiplied by `scale` of both ends
  const float* scale = nullptr;  ///< of the nodes; null unless packed
  std::int64_t blockStride;      ///<
  std::int64_t nextRow = 0;      ///< from a block to the same node's of the next row: fetched ahead
  const std::int64_t* jump;      ///< from a node to neighbour q, in nodes; `half` values
  const std::int64_t* back;      ///< from the block A(i − q, i) to A(i, i + q)
  const std::uint8_t* mirrored;  ///< is there a row of blocks A(i − q, i)? Else they are zero; `half` values
  float* out[3];                 ///<
};

/// Rows of a product, with the fields' first node and the way from a row to the next; widths are multiples of eight.
struct WindowRows
{
  std::int64_t rows = 0;
  std::int64_t n = 0;
  const float* here[3]{};     ///< of the field
  std::int64_t hereRow = 0;   ///<
  const std::int64_t* jump{}; ///< from a node to its neighbours, in the field
  const float* plus[3]{};     ///< what the product is taken off; null: nothing
  std::int64_t plusRow = 0;   ///<
  float* out[3]{};            ///<
  std::int64_t outRow = 0;    ///<
};

struct LevelKernels
{
  /// out = plus − A x on the rows of a window, by the first row's matrix. Returns x·out, rows added up in double
  /// precision. @param mirrored of each row
  double (*window)(int dimension, const WindowRows& rows, const BlockRow& matrix, std::int64_t diagonalRow,
    const std::uint8_t* const* mirrored);
  /// out −= A x over n nodes; up to seven values after them are read, and written as they are.
  void (*subtractProduct)(int dimension, std::int64_t n, const BlockRow& row);
  /// d = a d + b D⁻¹ r; x += d. `inverse` holds the entries of D⁻¹. With a = 0 what d and, if `first`, x hold is not
  /// read.
  void (*chebyshev)(int dimension, std::int64_t n, float a, float b, const float* const* inverse, const float* const* r,
    float* const* d, float* const* x, bool first);
  /// out[X] += Σ w (½ v[2X − 1] + v[2X] + ½ v[2X + 1]), n coarse nodes, the sum being over fine rows v with weights w,
  /// in each of some fields. What lies up to sixteen nodes beyond the rows is read.
  void (*restrictRows)(
    std::int64_t n, int rows, const float* weights, const float* const* fine, int fields, float* const* out);
  /// v[2X] = c[X], v[2X + 1] = ½ (c[X] + c[X + 1]), n fine nodes, with c = w (c₀ + … ) the sum of `rows` coarse rows,
  /// and what `plus` has, unless it is null. What lies up to eight nodes beyond the rows is read.
  void (*interpolateRow)(std::int64_t n, float w, int rows, const float* const* coarse, const float* plus, float* v);
  /// w[i] += a k[i].
  void (*axpy)(std::int64_t n, float a, const float* k, float* w);

  // conjugate gradients in double precision
  double (*dot)(std::int64_t n, const double* a, const double* b);
  double (*dotMixed)(std::int64_t n, const double* a, const float* b);
  /// y += a x.
  void (*axpyDouble)(std::int64_t n, double a, const double* x, double* y);
  /// p = a z + b p.
  void (*direction)(std::int64_t n, const float* z, double a, double b, double* p);
  void (*toFloat)(std::int64_t n, double scale, const double* a, float* b);
};

/// The fastest that this processor can run.
[[nodiscard]] const LevelKernels& levelKernels();

} // namespace lamella::peridynamics
