// Kinds of files that no library reads for us, and the arrangements of TIFF.
#include "PictureFiles.h"
#include "Support.h"

#include "io/Provenance.h"
#include "pictures/JpegFile.h"
#include "pictures/Picture.h"
#include "pictures/PngFile.h"
#include "pictures/RawVolume.h"
#include "pictures/TiffFile.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <tuple>

using namespace lamella;
using namespace lamella::micrograph;
using lamella::testing::Bytes;
using lamella::testing::put;
using lamella::testing::refusal;
using lamella::testing::TemporaryFolder;

namespace
{

using Greys = std::vector<std::uint16_t>;
using Size = std::array<std::int64_t, 3>;

Bytes bytesOf(const std::string& text, const Bytes& values = {})
{
  Bytes bytes(text.begin(), text.end());
  bytes.insert(bytes.end(), values.begin(), values.end());
  return bytes;
}

/// What is wrong with a file; one line, with a remedy.
std::string refused(const std::filesystem::path& path, const ReadOptions& options = {})
{
  const auto [what, hint] = refusal<Error>([&] { (void)readPicture(path, options); });
  EXPECT_FALSE(what.empty()) << path << " was read";
  EXPECT_FALSE(hint.empty()) << path;
  EXPECT_EQ((what + hint).find('\n'), std::string::npos);
  return what;
}

bool contains(const std::string& text, const std::string& part)
{
  return text.find(part) != std::string::npos;
}

/// A BMP of Windows 3; rows as they stand in the file, padded here.
struct BmpFile
{
  std::int32_t width = 2;
  std::int32_t height = 2;
  int bits = 24;
  std::uint32_t packing = 0;
  std::int32_t perMetre = 0;
  Bytes palette;
  std::vector<Bytes> rows;

  [[nodiscard]] Bytes bytes() const
  {
    Bytes file{ 'B', 'M' };
    put(file, 0, 8, false); // nobody looks at the file's size
    put(file, 54 + palette.size(), 4, false);
    put(file, 40, 4, false);
    put(file, static_cast<std::uint32_t>(width), 4, false);
    put(file, static_cast<std::uint32_t>(height), 4, false);
    put(file, 1, 2, false);
    put(file, static_cast<std::uint64_t>(bits), 2, false);
    put(file, packing, 4, false);
    put(file, 0, 4, false);
    put(file, static_cast<std::uint32_t>(perMetre), 4, false);
    put(file, static_cast<std::uint32_t>(perMetre), 4, false);
    put(file, palette.size() / 4, 4, false);
    put(file, 0, 4, false);
    file.insert(file.end(), palette.begin(), palette.end());
    for (Bytes row : rows)
    {
      row.resize((row.size() + 3) / 4 * 4);
      file.insert(file.end(), row.begin(), row.end());
    }
    return file;
  }
};

} // namespace

TEST(Netpbm, GreysAndColoursAsBytesAndAsText)
{
  const TemporaryFolder folder;
  const Picture small =
    readPicture(folder.write("a.pgm", bytesOf("P5\n# a comment\n3 2\n255\n", { 1, 2, 3, 4, 5, 6 })));
  EXPECT_EQ(small.grey, (Greys{ 4, 5, 6, 1, 2, 3 }));
  EXPECT_EQ(small.format, "PGM");
  EXPECT_EQ(small.bits, 8);
  EXPECT_EQ(small.lattice.dimension, 2);
  EXPECT_EQ(small.pixelSizeSource, "none");
  EXPECT_TRUE(small.warnings.empty());

  const Picture deep = readPicture(folder.write("b.pgm", bytesOf("P5 2 1 65535\n", { 1, 2, 0xff, 0xfe })));
  EXPECT_EQ(deep.grey, (Greys{ 0x0102, 0xfffe }));
  EXPECT_EQ(deep.bits, 16);
  // A largest value is no white: labels stay what they are.
  EXPECT_EQ(readPicture(folder.write("c.pgm", bytesOf("P2\n2 2\n3\n0 1\n2 3\n"))).grey, (Greys{ 2, 3, 0, 1 }));
  EXPECT_EQ(readPicture(folder.write("d.pgm", bytesOf("P2 2 1 1000 # of ten bits\n7\n1000"))).grey, (Greys{ 7, 1000 }));

  const Picture more = readPicture(folder.write("e.pgm", bytesOf("P5 2 1 255\n", { 1, 2, 3 })));
  EXPECT_EQ(more.grey, (Greys{ 1, 2 }));
  ASSERT_EQ(more.warnings.size(), 1U);
  EXPECT_TRUE(contains(more.warnings[0], "has 1 bytes behind its 2 × 1 pixels"));
  EXPECT_EQ(readPicture(folder.write("f.pgm", bytesOf("P2 2 1 255\n1 2 3"))).warnings.size(), 1U);

  EXPECT_EQ(readPicture(folder.write("a.ppm", bytesOf("P6 2 1 255\n", { 7, 7, 7, 9, 9, 9 }))).grey, (Greys{ 7, 9 }));
  const auto coloured = folder.write("b.ppm", bytesOf("P3 2 1 255 200 30 90 1 1 1"));
  EXPECT_TRUE(contains(refused(coloured), "is red 200, green 30, blue 90"));
  ReadOptions options;
  options.keepColour = true;
  const Picture picture = readPicture(coloured, options);
  EXPECT_EQ(picture.colour, (Greys{ 200, 30, 90, 1, 1, 1 }));
  EXPECT_EQ(picture.grey, (Greys{ 88, 1 })); // 0.299 · 200 + 0.587 · 30 + 0.114 · 90 = 87.7
  EXPECT_EQ(picture.format, "PPM");
}

