#include "pictures/NetpbmFile.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

namespace lamella::micrograph
{
namespace
{

bool isBlank(int c)
{
  return c == ' ' || (c >= '\t' && c <= '\r');
}

/// Numbers between blanks; '#' begins a comment that goes to the end of the line.
class Words
{
public:
  Words(const FileBytes& file, std::span<const std::uint8_t> bytes, std::uint64_t begin)
    : file_(file)
    , bytes_(bytes)
    , at(begin)
  {
  }

  /// The next one, and past the one blank behind it. @throws InputError
  std::int64_t number()
  {
    while (at < bytes_.size() && (isBlank(bytes_[at]) || bytes_[at] == '#'))
    {
      if (bytes_[at] == '#')
      {
        while (at < bytes_.size() && bytes_[at] != '\n' && bytes_[at] != '\r')
          ++at;
        continue;
      }
      ++at;
    }
    if (at >= bytes_.size())
      file_.truncated("a number is missing");
    constexpr std::int64_t most = std::int64_t{ 1 } << 40;
    std::int64_t value = 0;
    const std::uint64_t first = at;
    for (; at < bytes_.size() && bytes_[at] >= '0' && bytes_[at] <= '9' && value < most; ++at)
      value = 10 * value + (bytes_[at] - '0');
    if (at == first || value >= most || (at < bytes_.size() && !isBlank(bytes_[at]) && bytes_[at] != '#'))
      file_.damaged(fmt::format("there is no whole number at byte {}", first));
    at += at < bytes_.size() && bytes_[at] != '#' ? 1 : 0;
    return value;
  }

private:
  const FileBytes& file_;
  std::span<const std::uint8_t> bytes_;

public:
  std::uint64_t at;
};

struct NetpbmHead
{
  std::int64_t width = 0;
  std::int64_t height = 0;
  int channels = 1;
  bool text = false;
  std::int64_t largest = 255;
  std::uint64_t pixels = 0; ///< where they begin
};

NetpbmHead readNetpbmHead(FileBytes& file)
{
  constexpr std::uint64_t most = 1 << 16; // with its comments
  const std::vector<std::uint8_t> bytes = file.read(0, std::min(most, file.size()));
  const char kind = static_cast<char>(bytes[1]);
  if (kind == '1' || kind == '4')
    throw InputError(fmt::format("'{}' is a bitmap (P{})", file.name(), kind), "convert it to PGM or PNG");
  Words words(file, bytes, 2);
  NetpbmHead head;
  head.channels = kind == '3' || kind == '6' ? 3 : 1;
  head.text = kind == '2' || kind == '3';
  head.width = words.number();
  head.height = words.number();
  head.largest = words.number();
  head.pixels = words.at;
  if (head.width < 1 || head.height < 1)
    file.damaged("it holds no pixels");
  if (head.largest < 1 || head.largest > 65535)
    file.damaged(fmt::format("its largest value is {}; it can be 1 to 65535", head.largest));
  const double values = static_cast<double>(head.width) * static_cast<double>(head.height) * head.channels;
  // As text a value takes a digit and a blank, the last no blank.
  const double bytesWanted = head.text ? 2 * values - 1 : values * (head.largest > 255 ? 2 : 1);
  const auto held = static_cast<double>(file.size() - head.pixels);
  if (bytesWanted > held)
  {
    file.truncated(fmt::format("{:.0f} bytes behind its header cannot hold {} × {} pixels{}", held, head.width,
      head.height, head.channels == 3 ? " of three values" : ""));
  }
  return head;
}

} // namespace

bool isNetpbm(std::span<const std::uint8_t> head) noexcept
{
  return head.size() > 2 && head[0] == 'P' && head[1] >= '1' && head[1] <= '6' && (isBlank(head[2]) || head[2] == '#');
}

Probe probeNetpbm(FileBytes& file)
{
  const NetpbmHead head = readNetpbmHead(file);
  Probe result;
  result.format = head.channels == 3 ? Format::Ppm : Format::Pgm;
  result.width = head.width;
  result.height = head.height;
  result.channels = head.channels;
  result.bits = head.largest > 255 ? 16 : 8;
  return result;
}

Pixels decodeNetpbm(FileBytes& file, Probe& probe)
{
  const NetpbmHead head = readNetpbmHead(file);
  Pixels result;
  result.width = head.width;
  result.height = head.height;
  result.channels = head.channels;
  result.bits = head.largest > 255 ? 16 : 8;
  const auto count = static_cast<std::size_t>(head.width * head.height * head.channels);
  const std::size_t each = result.bits == 16 ? 2 : 1;
  const auto put = [&](std::size_t i, std::int64_t value)
  {
    if (value > head.largest)
      file.damaged(fmt::format("it holds {}, and its largest value is {}", value, head.largest));
    const auto small = static_cast<std::uint8_t>(value);
    const auto deep = static_cast<std::uint16_t>(value);
    std::memcpy(result.values.data() + i * each, each == 1 ? static_cast<const void*>(&small) : &deep, each);
  };
  const auto tellRest = [&](std::uint64_t rest)
  {
    if (rest > 0)
    {
      probe.warnings.push_back(fmt::format(
        "'{}' has {} bytes behind its {} × {} pixels; left out", file.name(), rest, head.width, head.height));
    }
  };
  if (head.text)
  {
    const std::vector<std::uint8_t> bytes = file.read(head.pixels, file.size() - head.pixels);
    result.values.resize(count * each);
    Words words(file, bytes, 0);
    for (std::size_t i = 0; i < count; ++i)
      put(i, words.number());
    const auto rest = bytes.begin() + static_cast<std::ptrdiff_t>(words.at);
    tellRest(static_cast<std::uint64_t>(bytes.end() - std::find_if_not(rest, bytes.end(), isBlank)));
    return result;
  }
  tellRest(file.size() - head.pixels - count * each);
  result.values = file.read(head.pixels, count * each);
  for (std::size_t i = 0; i < count && (each == 2 || head.largest < 255); ++i)
    put(i, static_cast<std::int64_t>(numberFrom(result.values.data() + i * each, static_cast<int>(each), true)));
  return result;
}

} // namespace lamella::micrograph
