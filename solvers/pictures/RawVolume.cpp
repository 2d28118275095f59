#include "pictures/RawVolume.h"

#include "core/Error.h"
#include "core/Lower.h"
#include "core/Parse.h"
#include "pictures/Probe.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <regex>
#include <utility>

namespace lamella::micrograph
{

namespace fs = std::filesystem;

/// Values that zlib or gzip packed, from the first to the last.
class RawVolume::Unpacker
{
public:
  Unpacker(FileBytes& file, std::uint64_t offset, std::uint64_t skip)
    : file_(file)
    , at_(offset)
    , skip_(skip)
  {
    if (inflateInit2(&stream_, 47) != Z_OK) // either header
      throw MemoryError("zlib cannot be started", "close other programs");
  }
  ~Unpacker() { inflateEnd(&stream_); }
  Unpacker(const Unpacker&) = delete;
  Unpacker& operator=(const Unpacker&) = delete;

  void read(unsigned char* to, std::uint64_t count)
  {
    std::vector<std::uint8_t> skipped(std::min<std::uint64_t>(skip_, std::uint64_t{ 1 } << 16));
    for (; skip_ > 0; skip_ -= std::min<std::uint64_t>(skip_, skipped.size()))
      this->take(skipped.data(), std::min<std::uint64_t>(skip_, skipped.size()));
    this->take(to, count);
  }

  /// After the last value: that there is no other, and that the checksum is right.
  void finish()
  {
    unsigned char more = 0;
    stream_.next_out = &more;
    stream_.avail_out = 1;
    while (!ended_)
    {
      this->step();
      if (stream_.avail_out == 0)
        file_.damaged("it holds more packed values than its header tells");
    }
  }

private:
  void take(unsigned char* to, std::uint64_t count)
  {
    while (count > 0)
    {
      const auto room = static_cast<unsigned>(std::min<std::uint64_t>(count, std::uint64_t{ 1 } << 30));
      stream_.next_out = to;
      stream_.avail_out = room;
      this->step();
      const unsigned done = room - stream_.avail_out;
      to += done;
      count -= done;
      if (ended_ && count > 0)
        file_.truncated(fmt::format("its packed values are {} bytes short", count));
    }
  }

  /// Unpacks into what room there is, from the bytes at hand or the next ones.
  void step()
  {
    if (stream_.avail_in == 0)
    {
      const std::uint64_t more = std::min<std::uint64_t>(std::uint64_t{ 1 } << 20, file_.size() - at_);
      if (more == 0)
        file_.truncated("its packed values end before the volume does");
      packed_ = file_.read(at_, more);
      at_ += more;
      stream_.next_in = packed_.data();
      stream_.avail_in = static_cast<unsigned>(more);
    }
    const int status = inflate(&stream_, Z_NO_FLUSH);
    if (status != Z_OK && status != Z_STREAM_END && status != Z_BUF_ERROR)
      file_.damaged("its packed values cannot be unpacked");
    ended_ = status == Z_STREAM_END;
  }

