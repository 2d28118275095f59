// Factors of a narrow band against dense ones.
#include "lbm/multigrid/BandCholesky.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include <algorithm>
#include <random>

namespace
{

using namespace lamella;

TEST(BandCholesky, SolvesAsDenseFactorsDo)
{
  std::mt19937 random(7);
  std::uniform_real_distribution<double> number(-0.3, 1.0);
  for (const Eigen::Index size : { 1, 2, 9, 40 })
    for (const Eigen::Index width : { 0, 1, 7, 39 })
    {
      // nodes and their links, a third of which are missing, and a weak one to a wall
      Eigen::MatrixXd dense = Eigen::MatrixXd::Identity(size, size) * 0.01;
      for (Eigen::Index row = 0; row < size; ++row)
        for (Eigen::Index column = std::max<Eigen::Index>(0, row - width); column < row; ++column)
        {
          const double link = std::max(0.0, number(random));
          dense(row, row) += link;
          dense(column, column) += link;
          dense(row, column) -= link;
          dense(column, row) -= link;
        }
      lbm::BandCholesky band(size, width);
      for (Eigen::Index row = 0; row < size; ++row)
        for (Eigen::Index column = 0; column < size; ++column)
          if (dense(row, column) != 0)
            band.add(row, column, dense(row, column));
      Eigen::VectorXd right = Eigen::VectorXd::NullaryExpr(size, [&] { return number(random); });
      const Eigen::VectorXd exact = dense.llt().solve(right);
      ASSERT_TRUE(band.factorize());
      band.solve({ right.data(), static_cast<std::size_t>(size) });
      EXPECT_LT((right - exact).norm(), 1e-11 * exact.norm()) << size << " " << width; // condition number 1e4
    }
}

TEST(BandCholesky, NoticesWhatIsNotPositiveDefinite)
{
  lbm::BandCholesky band(3, 1);
  for (const Eigen::Index i : { 0, 1, 2 })
    band.add(i, i, 1);
  band.add(1, 0, -1);
  EXPECT_FALSE(band.factorize());
}

} // namespace
