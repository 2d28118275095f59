#include "statistics/ErrorParts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace
{

using namespace lamella::statistics;

TEST(ErrorParts, AddAsSquaresAndTheLargestHalvesThem)
{
  const std::vector<ErrorPart> parts{ { "pixels", 0.01 }, { "window", 0.06 }, { "inputs", 0.02 } };
  const double total = totalError(parts);
  EXPECT_NEAR(total, std::sqrt(0.0041), 1e-15);
  const auto half = halving(parts);
  ASSERT_TRUE(half);
  EXPECT_EQ(half->part, 1U);
  std::vector<ErrorPart> less = parts;
  less[1].relative *= half->factor;
  EXPECT_NEAR(totalError(less), total / 2, 1e-15);
}

TEST(ErrorParts, OfWhichNoSingleOneHalvesThem)
{
  EXPECT_FALSE(halving(std::vector<ErrorPart>{ { "window", 0.03 }, { "inputs", 0.02 } }));
  EXPECT_FALSE(halving(std::vector<ErrorPart>{ { "window", 0.03 } }));
  EXPECT_TRUE(std::isnan(totalError(std::vector<ErrorPart>{ { "window", 0.03 } })));
  EXPECT_FALSE(halving(std::vector<ErrorPart>{ { "window", 0.0 }, { "inputs", 0.0 } }));
}

} // namespace
