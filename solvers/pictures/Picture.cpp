#include "pictures/Picture.h"

#include "pictures/Decode.h"
#include "pictures/RawVolume.h"
#include "pictures/Slices.h"

#include "core/Error.h"
#include "core/Lower.h"
#include "core/Memory.h"
#include "core/Plausible.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <type_traits>

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
  std::array<double, 3> aspect = picture.lattice.aspect;
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
        "resample it to square pixels or, if that is wrong, give the pixel size in metres");
    }
    spacing = size->x;
    picture.pixelSizeSource = size->source;
    if (dimension == 3 && size->z && std::abs(size->x - *size->z) > 1e-2 * size->x)
      aspect[2] = *size->z / size->x;
  }
  if (options.sliceDistance && dimension == 3)
  {
    if (picture.pixelSizeSource == "none")
      throw ParameterError(
        fmt::format("a distance of slices of {} and no pixel size", micrometres(*options.sliceDistance)),
        "give the pixel size, too: it says how far apart nodes are within a slice");
    aspect[2] = *options.sliceDistance / spacing;
  }
  picture.lattice = makeLattice(nx, ny, nz, dimension, spacing, aspect);
  picture.fileSize = picture.lattice.size;
  if (options.sizeKnown)
    options.sizeKnown(picture.lattice);
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
    return { { 0, 0, 0 }, whole.size };
  return { firstNode(whole, *window),
    { window->size[0], window->size[1], whole.dimension == 2 ? 1 : window->size[2] } };
}

void setSize(Lattice& lattice, const std::array<std::int64_t, 3>& size)
{
  lattice = makeLattice(size[0], size[1], size[2], lattice.dimension, lattice.spacing, lattice.aspect);
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
      "convert it to grey values, or segment it: lumens and walls are found in it");
  }
  if (seen.transparent)
    picture.warnings.push_back(fmt::format("'{}' has transparent parts; they are read as the colour they hold", name));
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
    picture.colour = {};
  if (probed.format == Format::Jpeg && !options.keepColour)
  {
    picture.warnings.push_back(fmt::format(
      "'{}' is a JPEG, which blurs greys: a label picture should be a PNG or TIFF, a scan is to be segmented",
      file.name()));
  }
  if (options.window)
    crop(picture, *options.window);
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
      continue;
    ReadOptions strict = options;
    strict.keepColour = false; // a volume of colours has no use here
    Picture ignored;
    std::uint16_t* to = picture.grey.data() + (z - kept.start[2]) * kept.size[0] * kept.size[1];
    addSeen(z == kept.start[2] ? picture : ignored, file.name(),
      decode(file, probed, false, options.window ? whole.data() : to, nullptr), strict);
    for (std::int64_t y = 0; options.window && y < kept.size[1]; ++y)
      to = std::copy_n(whole.data() + (kept.start[1] + y) * first.width + kept.start[0], kept.size[0], to);
  }
  return picture;
}

/// What a header says of the size of a voxel; of a raw file nothing.
std::optional<MetadataSize> sizeIn(const RawLayout& layout, Picture& picture)
{
  if (layout.pixelSizeSource == "none")
    return std::nullopt;
  const auto& s = layout.spacing;
  if (!layout.unitTold && std::max(s[0], s[1]) > largestPixel)
  {
    picture.warnings.push_back(fmt::format("'{}' names no unit, and in metres its voxels would be {} large: left out; "
                                           "give the pixel size",
      layout.file.string(), micrometres(s[0])));
    if (layout.size[2] > 1 && std::abs(s[0] - s[1]) <= 1e-3 * s[0] && std::abs(s[2] - s[0]) > 1e-2 * s[0])
      picture.lattice.aspect[2] = s[2] / s[0]; // a ratio has no unit
    return std::nullopt;
  }
  if (layout.direction != RawLayout().direction)
  {
    picture.warnings.push_back(
      fmt::format("the axes of '{}' are turned or mirrored; it is read as it is stored", layout.file.string()));
  }
  return MetadataSize{ s[0], s[1], s[2], layout.pixelSizeSource };
}

RawLayout layoutOf(const fs::path& path, const ReadOptions& options, RawHeader header)
{
  if (header != RawHeader::None)
    return headerLayout(path, header);
  RawSaid said;
  said.size = options.rawSize;
  said.offset = options.rawHeader;
  said.bigEndian = options.rawBigEndian;
  said.otherwise = NumberType{};
  if (options.rawBits)
  {
    if (*options.rawBits != 8 && *options.rawBits != 16)
      throw ParameterError(fmt::format("a raw volume of {} bits a voxel", *options.rawBits), "choose 8 or 16");
    said.type = NumberType{ 'u', *options.rawBits / 8 };
  }
  return rawLayout(path, said);
}

