#include "micrograph/Decode.h"
#include "micrograph/JpegDecode.h"
#include "micrograph/PngDecode.h"
#include "micrograph/TiffWatch.h"

#include "lattice/Error.h"

#include <fmt/format.h>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <limits>

namespace lamella::micrograph
{
namespace
{

/// OpenCV reports on standard error what we report as errors; it is quiet while one of these lives.
class Quiet
{
public:
  Quiet()
    : before_(cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT))
  {
  }
  ~Quiet() { cv::utils::logging::setLogLevel(before_); }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;

private:
  cv::utils::logging::LogLevel before_;
};

[[noreturn]] void undecodable(const FileBytes& file, const Probe& probe, const std::string& why = {})
{
  throw InputError(fmt::format("the pixels of '{}' cannot be decoded: the {} is damaged or of a rare kind{}",
                     file.name(), name(probe.format), why.empty() ? "" : " (" + why + ")"),
    "save it again as an 8-bit grey PNG");
}

template <class Value>
void convert(const cv::Mat& pixels, bool flip, bool invert, std::uint16_t* grey, std::uint16_t* colour, Decoded& seen)
{
  const int channels = pixels.channels();
  const auto width = static_cast<std::int64_t>(pixels.cols);
  const auto top = std::numeric_limits<Value>::max();
  for (int row = 0; row < pixels.rows; ++row)
  {
    const Value* from = pixels.ptr<Value>(row);
    const std::int64_t line = flip ? pixels.rows - 1 - row : row;
    std::uint16_t* to = grey + line * width;
    if (channels == 1)
    {
      std::transform(from, from + width, to, [&](Value v) { return static_cast<Value>(invert ? top - v : v); });
      continue;
    }
    std::uint16_t* rgb = colour == nullptr ? nullptr : colour + 3 * line * width;
    for (std::int64_t x = 0; x < width; ++x, from += channels)
    {
      // OpenCV's order is blue, green, red, alpha; two channels are grey and alpha.
      const std::array<int, 3> value = channels == 2 ? std::array<int, 3>{ from[0], from[0], from[0] }
                                                     : std::array<int, 3>{ from[2], from[1], from[0] };
      if ((channels == 2 || channels == 4) && from[channels - 1] != top)
      {
        seen.transparent = true;
      }
      if (value[0] != value[1] || value[1] != value[2])
      {
        if (!seen.colour)
        {
          seen.colour = true;
          seen.colourX = x;
          seen.colourY = row;
          seen.firstColour = value;
        }
        to[x] = static_cast<std::uint16_t>((299 * value[0] + 587 * value[1] + 114 * value[2] + 500) / 1000);
      }
      else
      {
        to[x] = static_cast<std::uint16_t>(value[0]);
      }
      if (rgb != nullptr)
      {
        std::copy(value.begin(), value.end(), rgb + 3 * x);
      }
    }
  }
}

} // namespace

Decoded decode(FileBytes& file, const Probe& probe, bool flip, std::uint16_t* grey, std::uint16_t* colour)
{
  const Quiet quiet;
  Decoded seen;
  const std::int64_t slice = probe.width * probe.height;
  const auto take = [&](const cv::Mat& pixels, std::size_t number)
  {
    const bool deep = pixels.depth() == CV_16U;
    if (pixels.empty() || pixels.cols != probe.width || pixels.rows != probe.height ||
      (!deep && pixels.depth() != CV_8U))
    {
      undecodable(file, probe);
    }
    const auto offset = static_cast<std::int64_t>(number) * slice;
    std::uint16_t* const rgb = colour == nullptr ? nullptr : colour + 3 * offset;
    if (deep)
    {
      convert<std::uint16_t>(pixels, flip, probe.whiteIsZero, grey + offset, rgb, seen);
    }
    else
    {
      convert<std::uint8_t>(pixels, flip, false, grey + offset, rgb, seen);
    }
    if (rgb != nullptr && pixels.channels() == 1)
    {
      for (std::int64_t i = 0; i < 3 * slice; ++i)
      {
        rgb[i] = grey[offset + i / 3];
      }
    }
  };
  try
  {
    if (probe.format == Format::Jpeg)
    {
      JpegPixels jpeg = decodeJpeg(file.read(0, file.size()));
      if (!jpeg.complaint.empty())
      {
        undecodable(file, probe, jpeg.complaint);
      }
      cv::Mat pixels(
        static_cast<int>(jpeg.height), static_cast<int>(jpeg.width), CV_8UC(jpeg.channels), jpeg.values.data());
      if (jpeg.channels == 3)
      {
        cv::cvtColor(pixels, pixels, cv::COLOR_RGB2BGR);
      }
      take(pixels, 0);
      return seen;
    }
    if (probe.format == Format::Png)
    {
      PngPixels png = decodePng(file.read(0, file.size()));
      if (!png.complaint.empty())
      {
        undecodable(file, probe, png.complaint);
      }
      cv::Mat pixels(static_cast<int>(png.height), static_cast<int>(png.width),
        CV_MAKETYPE(png.bits == 16 ? CV_16U : CV_8U, png.channels), png.values.data());
      if (png.channels >= 3)
      {
        cv::cvtColor(pixels, pixels, png.channels == 3 ? cv::COLOR_RGB2BGR : cv::COLOR_RGBA2BGRA);
      }
      take(pixels, 0);
      return seen;
    }
    (void)cv::haveImageReader(file.name()); // lets OpenCV set its own error handler before ours
    const TiffWatch watch;
    // A few pages at a time: few enough for little memory, enough not to search the file for every one.
    constexpr std::size_t batch = 32;
    std::vector<cv::Mat> pages;
    for (std::size_t i = 0; i < probe.slices.size();)
    {
      const std::size_t first = probe.slices[i];
      const std::size_t count = std::min(batch, probe.pages - first);
      pages.clear();
      if (!cv::imreadmulti(
            file.name(), pages, static_cast<int>(first), static_cast<int>(count), cv::IMREAD_UNCHANGED) ||
        pages.size() != count || !watch.error().empty())
      {
        undecodable(file, probe, watch.error());
      }
      for (; i < probe.slices.size() && probe.slices[i] < first + count; ++i)
      {
        take(pages[probe.slices[i] - first], i);
      }
    }
  }
  catch (const cv::Exception&)
  {
    undecodable(file, probe);
  }
  return seen;
}

} // namespace lamella::micrograph
