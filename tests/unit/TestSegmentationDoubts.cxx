// What a threshold gets wrong is right or warned of; whole tissue raises no alarm.
#include "../MicrographKinds.h"

#include "core/Random.h"
#include "segmentation/GreyClasses.h"
#include "segmentation/PieceShapes.h"
#include "segmentation/Segmentation.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

using namespace lamella;
using namespace lamella::micrograph;
using kinds::Kind;

namespace
{

bool doubts(const Segmentation& result, Doubt doubt)
{
  return std::ranges::any_of(
    result.report.doubts, [&](const Remark& remark) { return remark.doubt == doubt; });
}

/// Pictures of a kind, of both families.
std::vector<kinds::Sample> some(Kind kind, std::uint64_t count)
{
  std::vector<kinds::Sample> all;
  for (std::uint64_t seed = 1; seed <= count; ++seed)
    all.push_back(kinds::draw(kind, 100 + seed, seed % 2 == 0));
  return all;
}

class Faulty : public ::testing::TestWithParam<Kind>
{
};

} // namespace

TEST(SegmentationDoubts, WholeTissueRaisesNoAlarm)
{
  for (const kinds::Sample& sample : some(Kind::Good, 8))
  {
    const Segmentation result = segment(sample.picture);
    EXPECT_TRUE(kinds::compare(result.image, sample.open).right()) << sample.what;
    EXPECT_TRUE(result.report.cells) << sample.what;
    for (const std::string& warning : result.warnings)
      ADD_FAILURE() << sample.what << ": " << warning;
  }
}

// Right, or told. Every doubt is among the warnings, which is what people see.
TEST_P(Faulty, IsRightOrWarnedOf)
{
  for (const kinds::Sample& sample : some(GetParam(), 2))
  {
    const Segmentation result = segment(sample.picture);
    EXPECT_TRUE(kinds::compare(result.image, sample.open).right() || !result.report.doubts.empty()) << sample.what;
    for (const Remark& remark : result.report.doubts)
      EXPECT_EQ(std::ranges::count(result.warnings, remark.text), 1);
  }
}

INSTANTIATE_TEST_SUITE_P(SegmentationDoubts, Faulty, ::testing::ValuesIn(kinds::faulty()),
  [](const auto& which)
  {
    std::string word = kinds::name(which.param);
    std::erase_if(word, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; });
    return word;
  });

TEST(SegmentationDoubts, TheReasonIsNamed)
{
  for (const auto& [kind, doubt] : { std::pair{ Kind::Pith, Doubt::Filled }, { Kind::Rock, Doubt::Side },
         { Kind::Tomogram, Doubt::Greys }, { Kind::Coarse, Doubt::Resolution }, { Kind::Background, Doubt::Gaps } })
  {
    const Segmentation result = segment(kinds::draw(kind, 7).picture);
    EXPECT_TRUE(doubts(result, doubt)) << name(doubt);
    EXPECT_EQ(std::ranges::count(result.report.doubtNames(), name(doubt)), 1);
  }
}

// Few filled cells, 5 and 7 % of the picture, most of them cut by its border: too little wall to be told by its share.
TEST(SegmentationDoubts, AFewFilledCellsAreSeen)
{
  for (const std::uint64_t seed : { 4008U, 4013U })
  {
    const Segmentation result = segment(kinds::draw(Kind::Pith, seed, true).picture);
    EXPECT_TRUE(doubts(result, Doubt::Filled)) << "seed " << seed;
  }
}

// Far from the tissue the slide is evened out into wall, so that it touches two sides of the picture, not three.
TEST(SegmentationDoubts, SlideBesideTissueIsNeverTakenInSilence)
{
  for (std::uint64_t seed = 1; seed <= 16; ++seed)
  {
    const kinds::Sample sample = kinds::draw(Kind::Background, seed);
    const Segmentation result = segment(sample.picture);
    EXPECT_TRUE(!result.report.doubts.empty() || kinds::compare(result.image, sample.open).right()) << "seed " << seed;
  }
}

