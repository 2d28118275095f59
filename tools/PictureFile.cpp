#include "PictureFile.h"

#include "lattice/Error.h"

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

namespace lamella::cli
{

namespace fs = std::filesystem;

namespace
{

using Json = nlohmann::ordered_json;

constexpr std::string_view pngSignature("\x89PNG\r\n\x1a\n", 8);
constexpr std::string_view keyword("lamella");

/// CRC-32 of PNG chunks (PNG specification, annex D).
std::uint32_t crc32(std::string_view bytes)
{
  std::uint32_t crc = 0xffffffff;
  for (const char c : bytes)
  {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit)
    {
      crc = (crc >> 1) ^ ((crc & 1) != 0 ? 0xedb88320 : 0);
    }
  }
  return ~crc;
}

std::string bigEndian(std::uint32_t value)
{
  return { static_cast<char>(value >> 24), static_cast<char>(value >> 16), static_cast<char>(value >> 8),
    static_cast<char>(value) };
}

std::uint32_t fromBigEndian(const char* bytes)
{
  std::uint32_t value = 0;
  for (int i = 0; i < 4; ++i)
  {
    value = (value << 8) | static_cast<unsigned char>(bytes[i]);
  }
  return value;
}

std::string chunk(std::string_view type, std::string_view data)
{
  std::string typed(type);
  typed += data;
  return bigEndian(static_cast<std::uint32_t>(data.size())) + typed + bigEndian(crc32(typed));
}

std::optional<Record> parseRecord(std::string_view text)
{
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("provenance"))
  {
    return std::nullopt;
  }
  try
  {
    Record record;
    record.provenance = json.at("provenance").dump();
    if (json.contains("phases"))
    {
      for (const auto& [grey, name] : json.at("phases").items())
      {
        record.phases[std::stoi(grey)] = name.get<std::string>();
      }
    }
    if (json.contains("pixel_size") && json.at("pixel_size").is_number())
    {
      record.pixelSize = json.at("pixel_size").get<double>();
    }
    if (json.contains("size"))
    {
      record.size = json.at("size").get<std::array<std::int64_t, 3>>();
    }
    record.bits = json.value("bits", 8);
    return record;
  }
  catch (const std::exception&) // somebody else's JSON
  {
    return std::nullopt;
  }
}

std::optional<Record> readPng(std::ifstream& file)
{
  char head[8];
  while (file.read(head, 8))
  {
    const std::uint32_t size = fromBigEndian(head);
    const std::string_view type(head + 4, 4);
    if (type == "IDAT" || type == "IEND") // ours comes before the pixels
    {
      break;
    }
    if (type != "iTXt" || size > (1U << 24))
    {
      file.seekg(static_cast<std::streamoff>(size) + 4, std::ios::cur);
      continue;
    }
    std::string data(size, '\0');
    if (!file.read(data.data(), size) || !file.seekg(4, std::ios::cur))
    {
      break;
    }
    // keyword 0 compressed? method language 0 translated keyword 0 text
    const std::string start = std::string(keyword) + std::string(5, '\0');
    if (data.starts_with(start))
    {
      return parseRecord(std::string_view(data).substr(start.size()));
    }
  }
  return std::nullopt;
}

template <typename T>
void append(std::string& bytes, T value)
{
  static_assert(std::endian::native == std::endian::little, "TIFF is written in this machine's byte order");
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

template <typename T>
T valueAt(std::string_view bytes, std::size_t offset)
{
  T value{};
  if (offset + sizeof value <= bytes.size())
  {
    std::memcpy(&value, bytes.data() + offset, sizeof value);
  }
  return value;
}

std::optional<Record> readTiff(std::ifstream& file)
{
  const auto read = [&file](std::uint64_t offset, std::size_t size)
  {
    std::string bytes(size, '\0');
    file.clear();
    file.seekg(static_cast<std::streamoff>(offset));
    file.read(bytes.data(), static_cast<std::streamsize>(size));
    bytes.resize(static_cast<std::size_t>(file.gcount()));
    return bytes;
  };
  const auto directory = valueAt<std::uint32_t>(read(4, 4), 0);
  const auto entries = valueAt<std::uint16_t>(read(directory, 2), 0);
  const std::string table = read(directory + 2ULL, std::size_t{ 12 } * entries);
  for (std::size_t entry = 0; entry + 12 <= table.size(); entry += 12)
  {
    const auto count = valueAt<std::uint32_t>(table, entry + 4);
    if (valueAt<std::uint16_t>(table, entry) == 270 && count > 4 && count < (1U << 24))
    {
      std::string text = read(valueAt<std::uint32_t>(table, entry + 8), count);
      text.resize(std::strlen(text.c_str()));
      return parseRecord(text);
    }
  }
  return std::nullopt;
}

} // namespace

