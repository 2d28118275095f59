#include "micrograph/Probe.h"

#include "lattice/Error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

namespace lamella::micrograph
{
namespace
{

/// Text of a tEXt or uncompressed iTXt chunk that has this keyword; empty otherwise.
std::string textIn(const std::string& type, const std::vector<std::uint8_t>& data, const char* keyword)
{
  const std::string text(data.begin(), data.end());
  const std::size_t keyEnd = text.find('\0');
  if (keyEnd == std::string::npos || text.substr(0, keyEnd) != keyword)
  {
    return {};
  }
  if (type == "tEXt")
  {
    return text.substr(keyEnd + 1);
  }
  // iTXt: keyword, compression flag and method, language tag, translated keyword, text.
  if (keyEnd + 3 > text.size() || text[keyEnd + 1] != 0)
  {
    return {};
  }
  const std::size_t languageEnd = text.find('\0', keyEnd + 3);
  const std::size_t translatedEnd = languageEnd == std::string::npos ? languageEnd : text.find('\0', languageEnd + 1);
  return translatedEnd == std::string::npos ? std::string() : text.substr(translatedEnd + 1);
}

void readHeader(const FileBytes& file, const std::vector<std::uint8_t>& data, Probe& result)
{
  if (data.size() != 13)
  {
    file.damaged("its IHDR chunk has a wrong length");
  }
  result.width = static_cast<std::int64_t>(numberFrom(data.data(), 4, true));
  result.height = static_cast<std::int64_t>(numberFrom(data.data() + 4, 4, true));
  result.bits = std::max<int>(8, data[8]);
  switch (data[9])
  {
    case 0: // grey
      result.channels = 1;
      break;
    case 3: // palette
      result.bits = 8;
      [[fallthrough]];
    case 2: // RGB
      result.channels = 3;
      break;
    case 4: // grey and alpha
    case 6: // RGB and alpha
      result.channels = 4;
      break;
    default:
      file.damaged(fmt::format("colour type {} does not exist", data[9]));
  }
}

} // namespace

std::uint32_t pngCrc(const std::uint8_t* bytes, std::size_t count, std::uint32_t crc) noexcept
{
  static const auto table = []
  {
    std::array<std::uint32_t, 256> entries{};
    for (std::uint32_t n = 0; n < 256; ++n)
    {
      std::uint32_t value = n;
      for (int bit = 0; bit < 8; ++bit)
      {
        value = (value & 1U) != 0 ? 0xedb88320U ^ (value >> 1) : value >> 1;
      }
      entries[n] = value;
    }
    return entries;
  }();
  crc = ~crc;
  for (std::size_t i = 0; i < count; ++i)
  {
    crc = table[(crc ^ bytes[i]) & 0xffU] ^ (crc >> 8);
  }
  return ~crc;
}

Probe probePng(FileBytes& file)
{
  Probe result;
  result.format = Format::Png;
  bool hasHeader = false;
  std::uint64_t dataBytes = 0;
  for (std::uint64_t at = 8;;)
  {
    if (!file.holds(at, 12))
    {
      file.truncated("the PNG ends before its IEND chunk");
    }
    const std::uint64_t length = file.number(at, 4, true);
    if (length > 0x7fffffffU)
    {
      file.damaged(fmt::format("the chunk at byte {} says it is {} bytes long", at, length));
    }
    if (!file.holds(at, length + 12))
    {
      file.truncated(fmt::format("{} of the PNG's bytes are missing", at + length + 12 - file.size()));
    }
    std::vector<std::uint8_t> chunk = file.read(at + 4, length + 4);
    const std::string type(chunk.begin(), chunk.begin() + 4);
    const bool critical = type[0] >= 'A' && type[0] <= 'Z';
    if (pngCrc(chunk.data(), chunk.size()) != file.number(at + 8 + length, 4, true))
    {
      const std::string what = fmt::format("the checksum of its {} chunk at byte {} is wrong", type, at);
      if (critical)
      {
        file.damaged(what);
      }
      result.warnings.push_back(fmt::format("'{}' is damaged: {}; left out", file.name(), what));
      at += length + 12;
      continue;
    }
    chunk.erase(chunk.begin(), chunk.begin() + 4);
    if (!hasHeader && type != "IHDR")
    {
      file.damaged("its first chunk is not IHDR");
    }
    if (type == "IHDR")
    {
      readHeader(file, chunk, result);
      hasHeader = true;
    }
    else if (type == "IDAT")
    {
      dataBytes += length;
    }
    else if (type == "IEND")
    {
      break;
    }
    else if (type == "tRNS" && result.channels == 3)
    {
      result.channels = 4;
    }
    else if (type == "tEXt" || type == "iTXt")
    {
      for (auto [keyword, text] :
        { std::pair{ "Description", &result.description }, { "provenance", &result.provenance } })
      {
        if (text->empty())
        {
          *text = textIn(type, chunk, keyword);
        }
      }
    }
    else if (type == "pHYs" && chunk.size() == 9)
    {
      const auto x = static_cast<double>(numberFrom(chunk.data(), 4, true));
      const auto y = static_cast<double>(numberFrom(chunk.data() + 4, 4, true));
      if (x > 0 && y > 0 && chunk[8] == 1)
      {
        result.size = MetadataSize{ 1 / x, 1 / y, std::nullopt, "PNG pHYs" };
      }
      else if (x > 0 && y > 0 && x != y)
      {
        result.warnings.push_back(fmt::format(
          "the PNG says that its pixels are not square ({:.6g} to {:.6g}); they are taken as square", x, y));
      }
    }
    at += length + 12;
  }
  if (dataBytes == 0 || result.width < 1 || result.height < 1)
  {
    file.damaged("it holds no pixels");
  }
  checkBytes(file, result, dataBytes, 1100); // deflate packs at most 1032 bytes into one
  return result;
}

} // namespace lamella::micrograph