TEST(Netpbm, Refuses)
{
  const TemporaryFolder folder;
  const auto with = [&](const std::string& text) { return refused(folder.write("a.pgm", bytesOf(text))); };
  EXPECT_TRUE(contains(with("P5 3 2 255\n12345"), "5 bytes behind its header cannot hold 3 × 2 pixels"));
  EXPECT_TRUE(contains(with("P5 1000000 1000000 255\n1"), "cannot hold 1000000 × 1000000 pixels"));
  EXPECT_TRUE(contains(with("P2 2 1 255\n1"), "cannot hold"));
  EXPECT_TRUE(contains(with("P2 2 1 255\n12  "), "a number is missing"));
  EXPECT_TRUE(contains(with("P2 2 1 3\n1 4"), "it holds 4, and its largest value is 3"));
  EXPECT_TRUE(contains(with("P2 2 1 255\n1 -4"), "no whole number at byte"));
  EXPECT_TRUE(contains(with("P5 0 1 255\n"), "holds no pixels"));
  EXPECT_TRUE(contains(with("P5 1 1 70000\n1"), "its largest value is 70000"));
  EXPECT_TRUE(contains(with("P5 99999999999999999999 1 255\n1"), "no whole number"));
  EXPECT_TRUE(contains(with("P5 1"), "a number is missing"));
  EXPECT_TRUE(contains(with("P4 8 1\nx"), "is a bitmap (P4)"));
}

TEST(Bmp, ColoursPalettesAndDirections)
{
  const TemporaryFolder folder;
  BmpFile bmp;
  bmp.perMetre = 2000000;
  bmp.rows = { { 1, 1, 1, 2, 2, 2 }, { 7, 7, 7, 90, 30, 200 } }; // the lowest first; blue, green, red
  ReadOptions options;
  options.keepColour = true;
  const Picture picture = readPicture(folder.write("a.bmp", bmp.bytes()), options);
  EXPECT_EQ(picture.grey, (Greys{ 1, 2, 7, 88 }));
  EXPECT_EQ(picture.colour, (Greys{ 1, 1, 1, 2, 2, 2, 7, 7, 7, 200, 30, 90 }));
  EXPECT_EQ(picture.format, "BMP");
  EXPECT_DOUBLE_EQ(picture.lattice.spacing, 0.5e-6);
  EXPECT_EQ(picture.pixelSizeSource, "BMP resolution");

  bmp = {};
  bmp.height = -2;
  bmp.rows = { { 1, 1, 1, 2, 2, 2 }, { 7, 7, 7, 9, 9, 9 } }; // the highest first
  EXPECT_EQ(readPicture(folder.write("b.bmp", bmp.bytes())).grey, (Greys{ 7, 9, 1, 2 }));

  bmp = {};
  bmp.bits = 8;
  bmp.width = 3;
  bmp.palette = { 0, 0, 0, 0, 128, 128, 128, 0, 255, 255, 255, 0 };
  bmp.rows = { { 0, 1, 2 }, { 2, 1, 1 } };
  EXPECT_EQ(readPicture(folder.write("c.bmp", bmp.bytes())).grey, (Greys{ 0, 128, 255, 255, 128, 128 }));
  bmp.rows[1][2] = 3;
  EXPECT_TRUE(contains(refused(folder.write("d.bmp", bmp.bytes())), "a pixel has colour 3, and there are 3"));

  bmp = {};
  bmp.bits = 32;
  bmp.rows = { { 1, 1, 1, 0, 2, 2, 2, 0 }, { 7, 7, 7, 0, 9, 9, 9, 0 } }; // the fourth byte means nothing
  const Picture wide = readPicture(folder.write("e.bmp", bmp.bytes()));
  EXPECT_EQ(wide.grey, (Greys{ 1, 2, 7, 9 }));
  EXPECT_TRUE(wide.warnings.empty());
}

