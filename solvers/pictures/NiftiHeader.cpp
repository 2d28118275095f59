#include "pictures/RawVolume.h"

#include "core/Error.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <map>

// The fields of NIfTI-1 (348 bytes) and NIfTI-2 (540 bytes): https://nifti.nimh.nih.gov
namespace lamella::micrograph
{

namespace
{

namespace fs = std::filesystem;

constexpr std::size_t largestHeader = 540;

struct NiftiBytes
{
  std::vector<std::uint8_t> bytes;
  bool packed = false;
};

/// The first bytes of a file, unpacked.
NiftiBytes firstBytes(FileBytes& file)
{
  NiftiBytes head{ file.read(0, std::min<std::uint64_t>(file.size(), 1 << 14)) };
  if (head.bytes.size() < 2 || head.bytes[0] != 0x1f || head.bytes[1] != 0x8b)
    return head;
  head.packed = true;
  std::vector<std::uint8_t> unpacked(largestHeader);
  z_stream stream{};
  if (inflateInit2(&stream, 47) != Z_OK)
    throw MemoryError("zlib cannot be started", "close other programs");
  stream.next_in = head.bytes.data();
  stream.avail_in = static_cast<unsigned>(head.bytes.size());
  stream.next_out = unpacked.data();
  stream.avail_out = static_cast<unsigned>(unpacked.size());
  (void)inflate(&stream, Z_SYNC_FLUSH); // what comes of damaged ones is too short
  unpacked.resize(unpacked.size() - stream.avail_out);
  inflateEnd(&stream);
  head.bytes = std::move(unpacked);
  return head;
}

/// A header's fields, of either version.
class NiftiFields
{
public:
  explicit NiftiFields(std::vector<std::uint8_t> bytes)
    : bytes_(std::move(bytes))
  {
    for (const bool big : { false, true })
    {
      const std::uint64_t size = bytes_.size() < 4 ? 0 : numberFrom(bytes_.data(), 4, big);
      if ((size == 348 || size == 540) && bytes_.size() >= size)
      {
        big_ = big;
        second_ = size == 540;
        const auto* const magic = reinterpret_cast<const char*>(bytes_.data()) + (second_ ? 4 : 344);
        magic_ = std::string(magic, 3);
        known_ = (magic_[0] == 'n') && (magic_[1] == '+' || magic_[1] == 'i') && (magic_[2] == (second_ ? '2' : '1'));
      }
    }
  }

  [[nodiscard]] bool known() const { return known_; }
  [[nodiscard]] bool bigEndian() const { return big_; }
  [[nodiscard]] bool second() const { return second_; }
  [[nodiscard]] bool pair() const { return magic_[1] == 'i'; }

