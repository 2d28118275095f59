#include "PictureFiles.h"
#include "Support.h"

#include "io/Provenance.h"
#include "pictures/JpegFile.h"
#include "pictures/Picture.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>

using namespace lamella;
using namespace lamella::micrograph;
using lamella::testing::Bytes;
using lamella::testing::PngFile;
using lamella::testing::refusal;
using lamella::testing::TemporaryFolder;
using lamella::testing::TiffFile;

namespace
{

using Greys = std::vector<std::uint16_t>;
using Size = std::array<std::int64_t, 3>;

Bytes jpeg(int width, int height, int channels = 1)
{
  Pixels pixels{ width, height, channels };
  for (int row = 0; row < height; ++row)
    for (int x = 0; x < width * channels; ++x)
      pixels.values.push_back(static_cast<std::uint8_t>(20 + 3 * x + 5 * row));
  return encodeJpeg(pixels);
}

/// What and hint of the refusal of a file; both must be there, on one line each.
std::pair<std::string, std::string> refused(const std::filesystem::path& path, const ReadOptions& options = {})
{
  auto texts = refusal<InputError>([&] { (void)readPicture(path, options); });
  EXPECT_FALSE(texts.first.empty()) << path << " was read";
  EXPECT_FALSE(texts.second.empty()) << path;
  EXPECT_EQ((texts.first + texts.second).find('\n'), std::string::npos);
  return texts;
}

bool contains(const std::string& text, const std::string& part)
{
  return text.find(part) != std::string::npos;
}

} // namespace

TEST(Picture, PngIsFlippedSoThatTheBottomRowComesFirst)
{
  const TemporaryFolder folder;
  PngFile png;
  png.width = 3;
  png.rows = { { 1, 2, 3 }, { 4, 5, 6 } };
  const Picture picture = readPicture(folder.write("a.png", png.bytes()));
  EXPECT_EQ(picture.grey, (Greys{ 4, 5, 6, 1, 2, 3 }));
  EXPECT_EQ(picture.lattice.dimension, 2);
  EXPECT_EQ(picture.lattice.size, (Size{ 3, 2, 1 }));
  EXPECT_EQ(picture.lattice.spacing, 1);
  EXPECT_EQ(picture.pixelSizeSource, "none");
  EXPECT_EQ(picture.bits, 8);
  EXPECT_EQ(picture.format, "PNG");
  EXPECT_TRUE(picture.warnings.empty());
}

TEST(Picture, PngOfEveryKind)
{
  const TemporaryFolder folder;
  PngFile png;
  png.bits = 16;
  png.rows = { { 0x01, 0x02, 0xff, 0xfe }, { 0, 0, 0, 1 } };
  const Picture deep = readPicture(folder.write("16.png", png.bytes()));
  EXPECT_EQ(deep.grey, (Greys{ 0, 1, 0x0102, 0xfffe }));
  EXPECT_EQ(deep.bits, 16);

  png = {};
  png.bits = 1;
  png.rows = { { 0x80 }, { 0x40 } };
  EXPECT_EQ(readPicture(folder.write("1.png", png.bytes())).grey, (Greys{ 0, 255, 255, 0 }));

  png = {};
  png.colourType = 2;
  png.rows = { { 7, 7, 7, 9, 9, 9 }, { 1, 1, 1, 2, 2, 2 } };
  EXPECT_EQ(readPicture(folder.write("rgb.png", png.bytes())).grey, (Greys{ 1, 2, 7, 9 }));

  png = {};
  png.colourType = 3;
  png.chunks = { { "PLTE", { 0, 0, 0, 128, 128, 128, 255, 255, 255 } } };
  png.rows = { { 0, 1 }, { 2, 1 } };
  EXPECT_EQ(readPicture(folder.write("palette.png", png.bytes())).grey, (Greys{ 255, 128, 0, 128 }));

  png.chunks.push_back({ "tRNS", { 255, 255, 10 } });
  const Picture seeThrough = readPicture(folder.write("index.png", png.bytes()));
  EXPECT_EQ(seeThrough.grey, (Greys{ 255, 128, 0, 128 }));
  ASSERT_EQ(seeThrough.warnings.size(), 1U);
  EXPECT_TRUE(contains(seeThrough.warnings[0], "transparent"));

  png = {};
  png.colourType = 4;
  png.rows = { { 5, 255, 6, 255 }, { 7, 255, 8, 255 } };
  const Picture opaque = readPicture(folder.write("alpha.png", png.bytes()));
  EXPECT_EQ(opaque.grey, (Greys{ 7, 8, 5, 6 }));
  EXPECT_TRUE(opaque.warnings.empty());
  png.rows[0][1] = 100;
  const Picture transparent = readPicture(folder.write("through.png", png.bytes()));
  ASSERT_EQ(transparent.warnings.size(), 1U);
  EXPECT_TRUE(contains(transparent.warnings[0], "transparent"));
}