// The limits that the warning names are where the classes part: the lowest of them leaves void alone.
TEST(SegmentationDoubts, ThreeClassesCanBePartedAsTheWarningSays)
{
  for (std::uint64_t seed = 1; seed <= 6; ++seed)
  {
    const kinds::Sample sample = kinds::draw(Kind::Tomogram, seed);
    const Segmentation result = segment(sample.picture);
    const auto at = std::ranges::find(result.report.doubts, Doubt::Greys, &Remark::doubt);
    ASSERT_NE(at, result.report.doubts.end());
    const std::string option = "threshold ";
    SegmentOptions options;
    options.threshold = std::atof(at->text.c_str() + at->text.find(option) + option.size());
    options.lumen = LumenSide::Dark;
    EXPECT_TRUE(kinds::compare(segment(sample.picture, options).image, sample.open).right()) << at->text;
  }
}

TEST(SegmentationDoubts, WhatIsCutAwayIsNotWarnedOf)
{
  const kinds::Sample sample = kinds::draw(Kind::Background, 5);
  const Segmentation whole = segment(sample.picture);
  ASSERT_TRUE(doubts(whole, Doubt::Gaps));
  const auto mark = std::ranges::find(whole.marks, Mark::Kind::Gap, &Mark::kind);
  ASSERT_NE(mark, whole.marks.end());
  // The background is along the left or the lower side.
  const auto [nx, ny, nz] = sample.picture.lattice.size;
  const bool left = mark->y1 - mark->y0 == ny;
  SegmentOptions options;
  options.judged = left ? Window{ { mark->x1, 0, 0 }, { nx - mark->x1, ny, 0 } }
                        : Window{ { 0, 0, 0 }, { nx, ny - mark->y1, 0 } }; // y from the top
  const Segmentation part = segment(sample.picture, options);
  EXPECT_FALSE(doubts(part, Doubt::Gaps));
  EXPECT_EQ(part.image.phase, whole.image.phase);
}

TEST(SegmentationDoubts, WhoSaysWhichSideIsNotAsked)
{
  const kinds::Sample sample = kinds::draw(Kind::Rock, 3);
  ASSERT_TRUE(doubts(segment(sample.picture), Doubt::Side));
  SegmentOptions options;
  options.lumen = LumenSide::Dark;
  const Segmentation told = segment(sample.picture, options);
  EXPECT_FALSE(doubts(told, Doubt::Side));
  EXPECT_FALSE(told.report.cells); // nor are its pores called vessels
}

TEST(SegmentationDoubts, TearsAndBackgroundAreNoVessels)
{
  for (const Kind kind : { Kind::Torn, Kind::Background })
  {
    for (const kinds::Sample& sample : some(kind, 2))
    {
      const Segmentation result = segment(sample.picture);
      for (const Mark& mark : result.marks)
      {
        for (std::size_t i = 0; mark.kind == Mark::Kind::Gap && i < result.shapes.size(); ++i)
        {
          // The largest lumen whose middle lies in the mark is the gap itself.
          const LumenShape& shape = result.shapes[i];
          const bool gap = 2 * shape.area > std::int64_t{ mark.x1 - mark.x0 } * (mark.y1 - mark.y0) / 2 &&
            shape.x >= mark.x0 && shape.x < mark.x1 && shape.y >= mark.y0 && shape.y < mark.y1;
          EXPECT_FALSE(gap && result.vessel[i]) << sample.what;
        }
      }
    }
  }
}

TEST(SegmentationDoubts, WordsOfWoodAreForCellsAlone)
{
  SegmentReport report;
  report.vesselsFound = true;
  report.vessels = 12;
  report.vesselSize = 100;
  EXPECT_NE(report.lines().back().find("vessels: 12"), std::string::npos);
  report.cells = false;
  EXPECT_NE(report.lines().back().find("large pores: 12"), std::string::npos);
}