  /// A field by where it lies in version 1 and in version 2, the i-th number of it.
  [[nodiscard]] std::int64_t whole(
    std::size_t first, int bytes1, std::size_t second, int bytes2, std::size_t i = 0) const
  {
    const int bytes = second_ ? bytes2 : bytes1;
    const std::uint64_t value =
      numberFrom(bytes_.data() + (second_ ? second : first) + i * static_cast<std::size_t>(bytes), bytes, big_);
    const int unused = 64 - 8 * bytes;
    return static_cast<std::int64_t>(value << unused) >> unused;
  }
  /// 4 bytes in version 1, 8 in version 2. 0.002 in single precision is 0.002, as it was written.
  [[nodiscard]] double real(std::size_t first, std::size_t second, std::size_t i = 0) const
  {
    const std::uint64_t bits =
      numberFrom(bytes_.data() + (second_ ? second + 8 * i : first + 4 * i), second_ ? 8 : 4, big_);
    if (second_)
      return std::bit_cast<double>(bits);
    std::array<char, 32> text{};
    std::to_chars(text.data(), text.data() + text.size(), std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
    return std::strtod(text.data(), nullptr);
  }

private:
  std::vector<std::uint8_t> bytes_;
  std::string magic_ = "   ";
  bool known_ = false;
  bool big_ = false;
  bool second_ = false;
};

/// Place and direction of the axes, by a matrix or a rotation; as they lie in memory where there is neither.
void setPlace(RawLayout& layout, const NiftiFields& fields, double metres)
{
  std::array<double, 9> axes{ 1, 0, 0, 0, 1, 0, 0, 0, 1 };
  if (fields.whole(254, 2, 348, 4) > 0)
  {
    for (std::size_t row = 0; row < 3; ++row)
    {
      for (std::size_t axis = 0; axis < 3; ++axis)
        axes[3 * row + axis] = fields.real(280 + 16 * row, 400 + 32 * row, axis);
      layout.origin[row] = metres * fields.real(280 + 16 * row, 400 + 32 * row, 3);
    }
  }
  else if (fields.whole(252, 2, 344, 4) > 0)
  {
    const double b = fields.real(256, 352, 0);
    const double c = fields.real(256, 352, 1);
    const double d = fields.real(256, 352, 2);
    const double a = std::sqrt(std::max(0.0, 1 - b * b - c * c - d * d));
    const double hand = fields.real(76, 104, 0) < 0 ? -1 : 1;
    axes = { a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * hand * (b * d + a * c), 2 * (b * c + a * d),
      a * a + c * c - b * b - d * d, 2 * hand * (c * d - a * b), 2 * (b * d - a * c), 2 * (c * d + a * b),
      hand * (a * a + d * d - b * b - c * c) };
    for (std::size_t row = 0; row < 3; ++row)
      layout.origin[row] = metres * fields.real(268, 376, row);
  }
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    const double length = std::hypot(axes[axis], axes[3 + axis], axes[6 + axis]);
    for (std::size_t row = 0; row < 3; ++row)
      layout.direction[3 * row + axis] = length > 0 ? axes[3 * row + axis] / length : row == axis;
  }
}

} // namespace

bool beginsAsNifti(const fs::path& path)
{
  FileBytes file(path);
  return NiftiFields(firstBytes(file).bytes).known();
}

RawLayout niftiLayout(const fs::path& path)
{
  FileBytes file(path);
  NiftiBytes head = firstBytes(file);
  const NiftiFields fields(std::move(head.bytes));
  if (!fields.known())
    throw InputError(
      "'" + path.string() + "' is not a NIfTI file", "its header has 348 or 540 bytes and says n+1 or n+2");
  const auto refuse = [&](const std::string& what, const std::string& remedy)
  { throw InputError("the header of '" + path.string() + "' cannot be used: " + what, remedy); };

  RawLayout layout;
  static const std::map<std::int64_t, std::pair<NumberType, int>> types{ { 2, { { 'u', 1 }, 1 } },
    { 4, { { 'i', 2 }, 1 } }, { 8, { { 'i', 4 }, 1 } }, { 16, { { 'f', 4 }, 1 } }, { 64, { { 'f', 8 }, 1 } },
    { 128, { { 'u', 1 }, 3 } }, { 256, { { 'i', 1 }, 1 } }, { 512, { { 'u', 2 }, 1 } }, { 768, { { 'u', 4 }, 1 } },
    { 1024, { { 'i', 8 }, 1 } }, { 1280, { { 'u', 8 }, 1 } } };
  const std::int64_t code = fields.whole(70, 2, 12, 2);
  const auto known = types.find(code);
  if (known == types.end())
    refuse(fmt::format("its datatype is {}", code), "numbers of up to 64 bits can be read");
  std::tie(layout.type, layout.components) = known->second;
  layout.bigEndian = fields.bigEndian();

  const std::int64_t axes = fields.whole(40, 2, 16, 8);
  const auto size = [&](std::size_t axis) { return fields.whole(40, 2, 16, 8, axis + 1); };
  if (axes < 1 || axes > 7)
    refuse(fmt::format("it speaks of {} axes", axes), "two and three axes can be read");
  layout.axes = static_cast<int>(std::min<std::int64_t>(3, axes));
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(axes); ++axis)
  {
    if (size(axis) < 1 || (axis >= 3 && size(axis) != 1))
      refuse(fmt::format("its axis {} has {} values", axis + 1, size(axis)), "save one volume, of one value a voxel");
    if (axis < 3)
      layout.size[axis] = size(axis);
  }

  const double slope = fields.real(112, 176);
  const double shift = fields.real(116, 184);
  if (slope != 0 && (slope != 1 || shift != 0))
    refuse(fmt::format("its values stand for {} times themselves plus {}", slope, shift),
      "save the values themselves (scl_slope 1, scl_inter 0)");

  const std::int64_t unit = fields.whole(123, 1, 500, 4) & 7;
  const double metres = unit == 1 ? 1 : unit == 2 ? 1e-3 : unit == 3 ? 1e-6 : 1;
  layout.unitTold = unit >= 1 && unit <= 3;
  bool told = true;
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(layout.axes); ++axis)
  {
    const double spacing = fields.real(76, 104, axis + 1);
    told = told && std::isfinite(spacing) && spacing > 0;
    layout.spacing[axis] = told ? spacing * metres : 1;
  }
  layout.pixelSizeSource = told ? "NIfTI pixdim" : "none";
  setPlace(layout, fields, metres);

  layout.file = fields.pair() ? fs::path(path).replace_extension(".img") : path;
  const double offset = fields.second() ? static_cast<double>(fields.whole(0, 4, 168, 8)) : fields.real(108, 0);
  if (!(offset >= 0 && offset < 1e15) || offset != std::floor(offset) || (!fields.pair() && offset < 348))
    refuse(fmt::format("its values begin at byte {}", offset), "look at its vox_offset");
  layout.packed = head.packed;
  (head.packed ? layout.skip : layout.offset) = static_cast<std::uint64_t>(offset);
  return layout;
}

} // namespace lamella::micrograph
