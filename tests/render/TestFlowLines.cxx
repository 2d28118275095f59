// Lines on pictures: equal shares of a flow with a known stream function, even spacing, borders.

#include "FlowLines.h"
#include "Furniture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace lamella::rendering;

namespace
{

PlaneField makeField(int nx, int ny, auto&& value)
{
  PlaneField field{ nx, ny, {}, {} };
  for (int j = 0; j < ny; ++j)
  {
    for (int i = 0; i < nx; ++i)
    {
      const auto [x, y] = value(i, j);
      field.x.push_back(static_cast<float>(x));
      field.y.push_back(static_cast<float>(y));
    }
  }
  return field;
}

std::pair<double, double> range(const Polyline& line, std::size_t axis)
{
  const auto [low, high] = std::minmax_element(
    line.begin(), line.end(), [axis](const Point2& a, const Point2& b) { return a.at(axis) < b.at(axis); });
  return { low->at(axis), high->at(axis) };
}

} // namespace

TEST(EqualFluxLines, LayersGetLinesInProportionToTheirFlux)
{
  // Layers of 8 pixels with flux 1 and 4 in turn: of the flow's 10 shares each pair of layers of 40 carries one fifth
  // of a share in the first and four fifths in the second, so that line k stands where the running sum is k + 1/2
  // shares.
  const PlaneField field = makeField(80, 30, [](int i, int) { return std::pair{ 0.0, i / 8 % 2 == 0 ? 1.0 : 4.0 }; });
  auto lines = EqualFluxLines(field, 10);
  ASSERT_EQ(lines.size(), 10U);
  std::sort(lines.begin(), lines.end(), [](const auto& a, const auto& b) { return a[0][0] < b[0][0]; });
  const auto flowUpTo = [](double x)
  {
    const double pairs = std::floor(x / 16);
    const double rest = x - 16 * pairs;
    return 40 * pairs + std::min(rest, 8.0) + 4 * std::max(0.0, rest - 8);
  };
  for (std::size_t k = 0; k < lines.size(); ++k)
  {
    const auto [left, right] = range(lines[k], 0);
    EXPECT_NEAR(left, right, 1e-3) << "the lines are straight";
    // single precision of the contour: 1e-5 of the whole flow
    EXPECT_NEAR(flowUpTo(left), 20.0 * (static_cast<double>(k) + 0.5), 0.01);
    EXPECT_DOUBLE_EQ(range(lines[k], 1).first, 0) << "from edge to edge";
    EXPECT_DOUBLE_EQ(range(lines[k], 1).second, 30);
    EXPECT_LT(lines[k].front()[1], lines[k].back()[1]) << "along the flux";
  }
}

TEST(EqualFluxLines, FlowAcrossThePictureIsTheSameTurned)
{
  const PlaneField field = makeField(30, 80, [](int, int j) { return std::pair{ -1.0 - j / 40, 0.0 }; });
  const auto lines = EqualFluxLines(field, 6);
  ASSERT_EQ(lines.size(), 6U);
  for (const Polyline& line : lines)
  {
    EXPECT_GT(line.front()[0], line.back()[0]) << "the flux points to the left";
    EXPECT_NEAR(range(line, 1).first, range(line, 1).second, 1e-3);
  }
}

TEST(EqualFluxLines, BendsWithASolenoidalField)
{
  // A stream function of one's own: psi = x + 3 sin(2 pi y / 40) gives lines that swing by 3 pixels.
  const PlaneField field = makeField(60, 80,
    [](int, int j) {
      return std::pair{ 3 * 2 * std::numbers::pi / 40 * std::cos(2 * std::numbers::pi * (j + 0.5) / 40), -1.0 };
    });
  const auto lines = EqualFluxLines(field, 12);
  ASSERT_GE(lines.size(), 10U);
  int compared = 0;
  for (const Polyline& line : lines)
  {
    const auto [left, right] = range(line, 0);
    if (left > 1 && right < 59) // those at the sides leave the picture
    {
      EXPECT_NEAR(right - left, 6, 0.1);
      ++compared;
    }
  }
  EXPECT_GE(compared, 8);
}

TEST(EqualFluxLines, RefusesAFieldWithSources)
{
  const PlaneField field = makeField(40, 40, [](int i, int j) { return std::pair{ i - 10.0, j - 10.0 }; });
  EXPECT_TRUE(EqualFluxLines(field, 10).empty());
  EXPECT_TRUE(EqualFluxLines(makeField(40, 40, [](int, int) { return std::pair{ 0.0, 0.0 }; }), 10).empty());
}

