// Curves of compression: laws whose numbers are known, noise, curves that end early, what is refused.
#include "Support.h"

#include "compression/CompressionCurve.h"
#include "core/Error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

namespace
{

using namespace lamella;
using namespace lamella::compression;

struct Columns
{
  std::vector<double> strain;
  std::vector<double> stress;
};

Columns sampled(double end, double step, const std::function<double(double)>& law)
{
  Columns c;
  const auto rows = static_cast<std::size_t>(std::lround(end / step)) + 1;
  for (std::size_t i = 0; i < rows; ++i)
  {
    c.strain.push_back(static_cast<double>(i) * step);
    c.stress.push_back(law(c.strain.back()));
  }
  return c;
}

constexpr double young = 2e8;
constexpr double plateau = 4e6;
constexpr double yieldStrain = plateau / young; // 2 %
constexpr double dense = 0.5;
constexpr double rise = 4e8; // [Pa], beyond `dense` times (ε − dense)²

/// Linear, flat, and from a strain of 0.5 on a parabola.
double foam(double strain)
{
  if (strain < yieldStrain)
    return young * strain;
  return plateau + (strain > dense ? rise * (strain - dense) * (strain - dense) : 0);
}

/// Where its efficiency is largest: with x = ε − 0.5 and W = W₀ + σ_p x + c x³/3, W' σ = W σ' is
/// (σ_p + c x²)² = 2 c x (W₀ + σ_p x + c x³/3), solved by bisection.
double foamDensifies()
{
  const double before = plateau * (dense - yieldStrain / 2);
  double low = 0;
  double high = 0.2;
  for (int i = 0; i < 60; ++i)
  {
    const double x = (low + high) / 2;
    const double stress = plateau + rise * x * x;
    (stress * stress > 2 * rise * x * (before + plateau * x + rise * x * x * x / 3) ? low : high) = x;
  }
  return dense + low;
}

CompressionCurve analysed(const Columns& c, const CurveOptions& options = {})
{
  return compressionCurve(c.strain, c.stress, options);
}

bool misses(const CompressionCurve& found, const std::string& words)
{
  return std::ranges::any_of(
    found.missing, [&](const std::string& text) { return text.find(words) != std::string::npos; });
}

TEST(CompressionCurve, LinearPlateauAndParabolaHaveTheirOwnNumbers)
{
  CurveOptions options;
  options.smoothing = 0;
  options.stiffnessRange = { 0, 0.02 };
  const Columns c = sampled(0.8, 1e-4, foam);
  const CompressionCurve found = analysed(c, options);
  ASSERT_TRUE(found.linear && found.yield && found.plateau && found.densification && found.plateauEnd);
  EXPECT_NEAR(found.linear->slope, young, 1e-9 * young); // round-off of 200 rows
  EXPECT_NEAR(found.linear->intercept, 0, 1e-9 * plateau);
  EXPECT_NEAR(found.linear->r2, 1, 1e-12);
  EXPECT_EQ(found.linear->rows, 201U);
  // The line moved by 0.2 % meets the flat part at 2.2 %.
  EXPECT_NEAR(found.yield->strain, yieldStrain + 0.002, 1e-9);
  EXPECT_NEAR(found.yield->stress, plateau, 1e-6 * plateau);
  EXPECT_FALSE(found.peak);
  EXPECT_TRUE(misses(found, "peak: the stress never falls by 0.05"));
  // The largest of rows 1e-4 apart.
  EXPECT_NEAR(found.densification->strain, foamDensifies(), 1e-4);
  EXPECT_NEAR(found.densification->stress, foam(foamDensifies()), 0.003 * plateau);
  EXPECT_NEAR(found.densification->efficiency, found.densification->energy / found.densification->stress, 1e-12);
  // Mean from yield to densification: flat but for the parabola's ∫ = c x³/3.
  const double x = found.densification->strain - dense;
  const double length = found.densification->strain - found.yield->strain;
  EXPECT_NEAR(found.plateau->stress, plateau + rise * x * x * x / 3 / length, 1e-4 * plateau); // trapezia: c h²/12
  EXPECT_EQ(found.plateau->low, found.yield->strain);
  EXPECT_EQ(found.plateau->high, found.densification->strain);
  EXPECT_NEAR(found.plateauEnd->stress, 1.3 * found.plateau->stress, 1e-9 * plateau);
  EXPECT_NEAR(foam(found.plateauEnd->strain), found.plateauEnd->stress, 1e-4 * plateau);
  // W at the end: triangle, rectangle, ∫ of the parabola.
  const double work = plateau * (0.8 - yieldStrain / 2) + rise * std::pow(0.3, 3) / 3;
  EXPECT_NEAR(found.energy.back(), work, 1e-6 * work);
  EXPECT_EQ(found.energy.front(), 0);
  EXPECT_TRUE(std::isnan(found.efficiency.front())); // 0 over 0
  EXPECT_NEAR(found.efficiency[10], c.strain[10] / 2, 1e-12);
}

TEST(CompressionCurve, DefaultsFitThreePerCentAndSmoothingMovesLittle)
{
  const CompressionCurve found = analysed(sampled(0.8, 1e-3, foam));
  ASSERT_TRUE(found.linear && found.yield && found.plateau && found.densification);
  // Regression over 0 to 3 % of a curve that is flat beyond 2 %: slope = ∫ σ (ε − b) dε / (a³/12) with a = 3 %, b =
  // a/2.
  const double a = 0.03;
  const double y = yieldStrain;
  const double linear = young * (y * y * y / 3 - a * y * y / 4);
  const double flat = plateau * ((a * a - y * y) / 2 - a / 2 * (a - y));
  EXPECT_NEAR(found.linear->slope, (linear + flat) / (a * a * a / 12), 0.02 * young); // sum of 31 rows for an integral
  EXPECT_LT(found.linear->r2, 0.97);
  EXPECT_NEAR(found.densification->strain, foamDensifies(), 2e-3); // rows are 1e-3 apart
  EXPECT_NEAR(found.plateau->stress, plateau, 0.06 * plateau);     // with the parabola's begin
}

TEST(CompressionCurve, NoiseOfOnePerCentMovesNumbersByLittle)
{
  const double expected = foamDensifies();
  std::mt19937_64 engine(11);
  std::normal_distribution<double> noise(0, 0.01);
  for (int sample = 0; sample < 20; ++sample)
  {
    // of the stress, and of the plateau's stress as a load cell has it
    const Columns c =
      sampled(0.8, 1e-3, [&](double e) { return foam(e) * (1 + noise(engine)) + plateau * noise(engine); });
    CurveOptions options;
    options.stiffnessRange = { 0, 0.018 };
    const CompressionCurve found = analysed(c, options);
    ASSERT_TRUE(found.linear && found.yield && found.plateau && found.densification);
    // 19 rows: the slope's standard error is 0.01 σ_p √2 / (step √(n³/12)), about 1.3 %.
    EXPECT_NEAR(found.linear->slope, young, 4 * found.linear->standardError);
    EXPECT_LT(found.linear->standardError, 0.02 * young);
    // The line moved by 0.2 % meets a smoothed corner.
    EXPECT_NEAR(found.yield->strain, yieldStrain + 0.002, 0.003);
    EXPECT_FALSE(found.peak); // eleven rows' mean leaves 0.5 % of noise, 5 % is ten times that
    // η is flat where it is largest: W/σ loses 0.5 % within 0.01 of it.
    EXPECT_NEAR(found.densification->strain, expected, 0.015);
    EXPECT_NEAR(found.plateau->stress, plateau, 0.003 * plateau); // a mean of 490 rows: 0.07 %, and its ends
  }
}

TEST(CompressionCurve, FirstPeakIsWhereCellsCollapse)
{
  // A peak of 6 MPa at 3 %, falling to 4 MPa at 4 %.
  const auto law = [](double e)
  { return e < 0.03 ? 2e8 * e : std::max(foam(std::max(e, 0.04)), 6e6 - 2e8 * (e - 0.03)); };
  CurveOptions options;
  options.smoothing = 0;
  options.stiffnessRange = { 0, 0.03 };
  const CompressionCurve found = analysed(sampled(0.8, 1e-3, law), options);
  ASSERT_TRUE(found.peak && found.yield && found.plateau);
  EXPECT_DOUBLE_EQ(found.peak->strain, 0.03);
  EXPECT_DOUBLE_EQ(found.peak->stress, 6e6);
  // 6e6 − s (ε − 0.03) meets s (ε − 0.002) with s = 2e8 at ε = 0.031.
  EXPECT_NEAR(found.yield->strain, 0.031, 1e-9);
  EXPECT_EQ(found.collapse()->strain, found.peak->strain);
  EXPECT_EQ(found.plateau->low, found.peak->strain);
}

TEST(CompressionCurve, OfTwoPlateausThatAbsorbAlikeTheFirstEndsTheCollapse)
{
  const auto stress = [](double second, double e)
  {
    const double first = plateau * std::min(e / 0.02, 1.0) * (1 + std::clamp((e - 0.3) / 0.03, 0.0, 1.0));
    return first * (1 + 20 * std::max(e - second, 0.0));
  };
  CurveOptions options;
  options.smoothing = 0;
  // W/σ is 0.29 at the end of the first plateau, and of the second 0.2975 (within 5 %) or 0.3675 (beyond).
  for (const auto& [second, expected] : { std::pair{ 0.46, 0.3 }, { 0.53, 0.53 } })
  {
    const CompressionCurve found = analysed(sampled(0.7, 1e-3, [&](double e) { return stress(second, e); }), options);
    ASSERT_TRUE(found.densification && found.plateau);
    EXPECT_NEAR(found.densification->strain, expected, 1e-3); // a row
  }
}

TEST(CompressionCurve, SteepestWindowLeavesOutAToe)
{
  // σ = E ε²/(2t) up to a toe t, then straight: the line begins at t/2.
  const double toe = 0.01;
  const auto law = [&](double e)
  { return e < toe ? young * e * e / (2 * toe) : std::min(young * (e - toe / 2), young * 0.03); };
  CurveOptions options;
  options.smoothing = 0;
  options.stiffnessRange = { 0, 0.1 };
  options.window = 0.015;
  const CompressionCurve found = analysed(sampled(0.3, 1e-3, law), options);
  ASSERT_TRUE(found.linear && found.yield);
  EXPECT_NEAR(found.linear->slope, young, 1e-9 * young);
  EXPECT_NEAR(found.linear->toe(), toe / 2, 1e-9);
  EXPECT_NEAR(found.linear->high - found.linear->low, 0.015, 1e-9);
  EXPECT_NEAR(found.yield->strain, 0.03 + toe / 2 + 0.002, 1e-9);
  options.window = 0;
  EXPECT_LT(analysed(sampled(0.3, 1e-3, law), options).linear->slope, 0.5 * young);
}

TEST(CompressionCurve, PlateauOfAGivenRangeIsItsMean)
{
  CurveOptions options;
  options.plateauRange = { 0.2, 0.4 };
  const CompressionCurve found = analysed(sampled(0.48, 0.03, foam), options); // 0.2 and 0.4 lie between rows
  ASSERT_TRUE(found.plateau);
  EXPECT_NEAR(found.plateau->stress, plateau, 1e-9 * plateau);
  EXPECT_FALSE(found.plateauEnd);
  const CompressionCurve line = analysed(sampled(0.6, 0.07, [](double e) { return 1e6 * e; }), options);
  EXPECT_NEAR(line.plateau->stress, 0.3e6, 1e-6); // mean of a straight line
}

TEST(CompressionCurve, WhatACurveDoesNotHoldIsSaidAndNoNumber)
{
  const CompressionCurve early = analysed(sampled(0.45, 1e-3, foam));
  EXPECT_TRUE(early.yield);
  EXPECT_FALSE(early.densification);
  EXPECT_TRUE(misses(early, "densification: the efficiency does not fall before the curve ends"));
  EXPECT_FALSE(early.plateau);
  EXPECT_TRUE(misses(early, "plateau: no densification ends it"));

  const CompressionCurve line = analysed(sampled(0.02, 1e-3, foam));
  EXPECT_TRUE(line.linear);
  EXPECT_FALSE(line.yield);
  EXPECT_TRUE(misses(line, "yield: the curve does not fall below the line at an offset of 0.002"));
  EXPECT_TRUE(misses(line, "densification: no collapse before it"));

  const CompressionCurve coarse = analysed(sampled(0.8, 0.05, foam));
  EXPECT_FALSE(coarse.linear);
  EXPECT_TRUE(misses(coarse, "stiffness: fewer than 3 rows between strains of 0 and 0.03"));

  CurveOptions options;
  options.plateauRange = { 0.2, 0.5 };
  EXPECT_TRUE(misses(analysed(sampled(0.45, 1e-3, foam), options), "does not hold the strains 0.2 to 0.5"));
  const CompressionCurve falling = analysed(sampled(0.3, 1e-3, [](double e) { return 1e6 * (1 - e); }));
  EXPECT_TRUE(misses(falling, "stiffness: the stress does not rise"));
}

TEST(CompressionCurve, BadInputIsRefusedInWords)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto input = [](std::vector<double> strain, std::vector<double> stress)
  { return lamella::testing::refusal<InputError>([&] { (void)compressionCurve(strain, stress, {}); }).first; };
  EXPECT_EQ(input({ 0, 0.1, 0.2 }, { 0, 1 }), "3 strains and 2 stresses");
  EXPECT_EQ(input({ 0, 0.1 }, { 0, 1 }), "a curve of 2 rows");
  EXPECT_EQ(input({ 0, 0.1, 0.2 }, { 0, nan, 1 }), "strain 0.1 and stress nan in row 1 are not both finite");
  EXPECT_EQ(input({ 0, 0.2, 0.1 }, { 0, 1, 2 }), "the strain does not rise from 0.2 in row 1 to 0.1 in row 2");
  EXPECT_EQ(input({ 0, 0.1, 0.1 }, { 0, 1, 2 }), "the strain does not rise from 0.1 in row 1 to 0.1 in row 2");
  EXPECT_EQ(input({ 0, 1, 2 }, { 0, 1, 2 }), "a strain of 1 in row 1 is no compression");
  EXPECT_EQ(input({ 0, 0.1, 0.2 }, { 0, -1e6, -2e6 }), "the stresses do a work of -2e+05 J/m³");

  const Columns c = sampled(0.5, 0.01, foam);
  const auto options = [&](const std::function<void(CurveOptions&)>& spoil)
  {
    CurveOptions o;
    spoil(o);
    return lamella::testing::refusal<ParameterError>([&] { (void)analysed(c, o); }).first;
  };
  EXPECT_NE(options(
              [](CurveOptions& o) {
                o.stiffnessRange = { 0.03, 0 };
              })
              .find("0.03 to one of 0"),
    std::string::npos);
  EXPECT_NE(options([&](CurveOptions& o) { o.plateauRange = { 0.2, nan }; }).find("plateau"), std::string::npos);
  EXPECT_NE(options([](CurveOptions& o) { o.window = 0.04; }).find("a window of 0.04"), std::string::npos);
  EXPECT_NE(options([](CurveOptions& o) { o.offset = -1; }).find("offset of -1"), std::string::npos);
  EXPECT_NE(options([&](CurveOptions& o) { o.smoothing = nan; }).find("smoothed over"), std::string::npos);
  EXPECT_NE(options([](CurveOptions& o) { o.prominence = 1; }).find("prominence of 1"), std::string::npos);
}

} // namespace
