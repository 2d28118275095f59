#include "core/Error.h"
#include "lattice/SubWindows.h"
#include "statistics/Distributions.h"
#include "statistics/WindowError.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

using namespace lamella;
using namespace lamella::statistics;

namespace
{

/// A field of n × n cells; a window's value is the mean of its cells, so halves and thirds need n = 6, 12, ...
using Field = std::vector<double>;

WindowTiling tilingOf(const Field& field, std::size_t n, std::size_t parts)
{
  WindowTiling tiling{ { parts, parts, 1 }, std::vector<double>(parts * parts, 0.0) };
  for (std::size_t y = 0; y < n; ++y)
    for (std::size_t x = 0; x < n; ++x)
      tiling.values[x * parts / n + parts * (y * parts / n)] +=
        field[x + n * y] * static_cast<double>(parts * parts) / static_cast<double>(n * n);
  return tiling;
}

double meanOf(const Field& field)
{
  double sum = 0;
  for (const double v : field)
    sum += v;
  return sum / static_cast<double>(field.size());
}

WindowError errorOf(const Field& field, std::size_t n)
{
  return windowError(meanOf(field), std::vector{ tilingOf(field, n, 2), tilingOf(field, n, 3) });
}

} // namespace

// The quantiles of every table of Student's t and Fisher's F.
TEST(Distributions, AreThoseOfTheTables)
{
  EXPECT_NEAR(studentQuantile(0.95, 1), 12.7062, 1e-4);
  EXPECT_NEAR(studentQuantile(0.95, 4), 2.7764, 1e-4);
  EXPECT_NEAR(studentQuantile(0.95, 30), 2.0423, 1e-4);
  EXPECT_NEAR(studentQuantile(0.99, 10), 3.1693, 1e-4);
  EXPECT_NEAR(studentQuantile(0.95, 1e6), 1.95997, 1e-4);
  EXPECT_NEAR(fisherTail(4.96460, 1, 10), 0.05, 1e-5);
  EXPECT_NEAR(fisherTail(3.32583, 5, 10), 0.05, 1e-5);
  EXPECT_EQ(fisherTail(0, 2, 3), 1);
  EXPECT_NEAR(incompleteBeta(2, 3, 0.4), 0.5248, 1e-12); // 1 − Σ binomial
  EXPECT_THROW((void)studentQuantile(1, 4), ParameterError);
  EXPECT_THROW((void)fisherTail(1, 0, 4), ParameterError);
  EXPECT_NEAR(chiSquareTail(3.841458820694124, 1), 0.05, 1e-12);
  EXPECT_NEAR(chiSquareTail(18.30703805327515, 10), 0.05, 1e-12);
  EXPECT_NEAR(chiSquareTail(2, 2), std::exp(-1.0), 1e-14);
  EXPECT_NEAR(chiSquareTail(1, 4), 1.5 * std::exp(-0.5), 1e-14);
  EXPECT_EQ(chiSquareTail(0, 3), 1);
  EXPECT_THROW((void)chiSquareTail(1, 0), ParameterError);
}

// Of white noise all is known: the picture's mean varies by σ²/cells, windows' variances fall as their area. 4000
// pictures tell a share of 0.95 to within 0.004 (one standard deviation). Half of what the slabs vary more than the
// windows is added, by chance, too: the interval may only be the longer for it.
TEST(WindowError, OfWhiteNoiseHoldsTheMean)
{
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(3, 1);
  constexpr std::size_t n = 12;
  constexpr int pictures = 4000;
  int held = 0;
  int gradients = 0;
  double variance = 0;
  double decay = 0;
  for (int i = 0; i < pictures; ++i)
  {
    Field field(n * n);
    for (double& v : field)
      v = noise(random);
    const WindowError error = errorOf(field, n);
    EXPECT_NEAR(error.bias, 0, 1e-12);
    held += error.low <= 3 && 3 <= error.high ? 1 : 0;
    gradients += error.gradient ? 1 : 0;
    variance += error.deviation * error.deviation * n * n / pictures;
    decay += error.decay / pictures;
  }
  EXPECT_GT(held, 0.945 * pictures);
  EXPECT_LT(held, 0.99 * pictures);
  EXPECT_GT(variance, 0.97); // 1 were there no slabs
  EXPECT_LT(variance, 1.5);
  EXPECT_LT(gradients, 0.004 * pictures); // 0.001 is asked for
  // ln(s₃²/s₂²)/ln(9/4), whose mean is 1 but for the means of logarithms of few squares: E ln χ²_k/k = ψ(k/2) − ln(k/2)
  // is −0.369 of 3 and −0.130 of 8, so 1 + 0.239/0.811; the two sizes see the same noise, which changes no mean.
  EXPECT_NEAR(decay, 1.295, 0.1);
}

