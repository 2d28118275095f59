#include "micrograph/Probe.h"
#include "micrograph/TiffDirectory.h"

#include "lattice/Error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <stdexcept>

namespace lamella::micrograph
{
namespace
{

// Tags of TIFF 6.0.
enum Tag
{
  NewSubfileType = 254,
  ImageWidth = 256,
  ImageLength = 257,
  BitsPerSample = 258,
  Compression = 259,
  PhotometricInterpretation = 262,
  ImageDescription = 270,
  StripOffsets = 273,
  Orientation = 274,
  SamplesPerPixel = 277,
  StripByteCounts = 279,
  XResolution = 282,
  YResolution = 283,
  ResolutionUnit = 296,
  TileOffsets = 324,
  TileByteCounts = 325,
  SampleFormat = 339
};

/// Metres in a unit's name as ImageJ and OME write it; 0 for pixels and what is not a length.
double metresIn(std::string unit)
{
  if (unit == "\\u00B5m" || unit == "\u00b5m" || unit == "\u03bcm" ||
    unit == "\xb5m") // escaped, micro sign, mu, Latin-1
  {
    return 1e-6;
  }
  std::transform(unit.begin(), unit.end(), unit.begin(), [](unsigned char c) { return std::tolower(c); });
  static const std::map<std::string, double> names{ { "m", 1 }, { "meter", 1 }, { "cm", 1e-2 }, { "mm", 1e-3 },
    { "um", 1e-6 }, { "micron", 1e-6 }, { "microns", 1e-6 }, { "micrometer", 1e-6 }, { "nm", 1e-9 }, { "pm", 1e-12 },
    { "inch", 0.0254 }, { "in", 0.0254 } };
  const auto found = names.find(unit);
  return found == names.end() ? 0 : found->second;
}

/// The value of `key=value` on a line of its own, as ImageJ writes it.
std::string lineValue(const std::string& text, const std::string& key)
{
  const std::string start = "\n" + key + "=";
  const std::size_t at = ("\n" + text).find(start);
  if (at == std::string::npos)
  {
    return {};
  }
  const std::size_t from = at + start.size() - 1;
  return text.substr(from, text.find('\n', from) - from);
}

/// The value of attribute="value" in OME-XML.
std::string attribute(const std::string& text, const std::string& key)
{
  const std::string start = " " + key + "=\"";
  const std::size_t at = text.find(start);
  if (at == std::string::npos)
  {
    return {};
  }
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
  {
    return std::nullopt;
  }
  MetadataSize size{ x, y, std::nullopt, "OME-XML" };
  if (const double z = length("Z"); z > 0)
  {
    size.z = z;
  }
  return size;
}

/// Resolution tags, in the unit that ImageJ names in the description where the tags themselves name none.
std::optional<MetadataSize> tagSize(const TiffDirectory& page, const std::string& description)
{
  const double x = page.ratio(XResolution);
  const double y = page.has(YResolution) ? page.ratio(YResolution) : x;
  if (!(x > 0) || !(y > 0))
  {
    return std::nullopt;
  }
  if (description.rfind("ImageJ=", 0) == 0)
  {
    const double unit = metresIn(lineValue(description, "unit"));
    if (unit > 0)
    {
      MetadataSize size{ unit / x, unit / y, std::nullopt, "ImageJ" };
      if (const double spacing = numberIn(lineValue(description, "spacing")); spacing > 0)
      {
        size.z = spacing * unit;
      }
      return size;
    }
  }
  const std::uint64_t code = page.value(ResolutionUnit, 2);
  const double unit = code == 2 ? 0.0254 : code == 3 ? 0.01 : 0;
  if (!(unit > 0))
  {
    return std::nullopt;
  }
  return MetadataSize{ unit / x, unit / y, std::nullopt, "TIFF resolution" };
}

struct Page
{
  std::int64_t width, height;
  int bits, channels, format;
  double bytes; ///< of its pixels
  bool whiteIsZero;
};

/// Do all strips or tiles lie inside the file?
void checkData(FileBytes& file, const TiffDirectory& page, std::size_t number, const Page& shape)
{
  const bool tiled = page.has(TileOffsets);
  const std::vector<std::uint64_t> offsets = page.values(tiled ? TileOffsets : StripOffsets);
  const std::vector<std::uint64_t> counts = page.values(tiled ? TileByteCounts : StripByteCounts);
  if (offsets.empty())
  {
    file.damaged(fmt::format("page {} of the TIFF holds no pixels", number + 1));
  }
  if (counts.empty() && !tiled) // allowed in old files: the decoder works them out
  {
    return;
  }
  if (counts.size() != offsets.size())
  {
    file.damaged(fmt::format(
      "page {} of the TIFF has {} pieces and {} sizes of pieces", number + 1, offsets.size(), counts.size()));
  }
  for (std::size_t i = 0; i < offsets.size(); ++i)
  {
    if (!file.holds(offsets[i], counts[i]))
    {
      file.truncated(fmt::format("pixels of page {} of the TIFF lie beyond its end", number + 1));
    }
    if (counts[i] == 0)
    {
      file.damaged(fmt::format("a strip of page {} of the TIFF is empty", number + 1));
    }
  }
  const double held = std::accumulate(counts.begin(), counts.end(), 0.0);
  const std::uint64_t packing = page.value(Compression, 1);
  // Fax codes pack any blank line into a bit; LZW at most 2730 bytes into one.
  const double ratio = packing == 1 ? 1 : packing >= 2 && packing <= 4 ? 1e5 : 3000;
  if (held * ratio + 4096 * (packing != 1) < shape.bytes)
  {
    file.truncated(fmt::format("the {:.0f} bytes of page {} of the TIFF cannot hold {} × {} pixels", held, number + 1,
      shape.width, shape.height));
  }
}

Page readPage(const FileBytes& file, const TiffDirectory& page, std::size_t number, bool anyNumbers)
{
  Page result{};
  result.width = static_cast<std::int64_t>(page.value(ImageWidth, 0));
  result.height = static_cast<std::int64_t>(page.value(ImageLength, 0));
  if (result.width < 1 || result.height < 1)
  {
    file.damaged(fmt::format("page {} of the TIFF holds no pixels", number + 1));
  }
  const std::uint64_t photometric = page.value(PhotometricInterpretation, 99);
  const std::uint64_t bits = page.value(BitsPerSample, 1);
  const std::uint64_t samples = page.value(SamplesPerPixel, 1);
  if (page.values(PhotometricInterpretation).empty() || photometric > 8 || samples < 1 || samples > 4)
  {
    throw InputError(fmt::format("page {} of '{}' has {} values a pixel{}", number + 1, file.name(), samples,
                       photometric <= 8 ? "" : " and does not say what they mean"),
      "save it as an 8-bit grey or RGB picture");
  }
  if (photometric == 5)
  {
    throw InputError(fmt::format("'{}' is a CMYK TIFF, made for printing", file.name()),
      "convert it to grey or RGB first, for example: convert in.tif -colorspace Gray out.png");
  }
  result.format = static_cast<int>(page.value(SampleFormat, 1));
  if (result.format == 3 && !anyNumbers)
  {
    throw InputError(fmt::format("'{}' holds floating-point values of {} bits", file.name(), bits),
      "convert it to 8-bit or 16-bit grey values first");
  }
  if (result.format == 2 && !anyNumbers)
  {
    throw InputError(fmt::format("'{}' holds signed values of {} bits", file.name(), bits),
      "convert it to unsigned 8-bit or 16-bit grey values first");
  }
  const bool wide = anyNumbers && (bits == 32 || bits == 64);
  if (bits != 1 && bits != 4 && bits != 8 && bits != 16 && !wide)
  {
    throw InputError(
      fmt::format("'{}' holds {} bits a value", file.name(), bits), "convert it to 8-bit or 16-bit grey values first");
  }
  result.bytes = std::ceil(static_cast<double>(result.width) * static_cast<double>(samples * bits) / 8) *
    static_cast<double>(result.height);
  result.bits = bits >= 16 ? static_cast<int>(bits) : 8;
  result.channels = photometric == 3 ? 3 : static_cast<int>(std::min<std::uint64_t>(samples, 4));
  result.whiteIsZero = photometric == 0;
  return result;
}

} // namespace

Probe probeTiff(FileBytes& file, bool anyNumbers)
{
  Probe result;
  result.format = Format::Tiff;
  TiffSource source;
  source.read = [&file](std::uint64_t at, std::uint64_t count) { return file.read(at, count); };
  std::uint64_t at = source.open().value_or(0);
  std::set<std::uint64_t> seen;
  try
  {
    for (result.pages = 0; at != 0; ++result.pages)
    {
      if (!seen.insert(at).second)
      {
        file.damaged("its directories run in a circle");
      }
      const TiffDirectory directory(source, at);
      at = directory.next();
      if ((directory.value(NewSubfileType, 0) & 1U) != 0 && !result.slices.empty())
      {
        continue; // a smaller copy of a page
      }
      const Page page = readPage(file, directory, result.pages, anyNumbers);
      checkData(file, directory, result.pages, page);
      if (result.slices.empty())
      {
        result.width = page.width;
        result.height = page.height;
        result.bits = page.bits;
        result.channels = page.channels;
        result.whiteIsZero = page.whiteIsZero;
        result.sampleFormat = page.format;
        result.description = directory.text(ImageDescription);
        result.size = omeSize(result.description);
        if (!result.size)
        {
          result.size = tagSize(directory, result.description);
        }
        if (const std::uint64_t turned = directory.value(Orientation, 1); turned != 1)
        {
          result.warnings.push_back(
            fmt::format("the TIFF is to be shown turned or mirrored (orientation {}); look at the result", turned));
        }
      }
      else if (page.width != result.width || page.height != result.height || page.bits != result.bits ||
        page.format != result.sampleFormat)
      {
        throw InputError(
          fmt::format("page {} of '{}' is {} × {} pixels of {} bits, the first is {} × {} of {}", result.pages + 1,
            file.name(), page.width, page.height, page.bits, result.width, result.height, result.bits),
          "a volume's slices are all alike: write the pages that belong together into a file of their own");
      }
      result.slices.push_back(result.pages);
    }
  }
  catch (const std::length_error&)
  {
    file.damaged("a directory of the TIFF is nonsense");
  }
  if (result.slices.empty())
  {
    file.damaged("the TIFF holds no page");
  }
  return result;
}

Exif readExif(const std::vector<std::uint8_t>& block)
{
  Exif result;
  TiffSource source;
  source.read = [&block](std::uint64_t at, std::uint64_t count)
  {
    if (at > block.size() || count > block.size() - at)
    {
      throw std::out_of_range("Exif");
    }
    const auto from = block.begin() + static_cast<std::ptrdiff_t>(at);
    return std::vector<std::uint8_t>(from, from + static_cast<std::ptrdiff_t>(count));
  };
  try
  {
    if (const auto first = source.open())
    {
      const TiffDirectory directory(source, *first);
      result.orientation = static_cast<int>(directory.value(Orientation, 1));
      result.size = tagSize(directory, {});
      if (result.size)
      {
        result.size->source = "Exif resolution";
      }
    }
  }
  catch (const std::exception&) // a broken Exif block does not make the picture unreadable
  {
    return {};
  }
  return result;
}

void checkBytes(const FileBytes& file, const Probe& probe, std::uint64_t bytes, double ratio)
{
  const double pixels = static_cast<double>(probe.width) * static_cast<double>(probe.height);
  if (pixels * probe.bits / 64 > ratio * static_cast<double>(bytes) + 65536) // one-bit pictures count as 8 bits here
  {
    file.damaged(fmt::format("{} bytes cannot hold the {} × {} pixels it speaks of", bytes, probe.width, probe.height));
  }
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
      break;
  }
  return "TIFF";
}

Probe probe(FileBytes& file, bool anyNumbers)
{
  const std::vector<std::uint8_t> head = file.read(0, std::min<std::uint64_t>(file.size(), 8));
  const auto starts = [&](std::initializer_list<std::uint8_t> bytes)
  { return head.size() >= bytes.size() && std::equal(bytes.begin(), bytes.end(), head.begin()); };
  if (starts({ 0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n' }))
  {
    return probePng(file);
  }
  if (starts({ 0xff, 0xd8, 0xff }))
  {
    return probeJpeg(file);
  }
  if (starts({ 'I', 'I', 42, 0 }) || starts({ 'M', 'M', 0, 42 }) || starts({ 'I', 'I', 43, 0 }) ||
    starts({ 'M', 'M', 0, 43 }))
  {
    return probeTiff(file, anyNumbers);
  }
  if (starts({ 0x1f, 0x8b }))
  {
    throw InputError(
      fmt::format("'{}' is compressed with gzip", file.name()), "unpack it first: gunzip --keep FILE.gz");
  }
  throw InputError(fmt::format("'{}' is not a PNG, JPEG or TIFF picture", file.name()),
    "convert it to PNG, or give a raw volume the ending .raw and its size");
}

} // namespace lamella::micrograph
