#include "Mutation.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <regex>
#include <string_view>

namespace lamella::fuzz
{
namespace
{

/// All places that match, of which one is altered; of arrays at points only, or anywhere.
std::optional<std::string> replaceOne(
  const std::string& text, const std::regex& what, bool atPoints, Random& random, std::string (*by)(const std::smatch&))
{
  const std::size_t first = atPoints ? text.find("<PointData") : 0;
  const std::size_t end = atPoints ? text.find("</PointData") : text.size();
  if (first == std::string::npos || end == std::string::npos)
    return std::nullopt;
  const std::vector<std::smatch> found(std::sregex_iterator(text.begin() + static_cast<std::ptrdiff_t>(first),
                                         text.begin() + static_cast<std::ptrdiff_t>(end), what),
    std::sregex_iterator());
  if (found.empty())
    return std::nullopt;
  const std::smatch& one = oneOf(found, random);
  std::string result = text;
  result.replace(first + static_cast<std::size_t>(one.position()), static_cast<std::size_t>(one.length()), by(one));
  return result;
}

/// The second part of three is a number: one more.
std::string more(const std::smatch& m)
{
  return m[1].str() + std::to_string(std::stoull(m[2]) + 1) + m[3].str();
}

/// A number less, or four letters of base64, in one of the arrays.
std::optional<std::string> shorter(const std::string& xml, Random& random)
{
  std::vector<std::size_t> begins; // of the values
  for (std::size_t at = xml.find("Array "); at != std::string::npos; at = xml.find("Array ", at + 1))
  {
    const std::size_t end = xml.find('>', at);
    const std::string_view tag = std::string_view(xml).substr(at, end - at);
    const std::size_t first = end == std::string::npos ? end : xml.find_first_not_of(" \t\r\n", end + 1);
    if (first != std::string::npos && xml[first] != '<' && !tag.ends_with('/') &&
      tag.find("appended") == std::string_view::npos && tag.find("\"String\"") == std::string_view::npos)
      begins.push_back(first);
  }
  if (begins.empty())
    return std::nullopt;
  const std::size_t first = oneOf(begins, random);
  const std::size_t end = xml.find_first_of(" \t\r\n<", first);
  std::string result = xml;
  const bool text = xml.find("\"ascii\"") != std::string::npos;
  return result.erase(first, text ? end - first : std::min<std::size_t>(4, end - first));
}

std::optional<std::string> contradictingXml(const std::string& xml, Random& random)
{
  static const std::regex counts(R"re((NumberOf(?:Points|Verts|Lines|Polys|Strips|Cells|Tuples)=")(\d+)("))re");
  static const std::regex components(R"re((NumberOfComponents=")(\d+)("))re");
  static const std::regex types(R"re(type="(Float64|Float32|Int64|Int32|UInt8)")re");
  static const std::regex extents(R"re((Extent="\d+ )(\d+)( ))re");
  switch (below(random, 5))
  {
    case 0:
      return replaceOne(xml, counts, false, random, more);
    case 1:
      return replaceOne(xml, components, true, random, more);
    case 2: // numbers as text are right in many types
      return xml.find("\"ascii\"") != std::string::npos
        ? std::nullopt
        : replaceOne(
            xml, types, true, random,
            +[](const std::smatch& m) { return std::string(m[1] == "UInt8" ? "type=\"Int16\"" : "type=\"Int8\""); });
    case 3:
      return replaceOne(xml, extents, false, random, more);
    default:
      return shorter(xml, random);
  }
}

/// A number of the one line of a header that says how many values there are.
std::optional<std::string> moreValues(const std::string& file, const std::regex& line, Random& random)
{
  const std::string head = file.substr(0, std::min<std::size_t>(file.size(), 1000));
  std::smatch found;
  if (!std::regex_search(head, found, line))
    return std::nullopt;
  std::vector<std::size_t> ends(found.size() - 1);
  for (std::size_t i = 0; i < ends.size(); ++i)
    ends[i] = static_cast<std::size_t>(found.position(i + 1) + found.length(i + 1));
  const std::size_t end = oneOf(ends, random);
  std::string result = file;
  result[end - 1] = static_cast<char>(result[end - 1] == '9' ? '8' : result[end - 1] + 1);
  return result;
}

void putLittle(std::string& bytes, std::size_t at, std::size_t size, std::uint64_t value)
{
  for (std::size_t i = 0; i < size; ++i)
    bytes[at + i] = static_cast<char>(value >> (8 * i));
}

std::uint64_t little(const std::string& bytes, std::size_t at, std::size_t size)
{
  std::uint64_t value = 0;
  for (std::size_t i = size; i > 0; --i)
    value = value << 8 | static_cast<unsigned char>(bytes[at + i - 1]);
  return value;
}

/// A PNG or TIFF of more columns or rows than it has.
std::optional<std::string> largerPng(const std::string& file, Random& random)
{
  constexpr std::size_t header = 12, side = 16, sum = 29; // IHDR, width and height in it, its checksum
  if (file.size() < sum + 4)
    return std::nullopt;
  std::string result = file;
  ++result[side + 3 + 4 * below(random, 2)];
  const uLong right = crc32(0, reinterpret_cast<const Bytef*>(result.data() + header), static_cast<uInt>(sum - header));
  for (std::size_t i = 0; i < 4; ++i)
    result[sum + i] = static_cast<char>(right >> (24 - 8 * i));
  return result;
}

std::optional<std::string> largerTiff(const std::string& file, Random& random)
{
  if (file.size() < 8 || !file.starts_with("II*"))
    return std::nullopt;
  const std::size_t directory = little(file, 4, 4);
  const std::size_t entries = directory + 2 <= file.size() ? little(file, directory, 2) : 0;
  const std::uint64_t wanted = 256 + below(random, 2); // width or height
  for (std::size_t i = 0; i < entries && directory + 14 + 12 * i <= file.size(); ++i)
  {
    const std::size_t entry = directory + 2 + 12 * i;
    if (little(file, entry, 2) == wanted)
    {
      std::string result = file;
      const std::size_t size = little(file, entry + 2, 2) == 3 ? 2 : 4;
      putLittle(result, entry + 8, size, little(file, entry + 8, size) + 1);
      return result;
    }
  }
  return std::nullopt;
}

/// A BMP of more columns or rows than it has.
std::optional<std::string> largerBmp(const std::string& file, Random& random)
{
  if (file.size() < 26)
    return std::nullopt;
  std::string result = file;
  const std::size_t at = 18 + 4 * below(random, 2);
  putLittle(result, at, 4, little(file, at, 4) + 1);
  return result;
}

/// A NIfTI file of more voxels along an axis than it has.
std::optional<std::string> largerNifti(const std::string& file, Random& random)
{
  if (file.size() < 48 || little(file, 0, 4) != 348) // packed
    return std::nullopt;
  std::string result = file;
  const std::size_t at = 42 + 2 * below(random, 3);
  putLittle(result, at, 2, little(file, at, 2) + 1);
  return result;
}

/// A key twice.
std::optional<std::string> twice(const std::string& toml, Random& random)
{
  static const std::regex keys(R"re((^|\n)[a-z][a-z-]* = [^\n\[{]+(?=\n))re");
  return replaceOne(
    toml, keys, false, random,
    +[](const std::smatch& m) { return m[0].str() + (m[0].str().front() == '\n' ? "" : "\n") + m[0].str(); });
}

/// A row with a value less or more than there are columns.
std::optional<std::string> ragged(const std::string& table, Random& random)
{
  const std::size_t first = table.find('\n');
  std::vector<std::size_t> commas;
  for (std::size_t at = table.find(',', std::min(first, table.size())); at != std::string::npos;
       at = table.find(',', at + 1))
    commas.push_back(at);
  if (commas.empty())
    return std::nullopt;
  std::string result = table;
  const std::size_t at = oneOf(commas, random);
  return random() % 2 == 0 ? result.erase(at, 1) : result.insert(at, ",1");
}

/// A VTKHDF image of another extent than its arrays have.
std::optional<std::string> otherExtent(const std::string& file, Random& random)
{
  const std::size_t name = file.find("WholeExtent");
  for (std::size_t at = name; name != std::string::npos && at + 24 <= std::min(file.size(), name + 200); ++at)
  {
    const auto number = [&](std::size_t i) { return little(file, at + 4 * i, 4); };
    if (number(0) == 0 && number(2) == 0 && number(4) == 0 && number(1) - 1 < 100 && number(3) - 1 < 100 &&
      number(5) - 1 < 100)
    {
      std::string result = file;
      const std::size_t one = 1 + 2 * below(random, 3);
      putLittle(result, at + 4 * one, 4, number(one) + 1);
      return result;
    }
  }
  return std::nullopt;
}

} // namespace

