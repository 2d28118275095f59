#include "micrograph/Picture.h"

#include "micrograph/Decode.h"
#include "micrograph/Slices.h"

#include "lattice/Error.h"
#include "lattice/Memory.h"
#include "lattice/Plausible.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <regex>

namespace lamella::micrograph
{
namespace
{

namespace fs = std::filesystem;

// Limits of the decoders.
constexpr std::int64_t longestSide = std::int64_t{ 1 } << 20;
constexpr std::int64_t mostPixels = std::int64_t{ 1 } << 30;
// Larger "pixels" come from resolutions meant for printers: 1200 dots an inch are 21 µm.
constexpr double largestPixel = 20e-6;

std::string micrometres(double metres)
{
  return fmt::format("{:.4g} µm", metres * 1e6);
}

void needMemory(const std::string& name, double bytes)
{
  const auto available = static_cast<double>(availableMemory());
  if (bytes > available)
  {
    throw MemoryError(
      fmt::format("reading '{}' takes {}, and {} are free", name, bytesText(bytes), bytesText(available)),
      "cut out a part of it first");
  }
}

/// Sets the lattice, with the spacing that the option or the file says.
void setLattice(Picture& picture, const std::string& name, std::int64_t nx, std::int64_t ny, std::int64_t nz,
  int dimension, const std::optional<MetadataSize>& said, const ReadOptions& options)
{
  double spacing = 1;
  picture.pixelSizeSource = "none";
  if (options.pixelSize)
  {
    spacing = *options.pixelSize;
    picture.pixelSizeSource = "option";
  }
  else if (const auto size = trustedSize(said, name, picture.warnings))
  {
    if (std::abs(size->x - size->y) > 1e-3 * size->x)
    {
      throw InputError(fmt::format("the pixels of '{}' are not square: {} says {} by {}", name, size->source,
                         micrometres(size->x), micrometres(size->y)),
        "resample it to square pixels or, if that is wrong, give the size with --pixel-size METRES");
    }
    else if (dimension == 3 && size->z && std::abs(size->x - *size->z) > 1e-2 * size->x)
    {
      throw InputError(fmt::format("the voxels of '{}' are not cubes: {} says {} across and {} between slices", name,
                         size->source, micrometres(size->x), micrometres(*size->z)),
        "resample it to cubes or, if that is wrong, give the size with --pixel-size METRES");
    }
    else
    {
      spacing = size->x;
      picture.pixelSizeSource = size->source;
    }
  }
  picture.lattice = makeLattice(nx, ny, nz, dimension, spacing);
  picture.fileSize = picture.lattice.size;
  if (options.sizeKnown)
  {
    options.sizeKnown(picture.lattice);
  }
}

/// The box of nodes that is kept, as memory counts.
struct Box
{
  std::array<std::int64_t, 3> start{ 0, 0, 0 };
  std::array<std::int64_t, 3> size{ 1, 1, 1 };

