#pragma once

#include "../TemporaryFolder.h"

#include <zlib.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

/// Files made by hand for the tests of the readers, good ones and bad ones.
namespace lamella::testing
{

inline void put(Bytes& bytes, std::uint64_t value, int count, bool bigEndian)
{
  for (int i = 0; i < count; ++i)
    bytes.push_back(static_cast<std::uint8_t>(value >> (8 * (bigEndian ? count - 1 - i : i))));
}

/// A PNG of any colour type, its pixels not compressed.
struct PngFile
{
  std::uint32_t width = 2;
  std::uint32_t height = 2;
  int bits = 8;
  int colourType = 0;                                ///< 0 grey, 2 RGB, 3 palette, 4 grey and alpha, 6 RGB and alpha
  std::vector<Bytes> rows;                           ///< as PNG packs them, without the filter byte
  std::vector<std::pair<std::string, Bytes>> chunks; ///< between header and pixels

  [[nodiscard]] Bytes bytes() const
  {
    Bytes file{ 0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n' };
    Bytes header;
    put(header, width, 4, true);
    put(header, height, 4, true);
    for (const int value : { bits, colourType, 0, 0, 0 })
      header.push_back(static_cast<std::uint8_t>(value));
    addChunk(file, "IHDR", header);
    for (const auto& [type, data] : chunks)
      addChunk(file, type, data);
    Bytes raw;
    for (const Bytes& row : rows)
    {
      raw.push_back(0);
      raw.insert(raw.end(), row.begin(), row.end());
    }
    // zlib with stored blocks of at most 65535 bytes, and its Adler-32.
    Bytes data{ 0x78, 0x01 };
    std::uint32_t a = 1;
    std::uint32_t b = 0;
    for (const std::uint8_t value : raw)
    {
      a = (a + value) % 65521;
      b = (b + a) % 65521;
    }
    for (std::size_t at = 0; at < raw.size(); at += 65535)
    {
      const std::size_t count = std::min<std::size_t>(65535, raw.size() - at);
      data.push_back(at + count == raw.size());
      put(data, count, 2, false);
      put(data, ~count & 0xffffU, 2, false);
      data.insert(data.end(), raw.begin() + static_cast<std::ptrdiff_t>(at),
        raw.begin() + static_cast<std::ptrdiff_t>(at + count));
    }
    put(data, b << 16 | a, 4, true);
    addChunk(file, "IDAT", data);
    addChunk(file, "IEND", {});
    return file;
  }

  static void addChunk(Bytes& file, const std::string& type, const Bytes& data)
  {
    put(file, data.size(), 4, true);
    Bytes body(type.begin(), type.end());
    body.insert(body.end(), data.begin(), data.end());
    file.insert(file.end(), body.begin(), body.end());
    put(file, crc32(0, body.data(), static_cast<uInt>(body.size())), 4, true);
  }
  static Bytes physical(std::uint32_t x, std::uint32_t y, bool metres = true)
  {
    Bytes data;
    put(data, x, 4, true);
    put(data, y, 4, true);
    data.push_back(metres);
    return data;
  }
};

/// A TIFF of 8-bit grey pages, 3 × 2 pixels each unless the tags say otherwise; every tag can be overridden or added.
struct TiffFile
{
  bool bigEndian = false;
  struct Value
  {
    int type = 3; ///< 2 text, 3 short, 4 long, 5 ratio
    std::vector<std::uint64_t> numbers;
    std::string text;
  };
  std::vector<std::map<int, Value>> pages{ {} };
  Bytes pixels{ 10, 20, 30, 40, 50, 60 };

  [[nodiscard]] Bytes bytes() const
  {
    Bytes file;
    file.push_back(bigEndian ? 'M' : 'I');
    file.push_back(file[0]);
    put(file, 42, 2, bigEndian);
    std::size_t link = file.size(); // where the place of the next directory goes
    put(file, 0, 4, bigEndian);
    for (const auto& changes : pages)
    {
      const std::uint64_t pixelsAt = file.size();
      file.insert(file.end(), pixels.begin(), pixels.end());
      std::map<int, Value> tags{ { 256, { 4, { 3 }, {} } }, { 257, { 4, { 2 }, {} } }, { 258, { 3, { 8 }, {} } },
        { 259, { 3, { 1 }, {} } }, { 262, { 3, { 1 }, {} } }, { 273, { 4, { pixelsAt }, {} } },
        { 277, { 3, { 1 }, {} } }, { 278, { 4, { 2 }, {} } }, { 279, { 4, { pixels.size() }, {} } } };
      for (const auto& [tag, value] : changes)
        tags[tag] = value;
      std::map<int, std::uint64_t> places;
      for (const auto& [tag, value] : tags)
      {
        if (file.size() % 2 == 1)
          file.push_back(0);
        places[tag] = file.size();
        if (value.type == 2)
        {
          file.insert(file.end(), value.text.begin(), value.text.end());
          file.push_back(0);
        }
        else
        {
          for (const std::uint64_t number : value.numbers)
            put(file, number, value.type == 3 ? 2 : 4, bigEndian); // a ratio is two numbers
        }
      }
      if (file.size() % 2 == 1)
        file.push_back(0);
      Bytes place;
      put(place, file.size(), 4, bigEndian);
      std::copy(place.begin(), place.end(), file.begin() + static_cast<std::ptrdiff_t>(link));
      put(file, tags.size(), 2, bigEndian);
      for (const auto& [tag, value] : tags)
      {
        const std::size_t count =
          value.type == 2 ? value.text.size() + 1 : value.numbers.size() / (value.type == 5 ? 2 : 1);
        const std::size_t size = value.type == 2 ? count : count * (value.type == 3 ? 2 : value.type == 4 ? 4 : 8);
        put(file, static_cast<std::uint64_t>(tag), 2, bigEndian);
        put(file, static_cast<std::uint64_t>(value.type), 2, bigEndian);
        put(file, count, 4, bigEndian);
        if (size > 4)
        {
          put(file, places[tag], 4, bigEndian);
        }
        else
        {
          const auto from = file.begin() + static_cast<std::ptrdiff_t>(places[tag]);
          Bytes inside(from, from + static_cast<std::ptrdiff_t>(size));
          inside.resize(4, 0);
          file.insert(file.end(), inside.begin(), inside.end());
        }
      }
      link = file.size();
      put(file, 0, 4, bigEndian);
    }
    return file;
  }
};

} // namespace lamella::testing
