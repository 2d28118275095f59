#include "pictures/Probe.h"
#include "pictures/BmpFile.h"
#include "pictures/JpegFile.h"
#include "pictures/NetpbmFile.h"
#include "pictures/PngFile.h"
#include "pictures/TiffFile.h"

#include "core/Error.h"
#include "core/Lower.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <stdexcept>

namespace lamella::micrograph
{
namespace
{

/// The value of `key=value` on a line of its own, as ImageJ writes it.
std::string lineValue(const std::string& text, const std::string& key)
{
  const std::string start = "\n" + key + "=";
  const std::size_t at = ("\n" + text).find(start);
  if (at == std::string::npos)
    return {};
  const std::size_t from = at + start.size() - 1;
  return text.substr(from, text.find('\n', from) - from);
}

/// The value of attribute="value" in OME-XML.
std::string attribute(const std::string& text, const std::string& key)
{
  const std::string start = " " + key + "=\"";
  const std::size_t at = text.find(start);
  if (at == std::string::npos)
    return {};
  const std::size_t from = at + start.size();
  return text.substr(from, text.find('"', from) - from);
}

double numberIn(const std::string& text)
{
  try
  {
    return text.empty() ? 0 : std::stod(text);
  }
  catch (const std::exception&)
  {
    return 0;
  }
}

std::optional<MetadataSize> omeSize(const std::string& text)
{
  const auto length = [&](const std::string& axis)
  {
    const std::string unit = attribute(text, "PhysicalSize" + axis + "Unit");
    return numberIn(attribute(text, "PhysicalSize" + axis)) * (unit.empty() ? 1e-6 : metresIn(unit));
  };
  const double x = length("X");
  const double y = length("Y");
  if (text.find("OME") == std::string::npos || !(x > 0) || !(y > 0))
    return std::nullopt;
  MetadataSize size{ x, y, std::nullopt, "OME-XML" };
  if (const double z = length("Z"); z > 0)
    size.z = z;
  return size;
}

/// Resolution tags, in the unit that ImageJ names in the description where the tags themselves name none.
std::optional<MetadataSize> tagSize(const TiffPage& page)
{
  const auto [x, y] = page.perUnit;
  if (page.description.rfind("ImageJ=", 0) == 0 && x > 0 && y > 0)
  {
    const double unit = metresIn(lineValue(page.description, "unit"));
    if (unit > 0)
    {
      MetadataSize size{ unit / x, unit / y, std::nullopt, "ImageJ" };
      if (const double spacing = numberIn(lineValue(page.description, "spacing")); spacing > 0)
        size.z = spacing * unit;
      return size;
    }
  }
  if (page.pixelSize)
    return MetadataSize{ (*page.pixelSize)[0], (*page.pixelSize)[1], std::nullopt, "TIFF resolution" };
  return std::nullopt;
}

/// Can it become greys or colours?
void checkPage(FileBytes& file, const TiffPage& page, std::size_t number, bool anyNumbers)
{
  if (page.width < 1 || page.height < 1)
    file.damaged(fmt::format("page {} of the TIFF holds no pixels", number + 1));
  const bool known = page.photometric && *page.photometric <= 8;
  if (!known || page.samples < 1 || page.samples > 4)
  {
    throw InputError(fmt::format("page {} of '{}' has {} values a pixel{}", number + 1, file.name(), page.samples,
                       known ? "" : " and does not say what they mean"),
      "save it as an 8-bit grey or RGB picture");
  }
  constexpr int separated = 5;
  if (page.photometric == separated)
  {
    throw InputError(fmt::format("'{}' is a CMYK TIFF, made for printing", file.name()),
      "convert it to grey or RGB first, for example: convert in.tif -colorspace Gray out.png");
  }
  if (page.numbers == static_cast<int>(TiffNumbers::Real) && !anyNumbers)
  {
    throw InputError(fmt::format("'{}' holds floating-point values of {} bits", file.name(), page.bits),
      "convert it to 8-bit or 16-bit grey values first");
  }
  if (page.numbers == static_cast<int>(TiffNumbers::Signed) && !anyNumbers)
  {
    throw InputError(fmt::format("'{}' holds signed values of {} bits", file.name(), page.bits),
      "convert it to unsigned 8-bit or 16-bit grey values first");
  }
  const bool wide = anyNumbers && (page.bits == 32 || page.bits == 64);
  if (page.bits != 1 && page.bits != 4 && page.bits != 8 && page.bits != 16 && !wide)
  {
    throw InputError(fmt::format("'{}' holds {} bits a value", file.name(), page.bits),
      "convert it to 8-bit or 16-bit grey values first");
  }
}

/// Of a channel, as it is decoded.
int bitsOf(const TiffPage& page)
{
  return page.bits >= 16 && page.photometric <= 2 ? page.bits : 8;
}

} // namespace

double metresIn(std::string unit)
{
  if (unit == "\\u00B5m" || unit == "\u00b5m" || unit == "\u03bcm" ||
    unit == "\xb5m") // escaped, micro sign, mu, Latin-1
    return 1e-6;
  unit = lower(unit);
  static const std::map<std::string, double> names{ { "m", 1 }, { "meter", 1 }, { "cm", 1e-2 }, { "mm", 1e-3 },
    { "um", 1e-6 }, { "micron", 1e-6 }, { "microns", 1e-6 }, { "micrometer", 1e-6 }, { "nm", 1e-9 }, { "pm", 1e-12 },
    { "inch", 0.0254 }, { "in", 0.0254 } };
  const auto found = names.find(unit);
  return found == names.end() ? 0 : found->second;
}

Probe probeTiff(FileBytes& file, bool anyNumbers)
{
  Probe result;
  result.format = Format::Tiff;
  result.pages = 0;
  TiffFile tiff(file);
  do
  {
    const TiffPage& page = tiff.page();
    const std::size_t number = result.pages++;
    if (page.smaller && !result.slices.empty())
      continue; // a smaller copy of a page
    checkPage(file, page, number, anyNumbers);
    tiff.check();
    if (result.slices.empty())
    {
      result.width = page.width;
      result.height = page.height;
      result.bits = bitsOf(page);
      result.channels = page.photometric == 3 ? 3 : page.samples;
      result.sampleFormat = page.numbers;
      result.description = page.description;
      result.size = omeSize(page.description);
      if (!result.size)
        result.size = tagSize(page);
      if (page.orientation != 1)
      {
        result.warnings.push_back(fmt::format(
          "the TIFF is to be shown turned or mirrored (orientation {}); it is read as it is stored", page.orientation));
      }
    }
    else if (page.width != result.width || page.height != result.height || bitsOf(page) != result.bits ||
      page.numbers != result.sampleFormat)
    {
      throw InputError(
        fmt::format("page {} of '{}' is {} × {} pixels of {} bits, the first is {} × {} of {}", number + 1, file.name(),
          page.width, page.height, bitsOf(page), result.width, result.height, result.bits),
        "a volume's slices are all alike: write the pages that belong together into a file of their own");
    }
    result.slices.push_back(number);
  } while (tiff.next());
  return result;
}

void undecodable(const FileBytes& file, Format format, const std::string& why)
{
  throw InputError(fmt::format("the pixels of '{}' cannot be decoded: the {} is damaged or of a rare kind{}",
                     file.name(), name(format), why.empty() ? "" : " (" + why + ")"),
    "save it again as an 8-bit grey PNG");
}

void checkBytes(const FileBytes& file, const Probe& probe, std::uint64_t bytes, double ratio)
{
  const double pixels = static_cast<double>(probe.width) * static_cast<double>(probe.height);
  if (pixels * probe.bits / 64 > ratio * static_cast<double>(bytes) + 65536) // one-bit pictures count as 8 bits here
    file.damaged(fmt::format("{} bytes cannot hold the {} × {} pixels it speaks of", bytes, probe.width, probe.height));
}

const char* name(Format format) noexcept
{
  switch (format)
  {
    case Format::Png:
      return "PNG";
    case Format::Jpeg:
      return "JPEG";
    case Format::Tiff:
      return "TIFF";
    case Format::Pgm:
      return "PGM";
    case Format::Ppm:
      return "PPM";
    case Format::Bmp:
      break;
  }
  return "BMP";
}

Probe probe(FileBytes& file, bool anyNumbers)
{
  const std::vector<std::uint8_t> head = file.read(0, std::min<std::uint64_t>(file.size(), 8));
  const auto starts = [&](std::initializer_list<std::uint8_t> bytes)
  { return head.size() >= bytes.size() && std::equal(bytes.begin(), bytes.end(), head.begin()); };
  if (starts({ 0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n' }))
    return probePng(file);
  if (starts({ 0xff, 0xd8, 0xff }))
    return probeJpeg(file);
  if (starts({ 'I', 'I', 42, 0 }) || starts({ 'M', 'M', 0, 42 }) || starts({ 'I', 'I', 43, 0 }) ||
    starts({ 'M', 'M', 0, 43 }))
    return probeTiff(file, anyNumbers);
  if (isNetpbm(head))
    return probeNetpbm(file);
  if (starts({ 'B', 'M' }))
    return probeBmp(file);
  if (starts({ 0x1f, 0x8b }))
    throw InputError(fmt::format("'{}' is compressed with gzip", file.name()), "unpack it first: gunzip -k FILE.gz");
  throw InputError(fmt::format("'{}' is not a PNG, JPEG, TIFF, PGM, PPM or BMP picture", file.name()),
    "convert it to PNG, or give a raw volume the ending .raw and its size");
}

} // namespace lamella::micrograph
