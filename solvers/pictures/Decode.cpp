#include "pictures/Decode.h"

#include "pictures/BmpFile.h"
#include "pictures/JpegFile.h"
#include "pictures/NetpbmFile.h"
#include "pictures/PngFile.h"
#include "pictures/TiffFile.h"

#include <algorithm>
#include <limits>

namespace lamella::micrograph
{
namespace
{

template <class Value>
void convert(const Pixels& pixels, bool flip, std::uint16_t* grey, std::uint16_t* colour, Decoded& seen)
{
  const int channels = pixels.channels;
  const std::int64_t width = pixels.width;
  const auto* from = reinterpret_cast<const Value*>(pixels.values.data());
  for (std::int64_t row = 0; row < pixels.height; ++row)
  {
    const std::int64_t line = flip ? pixels.height - 1 - row : row;
    std::uint16_t* to = grey + line * width;
    std::uint16_t* rgb = colour == nullptr ? nullptr : colour + 3 * line * width;
    for (std::int64_t x = 0; x < width; ++x, from += channels)
    {
      const std::array<int, 3> value = channels < 3 ? std::array<int, 3>{ from[0], from[0], from[0] }
                                                    : std::array<int, 3>{ from[0], from[1], from[2] };
      if (channels % 2 == 0 && from[channels - 1] != std::numeric_limits<Value>::max())
        seen.transparent = true;
      to[x] = static_cast<std::uint16_t>(value[0]);
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
      if (rgb != nullptr)
        std::copy(value.begin(), value.end(), rgb + 3 * x);
    }
  }
}

} // namespace

void convert(const Pixels& pixels, bool flip, std::uint16_t* grey, std::uint16_t* colour, Decoded& seen)
{
  if (pixels.bits == 16)
    convert<std::uint16_t>(pixels, flip, grey, colour, seen);
  else
    convert<std::uint8_t>(pixels, flip, grey, colour, seen);
}

Pixels onlyPixels(FileBytes& file, Probe& probe)
{
  switch (probe.format)
  {
    case Format::Png:
      return decodePng(file, probe);
    case Format::Jpeg:
      return decodeJpeg(file);
    case Format::Pgm:
    case Format::Ppm:
      return decodeNetpbm(file, probe);
    case Format::Bmp:
    case Format::Tiff:
      break;
  }
  return decodeBmp(file);
}

Decoded decode(FileBytes& file, Probe& probe, bool flip, std::uint16_t* grey, std::uint16_t* colour)
{
  Decoded seen;
  const auto take = [&](const Pixels& pixels, std::size_t number)
  {
    if (pixels.width != probe.width || pixels.height != probe.height)
      undecodable(file, probe.format, "its size is another than it says");
    const std::int64_t offset = static_cast<std::int64_t>(number) * probe.width * probe.height;
    convert(pixels, flip, grey + offset, colour == nullptr ? nullptr : colour + 3 * offset, seen);
  };
  if (probe.format != Format::Tiff)
  {
    take(onlyPixels(file, probe), 0);
    return seen;
  }
  TiffFile tiff(file);
  for (std::size_t i = 0; i < probe.slices.size(); ++i)
  {
    tiff.go(probe.slices[i]);
    take(tiff.pixels(), i);
  }
  return seen;
}

} // namespace lamella::micrograph
