// How long a run still takes, from what it tells.
#include "session/TimeLeft.h"

#include <gtest/gtest.h>

#include <cmath>

namespace
{

using lamella::cli::TimeLeft;

TEST(TimeLeft, EvenPace)
{
  TimeLeft left;
  for (int i = 0; i <= 100; ++i)
  {
    left.tell(0.1 * i, 0.005 * i);
    if (i < 20)
      EXPECT_FALSE(left.seconds());
    else
      EXPECT_NEAR(left.seconds().value(), 20 - 0.1 * i, 0.2) << i;
  }
}

// A guess that creeps, then runs: fracture before and beyond its peak. Nothing is said while it changes, which cannot
// be seen within the first tenths of a second.
TEST(TimeLeft, SaysNothingOfGuesses)
{
  TimeLeft left;
  for (int i = 1; i <= 200; ++i)
  {
    const double t = 0.1 * i; // of 20 s
    left.tell(t, t < 10 ? 1e-3 * t : 0.01 + 0.099 * (t - 10));
    if (left.seconds())
      EXPECT_TRUE(t < 10.2 || std::fabs(left.seconds().value() - (20 - t)) < 0.5 * t) << t;
    if (t > 10.5 && t < 15)
      EXPECT_FALSE(left.seconds()) << t;
  }
}

} // namespace