  FileBytes& file_;
  std::uint64_t at_;
  std::uint64_t skip_;
  bool ended_ = false;
  z_stream stream_{};
  std::vector<std::uint8_t> packed_;
};

namespace
{

std::string trimmed(const std::string& text)
{
  const std::size_t begin = text.find_first_not_of(" \t\r\"");
  return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(" \t\r\"") - begin + 1);
}

std::vector<std::string> wordsOf(const std::string& text)
{
  std::vector<std::string> words;
  for (const std::string& word : split(text, ' '))
    if (!trimmed(word).empty())
      words.push_back(trimmed(word));
  return words;
}

/// The lines of a header, "key = value" or "key: value", by key in small letters.
class Header
{
public:
  /// @param separator between key and value
  /// @param last tells the last line; an empty line ends the header too
  Header(const fs::path& path, char separator, const std::function<bool(const std::string& key)>& last)
    : path_(path)
  {
    FileBytes file(path);
    constexpr std::uint64_t most = 1 << 20;
    const auto bytes = file.read(0, std::min(most, file.size()));
    const std::string text(bytes.begin(), bytes.end());
    for (std::size_t at = 0; at < text.size();)
    {
      const std::size_t end = std::min(text.find('\n', at), text.size());
      const std::string line = text.substr(at, end - at);
      at = end + 1;
      end_ = std::min(at, text.size());
      if (trimmed(line).empty())
        break;
      if (std::ranges::any_of(line, [](unsigned char c) { return c == 0; }))
        break; // values
      first_ = first_.empty() ? line : first_;
      const std::size_t sign = line.find(separator);
      if (line.front() == '#' || sign == std::string::npos)
        continue;
      const std::string key = lower(trimmed(line.substr(0, sign)));
      const std::size_t value = line.find_first_not_of("=", sign + 1); // NRRD's own keys have :=
      values_[key] = value == std::string::npos ? "" : line.substr(value);
      if (last(key))
        break;
    }
  }