TEST(Picture, ColourIsRefusedWithTheFirstColouredPixelUnlessAskedFor)
{
  const TemporaryFolder folder;
  PngFile png;
  png.colourType = 2;
  png.rows = { { 7, 7, 7, 9, 9, 9 }, { 1, 1, 1, 200, 30, 90 } };
  const auto file = folder.write("colour.png", png.bytes());
  const auto [what, hint] = refused(file);
  EXPECT_TRUE(
    contains(what, "colour.png' is a colour picture: pixel 1, 1 from the top left is red 200, green 30, blue 90"))
    << what;
  EXPECT_TRUE(contains(hint, "segment")) << hint;
  ReadOptions options;
  options.keepColour = true;
  const Picture picture = readPicture(file, options);
  EXPECT_EQ(picture.colour, (Greys{ 1, 1, 1, 200, 30, 90, 7, 7, 7, 9, 9, 9 }));
  EXPECT_EQ(picture.grey[1], 88); // 0.299 · 200 + 0.587 · 30 + 0.114 · 90 = 87.7
}

TEST(Picture, OneByOneAndVeryLong)
{
  const TemporaryFolder folder;
  PngFile png;
  png.width = png.height = 1;
  png.rows = { { 42 } };
  EXPECT_EQ(readPicture(folder.write("1x1.png", png.bytes())).grey, (Greys{ 42 }));
  png.width = 100000;
  png.rows = { Bytes(100000, 9) };
  const Picture wide = readPicture(folder.write("wide.png", png.bytes()));
  EXPECT_EQ(wide.lattice.size, (Size{ 100000, 1, 1 }));
  EXPECT_EQ(wide.grey, Greys(100000, 9));
  png.width = 1;
  png.height = 100000;
  png.rows = std::vector<Bytes>(100000, Bytes{ 8 });
  EXPECT_EQ(readPicture(folder.write("tall.png", png.bytes())).lattice.size, (Size{ 1, 100000, 1 }));
}

TEST(Picture, TooLargeForTheDecoderOrTheMemory)
{
  const TemporaryFolder folder;
  PngFile png;
  png.width = 2000000;
  png.height = 1;
  png.rows = { { 1 } };
  png.rows = { Bytes(2000000, 1) };
  EXPECT_TRUE(contains(refused(folder.write("long.png", png.bytes())).first, "2000000 × 1 pixels"));
  // A small file that speaks of a large picture is refused before memory is taken for it.
  png.rows = { { 1 } };
  png.width = png.height = 1U << 20;
  EXPECT_TRUE(
    contains(refused(folder.write("large.png", png.bytes())).first, "cannot hold the 1048576 × 1048576 pixels"));
}

TEST(Picture, PixelSizeOfPng)
{
  const TemporaryFolder folder;
  PngFile png;
  png.rows = { { 1, 2 }, { 3, 4 } };
  const auto read = [&](const Bytes& physical, const ReadOptions& options = {})
  {
    png.chunks = { { "pHYs", physical } };
    return readPicture(folder.write("a.png", png.bytes()), options);
  };
  const Picture half = read(PngFile::physical(2000000, 2000000));
  EXPECT_DOUBLE_EQ(half.lattice.spacing, 0.5e-6);
  EXPECT_DOUBLE_EQ(half.lattice.origin[0], 0.25e-6);
  EXPECT_EQ(half.pixelSizeSource, "PNG pHYs");

  ReadOptions options;
  options.pixelSize = 3e-6;
  const Picture option = read(PngFile::physical(2000000, 2000000), options);
  EXPECT_EQ(option.lattice.spacing, 3e-6);
  EXPECT_EQ(option.pixelSizeSource, "option");

  for (const std::uint32_t dots : { 2835U, 3780U, 11811U }) // 72, 96, 300 dots an inch
  {
    const Picture printed = read(PngFile::physical(dots, dots));
    EXPECT_EQ(printed.pixelSizeSource, "none");
    EXPECT_EQ(printed.lattice.spacing, 1);
    ASSERT_EQ(printed.warnings.size(), 1U);
    EXPECT_TRUE(contains(printed.warnings[0], "printer")) << printed.warnings[0];
  }
  EXPECT_EQ(read(PngFile::physical(1, 1, false)).pixelSizeSource, "none");
  EXPECT_EQ(read(PngFile::physical(2, 1, false)).warnings.size(), 1U);

  png.chunks = { { "pHYs", PngFile::physical(1000000, 500000) } };
  const auto file = folder.write("a.png", png.bytes());
  EXPECT_TRUE(contains(refused(file).first, "not square"));
  EXPECT_EQ(readPicture(file, options).lattice.spacing, 3e-6); // the option says otherwise

  for (const double wrong : { 0.0, -1e-6, std::nan(""), HUGE_VAL })
  {
    options.pixelSize = wrong;
    EXPECT_THROW((void)readPicture(file, options), ParameterError);
  }
}

