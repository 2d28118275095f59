#include "statistics/Fit.h"

#include "core/Error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace
{

using namespace lamella;
using namespace lamella::statistics;

// Layers of two conductors, along them and across.
FitEvaluation layers(std::span<const double> k, bool derivatives)
{
  const double f = 0.3;
  const double series = 1 / (f / k[0] + (1 - f) / k[1]);
  FitEvaluation e{ { f * k[0] + (1 - f) * k[1], series }, {} };
  if (derivatives)
    e.derivatives = { f, 1 - f, series * series * f / (k[0] * k[0]), series * series * (1 - f) / (k[1] * k[1]) };
  return e;
}

std::string errorOf(const auto& f)
{
  try
  {
    f();
  }
  catch (const Error& e)
  {
    return e.what();
  }
  return "";
}

TEST(Fit, FindsWhatMadeTheMeasurements)
{
  const FitEvaluation truth = layers(std::vector{ 0.4, 2.0 }, false);
  const std::vector<FitMeasurement> measured{ { "along", truth.values[0], 0.01 }, { "across", truth.values[1], 0.01 } };
  for (const bool derivatives : { true, false })
    for (const double start : { 0.02, 1.0, 20.0 })
    {
      const FitResult r = fit({ { "first", start }, { "second", 1.5 * start } }, measured,
        [&](std::span<const double> k) { return layers(k, derivatives); });
      EXPECT_NEAR(r.parameters[0].value, 0.4, 1e-3);
      EXPECT_NEAR(r.parameters[1].value, 2.0, 2e-3);
      EXPECT_LT(r.parameters[0].low, 0.4);
      EXPECT_GT(r.parameters[0].high, 0.4);
      EXPECT_LT(r.misfit, 0.01);
      EXPECT_EQ(r.freedom, 0);
      EXPECT_LE(r.evaluations, derivatives ? 12 : 24);
    }
}

// Intervals hold the truth 19 times out of 20: 1000 measurements with errors of 2 %.
TEST(Fit, IntervalsHold)
{
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  const std::vector<double> k{ 0.7, 2.0 };
  const FitEvaluation truth = layers(k, false);
  int held = 0;
  int chances = 0;
  const int times = 1000;
  for (int i = 0; i < times; ++i)
  {
    std::vector<FitMeasurement> measured;
    for (int again = 0; again < 2; ++again)
      for (std::size_t j = 0; j < 2; ++j)
      {
        const double sigma = 0.01 * truth.values[j];
        measured.push_back({ "value", truth.values[j] + sigma * normal(random), coverage95 * sigma });
      }
    const FitResult r = fit({ { "first", 0.5 }, { "second", 3 } }, measured, // k₁ > k₂ would fit, too
      [&](std::span<const double> p)
      {
        FitEvaluation e = layers(p, true);
        e.values.insert(e.values.end(), e.values.begin(), e.values.begin() + 2);
        e.derivatives.insert(e.derivatives.end(), e.derivatives.begin(), e.derivatives.begin() + 4);
        return e;
      });
    for (std::size_t p = 0; p < 2; ++p)
      held += r.parameters[p].low <= k[p] && k[p] <= r.parameters[p].high ? 1 : 0;
    EXPECT_EQ(r.freedom, 2);
    chances += r.chance < 0.1 ? 1 : 0;
  }
  // three standard deviations of 2000 and of 1000 draws
  EXPECT_NEAR(held / (2.0 * times), 0.95, 3 * std::sqrt(0.95 * 0.05 / times));
  EXPECT_NEAR(chances / static_cast<double>(times), 0.1, 3 * std::sqrt(0.1 * 0.9 / times));
}

// Of a valley that bends, as of walls that stretch and bend: a step that goes up finds back by the next one.
TEST(Fit, FollowsABentValley)
{
  const auto bent = [](std::span<const double> k)
  {
    // along and across in series and in parallel, with a share of each that is small
    const double a = k[0];
    const double b = k[1];
    const double half = 1 / (1 / a + 0.2 / b);
    const double most = 1 / (1 / a + 0.05 / b);
    return FitEvaluation{ { half, most },
      { half * half / (a * a), 0.2 * half * half / (b * b), most * most / (a * a), 0.05 * most * most / (b * b) } };
  };
  const FitEvaluation truth = bent(std::vector{ 1.5, 0.2 });
  const std::vector<FitMeasurement> measured{ { "x", truth.values[0], 0.04 * truth.values[0] },
    { "y", truth.values[1], 0.04 * truth.values[1] } };
  const FitResult r = fit({ { "along", 1.3, true }, { "across", 1.3, true } }, measured, bent);
  EXPECT_NEAR(r.parameters[0].value, 1.5, 0.01);
  EXPECT_NEAR(r.parameters[1].value, 0.2, 0.01);
  EXPECT_LE(r.evaluations, 8);
}

// What fits best lies where the model ends: it is never asked beyond, nor is anything told of there.
TEST(Fit, StaysWhereTheModelIs)
{
  const auto model = [](std::span<const double> k)
  {
    if (k[0] > 1.9)
      throw ParameterError("too much", "");
    return FitEvaluation{ { k[0] }, { 1 } };
  };
  const FitResult r = fit({ { "wall", 1 } }, { { "x", 1.92, 0.2 } }, model);
  EXPECT_LE(r.parameters[0].value, 1.9);
  EXPECT_GT(r.parameters[0].value, 1.8);
}

TEST(Fit, SaysWhatItCannotTell)
{
  const auto fitted = [](const std::vector<FitParameter>& p, const std::vector<FitMeasurement>& m, const auto& model)
  { return errorOf([&] { (void)fit(p, m, model); }); };
  const auto one = [](std::span<const double> k) { return FitEvaluation{ { k[0] + 1e-4 * k[1], k[0] }, {} }; };
  EXPECT_NE(
    fitted({ { "wall", 1 }, { "air", 1 } }, { { "x", 0.4, 0.01 }, { "y", 0.4, 0.01 } }, one).find("do not tell air"),
    std::string::npos);
  const auto sum = [](std::span<const double> k) { return FitEvaluation{ { k[0] + k[1], 2 * (k[0] + k[1]) }, {} }; };
  EXPECT_NE(fitted({ { "wall", 1 }, { "air", 1 } }, { { "x", 3, 0.01 }, { "y", 6, 0.01 } }, sum)
              .find("wall and air only together"),
    std::string::npos);
  const auto floor = [](std::span<const double> k) { return FitEvaluation{ { 1 + k[0] }, {} }; };
  EXPECT_NE(fitted({ { "wall", 1 } }, { { "x", 0.5, 0.001 } }, floor).find("nothing fits"), std::string::npos);
  EXPECT_THROW((void)fit({ { "wall", 1 }, { "air", 1 } }, { { "x", 1, 0.1 } }, sum), ParameterError);
  EXPECT_THROW((void)fit({ { "wall", -1 } }, { { "x", 1, 0.1 } }, floor), ParameterError);
  EXPECT_THROW((void)fit({ { "wall", 1 } }, { { "x", 1, 0 } }, floor), ParameterError);
  FitOptions o;
  o.progress = [](int) { return false; };
  EXPECT_THROW((void)fit({ { "wall", 1 } }, { { "x", 2, 0.1 } }, floor, o), Cancelled);
}

// Two measurements of one number, one four times as certain: the mean weighs them 16 to 1.
TEST(Fit, ErrorsOfTheModelWidenIntervals)
{
  const std::vector<FitMeasurement> measured{ { "x", 2, 0.02 }, { "y", 2, 0.08 } };
  const FitResult r = fit({ { "wall", 1 } }, measured,
    [](std::span<const double> k) {
      return FitEvaluation{ { k[0], k[0] }, { 1, 1 } };
    });
  const double own = 0.02 / std::sqrt(1 + 1 / 16.0);
  const auto half = [&](const std::vector<FitError>& errors)
  {
    FitResult wider = r;
    widen(wider, measured, errors);
    EXPECT_EQ(wider.parameters[0].value, r.parameters[0].value);
    return 2 * std::log(wider.parameters[0].high / 2);
  };
  constexpr double exact = 1e-6; // of the search, which meets 2 that well
  EXPECT_NEAR(half({}), own, exact);
  EXPECT_NEAR(half({ { 0.3, 0 }, { 0.2, 1 } }), std::hypot(own, 16 / 17.0 * 0.3, 1 / 17.0 * 0.2), exact);
  EXPECT_NEAR(half({ { 0.3, 0 }, { 0.2, 0 } }), std::hypot(own, 16 / 17.0 * 0.3 + 1 / 17.0 * 0.2), exact);
}

// What is off the same way everywhere does not fade with the number of measurements, and a difference does not have it.
TEST(Fit, ErrorsOfOneCauseDoNotAverageOut)
{
  std::vector<FitMeasurement> measured;
  std::vector<FitError> errors;
  for (int i = 0; i < 40; ++i)
  {
    measured.push_back({ "x", i % 2 == 0 ? 2.0 : 3.0, 1e-4 });
    errors.push_back({ 0.1 * measured.back().value, 0 });
  }
  FitResult r = fit({ { "dry", 1 }, { "moist", 1 } }, measured,
    [](std::span<const double> k)
    {
      FitEvaluation e;
      for (std::size_t i = 0; i < 40; ++i)
      {
        e.values.push_back(k[i % 2]);
        e.derivatives.insert(e.derivatives.end(), { i % 2 == 0 ? 1.0 : 0.0, i % 2 == 0 ? 0.0 : 1.0 });
      }
      return e;
    });
  widen(r, measured, errors);
  // derivatives are those from where the last step began: within a deviation of the measurements, 1e-5 of the values
  EXPECT_NEAR(std::log(r.parameters[0].high / 2), 0.1, 1e-6);
  EXPECT_NEAR(r.covariance[1] / r.covariance[0], 1, 1e-5); // their ratio is told by the measurements
}

} // namespace
