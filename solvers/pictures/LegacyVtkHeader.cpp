#include "pictures/RawVolume.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <map>

// The format: "VTK File Formats", https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html
namespace lamella::micrograph
{

namespace
{

/// Words and lines of a text whose values may be binary.
class LegacyVtkText
{
public:
  LegacyVtkText(FileBytes& file, std::uint64_t from)
    : name_(file.name())
  {
    const auto bytes = file.read(from, std::min<std::uint64_t>(file.size() - from, std::uint64_t{ 1 } << 20));
    text_.assign(bytes.begin(), bytes.end());
  }

  [[nodiscard]] std::uint64_t at() const { return at_; }
  [[nodiscard]] bool ended() const { return at_ >= text_.size(); }

  /// The rest of a line.
  std::string line()
  {
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    std::string result = text_.substr(at_, end - at_);
    at_ = std::min(end + 1, text_.size());
    if (result.ends_with('\r'))
      result.pop_back();
    return result;
  }
  std::string word()
  {
    at_ = std::min(text_.find_first_not_of(" \t\r\n", at_), text_.size());
    const std::size_t end = std::min(text_.find_first_of(" \t\r\n", at_), text_.size());
    std::string result = text_.substr(at_, std::min<std::size_t>(end - at_, 200));
    at_ = end;
    return result;
  }
  double number()
  {
    const std::string text = this->word();
    double value = 0;
    const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (failed != std::errc() || end != text.data() + text.size())
      this->refuse(fmt::format("'{}' is no number", text), "look at its header");
    return value;
  }
  [[noreturn]] void refuse(const std::string& what, const std::string& remedy) const
  {
    throw InputError("the header of '" + name_ + "' cannot be used: " + what, remedy);
  }

private:
  std::string name_;
  std::string text_;
  std::size_t at_ = 0;
};

NumberType legacyVtkType(const std::string& type, const LegacyVtkText& text)
{
  static const std::map<std::string, NumberType> types{ { "unsigned_char", { 'u', 1 } }, { "char", { 'i', 1 } },
    { "signed_char", { 'i', 1 } }, { "unsigned_short", { 'u', 2 } }, { "short", { 'i', 2 } },
    { "unsigned_int", { 'u', 4 } }, { "int", { 'i', 4 } }, { "vtktypeuint64", { 'u', 8 } },
    { "vtktypeint64", { 'i', 8 } }, { "float", { 'f', 4 } }, { "double", { 'f', 8 } } };
  const auto known = types.find(type);
  if (known == types.end())
    text.refuse(fmt::format("its values are of type '{}'", type), "save them as unsigned_char, int, float or the like");
  return known->second;
}

/// Behind the array: nothing, or what newer writers say of it.
/// @returns whether there are other values
bool otherValues(LegacyVtkText& text)
{
  while (!text.ended())
  {
    const std::string word = text.word();
    if (word.empty())
      return false;
    if (word != "METADATA")
      return true;
    (void)text.line();
    while (!text.ended() && !text.line().empty())
    {
    }
  }
  return false;
}

/// What stands before the first array's values: their type, and how many a node has.
std::string typeOfValues(LegacyVtkText& text, RawLayout& layout)
{
  std::string type;
  if (const std::string word = text.word(); word == "SCALARS")
  {
    (void)text.word(); // a name
    type = text.word();
    layout.components = static_cast<int>(std::clamp(std::strtol(text.line().c_str(), nullptr, 10), 1L, 64L));
    if (text.word() != "LOOKUP_TABLE")
      text.refuse("no LOOKUP_TABLE before its values", "save it as .vti");
    (void)text.line();
  }
  else if (word == "COLOR_SCALARS") // as VTK calls unsigned char
  {
    (void)text.word();
    layout.components = static_cast<int>(std::clamp(text.number(), 1.0, 64.0));
    type = "unsigned_char";
    (void)text.line();
  }
  else if (word == "FIELD")
  {
    (void)text.word();
    if (const double arrays = text.number(); arrays != 1)
      text.refuse(fmt::format("it holds {} arrays", arrays), "save one of them, or all as .vti");
    (void)text.word();
    layout.components = static_cast<int>(std::clamp(text.number(), 1.0, 64.0));
    (void)text.number();
    type = text.word();
    (void)text.line();
  }
  else
  {
    text.refuse(fmt::format("'{}' in place of SCALARS or FIELD", word), "save it as .vti");
  }
  return type;
}

} // namespace

RawLayout legacyVtkLayout(const std::filesystem::path& path)
{
  FileBytes file(path);
  LegacyVtkText text(file, 0);
  if (!text.line().starts_with("# vtk DataFile Version"))
    throw InputError(
      "'" + path.string() + "' is not a VTK file", "its first line is # vtk DataFile Version 3.0 or the like");
  (void)text.line(); // a title
  if (const std::string mode = text.word(); mode != "BINARY")
    text.refuse("its values are text", "save it as binary, or as .vti");
  (void)text.word();
  if (const std::string kind = text.word(); kind != "STRUCTURED_POINTS")
    text.refuse(
      fmt::format("it holds {}", kind), "images (STRUCTURED_POINTS) can be read: save it as .vti, .vtp or .vtu");

  RawLayout layout;
  layout.file = path;
  layout.unitTold = false;
  layout.bigEndian = true;
  std::array<double, 3> points{ 1, 1, 1 };
  const auto three = [&](std::array<double, 3>& to) { std::ranges::generate(to, [&] { return text.number(); }); };
  double told = -1;
  bool inCells = false;
  while (told < 0)
  {
    const std::string word = text.word();
    inCells = word == "CELL_DATA";
    if (word == "DIMENSIONS")
      three(points);
    else if (word == "ORIGIN")
      three(layout.origin);
    else if (word == "SPACING" || word == "ASPECT_RATIO")
      three(layout.spacing);
    else if (inCells || word == "POINT_DATA")
      told = text.number();
    else
      text.refuse(fmt::format("'{}' before its values", word), "save it as .vti");
  }
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    const double nodes = inCells ? std::max(1.0, points[axis] - 1) : points[axis];
    if (!(nodes >= 1 && nodes < 1e12) || !(layout.spacing[axis] > 0))
      text.refuse(
        fmt::format("{} nodes of spacing {} along an axis", nodes, layout.spacing[axis]), "look at its header");
    layout.size[axis] = static_cast<std::int64_t>(nodes);
    layout.origin[axis] += inCells ? layout.spacing[axis] / 2 : 0;
  }
  layout.axes = layout.size[2] == 1 ? 2 : 3;
  layout.pixelSizeSource = layout.spacing == std::array<double, 3>{ 1, 1, 1 } ? "none" : "VTK SPACING";

  const std::string type = typeOfValues(text, layout);
  layout.type = legacyVtkType(type, text);
  layout.offset = text.at();

  const double bytes = static_cast<double>(layout.size[0]) * static_cast<double>(layout.size[1]) *
    static_cast<double>(layout.size[2]) * layout.components * layout.type.bytes;
  if (told * layout.components * layout.type.bytes != bytes)
    text.refuse(fmt::format("{} values for {} × {} × {} {}", told, layout.size[0], layout.size[1], layout.size[2],
                  inCells ? "cells" : "points"),
      "look at its header");
  const auto end = static_cast<double>(layout.offset) + bytes;
  if (end < static_cast<double>(file.size()))
  {
    const auto from = static_cast<std::uint64_t>(end);
    LegacyVtkText behind(file, from);
    if (otherValues(behind))
      text.refuse("there is more behind its first array", "save one array, or all as .vti");
    layout.after = file.size() - from;
  }
  return layout;
}

} // namespace lamella::micrograph