TEST(Bmp, Refuses)
{
  const TemporaryFolder folder;
  BmpFile good;
  good.rows = { { 1, 1, 1, 2, 2, 2 }, { 7, 7, 7, 9, 9, 9 } };
  const auto with = [&](const std::function<void(BmpFile&)>& change)
  {
    BmpFile bmp = good;
    change(bmp);
    return refused(folder.write("a.bmp", bmp.bytes()));
  };
  EXPECT_TRUE(contains(with([](BmpFile& b) { b.width = 3; }), "take 24 bytes"));
  EXPECT_TRUE(contains(with([](BmpFile& b) { b.height = 2000000000; }), "is truncated"));
  EXPECT_TRUE(contains(with([](BmpFile& b) { b.height = std::numeric_limits<std::int32_t>::min(); }), "is truncated"));
  EXPECT_TRUE(contains(with([](BmpFile& b) { b.width = -2; }), "holds no pixels"));
  EXPECT_TRUE(contains(with([](BmpFile& b) { b.packing = 1; }), "is packed (kind 1)"));
  EXPECT_TRUE(contains(with([](BmpFile& b) { b.bits = 4; }), "of 4 bits a pixel"));
  const Bytes whole = good.bytes();
  for (std::size_t size = 3; size < whole.size(); ++size)
  {
    const auto file = folder.write("b.bmp", { whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size) });
    EXPECT_THROW((void)readPicture(file), InputError) << size << " of " << whole.size() << " bytes";
  }
}

TEST(Headers, NrrdAndMetaImageAreVolumes)
{
  const TemporaryFolder folder;
  const Bytes values{ 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12 };
  const std::string head = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 3 2\nencoding: raw\n"
                           "space dimension: 3\nspace directions: (0.5,0,0) (0,0.5,0) (0,0,0.5)\n"
                           "space units: \"um\" \"um\" \"um\"\n\n";
  const Picture nrrd = readPicture(folder.write("a.nrrd", bytesOf(head, values)));
  EXPECT_EQ(nrrd.lattice.size, (Size{ 2, 3, 2 }));
  EXPECT_EQ(nrrd.grey, (Greys{ 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12 }));
  EXPECT_DOUBLE_EQ(nrrd.lattice.spacing, 0.5e-6);
  EXPECT_EQ(nrrd.pixelSizeSource, "NRRD space directions");
  EXPECT_EQ(nrrd.format, "NRRD");
  EXPECT_EQ(nrrd.bits, 8);
  // By its first bytes, whatever its name.
  EXPECT_EQ(readPicture(folder.write("a.volume", bytesOf(head, values))).grey, nrrd.grey);
  ReadOptions options;
  options.window = Window{ { 1, 1, 1 }, { 1, 2, 1 } };
  EXPECT_EQ(readPicture(folder / "a.nrrd", options).grey, (Greys{ 10, 12 }));

  folder.write("v.raw", { 0x01, 0x02, 0x03, 0x04 });
  const std::string meta = "ObjectType = Image\nNDims = 2\nBinaryDataByteOrderMSB = True\nElementSpacing = 1e-6 1e-6\n"
                           "DimSize = 2 1\nElementType = MET_USHORT\nElementDataFile = v.raw\n";
  const Picture flat = readPicture(folder.write("v.mhd", bytesOf(meta)));
  EXPECT_EQ(flat.grey, (Greys{ 0x0102, 0x0304 }));
  EXPECT_EQ(flat.lattice.dimension, 2);
  EXPECT_EQ(flat.lattice.spacing, 1e-6);
  EXPECT_EQ(flat.bits, 16);
  EXPECT_EQ(flat.format, "MetaImage");

  // Packed by zlib, as MetaImage does it.
  Bytes packed(compressBound(12));
  uLongf size = packed.size();
  ASSERT_EQ(compress(packed.data(), &size, values.data(), values.size()), Z_OK);
  packed.resize(size);
  const std::string zipped = "ObjectType = Image\nNDims = 3\nCompressedData = True\nDimSize = 2 3 2\n"
                             "ElementType = MET_UCHAR\nElementDataFile = LOCAL\n";
  const auto file = folder.write("z.mha", bytesOf(zipped, packed));
  EXPECT_EQ(readPicture(file).grey, nrrd.grey);
  EXPECT_EQ(readPicture(file).pixelSizeSource, "none");
  EXPECT_EQ(readPicture(file, options).grey, (Greys{ 10, 12 }));
}

TEST(Headers, OtherTypesHaveToHoldGreys)
{
  const TemporaryFolder folder;
  const std::string head = "NRRD0004\ntype: TYPE\ndimension: 3\nsizes: 2 1 1\nencoding: raw\nendian: little\n\n";
  const auto with = [&](const std::string& type, const auto& numbers)
  {
    const auto* const from = reinterpret_cast<const std::uint8_t*>(numbers.data());
    std::string text = head;
    text.replace(text.find("TYPE"), 4, type);
    return folder.write("a.nrrd", bytesOf(text, Bytes(from, from + 2 * sizeof(numbers[0]))));
  };
  EXPECT_EQ(readPicture(with("int16", std::vector<std::int16_t>{ 3, 300 })).grey, (Greys{ 3, 300 }));
  EXPECT_EQ(readPicture(with("float", std::vector<float>{ 3, 30 })).bits, 8);
  EXPECT_EQ(readPicture(with("uint64", std::vector<std::uint64_t>{ 3, 65535 })).grey, (Greys{ 3, 65535 }));
  EXPECT_TRUE(contains(refused(with("int16", std::vector<std::int16_t>{ 3, -1 })), "holds -1; grey values"));
  EXPECT_TRUE(contains(refused(with("double", std::vector<double>{ 3, 0.5 })), "holds 0.5; grey values"));
  EXPECT_TRUE(contains(refused(with("float", std::vector<float>{ 3, NAN })), "holds nan; grey values"));
  EXPECT_TRUE(contains(refused(with("int64", std::vector<std::int64_t>{ 3, 65536 })), "holds 65536; grey values"));
}

