#include "XmlArrays.h"

#include "core/Error.h"
#include "core/Lower.h"

#include "vtkBase64InputStream.h"
#include "vtkDataCompressor.h"
#include "vtkNew.h"
#include "vtkXMLDataElement.h"
#include "vtkXMLDataParser.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <istream>
#include <limits>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>

namespace lamella
{
namespace
{

struct Type
{
  std::string_view name;
  int bytes;
  int vtk;
};

/// "Bit" is missing: VTK cannot read a part of such an array, and nobody writes one.
constexpr std::array<Type, 11> types{ { { "Float32", 4, VTK_FLOAT }, { "Float64", 8, VTK_DOUBLE },
  { "Int8", 1, VTK_SIGNED_CHAR }, { "UInt8", 1, VTK_UNSIGNED_CHAR }, { "Int16", 2, VTK_SHORT },
  { "UInt16", 2, VTK_UNSIGNED_SHORT }, { "Int32", 4, VTK_INT }, { "UInt32", 4, VTK_UNSIGNED_INT },
  { "Int64", 8, VTK_LONG_LONG }, { "UInt64", 8, VTK_UNSIGNED_LONG_LONG }, { "String", 1, VTK_CHAR } } };

const Type* typeOf(std::string_view name)
{
  const auto* const found = std::ranges::find(types, name, &Type::name);
  return found == types.end() ? nullptr : found;
}

/// VTK puts a long text together 1024 letters at a time and copies it each time.
constexpr std::uint64_t longestText = std::uint64_t{ 1 } << 22;
constexpr std::uint64_t mostLetters = std::uint64_t{ 1 } << 26;

constexpr std::uint64_t charactersOf(std::uint64_t bytes) // in base64
{
  return (bytes + 2) / 3 * 4;
}

std::string_view attribute(vtkXMLDataElement* element, const char* name)
{
  const char* const text = element->GetAttribute(name);
  return text == nullptr ? std::string_view() : std::string_view(text);
}

std::optional<std::int64_t> wholeNumber(std::string_view text)
{
  std::int64_t value = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  return fault == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

bool isSpace(char c)
{
  return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\v' || c == '\f';
}

/// Whether VTK, which reads numbers from a stream, takes a word for a value of this type, and for that value only.
template <typename Value>
bool isNumber(std::string_view word)
{
  word.remove_prefix(word.starts_with('+') ? 1 : 0);
  Value value{};
  const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
  const bool tiny = std::is_floating_point_v<Value> && fault == std::errc::result_out_of_range &&
    std::abs(std::strtod(std::string(word).c_str(), nullptr)) < 1; // VTK makes 0 of it
  return (fault == std::errc() || tiny) && end == word.data() + word.size() && !word.empty();
}

template <typename Value>
bool isReal(std::string_view word)
{
  const std::string small = lower(std::string(word));
  if (small == "nan" || small == "inf" || small == "-inf") // all that VTK knows, and it knows them
    return true;
  return small.find_first_of("infatyx") == std::string::npos && isNumber<Value>(word);
}

/// As one of the types that the format knows.
bool isValue(std::string_view word, const XmlArray& head)
{
  const Type* const type = typeOf(head.type);
  switch (type->vtk)
  {
    case VTK_FLOAT:
      return isReal<float>(word);
    case VTK_DOUBLE:
      return isReal<double>(word);
    case VTK_SIGNED_CHAR:
      return isNumber<std::int8_t>(word);
    case VTK_UNSIGNED_CHAR:
      return isNumber<std::uint8_t>(word);
    case VTK_CHAR: // written with or without a sign
      return isNumber<std::uint8_t>(word) || isNumber<std::int8_t>(word);
    case VTK_SHORT:
      return isNumber<std::int16_t>(word);
    case VTK_UNSIGNED_SHORT:
      return isNumber<std::uint16_t>(word);
    case VTK_INT:
      return isNumber<std::int32_t>(word);
    case VTK_UNSIGNED_INT:
      return isNumber<std::uint32_t>(word);
    case VTK_LONG_LONG:
      return isNumber<std::int64_t>(word);
    default:
      return isNumber<std::uint64_t>(word);
  }
}

/// Goes through a part of a stream a block at a time.
class Walk
{
public:
  Walk(std::istream& stream, std::int64_t first)
    : stream_(stream)
  {
    stream_.clear();
    stream_.seekg(first);
  }

  /// The next letter; nothing at the end.
  std::optional<char> next()
  {
    if (at_ == held_)
    {
      stream_.read(block_.data(), static_cast<std::streamsize>(block_.size()));
      held_ = static_cast<std::size_t>(stream_.gcount());
      at_ = 0;
      stream_.clear();
      if (held_ == 0)
        return std::nullopt;
    }
    return block_[at_++];
  }

private:
  std::istream& stream_;
  std::array<char, 1 << 16> block_;
  std::size_t at_ = 0;
  std::size_t held_ = 0;
};

/// Whether so many bytes stand there in base64, padded as they must be.
bool isBase64(Walk& walk, std::uint64_t bytes)
{
  const std::uint64_t pads = (3 - bytes % 3) % 3;
  const std::uint64_t letters = charactersOf(bytes) - pads;
  for (std::uint64_t i = 0; i < letters + pads; ++i)
  {
    const auto c = walk.next();
    const bool letter =
      c && ((*c >= 'A' && *c <= 'Z') || (*c >= 'a' && *c <= 'z') || (*c >= '0' && *c <= '9') || *c == '+' || *c == '/');
    if (i < letters ? !letter : c != '=')
      return false;
  }
  return true;
}

} // namespace

XmlArrays::XmlArrays(vtkXMLDataParser* parser, std::string path)
  : parser_(parser)
  , path_(std::move(path))
  , appended_(parser->GetAppendedDataPosition())
{
  std::istream& stream = *parser->GetStream();
  stream.clear();
  stream.seekg(0, std::ios::end);
  size_ = stream.tellg();
  vtkXMLDataElement* const root = parser->GetRootElement();
  word_ = attribute(root, "header_type") == "UInt64" ? 8 : 4;
  swap_ = (attribute(root, "byte_order") == "BigEndian") != (std::endian::native == std::endian::big) &&
    !attribute(root, "byte_order").empty();
  for (int i = 0; i < root->GetNumberOfNestedElements(); ++i)
  {
    vtkXMLDataElement* const nested = root->GetNestedElement(i);
    if (std::string_view(nested->GetName()) == "AppendedData")
    {
      const auto encoding = attribute(nested, "encoding");
      appendedRaw_ = encoding == "raw";
      if (!appendedRaw_ && encoding != "base64")
      {
        throw InputError(
          fmt::format("'{}' is damaged: its appended data are in no known encoding, '{}'", path_, encoding),
          "make or copy it again");
      }
    }
  }
}

void XmlArrays::damaged(const XmlArray& head, const std::string& what) const
{
  throw InputError(fmt::format("'{}' is damaged: array '{}' {}", path_, head.name, what), "make or copy it again");
}

XmlArray XmlArrays::head(vtkXMLDataElement* element) const
{
  XmlArray head;
  head.name = attribute(element, "Name");
  if (vtkXMLDataElement* const parent = element->GetParent();
      head.name.empty() && parent != nullptr && std::string_view(parent->GetName()) == "Points")
    head.name = "Points"; // which is found by its place, and needs no name
  if (head.name.empty())
    throw InputError(fmt::format("'{}' is damaged: an array in it has no name", path_), "make or copy it again");
  head.type = attribute(element, "type");
  const Type* const type = typeOf(head.type);
  if (type == nullptr)
    damaged(head, fmt::format("is of type '{}', which there is not", head.type));
  head.bytes = type->bytes;
  if (const auto components = attribute(element, "NumberOfComponents"); !components.empty())
  {
    const auto value = wholeNumber(components);
    if (!value || *value < 1 || *value > 9999)
      damaged(head, fmt::format("has {} components", components));
    head.components = static_cast<int>(*value);
  }
  if (element->GetAttribute("TimeStep") != nullptr)
    damaged(head, "is of one time of several, which a file of one state has not");
  return head;
}

bool XmlArrays::isText(vtkXMLDataElement* element) const
{
  return element->GetAttribute("offset") == nullptr && attribute(element, "format") != "binary";
}

/// As VTK finds it: appended when there is an offset, whatever the format says.
XmlArrays::Place XmlArrays::placeOf(vtkXMLDataElement* element, const XmlArray& head) const
{
  const auto format = attribute(element, "format");
  const bool appended = element->GetAttribute("offset") != nullptr;
  if (appended != (format == "appended") || (!appended && format != "binary" && format != "ascii" && !format.empty()))
    damaged(head, fmt::format("has format '{}' {} an offset", format, appended ? "and" : "without"));
  if (appended)
  {
    const auto offset = wholeNumber(attribute(element, "offset"));
    if (appended_ <= 0 || !offset || *offset < 0 || *offset >= size_ - appended_)
      damaged(head, fmt::format("has its data at {}, where there are none", attribute(element, "offset")));
    return { appended_ + *offset, size_, !appendedRaw_, true };
  }
  // VTK takes the first '>' for the end of the tag and what follows, up to the next '<', for the data.
  Walk walk(*parser_->GetStream(), element->GetXMLByteIndex());
  std::int64_t at = element->GetXMLByteIndex();
  auto c = walk.next();
  for (char quote = '\0'; c && (*c != '>' || quote != '\0'); c = walk.next(), ++at)
  {
    if (*c == '>')
      damaged(head, "has a '>' in its tag, which is not read");
    quote = quote == '\0' ? (*c == '"' || *c == '\'' ? *c : '\0') : (*c == quote ? '\0' : quote);
  }
  do
  {
    c = walk.next();
    ++at;
  } while (c && isSpace(*c));
  Place place{ at, at, true, false };
  for (; c && *c != '<'; c = walk.next())
    ++place.end;
  return place;
}

std::uint64_t XmlArrays::word(const std::vector<unsigned char>& bytes, std::size_t index) const
{
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < word_; ++i)
  {
    const std::size_t byte = swap_ ? i : word_ - 1 - i; // the highest first
    value = value << 8 | bytes[index * word_ + byte];
  }
  return value;
}

std::vector<unsigned char> XmlArrays::read(const Place& place, const XmlArray& head, std::uint64_t bytes) const
{
  const std::uint64_t stored = place.base64 ? charactersOf(bytes) : bytes;
  if (stored > static_cast<std::uint64_t>(place.end - place.first))
    damaged(head, "ends before its first value");
  std::istream& stream = *parser_->GetStream();
  stream.clear();
  stream.seekg(place.first);
  std::vector<unsigned char> result(bytes);
  std::uint64_t got = 0;
  if (place.base64)
  {
    vtkNew<vtkBase64InputStream> decoder;
    decoder->SetStream(&stream);
    decoder->StartReading();
    got = decoder->Read(result.data(), bytes);
    decoder->EndReading();
  }
  else
  {
    stream.read(reinterpret_cast<char*>(result.data()), static_cast<std::streamsize>(bytes)); // NOLINT: bytes
    got = static_cast<std::uint64_t>(stream.gcount());
  }
  stream.clear();
  if (got < bytes)
    damaged(head, "ends before its first value");
  return result;
}

/// Byte of the file behind so many bytes of data that begin at `first`, and are all there.
std::int64_t XmlArrays::endOf(const Place& place, std::int64_t first, std::uint64_t bytes, const XmlArray& head) const
{
  const std::uint64_t stored = place.base64 ? charactersOf(bytes) : bytes;
  if (stored > static_cast<std::uint64_t>(place.end - first))
    damaged(head, "ends before its last value");
  if (place.base64)
  {
    Walk walk(*parser_->GetStream(), first);
    if (!isBase64(walk, bytes))
      damaged(head, "is not written in base64");
  }
  return first + static_cast<std::int64_t>(stored);
}

std::uint64_t XmlArrays::countText(const Place& place, const XmlArray& head) const
{
  Walk walk(*parser_->GetStream(), place.first);
  std::uint64_t count = 0;
  std::string word;
  for (std::int64_t at = place.first; at <= place.end; ++at)
  {
    const auto c = at < place.end ? walk.next() : std::optional(' ');
    if (c && !isSpace(*c))
    {
      word += *c;
      if (word.size() > 400)
        damaged(head, "holds what is no number");
    }
    else if (!word.empty())
    {
      if (!isValue(word, head))
        damaged(head, fmt::format("holds '{}', which is no {}", word.substr(0, 40), head.type));
      ++count;
      word.clear();
    }
  }
  return count;
}

/// Bytes of values in binary data, from the head.
std::uint64_t XmlArrays::bytesHeld(const Place& place, const XmlArray& head)
{
  std::uint64_t held = 0;
  std::int64_t end = 0;
  const auto room = static_cast<std::uint64_t>(size_);
  if (parser_->GetCompressor() == nullptr)
  {
    held = word(read(place, head, word_), 0);
    if (held > room)
      damaged(head, "ends before its last value");
    end = endOf(place, place.first, word_ + held, head);
  }
  else
  {
    const auto first = read(place, head, 3 * word_);
    const std::uint64_t blocks = word(first, 0);
    const std::uint64_t block = word(first, 1);
    const std::uint64_t last = word(first, 2);
    // A block of a compressor is at most 2^31 - 1 bytes.
    constexpr std::uint64_t most = std::numeric_limits<std::int32_t>::max();
    if (blocks > room / word_ || block > most || last > block || (blocks > 0 && block == 0) ||
      (blocks == 0 && last != 0))
      damaged(head, fmt::format("is cut into {} blocks of {} bytes, the last of {}", blocks, block, last));
    held = blocks == 0 ? 0 : (last == 0 ? blocks * block : (blocks - 1) * block + last);
    const std::uint64_t heading = (3 + blocks) * word_;
    const auto sizes = read(place, head, heading);
    std::uint64_t packed = 0;
    for (std::uint64_t i = 0; i < blocks; ++i)
    {
      const std::uint64_t size = word(sizes, 3 + i);
      if (size > most || size > room)
        damaged(head, fmt::format("has a block of {} bytes", size));
      packed += size;
    }
    if (packed > room)
      damaged(head, "ends before its last value");
    end = endOf(place, endOf(place, place.first, heading, head), packed, head);
  }
  if (place.appended)
  {
    spans_.push_back({ place.first, end, head.name });
    return held;
  }
  Walk walk(*parser_->GetStream(), end);
  for (; end < place.end; ++end)
    if (const auto c = walk.next(); !c || !isSpace(*c))
      damaged(head, "goes on behind its last value");
  return held;
}

void XmlArrays::requireTuples(vtkXMLDataElement* element, const XmlArray& head, std::int64_t tuples)
{
  const Place place = placeOf(element, head);
  const std::uint64_t held =
    isText(element) ? countText(place, head) * static_cast<std::uint64_t>(head.bytes) : bytesHeld(place, head);
  const std::uint64_t values = static_cast<std::uint64_t>(tuples) * static_cast<std::uint64_t>(head.components);
  if (head.isText())
    requireTexts(element, head, held, values);
  else if (const auto size = static_cast<std::uint64_t>(head.bytes); held % size != 0 || held / size != values)
    damaged(head, fmt::format("holds {} values where {} are told", (held + size - 1) / size, values));
}

void XmlArrays::requireTexts(
  vtkXMLDataElement* element, const XmlArray& head, std::uint64_t letters, std::uint64_t texts)
{
  if (letters > mostLetters || texts > letters)
    damaged(head, fmt::format("holds {} letters for {} texts", letters, texts));
  std::string text(letters, '\1');
  if (letters > 0 &&
    (element->GetAttribute("offset") != nullptr
        ? parser_->ReadAppendedData(
            wholeNumber(attribute(element, "offset")).value_or(0), text.data(), 0, letters, VTK_CHAR)
        : parser_->ReadInlineData(element, isText(element) ? 1 : 0, text.data(), 0, letters, VTK_CHAR)) != letters)
    damaged(head, "cannot be unpacked");
  std::uint64_t found = 0;
  std::uint64_t length = 0;
  for (const char c : text)
  {
    length = c == '\0' ? 0 : length + 1;
    found += c == '\0' ? 1 : 0;
    if (length > longestText)
      damaged(head, fmt::format("holds a text of more than {} letters", longestText));
  }
  if (found != texts || length != 0)
    damaged(head, fmt::format("holds {} texts where {} are told", found + (length != 0 ? 1 : 0), texts));
}

std::vector<std::int64_t> XmlArrays::wholeNumbers(vtkXMLDataElement* element, const XmlArray& head, std::int64_t tuples)
{
  std::vector<std::int64_t> numbers(static_cast<std::size_t>(tuples));
  std::vector<unsigned char> bytes(numbers.size() * static_cast<std::size_t>(head.bytes));
  const int type = typeOf(head.type)->vtk;
  if (tuples == 0)
    return numbers;
  const std::size_t got = element->GetAttribute("offset") != nullptr
    ? parser_->ReadAppendedData(
        wholeNumber(attribute(element, "offset")).value_or(0), bytes.data(), 0, numbers.size(), type)
    : parser_->ReadInlineData(element, isText(element) ? 1 : 0, bytes.data(), 0, numbers.size(), type);
  if (got != numbers.size())
    damaged(head, "cannot be unpacked");
  const auto take = [&]<typename Value>(Value)
  {
    for (std::size_t i = 0; i < numbers.size(); ++i)
    {
      Value value{};
      std::memcpy(&value, bytes.data() + i * sizeof(Value), sizeof(Value));
      numbers[i] = static_cast<std::int64_t>(value);
    }
  };
  switch (type)
  {
    case VTK_SIGNED_CHAR:
      take(std::int8_t{});
      break;
    case VTK_UNSIGNED_CHAR:
      take(std::uint8_t{});
      break;
    case VTK_SHORT:
      take(std::int16_t{});
      break;
    case VTK_UNSIGNED_SHORT:
      take(std::uint16_t{});
      break;
    case VTK_INT:
      take(std::int32_t{});
      break;
    case VTK_UNSIGNED_INT:
      take(std::uint32_t{});
      break;
    case VTK_LONG_LONG:
      take(std::int64_t{});
      break;
    case VTK_UNSIGNED_LONG_LONG:
      take(std::uint64_t{});
      break;
    default:
      damaged(head, fmt::format("is of type {}, and holds whole numbers", head.type));
  }
  return numbers;
}

void XmlArrays::requireApart()
{
  std::ranges::sort(spans_, {}, [](const Span& s) { return std::pair(s.first, s.end); });
  for (std::size_t i = 1; i < spans_.size(); ++i)
  {
    const Span& before = spans_[i - 1];
    const Span& here = spans_[i];
    if (here.first < before.end && (here.first != before.first || here.end != before.end))
    {
      throw InputError(
        fmt::format("'{}' is damaged: arrays '{}' and '{}' share a part of their bytes", path_, before.name, here.name),
        "make or copy it again");
    }
  }
}

} // namespace lamella
