#include "convert/RawFile.h"

#include "Text.h"
#include "convert/Notes.h"
#include "convert/Types.h"

#include "lattice/Error.h"
#include "micrograph/FileBytes.h"
#include "vtkLatticeConversion.h"

#include <vtkByteSwap.h>
#include <vtkDataArray.h>
#include <vtkMatrix3x3.h>
#include <vtkPointData.h>

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <numeric>
#include <regex>

namespace lamella::cli
{

namespace
{

namespace fs = std::filesystem;

int bytesOf(int type)
{
  return vtkDataArray::GetDataTypeSize(type);
}

/// Values that zlib or gzip packed, from the first to the last.
class Unpacker
{
public:
  Unpacker(micrograph::FileBytes& file, std::uint64_t offset)
    : file_(file)
    , at_(offset)
  {
    if (inflateInit2(&stream_, 47) != Z_OK) // either header
    {
      throw InputError("zlib cannot be started", "is there memory?");
    }
  }
  ~Unpacker() { inflateEnd(&stream_); }
  Unpacker(const Unpacker&) = delete;
  Unpacker& operator=(const Unpacker&) = delete;

  void read(unsigned char* to, std::uint64_t count)
  {
    while (count > 0)
    {
      if (stream_.avail_in == 0)
      {
        const std::uint64_t more = std::min<std::uint64_t>(std::uint64_t{ 1 } << 20, file_.size() - at_);
        if (more == 0)
        {
          file_.truncated("its packed values end before the volume does");
        }
        packed_ = file_.read(at_, more);
        at_ += more;
        stream_.next_in = packed_.data();
        stream_.avail_in = static_cast<unsigned>(more);
      }
      const auto room = static_cast<unsigned>(std::min<std::uint64_t>(count, std::uint64_t{ 1 } << 30));
      stream_.next_out = to;
      stream_.avail_out = room;
      const int status = inflate(&stream_, Z_NO_FLUSH);
      const unsigned done = room - stream_.avail_out;
      to += done;
      count -= done;
      if (status == Z_STREAM_END && count > 0)
      {
        file_.truncated(fmt::format("its packed values are {} bytes short", count));
      }
      if (status != Z_OK && status != Z_STREAM_END && status != Z_BUF_ERROR)
      {
        file_.damaged("its packed values cannot be unpacked");
      }
    }
  }

private:
  micrograph::FileBytes& file_;
  std::uint64_t at_;
  z_stream stream_{};
  std::vector<std::uint8_t> packed_;
};

class Raw : public Volume
{
public:
  explicit Raw(const RawLayout& layout)
    : layout_(layout)
    , file_(layout.file)
  {
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      if (layout.size[axis] < 1 || layout.size[axis] > std::numeric_limits<int>::max())
      {
        throw InputError(
          fmt::format("the size of '{}' is {} × {} × {}", file_.name(), layout.size[0], layout.size[1], layout.size[2]),
          "a volume has 1 to 2147483647 voxels along each axis");
      }
      extent_[2 * axis] = 0;
      extent_[2 * axis + 1] = static_cast<int>(layout.size[axis] - 1);
    }
    const double layer = static_cast<double>(layout.size[0]) * static_cast<double>(layout.size[1]) * layout.components *
      bytesOf(layout.type);
    const double all = layer * static_cast<double>(layout.size[2]);
    const auto held = static_cast<double>(file_.size()) - static_cast<double>(layout.fromEnd ? 0 : layout.offset);
    const bool wrong = layout.fromEnd ? all > held : all != held;
    if (!layout.packed && wrong)
    {
      throw InputError(
        fmt::format("'{}' has {:.0f} bytes{}, but {} × {} × {} voxels of {}{} take {:.0f}", file_.name(), held,
          layout.offset > 0 ? " after its header" : "", layout.size[0], layout.size[1], layout.size[2],
          layout.components > 1 ? fmt::format("{} × ", layout.components) : "", typeName(layout.type), all),
        "check the size, the type and the length of the header; a file that is too short was truncated");
    }
    layer_ = static_cast<std::uint64_t>(layer);
    begin_ = layout.fromEnd ? file_.size() - static_cast<std::uint64_t>(all) : layout.offset;
  }