TEST(Picture, PixelSizeOfJpegAndItsWarning)
{
  const TemporaryFolder folder;
  Bytes bytes = jpeg(16, 8);
  // JFIF follows the start marker: unit at byte 13, densities at 14 and 16.
  ASSERT_EQ(bytes[6], 'J');
  bytes[13] = 2; // per centimetre
  bytes[14] = bytes[16] = 0x4e;
  bytes[15] = bytes[17] = 0x20; // 20000
  const Picture picture = readPicture(folder.write("a.jpg", bytes));
  EXPECT_DOUBLE_EQ(picture.lattice.spacing, 0.5e-6);
  EXPECT_EQ(picture.pixelSizeSource, "JFIF density");
  EXPECT_EQ(picture.lattice.size, (Size{ 16, 8, 1 }));
  ASSERT_EQ(picture.warnings.size(), 1U);
  EXPECT_TRUE(contains(picture.warnings[0], "blurs greys"));
}

TEST(Picture, PixelSizeAndTurnOfExif)
{
  const TemporaryFolder folder;
  Bytes block{ 'E', 'x', 'i', 'f', 0, 0 };
  TiffFile exif;
  exif.pages = { { { 274, { 3, { 6 }, {} } }, { 282, { 5, { 25400, 1 }, {} } }, { 283, { 5, { 25400, 1 }, {} } },
    { 296, { 3, { 2 }, {} } } } };
  const Bytes directory = exif.bytes();
  block.insert(block.end(), directory.begin(), directory.end());
  Bytes segment{ 0xff, 0xe1 };
  lamella::testing::put(segment, block.size() + 2, 2, true);
  segment.insert(segment.end(), block.begin(), block.end());
  Bytes bytes = jpeg(16, 8);
  bytes.insert(bytes.begin() + 2, segment.begin(), segment.end());
  const Picture picture = readPicture(folder.write("a.jpg", bytes));
  EXPECT_NEAR(picture.lattice.spacing, 1e-6, 1e-15);
  EXPECT_EQ(picture.pixelSizeSource, "Exif resolution");
  EXPECT_EQ(picture.lattice.size, (Size{ 16, 8, 1 })); // as it is stored
  EXPECT_TRUE(contains(picture.warnings.at(0), "orientation 6"));
}

TEST(Picture, TiffOfBothByteOrdersWithResolution)
{
  const TemporaryFolder folder;
  for (const bool bigEndian : { false, true })
  {
    TiffFile tiff;
    tiff.bigEndian = bigEndian;
    tiff.pages = { { { 282, { 5, { 20000, 1 }, {} } }, { 283, { 5, { 20000, 1 }, {} } }, { 296, { 3, { 3 }, {} } } } };
    const Picture picture = readPicture(folder.write("a.tif", tiff.bytes()));
    EXPECT_EQ(picture.grey, (Greys{ 40, 50, 60, 10, 20, 30 }));
    EXPECT_DOUBLE_EQ(picture.lattice.spacing, 0.5e-6);
    EXPECT_EQ(picture.pixelSizeSource, "TIFF resolution");
    tiff.pages[0][296] = { 3, { 1 }, {} }; // no unit
    EXPECT_EQ(readPicture(folder.write("a.tif", tiff.bytes())).pixelSizeSource, "none");
    tiff.pages[0][296] = { 3, { 2 }, {} };
    tiff.pages[0][282] = tiff.pages[0][283] = { 5, { 72, 1 }, {} };
    const Picture printed = readPicture(folder.write("a.tif", tiff.bytes()));
    EXPECT_EQ(printed.pixelSizeSource, "none");
    EXPECT_TRUE(contains(printed.warnings.at(0), "72 dots an inch"));
  }
}