std::optional<std::string> contradicting(const std::string& file, const std::string& ending, Random& random)
{
  static const std::regex nrrd(R"re(\nsizes: (\d+) (\d+) (\d+))re");
  static const std::regex netpbm(R"re(^P[2356]\n(?:#[^\n]*\n)?(\d+) (\d+)\n)re");
  static const std::regex meta(R"re(\nDimSize = (\d+) (\d+) (\d+))re");
  static const std::regex numpy(R"re('shape': \((\d+), (\d+), (\d+)\))re");
  static const std::regex legacy(R"re(\nDIMENSIONS (\d+) (\d+) (\d+))re");
  if (ending == ".vti" || ending == ".vtp" || ending == ".vtu")
    return contradictingXml(file, random);
  return ending == ".png"                    ? largerPng(file, random)
    : ending == ".tif"                       ? largerTiff(file, random)
    : ending == ".bmp"                       ? largerBmp(file, random)
    : ending == ".pgm"                       ? moreValues(file, netpbm, random)
    : ending == ".ppm"                       ? moreValues(file, netpbm, random)
    : ending == ".nrrd" || ending == ".nhdr" ? moreValues(file, nrrd, random)
    : ending == ".mha" || ending == ".mhd"   ? moreValues(file, meta, random)
    : ending == ".npy"                       ? moreValues(file, numpy, random)
    : ending == ".vtk"                       ? moreValues(file, legacy, random)
    : ending == ".nii"                       ? largerNifti(file, random)
    : ending == ".toml"                      ? twice(file, random)
    : ending == ".csv"                       ? ragged(file, random)
    : ending == ".vtkhdf"                    ? otherExtent(file, random)
                                             : std::nullopt;
}

} // namespace lamella::fuzz