  vtkSmartPointer<vtkImageData> read(int first, int last) override
  {
    auto slab = vtkSmartPointer<vtkImageData>::New();
    setPlace(slab, extent_, first, last);
    slab->SetSpacing(layout_.spacing.data());
    slab->SetOrigin(layout_.origin.data());
    slab->SetDirectionMatrix(layout_.direction.data());
    vtkSmartPointer<vtkDataArray> values;
    values.TakeReference(vtkDataArray::CreateDataArray(layout_.type));
    values->SetName(layout_.name.c_str());
    values->SetNumberOfComponents(layout_.components);
    values->SetNumberOfTuples(slab->GetNumberOfPoints());
    const std::uint64_t count = layer_ * static_cast<std::uint64_t>(last - first + 1);
    auto* const to = static_cast<unsigned char*>(values->GetVoidPointer(0));
    if (layout_.packed)
    {
      this->unpack(to, first, last);
    }
    else
    {
      file_.read(begin_ + layer_ * static_cast<std::uint64_t>(first), to, count);
    }
    if (layout_.bigEndian && bytesOf(layout_.type) > 1)
    {
      vtkByteSwap::SwapVoidRange(
        to, static_cast<std::size_t>(values->GetNumberOfValues()), static_cast<std::size_t>(bytesOf(layout_.type)));
    }
    slab->GetPointData()->SetScalars(values);
    setFieldText(slab, "pixel_size_source", layout_.pixelSizeSource);
    return slab;
  }

private:
  /// The last layer that was unpacked is kept: slabs of images with cells begin with it.
  void unpack(unsigned char* to, int first, int last)
  {
    if (unpacker_ == nullptr || first < next_ - 1 || (first == next_ - 1 && kept_.empty()))
    {
      unpacker_ = std::make_unique<Unpacker>(file_, begin_);
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
    {
      unpacker_->read(kept_.data(), layer_);
    }
    for (; next_ <= last; ++next_, to += layer_)
    {
      unpacker_->read(to, layer_);
      if (next_ == last)
      {
        std::copy_n(to, layer_, kept_.begin());
      }
    }
  }

  RawLayout layout_;
  micrograph::FileBytes file_;
  std::uint64_t layer_ = 0;
  std::uint64_t begin_ = 0;
  std::unique_ptr<Unpacker> unpacker_;
  int next_ = 0; ///< the layer that comes next
  std::vector<unsigned char> kept_;
};

std::string lower(std::string text)
{
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::string trimmed(const std::string& text)
{
  const std::size_t begin = text.find_first_not_of(" \t\r\"");
  return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(" \t\r\"") - begin + 1);
}

std::vector<std::string> wordsOf(const std::string& text)
{
  std::vector<std::string> words;
  for (const std::string& word : split(text, ' '))
  {
    if (!trimmed(word).empty())
    {
      words.push_back(trimmed(word));
    }
  }
  return words;
}

/// The lines of a header, "key = value" or "key: value", by key in small letters.
class Header
{
public:
  /// @param separator between key and value
  /// @param last tells the last line; an empty line ends the header too
  Header(const std::string& path, char separator, const std::function<bool(const std::string& key)>& last)
    : path_(path)
  {
    micrograph::FileBytes file(path);
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
      {
        break;
      }
      if (std::ranges::any_of(line, [](unsigned char c) { return c == 0; }))
      {
        break; // values
      }
      first_ = first_.empty() ? line : first_;
      const std::size_t sign = line.find(separator);
      if (line.front() == '#' || sign == std::string::npos)
      {
        continue;
      }
      const std::string key = lower(trimmed(line.substr(0, sign)));
      const std::size_t value = line.find_first_not_of("=", sign + 1); // NRRD's own keys have :=
      values_[key] = value == std::string::npos ? "" : line.substr(value);
      if (last(key))
      {
        break;
      }
    }
  }