TEST(Picture, TiffOfImageJAndOme)
{
  const TemporaryFolder folder;
  TiffFile tiff;
  tiff.pages = { { { 270, { 2, {}, "ImageJ=1.54f\nunit=\\u00B5m\nspacing=0.5\n" } }, { 282, { 5, { 2, 1 }, {} } },
                   { 283, { 5, { 2, 1 }, {} } }, { 296, { 3, { 1 }, {} } } },
    {} };
  const Picture picture = readPicture(folder.write("a.tif", tiff.bytes()));
  EXPECT_EQ(picture.lattice.dimension, 3);
  EXPECT_DOUBLE_EQ(picture.lattice.spacing, 0.5e-6);
  EXPECT_EQ(picture.pixelSizeSource, "ImageJ");
  tiff.pages[0][270].text = "ImageJ=1.54f\nunit=micron\nspacing=2.0\n";
  const auto file = folder.write("a.tif", tiff.bytes());
  EXPECT_DOUBLE_EQ(readPicture(file).lattice.spacingAlong(0), 0.5e-6);
  EXPECT_DOUBLE_EQ(readPicture(file).lattice.spacingAlong(2), 2e-6);
  EXPECT_DOUBLE_EQ(readPicture(file).lattice.origin[2], 1e-6);
  ReadOptions options;
  options.sliceDistance = 1.5e-6;
  EXPECT_DOUBLE_EQ(readPicture(file, options).lattice.spacingAlong(2), 1.5e-6);
  options.sliceDistance.reset();
  options.pixelSize = 1e-6;
  EXPECT_EQ(readPicture(file, options).lattice.spacing, 1e-6);
  EXPECT_TRUE(readPicture(file, options).lattice.cubes());

  tiff.pages = {
    { { 270, { 2, {}, "<OME xmlns=\"x\"><Pixels PhysicalSizeX=\"0.65\" PhysicalSizeY=\"0.65\"/></OME>" } } }
  };
  const Picture ome = readPicture(folder.write("b.tif", tiff.bytes()));
  EXPECT_DOUBLE_EQ(ome.lattice.spacing, 0.65e-6);
  EXPECT_EQ(ome.pixelSizeSource, "OME-XML");
}

TEST(Picture, TiffPagesAreAVolumeInTheOrderOfTheFile)
{
  const TemporaryFolder folder;
  TiffFile tiff;
  tiff.pages = { {}, { { 254, { 4, { 1 }, {} } }, { 256, { 4, { 1 }, {} } } }, {} }; // the second is a reduced copy
  const Picture picture = readPicture(folder.write("a.tif", tiff.bytes()));
  EXPECT_EQ(picture.lattice.size, (Size{ 3, 2, 2 }));
  EXPECT_EQ(picture.grey, (Greys{ 10, 20, 30, 40, 50, 60, 10, 20, 30, 40, 50, 60 })); // not flipped

  tiff.pages[1] = { { 256, { 4, { 2 }, {} } } };
  EXPECT_TRUE(contains(refused(folder.write("b.tif", tiff.bytes())).first, "page 2"));
}

TEST(Picture, TiffThatCannotBecomeGreys)
{
  const TemporaryFolder folder;
  const auto with = [&](int tag, std::uint64_t value)
  {
    TiffFile tiff;
    tiff.pages[0][tag] = { 3, { value }, {} };
    return refused(folder.write("a.tif", tiff.bytes()));
  };
  EXPECT_TRUE(contains(with(262, 5).first, "CMYK"));
  EXPECT_TRUE(contains(with(339, 3).first, "floating-point"));
  EXPECT_TRUE(contains(with(339, 2).first, "signed"));
  EXPECT_TRUE(contains(with(258, 32).first, "32 bits"));
  EXPECT_TRUE(contains(with(256, 0).first, "cannot be decoded"));
}

TEST(Picture, CmykJpeg)
{
  const TemporaryFolder folder;
  const Bytes bytes{ 0xff, 0xd8, 0xff, 0xc0, 0, 20, 8, 0, 2, 0, 2, 4, 1, 0x11, 0, 2, 0x11, 0, 3, 0x11, 0, 4, 0x11, 0,
    0xff, 0xda, 0, 2, 0xff, 0xd9 };
  const auto [what, hint] = refused(folder.write("a.jpg", bytes));
  EXPECT_TRUE(contains(what, "CMYK"));
  EXPECT_TRUE(contains(hint, "convert"));
}

