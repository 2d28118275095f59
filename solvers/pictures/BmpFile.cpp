#include "pictures/BmpFile.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>

namespace lamella::micrograph
{
namespace
{

/// As the header of Windows 3 and its followers has it.
struct BmpHead
{
  std::int64_t width = 0;
  std::int64_t height = 0;
  bool fromTop = false;
  int bits = 0; ///< a pixel
  bool alpha = false;
  std::uint64_t palette = 0; ///< where it is, of colours of four bytes
  std::uint64_t colours = 0;
  std::uint64_t pixels = 0; ///< where they are
  std::uint64_t row = 0;    ///< bytes
  std::array<std::int64_t, 2> perMetre{};
};

[[noreturn]] void refuse(const FileBytes& file, const std::string& what)
{
  throw InputError(
    fmt::format("'{}' is a BMP {}", file.name(), what), "save it as a BMP of 24 bits that is not packed, or as PNG");
}

BmpHead readBmpHead(FileBytes& file)
{
  const auto number = [&](std::uint64_t at, int bytes) { return file.number(at, bytes, false); };
  const auto signedNumber = [&](std::uint64_t at)
  { return static_cast<std::int64_t>(static_cast<std::int32_t>(static_cast<std::uint32_t>(number(at, 4)))); };
  constexpr std::uint64_t header = 14;
  const std::uint64_t size = number(header, 4);
  if (size < 40 || size > 124)
    refuse(file, fmt::format("with a header of {} bytes; 40 to 124 can be read", size));
  BmpHead head;
  head.pixels = number(10, 4);
  head.width = signedNumber(18);
  head.height = signedNumber(22);
  head.fromTop = head.height < 0;
  head.height = std::abs(head.height);
  head.bits = static_cast<int>(number(28, 2));
  const std::uint64_t packing = number(30, 4);
  head.perMetre = { signedNumber(38), signedNumber(42) };
  if (head.width < 1 || head.height < 1)
    file.damaged("it holds no pixels");
  constexpr std::uint64_t masks = 3; // BI_BITFIELDS
  if (packing != 0 && packing != masks)
    refuse(file, fmt::format("that is packed (kind {})", packing));
  if ((head.bits != 8 && head.bits != 24 && head.bits != 32) || (packing == masks && head.bits != 32))
    refuse(file, fmt::format("of {} bits a pixel", head.bits));
  if (packing == masks)
  {
    // In the header itself, or just behind one of 40 bytes.
    const std::array<std::uint64_t, 3> usual{ 0xff0000, 0xff00, 0xff };
    for (std::uint64_t i = 0; i < 3; ++i)
      if (number(header + 40 + 4 * i, 4) != usual[i])
        refuse(file, "of 32 bits with colours in another order than usual");
    head.alpha = size >= 56 && number(header + 52, 4) == 0xff000000U;
  }
  if (head.bits == 8)
  {
    head.colours = number(46, 4);
    head.colours = head.colours == 0 ? 256 : head.colours;
    head.palette = header + size;
    if (head.colours > 256)
      file.damaged(fmt::format("it has a palette of {} colours", head.colours));
    if (!file.holds(head.palette, 4 * head.colours))
      file.truncated("its palette lies beyond its end");
  }
  head.row = (static_cast<std::uint64_t>(head.width) * static_cast<std::uint64_t>(head.bits) / 8 + 3) / 4 * 4;
  // Below 2^64: at most (2^33 − 4) × 2^31.
  const std::uint64_t bytes = head.row * static_cast<std::uint64_t>(head.height);
  if (head.pixels < header + size || !file.holds(head.pixels, bytes))
  {
    file.truncated(fmt::format("{} × {} pixels of {} bits from byte {} on take {} bytes", head.width, head.height,
      head.bits, head.pixels, bytes));
  }
  return head;
}

} // namespace

Probe probeBmp(FileBytes& file)
{
  const BmpHead head = readBmpHead(file);
  Probe result;
  result.format = Format::Bmp;
  result.width = head.width;
  result.height = head.height;
  result.channels = head.alpha ? 4 : 3;
  if (head.perMetre[0] > 0 && head.perMetre[1] > 0)
  {
    result.size = MetadataSize{ 1.0 / static_cast<double>(head.perMetre[0]),
      1.0 / static_cast<double>(head.perMetre[1]), std::nullopt, "BMP resolution" };
  }
  return result;
}

Pixels decodeBmp(FileBytes& file)
{
  const BmpHead head = readBmpHead(file);
  const std::vector<std::uint8_t> palette =
    head.colours > 0 ? file.read(head.palette, 4 * head.colours) : std::vector<std::uint8_t>();
  Pixels result;
  result.width = head.width;
  result.height = head.height;
  result.channels = head.alpha ? 4 : 3;
  const auto line = static_cast<std::size_t>(head.width * result.channels);
  result.values.resize(line * static_cast<std::size_t>(head.height));
  std::vector<std::uint8_t> row(head.row);
  const auto each = static_cast<std::size_t>(head.bits / 8);
  for (std::uint64_t y = 0; y < static_cast<std::uint64_t>(head.height); ++y)
  {
    file.read(head.pixels + head.row * y, row.data(), head.row);
    const auto at = static_cast<std::size_t>(head.fromTop ? y : static_cast<std::uint64_t>(head.height) - 1 - y);
    std::uint8_t* to = result.values.data() + line * at;
    for (std::size_t x = 0; x < static_cast<std::size_t>(head.width); ++x)
    {
      const std::uint8_t* from = row.data() + each * x; // blue, green, red
      if (head.bits == 8)
      {
        if (*from >= head.colours)
          file.damaged(fmt::format("a pixel has colour {}, and there are {}", *from, head.colours));
        from = palette.data() + std::size_t{ 4 } * *from;
      }
      *to++ = from[2];
      *to++ = from[1];
      *to++ = from[0];
      if (head.alpha)
        *to++ = from[3];
    }
  }
  return result;
}

} // namespace lamella::micrograph
