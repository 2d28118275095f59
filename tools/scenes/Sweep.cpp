#include "scenes/Sweep.h"

#include "session/Text.h"

#include "SettingTable.h"
#include "core/Error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lamella::cli
{

namespace
{

constexpr double mostInRange = 1e6;

bool whole(double value)
{
  return std::floor(value) == value && std::abs(value) < 9e15;
}

/// Without the last digits of a sum in binary: 0.30000000000000004 is meant as 0.3.
double rounded(double value)
{
  return std::stod(fmt::format("{:.12g}", value));
}

/// The values of a key or an entry, where it has several.
std::optional<std::vector<Json>> several(const Json& value, Shape shape, const std::string& where)
{
  if (value.is_string() && shape != Shape::List)
    return range(value.get<std::string>(), where);
  if (!value.is_array())
    return std::nullopt;
  const bool nested = std::ranges::any_of(
    value, [](const Json& item) { return item.is_array(); });
  const bool texts = std::ranges::any_of(value, [](const Json& item) { return item.is_string(); });
  if (shape == Shape::List ? !nested : shape == Shape::Tuple ? !nested && !texts : false)
    return std::nullopt; // one value
  if (value.empty())
    sceneError(where, "a list without values", "give one at least, or leave the key out");
  return std::vector<Json>(value.begin(), value.end());
}

[[noreturn]] void wrong(const SceneOption& option, const Json& value, const char* wanted)
{
  sceneError(option.where, fmt::format("{} = {} is not {}", option.path, value.dump(), wanted),
    "lamella --help of its command tells what it takes");
}

/// One value as a word.
std::string single(const SceneOption& option, const Json& value)
{
  if (value.is_boolean() || value.is_object() || value.is_null())
    wrong(option, value, "a number or a text");
  if (value.is_array())
  {
    if (option.shape != Shape::Tuple)
      wrong(option, value, "one value");
    std::string joined;
    for (const Json& item : value)
    {
      if (!item.is_number() && !item.is_string())
        wrong(option, value, "a list of numbers");
      joined += joined.empty() ? "" : ",";
      joined += wordOf(item);
    }
    return joined;
  }
  return wordOf(value);
}

} // namespace

std::optional<std::vector<Json>> range(const std::string& text, const std::string& where)
{
  const std::size_t dots = text.find("..");
  if (dots == std::string::npos)
    return std::nullopt;
  const auto trimmed = [](std::string part)
  {
    const std::size_t begin = part.find_first_not_of(' ');
    return begin == std::string::npos ? "" : part.substr(begin, part.find_last_not_of(' ') - begin + 1);
  };
  std::string last = text.substr(dots + 2);
  std::string stepText = "1";
  const std::size_t at = last.find("step");
  if (at != std::string::npos)
  {
    stepText = trimmed(last.substr(at + 4));
    last.erase(at);
  }
  const auto low = toNumber(trimmed(text.substr(0, dots)));
  const auto high = toNumber(trimmed(last));
  const auto step = toNumber(stepText);
  if (!low || !high)
    return std::nullopt;
  const std::string hint = "write it as \"1..10\" or \"0.25..1 step 0.25\"";
  if (!step || !(*step != 0) || !std::isfinite(*low) || !std::isfinite(*high) || !std::isfinite(*step) ||
    (*high - *low) / *step < 0)
    sceneError(where, "the range \"" + text + "\" leads nowhere", hint);
  const double steps = std::floor((*high - *low) / *step * (1 + 1e-12) + 1e-9);
  if (steps >= mostInRange)
    sceneError(where, fmt::format("the range \"{}\" has {:.3g} values", text, steps + 1), "take a larger step");
  std::vector<Json> values;
  for (std::size_t i = 0; i <= static_cast<std::size_t>(steps); ++i)
  {
    const double value = *low + static_cast<double>(i) * *step;
    if (whole(*low) && whole(*step))
      values.emplace_back(static_cast<std::int64_t>(value));
    else
      values.emplace_back(rounded(value));
  }
  return values;
}

Sweep::Sweep(const Scene& scene)
{
  const auto add = [&](const SceneOption& option, const std::string& path, const Json& value, Shape shape)
  {
    if (std::ranges::find(axes_, path, &SweepAxis::path) != axes_.end())
      return;
    if (auto values = several(value, shape, option.where))
      axes_.push_back({ path, std::move(*values), option.where, unitOfWord(option.name) });
  };
  const auto look = [&](const SceneOption& option)
  {
    if (option.shape == Shape::Pairs && option.value.is_object())
    {
      for (const auto& [key, value] : option.value.items())
      {
        add(option, option.path + "." + key, value, Shape::Single);
      }
      return;
    }
    add(option, option.path, option.value, option.shape == Shape::Pairs ? Shape::List : option.shape);
  };
  // in the order of the file, where [material] is a section among others
  for (const SceneSection& section : scene.source.sections)
  {
    for (const SceneKey& key : section.keys)
    {
      const std::string path = section.name + "." + key.name;
      const auto lookAll = [&](const auto& stages)
      {
        for (const auto& stage : stages)
        {
          if (stage.file && stage.file->path == path)
            look(*stage.file);
          const auto found = std::ranges::find(stage.options, path, &SceneOption::path);
          if (found != stage.options.end())
            look(*found);
        }
      };
      lookAll(scene.stages);
      lookAll(scene.each);
    }
  }
}

double Sweep::count() const noexcept
{
  double product = 1;
  for (const SweepAxis& axis : axes_)
    product *= static_cast<double>(axis.values.size());
  return product;
}

Setting Sweep::setting(std::size_t sample) const
{
  Setting setting;
  for (auto axis = axes_.rbegin(); axis != axes_.rend(); ++axis)
  {
    setting[axis->path] = axis->values[sample % axis->values.size()];
    sample /= axis->values.size();
  }
  return setting;
}

std::vector<std::string> wordsFor(const SceneOption& option, const Setting& setting)
{
  const auto chosen = setting.find(option.path);
  const Json& value = chosen != setting.end() ? chosen->second : option.value;
  const std::string dashed = "--" + option.name;
  std::vector<std::string> words;
  switch (option.shape)
  {
    case Shape::Flag:
      if (!value.is_boolean())
        wrong(option, value, "true or false");
      if (value.get<bool>())
        words.push_back(dashed);
      return words;
    case Shape::Single:
    case Shape::Tuple:
      words.push_back(dashed + "=" + single(option, value));
      return words;
    case Shape::List:
      if (value.is_string())
      {
        if (const auto values = range(value.get<std::string>(), option.where))
        {
          for (const Json& item : *values)
            words.push_back(dashed + "=" + wordOf(item));
          return words;
        }
      }
      break;
    case Shape::Pairs:
      break;
  }
  if (value.is_object())
  {
    if (option.shape != Shape::Pairs)
      wrong(option, value, "a list");
    for (const auto& [key, entry] : value.items())
    {
      const auto swept = setting.find(option.path + "." + key);
      words.push_back(dashed + "=" + key + "=" + single(option, swept != setting.end() ? swept->second : entry));
    }
    return words;
  }
  for (const Json& item : value.is_array() ? value : Json::array({ value }))
    words.push_back(dashed + "=" + single(option, item));
  return words;
}

} // namespace lamella::cli
