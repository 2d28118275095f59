#include "micrograph/Probe.h"

#include "lattice/Error.h"

#include <fmt/format.h>

#include <cstring>

namespace lamella::micrograph
{
namespace
{

bool startsFrame(int marker)
{
  return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
}

void readFrame(const FileBytes& file, const std::vector<std::uint8_t>& data, Probe& result)
{
  if (data.size() < 6)
  {
    file.damaged("its frame header is too short");
  }
  const int bits = data[0];
  result.height = static_cast<std::int64_t>(numberFrom(data.data() + 1, 2, true));
  result.width = static_cast<std::int64_t>(numberFrom(data.data() + 3, 2, true));
  const int components = data[5];
  if (components == 4)
  {
    throw InputError(fmt::format("'{}' is a CMYK JPEG, made for printing", file.name()),
      "convert it to grey or RGB first, for example: convert in.jpg -colorspace Gray out.png");
  }
  if (bits != 8 || (components != 1 && components != 3))
  {
    throw InputError(fmt::format("'{}' is a JPEG with {} components of {} bits", file.name(), components, bits),
      "save it as an 8-bit grey or RGB picture");
  }
  if (result.width < 1 || result.height < 1)
  {
    file.damaged("it holds no pixels");
  }
  result.channels = components;
}

void readJfif(const std::vector<std::uint8_t>& data, Probe& result)
{
  if (data.size() < 12 || std::memcmp(data.data(), "JFIF", 5) != 0)
  {
    return;
  }
  const double unit = data[7] == 1 ? 0.0254 : data[7] == 2 ? 0.01 : 0; // per inch, per centimetre, or only a ratio
  const auto x = static_cast<double>(numberFrom(data.data() + 8, 2, true));
  const auto y = static_cast<double>(numberFrom(data.data() + 10, 2, true));
  if (unit > 0 && x > 0 && y > 0)
  {
    result.size = MetadataSize{ unit / x, unit / y, std::nullopt, "JFIF density" };
  }
}

/// Is there an end-of-image marker in what follows the first scan? Inside a scan every FF byte is followed by 00 or by
/// a restart marker, so FF D9 can only be the end.
bool hasEnd(FileBytes& file, std::uint64_t at)
{
  constexpr std::uint64_t piece = 1U << 20;
  int before = 0;
  for (; at < file.size(); at += piece)
  {
    for (const std::uint8_t byte : file.read(at, std::min(piece, file.size() - at)))
    {
      if (before == 0xff && byte == 0xd9)
      {
        return true;
      }
      before = byte;
    }
  }
  return false;
}

} // namespace

Probe probeJpeg(FileBytes& file)
{
  Probe result;
  result.format = Format::Jpeg;
  std::optional<MetadataSize> exifSize;
  std::uint64_t at = 2;
  while (true)
  {
    if (!file.holds(at, 4))
    {
      file.truncated("the JPEG ends before its pixels");
    }
    if (file.number(at, 1, true) != 0xff)
    {
      file.damaged(fmt::format("there is no marker at byte {}", at));
    }
    const int marker = static_cast<int>(file.number(at + 1, 1, true));
    if (marker == 0xff) // padding
    {
      ++at;
      continue;
    }
    if (marker == 0xd9)
    {
      file.damaged("it holds no pixels");
    }
    const std::uint64_t length = file.number(at + 2, 2, true);
    if (length < 2)
    {
      file.damaged(fmt::format("the segment at byte {} says it is {} bytes long", at, length));
    }
    if (!file.holds(at + 2, length))
    {
      file.truncated("the JPEG ends before its pixels");
    }
    const std::vector<std::uint8_t> data = file.read(at + 4, length - 2);
    at += 2 + length;
    if (startsFrame(marker))
    {
      readFrame(file, data, result);
    }
    else if (marker == 0xe0)
    {
      readJfif(data, result);
    }
    else if (marker == 0xe1 && data.size() > 6 && std::memcmp(data.data(), "Exif\0\0", 6) == 0)
    {
      const Exif exif = readExif({ data.begin() + 6, data.end() });
      exifSize = exif.size;
      if (exif.orientation != 1)
      {
        result.warnings.push_back(
          fmt::format("the JPEG is to be shown turned or mirrored (Exif orientation {}); it is read as it is stored",
            exif.orientation));
      }
    }
    else if (marker == 0xfe && result.description.empty())
    {
      result.description.assign(data.begin(), data.end());
    }
    else if (marker == 0xda)
    {
      break;
    }
  }
  if (result.width < 1)
  {
    file.damaged("its pixels come before its size");
  }
  if (!hasEnd(file, at))
  {
    file.truncated("the JPEG's end marker is missing, so pixels are");
  }
  checkBytes(file, result, file.size() - at, 5000); // even progressive scans of one grey stay below
  if (!result.size)
  {
    result.size = exifSize;
  }
  return result;
}

} // namespace lamella::micrograph
