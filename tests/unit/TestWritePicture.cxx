#include "PictureFiles.h"
#include "Support.h"

#include "core/WholeFile.h"
#include "generators/Generators.h"
#include "pictures/Picture.h"
#include "pictures/WritePicture.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <numeric>
#include <span>
#include <string_view>

using namespace lamella;
using namespace lamella::micrograph;
using lamella::testing::refusal;
using lamella::testing::TemporaryFolder;

namespace
{

std::size_t filesIn(const std::filesystem::path& folder)
{
  return static_cast<std::size_t>(
    std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator()));
}

std::span<const std::byte> bytesOf(std::string_view text)
{
  return std::as_bytes(std::span(text));
}

GreyMap labels()
{
  GreyMap map;
  map.phaseOfGrey = { { 0, "lumen" }, { 255, "wall" } };
  return map;
}

} // namespace

TEST(WriteLabels, ReadingGivesTheSameLatticeBack)
{
  const TemporaryFolder folder;
  for (const double spacing : { 1e-6, 0.4e-6, 0.123456789e-6, 7.7e-6 })
  {
    generators::SoftwoodOptions options;
    options.size = { 61, 40, 1 };
    options.spacing = spacing;
    options.tangentialDiameter *= spacing / 1e-6;
    options.radialDiameterEarly *= spacing / 1e-6;
    options.radialDiameterLate *= spacing / 1e-6;
    options.rayEvery = 0;
    const PhaseImage image = generators::softwood(options);
    for (const char* name : { "a.png", "a.tif", "a.TIFF" })
    {
      writeLabels(image, folder / name, {}, "seed 1, µm");
      const Picture picture = readPicture(folder / name);
      EXPECT_EQ(labels().apply(picture.lattice, picture.grey).phase, image.phase);
      EXPECT_EQ(picture.lattice.size, image.lattice.size);
      // PNG has whole pixels a metre: half a pixel off at most.
      // TIFF has, by libtiff, a float of 24 bits.
      EXPECT_NEAR(picture.lattice.spacing, spacing, (std::string(name) == "a.png" ? 0.51 * spacing : 1e-7) * spacing);
      EXPECT_EQ(picture.description, "seed 1, µm");
      EXPECT_TRUE(picture.warnings.empty());
    }
  }
  EXPECT_EQ(filesIn(folder.path()), 3U);
}

TEST(WriteLabels, VolumesBecomePagesInTheirOrder)
{
  const TemporaryFolder folder;
  const PhaseImage image = generators::laminate(3, { 5, 7, 9 }, 2e-6, 2, 0.4, 2);
  writeLabels(image, folder / "a.tif");
  const Picture picture = readPicture(folder / "a.tif");
  EXPECT_EQ(picture.lattice.dimension, 3);
  EXPECT_EQ(picture.lattice.size, image.lattice.size);
  EXPECT_EQ(picture.lattice.spacing, 2e-6);
  GreyMap map;
  map.phaseOfGrey = { { 0, "matrix" }, { 255, "inclusion" } };
  EXPECT_EQ(map.apply(picture.lattice, picture.grey).phase, image.phase);
}

TEST(WriteLabels, UnknownPixelSizeStaysUnknown)
{
  const TemporaryFolder folder;
  const PhaseImage image = generators::checkerboard(2, { 4, 4, 1 }, 1, 2);
  for (const char* name : { "a.png", "a.tif" })
  {
    const std::vector<std::uint8_t> greys{ 200, 10 };
    writeLabels(image, folder / name, greys, {}, false);
    const Picture picture = readPicture(folder / name);
    EXPECT_EQ(picture.pixelSizeSource, "none");
    EXPECT_TRUE(picture.warnings.empty());
    EXPECT_EQ(picture.grey[0], 200);
    EXPECT_EQ(picture.grey[2], 10);
  }
}