  [[nodiscard]] const std::string& firstLine() const { return first_; }
  /// Bytes of the header.
  [[nodiscard]] std::uint64_t end() const { return end_; }
  /// The text of the first of these keys that is there.
  [[nodiscard]] std::string text(std::initializer_list<const char*> keys) const
  {
    for (const char* const key : keys)
    {
      if (const auto found = values_.find(key); found != values_.end())
      {
        return trimmed(found->second);
      }
    }
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
      {
        this->refuse(fmt::format("'{}' is no number", word), "look at its header");
      }
      list.push_back(*number);
    }
    return list;
  }
  [[nodiscard]] std::int64_t integer(std::initializer_list<const char*> keys, std::int64_t otherwise) const
  {
    const std::string value = this->text(keys);
    const auto number = toInteger(value);
    if (!value.empty() && !number)
    {
      this->refuse(fmt::format("'{}' is no whole number", value), "look at its header");
    }
    return number.value_or(otherwise);
  }
  [[noreturn]] void refuse(const std::string& what, const std::string& remedy) const
  {
    throw InputError("the header of '" + path_ + "' cannot be used: " + what, remedy);
  }

private:
  std::string path_;
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
  {
    layout.size[axis] = static_cast<std::int64_t>(sizes[axis]);
  }
}

fs::path beside(const std::string& header, const std::string& name)
{
  const fs::path path(name);
  return path.is_absolute() ? path : fs::path(header).parent_path() / path;
}

/// Metres in a unit of other tools; 1 where there is none.
double metresIn(const std::string& unit)
{
  static const std::map<std::string, double> units{ { "m", 1 }, { "cm", 1e-2 }, { "mm", 1e-3 }, { "um", 1e-6 },
    { "µm", 1e-6 }, { "micron", 1e-6 }, { "microns", 1e-6 }, { "nm", 1e-9 } };
  const auto found = units.find(lower(unit));
  return found == units.end() ? 1 : found->second;
}

const std::map<std::string, int>& metaTypes()
{
  static const std::map<std::string, int> types{ { "MET_UCHAR", VTK_UNSIGNED_CHAR }, { "MET_CHAR", VTK_SIGNED_CHAR },
    { "MET_USHORT", VTK_UNSIGNED_SHORT }, { "MET_SHORT", VTK_SHORT }, { "MET_UINT", VTK_UNSIGNED_INT },
    { "MET_INT", VTK_INT }, { "MET_ULONG_LONG", VTK_UNSIGNED_LONG }, { "MET_LONG_LONG", VTK_LONG },
    { "MET_ULONG", VTK_UNSIGNED_INT }, { "MET_LONG", VTK_INT }, // of 4 bytes in MetaIO
    { "MET_FLOAT", VTK_FLOAT }, { "MET_DOUBLE", VTK_DOUBLE } };
  return types;
}

const std::map<std::string, int>& nrrdTypes()
{
  static const std::map<std::string, int> types{ { "uint8", VTK_UNSIGNED_CHAR }, { "uint8_t", VTK_UNSIGNED_CHAR },
    { "uchar", VTK_UNSIGNED_CHAR }, { "unsigned char", VTK_UNSIGNED_CHAR }, { "int8", VTK_SIGNED_CHAR },
    { "int8_t", VTK_SIGNED_CHAR }, { "signed char", VTK_SIGNED_CHAR }, { "uint16", VTK_UNSIGNED_SHORT },
    { "uint16_t", VTK_UNSIGNED_SHORT }, { "ushort", VTK_UNSIGNED_SHORT }, { "unsigned short", VTK_UNSIGNED_SHORT },
    { "int16", VTK_SHORT }, { "int16_t", VTK_SHORT }, { "short", VTK_SHORT }, { "uint32", VTK_UNSIGNED_INT },
    { "uint32_t", VTK_UNSIGNED_INT }, { "uint", VTK_UNSIGNED_INT }, { "unsigned int", VTK_UNSIGNED_INT },
    { "int32", VTK_INT }, { "int32_t", VTK_INT }, { "int", VTK_INT }, { "signed int", VTK_INT },
    { "uint64", VTK_UNSIGNED_LONG }, { "uint64_t", VTK_UNSIGNED_LONG }, { "unsigned long long", VTK_UNSIGNED_LONG },
    { "ulonglong", VTK_UNSIGNED_LONG }, { "int64", VTK_LONG }, { "int64_t", VTK_LONG }, { "long long", VTK_LONG },
    { "longlong", VTK_LONG }, { "float", VTK_FLOAT }, { "double", VTK_DOUBLE } };
  return types;
}

