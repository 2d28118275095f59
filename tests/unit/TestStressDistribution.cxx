// Statistics of stresses: laws whose numbers are known, sums counted by hand, slabs, ranks, what is refused.
#include "core/Error.h"
#include "statistics/StressDistribution.h"
#include "statistics/StressMeasure.h"

#include <gtest/gtest.h>
#include <mpi.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace
{

using namespace lamella;
using namespace lamella::statistics;

const Communicator alone(MPI_COMM_SELF);

StressDistribution distribution(std::span<const double> values, const DistributionOptions& options = {})
{
  return stressDistribution(values, {}, 1, options, alone);
}

std::vector<double> exponential(std::size_t count, double mean, unsigned seed)
{
  std::mt19937_64 engine(seed);
  std::exponential_distribution<double> law(1 / mean);
  std::vector<double> values(count);
  std::generate(values.begin(), values.end(), [&] { return law(engine); });
  return values;
}

TEST(StressDistribution, MeansAndSharesAreThoseCountedByHand)
{
  const std::vector<double> values{ 4, 2, 0, -1, 6, -3, 4 };
  const std::vector<std::uint8_t> group{ 0, 1, 0, 1, 1, 2, noGroup };
  DistributionOptions options;
  options.threshold = 1;
  options.binWidth = 0.5;
  const StressDistribution d = stressDistribution(values, group, 4, options, alone);
  EXPECT_EQ(d.all.count, 6);
  EXPECT_EQ(d.all.tensile, 3);
  EXPECT_EQ(d.all.compressive, 2);
  EXPECT_DOUBLE_EQ(d.all.meanTensile, 4);
  EXPECT_DOUBLE_EQ(d.all.meanCompressive, -2);
  EXPECT_DOUBLE_EQ(d.all.mean, 8.0 / 6);
  EXPECT_DOUBLE_EQ(d.all.deviation, std::sqrt(66.0 / 6 - 64.0 / 36));
  EXPECT_EQ(d.all.smallest, -3);
  EXPECT_EQ(d.all.largest, 6);
  EXPECT_EQ(d.groups.at(1).count, 3);
  EXPECT_DOUBLE_EQ(d.groups.at(1).meanTensile, 4);
  EXPECT_DOUBLE_EQ(d.groups.at(1).meanCompressive, -1);
  EXPECT_EQ(d.groups.at(2).tensile, 0);
  EXPECT_EQ(d.groups.at(2).meanTensile, 0);
  EXPECT_EQ(d.groups.at(3).count, 0);
  EXPECT_TRUE(d.groups.at(3).bins.empty());
  // In means: 1, 0.5, 0, −0.25, 1.5, −0.75; bins of a half from −1 on.
  EXPECT_EQ(d.firstBin, -2);
  EXPECT_EQ(d.all.bins, (std::vector<std::int64_t>{ 1, 1, 1, 1, 1, 1 }));
  EXPECT_DOUBLE_EQ(d.all.density.at(0), 1 / (6 * 0.5));
  EXPECT_DOUBLE_EQ(d.groups.at(1).density.at(1), 1 / (3 * 0.5));
  // Beyond one mean lies only 6.
  EXPECT_EQ(d.all.tail.count, 1);
  EXPECT_TRUE(std::isnan(d.all.tail.theta));
}

TEST(StressDistribution, DensitySumsToOne)
{
  std::vector<double> values = exponential(5000, 3e5, 1);
  for (std::size_t i = 0; i < values.size(); i += 3)
    values[i] *= -0.1;
  const StressDistribution d = distribution(values);
  EXPECT_NEAR(std::accumulate(d.all.density.begin(), d.all.density.end(), 0.0) * d.binWidth, 1, 1e-12);
  EXPECT_EQ(std::accumulate(d.all.bins.begin(), d.all.bins.end(), std::int64_t{ 0 }), 5000);
  DistributionOptions options;
  options.low = 0;
  options.high = 1.3; // 26 bins, not 27, though 1.3/0.05 is 26.000000000000004
  const StressDistribution part = distribution(values, options);
  EXPECT_EQ(part.firstBin, 0);
  ASSERT_EQ(part.all.bins.size(), 26U);
  const auto zero = static_cast<std::size_t>(-d.firstBin);
  EXPECT_TRUE(std::equal(part.all.bins.begin(), part.all.bins.end(), d.all.bins.begin() + static_cast<long>(zero)));
}

// An exponential law has θ = 1 over its own mean, beyond whatever threshold.
TEST(StressDistribution, ExponentialLawGivesThetaWithinItsStandardError)
{
  for (const double mean : { 1e-6, 1.0, 2.7e8 })
  {
    const std::vector<double> values = exponential(200000, mean, 7);
    for (const double threshold : { 0.5, 1.0, 2.0, 4.0 })
    {
      DistributionOptions options;
      options.threshold = threshold;
      const ExponentialTail tail = distribution(values, options).all.tail;
      EXPECT_DOUBLE_EQ(tail.standardError, tail.theta / std::sqrt(static_cast<double>(tail.count)));
      EXPECT_NEAR(tail.theta, 1, 2.5 * tail.standardError) << threshold;
      EXPECT_NEAR(tail.share, std::exp(-threshold), 0.01);
      // Kolmogorov's distance of the true law is below 1.36/√n in 95 of 100 samples.
      EXPECT_LT(tail.distance, 1.5 / std::sqrt(static_cast<double>(tail.count)));
    }
  }
}

// The standard error is the scatter of θ between samples: of 400 samples known to 1/√800, 3.5 %.
TEST(StressDistribution, StandardErrorIsTheScatterOfTheta)
{
  const int samples = 400;
  double sum = 0;
  double squares = 0;
  double told = 0;
  DistributionOptions options;
  options.threshold = 1;
  for (int s = 0; s < samples; ++s)
  {
    const std::vector<double> values = exponential(2000, 1, static_cast<unsigned>(100 + s));
    // θ is told in means of the sample, which scatter as well: that is taken out.
    const double scale = 2000 / std::accumulate(values.begin(), values.end(), 0.0);
    const ExponentialTail tail = distribution(values, options).all.tail;
    const double theta = tail.theta * scale;
    sum += theta;
    squares += theta * theta;
    told += tail.standardError * scale;
  }
  const double mean = sum / samples;
  const double scatter = std::sqrt(squares / samples - mean * mean);
  EXPECT_NEAR(scatter / (told / samples), 1, 0.12); // three times 3.5 %
}

TEST(StressDistribution, ThetaCountsFromTheThresholdInMeansOfAll)
{
  // Beyond 10 the law e^{−v/2}; below it, bulk. The mean of all is what θ refers to.
  std::vector<double> values = exponential(50000, 2, 3);
  for (double& v : values)
    v += 10;
  for (int i = 0; i < 50000; ++i)
    values.push_back(5);
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  for (int i = 0; i < 1000; ++i)
    values.push_back(-100); // compression changes nothing
  DistributionOptions options;
  options.threshold = 10 / mean;
  const StressDistribution d = distribution(values, options);
  EXPECT_NEAR(d.all.tail.theta, mean / 2, 2.5 * d.all.tail.standardError);
  EXPECT_EQ(d.all.tail.count, 50000);
  EXPECT_DOUBLE_EQ(d.all.tail.share, 0.5);
  // The same tail found by its share of the tensile values.
  options.threshold = 0;
  options.tailShare = 0.5;
  const ExponentialTail found = distribution(values, options).all.tail;
  EXPECT_NEAR(found.theta, d.all.tail.theta, 0.01 * d.all.tail.theta + 1e-3);
}

TEST(StressDistribution, ThresholdsShowWhereTheLawBegins)
{
  // Exponential only beyond its largest half: uniform below.
  std::vector<double> values = exponential(20000, 1, 5);
  for (double& v : values)
    v += 1;
  std::mt19937 engine(2);
  for (int i = 0; i < 20000; ++i)
    values.push_back(std::uniform_real_distribution<double>(0, 1)(engine));
  const StressDistribution d = distribution(values);
  ASSERT_GT(d.tails.size(), 8U);
  for (std::size_t i = 1; i < d.tails.size(); ++i)
  {
    EXPECT_GT(d.tails[i].threshold, d.tails[i - 1].threshold);
    EXPECT_LT(d.tails[i].count, d.tails[i - 1].count);
  }
  for (const ExponentialTail& tail : d.tails)
    EXPECT_NEAR(tail.theta, d.all.meanTensile, 3.5 * tail.standardError) << tail.threshold;
  // A uniform law beyond its middle is no exponential: the distance tells. (Exactly: θ = 4 beyond ½ mean-wise, 0.15.)
  std::vector<double> uniform(20000);
  std::generate(uniform.begin(), uniform.end(), [&] { return std::uniform_real_distribution<double>(0, 1)(engine); });
  EXPECT_GT(distribution(uniform).all.tail.distance, 0.1);
  EXPECT_LT(d.all.tail.distance, 0.03);
}

// The distance from the histogram against that of the sorted values.
TEST(StressDistribution, DistanceIsThatOfTheSortedValues)
{
  std::vector<double> values = exponential(3000, 1, 11);
  for (double& v : values)
    v = v * v;
  DistributionOptions options;
  options.threshold = 1.5;
  const StressDistribution d = distribution(values, options);
  const double mean = d.all.meanTensile;
  std::sort(values.begin(), values.end());
  const auto first = std::upper_bound(values.begin(), values.end(), 1.5 * mean);
  const auto n = static_cast<double>(values.end() - first);
  double expected = 0;
  for (auto v = first; v != values.end(); ++v)
  {
    const double law = 1 - std::exp(-d.all.tail.theta * (*v / mean - 1.5));
    const auto i = static_cast<double>(v - first);
    expected = std::max({ expected, std::abs(i / n - law), std::abs((i + 1) / n - law) });
  }
  EXPECT_NEAR(d.all.tail.distance, expected, 1e-3); // as the header promises
  EXPECT_GT(expected, 0.05);
}

TEST(StressDistribution, SlabsChangeNothing)
{
  std::vector<double> values = exponential(60000, 5, 17);
  std::vector<std::uint8_t> group(values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    group[i] = static_cast<std::uint8_t>(i % 3);
    values[i] -= static_cast<double>(i % 7) / 3;
  }
  const StressDistribution one = stressDistribution(values, group, 3, {}, alone);
  DistributionOptions options;
  options.slabs = 5;
  const StressDistribution five = stressDistribution(values, group, 3, options, alone);
  EXPECT_EQ(one.all.bins, five.all.bins);
  for (std::size_t g = 0; g < 3; ++g)
  {
    EXPECT_EQ(one.groups[g].bins, five.groups[g].bins);
    EXPECT_NEAR(one.groups[g].meanTensile, five.groups[g].meanTensile, 1e-14 * one.all.meanTensile);
    EXPECT_NEAR(one.groups[g].tail.theta, five.groups[g].tail.theta, 1e-12);
  }
  EXPECT_NEAR(one.all.tail.theta, five.all.tail.theta, 1e-12);
  EXPECT_EQ(one.tails.size(), five.tails.size());
}

TEST(StressDistribution, EqualStressesHaveNoTail)
{
  const StressDistribution d = distribution(std::vector<double>(100, 3.0));
  EXPECT_EQ(d.all.tail.count, 0);
  EXPECT_TRUE(std::isnan(d.all.tail.theta));
  EXPECT_TRUE(d.tails.empty());
  EXPECT_EQ(d.all.deviation, 0);
  ASSERT_EQ(d.all.bins.size(), 1U);
  EXPECT_DOUBLE_EQ(d.all.density[0] * d.binWidth, 1);
}

TEST(StressDistribution, WhatCannotBeDoneIsRefusedInWords)
{
  const auto refused = [](const std::vector<double>& values, const DistributionOptions& options, const char* words)
  {
    try
    {
      (void)distribution(values, options);
      ADD_FAILURE() << words;
    }
    catch (const Error& error)
    {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
      EXPECT_FALSE(error.hint().empty());
    }
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> fine{ 1, 2, 3 };
  const auto with = [](const auto& set)
  {
    DistributionOptions options;
    set(options);
    return options;
  };
  refused({}, {}, "no stress to count");
  refused({ 1, nan, -INFINITY }, {}, "2 stresses are not finite");
  refused({ -1, 0 }, {}, "none of 2 stresses is above 0");
  refused({ 1e308, 1e308 }, {}, "too large or too small");
  refused({ 1e-320 }, {}, "too large or too small");
  refused(fine, with([](auto& o) { o.threshold = 9; }), "no stress is beyond the threshold of 9");
  refused(fine, with([](auto& o) { o.threshold = -1; }), "threshold of -1 is not positive");
  refused(fine, with([&](auto& o) { o.threshold = nan; }), "threshold of nan is not positive");
  refused(fine, with([](auto& o) { o.tailShare = 1.5; }), "tail share of 1.5 is outside");
  refused(fine, with([](auto& o) { o.binWidth = 0; }), "bin width of 0 is not positive");
  refused(fine, with([](auto& o) { o.binWidth = 1e-8; }), "more than a million");
  refused(fine, with([&](auto& o) { o.high = nan; }), "is not finite");
  refused(fine, with([](auto& o) { o.reference = -2; }), "reference stress of -2");
}

TEST(StressMeasure, InvariantsOfTensors)
{
  const SymmetricTensor uniaxial{ 0, 5, 0, 0, 0, 0 };
  EXPECT_EQ(measure(uniaxial, StressMeasure::YY), 5);
  EXPECT_DOUBLE_EQ(measure(uniaxial, StressMeasure::VonMises), 5);
  EXPECT_DOUBLE_EQ(measure(uniaxial, StressMeasure::Mean), 5.0 / 3);
  const SymmetricTensor shear{ 0, 0, 0, 2, 0, 0 };
  EXPECT_DOUBLE_EQ(measure(shear, StressMeasure::VonMises), 2 * std::sqrt(3.0));
  EXPECT_NEAR(measure(shear, StressMeasure::Principal1), 2, 1e-14);
  EXPECT_NEAR(measure(shear, StressMeasure::Principal2), 0, 1e-14);
  EXPECT_NEAR(measure(shear, StressMeasure::Principal3), -2, 1e-14);
  // Any tensor: trace and the second invariant from the principal values.
  const SymmetricTensor any{ 3, -1, 2, 0.5, -0.7, 1.1 };
  const double p1 = measure(any, StressMeasure::Principal1);
  const double p2 = measure(any, StressMeasure::Principal2);
  const double p3 = measure(any, StressMeasure::Principal3);
  EXPECT_GE(p1, p2);
  EXPECT_GE(p2, p3);
  EXPECT_NEAR(p1 + p2 + p3, 4, 1e-13);
  EXPECT_NEAR(measure(any, StressMeasure::VonMises),
    std::sqrt(((p1 - p2) * (p1 - p2) + (p2 - p3) * (p2 - p3) + (p3 - p1) * (p3 - p1)) / 2), 1e-13);
  EXPECT_EQ(stressMeasureNames().at(static_cast<std::size_t>(StressMeasure::XZ)), "xz");
}

} // namespace