  [[nodiscard]] const std::string& firstLine() const { return first_; }
  /// Bytes of the header.
  [[nodiscard]] std::uint64_t end() const { return end_; }
  /// The text of the first of these keys that is there.
  [[nodiscard]] std::string text(std::initializer_list<const char*> keys) const
  {
    for (const char* const key : keys)
      if (const auto found = values_.find(key); found != values_.end())
        return trimmed(found->second);
    return "";
  }
  [[nodiscard]] std::string raw(const char* key) const
  {
    const auto found = values_.find(key);
    return found == values_.end() ? "" : found->second;
  }
  [[nodiscard]] std::vector<double> numbers(std::initializer_list<const char*> keys) const
  {
    std::vector<double> list;
    for (const std::string& word : wordsOf(this->text(keys)))
    {
      const auto number = toNumber(word);
      if (!number)
        this->refuse(fmt::format("'{}' is no number", word), "look at its header");
      list.push_back(*number);
    }
    return list;
  }
  [[nodiscard]] std::int64_t integer(std::initializer_list<const char*> keys, std::int64_t otherwise) const
  {
    const std::string value = this->text(keys);
    const auto number = toInteger(value);
    if (!value.empty() && !number)
      this->refuse(fmt::format("'{}' is no whole number", value), "look at its header");
    return number.value_or(otherwise);
  }
  [[noreturn]] void refuse(const std::string& what, const std::string& remedy) const
  {
    throw InputError("the header of '" + path_.string() + "' cannot be used: " + what, remedy);
  }

private:
  fs::path path_;
  std::string first_;
  std::uint64_t end_ = 0;
  std::map<std::string, std::string> values_;
};

/// Sizes of up to three axes. @throws InputError
void setSizes(RawLayout& layout, const std::vector<double>& sizes, const Header& header)
{
  if (sizes.empty() || sizes.size() > 3 || std::ranges::any_of(sizes, [](double n) { return !(n >= 1 && n < 1e18); }))
  {
    header.refuse(fmt::format("it speaks of {} axes of {}", sizes.size(), fmt::join(sizes, " × ")),
      "two and three axes can be read");
  }
  for (std::size_t axis = 0; axis < sizes.size(); ++axis)
    layout.size[axis] = static_cast<std::int64_t>(sizes[axis]);
  layout.axes = static_cast<int>(sizes.size());
}

fs::path beside(const fs::path& header, const std::string& name)
{
  const fs::path path(name);
  return path.is_absolute() ? path : header.parent_path() / path;
}

/// 1 where no unit is told.
double metresOr1(const std::string& unit)
{
  const double metres = metresIn(unit);
  return metres > 0 ? metres : 1;
}

using Named = std::pair<std::string_view, NumberType>;

/// The name that is written stands first.
const std::vector<Named>& metaTypes()
{
  static const std::vector<Named> types{ { "MET_UCHAR", { 'u', 1 } }, { "MET_CHAR", { 'i', 1 } },
    { "MET_USHORT", { 'u', 2 } }, { "MET_SHORT", { 'i', 2 } }, { "MET_UINT", { 'u', 4 } }, { "MET_INT", { 'i', 4 } },
    { "MET_ULONG_LONG", { 'u', 8 } }, { "MET_LONG_LONG", { 'i', 8 } }, { "MET_ULONG", { 'u', 4 } },
    { "MET_LONG", { 'i', 4 } }, // of 4 bytes in MetaIO
    { "MET_FLOAT", { 'f', 4 } }, { "MET_DOUBLE", { 'f', 8 } } };
  return types;
}

const std::vector<Named>& nrrdTypes()
{
  static const std::vector<Named> types{ { "uchar", { 'u', 1 } }, { "uint8", { 'u', 1 } }, { "uint8_t", { 'u', 1 } },
    { "unsigned char", { 'u', 1 } }, { "int8", { 'i', 1 } }, { "int8_t", { 'i', 1 } }, { "signed char", { 'i', 1 } },
    { "uint16", { 'u', 2 } }, { "uint16_t", { 'u', 2 } }, { "ushort", { 'u', 2 } }, { "unsigned short", { 'u', 2 } },
    { "int16", { 'i', 2 } }, { "int16_t", { 'i', 2 } }, { "short", { 'i', 2 } }, { "uint", { 'u', 4 } },
    { "uint32", { 'u', 4 } }, { "uint32_t", { 'u', 4 } }, { "unsigned int", { 'u', 4 } }, { "int", { 'i', 4 } },
    { "int32", { 'i', 4 } }, { "int32_t", { 'i', 4 } }, { "signed int", { 'i', 4 } }, { "uint64", { 'u', 8 } },
    { "uint64_t", { 'u', 8 } }, { "unsigned long long", { 'u', 8 } }, { "ulonglong", { 'u', 8 } },
    { "int64", { 'i', 8 } }, { "int64_t", { 'i', 8 } }, { "long long", { 'i', 8 } }, { "longlong", { 'i', 8 } },
    { "float", { 'f', 4 } }, { "double", { 'f', 8 } } };
  return types;
}

std::string nameIn(const std::vector<Named>& types, NumberType type)
{
  return std::string(std::ranges::find(types, type, &Named::second)->first);
}

/// "(1,0,0)" → 1 0 0; nothing for "none".
std::vector<double> vectorOf(const std::string& word, const Header& header)
{
  std::vector<double> list;
  if (word == "none")
    return list;
  for (const std::string& part : split(word.substr(1, word.size() >= 2 ? word.size() - 2 : 0), ','))
  {
    const auto number = toNumber(trimmed(part));
    if (!number)
      header.refuse(fmt::format("'{}' is no vector", word), "look at its header");
    list.push_back(*number);
  }
  return list;
}

/// Vectors of the axes become spacing and direction.
void setDirections(RawLayout& layout, const std::vector<std::vector<double>>& axes, double metres, const Header& header)
{
  for (std::size_t axis = 0; axis < axes.size(); ++axis)
  {
    const std::vector<double>& v = axes[axis];
    if (v.size() != axes.size())
    {
      header.refuse(fmt::format("an axis points along {} numbers in {} dimensions", v.size(), axes.size()),
        "look at its space directions");
    }
    double length = 0;
    for (const double part : v)
      length = std::hypot(length, part);
    const bool straight = std::ranges::count(v, 0.0) == static_cast<std::ptrdiff_t>(v.size()) - 1;
    length = straight ? std::abs(std::accumulate(v.begin(), v.end(), 0.0)) : length; // to the last bit
    if (!(length > 0))
      header.refuse("an axis has no length", "look at its space directions");
    layout.spacing[axis] = length * metres;
    for (std::size_t row = 0; row < v.size(); ++row)
      layout.direction[3 * row + axis] = v[row] / length;
  }
}

/// Size and type that a name says.
struct RawName
{
  std::optional<std::array<std::int64_t, 3>> size;
  std::optional<NumberType> type;
};

RawName rawName(const std::string& name)
{
  RawName result;
  static const std::regex size("(^|[^0-9])([0-9]{1,6})[xX]([0-9]{1,6})[xX]([0-9]{1,6})([^0-9]|$)");
  static const std::regex type("(^|[^A-Za-z0-9])(u|uint|i|int|f|float)(8|16|32|64)([^0-9]|$)", std::regex::icase);
  static const std::regex bits("(^|[^0-9])(8|16)[-_]?bit", std::regex::icase);
  std::smatch match;
  if (std::regex_search(name, match, size))
    result.size = { std::stoll(match[2]), std::stoll(match[3]), std::stoll(match[4]) };
  if (std::regex_search(name, match, type))
  {
    const NumberType said{ lower(match[2].str()).front(), std::stoi(match[3]) / 8 };
    result.type = said.kind == 'f' && said.bytes < 4 ? std::nullopt : std::optional(said);
  }
  else if (std::regex_search(name, match, bits))
  {
    result.type = NumberType{ 'u', std::stoi(match[2]) / 8 };
  }
  return result;
}

} // namespace

