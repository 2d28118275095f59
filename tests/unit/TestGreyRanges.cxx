#include "Support.h"
#include "core/Error.h"
#include "lattice/GreyRanges.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

using namespace lamella;
using lamella::testing::refusal;

namespace
{

GreyRanges rangesOf(const std::vector<std::pair<std::string, std::string>>& named)
{
  GreyRanges ranges;
  for (const auto& [range, name] : named)
    ranges.add(range, name);
  return ranges;
}

/// One row of values as a picture.
PhaseImage applied(const GreyRanges& ranges, const std::vector<std::uint16_t>& grey, const GreyScale& scale = {})
{
  return ranges.apply(makeLattice(static_cast<std::int64_t>(grey.size()), 1, 1, 2, 1), grey, scale).image;
}

std::string wrong(std::string_view text)
{
  return refusal<ParameterError>([&] { (void)parseGreyRange(text); }).first;
}

/// Normally distributed greys about each mean, as many of each.
std::vector<std::uint16_t> heaps(const std::vector<double>& means, double deviation, int each)
{
  std::mt19937 random(7);
  std::vector<std::uint16_t> grey;
  for (const double mean : means)
  {
    std::normal_distribution<double> distribution(mean, deviation);
    for (int i = 0; i < each; ++i)
      grey.push_back(static_cast<std::uint16_t>(std::lround(distribution(random))));
  }
  return grey;
}

} // namespace

TEST(GreyRange, ReadsOneGreyRangesAndOpenEnds)
{
  const GreyRange one = parseGreyRange("7");
  EXPECT_TRUE(one.single);
  EXPECT_EQ(one.first.grey, 7);
  EXPECT_EQ(one.last.grey, 7);
  const GreyRange closed = parseGreyRange(" 0 .. 89 ");
  EXPECT_EQ(closed.first.grey, 0);
  EXPECT_EQ(closed.last.grey, 89);
  EXPECT_FALSE(closed.openEnd);
  EXPECT_TRUE(parseGreyRange("90..").openEnd);
  EXPECT_EQ(parseGreyRange("..89").first.grey, 0);
  EXPECT_EQ(parseGreyRange("5..5").last.grey, 5);
  EXPECT_EQ(parseGreyRange("0..65535").last.grey, 65535);
  const GreyRange middle = parseGreyRange("otsu1..otsu2");
  EXPECT_EQ(middle.first.level, 1);
  EXPECT_EQ(middle.last.level, 2);
  EXPECT_EQ(middle.first.classes, 3);
  EXPECT_EQ(parseGreyRange("..otsu").last.classes, 2);
}

TEST(GreyRange, SaysWhatIsNone)
{
  EXPECT_EQ(wrong("wall"), "'wall' is not a grey value");
  EXPECT_EQ(wrong("-3"), "'-3' is not a grey value");
  EXPECT_EQ(wrong("1.5"), "'1.5' is not a grey value");
  EXPECT_EQ(wrong("70000"), "'70000' is not a grey value");
  EXPECT_EQ(wrong("0..70000"), "'70000' is not a grey value, in the range '0..70000'");
  EXPECT_EQ(wrong("1...9"), "'.9' is not a grey value, in the range '1...9'");
  EXPECT_EQ(wrong("otsu3.."), "'otsu3' is not a grey value, in the range 'otsu3..'");
  EXPECT_EQ(wrong(".."), "the range '..' has no end");
  EXPECT_EQ(wrong("90..0"), "the range of greys '90..0' runs backwards");
  EXPECT_EQ(wrong("otsu2..otsu1"), "the range of greys 'otsu2..otsu1' runs backwards");
  EXPECT_EQ(wrong("otsu"), "'otsu' is a level between two greys, not a grey value");
  EXPECT_EQ(refusal<ParameterError>([] { (void)parseGreyRange("90..0"); }).second, "write the darker end first: 0..90");
  EXPECT_EQ(wrong(""), "'' is not a grey value");
}

TEST(GreyRanges, BothEndsBelongToARange)
{
  const PhaseImage image = applied(rangesOf({ { "90..", "fibre" }, { "0..89", "void" } }), { 0, 89, 90, 255, 65535 });
  EXPECT_EQ(image.phases.names(), (std::vector<std::string>{ "void", "fibre" }));
  EXPECT_EQ(image.phase, (std::vector<std::uint8_t>{ 0, 0, 1, 1, 1 }));
  // Single greys beside ranges, one name for several, and the rest.
  GreyRanges mixed = rangesOf({ { "..9", "void" }, { "50", "fibre" }, { "200..", "fibre" } });
  mixed.other = "resin";
  EXPECT_EQ(applied(mixed, { 9, 10, 50, 51, 200 }).phase, (std::vector<std::uint8_t>{ 0, 2, 1, 2, 1 }));
}

TEST(GreyRanges, NamesTheRangeThatIsMissing)
{
  const GreyRanges ranges = rangesOf({ { "..89", "void" }, { "100..199", "fibre" } });
  const auto [what, hint] = refusal<InputError>([&] { (void)applied(ranges, { 0, 95, 99, 250 }, { 8, 1, {} }); });
  EXPECT_EQ(what,
    "the grey values 90..99 and 200..255 are in no phase: 3 nodes have such a grey, one is pixel 1, 0 from the top "
    "left "
    "with 95");
  EXPECT_EQ(
    hint, "name them with phase 90..99=NAME and 200..255=NAME, or all greys that are not listed with other NAME");
  // Greys that no node has need no phase.
  EXPECT_EQ(applied(ranges, { 0, 150 }).phase, (std::vector<std::uint8_t>{ 0, 1 }));
  // Where only single greys are named the grey itself is told.
  EXPECT_EQ(refusal<InputError>(
              [&] {
                (void)applied(rangesOf({ { "0", "void" } }), { 0, 7 });
              })
              .first,
    "grey value 7 is in no phase: 1 node has it, one is pixel 1, 0 from the top left");
}