TEST(Headers, Refuse)
{
  const TemporaryFolder folder;
  const auto nrrd = [&](const std::string& lines) {
    return refused(folder.write("a.nrrd", bytesOf("NRRD0004\n" + lines + "\n\n", { 1, 2 })));
  };
  EXPECT_TRUE(contains(nrrd("type: uint8\nsizes: 2 3\nencoding: raw"), "has 2 bytes after its header, but 2 × 3 × 1"));
  EXPECT_TRUE(contains(nrrd("type: uint8\nsizes: 2 1\nencoding: bzip2"), "its encoding is 'bzip2'"));
  EXPECT_TRUE(contains(nrrd("type: block\nsizes: 2 1\nencoding: raw"), "its type is 'block'"));
  // Before memory is taken: two bytes cannot be unpacked to so many.
  EXPECT_TRUE(contains(nrrd("type: uint8\nsizes: 1000 1000 1000\nencoding: gzip"), "has 2 packed bytes"));
  EXPECT_TRUE(contains(nrrd("type: uint8\nsizes: 2 1\nencoding: gzip"), "cannot be unpacked"));
  EXPECT_TRUE(contains(nrrd("type: uint8\nsizes: 2 1\nencoding: raw\ndata file: none.raw"), "there is no file"));
  const auto unitless = folder.write("b.mha",
    bytesOf("ObjectType = Image\nNDims = 3\nElementSpacing = 0.005 0.005 0.005\nDimSize = 2 1 1\n"
            "ElementType = MET_UCHAR\nElementDataFile = LOCAL\n",
      { 1, 2 }));
  const Picture picture = readPicture(unitless); // 5 µm, if these are millimetres
  EXPECT_EQ(picture.pixelSizeSource, "none");
  ASSERT_EQ(picture.warnings.size(), 1U);
  EXPECT_TRUE(contains(picture.warnings[0], "names no unit"));
}

/// An array as numpy.save() writes it.
Bytes numpyBytes(const std::string& dictionary, const Bytes& values)
{
  std::string text = dictionary;
  text.resize(std::max<std::size_t>(text.size(), 117), ' ');
  Bytes file = bytesOf("\x93NUMPY");
  file.insert(file.end(), { 1, 0 });
  put(file, text.size() + 1, 2, false);
  const Bytes rest = bytesOf(text + '\n', values);
  file.insert(file.end(), rest.begin(), rest.end());
  return file;
}

const Bytes toTwelve{ 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12 };

TEST(Numpy, ArraysAreVolumesAndPictures)
{
  const TemporaryFolder folder;
  const auto read = [&](const std::string& type, const std::string& shape, const Bytes& values)
  {
    return readPicture(folder.write(
      "a.npy", numpyBytes("{'descr': '" + type + "', 'fortran_order': False, 'shape': (" + shape + "), }", values)));
  };
  const Picture volume = read("|u1", "2, 3, 2", toTwelve);
  EXPECT_EQ(volume.lattice.size, (Size{ 2, 3, 2 }));
  EXPECT_EQ(volume.grey, (Greys{ 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12 }));
  EXPECT_EQ(volume.format, "NumPy");
  EXPECT_EQ(volume.pixelSizeSource, "none");
  // Not a cube, and the last axis runs fastest.
  EXPECT_EQ(read("|u1", "1, 3, 4", toTwelve).lattice.size, (Size{ 4, 3, 1 }));
  const Picture flat = read(">u2", "1, 2", { 1, 2, 3, 4 });
  EXPECT_EQ(flat.lattice.dimension, 2);
  EXPECT_EQ(flat.grey, (Greys{ 0x0102, 0x0304 }));
  EXPECT_EQ(read("|b1", "1, 3", { 0, 1, 1 }).grey, (Greys{ 0, 1, 1 }));
  EXPECT_EQ(read("<f4", "1, 1", { 0, 0, 0x80, 0x3f }).grey, (Greys{ 1 }));
}