std::string NumberType::name() const
{
  return kind + std::to_string(8 * bytes);
}

std::string metaTypeName(NumberType type)
{
  return nameIn(metaTypes(), type);
}

std::string nrrdTypeName(NumberType type)
{
  return nameIn(nrrdTypes(), type);
}

RawLayout rawLayout(const fs::path& path, const RawSaid& said)
{
  const RawName named = rawName(path.filename().string());
  RawLayout layout;
  layout.file = path;
  layout.offset = said.offset;
  layout.components = said.components;
  layout.bigEndian = said.bigEndian;
  const auto size = said.size ? said.size : named.size;
  if (!size)
  {
    throw InputError(fmt::format("the size of the raw volume '{}' is not known", path.string()),
      "give the raw size, NX,NY,NZ, or put it into the name, such as berea_200x200x200_u8.raw");
  }
  layout.size = *size;
  std::error_code missing;
  const auto bytes = static_cast<double>(fs::file_size(path, missing)) - static_cast<double>(layout.offset);
  const double voxels =
    static_cast<double>(layout.size[0]) * static_cast<double>(layout.size[1]) * static_cast<double>(layout.size[2]);
  auto type = said.type ? said.type : named.type;
  if (!type && (bytes == voxels || bytes == 2 * voxels))
    type = NumberType{ 'u', bytes == voxels ? 1 : 2 };
  type = type ? type : said.otherwise;
  if (!type)
  {
    throw InputError(fmt::format("the type of the values in '{}' is not known", path.string()),
      "give the raw type, u8, u16, i16, f32 …, or put it into the name, such as berea_200x200x200_u8.raw");
  }
  layout.type = *type;
  return layout;
}

RawHeader rawHeader(const fs::path& path)
{
  const std::string ending = endingOf(path);
  if (ending == ".mhd" || ending == ".mha")
    return RawHeader::Meta;
  if (ending == ".nrrd" || ending == ".nhdr")
    return RawHeader::Nrrd;
  if (ending == ".npy")
    return RawHeader::Numpy;
  if (ending == ".nii" || ending == ".nii.gz")
    return RawHeader::Nifti;
  if (ending == ".vtk")
    return RawHeader::LegacyVtk;
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored) || fs::file_size(path, ignored) < 8)
    return RawHeader::None;
  FileBytes file(path);
  const std::vector<std::uint8_t> bytes = file.read(0, 8);
  const std::string_view head(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return head.starts_with("NRRD00") ? RawHeader::Nrrd
    : head.starts_with("\x93NUMPY") ? RawHeader::Numpy
    : head.starts_with("# vtk Da")  ? RawHeader::LegacyVtk
    : beginsAsNifti(path)           ? RawHeader::Nifti
                                    : RawHeader::None;
}