/// Numbers of a file become greys, if they are some, or levels.
template <typename Value>
void toGreys(const std::vector<std::uint8_t>& bytes, std::uint16_t* to, const std::string& name,
  const std::optional<GreyBins>& levels)
{
  constexpr auto most = static_cast<double>(std::numeric_limits<std::uint16_t>::max());
  const auto* const from = reinterpret_cast<const Value*>(bytes.data());
  if constexpr (std::is_unsigned_v<Value> && sizeof(Value) <= 2)
  {
    std::copy_n(from, bytes.size() / sizeof(Value), to);
    return;
  }
  if (levels)
  {
    for (std::size_t i = 0; i < bytes.size() / sizeof(Value); ++i)
    {
      const auto value = static_cast<double>(from[i]);
      if (std::isnan(value))
        throw InputError(fmt::format("'{}' holds values that are no numbers", name), "give every voxel a grey");
      to[i] = levels->of(value);
    }
    return;
  }
  for (std::size_t i = 0; i < bytes.size() / sizeof(Value); ++i)
  {
    const auto value = static_cast<double>(from[i]); // whole numbers up to 65535 stay what they are
    if (!(value >= 0 && value <= most) || value != std::floor(value))
    {
      throw InputError(
        fmt::format("'{}' holds {}; grey values and phases are whole numbers from 0 to 65535", name, value),
        "map its values to greys first: convert it to a TIFF of type u16, with the range of its values");
    }
    to[i] = static_cast<std::uint16_t>(value);
  }
}

void toGreys(NumberType type, const std::vector<std::uint8_t>& bytes, std::uint16_t* to, const std::string& name,
  const std::optional<GreyBins>& levels)
{
  const auto as = [&](auto value) { toGreys<decltype(value)>(bytes, to, name, levels); };
  const bool plus = type.kind == 'u';
  const bool real = type.kind == 'f';
  switch (type.bytes)
  {
    case 1:
      return plus ? as(std::uint8_t{}) : as(std::int8_t{});
    case 2:
      return plus ? as(std::uint16_t{}) : as(std::int16_t{});
    case 4:
      return plus ? as(std::uint32_t{}) : real ? as(float{}) : as(std::int32_t{});
    default:
      return plus ? as(std::uint64_t{}) : real ? as(double{}) : as(std::int64_t{});
  }
}

/// Bytes of the part that is kept go to `take`, in the order of the file and in pieces.
void readKept(RawVolume& volume, const Box& kept, const std::function<void(const std::vector<std::uint8_t>&)>& take)
{
  const RawLayout& layout = volume.layout();
  const auto each = static_cast<std::size_t>(layout.type.bytes * layout.components);
  const std::int64_t nx = layout.size[0];
  std::vector<std::uint8_t> bytes;
  if (layout.packed)
  {
    bytes.resize(volume.bytes());
    std::vector<std::uint8_t> part(each * static_cast<std::size_t>(kept.size[0] * kept.size[1]));
    for (std::int64_t z = kept.start[2]; z < kept.start[2] + kept.size[2]; ++z)
    {
      volume.read(z, z, bytes.data());
      auto to = part.begin();
      for (std::int64_t y = kept.start[1]; y < kept.start[1] + kept.size[1]; ++y)
      {
        const auto from = static_cast<std::ptrdiff_t>(each) * (kept.start[0] + nx * y);
        to = std::copy_n(bytes.begin() + from, static_cast<std::ptrdiff_t>(each) * kept.size[0], to);
      }
      take(part);
    }
    return;
  }
  // Runs of voxels that lie together in the file and in the picture: rows, planes or all of it, in pieces.
  const bool rows = kept.size[0] == nx;
  const bool planes = rows && kept.size[1] == layout.size[1];
  const std::int64_t run = planes ? kept.count() : rows ? kept.size[0] * kept.size[1] : kept.size[0];
  constexpr std::int64_t piece = std::int64_t{ 1 } << 20;
  for (std::int64_t r = 0; r < kept.count() / run; ++r)
  {
    const std::int64_t y = rows ? 0 : r % kept.size[1];
    const std::int64_t z = rows ? r : r / kept.size[1];
    for (std::int64_t at = 0; at < run; at += piece)
    {
      const auto count = static_cast<std::uint64_t>(std::min(piece, run - at));
      bytes.resize(each * count);
      volume.readRun({ kept.start[0] + at, kept.start[1] + y, kept.start[2] + z }, count, bytes.data());
      take(bytes);
    }
  }
}