std::string toJson(const Record& record)
{
  Json json;
  json["provenance"] = record.provenance.empty() ? Json::object() : Json::parse(record.provenance);
  if (!record.phases.empty())
  {
    for (const auto& [grey, name] : record.phases)
    {
      json["phases"][std::to_string(grey)] = name;
    }
  }
  if (record.pixelSize)
  {
    json["pixel_size"] = *record.pixelSize;
  }
  if (record.size)
  {
    json["size"] = *record.size;
    json["bits"] = record.bits;
  }
  return json.dump(-1, ' ', true, Json::error_handler_t::replace);
}

std::optional<Record> readRecord(const fs::path& path)
{
  std::error_code ignored;
  if (fs::is_regular_file(recordBeside(path), ignored))
  {
    std::ifstream beside(recordBeside(path));
    return parseRecord(std::string(std::istreambuf_iterator<char>(beside), {}));
  }
  if (!fs::is_regular_file(path, ignored))
  {
    return std::nullopt;
  }
  std::ifstream file(path, std::ios::binary);
  char head[8] = {};
  file.read(head, 8);
  if (std::string_view(head, 8) == pngSignature)
  {
    return readPng(file);
  }
  if (std::string_view(head, 4) == std::string_view("II*\0", 4))
  {
    return readTiff(file);
  }
  return std::nullopt;
}

std::map<int, std::string> greysOfPhases(const PhaseTable& phases)
{
  std::map<int, std::string> greys;
  const std::size_t last = std::max<std::size_t>(phases.size(), 2) - 1;
  for (std::size_t id = 0; id < phases.size(); ++id)
  {
    greys[static_cast<int>(255 * id / last)] = phases.names()[id];
  }
  return greys;
}

namespace
{

/// The bytes of a picture: greys instead of ids, upright in 2D.
std::vector<std::uint8_t> greys(const PhaseImage& image)
{
  std::array<std::uint8_t, 256> greyOf{};
  std::size_t id = 0;
  for (const auto& [grey, name] : greysOfPhases(image.phases))
  {
    greyOf[id++] = static_cast<std::uint8_t>(grey);
  }
  std::vector<std::uint8_t> bytes(image.phase.size());
  const auto width = static_cast<std::size_t>(image.lattice.size[0]);
  const std::size_t rows = bytes.size() / width;
  for (std::size_t row = 0; row < rows; ++row)
  {
    const std::size_t from = image.lattice.dimension == 2 ? rows - 1 - row : row;
    std::transform(image.phase.begin() + static_cast<std::ptrdiff_t>(from * width),
      image.phase.begin() + static_cast<std::ptrdiff_t>((from + 1) * width),
      bytes.begin() + static_cast<std::ptrdiff_t>(row * width), [&](std::uint8_t phase) { return greyOf[phase]; });
  }
  return bytes;
}

} // namespace

std::string encodePng(const PhaseImage& image, const Record& record)
{
  if (image.lattice.dimension == 3)
  {
    throw ParameterError("a PNG holds one picture, not a volume", "write the volume as .vti, .tif or .raw");
  }
  std::vector<std::uint8_t> bytes = greys(image);
  const cv::Mat mat(
    static_cast<int>(image.lattice.size[1]), static_cast<int>(image.lattice.size[0]), CV_8UC1, bytes.data());
  std::vector<std::uint8_t> png;
  cv::imencode(".png", mat, png);
  return addRecordToPng({ reinterpret_cast<const char*>(png.data()), png.size() }, record);
}