std::string name(RawHeader header)
{
  static constexpr std::array names{ "raw", "MetaImage", "NRRD", "NumPy", "NIfTI", "VTK legacy" };
  return names[static_cast<std::size_t>(header)];
}

RawLayout headerLayout(const fs::path& path, RawHeader header)
{
  switch (header)
  {
    case RawHeader::Meta:
      return metaLayout(path);
    case RawHeader::Nrrd:
      return nrrdLayout(path);
    case RawHeader::Numpy:
      return numpyLayout(path);
    case RawHeader::Nifti:
      return niftiLayout(path);
    default:
      return legacyVtkLayout(path);
  }
}

RawLayout metaLayout(const fs::path& path)
{
  const Header header(path, '=', [](const std::string& key) { return key == "elementdatafile"; });
  RawLayout layout;
  const std::string data = header.text({ "elementdatafile" });
  if (data.empty() || header.text({ "dimsize" }).empty())
    header.refuse("it has no DimSize or no ElementDataFile", "give a whole .mhd or .mha file");
  setSizes(layout, header.numbers({ "dimsize" }), header);
  const std::string type = header.text({ "elementtype" });
  const auto known = std::ranges::find(metaTypes(), type, &Named::first);
  if (known == metaTypes().end())
    header.refuse(fmt::format("its ElementType is '{}'", type), "numbers of up to 64 bits can be read");
  layout.type = known->second;
  layout.components =
    static_cast<int>(std::clamp<std::int64_t>(header.integer({ "elementnumberofchannels" }, 1), 1, 64));
  layout.bigEndian = lower(header.text({ "binarydatabyteordermsb", "elementbyteordermsb" })).starts_with("t");
  layout.packed = lower(header.text({ "compresseddata" })).starts_with("t");
  if (lower(header.text({ "binarydata" })).starts_with("f"))
    header.refuse("its values are text (BinaryData = False)", "write them as binary");
  if (data == "LIST" || data.find('%') != std::string::npos)
    header.refuse("its values are in several files", "convert those as a stack: a pattern such as slice_%03d.png");
  const bool inside = data == "LOCAL" || data == "Local" || data == "local";
  layout.file = inside ? path : beside(path, data);
  const std::int64_t skip = header.integer({ "headersize" }, 0);
  layout.fromEnd = skip < 0;
  layout.offset = inside ? header.end() : static_cast<std::uint64_t>(std::max<std::int64_t>(0, skip));
  const std::string unit = header.text({ "distanceunits" });
  const double metres = metresOr1(unit);
  layout.unitTold = !unit.empty();
  const auto spacing = header.numbers({ "elementspacing", "elementsize" });
  const auto origin = header.numbers({ "offset", "position", "origin" });
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    layout.spacing[axis] = axis < spacing.size() ? spacing[axis] * metres : 1;
    layout.origin[axis] = axis < origin.size() ? origin[axis] * metres : 0;
    if (!(layout.spacing[axis] > 0))
      header.refuse(fmt::format("a spacing of {}", layout.spacing[axis]), "a spacing is a positive length");
  }
  layout.pixelSizeSource = spacing.empty() ? "none" : "MetaImage ElementSpacing";
  const auto turn = header.numbers({ "transformmatrix", "rotation", "orientation" });
  const std::size_t axes = turn.size() == 9 ? 3 : turn.size() == 4 ? 2 : 0;
  for (std::size_t row = 0; row < axes; ++row)
    for (std::size_t column = 0; column < axes; ++column)
      layout.direction[3 * row + column] = turn[axes * column + row]; // a row of the file is an axis
  return layout;
}