// Rows that vary as a whole, by half of the picture's variance 0.09/12 + 1/144: windows side by side are alike, and
// what differs between rows is not averaged over the windows of a row. Independent windows would tell 0.0094 of 0.0144.
TEST(WindowError, SeesWhatWholeRowsHaveInCommon)
{
  std::mt19937_64 random(6);
  std::normal_distribution<double> noise;
  constexpr std::size_t n = 12;
  constexpr int pictures = 2000;
  int held = 0;
  double variance = 0;
  for (int i = 0; i < pictures; ++i)
  {
    Field field(n * n);
    double row = 0;
    for (std::size_t j = 0; j < field.size(); ++j)
    {
      if (j % n == 0)
        row = 0.3 * noise(random);
      field[j] = row + noise(random);
    }
    const WindowError error = errorOf(field, n);
    held += error.low <= 0 && 0 <= error.high ? 1 : 0;
    variance += error.deviation * error.deviation / pictures;
  }
  EXPECT_GT(variance, 0.0115); // half of the slabs' part counts
  EXPECT_GT(held, 0.92 * pictures);
}

TEST(WindowError, TellsAGradientFromScatter)
{
  constexpr std::size_t n = 12;
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise;
  Field field;
  Field level;
  for (std::size_t i = 0; i < n * n; ++i)
  {
    level.push_back(0.1 * noise(random));
    field.push_back(level.back() + 10 + static_cast<double>(i % n)); // from 10 to 21 along x
  }
  const WindowError error = errorOf(field, n);
  ASSERT_TRUE(error.gradient.has_value());
  EXPECT_EQ(error.gradient->axis, 0U);
  EXPECT_NEAR(error.gradient->change, 12, 0.2); // from edge to edge
  EXPECT_LT(error.gradient->chance, 1e-6);
  ASSERT_EQ(error.gradient->slabs.size(), 3U);
  EXPECT_NEAR(error.gradient->slabs[0], 11.5, 0.1);
  EXPECT_NEAR(error.gradient->layered, error.value, 1e-12); // side by side
  // What is left without the layers is the noise: 0.1/12 of the mean, known from few windows. With them it is scatter.
  EXPECT_LT(error.gradient->high - error.gradient->low, 0.2);
  EXPECT_LT(error.gradient->low, error.value);
  EXPECT_GT(error.gradient->high, error.value);
  EXPECT_GT(error.high - error.low, 5);
  EXPECT_FALSE(errorOf(level, n).gradient.has_value());
  // One after the other: then means of windows do not tell how the picture's end changes its value.
  const std::vector tilings{ tilingOf(field, n, 2), tilingOf(field, n, 3) };
  const double series = 3 / (1 / 11.5 + 1 / 15.5 + 1 / 19.5);
  const WindowError layers = windowError(series, tilings, { .seriesAxis = 0 });
  EXPECT_NEAR(layers.gradient->layered, series, 0.1);
  EXPECT_LT(layers.gradient->high, series + 0.3);
  EXPECT_GT(layers.gradient->low, series - 0.3);
  EXPECT_GT(layers.bias, 0.2);
  // What one property shows holds for all.
  const std::vector<WindowProperty> both{ { "a", error.value, tilings, {}, {} },
    { "b", meanOf(level), { tilingOf(level, n, 2), tilingOf(level, n, 3) }, {}, {} } };
  const std::vector<WindowError> shared = windowErrors(both);
  ASSERT_TRUE(shared[1].gradient.has_value());
  EXPECT_EQ(shared[1].gradient->axis, 0U);
  EXPECT_EQ(shared[1].name, "b");
  EXPECT_GT(shared[1].gradient->chance, 0.001);
  const WindowError twice = error.scaled(2);
  EXPECT_EQ(twice.high, 2 * error.high);
  EXPECT_EQ(twice.gradient->slabs[1], 2 * error.gradient->slabs[1]);
  EXPECT_NEAR(twice.relative(), error.relative(), 1e-15);
}

