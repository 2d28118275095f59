#include "reports/Pictures.h"

#include "reports/Html.h"

#include "lattice/Error.h"
#include "micrograph/FileBytes.h"
#include "micrograph/Probe.h"

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <span>
#include <string_view>
#include <vector>

namespace lamella::reports
{

namespace fs = std::filesystem;

namespace
{

constexpr std::int64_t mostPixels = std::int64_t{ 100 } << 20;
constexpr std::uint64_t largestDrawing = std::uint64_t{ 8 } << 20; // of an SVG [bytes]

std::string ending(const fs::path& path)
{
  std::string text = path.extension().string();
  std::transform(
    text.begin(), text.end(), text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::string dataOf(const char* kind, const std::vector<std::uint8_t>& bytes)
{
  return std::string("data:image/") + kind + ";base64," + base64(std::as_bytes(std::span(bytes)));
}

EmbeddedPicture drawing(const fs::path& path)
{
  micrograph::FileBytes file(path);
  if (file.size() > largestDrawing)
  {
    throw InputError("'" + path.string() + "' is an SVG of more than 8 MB", "make a PNG of it");
  }
  const std::vector<std::uint8_t> bytes = file.read(0, file.size());
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.find("<svg") == std::string_view::npos || text.find("</svg>") == std::string_view::npos)
  {
    file.damaged("it holds no whole <svg> element");
  }
  EmbeddedPicture picture;
  picture.source = dataOf("svg+xml", bytes); // in an <img> nothing in it is run or fetched
  return picture;
}

/// The pixels, smaller where they are too many; as PNG.
void redraw(
  EmbeddedPicture& picture, const std::vector<std::uint8_t>& bytes, int mostWide, bool jpeg, const fs::path& path)
{
  cv::Mat pixels;
  try
  {
    pixels = cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
    if (pixels.depth() != CV_8U && !pixels.empty())
    {
      pixels.convertTo(pixels, CV_8U, 1.0 / 257);
    }
    if (!pixels.empty() && picture.fullWidth > mostWide)
    {
      const double share = static_cast<double>(mostWide) / static_cast<double>(picture.fullWidth);
      picture.width = mostWide;
      picture.height = std::max<std::int64_t>(1, std::llround(share * static_cast<double>(picture.fullHeight)));
      cv::Mat smaller;
      cv::resize(
        pixels, smaller, { static_cast<int>(picture.width), static_cast<int>(picture.height) }, 0, 0, cv::INTER_AREA);
      pixels = smaller;
    }
    std::vector<std::uint8_t> drawn;
    if (!pixels.empty() && cv::imencode(jpeg ? ".jpg" : ".png", pixels, drawn))
    {
      picture.source = dataOf(jpeg ? "jpeg" : "png", drawn);
      return;
    }
  }
  catch (const cv::Exception&)
  {
    picture.source.clear();
  }
  throw InputError("'" + path.string() + "' cannot be drawn anew", "save it as an 8-bit PNG");
}

} // namespace

bool isPicture(const fs::path& path)
{
  const std::string end = ending(path);
  return end == ".png" || end == ".jpg" || end == ".jpeg" || end == ".svg" || end == ".tif" || end == ".tiff";
}

EmbeddedPicture embed(const fs::path& path, int mostWide)
{
  if (!isPicture(path))
  {
    throw InputError("'" + path.string() + "' is no picture by its name", "pictures are PNG, JPEG, TIFF or SVG");
  }
  if (ending(path) == ".svg")
  {
    return drawing(path);
  }
  micrograph::FileBytes file(path);
  const micrograph::Probe probe = micrograph::probe(file);
  EmbeddedPicture picture;
  picture.width = picture.fullWidth = probe.width;
  picture.height = picture.fullHeight = probe.height;
  if (probe.width * probe.height > mostPixels)
  {
    throw InputError("'" + path.string() + "' has " + std::to_string(probe.width) + " × " +
        std::to_string(probe.height) + " pixels, too many for a page",
      "make a smaller one, of 100 million pixels at most");
  }
  // A drawing carries it by itself, a picture of labels within its description (Record.h).
  const auto record = nlohmann::json::parse(probe.description, nullptr, false);
  const bool labels = record.is_object() && record.contains("provenance") && record["provenance"].is_object();
  picture.provenance = labels ? record["provenance"].dump() : probe.provenance;
  const std::vector<std::uint8_t> bytes = file.read(0, file.size());
  const bool jpeg = probe.format == micrograph::Format::Jpeg;
  if (probe.width <= mostWide && probe.format != micrograph::Format::Tiff)
  {
    picture.source = dataOf(jpeg ? "jpeg" : "png", bytes);
    return picture;
  }
  redraw(picture, bytes, mostWide, jpeg, path);
  return picture;
}

} // namespace lamella::reports