RawLayout nrrdLayout(const fs::path& path)
{
  const Header header(path, ':', [](const std::string&) { return false; });
  if (!header.firstLine().starts_with("NRRD00"))
    throw InputError("'" + path.string() + "' is not an NRRD file", "its first line is NRRD0004 or the like");
  RawLayout layout;
  const std::string type = lower(header.text({ "type" }));
  const auto known = std::ranges::find(nrrdTypes(), type, &Named::first);
  if (known == nrrdTypes().end())
    header.refuse(fmt::format("its type is '{}'", type), "numbers of up to 64 bits can be read");
  layout.type = known->second;
  auto sizes = header.numbers({ "sizes" });
  auto kinds = wordsOf(header.text({ "kinds" }));
  auto directions = wordsOf(header.text({ "space directions" }));
  auto spacings = header.numbers({ "spacings" });
  const bool list = sizes.size() > 1 &&
    ((!directions.empty() && directions.front() == "none") ||
      (!kinds.empty() && lower(kinds.front()) != "domain" && lower(kinds.front()) != "space" &&
        kinds.front() != "???"));
  if (list)
  {
    layout.components = static_cast<int>(std::clamp(sizes.front(), 1.0, 64.0));
    for (auto* const words : { &kinds, &directions })
      words->erase(words->begin(), words->begin() + (words->empty() ? 0 : 1));
    sizes.erase(sizes.begin());
    spacings.erase(spacings.begin(), spacings.begin() + (spacings.empty() ? 0 : 1));
  }
  setSizes(layout, sizes, header);
  const std::string encoding = lower(header.text({ "encoding" }));
  layout.packed = encoding == "gzip" || encoding == "gz";
  if (!layout.packed && encoding != "raw")
    header.refuse(fmt::format("its encoding is '{}'", encoding), "raw and gzip can be read: save it as one of these");
  layout.bigEndian = lower(header.text({ "endian" })) == "big";
  const std::string data = header.text({ "data file", "datafile" });
  if (data.find('%') != std::string::npos || data == "LIST" || data.starts_with("LIST "))
    header.refuse("its values are in several files", "convert those as a stack: a pattern such as slice_%03d.png");
  if (header.integer({ "line skip", "lineskip" }, 0) != 0)
    header.refuse("it skips lines", "give the number of bytes instead (byte skip)");
  const std::int64_t skip = header.integer({ "byte skip", "byteskip" }, 0);
  layout.fromEnd = skip < 0;
  layout.file = data.empty() ? path : beside(path, data);
  layout.offset = (data.empty() ? header.end() : 0) + static_cast<std::uint64_t>(std::max<std::int64_t>(0, skip));
  const auto units = wordsOf(header.text({ "space units", "units" }));
  const double metres = units.empty() ? 1 : metresOr1(units.front());
  layout.unitTold = !units.empty();
  if (!directions.empty())
  {
    std::vector<std::vector<double>> axes;
    for (const std::string& word : directions)
      axes.push_back(vectorOf(word, header));
    setDirections(layout, axes, metres, header);
    layout.pixelSizeSource = "NRRD space directions";
  }
  else if (!spacings.empty())
  {
    for (std::size_t axis = 0; axis < std::min<std::size_t>(3, spacings.size()); ++axis)
      layout.spacing[axis] = std::isfinite(spacings[axis]) && spacings[axis] > 0 ? spacings[axis] * metres : 1;
    layout.pixelSizeSource = "NRRD spacings";
  }
  if (const std::string origin = header.text({ "space origin" }); !origin.empty())
  {
    const auto numbers = vectorOf(origin, header);
    for (std::size_t axis = 0; axis < std::min<std::size_t>(3, numbers.size()); ++axis)
      layout.origin[axis] = numbers[axis] * metres;
  }
  return layout;
}

