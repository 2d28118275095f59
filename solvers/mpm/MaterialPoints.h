#pragma once

#include "core/AlignedAllocator.h"
#include "lattice/Decomposition.h"
#include "lattice/Lattice.h"
#include "mpm/Tensor.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lamella::mpm
{

/// Material points as a structure of arrays: one column of doubles a component, each with a few values to spare behind
/// the last point, so that kernels can read whole vectors.
/// Bytes a point: 8 (3 Dim + Dim² + 2 + history) + 5, which is 101 in 2D and 165 in 3D without history. The affine
/// velocity C is stored, with Dim² columns more, only where it is given point by point and cannot be had from a grid.
template <int Dim>
class MaterialPoints
{
public:
  static_assert(Dim == 2 || Dim == 3);
  /// First columns; matrices row by row.
  static constexpr int positions = 0;                     ///< x [m]
  static constexpr int velocities = Dim;                  ///< v [m/s]
  static constexpr int deformations = 2 * Dim;            ///< F [-]; of an elastic-plastic law its elastic part
  static constexpr int masses = deformations + Dim * Dim; ///< [kg], per metre of depth in 2D
  static constexpr int volumes = masses + 1;              ///< at the start [m³], [m²] in 2D
  static constexpr int axes = masses + 2;                 ///< unit vector along the wall, at the start
  static constexpr int histories = masses + 2 + Dim;      ///< what a law remembers beside F
  static constexpr std::size_t padding = 16;              ///< values to spare

  /// Points at rest (v = 0, C = 0), undeformed (F = I), of no mass, with their axis along x, of phase 0, numbered from
  /// 0.
  /// @param history numbers a point that the law remembers, at the start 0; at most mostHistory
  explicit MaterialPoints(std::size_t count = 0, int history = 0);

  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  [[nodiscard]] int history() const noexcept { return columns_ - histories; }
  /// Those that are stored, C last.
  [[nodiscard]] int columns() const noexcept { return columns_ + (storesAffines() ? Dim * Dim : 0); }
  /// A column: count() values, and `padding` more behind them that may be read.
  [[nodiscard]] std::span<double> column(int c) noexcept { return { at(c), count_ }; }
  [[nodiscard]] std::span<const double> column(int c) const noexcept
  {
    return { const_cast<MaterialPoints*>(this)->at(c), count_ };
  }
  [[nodiscard]] std::span<std::uint8_t> phase() noexcept { return { phase_.data(), count_ }; }
  [[nodiscard]] std::span<const std::uint8_t> phase() const noexcept { return { phase_.data(), count_ }; }
  [[nodiscard]] std::span<std::uint32_t> id() noexcept { return id_; } ///< stays with a point when they are sorted
  [[nodiscard]] std::span<const std::uint32_t> id() const noexcept { return id_; }
  /// From a column to the next, in doubles.
  [[nodiscard]] std::size_t pitch() const noexcept { return pitch_; }
  [[nodiscard]] std::size_t bytes() const noexcept;

  /// The affine velocity C [1/s] of APIC: v(y) ≈ v + C (y − x). One for all points, or one each.
  [[nodiscard]] Matrix<Dim> affine(std::size_t p) const noexcept
  {
    return storesAffines() ? matrix(affines(), p) : common_;
  }
  [[nodiscard]] bool storesAffines() const noexcept { return stored_; }
  /// Of all points, where it is not stored.
  [[nodiscard]] const Matrix<Dim>& commonAffine() const noexcept { return common_; }
  /// First column of C; only where it is stored.
  [[nodiscard]] int affines() const noexcept { return columns_; }
  /// That of all points; nothing is stored.
  void setAffines(const Matrix<Dim>& c) noexcept;
  /// Stores that of each point, which is what it was.
  void storeAffines();
  void setAffine(std::size_t p, const Matrix<Dim>& c)
  {
    storeAffines();
    setMatrix(affines(), p, c);
  }
  /// C becomes keep C, and on the diagonal of an axis more by a rate [1/s].
  void changeAffines(double keep, int axis, double rate);
  /// All numbers of a point in the order of files: position, velocity, C, deformation gradient, mass, initial volume,
  /// wall axis, history.
  [[nodiscard]] int numbers() const noexcept { return columns_ + Dim * Dim; }
  /// A column for each but those of C, which are −1.
  [[nodiscard]] static constexpr int columnOf(int number) noexcept
  {
    return number < deformations ? number : number < deformations + Dim * Dim ? -1 : number - Dim * Dim;
  }

  static constexpr int mostHistory = 8;
  /// What a point remembers beside F: history() numbers, and then none.
  [[nodiscard]] std::array<double, mostHistory> memory(std::size_t p) const noexcept
  {
    std::array<double, mostHistory> a{};
    for (int i = 0; i < history(); ++i)
      a[static_cast<std::size_t>(i)] = column(histories + i)[p];
    return a;
  }

  [[nodiscard]] Vector<Dim> vector(int first, std::size_t p) const noexcept
  {
    Vector<Dim> a;
    for (int i = 0; i < Dim; ++i)
      a[i] = column(first + i)[p];
    return a;
  }
  void setVector(int first, std::size_t p, const Vector<Dim>& a) noexcept
  {
    for (int i = 0; i < Dim; ++i)
      column(first + i)[p] = a[i];
  }
  [[nodiscard]] Matrix<Dim> matrix(int first, std::size_t p) const noexcept
  {
    Matrix<Dim> a;
    for (int i = 0; i < Dim * Dim; ++i)
      a.m[i] = column(first + i)[p];
    return a;
  }
  void setMatrix(int first, std::size_t p, const Matrix<Dim>& a) noexcept
  {
    for (int i = 0; i < Dim * Dim; ++i)
      column(first + i)[p] = a.m[i];
  }

  /// Puts them into a new order: point k becomes what order[k] was; each point once.
  void reorder(std::span<const std::uint32_t> order);

private:
  [[nodiscard]] double* at(int c) noexcept
  {
    return c < columns_ ? data_.data() + c * pitch_ : affine_.data() + (c - columns_) * pitch_;
  }

  std::size_t count_ = 0;
  std::size_t pitch_ = 0;
  int columns_ = histories;
  std::vector<double, AlignedAllocator<double>> data_;
  std::vector<double, AlignedAllocator<double>> affine_; ///< C by columns, or nothing
  bool stored_ = false;
  Matrix<Dim> common_{}; ///< C where it is not stored
  std::vector<std::uint8_t> phase_;
  std::vector<std::uint32_t> id_;
};

struct PointOptions
{
  int perNode = 2;                     ///< points along each direction of a lattice node's cell
  std::vector<double> density{ 1500 }; ///< by phase [kg/m³]; a single value is that of all phases
  std::uint8_t empty = 0;              ///< phase that has no points
  int history = 0;                     ///< numbers a point that the law remembers
};

/// Points in all nodes of a lattice but those of the empty phase, evenly spread over each node's cell, at rest.
/// @param phase lattice.count() phases
/// @param axis lattice.count() directions along the wall, any length; a zero vector, or none at all: along x
/// @throws ParameterError: a lattice of another dimension, perNode < 1, a density that is not positive or lacks
/// @throws InputError: arrays of another length, nothing but the empty phase, more than 2³² − 1 points
template <int Dim>
[[nodiscard]] MaterialPoints<Dim> pointsFromLattice(const Lattice& lattice, std::span<const std::uint8_t> phase,
  std::span<const std::array<float, Dim>> axis, const PointOptions& options);

/// The same of a part of the lattice, which may be nothing but the empty phase: the points, to the last bit, that have
/// the numbers from firstNumber on among those of the whole lattice, where the part is whole rows, layers of it in 3D.
/// @param phase part.count() phases; directions likewise
template <int Dim>
[[nodiscard]] MaterialPoints<Dim> pointsFromLattice(const Lattice& lattice, const Block& part,
  std::span<const std::uint8_t> phase, std::span<const std::array<float, Dim>> axis, const PointOptions& options,
  std::int64_t firstNumber);

extern template class MaterialPoints<2>;
extern template class MaterialPoints<3>;

} // namespace lamella::mpm
