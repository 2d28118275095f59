// Functions of lanes against those of long doubles; here with the instructions that every processor has.
#include "mpm/kernels/Lanes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace
{

using lamella::mpm::Lanes;
constexpr int lanes = 2; // more are vectors that such processors do not have

/// Largest relative error in units of the last place, of numbers between 2^low and 2^high, of either sign if asked.
template <class F, class Exact>
double worst(int low, int high, bool signs, const F& f, const Exact& exact)
{
  std::mt19937 random(7);
  std::uniform_real_distribution<double> power(low, high);
  double most = 0;
  for (int trial = 0; trial < 20000; ++trial)
  {
    Lanes<lanes> a;
    for (int l = 0; l < lanes; ++l)
      a.v[l] = (signs && l % 2 == 1 ? -1 : 1) * std::exp2(power(random));
    const Lanes<lanes> found = f(a);
    for (int l = 0; l < lanes; ++l)
    {
      const long double expected = exact(static_cast<long double>(a.v[l]));
      const long double off = std::fabs((found.v[l] - expected) / expected);
      most = std::fmax(most, static_cast<double>(off) / std::numeric_limits<double>::epsilon());
    }
  }
  return most;
}

TEST(PointLanes, PowersAndLogarithms)
{
  const auto power = [](Lanes<lanes> a) { return exp(a); };
  const auto logarithm = [](Lanes<lanes> a) { return log(a); };
  const auto exactPower = [](long double a) { return std::exp(a); };
  const auto exactLogarithm = [](long double a) { return std::log(a); };
  EXPECT_LT(worst(-40, 0, true, power, exactPower), 2);
  EXPECT_LT(worst(0, 9, true, power, exactPower), 2);
  EXPECT_LT(worst(1, 900, false, logarithm, exactLogarithm), 2);
  EXPECT_LT(worst(-900, -1, false, logarithm, exactLogarithm), 2);
  EXPECT_EQ(exp(Lanes<lanes>(0.0)).v[1], 1);
}

TEST(PointLanes, AnyOfThem)
{
  Lanes<lanes> a(1.0);
  EXPECT_FALSE(any(a > Lanes<lanes>(1.0), a));
  a.v[1] = 2;
  EXPECT_TRUE(any(a > Lanes<lanes>(1.0), a));
  a.v[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(any(a > Lanes<lanes>(1.0), a));
}

} // namespace