/// "(1,0,0)" → 1 0 0; nothing for "none".
std::vector<double> vectorOf(const std::string& word, const Header& header)
{
  std::vector<double> list;
  if (word == "none")
  {
    return list;
  }
  for (const std::string& part : split(word.substr(1, word.size() >= 2 ? word.size() - 2 : 0), ','))
  {
    const auto number = toNumber(trimmed(part));
    if (!number)
    {
      header.refuse(fmt::format("'{}' is no vector", word), "look at its header");
    }
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
    {
      length = std::hypot(length, part);
    }
    const bool straight = std::ranges::count(v, 0.0) == static_cast<std::ptrdiff_t>(v.size()) - 1;
    length = straight ? std::abs(std::accumulate(v.begin(), v.end(), 0.0)) : length; // to the last bit
    if (!(length > 0))
    {
      header.refuse("an axis has no length", "look at its space directions");
    }
    layout.spacing[axis] = length * metres;
    for (std::size_t row = 0; row < v.size(); ++row)
    {
      layout.direction[3 * row + axis] = v[row] / length;
    }
  }
}

/// Size and type that a name such as berea_200x200x200_u8.raw says.
struct Named
{
  std::optional<std::array<std::int64_t, 3>> size;
  std::optional<int> type;
};

Named saidBy(const std::string& name)
{
  Named result;
  static const std::regex size("(^|[^0-9])([0-9]{1,6})[xX]([0-9]{1,6})[xX]([0-9]{1,6})([^0-9]|$)");
  static const std::regex type("(^|[^A-Za-z0-9])(u|uint|i|int|f|float)(8|16|32|64)([^0-9]|$)", std::regex::icase);
  static const std::regex bits("(^|[^0-9])(8|16)[-_]?bit", std::regex::icase);
  std::smatch match;
  if (std::regex_search(name, match, size))
  {
    result.size = { std::stoll(match[2]), std::stoll(match[3]), std::stoll(match[4]) };
  }
  if (std::regex_search(name, match, type))
  {
    result.type = typeNamed(lower(match[2].str()).substr(0, 1) + match[3].str());
  }
  else if (std::regex_search(name, match, bits))
  {
    result.type = typeNamed("u" + match[2].str());
  }
  return result;
}

} // namespace

void addRawTypeOptions(CLI::App& command, RawOptions& options)
{
  const auto sample = [](CLI::Option* option) { return option->group("Sample"); };
  sample(command.add_option("--raw-type", options.type, "Type of the numbers in a raw volume: u8, i16, f32 ..."))
    ->type_name("TYPE");
  sample(command.add_option("--raw-order", options.order, "Byte order in a raw volume"))
    ->type_name("little|big")
    ->default_str("little");
}

RawLayout rawLayout(const std::string& path, const RawOptions& options)
{
  const micrograph::ReadOptions read = readOptions(options.picture);
  const std::string notes = notesBeside(path);
  const auto noted = rawNotes(notes);
  const Named named = saidBy(fs::path(path).filename().string());
  RawLayout layout;
  layout.file = path;
  layout.offset = read.rawHeader;
  const auto size = read.rawSize ? read.rawSize : noted ? std::optional(noted->size) : named.size;
  if (!size)
  {
    throw InputError(fmt::format("the size of the raw volume '{}' is not known", path),
      "give it with --raw-size NX,NY,NZ, or put it into the name, such as berea_200x200x200_u8.raw");
  }
  layout.size = *size;
  std::optional<int> type = named.type;
  if (!options.type.empty())
  {
    type = typeNamed(numberTypes()[oneOf("--raw-type", options.type, numberTypes())]);
  }
  else if (read.rawBits)
  {
    type = typeNamed("u" + std::to_string(*read.rawBits));
  }
  else if (noted)
  {
    type = noted->type;
    layout.components = noted->components;
  }
  std::error_code missing;
  const auto bytes = static_cast<double>(fs::file_size(path, missing)) - static_cast<double>(layout.offset);
  const double voxels =
    static_cast<double>(layout.size[0]) * static_cast<double>(layout.size[1]) * static_cast<double>(layout.size[2]);
  if (!type && (bytes == voxels || bytes == 2 * voxels)) // as all commands take it
  {
    type = bytes == voxels ? VTK_UNSIGNED_CHAR : VTK_UNSIGNED_SHORT;
  }
  if (!type)
  {
    throw InputError(fmt::format("the type of the values in '{}' is not known", path),
      "give it with --raw-type u8, u16, i16, f32 …, or put it into the name, such as berea_200x200x200_u8.raw");
  }
  layout.type = *type;
  const std::vector<std::string> orders{ "little", "big" };
  layout.bigEndian = !options.order.empty() && oneOf("--raw-order", options.order, orders) == 1;
  if (read.pixelSize)
  {
    layout.spacing.fill(*read.pixelSize);
    layout.pixelSizeSource = "option";
  }
  const double half = layout.spacing[0] / 2;
  layout.origin = { half, half, layout.size[2] > 1 ? half : 0 };
  return layout;
}

