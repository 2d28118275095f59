#pragma once

#include "elasticity/ElasticKernels.h"
#include "elasticity/PairKernels.h"
#include "lattice/PlaneParts.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace lamella::elasticity
{

/// A box of elements in D dimensions, and its nodes. Along x the last node of a row is always stored, as a copy of the
/// first one where x is periodic; along the other axes only nodes of their own are. Arrays hold one component after the
/// other, planes of the last axis one after the other, each plane with some spare values behind it. Of a box that is
/// split over ranks they hold the rank's own planes, which are numbered as the whole box's.
template <int D>
struct ElasticGrid
{
  std::array<std::int64_t, D> elements{};
  std::array<bool, D> periodic{};
  /// Of the two outer layers of nodes across an axis, which components are held at 0: held[axis][component].
  std::array<std::array<bool, D>, D> held{};
  /// Edges of the elements along each axis over `edge`; empty: all of them 1.
  std::array<std::vector<float>, D> width;
  double edge = 1; ///< in edges of the finest elements along x
  PlaneParts parts;

  [[nodiscard]] std::int64_t nodes(int axis) const noexcept { return elements[axis] + (periodic[axis] ? 0 : 1); }
  [[nodiscard]] std::int64_t rows() const noexcept { return D == 3 ? nodes(1) : 1; } ///< of nodes in a plane
  [[nodiscard]] std::int64_t elementRows() const noexcept { return D == 3 ? elements[1] : 1; }
  [[nodiscard]] std::int64_t planes() const noexcept { return nodes(D - 1); }
  [[nodiscard]] std::int64_t elementPlanes() const noexcept { return elements[D - 1]; }
  /// The rank's own planes of nodes, and of elements, each above the plane of nodes of its number.
  [[nodiscard]] std::int64_t first() const noexcept { return parts.split() ? parts.first() : 0; }
  [[nodiscard]] std::int64_t last() const noexcept { return parts.split() ? parts.last() : planes(); }
  [[nodiscard]] std::int64_t lastElements() const noexcept { return std::min(last(), elementPlanes()); }
  [[nodiscard]] std::int64_t rowLength() const noexcept { return elements[0] + 1; }
  [[nodiscard]] std::int64_t planeStride() const noexcept { return rowLength() * rows() + spareValues; }
  [[nodiscard]] std::int64_t componentStride() const noexcept { return planeStride() * (last() - first()); }
  [[nodiscard]] std::size_t values() const noexcept { return static_cast<std::size_t>(D * componentStride()); }
  [[nodiscard]] std::int64_t at(std::int64_t row, std::int64_t plane) const noexcept
  {
    return (plane - first()) * planeStride() + row * rowLength();
  }
  /// f(first place, how many) of every run of one component's values in a row that is held.
  template <class F>
  void forHeld(std::int64_t row, std::int64_t plane, int component, F&& f) const
  {
    const auto c = static_cast<std::size_t>(component);
    const bool whole = (held[D - 1][c] && (plane == 0 || plane == planes() - 1)) ||
      (D == 3 && held[1][c] && (row == 0 || row == rows() - 1));
    if (whole)
      f(std::int64_t{ 0 }, rowLength());
    else if (held[0][c])
    {
      f(std::int64_t{ 0 }, std::int64_t{ 1 });
      f(elements[0], std::int64_t{ 1 });
    }
  }
  /// Of the whole box, without copies.
  [[nodiscard]] std::int64_t ownNodes() const noexcept { return nodes(0) * rows() * planes(); }
  /// Splits its planes over ranks, unless it is small.
  void share(const Communicator& ranks)
  {
    if (ownNodes() > PlaneParts::fewNodes)
      parts = PlaneParts(planes(), periodic[D - 1], ranks);
  }
  [[nodiscard]] bool stretched() const noexcept
  {
    return std::ranges::any_of(
      width, [](const auto& w) { return !w.empty(); });
  }
  [[nodiscard]] float widthOf(int axis, std::int64_t i) const
  {
    return width[axis].empty() ? 1.0F : width[axis][static_cast<std::size_t>(i)];
  }
};

/// The moduli of a row of elements: sets `rows` to them, as they are stored or written into `buffer`; each with zeros
/// for spareValues after the last.
template <class Real>
using ModuliRows = std::function<void(std::int64_t row, std::int64_t plane, Real* const* buffer, const Real** rows)>;

/// What a body is loaded by besides its displacements.
template <int D>
struct ElasticLoad
{
  std::array<double, 6> strain{}; ///< mean strain that displacements are the rest of, Voigt's order, shears γ
  /// Stress to add of a row of elements, over the largest modulus; or none.
  std::function<void(std::int64_t row, std::int64_t plane, double* const* stress)> initial;
};

/// A field of a box: displacements, and the mean strain that they are the rest of.
template <class Real>
struct StrainField
{
  const Real* u = nullptr;
  std::array<double, 6> strain{};
};

/// Whose parts energies of pairs of fields are told by, as PairRow has them of a row.
struct PairPhases
{
  std::function<const std::uint8_t*(std::int64_t row, std::int64_t plane)> phase;
  std::function<const float*(std::int64_t row, std::int64_t plane)> axis; ///< none: parts are not axial
  std::array<std::int16_t, 256> slot{};
  std::size_t slots = 0;
};

/// The product with the stiffness of a box of elements, made plane by plane: once a plane of nodes is complete, it is
/// handed over and may replace the values it was made of. Each plane is worked out by one thread and in one order, so
/// that the number of threads changes nothing.
template <int D>
class ElasticOperator
{
public:
  static constexpr int rowsAround = 1 << (D - 1);

  /// @param exact  the moduli in double, or none: those in single precision are taken
  ElasticOperator(ElasticGrid<D> grid, bool isotropic, ModuliRows<float> moduli, ModuliRows<double> exact, int threads);

  [[nodiscard]] const ElasticGrid<D>& grid() const noexcept { return grid_; }
  [[nodiscard]] bool isotropic() const noexcept { return isotropic_; }
  [[nodiscard]] int threads() const noexcept { return threads_; }
  [[nodiscard]] int moduliCount() const noexcept { return isotropic_ ? 2 : stiffnessSize(D); }
  void moduliRow(std::int64_t row, std::int64_t plane, float* const* buffer, const float** rows) const
  {
    moduli_(row, plane, buffer, rows);
  }
  void moduliRow(std::int64_t row, std::int64_t plane, double* const* buffer, const double** rows) const;
  /// The thread's planes of nodes are [first, last); an even number but for the last thread's.
  [[nodiscard]] std::array<std::int64_t, 2> slab(int thread) const noexcept;
  [[nodiscard]] std::size_t bytes() const noexcept;

  /// visit(thread, plane, row, sums) for every row of nodes, where sums[c] are (A u)_c, zero where it is held; with
  /// `diagonal` sums[D] is the mean diagonal of A. `u`: null for the diagonal alone. visit may overwrite u's row.
  /// endPlane(thread, plane) follows a plane's last row.
  template <class Real, class Visit, class End>
  void sweep(const Real* u, const ElasticLoad<D>* load, bool diagonal, Visit&& visit, End&& endPlane) const;
  template <class Real, class Visit>
  void sweep(const Real* u, const ElasticLoad<D>* load, bool diagonal, Visit&& visit) const
  {
    sweep<Real>(
      u, load, diagonal, std::forward<Visit>(visit), [](int, std::int64_t) {});
  }

  /// Of a row of elements, by its thread: mean stress over the largest modulus, by Voigt's order, mean strain, and
  /// ∫ σ : ε over a voxel's volume.
  using StressRow = std::function<void(std::int64_t row, std::int64_t plane, const ElasticRow<D, double>& elements,
    const double* const* stress, const double* const* strain, double energy)>;
  /// f for every row of elements of the rank. A plane's rows follow each other in one thread.
  template <class Real>
  void forStresses(const Real* u, const ElasticLoad<D>* load, const StressRow& f) const;

  /// f(thread, row, plane, rows) for every row of elements of the rank, with the nodes around it of each field; moduli
  /// are not told, stretchX is not null. A plane's rows follow each other in one thread.
  template <class Real>
  using RowsOfFields =
    std::function<void(int thread, std::int64_t row, std::int64_t plane, std::span<const ElasticRow<D, Real>> rows)>;
  template <class Real>
  void forRows(std::span<const StrainField<Real>> fields, const RowsOfFields<Real>& f) const;

  /// f(plane, sums) for every plane of elements of the rank, by its thread: sums of PairKernel over the plane, of
  /// strains over 1, ∫ over a voxel's volume. @param fields one, or voigtSize(D)
  template <class Real>
  void forPairs(std::span<const StrainField<Real>> fields, const PairPhases& phases,
    const std::function<void(std::int64_t plane, const double* sums)>& f) const;

private:
  /// The planes of all components below the rank's own ones, and behind them those above.
  template <class Real>
  void planesBeside(const Real* u, std::vector<Real>& beside) const;
  /// A row of nodes around a row of elements, of one component. @param beside planesBeside()
  template <class Real>
  const Real* nodesAround(const Real* u, const std::vector<Real>& beside, std::int64_t row, std::int64_t plane,
    int which, int component) const;

  ElasticGrid<D> grid_;
  bool isotropic_;
  ModuliRows<float> moduli_;
  ModuliRows<double> exact_;
  int threads_;
  std::int64_t sumLength_; ///< of a row of sums or moduli, spare values included
  std::vector<float> stretchX_;
  mutable std::vector<std::vector<float>> sums_; ///< by thread: two planes of D + 1 rows of sums
  mutable std::vector<float> rims_;              ///< by thread: its first and its last plane as they were
  mutable std::vector<float> beside_;            ///< of a box that is split: planesBeside()
};

/// The factor between a strain and the sum of signed corner values that stands for it in a kernel.
template <int D>
inline constexpr double cornerFactor = 1.0 / (1 << (D - 1));

} // namespace lamella::elasticity