TEST(Picture, ShortStripsOfATiff)
{
  const TemporaryFolder folder;
  TiffFile tiff;
  tiff.pages[0][279] = { 4, { 5 }, {} };
  EXPECT_TRUE(contains(refused(folder.write("a.tif", tiff.bytes())).first, "page 1: Bogus"));
}

TEST(Picture, DamagedJpegIsNoticedInTheMiddle)
{
  const TemporaryFolder folder;
  Bytes bytes = jpeg(64, 64);
  std::fill(bytes.end() - 120, bytes.end() - 60, std::uint8_t{ 0xaa });
  EXPECT_TRUE(contains(refused(folder.write("a.jpg", bytes)).first, "cannot be decoded"));
}

TEST(Picture, EveryTruncationIsNoticed)
{
  const TemporaryFolder folder;
  PngFile png;
  png.rows = { { 1, 2 }, { 3, 4 } };
  TiffFile tiff;
  tiff.pages = { {}, {} };
  for (const auto& [name, whole] : { std::pair<std::string, Bytes>{ "a.png", png.bytes() }, { "a.tif", tiff.bytes() },
         { "a.jpg", jpeg(16, 8) }, { "rgb.jpg", jpeg(16, 8, 3) } })
  {
    // An exception takes milliseconds with as many libraries as these, so not at every byte of the longer files.
    const std::size_t step = whole.size() > 250 ? 7 : 1;
    for (std::size_t size = 0; size < whole.size(); size += step)
    {
      const Bytes part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
      const auto file = folder.write(name, part);
      EXPECT_THROW((void)readPicture(file), InputError) << name << ": " << size << " of " << whole.size() << " bytes";
    }
  }
  const Bytes whole = png.bytes();
  EXPECT_TRUE(contains(refused(folder.write("a.png", { whole.begin(), whole.end() - 1 })).first, "truncated"));
}

TEST(Picture, ChangedBytesOfAPngAreNoticed)
{
  const TemporaryFolder folder;
  PngFile png;
  png.rows = { { 1, 2 }, { 3, 4 } };
  const Bytes whole = png.bytes();
  for (std::size_t at = 0; at < whole.size(); ++at)
  {
    Bytes bytes = whole;
    bytes[at] ^= 0x10;
    const auto file = folder.write("a.png", bytes);
    EXPECT_THROW((void)readPicture(file), InputError) << "byte " << at;
  }
}

TEST(Picture, PngWithTooFewRows)
{
  const TemporaryFolder folder;
  PngFile png;
  png.height = 3;
  png.rows = { { 1, 2 }, { 3, 4 } };
  const std::string what = refused(folder.write("a.png", png.bytes())).first;
  EXPECT_TRUE(contains(what, "cannot be decoded") && contains(what, "Not enough image data")) << what;
  png.height = 2;
  png.bits = 3;
  EXPECT_TRUE(contains(refused(folder.write("b.png", png.bytes())).first, "Invalid IHDR data"));
}

TEST(Picture, DamagedTextOfAPngIsLeftOutWithAWarning)
{
  const TemporaryFolder folder;
  PngFile png;
  png.rows = { { 1, 2 }, { 3, 4 } };
  const std::string text = std::string("Description") + '\0' + "seed 1";
  png.chunks = { { "tEXt", { text.begin(), text.end() } } };
  Bytes bytes = png.bytes();
  EXPECT_EQ(readPicture(folder.write("a.png", bytes)).description, "seed 1");
  *std::find(bytes.begin(), bytes.end(), '1') = '2';
  const Picture picture = readPicture(folder.write("b.png", bytes));
  EXPECT_EQ(picture.grey, (Greys{ 3, 4, 1, 2 }));
  EXPECT_EQ(picture.description, "");
  ASSERT_EQ(picture.warnings.size(), 1U);
  EXPECT_TRUE(contains(picture.warnings[0], "the checksum of its tEXt chunk is wrong; left out"));
}

TEST(Picture, DamageOfAnyKindIsAnErrorOfOurs)
{
  // Random bytes of good files changed: read or refused, never a crash, a hang or another exception.
  const TemporaryFolder folder;
  PngFile png;
  png.width = 3;
  png.rows = { { 1, 2, 3 }, { 3, 4, 5 } };
  TiffFile tiff;
  tiff.pages = { { { 270, { 2, {}, "ImageJ=1\nunit=um\n" } }, { 282, { 5, { 2, 1 }, {} } } }, {} };
  std::mt19937 random(1);
  for (const auto& [name, whole] :
    { std::pair<std::string, Bytes>{ "a.png", png.bytes() }, { "a.tif", tiff.bytes() }, { "a.jpg", jpeg(16, 8) } })
  {
    for (int trial = 0; trial < 150; ++trial)
    {
      Bytes bytes = whole;
      for (int change = 0; change < 1 + trial % 4; ++change)
        bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
      const auto file = folder.write(name, bytes);
      try
      {
        (void)readPicture(file);
      }
      catch (const Error&)
      {
      }
    }
  }
}