RawLayout metaLayout(const std::string& path)
{
  const Header header(path, '=', [](const std::string& key) { return key == "elementdatafile"; });
  RawLayout layout;
  const std::string data = header.text({ "elementdatafile" });
  if (data.empty() || header.text({ "dimsize" }).empty())
  {
    header.refuse("it has no DimSize or no ElementDataFile", "give a whole .mhd or .mha file");
  }
  setSizes(layout, header.numbers({ "dimsize" }), header);
  const std::string type = header.text({ "elementtype" });
  if (!metaTypes().contains(type))
  {
    header.refuse(fmt::format("its ElementType is '{}'", type), "numbers of up to 64 bits can be read");
  }
  layout.type = metaTypes().at(type);
  layout.components =
    static_cast<int>(std::clamp<std::int64_t>(header.integer({ "elementnumberofchannels" }, 1), 1, 64));
  layout.bigEndian = lower(header.text({ "binarydatabyteordermsb", "elementbyteordermsb" })).starts_with("t");
  layout.packed = lower(header.text({ "compresseddata" })).starts_with("t");
  if (lower(header.text({ "binarydata" })).starts_with("f"))
  {
    header.refuse("its values are text (BinaryData = False)", "write them as binary");
  }
  if (data == "LIST" || data.find('%') != std::string::npos)
  {
    header.refuse("its values are in several files", "convert those as a stack: a pattern such as slice_%03d.png");
  }
  const bool inside = data == "LOCAL" || data == "Local" || data == "local";
  layout.file = inside ? fs::path(path) : beside(path, data);
  const std::int64_t skip = header.integer({ "headersize" }, 0);
  layout.fromEnd = skip < 0;
  layout.offset = inside ? header.end() : static_cast<std::uint64_t>(std::max<std::int64_t>(0, skip));
  const std::string unit = header.text({ "distanceunits" });
  const double metres = metresIn(unit);
  const auto spacing = header.numbers({ "elementspacing", "elementsize" });
  const auto origin = header.numbers({ "offset", "position", "origin" });
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    layout.spacing[axis] = axis < spacing.size() ? spacing[axis] * metres : 1;
    layout.origin[axis] = axis < origin.size() ? origin[axis] * metres : 0;
    if (!(layout.spacing[axis] > 0))
    {
      header.refuse(fmt::format("a spacing of {}", layout.spacing[axis]), "a spacing is a positive length");
    }
  }
  layout.pixelSizeSource = spacing.empty() ? "none" : "MetaImage ElementSpacing";
  const auto turn = header.numbers({ "transformmatrix", "rotation", "orientation" });
  const std::size_t axes = turn.size() == 9 ? 3 : turn.size() == 4 ? 2 : 0;
  for (std::size_t row = 0; row < axes; ++row)
  {
    for (std::size_t column = 0; column < axes; ++column)
    {
      layout.direction[3 * row + column] = turn[axes * column + row]; // a row of the file is an axis
    }
  }
  return layout;
}

