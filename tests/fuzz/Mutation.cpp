#include "Mutation.h"

#include "io/Provenance.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <span>
#include <string_view>

namespace lamella::fuzz
{
namespace
{

/// What numbers in files are that somebody did not think of.
constexpr std::array<std::string_view, 28> numbers{ "0", "-1", "1", "2", "255", "256", "65535", "65536", "2147483647",
  "-2147483648", "4294967295", "4294967296", "9223372036854775807", "-9223372036854775808", "18446744073709551616",
  "1e308", "-1e308", "1e-308", "1e999", "nan", "inf", "-inf", "0.5", "1e9", "", " ", "x", "1,5" };

struct Place
{
  std::size_t first = 0;
  std::size_t size = 0;
};

/// A run of letters of one sort around a random place.
Place run(const std::string& text, Random& random, bool (*is)(unsigned char))
{
  for (int attempt = 0; attempt < 20; ++attempt)
  {
    std::size_t first = below(random, text.size());
    if (text.empty() || !is(static_cast<unsigned char>(text[first])))
      continue;
    while (first > 0 && is(static_cast<unsigned char>(text[first - 1])))
      --first;
    std::size_t end = first;
    while (end < text.size() && is(static_cast<unsigned char>(text[end])))
      ++end;
    return { first, end - first };
  }
  return { below(random, text.size()), 0 };
}

bool isNumber(unsigned char c)
{
  return std::isdigit(c) != 0 || c == '.' || c == '-' || c == '+' || c == 'e';
}

bool isWord(unsigned char c)
{
  return std::isalnum(c) != 0 || c == '_';
}

bool isLine(unsigned char c)
{
  return c != '\n';
}

void alterOnce(std::string& file, const std::vector<std::string>& others, Random& random)
{
  if (file.empty())
  {
    file.assign(1, '0');
    return;
  }
  const auto replace = [&](const Place& place, std::string_view by) { file.replace(place.first, place.size, by); };
  switch (below(random, 12))
  {
    case 0:
    case 1:
      oneOf(file, random) ^= static_cast<char>(1U << below(random, 8));
      break;
    case 2:
      oneOf(file, random) = static_cast<char>(random());
      break;
    case 3:
    case 4:
    case 5:
      replace(run(file, random, isNumber), oneOf(numbers, random));
      break;
    case 6: // another word of the file in the place of this one
    {
      const Place from = run(file, random, isWord);
      replace(run(file, random, isWord), std::string(file, from.first, from.size));
      break;
    }
    case 7: // four bytes, as of a length
    {
      const std::array<std::uint32_t, 6> values{ 0, 1, 0x7fffffff, 0x80000000, 0xffffffff, 1U << below(random, 32) };
      const std::uint32_t value = oneOf(values, random);
      const std::size_t at = below(random, file.size());
      for (std::size_t i = 0; i < 4 && at + i < file.size(); ++i)
        file[at + i] = static_cast<char>(value >> (8 * i));
      break;
    }
    case 8: // a line twice, or gone
    {
      const Place line = run(file, random, isLine);
      replace(line,
        random() % 2 == 0 ? ""
                          : std::string(file, line.first, line.size) + "\n" + std::string(file, line.first, line.size));
      break;
    }
    case 9: // a part gone
    {
      const std::size_t at = below(random, file.size());
      file.erase(at, 1 + below(random, std::min<std::size_t>(200, file.size() - at)));
      break;
    }
    case 10: // cut off
      file.resize(below(random, file.size()));
      break;
    default: // a part of another file
    {
      const std::string& other = oneOf(others, random);
      const std::size_t at = below(random, other.size());
      file.insert(below(random, file.size()), other, at, 1 + below(random, 300));
      break;
    }
  }
}

} // namespace

std::string altered(const std::string& file, const std::vector<std::string>& others, Random& random)
{
  std::string result = file;
  for (std::size_t count = 1 + (random() % 4 == 0 ? below(random, 6) : 0); count > 0; --count)
    alterOnce(result, others, random);
  constexpr std::size_t most = std::size_t{ 1 } << 20;
  result.resize(std::min(result.size(), most));
  return result;
}

std::string mended(const std::string& checkpoint, Random& random)
{
  constexpr std::size_t header = 512;
  if (checkpoint.size() <= header)
    return checkpoint;
  std::string content = checkpoint.substr(header);
  for (std::size_t count = 1 + below(random, 4); count > 0; --count)
    alterOnce(content, { checkpoint }, random);
  io::Sha256 hash;
  hash.update(std::as_bytes(std::span(content)));
  std::string head =
    fmt::format("Lamella checkpoint\nformat 1\nwritten-by fuzz\nbytes {}\nsha256 {}\nHDF5 from byte {}\n",
      content.size(), hash.finish(), header);
  head.resize(header, '\0');
  return head + content;
}

} // namespace lamella::fuzz