TEST(EvenlySpacedLines, KeepsItsDistance)
{
  const PlaneField field = makeField(100, 60,
    [](int i, int j) {
      return std::pair{ 1.0 + 0.3 * std::sin(j / 9.0), 0.4 * std::cos(i / 13.0) };
    });
  const double separation = 6;
  const auto lines = EvenlySpacedLines(field, separation);
  ASSERT_GT(lines.size(), 6U);
  for (std::size_t a = 0; a < lines.size(); ++a)
  {
    for (std::size_t b = a + 1; b < lines.size(); ++b)
    {
      double nearest = 1e9;
      for (const Point2& p : lines[a])
        for (const Point2& q : lines[b])
          nearest = std::min(nearest, Distance(p, q));
      EXPECT_GE(nearest, 0.5 * separation - 1e-9); // lines end at half the separation (Jobard and Lefer's d_test)
    }
  }
}

TEST(EvenlySpacedLines, CirclesClose)
{
  const PlaneField field = makeField(60, 60, [](int i, int j) { return std::pair{ 29.5 - j, i - 29.5 }; });
  for (const Polyline& line : EvenlySpacedLines(field, 8))
  {
    const double radius = Distance(line.front(), { 30, 30 });
    for (const Point2& p : line)
      EXPECT_NEAR(Distance(p, { 30, 30 }), radius, 0.1);
  }
}

TEST(BlockArrows, ShowTheMeanOfEachBlock)
{
  const PlaneField field = makeField(40, 20, [](int i, int) { return std::pair{ i < 20 ? 1.0 : 0.5, 0.0 }; });
  const auto arrows = BlockArrows(field, 20);
  ASSERT_EQ(arrows.size(), 2U);
  EXPECT_NEAR(arrows[0].tip[0] - arrows[0].tail[0], 18, 1e-6);
  EXPECT_NEAR(arrows[1].tip[0] - arrows[1].tail[0], 9, 1e-6);
  EXPECT_NEAR(arrows[1].tip[1], 10, 1e-9);
}

TEST(Outline, FollowsACircleWithinHalfAPixel)
{
  std::vector<bool> inside(60UL * 60UL);
  for (int j = 0; j < 60; ++j)
    for (int i = 0; i < 60; ++i)
      inside[static_cast<std::size_t>(60 * j + i)] = std::hypot(i - 29.5, j - 29.5) < 20;
  const auto lines = Outline(inside, 60, 60);
  ASSERT_EQ(lines.size(), 1U);
  for (const Point2& p : Smooth(lines[0], 0.5, 0.8))
    EXPECT_NEAR(Distance(p, { 30, 30 }), 20, 0.5);
}

TEST(Numbers, TicksAreRound)
{
  EXPECT_EQ(NiceTicks(0, 1), (std::vector<double>{ 0, 0.2, 0.4, 0.6000000000000001, 0.8, 1 }));
  for (const double high : { 0.7, 1.3, 4.0, 9.9, 123.0, 7.7e-7 })
  {
    const auto ticks = NiceTicks(0, high);
    EXPECT_GE(ticks.size(), 4U) << high;
    EXPECT_LE(ticks.size(), 7U) << high;
    EXPECT_DOUBLE_EQ(ticks.front(), 0);
    EXPECT_LE(ticks.back(), high * (1 + 1e-6));
  }
}

TEST(Numbers, LabelsShowNoMoreThanIsThere)
{
  int exponent = 7;
  EXPECT_EQ(TickLabels({ 0, 0.25, 0.5 }, exponent), (std::vector<std::string>{ "0.00", "0.25", "0.50" }));
  EXPECT_EQ(exponent, 0);
  EXPECT_EQ(TickLabels({ -2, 0, 2 }, exponent), (std::vector<std::string>{ "−2", "0", "2" }));
  EXPECT_EQ(TickLabels({ 0, 2e4, 4e4 }, exponent), (std::vector<std::string>{ "0", "20", "40" }));
  EXPECT_EQ(exponent, 3);
  EXPECT_EQ(TickLabels({ 0, 1e-4, 2e-4 }, exponent), (std::vector<std::string>{ "0", "100", "200" }));
  EXPECT_EQ(exponent, -6);
  EXPECT_EQ(RaisedText(-6), "⁻⁶");
}

TEST(Numbers, LengthsOfScaleBars)
{
  std::string text;
  EXPECT_DOUBLE_EQ(NiceLength(7.3e-5, true, text), 5e-5);
  EXPECT_EQ(text, "50 µm");
  EXPECT_DOUBLE_EQ(NiceLength(1.2e-3, true, text), 1e-3);
  EXPECT_EQ(text, "1 mm");
  EXPECT_DOUBLE_EQ(NiceLength(2.4e-7, true, text), 2e-7);
  EXPECT_EQ(text, "0.2 µm");
  EXPECT_DOUBLE_EQ(NiceLength(3e-9, true, text), 2e-9);
  EXPECT_EQ(text, "2 nm");
  EXPECT_DOUBLE_EQ(NiceLength(130, false, text), 100);
  EXPECT_EQ(text, "100 pixels");
}