std::string addRecordToPng(std::string_view png, const Record& record)
{
  // Signature, then IHDR: always 13 bytes of data; pHYs and iTXt may follow at once.
  constexpr std::size_t head = 8 + 12 + 13;
  std::string added;
  if (record.pixelSize)
  {
    const double perMetre = std::round(1 / *record.pixelSize);
    if (perMetre >= 1 && perMetre <= std::numeric_limits<std::int32_t>::max())
    {
      const std::string density = bigEndian(static_cast<std::uint32_t>(perMetre));
      added += chunk("pHYs", density + density + '\1');
    }
  }
  added += chunk("iTXt", std::string(keyword) + std::string(5, '\0') + toJson(record));
  return std::string(png.substr(0, head)) + added + std::string(png.substr(head));
}

std::string encodeTiff(const PhaseImage& image, const Record& record)
{
  // Baseline TIFF 6.0, one uncompressed strip a page: what every reader takes.
  enum Type : std::uint16_t
  {
    Ascii = 2,
    Short = 3,
    Long = 4,
    Rational = 5
  };
  const std::vector<std::uint8_t> pixels = greys(image);
  const Lattice& lattice = image.lattice;
  const auto pageBytes = static_cast<std::size_t>(lattice.size[0] * lattice.size[1]);
  const auto pages = static_cast<std::size_t>(lattice.size[2]);
  std::string description = toJson(record);
  description += '\0';
  if (pixels.size() + pages * 256 + description.size() > std::numeric_limits<std::uint32_t>::max())
  {
    throw ParameterError("a TIFF holds 4 GB at most, and this sample has more", "write it as .vti or .raw");
  }

  std::string file("II*\0", 4);
  append<std::uint32_t>(file, 0); // the first directory; set below
  const auto here = [&file] { return static_cast<std::uint32_t>(file.size()); };
  const std::uint32_t descriptionAt = here();
  file += description;
  file.append(file.size() % 2, '\0');
  const std::uint32_t resolutionAt = here();
  append(file, static_cast<std::uint32_t>(std::round(std::min(0.01 / record.pixelSize.value_or(0.01) * 1000, 4.2e9))));
  append<std::uint32_t>(file, 1000);
  const std::uint32_t pixelsAt = here();
  file.append(reinterpret_cast<const char*>(pixels.data()), pixels.size());
  file.append(file.size() % 2, '\0');

  std::size_t pointer = 4; // where the offset of the next directory goes
  for (std::size_t page = 0; page < pages; ++page)
  {
    const std::uint32_t at = here();
    std::memcpy(file.data() + pointer, &at, sizeof at);
    std::string table;
    std::uint16_t entries = 0;
    const auto entry = [&](std::uint16_t tag, Type type, std::uint32_t count, std::uint32_t value)
    {
      append(table, tag);
      append<std::uint16_t>(table, type);
      append(table, count);
      append(table, value); // little-endian, so a Short stands in the first two bytes
      ++entries;
    };
    entry(254, Long, 1, pages > 1 ? 2 : 0); // a page of many
    entry(256, Long, 1, static_cast<std::uint32_t>(lattice.size[0]));
    entry(257, Long, 1, static_cast<std::uint32_t>(lattice.size[1]));
    entry(258, Short, 1, 8);
    entry(259, Short, 1, 1); // not compressed
    entry(262, Short, 1, 1); // 0 is black
    if (page == 0)
    {
      entry(270, Ascii, static_cast<std::uint32_t>(description.size()), descriptionAt);
    }
    entry(273, Long, 1, static_cast<std::uint32_t>(pixelsAt + page * pageBytes));
    entry(277, Short, 1, 1);
    entry(278, Long, 1, static_cast<std::uint32_t>(lattice.size[1]));
    entry(279, Long, 1, static_cast<std::uint32_t>(pageBytes));
    if (record.pixelSize)
    {
      entry(282, Rational, 1, resolutionAt);
      entry(283, Rational, 1, resolutionAt);
      entry(296, Short, 1, 3); // a centimetre
    }
    append(file, entries);
    file += table;
    pointer = file.size();
    append<std::uint32_t>(file, 0);
  }
  return file;
}

std::string_view encodeRaw(const PhaseImage& image) noexcept
{
  return { reinterpret_cast<const char*>(image.phase.data()), image.phase.size() };
}

fs::path recordBeside(const fs::path& raw)
{
  return raw.string() + ".json";
}

} // namespace lamella::cli
