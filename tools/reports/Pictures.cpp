#include "reports/Pictures.h"

#include "reports/Html.h"

#include "core/Error.h"
#include "core/Lower.h"
#include "pictures/Decode.h"
#include "pictures/JpegFile.h"
#include "pictures/PngFile.h"
#include "pictures/TiffFile.h"

#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <set>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace lamella::reports
{

namespace fs = std::filesystem;

namespace
{

constexpr std::int64_t mostPixels = std::int64_t{ 100 } << 20;
constexpr int narrowest = 48;                                      // of a picture that is made to fit
constexpr std::uint64_t largestDrawing = std::uint64_t{ 8 } << 20; // of an SVG [bytes]

std::string dataOf(const char* kind, const std::vector<std::uint8_t>& bytes)
{
  return std::string("data:image/") + kind + ";base64," + base64(std::as_bytes(std::span(bytes)));
}

[[noreturn]] void noRoom(const fs::path& path)
{
  throw InputError("there is no room for '" + path.string() + "' in the page", "make a smaller picture of it");
}

EmbeddedPicture drawing(const fs::path& path, std::size_t mostBytes)
{
  micrograph::FileBytes file(path);
  if (file.size() > largestDrawing)
    throw InputError("'" + path.string() + "' is an SVG of more than 8 MB", "make a PNG of it");
  const std::vector<std::uint8_t> bytes = file.read(0, file.size());
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.find("<svg") == std::string_view::npos || text.find("</svg>") == std::string_view::npos)
    file.damaged("it holds no whole <svg> element");
  EmbeddedPicture picture;
  picture.source = dataOf("svg+xml", bytes); // in an <img> nothing in it is run or fetched
  if (mostBytes > 0 && picture.source.size() > mostBytes)
    noRoom(path);
  return picture;
}

/// Eight bits, and no more columns than `mostWide`.
micrograph::Pixels smaller(micrograph::Pixels pixels, int mostWide)
{
  const int channels = pixels.channels;
  const bool deep = pixels.bits == 16;
  cv::Mat matrix(static_cast<int>(pixels.height), static_cast<int>(pixels.width),
    CV_MAKETYPE(deep ? CV_16U : CV_8U, channels), pixels.values.data());
  if (deep)
    matrix.convertTo(matrix, CV_8U, 1.0 / 257);
  if (pixels.width > mostWide)
  {
    const double share = static_cast<double>(mostWide) / static_cast<double>(pixels.width);
    const auto height = std::max<std::int64_t>(1, std::llround(share * static_cast<double>(pixels.height)));
    cv::Mat resized;
    cv::resize(matrix, resized, { mostWide, static_cast<int>(height) }, 0, 0, cv::INTER_AREA);
    matrix = resized;
  }
  micrograph::Pixels result{ matrix.cols, matrix.rows, channels };
  result.values.assign(matrix.data, matrix.data + matrix.total() * matrix.elemSize());
  return result;
}

/// PNG or JPEG, which has no transparency: there it is white.
std::string shorter(const micrograph::Pixels& pixels)
{
  std::string png = dataOf("png", micrograph::encodePng(pixels, 0, "", 9));
  micrograph::Pixels opaque = pixels;
  if (pixels.channels == 2 || pixels.channels == 4)
  {
    opaque.channels = pixels.channels - 1;
    opaque.values.clear();
    for (std::size_t i = 0; i < pixels.values.size(); ++i)
    {
      const std::size_t last = static_cast<std::size_t>(opaque.channels);
      const std::size_t alpha = i - i % (last + 1) + last;
      if (i != alpha)
        opaque.values.push_back(static_cast<std::uint8_t>(255 - (255 - pixels.values[i]) * pixels.values[alpha] / 255));
    }
  }
  std::string jpeg = dataOf("jpeg", micrograph::encodeJpeg(opaque, 85));
  return png.size() < jpeg.size() ? png : jpeg;
}

/// The pixels of the only picture, or of the first page.
micrograph::Pixels pixelsOf(micrograph::FileBytes& file, micrograph::Probe& probe)
{
  if (probe.format != micrograph::Format::Tiff)
    return micrograph::onlyPixels(file, probe);
  micrograph::TiffFile tiff(file);
  tiff.go(probe.slices.front());
  return tiff.pixels();
}

} // namespace

bool isPicture(const fs::path& path)
{
  const std::string end = endingOf(path);
  static const std::set<std::string> known{ ".png", ".jpg", ".jpeg", ".svg", ".tif", ".tiff", ".pgm", ".ppm", ".pnm",
    ".bmp" };
  return known.contains(end);
}

EmbeddedPicture embed(const fs::path& path, int mostWide, std::size_t mostBytes)
{
  if (!isPicture(path))
  {
    throw InputError(
      "'" + path.string() + "' is no picture by its name", "pictures are PNG, JPEG, TIFF, PGM, PPM, BMP or SVG");
  }
  if (endingOf(path) == ".svg")
    return drawing(path, mostBytes);
  micrograph::FileBytes file(path);
  micrograph::Probe probe = micrograph::probe(file);
  EmbeddedPicture picture;
  picture.width = picture.fullWidth = probe.width;
  picture.height = picture.fullHeight = probe.height;
  if (probe.width * probe.height > mostPixels)
  {
    throw InputError("'" + path.string() + "' has " + std::to_string(probe.width) + " × " +
        std::to_string(probe.height) + " pixels, too many for a page",
      "make a smaller one, of 100 million pixels at most");
  }
  micrograph::Pixels pixels = pixelsOf(file, probe); // also where only the bytes go on: a damaged file is noticed
  // A drawing carries it by itself, a picture of labels within its description (Record.h).
  const auto record = nlohmann::json::parse(probe.description, nullptr, false);
  const bool labels = record.is_object() && record.contains("provenance") && record["provenance"].is_object();
  picture.provenance = labels ? record["provenance"].dump() : probe.provenance;
  const bool jpeg = probe.format == micrograph::Format::Jpeg;
  if (probe.width <= mostWide && (jpeg || probe.format == micrograph::Format::Png))
  {
    picture.source = dataOf(jpeg ? "jpeg" : "png", file.read(0, file.size()));
    if (mostBytes == 0 || picture.source.size() <= mostBytes)
      return picture;
  }
  for (int width = mostWide; width >= narrowest; width = width * 3 / 4)
  {
    pixels = smaller(std::move(pixels), width);
    picture.width = pixels.width;
    picture.height = pixels.height;
    picture.source = mostBytes > 0 ? shorter(pixels)
      : jpeg                       ? dataOf("jpeg", micrograph::encodeJpeg(pixels))
                                   : dataOf("png", micrograph::encodePng(pixels, 0, "", 1));
    if (mostBytes == 0 || picture.source.size() <= mostBytes)
      return picture;
  }
  noRoom(path);
}

} // namespace lamella::reports