// Of a + b/L the windows tell b exactly; the interval reaches to a, and half of b is taken off.
TEST(WindowError, TakesOffTheBiasOfSmallWindows)
{
  const double a = 5;
  const double b = 0.1;
  const std::vector<WindowTiling> tilings{ { { 2, 2, 1 }, std::vector(4, a + 2 * b) },
    { { 3, 3, 1 }, std::vector(9, a + 3 * b) } };
  const WindowError error = windowError(a + b, tilings);
  EXPECT_NEAR(error.bias, b, 1e-12);
  EXPECT_NEAR(error.expected, a + b / 2, 1e-12);
  EXPECT_LT(error.low, a);
  EXPECT_GT(error.high, a + b);
  // A value with other sides, as good as the material's: the windows alone tell.
  const WindowError periodic = windowError(a, tilings, { .sameSides = false });
  EXPECT_NEAR(periodic.bias, 0, 1e-12);
  EXPECT_NEAR(periodic.high, a, 1e-9);
  // A bias that is known well: all of it is taken off, and little is left.
  const WindowError known = windowError(a + b, tilings, { .biasTaken = 1, .biasDoubt = 0.1 });
  EXPECT_NEAR(known.expected, a, 1e-12);
  EXPECT_LT(known.high - known.low, error.high - error.low);
  // Their number does not help against a bias.
  EXPECT_FALSE(error.picturesFor(0.001).has_value());
  EXPECT_EQ(error.picturesFor(0.5), 1);
}

TEST(WindowError, TellsHowManyPicturesAreWanted)
{
  const std::vector<WindowTiling> tilings{ { { 2, 2, 1 }, { 9, 11, 11, 9 } } };
  const WindowError error = windowError(10, tilings);
  EXPECT_EQ(error.bias, 0);
  EXPECT_NEAR(error.deviation, std::sqrt(4.0 / 3 / 4), 1e-12); // s²/N
  // n pictures: t σ/√n = 2 %
  const double n = std::pow(error.quantile * error.deviation / 0.2, 2);
  EXPECT_EQ(error.picturesFor(0.02), std::ceil(n));
  EXPECT_NEAR(error.relative(), error.quantile * error.deviation / 10, 1e-12);
}

TEST(WindowError, OfSeveralSamplesIsStudents)
{
  const std::vector<double> values{ 1, 2, 3, 4, 5 };
  const WindowError error = sampleError(values);
  EXPECT_EQ(error.value, 3);
  EXPECT_NEAR(error.high, 3 + 2.7764 * std::sqrt(0.5), 1e-3);
  EXPECT_THROW((void)sampleError(std::vector{ 1.0 }), ParameterError);
}

TEST(WindowError, RefusesWhatItCannotTell)
{
  EXPECT_THROW((void)windowError(1, {}), ParameterError);
  EXPECT_THROW((void)windowError(1, std::vector<WindowTiling>{ { { 1, 1, 1 }, { 1 } } }), ParameterError);
  EXPECT_THROW((void)windowError(1, std::vector<WindowTiling>{ { { 2, 2, 1 }, { 1, 2, 3 } } }), ParameterError);
  EXPECT_THROW((void)windowError(1, std::vector<WindowTiling>{ { { 2, 1, 1 }, { 1, NAN } } }), ParameterError);
  EXPECT_TRUE(std::isnan(windowError(0, std::vector<WindowTiling>{ { { 2, 1, 1 }, { 0, 0 } } }).relative()));
}

