#include "pictures/Slices.h"

#include "core/Error.h"
#include "core/Lower.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <optional>
#include <regex>
#include <set>
#include <tuple>

namespace lamella::micrograph
{
namespace
{

namespace fs = std::filesystem;

const std::regex& numberFormat()
{
  static const std::regex format("%(0?[0-9]*)[diu]");
  return format;
}

struct Slice
{
  fs::path file;
  std::string series; ///< the name without its last number
  std::uint64_t number = 0;
};

bool isDigit(char c)
{
  return c >= '0' && c <= '9';
}

/// Splits a name at its last number; nothing where it has none.
std::optional<Slice> split(const fs::path& file)
{
  const std::string stem = file.stem().string();
  std::size_t end = stem.size();
  while (end > 0 && !isDigit(stem[end - 1]))
    --end;
  std::size_t begin = end;
  while (begin > 0 && isDigit(stem[begin - 1]))
    --begin;
  if (begin == end || end - begin > 18)
    return std::nullopt;
  return Slice{ file, stem.substr(0, begin) + "#" + stem.substr(end), std::stoull(stem.substr(begin, end - begin)) };
}

bool looksLikePicture(const fs::path& file)
{
  static const std::set<std::string> endings{ ".png", ".jpg", ".jpeg", ".tif", ".tiff", ".pgm", ".ppm", ".pnm",
    ".bmp" };
  return endings.count(endingOf(file)) != 0 && file.filename().string().front() != '.';
}

std::vector<fs::path> filesIn(const fs::path& folder)
{
  std::error_code failure;
  std::vector<fs::path> files;
  for (fs::directory_iterator entry(folder.empty() ? fs::path(".") : folder, failure), end; !failure && entry != end;
       entry.increment(failure))
  {
    std::error_code ignored;
    if (entry->is_regular_file(ignored))
      files.push_back(folder.empty() ? entry->path().filename() : entry->path());
  }
  if (failure)
  {
    throw InputError(fmt::format("the folder '{}' cannot be read: {}", folder.string(), failure.message()),
      "check its name and permissions");
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// The number that stands for %d in a name, where the rest of the name is as the pattern has it.
std::optional<std::uint64_t> numberAt(
  const std::string& name, const std::string& before, const std::string& after, std::size_t digits)
{
  if (name.size() < before.size() + after.size() + std::max<std::size_t>(digits, 1) ||
    name.compare(0, before.size(), before) != 0 || name.compare(name.size() - after.size(), after.size(), after) != 0)
    return std::nullopt;
  const std::string number = name.substr(before.size(), name.size() - before.size() - after.size());
  if (number.size() > 18 || !std::all_of(number.begin(), number.end(), isDigit) ||
    (number.size() > digits && digits > 1 && number[0] == '0'))
    return std::nullopt;
  return std::stoull(number);
}

std::vector<Slice> byNumber(const fs::path& pattern)
{
  const std::string name = pattern.filename().string();
  std::smatch match;
  std::regex_search(name, match, numberFormat());
  if (std::regex_search(match.suffix().first, name.cend(), numberFormat()))
  {
    throw InputError(fmt::format("the pattern '{}' has more than one number in it", pattern.string()),
      "leave one %d, the slice's number");
  }
  const std::string width = match[1].str();
  const std::size_t digits = !width.empty() && width[0] == '0' ? std::stoul(width) : 0;
  std::vector<Slice> slices;
  for (const fs::path& file : filesIn(pattern.parent_path()))
    if (const auto number = numberAt(file.filename().string(), match.prefix(), match.suffix(), digits))
      slices.push_back({ file, name, *number });
  return slices;
}

} // namespace

bool isSlicePattern(const fs::path& path)
{
  const std::string name = path.filename().string();
  std::error_code ignored;
  return !fs::exists(path, ignored) &&
    (name.find_first_of("*?") != std::string::npos || std::regex_search(name, numberFormat()));
}

Slices listSlices(const fs::path& path)
{
  std::error_code ignored;
  const std::string name = path.filename().string();
  const bool folder = fs::is_directory(path, ignored);
  const bool numbered = !folder && name.find_first_of("*?") == std::string::npos;
  std::vector<Slice> slices;
  if (numbered)
  {
    slices = byNumber(path);
  }
  else
  {
    for (const fs::path& file : filesIn(folder ? path : path.parent_path()))
    {
      const bool wanted =
        folder ? looksLikePicture(file) : fnmatch(name.c_str(), file.filename().c_str(), FNM_PERIOD) == 0;
      if (wanted)
      {
        const auto slice = split(file);
        if (!slice)
        {
          throw InputError(
            fmt::format("'{}' has no number in its name, so its place in the volume is not known", file.string()),
            "number the slices, or name them with a pattern such as slice_%04d.png");
        }
        slices.push_back(*slice);
      }
    }
  }
  if (slices.empty())
  {
    throw folder
      ? InputError(fmt::format("the folder '{}' holds no PNG, JPEG, TIFF, PGM, PPM or BMP picture", path.string()),
          "name a folder of numbered slices")
      : InputError(fmt::format("no file is called '{}'", path.string()), "check the pattern and the folder");
  }
  std::sort(slices.begin(), slices.end(),
    [](const Slice& a, const Slice& b) { return std::tie(a.number, a.file) < std::tie(b.number, b.file); });

  Slices result;
  std::uint64_t missing = 0;
  std::uint64_t firstMissing = 0;
  for (std::size_t i = 0; i < slices.size(); ++i)
  {
    if (slices[i].series != slices[0].series)
    {
      throw InputError(fmt::format("'{}' and '{}' are of two series", slices[0].file.filename().string(),
                         slices[i].file.filename().string()),
        "name one series with a pattern such as slice_%04d.png");
    }
    if (i > 0 && slices[i].number == slices[i - 1].number)
    {
      throw InputError(fmt::format("'{}' and '{}' have the same number", slices[i - 1].file.filename().string(),
                         slices[i].file.filename().string()),
        "leave one of them");
    }
    if (i > 0 && slices[i].number > slices[i - 1].number + 1)
    {
      firstMissing = missing == 0 ? slices[i - 1].number + 1 : firstMissing;
      missing += slices[i].number - slices[i - 1].number - 1;
    }
    result.files.push_back(slices[i].file);
  }
  if (missing > 0)
  {
    const std::string what = fmt::format("{} of the slices {} to {} {} missing, the first is {}", missing,
      slices.front().number, slices.back().number, missing == 1 ? "is" : "are", firstMissing);
    if (numbered)
      throw InputError(what, "add them, number the slices anew, or use * in place of %d to close the gap");
    result.warnings.push_back(what + "; the others are put side by side");
  }
  return result;
}

} // namespace lamella::micrograph
