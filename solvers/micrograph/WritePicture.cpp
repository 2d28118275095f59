#include "micrograph/WritePicture.h"

#include "micrograph/Probe.h"

#include "lattice/Error.h"
#include "lattice/PartFile.h"

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <limits>
#include <system_error>

namespace lamella::micrograph
{
namespace
{

namespace fs = std::filesystem;

void append(std::string& bytes, std::uint64_t value, int count, bool bigEndian)
{
  for (int i = 0; i < count; ++i)
  {
    bytes += static_cast<char>(value >> (8 * (bigEndian ? count - 1 - i : i)));
  }
}

std::string pngChunk(const std::string& type, const std::string& data)
{
  std::string chunk;
  append(chunk, data.size(), 4, true);
  const std::string body = type + data;
  chunk += body;
  append(chunk, pngCrc(reinterpret_cast<const std::uint8_t*>(body.data()), body.size()), 4, true);
  return chunk;
}

/// Greys of a slice with rows from the top, as files have them.
std::vector<std::uint8_t> rowsFromTop(const PhaseImage& image, std::span<const std::uint8_t> grey, std::int64_t z)
{
  const auto [nx, ny, nz] = image.lattice.size;
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(nx * ny));
  for (std::int64_t row = 0; row < ny; ++row)
  {
    const std::int64_t y = image.lattice.dimension == 2 ? ny - 1 - row : row;
    for (std::int64_t x = 0; x < nx; ++x)
    {
      pixels[static_cast<std::size_t>(x + nx * row)] =
        grey[image.phase[static_cast<std::size_t>(image.lattice.index(x, y, z))]];
    }
  }
  return pixels;
}

/// A PNG file of rows from the top.
std::string png(
  const cv::Mat& pixels, const Lattice& lattice, std::string_view description, bool hasPixelSize, int effort = 9)
{
  std::vector<std::uint8_t> encoded;
  try
  {
    if (!cv::imencode(".png", pixels, encoded, { cv::IMWRITE_PNG_COMPRESSION, effort }))
    {
      encoded.clear();
    }
  }
  catch (const cv::Exception&)
  {
    encoded.clear();
  }
  constexpr std::size_t headerEnd = 33; // signature and IHDR
  if (encoded.size() < headerEnd)
  {
    throw ParameterError(
      fmt::format("a picture of {} × {} pixels cannot be written as PNG", lattice.size[0], lattice.size[1]),
      "write a TIFF instead");
  }
  std::string bytes(encoded.begin(), encoded.begin() + headerEnd);
  const double perMetre = std::round(1 / lattice.spacing);
  if (hasPixelSize && perMetre >= 1 && perMetre < 2147483648.0)
  {
    std::string data;
    append(data, static_cast<std::uint64_t>(perMetre), 4, true);
    append(data, static_cast<std::uint64_t>(perMetre), 4, true);
    data += '\1'; // per metre
    bytes += pngChunk("pHYs", data);
  }
  if (!description.empty())
  {
    bytes += pngChunk("iTXt", std::string("Description\0\0\0\0\0", 16) + std::string(description));
  }
  bytes.append(encoded.begin() + headerEnd, encoded.end());
  return bytes;
}

std::string png(
  const PhaseImage& image, std::span<const std::uint8_t> grey, std::string_view description, bool hasPixelSize)
{
  std::vector<std::uint8_t> pixels = rowsFromTop(image, grey, 0);
  const cv::Mat matrix(
    static_cast<int>(image.lattice.size[1]), static_cast<int>(image.lattice.size[0]), CV_8UC1, pixels.data());
  return png(matrix, image.lattice, description, hasPixelSize);
}

/// The spacing as pixels per centimetre, the best ratio of two 32-bit numbers with a denominator that is a power of
/// ten.
std::array<std::uint32_t, 2> perCentimetre(double spacing)
{
  const double wanted = 0.01 / spacing;
  double below = 1;
  while (wanted * below * 10 < 4e9 && below < 1e9)
  {
    below *= 10;
  }
  return { static_cast<std::uint32_t>(std::llround(std::min(wanted * below, 4294967295.0))),
    static_cast<std::uint32_t>(below) };
}

/// A TIFF 6.0 file, not compressed, one page a slice: header, then for each page its pixels and directory.
void tiff(std::ostream& out, const PhaseImage& image, std::span<const std::uint8_t> grey, std::string_view description,
  bool hasPixelSize)
{
  const auto [nx, ny, nz] = image.lattice.size;
  const std::uint64_t slice = static_cast<std::uint64_t>(nx * ny);
  const std::uint64_t padded = slice + slice % 2; // directories begin at even bytes
  constexpr std::uint64_t entries = 13;
  const std::uint64_t directory = 2 + 12 * entries + 4;
  const std::string text(description.begin(), description.end());
  // Description and resolution stand once, behind the header.
  const std::uint64_t textAt = 8;
  const std::uint64_t textSize = text.size() + 1;
  const std::uint64_t ratioAt = textAt + textSize + textSize % 2;
  const std::uint64_t firstPage = ratioAt + 8;
  const std::uint64_t total = firstPage + static_cast<std::uint64_t>(nz) * (padded + directory);
  if (total > std::numeric_limits<std::uint32_t>::max())
  {
    throw ParameterError(fmt::format("a volume of {} × {} × {} voxels is more than the 4 GiB of a TIFF", nx, ny, nz),
      "write a .vti instead");
  }

  std::string head = "II";
  append(head, 42, 2, false);
  append(head, firstPage + padded, 4, false);
  head += text;
  head.append(1 + textSize % 2, '\0');
  const auto ratio = perCentimetre(image.lattice.spacing);
  append(head, ratio[0], 4, false);
  append(head, ratio[1], 4, false);
  out.write(head.data(), static_cast<std::streamsize>(head.size()));

  for (std::int64_t z = 0; z < nz; ++z)
  {
    const std::uint64_t pageAt = firstPage + static_cast<std::uint64_t>(z) * (padded + directory);
    const std::vector<std::uint8_t> pixels = rowsFromTop(image, grey, z);
    out.write(reinterpret_cast<const char*>(pixels.data()), static_cast<std::streamsize>(slice));
    if (padded > slice)
    {
      out.put('\0');
    }
    std::string page;
    append(page, entries, 2, false);
    const auto entry = [&](std::uint64_t tag, std::uint64_t type, std::uint64_t count, std::uint64_t value)
    {
      append(page, tag, 2, false);
      append(page, type, 2, false);
      append(page, count, 4, false);
      append(page, value, 4, false);
    };
    constexpr std::uint64_t ascii = 2, shortNumber = 3, longNumber = 4, rational = 5;
    entry(254, longNumber, 1, nz > 1 ? 2 : 0); // a page of several
    entry(256, longNumber, 1, static_cast<std::uint64_t>(nx));
    entry(257, longNumber, 1, static_cast<std::uint64_t>(ny));
    entry(258, shortNumber, 1, 8);
    entry(259, shortNumber, 1, 1); // not compressed
    entry(262, shortNumber, 1, 1); // black is zero
    // A text of up to four bytes stands in the entry itself.
    entry(270, ascii, textSize <= 4 ? 1 : textSize, textSize <= 4 ? 0 : textAt);
    entry(273, longNumber, 1, pageAt);
    entry(278, longNumber, 1, static_cast<std::uint64_t>(ny));
    entry(279, longNumber, 1, slice);
    entry(282, rational, 1, ratioAt);
    entry(283, rational, 1, ratioAt);
    entry(296, shortNumber, 1, hasPixelSize ? 3 : 1); // centimetre, or none
    append(page, z + 1 < nz ? pageAt + padded + directory + padded : 0, 4, false);
    out.write(page.data(), static_cast<std::streamsize>(page.size()));
  }
}

} // namespace

