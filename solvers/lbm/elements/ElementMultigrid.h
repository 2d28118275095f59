#pragma once

#include "lattice/PlaneParts.h"
#include "lbm/elements/ElementKernels.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace lamella::lbm
{

/// A box of elements and their nodes; along periodic axes the last plane of nodes is the first one again, and holds the
/// same values. Split over ranks it is a rank's planes of elements and the nodes on both sides of them: the last plane
/// of nodes is the next rank's first one.
struct ElementBox
{
  std::array<std::int64_t, 3> elements{ 1, 1, 1 };
  std::array<bool, 3> periodic{ false, false, false }; ///< of the whole box
  int fixed = -1;                                      ///< the axis whose two outer planes of nodes are held, or −1
  PlaneParts parts;                                    ///< of the planes of elements across z

  [[nodiscard]] std::int64_t nodes(int axis) const noexcept { return elements[axis] + 1; }
  [[nodiscard]] std::int64_t nodes() const noexcept { return nodes(0) * nodes(1) * nodes(2); }
  [[nodiscard]] std::int64_t count() const noexcept { return elements[0] * elements[1] * elements[2]; }
  [[nodiscard]] std::int64_t row(std::int64_t y, std::int64_t z) const noexcept
  {
    return nodes(0) * (y + nodes(1) * z);
  }
  /// Of the planes along an axis those that are nodes of their own, and this rank's.
  [[nodiscard]] std::int64_t owned(int axis) const noexcept
  {
    return elements[axis] + (periodic[axis] || (axis == 2 && !isLast()) ? 0 : 1);
  }
  [[nodiscard]] std::int64_t first() const noexcept { return parts.split() ? parts.first() : 0; }
  [[nodiscard]] bool isLast() const noexcept { return !parts.split() || parts.last() == parts.planes(); }
  /// Elements of all ranks along an axis, and nodes.
  [[nodiscard]] std::int64_t whole(int axis) const noexcept
  {
    return axis == 2 && parts.split() ? parts.planes() : elements[axis];
  }
  [[nodiscard]] std::int64_t wholeNodes() const noexcept { return (whole(0) + 1) * (whole(1) + 1) * (whole(2) + 1); }

  /// Adds up what the copies of a node got, and gives it to all. Collective.
  template <class Real>
  void addCopies(std::span<Real> values) const;
  /// Held nodes get 0.
  template <class Real>
  void hold(std::span<Real> values) const;
  /// Both.
  template <class Real>
  void close(std::span<Real> values) const
  {
    addCopies(values);
    hold(values);
  }
  /// Σ a b over the nodes of all ranks, of copies one; in parts that no number of threads changes. Collective.
  template <class A, class B>
  [[nodiscard]] double dot(const std::vector<A>& a, const std::vector<B>& b, int threads) const;
};

template <class A, class B>
double ElementBox::dot(const std::vector<A>& a, const std::vector<B>& b, int threads) const
{
  std::vector<double> sums(static_cast<std::size_t>(owned(2)), 0.0);
#pragma omp parallel for num_threads(threads) if (threads > 1) schedule(static)
  for (std::int64_t z = 0; z < owned(2); ++z)
    for (std::int64_t y = 0; y < owned(1); ++y)
    {
      const A* p = a.data() + row(y, z);
      const B* q = b.data() + row(y, z);
      double sum = 0;
#pragma omp simd reduction(+ : sum)
      for (std::int64_t x = 0; x < owned(0); ++x)
        sum += static_cast<double>(p[x]) * static_cast<double>(q[x]);
      sums[static_cast<std::size_t>(z)] += sum;
    }
  double total = 0;
  for (const double sum : sums)
    total += sum;
  parts.sum(std::span<double>(&total, 1));
  return total;
}

/// Fills the six rows of an ElementRow's tensors for the row of elements (y, z).
using TensorRows = std::function<void(std::int64_t y, std::int64_t z, float* const tensor[6])>;

/// Applies the elements of a box, row by row: planes of elements, or groups of them, in two colours, so that threads
/// change nothing.
class ElementOperator
{
public:
  ElementOperator(const ElementBox& box, TensorRows tensors, int threads);

  [[nodiscard]] const ElementBox& box() const noexcept { return box_; }
  [[nodiscard]] int threads() const noexcept { return threads_; }
  /// out = A u, closed. @param gradient as that of ElementRow
  template <class Real>
  void apply(std::span<const Real> u, std::span<Real> out, const std::array<double, 3>& gradient = { 0, 0, 0 }) const;
  /// The diagonal, closed but that held nodes keep theirs.
  void diagonal(std::span<float> out) const;
  /// f(y, z, flux along x, y, z of the elements of that row, energy of the row); in planes of z, each in one thread.
  using FluxRow = std::function<void(std::int64_t y, std::int64_t z, const double* const flux[3], double energy)>;
  void forFluxes(std::span<const double> u, const std::array<double, 3>& gradient, const FluxRow& f) const
  {
    forFluxes(u, gradient, { { { 0, box_.elements[1] }, { 0, box_.elements[2] } } }, f);
  }
  /// The same of some rows: y and z from the first on, the last not included.
  using RowRange = std::array<std::array<std::int64_t, 2>, 2>;
  void forFluxes(
    std::span<const double> u, const std::array<double, 3>& gradient, const RowRange& rows, const FluxRow& f) const;
  void tensorRow(std::int64_t y, std::int64_t z, float* const tensor[6]) const { tensors_(y, z, tensor); }

private:
  template <class Real, class F>
  void forRows(const RowRange& rows, F&& f) const;
  template <class Real, class F>
  void forRows(F&& f) const
  {
    forRows<Real>({ { { 0, box_.elements[1] }, { 0, box_.elements[2] } } }, f);
  }

  ElementBox box_;
  TensorRows tensors_;
  int threads_;
};

/// A V-cycle for trilinear elements with a tensor each: Chebyshev smoothing, coarse elements of the mean tensors of
/// those that they hold, which over uniform regions is the Galerkin product exactly. Axes along which elements couple
/// weakly are not coarsened. Any number of elements: of an odd one the last coarse element is half as long.
///
/// Symmetric, so that conjugate gradients may be preconditioned by it. Memory: 20 bytes a node of the finest box, a
/// seventh of 44 more for all others.
///
/// A box that is split over ranks has coarse ones that are split likewise, as long as all parts begin at even planes
/// and there are more than PlaneParts::fewNodes nodes; from there on every rank works out the whole of what is left. So
/// the cycle does not depend on the number of ranks, up to the order of sums.
class ElementMultigrid
{
public:
  explicit ElementMultigrid(const ElementOperator& finest);

  /// x ≈ A⁻¹ b, from x = 0; b is used up.
  void cycle(std::span<float> b, std::span<float> x);
  [[nodiscard]] std::size_t bytes() const noexcept;

private:
  struct Level
  {
    ElementOperator op;
    ElementBox made;             ///< what this rank makes of the finer level: its part, or the operator's box
    std::int64_t madeOffset = 0; ///< of the first node of `made` in the arrays
    std::array<std::vector<float>, 3> width;           ///< of the elements along each axis
    std::array<bool, 3> halved{ false, false, false }; ///< on the way to the next level
    std::vector<float> inverse;                        ///< 1 / diagonal; 0 at held nodes, and where nothing conducts
    std::vector<float> b, x;                           ///< of the next level's problem; none on the finest level
    std::vector<float> d, t;                           ///< direction, and its product
    float largest = 0;                                 ///< eigenvalue of inverse × A
    std::size_t tensorBytes = 0;

    explicit Level(const ElementOperator& o, const ElementBox& part)
      : op(o)
      , made(part)
    {
    }
    [[nodiscard]] bool gathered() const noexcept { return made.parts.split() && !op.box().parts.split(); }
  };

  void addLevel(const ElementOperator& op, const ElementBox& made);
  [[nodiscard]] bool coarsen();
  void findLargest(Level& level) const;
  void factorize();
  void cycle(std::size_t index, std::span<float> b, std::span<float> x);
  void smooth(Level& level, std::span<float> b, std::span<float> x, bool residual) const;
  void restrictTo(const Level& fine, std::span<float> b, Level& coarse) const;
  void addFrom(const Level& coarse, Level& fine, std::span<float> b, std::span<float> x) const;

  std::vector<std::unique_ptr<Level>> levels_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> direct_;
  std::vector<std::int64_t> unknown_; ///< by node of the coarsest box, −1: none
};

} // namespace lamella::lbm