// Strengths that are all 1000 A^(-1/6) by area, but for a scatter of a tenth on either side of the mean.
TEST(StrengthError, TellsTheSizeEffectAndTheScatter)
{
  const auto tiling = [](std::size_t parts)
  {
    WindowTiling t{ { parts, parts, 1 }, {} };
    const auto n = static_cast<double>(parts * parts);
    const double mean = 1000 * std::pow(n, 1.0 / 6);
    for (std::size_t i = 0; i < parts * parts; ++i)
      t.values.push_back(mean);
    t.values[0] *= 1.1;
    t.values[1] *= 0.9;
    return t;
  };
  const std::vector<WindowTiling> tilings{ tiling(2), tiling(3) };
  const StrengthError found = strengthError(1000, tilings);
  EXPECT_NEAR(found.exponent, -1.0 / 6, 1e-12);
  // squares of relative deviations: 0.02/3 of four windows, 0.02/8 of nine
  const double own = (0.02 * std::pow(4, -2.0 / 3) + 0.02 * std::pow(9, -2.0 / 3)) / 11;
  EXPECT_NEAR(found.error.deviation, 1000 * std::sqrt(own), 1e-9);
  EXPECT_EQ(found.error.freedom, 6);
  EXPECT_NEAR(found.error.high - 1000, 2.4469 * found.error.deviation, 1e-3 * found.error.deviation);
  EXPECT_NEAR(found.error.low + found.error.high, 2000, 1e-9);
  EXPECT_NEAR(found.modulus, std::pow(std::sqrt(0.04 / 11), -1.086), 1e-9);
}

TEST(StrengthError, OfWindowsThatNothingLeadsAcross)
{
  const std::vector<WindowTiling> tilings{ { { 2, 2, 1 }, { 0, 3, 5, 0 } },
    { { 3, 3, 1 }, std::vector<double>(9, 0.0) } };
  const StrengthError found = strengthError(2, tilings);
  EXPECT_TRUE(std::isnan(found.exponent));
  EXPECT_EQ(found.error.low, 0);
  EXPECT_GT(found.error.high, 2);
  EXPECT_THROW((void)strengthError(2, {}), ParameterError);
}

TEST(SubWindows, HoldEveryNodeOnce)
{
  PhaseImage image;
  image.lattice = makeLattice(13, 16, 9, 3, 2e-6);
  for (std::int64_t i = 0; i < image.lattice.count(); ++i)
    image.phase.push_back(static_cast<std::uint8_t>(i % 251));
  for (const int parts : windowParts)
  {
    const SubWindows cuts = subWindows(image.lattice, parts);
    EXPECT_EQ(cuts.counts[0], static_cast<std::size_t>(parts));
    EXPECT_EQ(cuts.counts[2], parts == 2 ? 2U : 1U); // three parts of nine nodes are too short
    std::vector<int> seen(image.phase.size(), 0);
    for (const SubWindow& window : cuts.windows)
    {
      const PhaseImage part = cut(image, window);
      std::size_t at = 0;
      for (std::int64_t z = 0; z < window.size[2]; ++z)
        for (std::int64_t y = 0; y < window.size[1]; ++y)
          for (std::int64_t x = 0; x < window.size[0]; ++x)
          {
            const auto i = static_cast<std::size_t>(
              image.lattice.index(window.first[0] + x, window.first[1] + y, window.first[2] + z));
            EXPECT_EQ(part.phase[at++], image.phase[i]);
            ++seen[i];
          }
    }
    EXPECT_EQ(seen, std::vector<int>(seen.size(), 1));
  }
}
