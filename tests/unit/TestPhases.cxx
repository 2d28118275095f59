#include "Support.h"
#include "core/Error.h"
#include "core/Memory.h"
#include "lattice/Phases.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <numeric>

using namespace lamella;
using lamella::testing::refusal;

namespace
{

/// nx × ny greys counted up from 0, so that every node is known by its value.
std::vector<std::uint16_t> ramp(std::int64_t count)
{
  std::vector<std::uint16_t> grey(static_cast<std::size_t>(count));
  std::iota(grey.begin(), grey.end(), std::uint16_t{ 0 });
  return grey;
}

PhaseImage numbered(std::int64_t nx, std::int64_t ny, std::int64_t nz, int dimension)
{
  const Lattice lattice = makeLattice(nx, ny, nz, dimension, 2e-6);
  GreyMap map;
  for (int grey = 0; grey < static_cast<int>(lattice.count()); ++grey)
    map.phaseOfGrey[grey] = fmt::format("p{}", grey);
  return map.apply(lattice, ramp(lattice.count()));
}

} // namespace

TEST(PhaseTable, GivesIdsInOrderAndKeepsThem)
{
  PhaseTable table({ "lumen", "wall" });
  EXPECT_EQ(table.size(), 2U);
  EXPECT_EQ(table.add("wall"), 1);
  EXPECT_EQ(table.add("lamella"), 2);
  EXPECT_EQ(table.name(2), "lamella");
  EXPECT_EQ(table.find("lumen"), std::uint8_t{ 0 });
  EXPECT_FALSE(table.find("glue"));
}

TEST(PhaseTable, RefusesEmptyDoubleAndTooMany)
{
  EXPECT_THROW(PhaseTable({ "" }), ParameterError);
  EXPECT_THROW(PhaseTable({ "wall", "wall" }), ParameterError);
  PhaseTable table;
  for (int i = 0; i < 256; ++i)
    EXPECT_EQ(table.add(fmt::format("p{}", i)), i);
  EXPECT_THROW(table.add("one more"), ParameterError);
  EXPECT_EQ(table.add("p255"), 255); // a known name is no new phase
}

TEST(GreyMap, IdsFollowRisingGreyThenOther)
{
  GreyMap map;
  map.phaseOfGrey = { { 255, "wall" }, { 0, "lumen" }, { 128, "wall" } };
  map.other = "lamella";
  const std::vector<std::uint16_t> grey{ 0, 128, 7, 255 };
  const PhaseImage image = map.apply(makeLattice(2, 2, 1, 2, 1e-6), grey);
  EXPECT_EQ(image.phases.names(), (std::vector<std::string>{ "lumen", "wall", "lamella" }));
  EXPECT_EQ(image.phase, (std::vector<std::uint8_t>{ 0, 1, 2, 1 }));
  EXPECT_EQ(image.fractions(), (std::vector<double>{ 0.25, 0.5, 0.25 }));
}

TEST(GreyMap, VoidIsAlwaysPhaseZero)
{
  GreyMap map;
  map.phaseOfGrey = { { 0, "wall" } };
  map.other = "void";
  const PhaseImage image = map.apply(makeLattice(2, 1, 1, 2, 1), std::vector<std::uint16_t>{ 0, 65535 });
  EXPECT_EQ(image.phases.names(), (std::vector<std::string>{ "void", "wall" }));
  EXPECT_EQ(image.phase, (std::vector<std::uint8_t>{ 1, 0 }));
}

TEST(GreyMap, NamesTheGreyThatHasNoPhase)
{
  GreyMap map;
  map.phaseOfGrey = { { 0, "lumen" } };
  // Memory row 0 is the bottom row, so node 1 of a 2 × 2 picture is x = 1, y = 1 from the top.
  const std::vector<std::uint16_t> grey{ 0, 128, 128, 9 };
  const auto [what, hint] = refusal<InputError>([&] { (void)map.apply(makeLattice(2, 2, 1, 2, 1), grey); });
  EXPECT_EQ(what,
    "grey value 128 is in no phase: 2 nodes have it, one is pixel 1, 1 from the top left; 1 more grey value "
    "likewise");
  EXPECT_EQ(hint, "name it with phase 128=NAME, or all greys that are not listed with other NAME");
}

TEST(GreyMap, RefusesGreysThatNoPictureHasAndWrongCounts)
{
  GreyMap map;
  map.phaseOfGrey = { { 70000, "wall" } };
  EXPECT_THROW((void)map.apply(makeLattice(1, 1, 1, 2, 1), ramp(1)), ParameterError);
  map.phaseOfGrey = { { 0, "wall" } };
  EXPECT_THROW((void)map.apply(makeLattice(2, 1, 1, 2, 1), ramp(1)), ParameterError);
}