TEST(Picture, FilesThatAreNoPictures)
{
  const TemporaryFolder folder;
  EXPECT_TRUE(contains(refused(folder / "nothing.png").first, "there is no file"));
  EXPECT_TRUE(contains(refused(folder.write("empty.png", {})).first, "is empty (0 bytes)"));
  const std::string text = "This is no picture at all.";
  EXPECT_TRUE(contains(refused(folder.write("text.png", { text.begin(), text.end() })).first,
    "is not a PNG, JPEG, TIFF, PGM, PPM or BMP picture"));
  EXPECT_TRUE(contains(refused(folder.write("a.raw.gz", { 0x1f, 0x8b, 8, 0 })).second, "gunzip"));
  std::filesystem::create_directory(folder / "folder");
  EXPECT_TRUE(contains(refused(folder / "folder").first, "holds no PNG, JPEG, TIFF, PGM, PPM or BMP"));
  EXPECT_TRUE(contains(refused("/dev/null").first, "not a regular file"));
}

TEST(Picture, FileThatMayNotBeRead)
{
  if (::geteuid() == 0)
    GTEST_SKIP() << "root may read every file";
  const TemporaryFolder folder;
  const auto file = folder.write("a.png", { 1 });
  std::filesystem::permissions(file, std::filesystem::perms::none);
  EXPECT_TRUE(contains(refused(file).first, "cannot be opened: Permission denied"));
}

TEST(Slices, AreSortedByNumber)
{
  const TemporaryFolder folder;
  PngFile png;
  png.width = 1;
  png.height = 2;
  for (const std::uint8_t number : { 10, 9, 2, 1 })
  {
    png.rows = { { number }, { static_cast<std::uint8_t>(100 + number) } };
    folder.write(fmt::format("tissue2_{}.png", number), png.bytes());
  }
  folder.write("notes.txt", { 'x' });
  const Greys expected{ 1, 101, 2, 102, 9, 109, 10, 110 };
  const Picture all = readPicture(folder.path());
  EXPECT_EQ(all.grey, expected);
  EXPECT_EQ(all.lattice.size, (Size{ 1, 2, 4 }));
  ASSERT_EQ(all.warnings.size(), 1U);
  EXPECT_TRUE(contains(all.warnings[0], "6 of the slices 1 to 10 are missing, the first is 3")) << all.warnings[0];
  EXPECT_EQ(readPicture(folder / "tissue2_*.png").grey, expected);
  EXPECT_EQ(readPicture(folder / "tissue2_?.png").lattice.size[2], 3);
  EXPECT_TRUE(contains(refused(folder / "tissue2_%d.png").first, "6 of the slices 1 to 10 are missing"));
  EXPECT_TRUE(contains(refused(folder / "other_%d.png").first, "no file is called"));
  EXPECT_TRUE(contains(refused(folder / "a%d_%d.png").first, "more than one number"));

  // Padded numbers.
  for (int number = 3; number <= 8; ++number)
    folder.write(fmt::format("tissue2_{}.png", number), png.bytes());
  EXPECT_EQ(readPicture(folder / "tissue2_%d.png").lattice.size[2], 10);
  EXPECT_TRUE(contains(refused(folder / "tissue2_%04d.png").first, "no file is called"));
  folder.write("tissue2_02.png", png.bytes());
  EXPECT_TRUE(contains(refused(folder.path()).first, "the same number"));
  EXPECT_TRUE(contains(refused(folder / "tissue2_%02d.png").first, "7 of the slices 2 to 10")); // 02 and 10
}

TEST(Slices, MustBelongTogether)
{
  const TemporaryFolder folder;
  PngFile png;
  png.rows = { { 1, 2 }, { 3, 4 } };
  folder.write("a_1.png", png.bytes());
  folder.write("b_2.png", png.bytes());
  EXPECT_TRUE(contains(refused(folder.path()).first, "two series"));
  EXPECT_EQ(readPicture(folder / "a_*.png").lattice.size, (Size{ 2, 2, 1 }));
  png.rows = { { 1, 2 } };
  png.height = 1;
  folder.write("a_2.png", png.bytes());
  EXPECT_TRUE(contains(refused(folder / "a_*.png").first, "2 × 1 pixels of 8 bits, the first slice is 2 × 2"));
  png.colourType = 2;
  png.rows = { { 1, 2, 3, 4, 5, 6 } };
  folder.write("c_1.png", png.bytes());
  EXPECT_TRUE(contains(refused(folder / "c_%d.png").first, "colour"));
  folder.write("odd.png", png.bytes());
  EXPECT_TRUE(contains(refused(folder / "o*.png").first, "no number"));
}

