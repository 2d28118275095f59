#include "lattice/GreyRanges.h"

#include "core/Error.h"
#include "lattice/NodeText.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace lamella
{
namespace
{

constexpr int brightest = 65535;

std::string_view trimmed(std::string_view text)
{
  const auto first = text.find_first_not_of(" \t");
  return first == std::string_view::npos ? "" : text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

[[noreturn]] void refuse(std::string_view text, std::string_view part)
{
  throw ParameterError(part == text ? fmt::format("'{}' is not a grey value", text)
                                    : fmt::format("'{}' is not a grey value, in the range '{}'", part, text),
    "greys run from 0 to 255 (16-bit pictures: 65535): give one, as 255, or a range with both ends in it, as 0..89, "
    "..89 or 90..; ..otsu and otsu.. part the greys where the picture says");
}

GreyBound bound(std::string_view text, std::string_view part)
{
  if (part == "otsu")
    return { 0, 1, 2 };
  if (part == "otsu1" || part == "otsu2")
    return { 0, part.back() - '0', 3 };
  int grey = -1;
  const auto [end, problem] = std::from_chars(part.data(), part.data() + part.size(), grey);
  if (problem != std::errc() || end != part.data() + part.size() || grey < 0 || grey > brightest)
    refuse(text, part);
  return { grey, 0, 0 };
}

/// A range in values, both ends included.
struct Values
{
  std::int64_t first = 0;
  std::int64_t last = 0;
};

Values valuesOf(const GreyRange& range, const GreyScale& how)
{
  // Where values are finer than greys, a grey is the values that round to it.
  const std::int64_t half = how.scale / 2;
  Values v{ range.first.grey * static_cast<std::int64_t>(how.scale) - half,
    range.last.grey * static_cast<std::int64_t>(how.scale) + how.scale - half - 1 };
  if (range.first.level > 0)
    v.first = how.levels->last[static_cast<std::size_t>(range.first.level - 1)] + 1;
  if (range.last.level > 0)
    v.last = how.levels->last[static_cast<std::size_t>(range.last.level - 1)];
  if (range.openEnd)
    v.last = brightest;
  return { std::max<std::int64_t>(v.first, 0), std::min<std::int64_t>(v.last, brightest) };
}

std::string rangeText(std::int64_t first, std::int64_t last)
{
  return first == last ? fmt::format("{}", first) : fmt::format("{}..{}", first, last);
}

/// @throws InputError for the greys between ranges that some nodes have
void refuseGaps(
  const Lattice& lattice, std::span<const std::uint16_t> values, const std::vector<bool>& covered, const GreyScale& how)
{
  const std::vector<std::int64_t> histogram = greyHistogram(values);
  const std::int64_t top = how.bits == 8 ? 255 : brightest;
  std::string missing;
  std::string options;
  std::int64_t nodes = 0;
  for (std::int64_t first = 0; first <= brightest;)
  {
    if (covered[static_cast<std::size_t>(first)])
    {
      ++first;
      continue;
    }
    std::int64_t last = first;
    std::int64_t count = 0;
    for (; last <= brightest && !covered[static_cast<std::size_t>(last)]; ++last)
      count += histogram[static_cast<std::size_t>(last)];
    if (count > 0)
    {
      const std::int64_t half = how.scale / 2;
      const std::string range = rangeText((first + half) / how.scale, std::min((last - 1 + half) / how.scale, top));
      missing += (missing.empty() ? "" : " and ") + range;
      options += fmt::format("{}{}=NAME", options.empty() ? "" : " and ", range);
      nodes += count;
    }
    first = last;
  }
  if (nodes == 0)
    return;
  const auto one = std::find_if(values.begin(), values.end(), [&](std::uint16_t value) { return !covered[value]; });
  throw InputError(
    fmt::format("the grey values {} are in no phase: {} {} such a grey, one is {} with {}", missing, nodes,
      nodes == 1 ? "node has" : "nodes have", nodeText(lattice, one - values.begin()), *one / how.scale),
    fmt::format("name them with phase {}, or all greys that are not listed with other NAME", options));
}

} // namespace

GreyRange parseGreyRange(std::string_view given)
{
  const std::string_view text = trimmed(given);
  GreyRange range;
  range.text = text;
  const auto dots = text.find("..");
  if (dots == std::string_view::npos)
  {
    range.first = range.last = bound(text, text);
    range.single = true;
    if (range.first.level > 0)
    {
      throw ParameterError(fmt::format("'{}' is a level between two greys, not a grey value", text),
        fmt::format("write ..{0} for the darker greys and {0}.. for the brighter ones", text));
    }
    return range;
  }
  const std::string_view from = trimmed(text.substr(0, dots));
  const std::string_view to = trimmed(text.substr(dots + 2));
  if (from.empty() && to.empty())
  {
    throw ParameterError("the range '..' has no end",
      "give one, as 90.. or ..89; all greys that are not listed have the name given as other");
  }
  if (!from.empty())
    range.first = bound(text, from);
  range.openEnd = to.empty();
  if (!to.empty())
    range.last = bound(text, to);
  const bool numbers = range.first.level == 0 && range.last.level == 0;
  if ((numbers && range.first.grey > range.last.grey) ||
    (range.first.level > 0 && range.last.level > 0 && range.first.level >= range.last.level))
  {
    throw ParameterError(fmt::format("the range of greys '{}' runs backwards", text),
      fmt::format("write the darker end first: {}..{}", to, from));
  }
  return range;
}

void GreyRanges::add(std::string_view text, const std::string& name)
{
  Named added{ parseGreyRange(text), name };
  if (name.empty())
    throw ParameterError(fmt::format("the phase of grey '{}' has an empty name", text), "give it a name, such as wall");
  for (const GreyBound& end : { added.range.first, added.range.last })
  {
    if (end.classes > 0 && classes_ > 0 && end.classes != classes_)
    {
      throw ParameterError(fmt::format("'{}' is of {} classes, and another range of {}", text, end.classes, classes_),
        "write otsu for two classes, otsu1 and otsu2 for three");
    }
    classes_ = std::max(classes_, end.classes);
  }
  // Of numbers it is known at once; levels are looked at when they are.
  const auto numbers = [](const GreyRange& range) { return range.first.level == 0 && range.last.level == 0; };
  for (const Named& there : ranges_)
  {
    if (there.name == name || !numbers(there.range) || !numbers(added.range))
      continue;
    const int first = std::max(there.range.first.grey, added.range.first.grey);
    const int last = std::min(there.range.last.grey, added.range.last.grey);
    if (first <= last && there.range.single && added.range.single)
    {
      throw ParameterError(fmt::format("the grey value {} has two names, '{}' and '{}'", first, there.name, name),
        "give every grey value one phase");
    }
    if (first <= last)
    {
      throw ParameterError(fmt::format("the greys {} of '{}' and {} of '{}' overlap: {} would be both",
                             there.range.text, there.name, added.range.text, name, rangeText(first, last)),
        "give every grey value one phase: both ends belong to a range, as in ..89 and 90..");
    }
  }
  ranges_.push_back(std::move(added));
}

std::vector<int> GreyRanges::cuts() const
{
  std::vector<int> last;
  for (const Named& one : ranges_)
  {
    if (one.range.first.level == 0 && one.range.first.grey > 0)
      last.push_back(one.range.first.grey - 1);
    if (one.range.last.level == 0 && !one.range.openEnd && one.range.last.grey < brightest)
      last.push_back(one.range.last.grey);
  }
  std::sort(last.begin(), last.end());
  last.erase(std::unique(last.begin(), last.end()), last.end());
  return last;
}

GreyRanges::Applied GreyRanges::apply(
  const Lattice& lattice, std::span<const std::uint16_t> values, const GreyScale& scale) const
{
  Applied result;
  GreyScale how = scale;
  if (classes_ > 0 && !how.levels)
  {
    how.levels = otsuLevels(greyHistogram(values), classes_);
    if (std::string doubt = how.levels->doubt(); !doubt.empty())
      result.warnings.push_back(std::move(doubt));
  }
  result.levels = how.levels;

  const int top = how.bits == 8 ? 255 : brightest;
  GreyMap map;
  map.other = other;
  std::vector<const Named*> owner(brightest + 1, nullptr);
  std::vector<bool> covered(brightest + 1, other.has_value());
  for (const Named& one : ranges_)
  {
    if (const GreyRange& r = one.range;
        (r.first.level == 0 && r.first.grey > top) || (r.last.level == 0 && !r.openEnd && r.last.grey > top))
    {
      throw ParameterError(fmt::format("phase '{}' is given the grey{} {}, and those of this picture run from 0 to {} "
                                       "(8 bits)",
                             one.name, r.single ? " value" : "s", r.text, top),
        r.single ? "look at its greys: lamella info tells them"
                 : "leave the end out to go as far as greys do, as in 90..");
    }
    const Values v = valuesOf(one.range, how);
    for (std::int64_t value = v.first; value <= v.last; ++value)
    {
      const auto at = static_cast<std::size_t>(value);
      if (owner[at] != nullptr && owner[at]->name != one.name)
      {
        throw ParameterError(
          fmt::format("the greys {} of '{}' and {} of '{}' overlap in this picture: {} would be both",
            owner[at]->range.text, owner[at]->name, one.range.text, one.name, value / how.scale),
          "give every grey value one phase");
      }
      owner[at] = &one;
      covered[at] = true;
      map.phaseOfGrey[static_cast<int>(value)] = one.name;
    }
    if (v.first > v.last)
    {
      throw ParameterError(fmt::format("the greys {} of '{}' are none in this picture, where the level is {}",
                             one.range.text, one.name, (one.range.first.level > 0 ? v.first - 1 : v.last) / how.scale),
        "give a range that reaches the level");
    }
  }
  if (!std::ranges::all_of(ranges_, [](const Named& one) { return one.range.single; }))
    refuseGaps(lattice, values, covered, how);
  result.image = map.apply(lattice, values);
  return result;
}

} // namespace lamella