TEST(GreyClasses, AreCountedInFlatPlaces)
{
  const Random random(3);
  const auto stripes = [&](const std::vector<double>& greys, double sigma, double noise)
  {
    cv::Mat grey(240, 240, CV_32F);
    for (int row = 0; row < grey.rows; ++row)
      for (int x = 0; x < grey.cols; ++x)
        grey.at<float>(row, x) = static_cast<float>(greys[static_cast<std::size_t>(x / 20) % greys.size()]);
    cv::GaussianBlur(grey, grey, cv::Size(), sigma, sigma);
    for (int row = 0; row < grey.rows; ++row)
      for (int x = 0; x < grey.cols; ++x)
        grey.at<float>(row, x) += static_cast<float>(noise * random.normal(RandomUse::Noise, x, row));
    return greyClasses(grey, 120, noise / 120);
  };
  // However wide their ramps, two classes are two.
  EXPECT_EQ(stripes({ 60, 180 }, 1, 0).size(), 2U);
  EXPECT_EQ(stripes({ 60, 180 }, 4, 0).size(), 2U);
  EXPECT_EQ(stripes({ 60, 180 }, 1, 12).size(), 2U);
  const auto three = stripes({ 40, 110, 190 }, 1.2, 12);
  ASSERT_EQ(three.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i)
  {
    EXPECT_NEAR(three[i].grey, (std::array{ 40, 110, 190 })[i], 4); // an eighth of what lies between
    EXPECT_NEAR(three[i].share, 1.0 / 3, 0.03);
  }
  EXPECT_NEAR(three[1].from, 75, 15); // a valley between two summits is broad
  EXPECT_NEAR(three[2].from, 150, 15);
  EXPECT_EQ(stripes({ 100 }, 1, 5).size(), 1U);
}

TEST(PieceShapes, SolidityIsOfThePixelsCorners)
{
  cv::Mat mask(60, 60, CV_8U, cv::Scalar(0));
  cv::rectangle(mask, cv::Rect(5, 5, 10, 6), cv::Scalar(255), cv::FILLED);
  cv::rectangle(mask, cv::Rect(30, 30, 20, 4), cv::Scalar(255), cv::FILLED); // an L of two bars
  cv::rectangle(mask, cv::Rect(30, 30, 4, 20), cv::Scalar(255), cv::FILLED);
  cv::rectangle(mask, cv::Rect(0, 50, 3, 3), cv::Scalar(255), cv::FILLED);
  const auto pieces = pieceShapes(mask, 1);
  ASSERT_EQ(pieces.size(), 3U);
  EXPECT_DOUBLE_EQ(pieces[0].solidity, 1);
  EXPECT_FALSE(pieces[0].cut);
  EXPECT_EQ(pieces[1].area, 144);
  EXPECT_NEAR(pieces[1].solidity, 144.0 / (400 - 16 * 16 / 2.0), 1e-9); // hull: the square less a triangle
  EXPECT_TRUE(pieces[2].cut);
  const SideShape side = sideShape(pieces);
  EXPECT_NEAR(side.compact, 69.0 / 213, 1e-9);
  EXPECT_EQ(pieceShapes(mask, 100).size(), 1U);
}

TEST(SegmentationDoubts, ARealScanOfTissueIsNotDoubted)
{
  const char* const data = std::getenv("LAMELLA_REAL_DATA");
  if (data == nullptr)
    GTEST_SKIP() << "LAMELLA_REAL_DATA is not set";
  ReadOptions read;
  read.keepColour = true;
  const Picture picture = readPicture(std::filesystem::path(data) / "conifer_roxas_scan.jpg", read);
  const Segmentation result = segment(picture);
  EXPECT_TRUE(result.report.doubts.empty());
  EXPECT_TRUE(result.report.cells);
}
