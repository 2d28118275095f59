#include "pictures/RawVolume.h"

#include "core/Error.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>

// The format: https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html
namespace lamella::micrograph
{

namespace
{

[[noreturn]] void refuseNumpy(const std::filesystem::path& path, const std::string& what, const std::string& remedy)
{
  throw InputError("the array in '" + path.string() + "' cannot be used: " + what, remedy);
}

/// The text between two marks behind a key; empty without them.
std::string valueOf(const std::string& dictionary, const std::string& key, char from, char to)
{
  const std::size_t at = dictionary.find("'" + key + "'");
  const std::size_t begin = at == std::string::npos ? at : dictionary.find(from, at + key.size() + 2);
  const std::size_t end = begin == std::string::npos ? begin : dictionary.find(to, begin + 1);
  return end == std::string::npos ? "" : dictionary.substr(begin + 1, end - begin - 1);
}

std::vector<std::int64_t> shapeOf(const std::string& text, const std::filesystem::path& path)
{
  std::vector<std::int64_t> shape;
  for (std::size_t at = 0; at < text.size();)
  {
    const std::size_t end = std::min(text.find(',', at), text.size());
    std::string part = text.substr(at, end - at);
    std::erase(part, ' ');
    at = end + 1;
    if (part.empty() && at > text.size())
      break; // (5,)
    std::int64_t size = 0;
    const auto [last, failed] = std::from_chars(part.data(), part.data() + part.size(), size);
    if (failed != std::errc() || last != part.data() + part.size())
      refuseNumpy(path, fmt::format("its shape is ({})", text), "save it again");
    shape.push_back(size);
  }
  return shape;
}

} // namespace

RawLayout numpyLayout(const std::filesystem::path& path)
{
  FileBytes file(path);
  const auto start = file.read(0, std::min<std::uint64_t>(file.size(), 12));
  if (start.size() < 12 || !std::string(start.begin(), start.end()).starts_with("\x93NUMPY"))
    throw InputError("'" + path.string() + "' is not a NumPy file", "write it with numpy.save()");
  const int digits = start[6] == 1 ? 2 : 4; // of the header's length, in versions 1, and 2 and 3
  const std::uint64_t begin = 8 + static_cast<std::uint64_t>(digits);
  const std::uint64_t length = file.number(8, digits, false);
  if (start[6] < 1 || start[6] > 3 || length > (std::uint64_t{ 1 } << 20))
    refuseNumpy(path, fmt::format("a header of version {} and {} bytes", start[6], length), "save it again");
  const auto bytes = file.read(begin, length);
  const std::string header(bytes.begin(), bytes.end());

  RawLayout layout;
  layout.file = path;
  layout.offset = begin + length;
  const std::string type = valueOf(header, "descr", '\'', '\'');
  const bool known = type.size() == 3 && std::string_view("<>|").find(type[0]) != std::string_view::npos &&
    std::string_view("buif").find(type[1]) != std::string_view::npos &&
    std::string_view("1248").find(type[2]) != std::string_view::npos;
  if (!known || (type[1] == 'f' && type[2] < '4') || (type[1] == 'b' && type[2] != '1'))
    refuseNumpy(
      path, fmt::format("its type is '{}'", type), "numbers of up to 64 bits can be read: array.astype('u1')");
  layout.type = { type[1] == 'b' ? 'u' : type[1], type[2] - '0' };
  layout.bigEndian = type[0] == '>';

  const std::vector<std::int64_t> shape = shapeOf(valueOf(header, "shape", '(', ')'), path);
  const bool small = std::ranges::all_of(shape, [](std::int64_t n) { return n >= 1 && n < (std::int64_t{ 1 } << 40); });
  if (shape.empty() || shape.size() > 4 || !small || (shape.size() == 4 && shape[3] > 64))
    refuseNumpy(path, fmt::format("its shape is ({})", fmt::join(shape, ", ")), "save it as [z, y, x] or [y, x]");
  if (shape.size() > 1 && valueOf(header, "fortran_order", ':', ',').find("True") != std::string::npos)
    refuseNumpy(path, "its first axis runs fastest (Fortran order)", "save it as numpy.ascontiguousarray(array)");
  layout.axes = static_cast<int>(std::min<std::size_t>(3, shape.size()));
  for (int axis = 0; axis < layout.axes; ++axis)
    layout.size[static_cast<std::size_t>(axis)] = shape[static_cast<std::size_t>(layout.axes - 1 - axis)];
  layout.components = shape.size() == 4 ? static_cast<int>(shape[3]) : 1;
  return layout;
}

} // namespace lamella::micrograph