void writeWhole(const fs::path& path, const std::function<void(std::ostream&)>& write)
{
  // In the same folder, so that taking the name is one step that cannot be seen half done.
  PartFile part(path);
  const auto cannot = [&](int error)
  {
    if (error == ECANCELED)
    {
      throw Cancelled();
    }
    throw Error(fmt::format("'{}' cannot be written: {}", path.string(), std::generic_category().message(error)),
      "choose a folder that exists and that you may write to, and another name");
  };
  if (part.error() != 0)
  {
    cannot(part.error());
  }
  std::ofstream out(part.path(), std::ios::binary | std::ios::trunc);
  write(out);
  errno = 0;
  out.close();
  if (!out)
  {
    const std::string reason = errno != 0 ? std::generic_category().message(errno) : "the disk is full or failing";
    throw Error(fmt::format("'{}' cannot be written whole: {}", path.string(), reason),
      "make room on the disk or choose another folder; nothing was left behind");
  }
  if (const int error = part.take(path); error != 0)
  {
    cannot(error);
  }
}

void writeLabels(const PhaseImage& image, const fs::path& path, std::span<const std::uint8_t> grey,
  std::string_view description, bool hasPixelSize)
{
  std::vector<std::uint8_t> greys(grey.begin(), grey.end());
  const std::size_t phases = image.phases.size();
  for (std::size_t id = 0; grey.empty() && id < phases; ++id)
  {
    greys.push_back(static_cast<std::uint8_t>(phases > 1 ? id * 255 / (phases - 1) : 0));
  }
  std::vector<std::uint8_t> sorted = greys;
  std::sort(sorted.begin(), sorted.end());
  if (greys.size() != phases || std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end())
  {
    throw ParameterError(
      fmt::format("{} greys for {} phases, or two alike", greys.size(), phases), "give every phase a grey of its own");
  }
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  const bool flat = image.lattice.dimension == 2;
  if (ending == ".png" && flat)
  {
    const std::string bytes = png(image, greys, description, hasPixelSize);
    writeWhole(path, [&](std::ostream& out) { out.write(bytes.data(), static_cast<std::streamsize>(bytes.size())); });
  }
  else if (ending == ".tif" || ending == ".tiff")
  {
    writeWhole(path, [&](std::ostream& out) { tiff(out, image, greys, description, hasPixelSize); });
  }
  else
  {
    throw ParameterError(fmt::format("labels cannot be written as '{}'", path.filename().string()),
      flat ? "let its name end in .png or .tif" : "let its name end in .tif: a volume becomes one page a slice");
  }
}