TEST(Raw, SizeAndDepthComeFromNameOptionOrFile)
{
  const TemporaryFolder folder;
  const Bytes bytes{ 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12 };
  const Picture named = readPicture(folder.write("rock_2x3x2_u8.raw", bytes));
  EXPECT_EQ(named.lattice.size, (Size{ 2, 3, 2 }));
  EXPECT_EQ(named.lattice.dimension, 3);
  EXPECT_EQ(named.grey, (Greys{ 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12 }));

  const Picture deep = readPicture(folder.write("rock_1x3x2_u16.raw", bytes));
  EXPECT_EQ(deep.bits, 16);
  EXPECT_EQ(deep.grey, (Greys{ 0x0201, 0x0403, 0x0605, 0x0807, 0x0a09, 0x0c0b }));
  EXPECT_EQ(readPicture(folder.write("rock_1x3x2.raw", bytes)).bits, 16); // the file's size says so

  ReadOptions options;
  options.rawSize = { 5, 1, 1 };
  options.rawHeader = 2;
  options.rawBigEndian = true;
  options.pixelSize = 2e-6;
  const Picture big = readPicture(folder.write("rock.dat", bytes), options);
  EXPECT_EQ(big.grey, (Greys{ 0x0304, 0x0506, 0x0708, 0x090a, 0x0b0c }));
  EXPECT_EQ(big.lattice.spacing, 2e-6);
}

TEST(Raw, RefusesSizesThatDoNotFit)
{
  const TemporaryFolder folder;
  const Bytes bytes(12, 1);
  EXPECT_TRUE(contains(refused(folder.write("rock.raw", bytes)).second, "raw size"));
  EXPECT_TRUE(
    contains(refused(folder.write("rock_2x3x3.raw", bytes)).first, "has 12 bytes, but 2 × 3 × 3 voxels of u8 take 18"));
  EXPECT_TRUE(contains(refused(folder.write("rock_2x3x2_u16.raw", bytes)).first, "u16 take 24"));
  ReadOptions options;
  options.rawSize = { 2, 3, 0 };
  EXPECT_THROW((void)readPicture(folder / "rock.raw", options), ParameterError);
  options.rawSize = { 2, 3, 2 };
  options.rawBits = 12;
  EXPECT_THROW((void)readPicture(folder / "rock.raw", options), ParameterError);
  options.rawBits = 8;
  options.rawHeader = 100;
  EXPECT_THROW((void)readPicture(folder / "rock.raw", options), InputError);
}