TEST(Crop, CountsFromTheTopRowIn2D)
{
  // Rows in memory from the bottom: 0 1 2 | 3 4 5 | 6 7 8 | 9 10 11; the picture's top row is 9 10 11.
  const PhaseImage image = numbered(3, 4, 1, 2);
  const PhaseImage window = crop(image, { { 1, 0, 0 }, { 2, 3, 0 } });
  EXPECT_EQ(window.phase, (std::vector<std::uint8_t>{ 4, 5, 7, 8, 10, 11 }));
  EXPECT_EQ(window.lattice.size, (std::array<std::int64_t, 3>{ 2, 3, 1 }));
  EXPECT_EQ(window.lattice.spacing, 2e-6);
  EXPECT_EQ(window.lattice.origin, (std::array<double, 3>{ 1e-6, 1e-6, 0 }));
  EXPECT_EQ(window.phases.names(), image.phases.names());
}

TEST(Crop, CountsFromTheFirstVoxelIn3D)
{
  const PhaseImage image = numbered(2, 3, 4, 3);
  const PhaseImage window = crop(image, { { 1, 1, 2 }, { 1, 2, 2 } });
  EXPECT_EQ(window.phase, (std::vector<std::uint8_t>{ 15, 17, 21, 23 }));
}

TEST(Crop, RefusesWindowsOutside)
{
  const PhaseImage image = numbered(3, 4, 1, 2);
  const std::int64_t huge = std::numeric_limits<std::int64_t>::max();
  for (const Window& window :
    { Window{ { 0, 0, 0 }, { 4, 4, 0 } }, Window{ { 3, 0, 0 }, { 1, 1, 0 } }, Window{ { -1, 0, 0 }, { 2, 2, 0 } },
      Window{ { 0, 0, 0 }, { 0, 1, 0 } }, Window{ { 1, 1, 0 }, { huge, huge, 0 } } })
    EXPECT_THROW((void)crop(image, window), ParameterError);
  const auto [what, hint] = refusal<ParameterError>([&] { (void)crop(image, { { 0, 2, 0 }, { 3, 3, 0 } }); });
  EXPECT_EQ(what, "the window 0,2,3,3 reaches outside along y in the picture, which is 3 × 4 pixels");
  EXPECT_NE(hint.find("from the top left"), std::string::npos);
}

TEST(Refine, KeepsTheGeometry)
{
  for (const int dimension : { 2, 3 })
  {
    const PhaseImage image = numbered(3, 4, dimension == 3 ? 2 : 1, dimension);
    const PhaseImage fine = refine(image, 3);
    EXPECT_EQ(fine.lattice.count(), image.lattice.count() * (dimension == 3 ? 27 : 9));
    EXPECT_EQ(fine.fractions(), image.fractions());
    for (int axis = 0; axis < dimension; ++axis)
    {
      EXPECT_DOUBLE_EQ(fine.lattice.length(axis), image.lattice.length(axis));
      EXPECT_DOUBLE_EQ(fine.lattice.origin[axis], fine.lattice.spacing / 2);
    }
    for (std::int64_t z = 0; z < fine.lattice.size[2]; ++z)
    {
      for (std::int64_t y = 0; y < fine.lattice.size[1]; ++y)
      {
        for (std::int64_t x = 0; x < fine.lattice.size[0]; ++x)
        {
          ASSERT_EQ(fine.phase[fine.lattice.index(x, y, z)],
            image.phase[image.lattice.index(x / 3, y / 3, dimension == 3 ? z / 3 : 0)]);
        }
      }
    }
  }
}

TEST(Refine, ByOneChangesNothingAndTwiceIsOnce)
{
  const PhaseImage image = numbered(3, 4, 1, 2);
  EXPECT_EQ(refine(image, 1).phase, image.phase);
  EXPECT_EQ(refine(refine(image, 2), 3).phase, refine(image, 6).phase);
}

TEST(Refine, CommutesWithCrop)
{
  const PhaseImage image = numbered(4, 5, 1, 2);
  const PhaseImage first = refine(crop(image, { { 1, 1, 0 }, { 2, 3, 0 } }), 2);
  const PhaseImage second = crop(refine(image, 2), { { 2, 2, 0 }, { 4, 6, 0 } });
  EXPECT_EQ(first.phase, second.phase);
}

TEST(Refine, SaysHowMuchMemoryItWouldNeed)
{
  const PhaseImage image = numbered(10, 10, 1, 2);
  EXPECT_THROW((void)refine(image, 0), ParameterError);
  const auto [what, hint] = refusal<MemoryError>([&] { (void)refine(image, 1000000000); });
  EXPECT_NE(what.find("10 × 10 nodes refined by 1000000000 needs 100.0 EB"), std::string::npos) << what;
  EXPECT_NE(hint.find("refine less"), std::string::npos);
}

TEST(Memory, TextIsReadable)
{
  EXPECT_EQ(bytesText(12), "12 B");
  EXPECT_EQ(bytesText(1e9), "1.0 GB");
  EXPECT_EQ(bytesText(999999), "1.0 MB");
  EXPECT_GT(availableMemory(), 1000000U);
}