namespace
{

/// The pixels of a picture as OpenCV has them: rows from the top, blue first.
template <typename Value>
cv::Mat matrixOf(const Picture& picture, int type)
{
  const bool colour = !picture.colour.empty();
  const auto width = static_cast<int>(picture.lattice.size[0]);
  const auto height = static_cast<int>(picture.lattice.size[1]);
  const int channels = colour ? 3 : 1;
  cv::Mat pixels(height, width, CV_MAKETYPE(type, channels));
  const std::vector<std::uint16_t>& values = colour ? picture.colour : picture.grey;
  for (int row = 0; row < height; ++row)
  {
    auto* const to = pixels.ptr<Value>(row);
    const std::size_t from = static_cast<std::size_t>(height - 1 - row) * static_cast<std::size_t>(width * channels);
    for (int i = 0; i < width * channels; ++i)
    {
      const int source = colour ? i / 3 * 3 + 2 - i % 3 : i;
      to[i] = static_cast<Value>(values[from + static_cast<std::size_t>(source)]);
    }
  }
  return pixels;
}

} // namespace

void writePicture(const Picture& picture, const fs::path& path, std::string_view description, int effort)
{
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  if (ending != ".png" || picture.lattice.dimension != 2)
  {
    throw ParameterError(
      fmt::format("a {}D picture cannot be written as '{}'", picture.lattice.dimension, path.filename().string()),
      "a picture can be written as .png");
  }
  const cv::Mat pixels =
    picture.bits == 16 ? matrixOf<std::uint16_t>(picture, CV_16U) : matrixOf<std::uint8_t>(picture, CV_8U);
  const std::string bytes = png(pixels, picture.lattice, description, picture.pixelSizeSource != "none", effort);
  writeWhole(path, [&](std::ostream& out) { out.write(bytes.data(), static_cast<std::streamsize>(bytes.size())); });
}

} // namespace lamella::micrograph