  [[nodiscard]] std::int64_t count() const { return size[0] * size[1] * size[2]; }
};

Box keptBox(const Lattice& whole, const std::optional<Window>& window)
{
  if (!window)
  {
    return { { 0, 0, 0 }, whole.size };
  }
  return { firstNode(whole, *window),
    { window->size[0], window->size[1], whole.dimension == 2 ? 1 : window->size[2] } };
}

void setSize(Lattice& lattice, const std::array<std::int64_t, 3>& size)
{
  lattice = makeLattice(size[0], size[1], size[2], lattice.dimension, lattice.spacing);
}

void checkSize(const FileBytes& file, const Probe& probe)
{
  if (probe.width > longestSide || probe.height > longestSide || probe.width > mostPixels / probe.height)
  {
    throw InputError(fmt::format("'{}' is {} × {} pixels, more than {} along a side or {} in all", file.name(),
                       probe.width, probe.height, longestSide, mostPixels),
      "cut it into parts, or save it as a raw volume of one slice");
  }
}

void addSeen(Picture& picture, const std::string& name, const Decoded& seen, const ReadOptions& options)
{
  if (seen.colour && !options.keepColour)
  {
    throw InputError(
      fmt::format("'{}' is a colour picture: pixel {}, {} from the top left is red {}, green {}, blue {}", name,
        seen.colourX, seen.colourY, seen.firstColour[0], seen.firstColour[1], seen.firstColour[2]),
      "convert it to grey values, or let --segment find lumens and walls in it");
  }
  if (seen.transparent)
  {
    picture.warnings.push_back(fmt::format("'{}' has transparent parts; they are read as the colour they hold", name));
  }
}

Picture readFile(const fs::path& path, const ReadOptions& options)
{
  FileBytes file(path);
  Probe probed = probe(file);
  checkSize(file, probed);
  Picture picture;
  picture.format = name(probed.format);
  picture.bits = probed.bits;
  const auto slices = static_cast<std::int64_t>(std::max<std::size_t>(1, probed.slices.size()));
  const bool colour = options.keepColour && probed.channels > 1;
  const auto nodes = static_cast<std::size_t>(probed.width * probed.height * slices);
  setLattice(picture, file.name(), probed.width, probed.height, slices, slices > 1 ? 3 : 2, probed.size, options);
  needMemory(file.name(), static_cast<double>(nodes) * (colour ? 8 : 2));
  picture.grey.resize(nodes);
  picture.colour.resize(colour ? 3 * nodes : 0);
  const Decoded seen = decode(file, probed, slices == 1, picture.grey.data(), colour ? picture.colour.data() : nullptr);
  picture.description = probed.description;
  picture.provenance = probed.provenance;
  picture.warnings.insert(picture.warnings.begin(), probed.warnings.begin(), probed.warnings.end());
  addSeen(picture, file.name(), seen, options);
  if (!seen.colour)
  {
    picture.colour = {};
  }
  if (probed.format == Format::Jpeg && !options.keepColour)
  {
    picture.warnings.push_back(
      fmt::format("'{}' is a JPEG, which blurs greys: a label picture should be a PNG or TIFF, a scan needs --segment",
        file.name()));
  }
  if (options.window)
  {
    crop(picture, *options.window);
  }
  return picture;
}

Picture readSlices(const fs::path& path, const ReadOptions& options)
{
  const Slices slices = listSlices(path);
  Picture picture;
  picture.warnings = slices.warnings;
  const auto count = static_cast<std::int64_t>(slices.files.size());
  Probe first;
  Box kept;
  std::vector<std::uint16_t> whole; // slice, where a window is cut out of it
  for (std::int64_t z = 0; z < count; ++z)
  {
    FileBytes file(slices.files[static_cast<std::size_t>(z)]);
    Probe probed = probe(file);
    checkSize(file, probed);
    if (probed.slices.size() > 1)
    {
      throw InputError(
        fmt::format("'{}' holds {} pages, but is one of several slices", file.name(), probed.slices.size()),
        "name the file itself to read its pages as a volume");
    }
    if (z == 0)
    {
      first = probed;
      picture.format = name(probed.format);
      picture.bits = probed.bits;
      picture.description = probed.description;
      picture.warnings.insert(picture.warnings.end(), probed.warnings.begin(), probed.warnings.end());
      setLattice(picture, path.string(), probed.width, probed.height, count, 3, probed.size, options);
      kept = keptBox(picture.lattice, options.window);
      needMemory(path.string(), 2.0 * static_cast<double>(kept.count()));
      setSize(picture.lattice, kept.size);
      picture.grey.resize(static_cast<std::size_t>(kept.count()));
      whole.resize(options.window ? static_cast<std::size_t>(probed.width * probed.height) : 0);
    }
    else if (probed.width != first.width || probed.height != first.height || probed.bits != first.bits)
    {
      throw InputError(fmt::format("'{}' is {} × {} pixels of {} bits, the first slice is {} × {} of {}", file.name(),
                         probed.width, probed.height, probed.bits, first.width, first.height, first.bits),
        "a volume's slices are all alike: leave out what does not belong to it");
    }
    if (z < kept.start[2] || z >= kept.start[2] + kept.size[2])
    {
      continue;
    }
    ReadOptions strict = options;
    strict.keepColour = false; // a volume of colours has no use here
    Picture ignored;
    std::uint16_t* to = picture.grey.data() + (z - kept.start[2]) * kept.size[0] * kept.size[1];
    addSeen(z == kept.start[2] ? picture : ignored, file.name(),
      decode(file, probed, false, options.window ? whole.data() : to, nullptr), strict);
    for (std::int64_t y = 0; options.window && y < kept.size[1]; ++y)
    {
      to = std::copy_n(whole.data() + (kept.start[1] + y) * first.width + kept.start[0], kept.size[0], to);
    }
  }
  return picture;
}

/// Size and depth of a raw volume as its name says them.
struct RawName
{
  std::optional<std::array<std::int64_t, 3>> size;
  std::optional<int> bits;
};

RawName readName(const std::string& name)
{
  RawName result;
  static const std::regex size("(^|[^0-9])([0-9]{1,6})[xX]([0-9]{1,6})[xX]([0-9]{1,6})([^0-9]|$)");
  static const std::regex bits("(^|[^A-Za-z0-9])(u|uint|U|UINT)(8|16)([^0-9]|$)|(^|[^0-9])(8|16)[-_]?[bB]its?");
  std::smatch match;
  if (std::regex_search(name, match, size))
  {
    result.size = { std::stoll(match[2]), std::stoll(match[3]), std::stoll(match[4]) };
  }
  if (std::regex_search(name, match, bits))
  {
    result.bits = std::stoi(match[3].matched ? match[3] : match[6]);
  }
  return result;
}

Picture readRaw(const fs::path& path, const ReadOptions& options)
{
  FileBytes file(path);
  const RawName said = readName(path.filename().string());
  const auto size = options.rawSize ? options.rawSize : said.size;
  if (!size)
  {
    throw InputError(fmt::format("the size of the raw volume '{}' is not known", file.name()),
      "give it with --raw-size NX,NY,NZ, or put it into the name, such as berea_200x200x200_u8.raw");
  }
  const auto [nx, ny, nz] = *size;
  for (const std::int64_t nodes : *size)
  {
    if (nodes < 1 || nodes > longestSide)
    {
      throw ParameterError(fmt::format("a raw volume of {} × {} × {} voxels", nx, ny, nz),
        fmt::format("give 1 to {} voxels along each axis", longestSide));
    }
  }
  const double voxels = static_cast<double>(nx) * static_cast<double>(ny) * static_cast<double>(nz);
  const std::uint64_t data = file.size() > options.rawHeader ? file.size() - options.rawHeader : 0;
  std::optional<int> bits = options.rawBits ? options.rawBits : said.bits;
  if (!bits)
  {
    bits = static_cast<double>(data) == 2 * voxels ? 16 : 8;
  }
  if (*bits != 8 && *bits != 16)
  {
    throw ParameterError(fmt::format("a raw volume of {} bits a voxel", *bits), "choose 8 or 16");
  }
  const int voxelBytes = *bits / 8;
  const double expected = voxels * voxelBytes;
  if (static_cast<double>(data) != expected)
  {
    throw InputError(fmt::format("'{}' has {} bytes{}, but {} × {} × {} voxels of {} bits take {:.0f}", file.name(),
                       data, options.rawHeader > 0 ? " after its header" : "", nx, ny, nz, *bits, expected),
      "check --raw-size, --raw-bits and --raw-header; a file that is too short was truncated");
  }
  Picture picture;
  picture.format = "raw";
  picture.bits = *bits;
  setLattice(picture, file.name(), nx, ny, nz, 3, std::nullopt, options);
  const Lattice whole = picture.lattice;
  const Box kept = keptBox(whole, options.window);
  needMemory(file.name(), 2 * static_cast<double>(kept.count()));
  setSize(picture.lattice, kept.size);
  picture.grey.resize(static_cast<std::size_t>(kept.count()));

  // Runs of voxels that lie together in the file and in the picture: rows, planes or all of it, in pieces.
  const bool rows = kept.size[0] == nx;
  const bool planes = rows && kept.size[1] == ny;
  const std::int64_t run = planes ? kept.count() : rows ? kept.size[0] * kept.size[1] : kept.size[0];
  constexpr std::int64_t piece = std::int64_t{ 1 } << 20;
  const auto bytesEach = static_cast<std::uint64_t>(*bits / 8);
  std::uint16_t* to = picture.grey.data();
  for (std::int64_t r = 0; r < kept.count() / run; ++r)
  {
    const std::int64_t y = rows ? 0 : r % kept.size[1];
    const std::int64_t z = rows ? r : r / kept.size[1];
    const std::int64_t from = whole.index(kept.start[0], kept.start[1] + y, kept.start[2] + z);
    for (std::int64_t at = 0; at < run; at += piece)
    {
      const auto count = static_cast<std::uint64_t>(std::min(piece, run - at));
      const std::vector<std::uint8_t> bytes =
        file.read(options.rawHeader + static_cast<std::uint64_t>(from + at) * bytesEach, count * bytesEach);
      if (*bits == 8)
      {
        to = std::copy(bytes.begin(), bytes.end(), to);
        continue;
      }
      for (std::size_t i = 0; i + 1 < bytes.size(); i += 2)
      {
        *to++ = static_cast<std::uint16_t>(numberFrom(bytes.data() + i, 2, options.rawBigEndian));
      }
    }
  }
  return picture;
}

bool isRaw(const fs::path& path, const ReadOptions& options)
{
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  return ending == ".raw" || ending == ".bin" || options.rawSize.has_value();
}

} // namespace

std::optional<MetadataSize> trustedSize(
  const std::optional<MetadataSize>& size, const std::string& name, std::vector<std::string>& warnings)
{
  if (!size)
  {
    return std::nullopt;
  }
  const bool forPrint = size->source != "ImageJ" && size->source != "OME-XML";
  if (forPrint && std::max(size->x, size->y) > largestPixel)
  {
    warnings.push_back(fmt::format("{} of '{}' says {:.4g} dots an inch, pixels of {}: left out, as that is a "
                                   "printer's resolution, not a microscope's",
      size->source, name, 0.0254 / size->x, micrometres(size->x)));
    return std::nullopt;
  }
  if (std::min(size->x, size->y) < 1e-10)
  {
    warnings.push_back(
      fmt::format("{} of '{}' says pixels of {:.3g} m: left out", size->source, name, std::min(size->x, size->y)));
    return std::nullopt;
  }
  return size;
}

void crop(Picture& picture, const Window& window)
{
  const Lattice from = picture.lattice;
  const Box kept = keptBox(from, window);
  setSize(picture.lattice, kept.size);
  const auto cut = [&](std::vector<std::uint16_t>& values, std::int64_t each)
  {
    // Rows move towards the front only, so that they can be moved in place.
    auto to = values.begin();
    for (std::int64_t z = 0; z < kept.size[2]; ++z)
    {
      for (std::int64_t y = 0; y < kept.size[1]; ++y)
      {
        const std::int64_t row = from.index(kept.start[0], kept.start[1] + y, kept.start[2] + z);
        to = std::copy_n(values.begin() + each * row, each * kept.size[0], to);
      }
    }
    values.erase(to, values.end());
    values.shrink_to_fit();
  };
  cut(picture.grey, 1);
  if (!picture.colour.empty())
  {
    cut(picture.colour, 3);
  }
}

Picture readPicture(const fs::path& path, const ReadOptions& options)
{
  if (options.pixelSize && !(*options.pixelSize > 0 && plausible(*options.pixelSize)))
  {
    throw ParameterError(fmt::format("a pixel size of {} m", *options.pixelSize), "give it in metres, such as 0.5e-6");
  }
  std::error_code ignored;
  if (fs::is_directory(path, ignored) || isSlicePattern(path))
  {
    return readSlices(path, options);
  }
  return isRaw(path, options) ? readRaw(path, options) : readFile(path, options);
}

} // namespace lamella::micrograph
