#pragma once

#include "mpm/BlockRows.h"

#include <Eigen/Cholesky>

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

/// Internal: what preconditions the conjugate gradients of PointStiffness.h.
namespace lamella::mpm
{

/// Where the unknowns of a level are; along an axis that is periodic the length of the period [spacings], else 0.
template <int Dim>
struct NodePlaces
{
  std::vector<std::array<double, Dim>> at; ///< [spacings]
  std::array<double, Dim> period{};

  /// The way from one place to another, around a period where that is shorter.
  [[nodiscard]] std::array<double, Dim> way(
    const std::array<double, Dim>& from, const std::array<double, Dim>& to) const;
};

/// Algebraic multigrid by smoothed aggregation (Vaněk, Mandel and Brezina, Computing 56 (1996) 179): nodes that hang
/// together become one that moves as a rigid body, so that walls a few cells thick, which bend and turn, have on every
/// level what they need, and walls that only a lumen parts are never one. Polynomials of Chebyshev's smooth.
template <int Dim>
class PointMultigrid
{
public:
  static constexpr int motions = Dim == 3 ? 6 : 3; ///< of a rigid body

  /// @param matrix symmetric, its diagonal 1; a value that is held has a row of zeros
  /// @param scale of every value: that of the displacement is this times the unknown's; 0 where it is held
  /// @param told asked now and then; throws to stop
  PointMultigrid(const BlockRows<Dim>& matrix, const std::vector<double>& scale, NodePlaces<Dim> places,
    const std::function<void()>& told);

  /// One V cycle from 0 for each of Many right-hand sides: symmetric. @param b, x as BlockRows has them
  template <int Many>
  void apply(const double* b, double* x) const;

  [[nodiscard]] std::size_t bytes() const noexcept;
  [[nodiscard]] int levels() const noexcept { return static_cast<int>(coarse_.size()) + 1; }

private:
  template <int B>
  struct Level
  {
    std::vector<typename BlockRows<B>::Block> inverse; ///< of the diagonal's blocks
    double largest = 0;                                ///< eigenvalue of inverse × matrix
    BlockRows<B, motions> up;                          ///< from the next level
    BlockRows<motions, B> down;
  };
  struct CoarseLevel : Level<motions>
  {
    BlockRows<motions> matrix;
  };

  template <int B>
  NodePlaces<Dim> coarsen(const BlockRows<B>& matrix, const std::vector<double>* scale, const NodePlaces<Dim>& places,
    double length, double nextLength, Level<B>& level, BlockRows<motions>& next,
    const std::function<void()>& told) const;
  template <int B, int Many>
  static void smooth(const BlockRows<B>& matrix, const Level<B>& level, const double* b, double* x, bool fromZero,
    std::vector<double>& d);
  template <int B, int Many>
  void cycle(const BlockRows<B>& matrix, const Level<B>& level, std::size_t depth, const double* b, double* x) const;

  const BlockRows<Dim>& finest_;
  Level<Dim> fine_;
  std::vector<CoarseLevel> coarse_; ///< the last one solved directly
  Eigen::LLT<Eigen::MatrixXd> factors_;
};

extern template class PointMultigrid<2>;
extern template class PointMultigrid<3>;

} // namespace lamella::mpm