TEST(Windows, AreTheSameHoweverMuchOfTheFileIsRead)
{
  // Voxel x, y, z of 7 × 5 × 4 holds its own index, as a raw file of 8 and of 16 bits, as slices and as one picture.
  const TemporaryFolder folder;
  constexpr std::uint8_t nx = 7;
  constexpr std::uint8_t ny = 5;
  constexpr std::uint8_t nz = 4;
  Bytes small;
  Bytes deep;
  for (std::uint8_t z = 0; z < nz; ++z)
  {
    PngFile png;
    png.width = nx;
    png.height = ny;
    for (std::uint8_t y = 0; y < ny; ++y)
    {
      png.rows.emplace_back();
      for (std::uint8_t x = 0; x < nx; ++x)
      {
        const auto value = static_cast<std::uint8_t>(x + nx * (y + ny * z));
        small.push_back(value);
        deep.insert(deep.end(), { value, 1 });
        png.rows.back().push_back(value);
      }
    }
    folder.write(fmt::format("slice_{}.png", z), png.bytes());
  }
  const auto raw = folder.write("rock_7x5x4_u8.raw", small);
  const auto raw16 = folder.write("rock_7x5x4_u16.raw", deep);
  const Picture all = readPicture(raw);
  for (const Window& window : { Window{ { 2, 1, 1 }, { 3, 2, 2 } }, Window{ { 0, 2, 1 }, { 7, 3, 2 } },
         Window{ { 0, 0, 2 }, { 7, 5, 1 } }, Window{ { 0, 0, 0 }, { 7, 5, 4 } }, Window{ { 6, 4, 3 }, { 1, 1, 1 } } })
  {
    Greys expected;
    for (std::int64_t z = 0; z < window.size[2]; ++z)
    {
      for (std::int64_t y = 0; y < window.size[1]; ++y)
      {
        for (std::int64_t x = 0; x < window.size[0]; ++x)
        {
          const auto at = all.lattice.index(window.start[0] + x, window.start[1] + y, window.start[2] + z);
          expected.push_back(all.grey[static_cast<std::size_t>(at)]);
        }
      }
    }
    Size told{};
    ReadOptions options;
    options.window = window;
    options.sizeKnown = [&](const Lattice& whole) { told = whole.size; };
    for (const auto& file : { raw, folder / "slice_%d.png" })
    {
      const Picture part = readPicture(file, options);
      EXPECT_EQ(part.grey, expected) << file;
      EXPECT_EQ(part.lattice.size, window.size);
      EXPECT_EQ(part.fileSize, all.lattice.size);
      EXPECT_EQ(told, all.lattice.size);
    }
    std::transform(expected.begin(), expected.end(), expected.begin(), [](std::uint16_t v) { return v + 256; });
    EXPECT_EQ(readPicture(raw16, options).grey, expected);
  }
  ReadOptions options;
  options.window = Window{ { 2, 1, 0 }, { 3, 2, 0 } }; // from the top left
  EXPECT_EQ(readPicture(folder / "slice_0.png", options).grey, (Greys{ 16, 17, 18, 9, 10, 11 }));
  options.window->size[0] = 6;
  EXPECT_THROW((void)readPicture(folder / "slice_0.png", options), ParameterError);
  EXPECT_THROW((void)readPicture(raw, options), ParameterError);
}

TEST(Windows, OfAVolumeThatNoMemoryHoldsAreRead)
{
  const TemporaryFolder folder;
  const auto file = folder.write("rock_20000x20000x10000_u8.raw", { 1 });
  std::error_code failed;
  std::filesystem::resize_file(file, 4'000'000'000'000, failed); // without taking space
  if (failed)
    GTEST_SKIP() << "no sparse files here: " << failed.message();
  EXPECT_THROW((void)readPicture(file), MemoryError);
  ReadOptions options;
  options.window = Window{ { 0, 0, 0 }, { 2, 2, 2 } };
  EXPECT_EQ(readPicture(file, options).grey, (Greys{ 1, 0, 0, 0, 0, 0, 0, 0 }));
  options.window->start = { 19998, 19998, 9998 };
  EXPECT_EQ(readPicture(file, options).grey, Greys(8, 0));
  options.sizeKnown = [](const Lattice&) { throw InputError("not this one", "another"); };
  EXPECT_THROW((void)readPicture(file, options), InputError);

  const io::InputFile described = io::describeInput(file); // 4 TB are not read for a hash
  EXPECT_TRUE(described.ends);
  EXPECT_EQ(described.bytes, 4'000'000'000'000U);
  io::Sha256 hash;
  std::vector<std::byte> ends(2 * io::hashedEnd);
  ends[0] = std::byte{ 1 };
  hash.update(ends);
  EXPECT_EQ(described.sha256, hash.finish());
  io::Provenance record;
  record.inputs = { described };
  const io::Provenance again = io::provenanceFromJson(io::toJson(record));
  EXPECT_EQ(again.inputs.at(0).sha256, described.sha256);
  EXPECT_TRUE(again.inputs.at(0).ends);
}

TEST(RealPictures, HaveTheSolidFractionsOfTheirSource)
{
  const char* const data = std::getenv("LAMELLA_REAL_DATA");
  if (data == nullptr)
    GTEST_SKIP() << "LAMELLA_REAL_DATA is not set";
  GreyMap map;
  map.phaseOfGrey = { { 0, "lumen" }, { 128, "wall" }, { 255, "wall" } };
  for (const auto& [name, solid, size] : { std::tuple{ "spruce_EW_labels_0.5um.png", 0.1997, Size{ 760, 780, 1 } },
         std::tuple{ "spruce_LW_labels_0.5um.png", 0.6094, Size{ 752, 446, 1 } } })
  {
    const Picture picture = readPicture(std::filesystem::path(data) / name);
    EXPECT_EQ(picture.lattice.size, size);
    EXPECT_NEAR(map.apply(picture.lattice, picture.grey).fractions()[1], solid, 5e-5); // four digits are given
  }
}
