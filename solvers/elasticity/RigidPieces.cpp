#include "elasticity/RigidPieces.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <limits>

namespace lamella::elasticity
{

template <int D>
RigidPieces<D>::RigidPieces(
  const ElasticGrid<D>& grid, std::span<const std::uint8_t> phase, const std::vector<bool>& rigid)
  : motion_(grid, phase, rigid, 1, std::numeric_limits<std::int32_t>::max())
{
  constexpr int n = PieceMotions<D>::motions;
  for (const auto& piece : motion_.pieces())
  {
    if (piece.endless)
      throw ParameterError("a rigid phase goes on from cell to cell: nothing strains it",
        "give the phase a Young's modulus, or take another window");
    if (piece.held)
      throw ParameterError(
        "a rigid piece touches a side that follows the strain", "take periodic sides, or give it a Young's modulus");
  }
  for (const auto& inertia : motion_.inertia())
  {
    Eigen::Matrix<double, n, n> gram;
    for (int m = 0; m < n; ++m)
    {
      // the motion's displacements as forces: Σ u and Σ u ⊗ d
      const auto affine = PieceMotions<D>::affineOf(PieceMotions<D>::Motions::Unit(m));
      typename PieceMotions<D>::Affine sum;
      sum.shift = inertia.nodes * affine.shift + affine.slope * inertia.first;
      sum.slope = affine.shift * inertia.first.transpose() + affine.slope * inertia.second;
      gram.col(m) = PieceMotions<D>::workOf(sum);
    }
    inverse_.push_back(gram.inverse());
  }
}

template <int D>
template <class Real>
void RigidPieces<D>::start(const std::array<double, 6>& strain, int threads, Real* u) const
{
  typename PieceMotions<D>::Affine rest;
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j)
      rest.slope(i, j) = (i == j ? -1 : -0.5) * strain[static_cast<std::size_t>(voigt(D, i, j))];
  const std::vector<typename PieceMotions<D>::Affine> motions(motion_.pieces().size(), rest);
  motion_.place(std::span<const typename PieceMotions<D>::Affine>(motions), false, threads, u);
}

template <int D>
template <class Real>
void RigidPieces<D>::project(Real* v, int threads) const
{
  std::vector<typename PieceMotions<D>::Affine> affine = motion_.moments(v);
  for (std::size_t p = 0; p < affine.size(); ++p)
    affine[p] = PieceMotions<D>::affineOf(inverse_[p] * PieceMotions<D>::workOf(affine[p]));
  motion_.place(std::span<const typename PieceMotions<D>::Affine>(affine), false, threads, v);
}

template <int D>
template <class Real>
std::array<double, voigtSize(D)> RigidPieces<D>::stress(const Real* forces) const
{
  std::array<double, voigtSize(D)> sum{};
  for (const auto& moment : motion_.moments(forces))
    for (int i = 0; i < D; ++i)
      for (int j = i; j < D; ++j)
        sum[static_cast<std::size_t>(voigt(D, i, j))] -= 0.5 * (moment.slope(i, j) + moment.slope(j, i));
  return sum;
}

template class RigidPieces<2>;
template class RigidPieces<3>;
template void RigidPieces<2>::start(const std::array<double, 6>&, int, float*) const;
template void RigidPieces<3>::start(const std::array<double, 6>&, int, float*) const;
template void RigidPieces<2>::start(const std::array<double, 6>&, int, double*) const;
template void RigidPieces<3>::start(const std::array<double, 6>&, int, double*) const;
template void RigidPieces<2>::project(float*, int) const;
template void RigidPieces<3>::project(float*, int) const;
template void RigidPieces<2>::project(double*, int) const;
template void RigidPieces<3>::project(double*, int) const;
template std::array<double, 3> RigidPieces<2>::stress(const float*) const;
template std::array<double, 6> RigidPieces<3>::stress(const float*) const;
template std::array<double, 3> RigidPieces<2>::stress(const double*) const;
template std::array<double, 6> RigidPieces<3>::stress(const double*) const;

} // namespace lamella::elasticity