TEST(Numpy, RefusesOthers)
{
  const TemporaryFolder folder;
  const auto refusal = [&](const std::string& dictionary)
  { return refused(folder.write("a.npy", numpyBytes(dictionary, toTwelve))); };
  EXPECT_TRUE(contains(refusal("{'descr': '<c8', 'fortran_order': False, 'shape': (1, 1)}"), "its type is '<c8'"));
  EXPECT_TRUE(contains(refusal("{'descr': '|u1', 'fortran_order': True, 'shape': (2, 6)}"), "first axis runs fastest"));
  EXPECT_TRUE(contains(refusal("{'descr': '|u1', 'fortran_order': False, 'shape': ()}"), "its shape is ()"));
  EXPECT_TRUE(contains(refusal("{'descr': '|u1', 'fortran_order': False, 'shape': (2, -6)}"), "its shape is (2, -6)"));
  EXPECT_TRUE(contains(refusal("{'descr': '|u1', 'fortran_order': False, 'shape': (2, x)}"), "its shape is (2, x)"));
  EXPECT_TRUE(contains(refusal("{'descr': '|u1', 'fortran_order': False, 'shape': (2, 7)}"), "has 12 bytes after"));
  EXPECT_TRUE(contains(refusal("no dictionary"), "its type is ''"));
  const Bytes whole = numpyBytes("{'descr': '|u1', 'fortran_order': False, 'shape': (2, 6)}", toTwelve);
  for (std::size_t size = 1; size < whole.size(); ++size)
  {
    const auto file = folder.write("b.npy", { whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size) });
    EXPECT_THROW((void)readPicture(file), InputError) << size << " of " << whole.size() << " bytes";
  }
}

/// A file of NIfTI-1 or -2 with 2 × 3 × 2 voxels of u8, 2 µm large.
struct NiftiFile
{
  bool second = false;
  bool big = false;
  std::map<std::size_t, std::pair<std::uint64_t, int>> changes; ///< by place: value and bytes
  Bytes values = toTwelve;

  [[nodiscard]] Bytes bytes() const
  {
    Bytes header(second ? 544 : 352, 0);
    const auto set = [&](std::size_t at, std::uint64_t value, int count)
    {
      Bytes number;
      put(number, value, count, big);
      std::copy(number.begin(), number.end(), header.begin() + static_cast<std::ptrdiff_t>(at));
    };
    const auto real = [&](std::size_t at, double value)
    {
      if (second)
        set(at, std::bit_cast<std::uint64_t>(value), 8);
      else
        set(at, std::bit_cast<std::uint32_t>(static_cast<float>(value)), 4);
    };
    const std::array<std::uint64_t, 4> axes{ 3, 2, 3, 2 };
    set(0, second ? 540 : 348, 4);
    for (std::size_t i = 0; i < 4; ++i)
    {
      set(second ? 16 + 8 * i : 40 + 2 * i, axes[i], second ? 8 : 2);
      real(second ? 104 + 8 * i : 76 + 4 * i, 2);
    }
    set(second ? 12 : 70, 2, 2);
    if (second)
      set(168, 544, 8);
    else
      real(108, 352);
    set(second ? 500 : 123, 3, second ? 4 : 1);
    const Bytes magic = bytesOf(second ? "n+2" : "n+1");
    std::copy(magic.begin(), magic.end(), header.begin() + (second ? 4 : 344));
    for (const auto& [at, change] : changes)
      set(at, change.first, change.second);
    header.insert(header.end(), values.begin(), values.end());
    return header;
  }
};