RawLayout nrrdLayout(const std::string& path)
{
  const Header header(path, ':', [](const std::string&) { return false; });
  if (!header.firstLine().starts_with("NRRD00"))
  {
    throw InputError("'" + path + "' is not an NRRD file", "its first line is NRRD0004 or the like");
  }
  RawLayout layout;
  const std::string type = lower(header.text({ "type" }));
  if (!nrrdTypes().contains(type))
  {
    header.refuse(fmt::format("its type is '{}'", type), "numbers of up to 64 bits can be read");
  }
  layout.type = nrrdTypes().at(type);
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
    {
      words->erase(words->begin(), words->begin() + (words->empty() ? 0 : 1));
    }
    sizes.erase(sizes.begin());
    spacings.erase(spacings.begin(), spacings.begin() + (spacings.empty() ? 0 : 1));
  }
  setSizes(layout, sizes, header);
  const std::string encoding = lower(header.text({ "encoding" }));
  layout.packed = encoding == "gzip" || encoding == "gz";
  if (!layout.packed && encoding != "raw")
  {
    header.refuse(fmt::format("its encoding is '{}'", encoding), "raw and gzip can be read: save it as one of these");
  }
  layout.bigEndian = lower(header.text({ "endian" })) == "big";
  const std::string data = header.text({ "data file", "datafile" });
  if (data.find('%') != std::string::npos || data == "LIST" || data.starts_with("LIST "))
  {
    header.refuse("its values are in several files", "convert those as a stack: a pattern such as slice_%03d.png");
  }
  if (header.integer({ "line skip", "lineskip" }, 0) != 0)
  {
    header.refuse("it skips lines", "give the number of bytes instead (byte skip)");
  }
  const std::int64_t skip = header.integer({ "byte skip", "byteskip" }, 0);
  layout.fromEnd = skip < 0;
  layout.file = data.empty() ? fs::path(path) : beside(path, data);
  layout.offset = (data.empty() ? header.end() : 0) + static_cast<std::uint64_t>(std::max<std::int64_t>(0, skip));
  const auto units = wordsOf(header.text({ "space units", "units" }));
  const double metres = units.empty() ? 1 : metresIn(units.front());
  if (!directions.empty())
  {
    std::vector<std::vector<double>> axes;
    for (const std::string& word : directions)
    {
      axes.push_back(vectorOf(word, header));
    }
    setDirections(layout, axes, metres, header);
    layout.pixelSizeSource = "NRRD space directions";
  }
  else if (!spacings.empty())
  {
    for (std::size_t axis = 0; axis < std::min<std::size_t>(3, spacings.size()); ++axis)
    {
      layout.spacing[axis] = std::isfinite(spacings[axis]) && spacings[axis] > 0 ? spacings[axis] * metres : 1;
    }
    layout.pixelSizeSource = "NRRD spacings";
  }
  if (const std::string origin = header.text({ "space origin" }); !origin.empty())
  {
    const auto numbers = vectorOf(origin, header);
    for (std::size_t axis = 0; axis < std::min<std::size_t>(3, numbers.size()); ++axis)
    {
      layout.origin[axis] = numbers[axis] * metres;
    }
  }
  return layout;
}

std::unique_ptr<Volume> openRaw(const RawLayout& layout)
{
  return std::make_unique<Raw>(layout);
}

ByteStream::ByteStream(const OutputFile& file)
  : file_(file)
  , number_(::open(file.temporary().c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC))
{
  if (number_ < 0)
  {
    file.failed(std::strerror(errno));
  }
}

ByteStream::~ByteStream()
{
  if (number_ >= 0)
  {
    ::close(number_);
  }
}

void ByteStream::write(const void* bytes, std::size_t count)
{
  const auto* from = static_cast<const char*>(bytes);
  while (count > 0)
  {
    const ssize_t written = ::write(number_, from, count);
    if (written < 0 && errno != EINTR)
    {
      file_.failed(std::strerror(errno));
    }
    from += std::max<ssize_t>(0, written);
    count -= static_cast<std::size_t>(std::max<ssize_t>(0, written));
  }
}

void ByteStream::finish()
{
  if (::close(std::exchange(number_, -1)) != 0)
  {
    file_.failed(std::strerror(errno));
  }
}

