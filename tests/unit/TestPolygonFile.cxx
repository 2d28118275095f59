#include "core/Error.h"
#include "outlines/ContourCheck.h"
#include "outlines/ContourMeasures.h"
#include "outlines/PolygonFile.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <fstream>
#include <string>

using namespace lamella;
using namespace lamella::micrograph;
namespace fs = std::filesystem;

namespace
{

/// A file that goes when the test does.
class PolygonFiles : public ::testing::Test
{
protected:
  void SetUp() override
  {
    folder_ = fs::temp_directory_path() /
      ("lamella-polygons-" + std::to_string(::getpid()) + "-" +
        ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path file(const std::string& text, const std::string& name = "cells.json") const
  {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  PolygonFile read(const std::string& text, const PolygonReadOptions& options = {}) const
  {
    return readPolygons(file(text), options);
  }
  /// The text of the error, and that it is one line with a remedy.
  std::string error(const std::string& text, const PolygonReadOptions& options = {}) const
  {
    try
    {
      static_cast<void>(read(text, options));
    }
    catch (const Error& failure)
    {
      EXPECT_FALSE(failure.hint().empty()) << text;
      EXPECT_EQ(std::string(failure.what()).find('\n'), std::string::npos);
      EXPECT_LT(std::string(failure.what()).size(), 400U);
      return failure.what();
    }
    ADD_FAILURE() << "was read: " << text.substr(0, 200);
    return {};
  }

  fs::path folder_;
};

const std::string square = "[[1,1],[3,1],[3,3],[1,3],[1,1]]";

std::string lumens(const std::string& list)
{
  return R"({"units":"um","lumens":[)" + list + "]}";
}

bool holds(const std::string& text, const std::string& part)
{
  return text.find(part) != std::string::npos;
}

} // namespace

TEST_F(PolygonFiles, LumensAndCellsInTheirUnit)
{
  const PolygonFile f = read(
    R"({"units":"micrometre","outer":[[0,0],[10,0],[10,5],[0,5]],"cells":[{"outer":[[0.5,0.5],[4,0.5],[4,4],[0.5,4]],"lumen":)" +
    square + "}]}");
  EXPECT_EQ(f.unit, 1e-6);
  EXPECT_NEAR(f.lumens.size[0], 10e-6, 1e-18);
  EXPECT_NEAR(f.lumens.size[1], 5e-6, 1e-18);
  ASSERT_EQ(f.lumens.contours.size(), 1U);
  EXPECT_EQ(f.lumens.contours[0].points.size(), 4U); // the repeated first point goes
  ASSERT_TRUE(f.cells);
  EXPECT_EQ(f.cells->contours.size(), 1U);
  EXPECT_NEAR(wallFraction(f.lumens), 1 - 4.0 / 50, 1e-12);
  EXPECT_TRUE(f.warnings.empty());
}

TEST_F(PolygonFiles, EachCellIsSoundByItself)
{
  const std::string inner = R"("lumen":[[1,1],[3,1],[3,3],[1,3]])";
  const auto cells = [&](const std::string& other) {
    return R"({"units":"um","cells":[{"outer":[[0,0],[4,0],[4,4],[0,4]],)" + inner + R"(},{"outer":)" + other + "}]}";
  };
  // Cells may cross each other, also on the picture's border.
  PolygonReadOptions options;
  options.window = { 0.5, 0.5, 5, 3.5 };
  const PolygonFile crossing = read(cells("[[3.5,0],[8,0],[8,4],[3.5,4]]"), options);
  ASSERT_TRUE(crossing.cells);
  EXPECT_TRUE(crossing.warnings.empty());
  ASSERT_EQ(crossing.cells->contours.size(), 2U);
  for (const Contour& contour : crossing.cells->contours)
  {
    EXPECT_FALSE(contour.closed);
    EXPECT_TRUE(validate({ crossing.cells->size, { contour } }).empty());
  }
  EXPECT_NE(crossing.cells->contours[0].lumen, crossing.cells->contours[1].lumen);
  // One that crosses itself is left out, told with its number.
  const PolygonFile bow = read(cells("[[5,0],[9,4],[9,0],[5,4.5]]"));
  EXPECT_EQ(bow.cells->contours.size(), 1U);
  ASSERT_EQ(bow.warnings.size(), 1U);
  EXPECT_TRUE(holds(bow.warnings[0], "cell 2"));
  // A window within a cell's outline, but not within its lumen.
  options.window = { 0.5, 0.5, 3.5, 3.5 };
  EXPECT_TRUE(read(cells("[[5,0],[9,0],[9,4]]"), options).cells->contours.empty());
  // As it was written.
  ContourSet own = bow.lumens;
  own.contours.push_back({ { { 5e-6, 1e-6 }, { 6e-6, 2e-6 }, { 6e-6, 1e-6 }, { 5e-6, 2.5e-6 } }, true, 7 });
  const fs::path path = file("", "own.json");
  writePolygons(bow.lumens, path, &own);
  const PolygonFile back = readPolygons(path);
  EXPECT_EQ(back.cells->contours.size(), 1U);
  ASSERT_EQ(back.warnings.size(), 1U);
  EXPECT_TRUE(holds(back.warnings[0], "cell 7"));
  // A window of it is a part of its picture.
  options.window = { 0, 0, 2e-6, 4e-6 };
  const PolygonFile part = readPolygons(path, options);
  EXPECT_NEAR(wallFraction(part.lumens), 1 - 2.0 / 8, 1e-12);
  EXPECT_EQ(part.cells->contours.size(), 1U);
  options.window = { -1e-6, 0, 2e-6, 4e-6 };
  EXPECT_THROW(static_cast<void>(readPolygons(path, options)), ParameterError);
}

TEST_F(PolygonFiles, PlainListsNeedTheUnit)
{
  EXPECT_TRUE(holds(error("[" + square + "]"), "unit"));
  PolygonReadOptions options;
  options.unit = 1e-6;
  const PolygonFile f = read("[" + square + ",[[5,5],[5,6],[6,6]]]", options); // the second clockwise: turned
  EXPECT_EQ(f.lumens.contours.size(), 2U);
  EXPECT_TRUE(validate(f.lumens).empty());
}

TEST_F(PolygonFiles, AWindowCutsPolygonsOpen)
{
  PolygonReadOptions options;
  options.window = { 0, 0, 2, 4 };
  const PolygonFile f = read(lumens(square), options);
  ASSERT_EQ(f.lumens.contours.size(), 1U);
  EXPECT_FALSE(f.lumens.contours[0].closed);
  EXPECT_NEAR(wallFraction(f.lumens), 1 - 2.0 / 8, 1e-12);
  options.window = { 10, 10, 12, 12 };
  EXPECT_TRUE(holds(error(lumens(square), options), "no lumen lies in the window"));
  options.window = { 1.5, 1.5, 2.5, 2.5 };
  EXPECT_TRUE(holds(error(lumens(square), options), "covers the whole window"));
  options.window = { 2, 0, 1, 4 };
  EXPECT_TRUE(holds(error(lumens(square), options), "empty"));
}

TEST_F(PolygonFiles, YMayPointDown)
{
  PolygonReadOptions options;
  options.yDown = true;
  options.window = { 0, 0, 10, 20 };
  const PolygonFile f = read(lumens(square), options);
  const LumenMeasures m = measureLumens(f.lumens).at(0);
  EXPECT_NEAR(m.centroid[0], 2e-6, 1e-15);
  EXPECT_NEAR(m.centroid[1], 18e-6, 1e-15);
}

TEST_F(PolygonFiles, WhatIsWrittenComesBackBitForBit)
{
  PolygonReadOptions options;
  options.window = { 0, 0, 2, 4.1 };
  const ContourSet set = read(lumens(square + ",[[0.1,3.3],[1.7,3.35],[0.77,3.9]]"), options).lumens;
  for (const char* name : { "own.json", "own.json.gz" })
  {
    writePolygons(set, folder_ / name, &set);
    const PolygonFile back = readPolygons(folder_ / name);
    EXPECT_EQ(back.lumens.size, set.size);
    ASSERT_EQ(back.lumens.contours.size(), set.contours.size());
    for (std::size_t i = 0; i < set.contours.size(); ++i)
    {
      EXPECT_EQ(back.lumens.contours[i].points, set.contours[i].points);
      EXPECT_EQ(back.lumens.contours[i].closed, set.contours[i].closed);
      EXPECT_EQ(back.lumens.contours[i].lumen, set.contours[i].lumen);
    }
    ASSERT_TRUE(back.cells);
  }
  EXPECT_THROW(writePolygons(set, folder_ / "none" / "x.json"), Error);
  EXPECT_THROW(static_cast<void>(readPolygons(folder_ / "own.json", options)), ParameterError); // it has its window
}

TEST_F(PolygonFiles, OpenRingsAreClosedAndLargeGapsTold)
{
  EXPECT_TRUE(read(lumens("[[1,1],[3,1],[3,3],[1,3]]")).warnings.empty()); // one side is left to the reader
  const PolygonFile f = read(lumens("[[1,1],[2,1],[3,1.5],[3,2],[3,3],[2,4],[1.5,4.5],[1,5]]"));
  ASSERT_EQ(f.warnings.size(), 1U);
  EXPECT_TRUE(holds(f.warnings[0], "polygon 1 is open by 4"));
}

TEST_F(PolygonFiles, RepeatedPointsAndFlatRingsAreTold)
{
  const PolygonFile f = read(lumens("[[1,1],[3,1],[3,1],[3,3],[1,3],[1,1]],[[5,5],[6,6],[7,7]]"));
  ASSERT_EQ(f.warnings.size(), 2U);
  EXPECT_TRUE(holds(f.warnings[0], "polygon 2 has no area"));
  EXPECT_TRUE(holds(f.warnings[1], "1 point repeated"));
}

TEST_F(PolygonFiles, BadFilesAreRefusedInOneLine)
{
  EXPECT_TRUE(holds(error("{"), "no JSON"));
  EXPECT_TRUE(holds(error("[[[1,1],[2,NaN]]]"), "no JSON"));
  EXPECT_TRUE(holds(error("[1e999]"), "too large"));
  EXPECT_TRUE(holds(error("3"), "not a list of polygons"));
  EXPECT_TRUE(holds(error("{}"), "neither"));
  EXPECT_TRUE(holds(error(R"({"units":"um","lumens":[]})"), "no polygons"));
  EXPECT_TRUE(holds(error(R"({"units":"um","lumens":{"a":1}})"), "not a list"));
  EXPECT_TRUE(holds(error(R"({"units":"furlong","lumens":[)" + square + "]}"), "furlong"));
  EXPECT_TRUE(holds(error(R"({"units":3,"lumens":[)" + square + "]}"), "not a name"));
  EXPECT_TRUE(holds(error(lumens("[[1,1]]")), "polygon 1 has 1 different point"));
  EXPECT_TRUE(holds(error(lumens("[[1,1],[2,2],[1,1]]")), "2 different points"));
  EXPECT_TRUE(holds(error(lumens("[[1,1],[2,2,3],[1,1]]")), "a point of 3 numbers"));
  EXPECT_TRUE(holds(error(lumens(R"([["1",1],[2,2],[1,1]])")), "string"));
  EXPECT_TRUE(holds(error(lumens("[1,2,3]")), "where a point should be"));
  EXPECT_TRUE(holds(error(lumens("7")), "not a list of points"));
  EXPECT_TRUE(holds(error(lumens("[[1,1],[1e30,1],[3,3]]")), "coordinate"));
  EXPECT_TRUE(holds(error(lumens("[[1,1],[2e6,1],[3,3]]")), "reach over"));
  EXPECT_TRUE(holds(error(lumens("[[0,0],[3,2],[3,0],[0,2.5]]")), "crosses or touches itself"));
  EXPECT_TRUE(holds(error(lumens(square + ",[[2,2],[4,2],[4,4]]")), "lumens 1 and 2 cross"));
  EXPECT_TRUE(holds(error(lumens(square + ",[[1.5,1.5],[2,1.5],[2,2]]")), "lies inside"));
  EXPECT_TRUE(holds(error(R"({"units":"um","cells":[{"inner":1}]})"), "neither \"lumen\" nor"));
  EXPECT_TRUE(holds(error(R"({"units":"um","cells":[5]})"), "neither \"lumen\" nor"));
  EXPECT_TRUE(holds(error(R"({"units":"um","cells":[{"outer":)" + square + "}]}"), "no lumen"));
  EXPECT_TRUE(holds(error(R"({"units":"m","contours":[]})"), "size"));
  EXPECT_TRUE(holds(error(R"({"units":"m","size":[1,1],"contours":[]})"), "no contours"));
  EXPECT_TRUE(holds(error(R"({"units":"m","size":[1,1],"contours":[{"points":5}]})"), "not a list of points"));
  EXPECT_TRUE(holds(error(R"({"units":"m","size":[1,1],"contours":[{"lumen":"a"}]})"), "not an object"));
  EXPECT_TRUE(holds(error(R"({"units":"m","size":[1,1],"contours":[{"closed":false,"points":[[0.1,0.1],[0.2,0.2]]}]})"),
    "ends inside"));
  EXPECT_TRUE(holds(error(""), "empty"));
  EXPECT_THROW(static_cast<void>(readPolygons(folder_ / "none.json")), InputError);
  PolygonReadOptions options;
  options.unit = -1;
  EXPECT_THROW(static_cast<void>(read("[]", options)), ParameterError);
}

TEST_F(PolygonFiles, DamagedGzipIsTold)
{
  const ContourSet set = read(lumens(square)).lumens;
  writePolygons(set, folder_ / "good.json.gz");
  std::ifstream in(folder_ / "good.json.gz", std::ios::binary);
  const std::string packed((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  EXPECT_TRUE(holds(error(packed.substr(0, packed.size() - 12)), "ends too early"));
  std::string damaged = packed;
  damaged[packed.size() / 2] = static_cast<char>(~damaged[packed.size() / 2]);
  EXPECT_TRUE(holds(error(damaged), "damaged"));
  EXPECT_TRUE(holds(error("\x1f\x8b\x08" + std::string(20, '\xff')), "damaged"));
}