Bytes gzipped(const Bytes& bytes)
{
  Bytes packed(bytes.size() + 200);
  z_stream stream{};
  EXPECT_EQ(deflateInit2(&stream, 6, Z_DEFLATED, 31, 8, Z_DEFAULT_STRATEGY), Z_OK);
  stream.next_in = const_cast<std::uint8_t*>(bytes.data());
  stream.avail_in = static_cast<unsigned>(bytes.size());
  stream.next_out = packed.data();
  stream.avail_out = static_cast<unsigned>(packed.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

TEST(Nifti, BothVersionsPackedOrNot)
{
  const TemporaryFolder folder;
  for (const bool second : { false, true })
  {
    for (const bool big : { false, true })
    {
      const Bytes bytes = NiftiFile{ second, big, {} }.bytes();
      for (const auto& file : { folder.write("a.nii", bytes), folder.write("a.nii.gz", gzipped(bytes)) })
      {
        const Picture picture = readPicture(file);
        EXPECT_EQ(picture.lattice.size, (Size{ 2, 3, 2 }));
        EXPECT_EQ(picture.grey, (Greys{ 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12 }));
        EXPECT_DOUBLE_EQ(picture.lattice.spacing, 2e-6);
        EXPECT_EQ(picture.pixelSizeSource, "NIfTI pixdim");
        EXPECT_EQ(picture.format, "NIfTI");
        EXPECT_TRUE(picture.warnings.empty());
        ReadOptions options;
        options.window = Window{ { 1, 1, 1 }, { 1, 2, 1 } };
        EXPECT_EQ(readPicture(file, options).grey, (Greys{ 10, 12 }));
      }
    }
  }
  // The values in a file of their own.
  NiftiFile pair{ false, false, { { 344, { 0x31696e, 4 } }, { 108, { 0, 4 } } }, {} };
  folder.write("b.img", toTwelve);
  EXPECT_EQ(readPicture(folder.write("b.hdr", pair.bytes())).grey.size(), 12U);
}

TEST(Nifti, PlaceAndDirection)
{
  const TemporaryFolder folder;
  const auto number = [](float value) {
    return std::pair<std::uint64_t, int>{ std::bit_cast<std::uint32_t>(value), 4 };
  };
  // A turn of 90° about z by the quaternion (cos 45°, 0, 0, sin 45°), and the third axis mirrored.
  NiftiFile turned;
  turned.changes = { { 252, { 1, 2 } }, { 264, number(std::sqrt(0.5F)) }, { 76, number(-1) }, { 268, number(5) } };
  RawLayout layout = niftiLayout(folder.write("a.nii", turned.bytes()));
  const std::array<double, 9> about{ 0, -1, 0, 1, 0, 0, 0, 0, -1 };
  for (std::size_t i = 0; i < 9; ++i)
    EXPECT_NEAR(layout.direction[i], about[i], 1e-6); // the header's numbers are single
  EXPECT_NEAR(layout.origin[0], 5e-6, 1e-12);
  // The same by a matrix, which wins.
  turned.changes.insert(
    { { 254, { 1, 2 } }, { 284, number(-2) }, { 296, number(2) }, { 320, number(-2) }, { 292, number(7) } });
  layout = niftiLayout(folder.write("a.nii", turned.bytes()));
  for (std::size_t i = 0; i < 9; ++i)
    EXPECT_NEAR(layout.direction[i], about[i], 1e-12);
  EXPECT_NEAR(layout.origin[0], 7e-6, 1e-12);
  EXPECT_TRUE(contains(readPicture(folder / "a.nii").warnings.at(0), "turned or mirrored"));
}

TEST(Nifti, RefusesOthers)
{
  const TemporaryFolder folder;
  const auto with = [&](std::size_t at, std::uint64_t value, int bytes) {
    return refused(folder.write("a.nii", NiftiFile{ false, false, { { at, { value, bytes } } } }.bytes()));
  };
  EXPECT_TRUE(contains(with(70, 32, 2), "its datatype is 32")); // complex
  EXPECT_TRUE(contains(with(40, 9, 2), "speaks of 9 axes"));
  EXPECT_TRUE(contains(with(44, 0xffff, 2), "axis 2 has -1 values"));
  EXPECT_TRUE(contains(with(108, 0x7f800000, 4), "begin at byte inf"));
  EXPECT_TRUE(contains(with(112, std::bit_cast<std::uint32_t>(0.5F), 4), "0.5 times themselves"));
  EXPECT_TRUE(contains(with(42, 3, 2), "has 12 bytes after its header"));
  EXPECT_TRUE(contains(with(344, 0, 4), "is not a NIfTI file"));
  NiftiFile four{ false, false, { { 40, { 4, 2 } }, { 48, { 5, 2 } } } };
  EXPECT_TRUE(contains(refused(folder.write("b.nii", four.bytes())), "its axis 4 has 5 values"));
  const Bytes packed = gzipped(NiftiFile{}.bytes());
  for (std::size_t size = 1; size < packed.size(); ++size)
  {
    const auto file = folder.write("c.nii.gz", { packed.begin(), packed.begin() + static_cast<std::ptrdiff_t>(size) });
    EXPECT_THROW((void)readPicture(file), InputError) << size << " of " << packed.size() << " bytes";
  }
}

TEST(Headers, PackedValuesEndWhereTheHeaderSays)
{
  const TemporaryFolder folder;
  const std::string head = "NRRD0004\ntype: uint8\nsizes: 2 3 SLICES\nencoding: gzip\n\n";
  const auto with = [&](const std::string& slices, const Bytes& packed)
  {
    std::string text = head;
    text.replace(text.find("SLICES"), 6, slices);
    return folder.write("a.nrrd", bytesOf(text, packed));
  };
  Bytes packed = gzipped(toTwelve);
  EXPECT_EQ(readPicture(with("2", packed)).grey.size(), 12U);
  EXPECT_TRUE(contains(refused(with("1", packed)), "more packed values than its header tells"));
  packed[packed.size() - 6] ^= 1; // of the checksum
  EXPECT_TRUE(contains(refused(with("2", packed)), "cannot be unpacked"));
}

TEST(LegacyVtk, StructuredPoints)
{
  const TemporaryFolder folder;
  const std::string head = "# vtk DataFile Version 3.0\na title\nBINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS ";
  const std::string scalars = "SCALARS phase unsigned_char 1\nLOOKUP_TABLE default\n";
  const Picture points = readPicture(folder.write(
    "a.vtk", bytesOf(head + "2 3 2\nORIGIN 0 0 0\nSPACING 1e-6 1e-6 1e-6\nPOINT_DATA 12\n" + scalars, toTwelve)));
  EXPECT_EQ(points.lattice.size, (Size{ 2, 3, 2 }));
  EXPECT_EQ(points.grey, (Greys{ 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12 }));
  EXPECT_DOUBLE_EQ(points.lattice.spacing, 1e-6);
  EXPECT_EQ(points.format, "VTK legacy");
  // Cells, and what newer versions say behind the values.
  Bytes cells = bytesOf(head + "3 4 3\nSPACING 1 1 1\nORIGIN 0 0 0\nCELL_DATA 12\n" + scalars, toTwelve);
  const Bytes behind = bytesOf("\nMETADATA\nINFORMATION 0\n\n");
  cells.insert(cells.end(), behind.begin(), behind.end());
  EXPECT_EQ(readPicture(folder.write("b.vtk", cells)).grey, points.grey);
  EXPECT_EQ(readPicture(folder / "b.vtk").pixelSizeSource, "none");
  EXPECT_EQ(legacyVtkLayout(folder / "b.vtk").origin, (std::array<double, 3>{ 0.5, 0.5, 0.5 }));
  const Picture wide = readPicture(folder.write(
    "c.vtk", bytesOf(head + "2 1 1\nPOINT_DATA 2\nFIELD FieldData 1\nphase 1 2 unsigned_short\n", { 1, 2, 3, 4 })));
  EXPECT_EQ(wide.grey, (Greys{ 0x0102, 0x0304 }));
  EXPECT_EQ(wide.lattice.dimension, 2);

  // As VTK itself writes them.
  const std::string colours = "2 3 2\nPOINT_DATA 12\nCOLOR_SCALARS phase 1\n";
  EXPECT_EQ(readPicture(folder.write("e.vtk", bytesOf(head + colours, toTwelve))).grey, points.grey);
  const auto refusal = [&](const std::string& text) { return refused(folder.write("d.vtk", bytesOf(text, toTwelve))); };
  EXPECT_TRUE(contains(refusal("# vtk DataFile Version 3.0\nt\nASCII\n"), "its values are text"));
  EXPECT_TRUE(contains(refusal("# vtk DataFile Version 3.0\nt\nBINARY\nDATASET POLYDATA\n"), "it holds POLYDATA"));
  EXPECT_TRUE(contains(refusal(head + "2 3 3\nPOINT_DATA 12\n" + scalars), "12 values for 2 × 3 × 3 points"));
  EXPECT_TRUE(contains(refusal(head + "2 3 -2\nPOINT_DATA 12\n" + scalars), "-2 nodes"));
  EXPECT_TRUE(contains(refusal(head + "2 3 2\nSPACING 1 nan 1\nPOINT_DATA 12\n" + scalars), "spacing nan"));
  EXPECT_TRUE(contains(refusal(head + "2 3 1\nPOINT_DATA 6\n" + scalars), "more behind its first array"));
  EXPECT_TRUE(contains(refusal(head + "3 3 2\nPOINT_DATA 18\n" + scalars), "has 12 bytes after its header"));
  EXPECT_TRUE(contains(refusal(head + "2 3 2\nPOINT_DATA 12\nSCALARS a bit\nLOOKUP_TABLE t\n"), "type 'bit'"));
  EXPECT_TRUE(contains(refusal(head + "2 3 2\nPOINT_DATA 12\nVECTORS a float\n"), "'VECTORS' in place of"));
}

TEST(Tiff, ArrangementsBecomeTheSameGreys)
{
  const TemporaryFolder folder;
  const auto read = [&](const Bytes& pixels, const std::map<int, lamella::testing::TiffFile::Value>& tags)
  {
    lamella::testing::TiffFile tiff;
    tiff.pixels = pixels;
    tiff.pages[0] = tags;
    ReadOptions options;
    options.keepColour = true;
    return readPicture(folder.write("a.tif", tiff.bytes()), options);
  };
  // 3 × 2; the lower row comes first.
  EXPECT_EQ(read({ 10, 20, 30, 40, 50, 60 }, { { 262, { 3, { 0 }, {} } } }).grey, // white is zero
    (Greys{ 215, 205, 195, 245, 235, 225 }));
  EXPECT_EQ(
    read({ 1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 0, 1 }, { { 258, { 3, { 16 }, {} } } }).grey, (Greys{ 4, 5, 256, 1, 2, 3 }));
  EXPECT_EQ(read({ 0xa0, 0x40 }, { { 258, { 3, { 1 }, {} } } }).grey, (Greys{ 0, 255, 0, 255, 0, 255 }));
  EXPECT_EQ(read({ 0x12, 0x30, 0x45, 0x60 }, { { 258, { 3, { 4 }, {} } } }).grey, // 17 times as much
    (Greys{ 68, 85, 102, 17, 34, 51 }));
  lamella::testing::TiffFile::Value map{ 3, {}, {} };
  for (std::uint64_t i = 0; i < 768; ++i)
    map.numbers.push_back(i % 256 * 257 / 2); // greys, half as bright
  EXPECT_EQ(read({ 10, 20, 30, 40, 50, 60 }, { { 262, { 3, { 3 }, {} } }, { 320, map } }).grey,
    (Greys{ 20, 25, 30, 5, 10, 15 }));
  const std::vector<std::uint64_t> depths{ 8, 8, 8 };
  const Bytes colours{ 1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 4, 5, 5, 5, 200, 30, 90 };
  const Picture rgb =
    read(colours, { { 258, { 3, depths, {} } }, { 262, { 3, { 2 }, {} } }, { 277, { 3, { 3 }, {} } } });
  EXPECT_EQ(rgb.grey, (Greys{ 4, 5, 88, 1, 2, 3 }));
  EXPECT_EQ(rgb.colour[6], 200);
  // Grey and alpha: the grey that is there, and told of.
  const Picture seen = read({ 100, 255, 100, 51, 7, 255, 8, 255, 9, 255, 10, 255 },
    { { 258, { 3, { 8, 8 }, {} } }, { 277, { 3, { 2 }, {} } }, { 338, { 3, { 2 }, {} } } });
  EXPECT_EQ(seen.grey, (Greys{ 8, 9, 10, 100, 100, 7 }));
  EXPECT_TRUE(contains(seen.warnings.at(0), "transparent"));
  EXPECT_TRUE(
    contains(read({ 10, 20, 30, 40, 50, 60 }, { { 274, { 3, { 3 }, {} } } }).warnings.at(0), "as it is stored"));
}

TEST(Tiff, WhatIsWrittenIsReadToTheLastBit)
{
  const TemporaryFolder folder;
  for (const auto& [bits, samples, numbers] : { std::tuple{ 8, 1, TiffNumbers::Unsigned },
         { 16, 3, TiffNumbers::Unsigned }, { 32, 1, TiffNumbers::Signed }, { 64, 1, TiffNumbers::Real } })
  {
    TiffForm form{ 5, 7, 2 };
    form.bits = bits;
    form.samples = samples;
    form.numbers = numbers;
    Bytes page(static_cast<std::size_t>(5 * 7 * samples * bits / 8));
    for (std::size_t i = 0; i < page.size(); ++i)
      page[i] = static_cast<std::uint8_t>(7 * i + i / 11);
    TiffWriter writer(folder / "a.tif", form);
    EXPECT_TRUE(writer.add(page.data(), "words"));
    EXPECT_TRUE(writer.add(page.data()));
    EXPECT_TRUE(writer.finish());
    FileBytes file(folder / "a.tif");
    TiffFile tiff(file);
    EXPECT_EQ(tiff.page().description, "words");
    tiff.go(1);
    EXPECT_TRUE(tiff.page().plain());
    EXPECT_EQ(tiff.page().bits, bits);
    Bytes back(page.size());
    tiff.readSamples(back.data());
    EXPECT_EQ(back, page);
    EXPECT_FALSE(tiff.next());
  }
}

TEST(Encoders, GiveWhatTheDecodersRead)
{
  const TemporaryFolder folder;
  for (const int channels : { 1, 2, 3, 4 })
  {
    for (const int bits : { 8, 16 })
    {
      Pixels pixels{ 5, 3, channels, bits };
      for (int i = 0; i < 15 * channels * bits / 8; ++i)
        pixels.values.push_back(static_cast<std::uint8_t>(37 * i));
      FileBytes file(folder.write("a.png", encodePng(pixels, 1e6, "words", 4)));
      Probe probe = probePng(file);
      EXPECT_EQ(probe.description, "words");
      EXPECT_EQ(decodePng(file, probe).values, pixels.values);
    }
  }
  Pixels grey{ 64, 64 };
  grey.values.assign(64 * 64, 77); // of one grey, so that nothing is lost
  FileBytes file(folder.write("a.jpg", encodeJpeg(grey)));
  EXPECT_EQ(decodeJpeg(file).values, grey.values);
}

TEST(Encoders, APngThatSpeaksOfALargeChunkTakesNoMemoryForIt)
{
  const TemporaryFolder folder;
  const Pixels pixels{ 1, 1, 1, 8, { 7 } };
  Bytes bytes = encodePng(pixels, 0, "words", 4);
  const std::string type = "iTXt";
  const auto at = std::search(bytes.begin(), bytes.end(), type.begin(), type.end());
  ASSERT_NE(at, bytes.end());
  *(at - 4) = 0x7d; // of its length, 2 GB
  const std::string what = refused(folder.write("a.png", bytes));
  // libpng 1.6.39 refuses the chunk; 1.6.48 looks for the next one behind it, where the file has ended.
  EXPECT_TRUE(contains(what, "too large") || contains(what, "truncated")) << what;
}

TEST(Sha256, IsThatOfTheStandard)
{
  // FIPS 180-4's examples of one and two blocks, in pieces, and nothing at all.
  const auto hashed = [](std::initializer_list<std::string> pieces)
  {
    io::Sha256 hash;
    for (const std::string& piece : pieces)
      hash.update(std::as_bytes(std::span(piece)));
    return hash.finish();
  };
  EXPECT_EQ(hashed({}), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(hashed({ "a", "", "bc" }), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(hashed({ "abcdbcdecdefdefgefghfghighijhijk", "ijkljklmklmnlmnomnopnopq" }),
    "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
}