RawVolume::RawVolume(const RawLayout& layout)
  : layout_(layout)
  , file_(layout.file)
{
  for (const std::int64_t nodes : layout.size)
  {
    if (nodes < 1 || nodes > std::numeric_limits<int>::max())
    {
      throw InputError(
        fmt::format("the size of '{}' is {} × {} × {}", file_.name(), layout.size[0], layout.size[1], layout.size[2]),
        "a volume has 1 to 2147483647 voxels along each axis");
    }
  }
  const double layer =
    static_cast<double>(layout.size[0]) * static_cast<double>(layout.size[1]) * layout.components * layout.type.bytes;
  const double all = layer * static_cast<double>(layout.size[2]);
  const auto held = static_cast<double>(file_.size()) - static_cast<double>(layout.fromEnd ? 0 : layout.offset) -
    static_cast<double>(layout.after);
  // zlib packs at most 1032 bytes into one
  const bool wrong = layout.packed ? all > 1100 * held + 65536 : layout.fromEnd ? all > held : all != held;
  if (wrong)
  {
    throw InputError(
      fmt::format("'{}' has {:.0f}{} bytes{}, but {} × {} × {} voxels of {}{} take {:.0f}", file_.name(), held,
        layout.packed ? " packed" : "", layout.offset > 0 ? " after its header" : "", layout.size[0], layout.size[1],
        layout.size[2], layout.components > 1 ? fmt::format("{} × ", layout.components) : "", layout.type.name(), all),
      "check the size, the type and the length of the header, of raw files raw size, raw bits and raw header; a "
      "file that is too short was truncated");
  }
  layer_ = static_cast<std::uint64_t>(layer);
  begin_ = layout.fromEnd ? file_.size() - static_cast<std::uint64_t>(all) : layout.offset;
}

RawVolume::~RawVolume() = default;

void RawVolume::read(std::int64_t first, std::int64_t last, void* to)
{
  const std::uint64_t bytes = layer_ * static_cast<std::uint64_t>(last - first + 1);
  if (layout_.packed)
    this->unpack(static_cast<std::uint8_t*>(to), first, last);
  else
    file_.read(begin_ + layer_ * static_cast<std::uint64_t>(first), to, bytes);
  this->swap(to, bytes);
}

void RawVolume::readRun(const std::array<std::int64_t, 3>& from, std::uint64_t count, void* to)
{
  const auto each = static_cast<std::uint64_t>(layout_.components * layout_.type.bytes);
  const auto before = static_cast<std::uint64_t>(from[0] + layout_.size[0] * (from[1] + layout_.size[1] * from[2]));
  file_.read(begin_ + each * before, to, each * count);
  this->swap(to, each * count);
}

void RawVolume::swap(void* values, std::uint64_t bytes) const
{
  const auto each = static_cast<std::size_t>(layout_.type.bytes);
  if (each == 1 || layout_.bigEndian == (std::endian::native == std::endian::big))
    return;
  auto* const from = static_cast<std::uint8_t*>(values);
  for (std::uint64_t at = 0; at < bytes; at += each)
    std::reverse(from + at, from + at + each);
}

/// The last layer that was unpacked is kept: slabs of images with cells begin with it.
void RawVolume::unpack(std::uint8_t* to, std::int64_t first, std::int64_t last)
{
  if (unpacker_ == nullptr || first < next_ - 1 || (first == next_ - 1 && kept_.empty()))
  {
    unpacker_ = std::make_unique<Unpacker>(file_, begin_, layout_.skip);
    next_ = 0;
  }
  if (first == next_ - 1)
  {
    std::copy(kept_.begin(), kept_.end(), to);
    to += layer_;
    ++first;
  }
  kept_.resize(layer_);
  for (; next_ < first; ++next_)
    unpacker_->read(kept_.data(), layer_);
  for (; next_ <= last; ++next_, to += layer_)
  {
    unpacker_->read(to, layer_);
    if (next_ == last)
      std::copy_n(to, layer_, kept_.begin());
    if (next_ == layout_.size[2] - 1)
      unpacker_->finish();
  }
}

} // namespace lamella::micrograph