TEST(GreyRanges, RefusesWhatHasTwoNamesOrNoPicture)
{
  GreyRanges ranges = rangesOf({ { "0..100", "void" } });
  const auto [what, hint] = refusal<ParameterError>([&] { ranges.add("90..", "fibre"); });
  EXPECT_EQ(what, "the greys 0..100 of 'void' and 90.. of 'fibre' overlap: 90..100 would be both");
  EXPECT_NE(hint.find("..89 and 90.."), std::string::npos);
  EXPECT_NO_THROW(ranges.add("50..120", "void")); // the same phase twice contradicts nothing
  EXPECT_THROW(ranges.add("200", ""), ParameterError);
  EXPECT_THROW(rangesOf({ { "7", "a" }, { "7", "b" } }), ParameterError);
  EXPECT_THROW(rangesOf({ { "..otsu", "a" }, { "otsu2..", "b" } }), ParameterError);

  // An 8-bit picture has no 300; as far as greys go is no mistake.
  EXPECT_EQ(refusal<ParameterError>(
              [] {
                (void)applied(rangesOf({ { "90..300", "a" } }), { 90 }, { 8, 1, {} });
              })
              .first,
    "phase 'a' is given the greys 90..300, and those of this picture run from 0 to 255 (8 bits)");
  EXPECT_THROW((void)applied(rangesOf({ { "300", "a" } }), { 90 }, { 8, 1, {} }), ParameterError);
  EXPECT_NO_THROW((void)applied(rangesOf({ { "90..", "a" } }), { 90 }, { 8, 1, {} }));
  EXPECT_NO_THROW((void)applied(rangesOf({ { "90..300", "a" } }), { 90, 300 }));

  // Overlaps that only the picture shows: its level lies at 50.
  const std::vector<std::uint16_t> two{ 0, 0, 100, 100 };
  EXPECT_NE(refusal<ParameterError>(
              [&] {
                (void)applied(rangesOf({ { "..otsu", "a" }, { "20..", "b" } }), two);
              })
              .first.find("overlap in this picture"),
    std::string::npos);
  EXPECT_NE(refusal<ParameterError>(
              [&] {
                (void)applied(rangesOf({ { "200..otsu", "a" } }), two);
              })
              .first.find("are none in this picture, where the level is 49"),
    std::string::npos);
}

TEST(GreyRanges, PartsAtOtsusLevels)
{
  // The level lies in the middle of the gap between the only two greys.
  const GreyRanges two = rangesOf({ { "otsu..", "fibre" }, { "..otsu", "void" } });
  const auto found = two.apply(makeLattice(4, 1, 1, 2, 1), std::vector<std::uint16_t>{ 10, 10, 200, 10 });
  ASSERT_TRUE(found.levels);
  EXPECT_EQ(found.levels->last, std::vector<int>{ 104 });
  EXPECT_EQ(found.image.phase, (std::vector<std::uint8_t>{ 0, 0, 1, 0 }));
  EXPECT_EQ(found.levels->separability, 1);
  EXPECT_TRUE(found.warnings.empty());
  EXPECT_THROW((void)applied(two, { 7, 7, 7 }), InputError);

  const GreyRanges three = rangesOf({ { "..otsu1", "void" }, { "otsu1..otsu2", "matrix" }, { "otsu2..", "fibre" } });
  const std::vector<std::uint16_t> grey = heaps({ 10000, 20000, 50000 }, 1000, 4000);
  const auto parted = three.apply(makeLattice(12000, 1, 1, 2, 1), grey);
  // In the middle of the gap between the heaps, whose ends scatter by a quarter of the deviation.
  EXPECT_NEAR(parted.levels->last[0], 15000, 500);
  EXPECT_NEAR(parted.levels->last[1], 35000, 500);
  EXPECT_EQ(parted.image.fractions(), (std::vector<double>(3, 1.0 / 3)));
}

TEST(GreyLevels, DoubtsOneHeapAndEqualGreys)
{
  // A Gaussian parted at its middle: between-class over total variance is 2/π; 20 000 values tell it to 0.01.
  const GreyLevels one = otsuLevels(greyHistogram(heaps({ 1000 }, 100, 20000)), 2);
  EXPECT_NEAR(one.separability, 0.637, 0.01);
  EXPECT_GT(one.valley, 0.95);
  EXPECT_NE(one.doubt().find("no valley"), std::string::npos);
  // Equally common greys: 3/4, and no valley either.
  std::vector<std::uint16_t> even(1000);
  for (std::size_t i = 0; i < even.size(); ++i)
    even[i] = static_cast<std::uint16_t>(i);
  const GreyLevels flat = otsuLevels(greyHistogram(even), 2);
  EXPECT_NEAR(flat.separability, 0.75, 0.001);
  EXPECT_FALSE(flat.doubt().empty());
  // Two heaps six deviations apart are not doubted, however rare one is.
  EXPECT_EQ(otsuLevels(greyHistogram(heaps({ 1000, 1600 }, 100, 20000)), 2).doubt(), "");
  std::vector<std::uint16_t> rare = heaps({ 1000 }, 100, 20000);
  const std::vector<std::uint16_t> few = heaps({ 2000 }, 100, 1000);
  rare.insert(rare.end(), few.begin(), few.end());
  EXPECT_EQ(otsuLevels(greyHistogram(rare), 2).doubt(), "");
  EXPECT_NE(otsuLevels(greyHistogram(heaps({ 1000, 1200 }, 100, 20000)), 2).doubt(), "");
}