namespace
{

template <typename Map>
std::string wordFor(const Map& types, int type)
{
  const std::string name = type == VTK_CHAR ? "i8" : type == VTK_ID_TYPE ? "i64" : typeName(type);
  for (const auto& [word, value] : types)
  {
    if (value == type || (typeName(value) == name && vtkDataArray::GetDataTypeSize(value) == bytesOf(type)))
    {
      return word;
    }
  }
  return "";
}

int axesOf(const std::array<int, 6>& extent)
{
  return extent[5] > extent[4] ? 3 : 2;
}

/// A vector of the place's axes: its first numbers, all their digits.
std::string numbersText(const double* numbers, int count, const char* separator)
{
  return fmt::format("{}", fmt::join(numbers, numbers + count, separator));
}

/// Where the first point lies: what VTK calls the origin is the place of point 0, 0, 0 even where the extent begins
/// elsewhere.
std::array<double, 3> firstPoint(vtkImageData* sample, const std::array<int, 6>& extent)
{
  std::array<double, 3> place{};
  sample->TransformIndexToPhysicalPoint(extent[0], extent[2], extent[4], place.data());
  return place;
}

} // namespace

std::string metaHeader(vtkImageData* sample, const std::array<int, 6>& extent, const std::string& data)
{
  const int axes = axesOf(extent);
  vtkDataArray* const values = onlyArray(sample);
  const auto origin = firstPoint(sample, extent);
  const double* const direction = sample->GetDirectionMatrix()->GetData();
  std::vector<double> turn;
  for (int axis = 0; axis < axes; ++axis)
  {
    for (int row = 0; row < axes; ++row)
    {
      turn.push_back(direction[3 * row + axis]);
    }
  }
  std::string size;
  for (int axis = 0; axis < axes; ++axis)
  {
    const auto at = static_cast<std::size_t>(2 * axis);
    size += (axis > 0 ? " " : "") + std::to_string(extent[at + 1] - extent[at] + 1);
  }
  std::string text = fmt::format("ObjectType = Image\nNDims = {}\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
                                 "CompressedData = False\nTransformMatrix = {}\nOffset = {}\nElementSpacing = {}\n"
                                 "DimSize = {}\n",
    axes, fmt::join(turn, " "), numbersText(origin.data(), axes, " "), numbersText(sample->GetSpacing(), axes, " "),
    size);
  if (values->GetNumberOfComponents() > 1)
  {
    text += fmt::format("ElementNumberOfChannels = {}\n", values->GetNumberOfComponents());
  }
  return text +
    fmt::format("ElementType = {}\nElementDataFile = {}\n", wordFor(metaTypes(), values->GetDataType()),
      data.empty() ? "LOCAL" : data);
}

std::string nrrdHeader(vtkImageData* sample, const std::array<int, 6>& extent, const std::string& data)
{
  const int axes = axesOf(extent);
  vtkDataArray* const values = onlyArray(sample);
  const int components = values->GetNumberOfComponents();
  const auto origin = firstPoint(sample, extent);
  const double* const direction = sample->GetDirectionMatrix()->GetData();
  std::string sizes = components > 1 ? std::to_string(components) : "";
  std::string kinds = components == 3 ? "vector" : components > 1 ? "list" : "";
  std::string directions = components > 1 ? "none" : "";
  std::string units;
  for (int axis = 0; axis < axes; ++axis)
  {
    const auto at = static_cast<std::size_t>(2 * axis);
    const char* const blank = sizes.empty() ? "" : " ";
    sizes += blank + std::to_string(extent[at + 1] - extent[at] + 1);
    kinds += std::string(blank) + "domain";
    std::vector<double> vector;
    for (int row = 0; row < axes; ++row)
    {
      vector.push_back(direction[3 * row + axis] * sample->GetSpacing()[axis]);
    }
    directions += fmt::format("{}({})", blank, fmt::join(vector, ","));
    units += std::string(axis > 0 ? " " : "") + "\"m\"";
  }
  std::string text = fmt::format("NRRD0004\ntype: {}\ndimension: {}\nspace dimension: {}\nsizes: {}\n"
                                 "space directions: {}\nkinds: {}\nendian: little\nencoding: raw\nspace units: {}\n"
                                 "space origin: ({})\n",
    wordFor(nrrdTypes(), values->GetDataType()), axes + (components > 1 ? 1 : 0), axes, sizes, directions, kinds, units,
    numbersText(origin.data(), axes, ","));
  return text + (data.empty() ? "\n" : "data file: " + data + "\n");
}

} // namespace lamella::cli