TEST(WriteLabels, RefusesNamesAndGreysThatDoNotFit)
{
  const TemporaryFolder folder;
  const PhaseImage flat = generators::checkerboard(2, { 4, 4, 1 }, 1e-6, 2);
  const PhaseImage solid = generators::checkerboard(3, { 4, 4, 4 }, 1e-6, 2);
  const std::vector<std::uint8_t> alike{ 5, 5 };
  const std::vector<std::uint8_t> few{ 5 };
  EXPECT_THROW(writeLabels(flat, folder / "a.jpg"), ParameterError);
  EXPECT_THROW(writeLabels(solid, folder / "a.png"), ParameterError);
  EXPECT_THROW(writeLabels(flat, folder / "a.png", alike), ParameterError);
  EXPECT_THROW(writeLabels(flat, folder / "a.png", few), ParameterError);
  EXPECT_EQ(filesIn(folder.path()), 0U);
}

TEST(WriteWhole, LeavesNothingBehindWhenTheFolderIsNotThere)
{
  const TemporaryFolder folder;
  const auto [what, hint] = refusal<Error>([&] { writeWhole(folder / "no/such/a.txt", bytesOf("x")); });
  EXPECT_NE(what.find("a.txt' cannot be written: No such file or directory"), std::string::npos) << what;
  EXPECT_FALSE(hint.empty());
}

TEST(WriteWhole, KeepsTheOldFileWhenTheDiskIsFull)
{
  const TemporaryFolder folder;
  writeWhole(folder / "a.txt", bytesOf("old"));
  // A limit on the size of files stands for a full disk: the write fails in the same way, in the middle of the file.
  const auto before = std::signal(SIGXFSZ, SIG_IGN);
  rlimit limit{};
  getrlimit(RLIMIT_FSIZE, &limit);
  const rlimit small{ 100000, limit.rlim_max };
  setrlimit(RLIMIT_FSIZE, &small);
  const std::string large(1000000, 'x');
  const auto [what, hint] = refusal<Error>([&] { writeWhole(folder / "a.txt", bytesOf(large)); });
  setrlimit(RLIMIT_FSIZE, &limit);
  std::signal(SIGXFSZ, before);
  EXPECT_NE(what.find("cannot be written whole"), std::string::npos) << what;
  EXPECT_NE(hint.find("make room"), std::string::npos) << hint;
  EXPECT_EQ(lamella::testing::bytesOf(folder / "a.txt"), (lamella::testing::Bytes{ 'o', 'l', 'd' }));
  EXPECT_EQ(filesIn(folder.path()), 1U);
}

TEST(WriteWhole, LeavesNothingBehindWhenTheWriterGivesUp)
{
  const TemporaryFolder folder;
  EXPECT_THROW(writeWhole(folder / "a.txt",
                 [](const PartFile& part) -> int
                 {
                   EXPECT_EQ(part.write(bytesOf("half")), 0);
                   throw Cancelled();
                 }),
    Cancelled);
  EXPECT_EQ(filesIn(folder.path()), 0U);
}

TEST(WritePicture, SixteenBitsAndColoursComeBack)
{
  const TemporaryFolder folder;
  Picture picture;
  picture.lattice = makeLattice(7, 5, 1, 2, 0.5e-6);
  picture.pixelSizeSource = "option";
  picture.bits = 16;
  picture.grey.resize(35);
  std::iota(picture.grey.begin(), picture.grey.end(), std::uint16_t{ 65000 });
  writePicture(picture, folder / "a.png", "a test", 1);
  const Picture grey = readPicture(folder / "a.png");
  EXPECT_EQ(grey.grey, picture.grey);
  EXPECT_EQ(grey.bits, 16);
  EXPECT_EQ(grey.description, "a test");
  picture.colour.resize(105);
  std::iota(picture.colour.begin(), picture.colour.end(), std::uint16_t{ 300 });
  writePicture(picture, folder / "b.png");
  ReadOptions options;
  options.keepColour = true;
  EXPECT_EQ(readPicture(folder / "b.png", options).colour, picture.colour);
}
