// What Newton's method on grains rests on: second derivatives that are those of the forces, and block Cholesky factors
// that solve and that tell a positive definite matrix from others.
#include "packing/BlockCholesky.h"
#include "packing/Enthalpy.h"
#include "packing/GrainSystem.h"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

namespace
{

using namespace lamella;
using namespace lamella::packing;

// A lattice of grains a little out of place, each with overlaps and gaps of some hundredths to its neighbours.
template <int Dim>
GrainSystem<Dim> crowd(bool periodic)
{
  GrainSystem<Dim> g;
  const int edge = Dim == 2 ? 6 : 4;
  g.resize(static_cast<std::size_t>(std::pow(edge, Dim)));
  g.periodic.fill(periodic);
  g.box.setConstant(edge);
  std::uint64_t state = 3;
  const auto number = [&]
  {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(state >> 11) * 0x1p-53;
  };
  for (std::size_t i = 0; i < g.count(); ++i)
  {
    g.radius[i] = 0.47 + 0.06 * number();
    auto rest = static_cast<int>(i);
    for (int a = 0; a < Dim; ++a, rest /= edge)
      g.position[i][a] = 0.5 + rest % edge + 0.05 * (number() - 0.5);
  }
  return g;
}

template <int Dim>
Eigen::MatrixXd dense(const BlockMatrix<Dim>& m, Eigen::Index box)
{
  const auto n = Dim * static_cast<Eigen::Index>(m.diagonal.size());
  Eigen::MatrixXd d = Eigen::MatrixXd::Zero(n + box, n + box);
  for (std::size_t i = 0; i < m.diagonal.size(); ++i)
  {
    const auto at = Dim * static_cast<Eigen::Index>(i);
    d.block(at, at, Dim, Dim) = m.diagonal[i];
    d.block(at, n, Dim, box) = m.border[i].leftCols(box);
    d.block(n, at, box, Dim) = m.border[i].leftCols(box).transpose();
  }
  for (std::size_t l = 0; l < m.links.size(); ++l)
  {
    const auto first = Dim * static_cast<Eigen::Index>(m.links[l][0]);
    const auto second = Dim * static_cast<Eigen::Index>(m.links[l][1]);
    d.block(second, first, Dim, Dim) = m.coupling[l];
    d.block(first, second, Dim, Dim) = m.coupling[l].transpose();
  }
  d.bottomRightCorner(box, box) = m.corner.topLeftCorner(box, box);
  return d;
}

template <int Dim>
void checkSecondDerivatives(bool periodic, BoxMotion box)
{
  auto g = crowd<Dim>(periodic);
  RelaxationOptions options;
  options.box = box;
  options.pressure = 0.01;
  options.smoothing = 1e-4; // contacts that open and close would have no second derivative
  Enthalpy<Dim> enthalpy(g, options);
  enthalpy.evaluate();
  const Eigen::MatrixXd h = dense(enthalpy.hessian(), enthalpy.boxUnknowns());
  ASSERT_EQ(h.rows(), enthalpy.size());
  const Eigen::VectorXd force = enthalpy.force();
  const auto position = g.position;
  const auto edges = g.box;
  // central differences: h² times the fourth derivatives, which are up to 1/smoothing
  const double step = 1e-5;
  for (const Eigen::Index k : { Eigen::Index{ 0 }, Eigen::Index{ 17 }, h.rows() - Dim, h.rows() - 1 })
  {
    Eigen::VectorXd move = Eigen::VectorXd::Zero(h.rows());
    Eigen::VectorXd difference = Eigen::VectorXd::Zero(h.rows());
    for (const double sign : { 1.0, -1.0 })
    {
      g.position = position;
      g.box = edges;
      move[k] = sign * step;
      enthalpy.move(move);
      enthalpy.evaluate();
      difference -= sign * enthalpy.force() / (2 * step);
    }
    // A net force, nil at rest, is work when the box takes its grain along: that is left out.
    Eigen::VectorXd expected = h.col(k);
    const Eigen::Index grains = h.rows() - enthalpy.boxUnknowns();
    if (k < grains && enthalpy.boxUnknowns() > 0)
      expected[grains + (box == BoxMotion::Volume ? 0 : k % Dim)] -= force[k];
    const double error = (difference - expected).norm() / expected.norm();
    EXPECT_LT(error, 1e-5) << "unknown " << k;
  }
}

TEST(PackingNewton, SecondDerivativesAreThoseOfTheForces)
{
  for (const BoxMotion box : { BoxMotion::Fixed, BoxMotion::Volume, BoxMotion::EachAxis })
    for (const bool periodic : { false, true })
    {
      checkSecondDerivatives<2>(periodic, box);
      checkSecondDerivatives<3>(periodic, box);
    }
}

template <int Dim>
void checkFactors(BoxMotion box)
{
  auto g = crowd<Dim>(true);
  RelaxationOptions options;
  options.box = box;
  options.pressure = 0.01;
  options.smoothing = 1e-4;
  Enthalpy<Dim> enthalpy(g, options);
  enthalpy.evaluate();
  const BlockMatrix<Dim>& matrix = enthalpy.hessian();
  const Eigen::MatrixXd full = dense(matrix, enthalpy.boxUnknowns());
  BlockCholesky<Dim> factors;
  factors.analyse(g.count(), matrix.links);
  EXPECT_GE(factors.entries(), matrix.links.size());

  const Eigen::VectorXd values =
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(full, Eigen::EigenvaluesOnly).eigenvalues();
  // Pushed together, the grains would rather move aside, and all together they move freely.
  ASSERT_LT(values[0], 1e-10);
  EXPECT_FALSE(factors.factorise(matrix, -values[0] - 0.01));
  const double shift = -values[0] + 0.01;
  ASSERT_TRUE(factors.factorise(matrix, shift));
  const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(full.rows(), -1, 2);
  const Eigen::VectorXd x = factors.solve(right, enthalpy.boxUnknowns());
  // condition (largest over least eigenvalue, below 1e4) times the rounding of a double
  EXPECT_LT((full * x + shift * x - right).norm(), 1e-11 * right.norm());

  // other links: the same order of elimination, or another
  const std::vector<std::array<std::int32_t, 2>> none;
  factors.analyse(g.count(), none);
  EXPECT_EQ(factors.entries(), 0U);
  factors.analyse(g.count(), matrix.links);
  ASSERT_TRUE(factors.factorise(matrix, shift));
  EXPECT_LT((factors.solve(right, enthalpy.boxUnknowns()) - x).norm(), 1e-9 * x.norm());
}

TEST(PackingNewton, FactorsSolveAndTellPositiveDefinite)
{
  for (const BoxMotion box : { BoxMotion::Fixed, BoxMotion::Volume, BoxMotion::EachAxis })
  {
    checkFactors<2>(box);
    checkFactors<3>(box);
  }
}

} // namespace