Picture readRaw(const fs::path& path, const ReadOptions& options)
{
  const RawHeader header = options.rawSize ? RawHeader::None : rawHeader(path);
  const RawLayout layout = layoutOf(path, options, header);
  const auto [nx, ny, nz] = layout.size;
  for (const std::int64_t nodes : layout.size)
  {
    if (nodes >= 1 && nodes <= longestSide)
      continue;
    const std::string limits = fmt::format("1 to {} voxels along each axis", longestSide);
    if (header != RawHeader::None)
      throw InputError(
        fmt::format("'{}' says that it has {} × {} × {} voxels", path.string(), nx, ny, nz), limits + " can be read");
    throw ParameterError(fmt::format("a raw volume of {} × {} × {} voxels", nx, ny, nz), "give " + limits);
  }
  const bool coloured = layout.components == 3 && layout.type.kind == 'u' && layout.type.bytes <= 2;
  if (layout.components != 1 && !coloured)
  {
    throw InputError(
      fmt::format("'{}' holds {} values of {} a voxel", path.string(), layout.components, layout.type.name()),
      "save it as grey values, one a voxel");
  }
  RawVolume volume(layout);
  const std::string name = layout.file.string();
  Picture picture;
  picture.format = micrograph::name(header);
  setLattice(picture, path.string(), nx, ny, nz, nz == 1 && layout.axes < 3 ? 2 : 3, sizeIn(layout, picture), options);
  const Box kept = keptBox(picture.lattice, options.window);
  const auto nodes = static_cast<std::size_t>(kept.count());
  const bool colour = coloured && options.keepColour;
  needMemory(path.string(),
    static_cast<double>(nodes) * (colour ? 8 : 2) + (layout.packed ? 2 * static_cast<double>(volume.bytes()) : 0));
  setSize(picture.lattice, kept.size);
  picture.grey.resize(nodes);
  picture.colour.resize(colour ? 3 * nodes : 0);
  std::size_t at = 0;
  Decoded seen;
  readKept(volume, kept,
    [&](const std::vector<std::uint8_t>& bytes)
    {
      const std::size_t count = bytes.size() / static_cast<std::size_t>(layout.components * layout.type.bytes);
      if (coloured)
      {
        const Pixels pixels{ static_cast<std::int64_t>(count), 1, 3, 8 * layout.type.bytes, bytes };
        convert(pixels, false, picture.grey.data() + at, colour ? picture.colour.data() + 3 * at : nullptr, seen);
      }
      else
      {
        toGreys(layout.type, bytes, picture.grey.data() + at, name, options.levels);
      }
      at += count;
    });
  addSeen(picture, name, seen, options);
  if (!seen.colour)
    picture.colour = {};
  const bool usual = layout.type.kind == 'u' && layout.type.bytes <= 2;
  if (!usual)
    picture.levels = options.levels;
  const bool small = !usual && std::ranges::all_of(picture.grey, [](std::uint16_t grey) { return grey < 256; });
  picture.bits = usual ? 8 * layout.type.bytes : small ? 8 : 16;
  return picture;
}

bool isRaw(const fs::path& path, const ReadOptions& options)
{
  const std::string ending = endingOf(path);
  return ending == ".raw" || ending == ".bin" || options.rawSize.has_value() || rawHeader(path) != RawHeader::None;
}

} // namespace

std::optional<MetadataSize> trustedSize(
  const std::optional<MetadataSize>& size, const std::string& name, std::vector<std::string>& warnings)
{
  if (!size)
    return std::nullopt;
  static const std::set<std::string> lengths{ "ImageJ", "OME-XML", "MetaImage ElementSpacing", "NRRD spacings",
    "NRRD space directions", "NIfTI pixdim", "VTK SPACING" };
  const bool forPrint = !lengths.contains(size->source);
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
    cut(picture.colour, 3);
}

Picture readPicture(const fs::path& path, const ReadOptions& options)
{
  if (options.pixelSize && !(*options.pixelSize > 0 && plausible(*options.pixelSize)))
    throw ParameterError(fmt::format("a pixel size of {} m", *options.pixelSize), "give it in metres, such as 0.5e-6");
  std::error_code ignored;
  if (fs::is_directory(path, ignored) || isSlicePattern(path))
    return readSlices(path, options);
  return isRaw(path, options) ? readRaw(path, options) : readFile(path, options);
}

} // namespace lamella::micrograph
