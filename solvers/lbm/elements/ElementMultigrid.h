#pragma once

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
/// same values.
struct ElementBox
{
  std::array<std::int64_t, 3> elements{ 1, 1, 1 };
  std::array<bool, 3> periodic{ false, false, false };
  int fixed = -1; ///< the axis whose two outer planes of nodes are held, or −1

  [[nodiscard]] std::int64_t nodes(int axis) const noexcept { return elements[axis] + 1; }
  [[nodiscard]] std::int64_t nodes() const noexcept { return nodes(0) * nodes(1) * nodes(2); }
  [[nodiscard]] std::int64_t count() const noexcept { return elements[0] * elements[1] * elements[2]; }
  [[nodiscard]] std::int64_t row(std::int64_t y, std::int64_t z) const noexcept
  {
    return nodes(0) * (y + nodes(1) * z);
  }
  /// Of the planes along an axis those that are nodes of their own.
  [[nodiscard]] std::int64_t owned(int axis) const noexcept { return elements[axis] + (periodic[axis] ? 0 : 1); }

  /// Adds up what both copies of a node got, and gives it to both; held nodes get 0.
  template <class Real>
  void close(std::span<Real> values) const;
};

/// Fills the six rows of an ElementRow's tensors for the row of elements (y, z).
using TensorRows = std::function<void(std::int64_t y, std::int64_t z, float* const tensor[6])>;

/// Applies the elements of a box, row by row: planes of elements in two colours, so that threads change nothing.
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
  void forFluxes(std::span<const double> u, const std::array<double, 3>& gradient,
    const std::function<void(std::int64_t y, std::int64_t z, const double* const flux[3], double energy)>& f) const;
  void tensorRow(std::int64_t y, std::int64_t z, float* const tensor[6]) const { tensors_(y, z, tensor); }

private:
  template <class Real, class F>
  void forRows(F&& f) const;

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
    std::array<std::vector<float>, 3> width;           ///< of the elements along each axis
    std::array<bool, 3> halved{ false, false, false }; ///< on the way to the next level
    std::vector<float> inverse;                        ///< 1 / diagonal; 0 at held nodes, and where nothing conducts
    std::vector<float> b, x;                           ///< of the next level's problem; none on the finest level
    std::vector<float> d, t;                           ///< direction, and its product
    float largest = 0;                                 ///< eigenvalue of inverse × A
    std::size_t tensorBytes = 0;

    explicit Level(const ElementOperator& o)
      : op(o)
    {
    }
  };

  void addLevel(const ElementOperator& op);
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
