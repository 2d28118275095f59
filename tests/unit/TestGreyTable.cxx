// Values between greys, and the bins that stand for them.
#include "core/Error.h"
#include "lattice/GreyTable.h"

#include <gtest/gtest.h>

#include <cmath>

namespace
{

using namespace lamella;

TEST(GreyTable, LinearBetweenAndConstantBeyond)
{
  const GreyTable table({ { "40", 0.1 }, { "220", 1 }, { "100", 0.4 } }, "conductivity");
  EXPECT_DOUBLE_EQ(table.value(40), 0.1);
  EXPECT_DOUBLE_EQ(table.value(70), 0.25);
  EXPECT_DOUBLE_EQ(table.value(100), 0.4);
  EXPECT_DOUBLE_EQ(table.value(160), 0.7);
  EXPECT_DOUBLE_EQ(table.value(-1e9), 0.1);
  EXPECT_DOUBLE_EQ(table.value(1e9), 1);
}

/// The value of a bin's grey is that of any grey in it within the rounding that is told; 0 stays 0; ends are exact.
TEST(GreyTable, BinsStandForTheirGreys)
{
  for (const std::map<std::string, double>& given :
    { std::map<std::string, double>{ { "0", 1e-3 }, { "1", 1 } }, { { "-5", 3 }, { "2", 0.5 }, { "9", 40 } },
      { { "0", 0 }, { "1", 0 }, { "2", 1 }, { "3", 0 } }, { { "1e4", 7 }, { "2e4", 7 }, { "3e4", 0.07 } } })
  {
    const GreyTable table(given, "conductivity");
    const GreyBins bins = table.bins();
    EXPECT_LE(bins.count(), 255U);
    EXPECT_LT(table.rounding(), 0.06);
    const double first = std::stod(given.begin()->first) - 1;
    for (int i = 0; i <= 100000; ++i)
    {
      const double grey = first + i * 3e-5 * (table.value(2e4) > 5 ? 2e4 : 5);
      const double value = table.value(grey);
      const double bin = table.value(bins.grey(bins.of(grey)));
      if (value == 0 || bin == 0)
        EXPECT_NEAR(value, bin, 2e-6 * 40);
      else
        EXPECT_LE(std::abs(std::log(bin / value)), 1.0001 * std::log1p(table.rounding())) << grey;
    }
    EXPECT_DOUBLE_EQ(table.value(bins.grey(bins.of(-1e300))), table.value(-1e300));
    EXPECT_DOUBLE_EQ(table.value(bins.grey(bins.of(1e300))), table.value(1e300));
    EXPECT_DOUBLE_EQ(table.value(bins.grey(bins.of(first + 1))), table.value(first + 1));
  }
}

TEST(GreyTable, EvenBins)
{
  for (const auto& [none, all] : { std::pair{ 40.0, 220.0 }, std::pair{ 1.7, -0.3 } })
  {
    const GreyBins bins = GreyBins::even(none, all);
    for (int i = -100; i <= 1100; ++i)
    {
      const double share = std::clamp(i / 1000.0, 0.0, 1.0);
      const double grey = none + (all - none) * i / 1000;
      EXPECT_NEAR((bins.grey(bins.of(grey)) - none) / (all - none), share, 1.0 / 507);
    }
  }
}

TEST(GreyTable, WhatDoesNotFitIsRefused)
{
  using Given = std::map<std::string, double>;
  for (const Given& given : { Given{}, Given{ { "40", 1 } }, Given{ { "40", 1 }, { "wall", 2 } },
         Given{ { "40", 1 }, { "4e1", 2 } }, Given{ { "40", 1 }, { "220", -1 } }, Given{ { "40", 0 }, { "220", 0 } },
         Given{ { "nan", 1 }, { "220", 1 } }, Given{ { "40", std::nan("") }, { "220", 1 } } })
    EXPECT_THROW((void)GreyTable(given, "conductivity"), ParameterError);
}

} // namespace
