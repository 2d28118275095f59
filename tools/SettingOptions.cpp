#include "SettingOptions.h"

#include "SettingTable.h"
#include "Text.h"
#include "Units.h"

#include "lattice/Error.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace lamella::cli
{

namespace
{

using Kind = Setting::Kind;
using Type = Setting::Type;

/// "Bonds" is PAIR, "x1 [m]" is X1.
std::string upper(std::string name)
{
  name = name.substr(0, name.find(" ["));
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::toupper(c); });
  std::replace(name.begin(), name.end(), ' ', '_');
  return name == "BONDS" ? "PAIR" : name;
}

/// How an option is written: x|y|z, SHARE, PAIR=VALUE.
std::string form(const Setting& setting)
{
  std::vector<std::string> words;
  switch (setting.kind)
  {
    case Kind::Switch:
      return "";
    case Kind::Choice:
      std::transform(setting.choices.begin(), setting.choices.end(), std::back_inserter(words),
        [](const SettingChoice& choice) { return choice.word; });
      return fmt::format("{}", fmt::join(words, "|"));
    case Kind::Text:
      return "NAME";
    case Kind::File:
      return "FILE";
    case Kind::Axes:
      return "AXES";
    case Kind::Whole:
      return "NUMBER";
    case Kind::Number:
      return setting.unit[0] == '\0' && setting.low == 0 && setting.high == 1 ? "SHARE" : "NUMBER";
    case Kind::List:
      if (setting.types.size() == 1)
      {
        return setting.types[0] == Type::Text ? "NAME" : "LIST";
      }
      if (setting.types.size() == 2 && setting.types[0] == Type::Text)
      {
        return upper(setting.parts[0]) + "=" + (setting.types[1] == Type::Text ? upper(setting.parts[0]) : "VALUE");
      }
      break;
    case Kind::Vector:
      break;
  }
  std::transform(setting.parts.begin(), setting.parts.end(), std::back_inserter(words), upper);
  return fmt::format("{}", fmt::join(words, ","));
}

[[noreturn]] void refuse(const Setting& setting, const std::string& text, const std::string& what)
{
  throw ParameterError(fmt::format("{} '{}' is not {}", nameOf(setting), text, what),
    fmt::format("write it as --{} {}", setting.word, form(setting)));
}

/// The unit of one of its parts: "Young's modulus [Pa]".
std::string unitOf(const Setting& setting, std::size_t part)
{
  const std::string name = part < setting.parts.size() ? setting.parts[part] : "";
  const std::size_t begin = name.find(" [");
  return begin == std::string::npos ? setting.unit : name.substr(begin + 2, name.size() - begin - 3);
}

double number(const Setting& setting, std::size_t part, const std::string& text)
{
  const std::string unit = unitOf(setting, part);
  std::optional<double> value = toNumber(text);
  if (!value && unit == "m")
  {
    return lengthInMetres("--" + std::string(setting.word), text);
  }
  if (!value && unit == "Pa")
  {
    value = pascals(text);
  }
  if (!value && unit.empty() && text.ends_with('%'))
  {
    value = toNumber(std::string_view(text).substr(0, text.size() - 1));
    value = value ? std::optional(*value / 100) : value;
  }
  if (!value)
  {
    refuse(setting, text, "a number");
  }
  return *value;
}

SettingValue valueOf(const Setting& setting, std::size_t part, const std::string& text)
{
  const Type type = setting.types[part];
  if (type == Type::Text)
  {
    return text;
  }
  const double value = number(setting, part, text);
  if (type == Type::Whole && std::isfinite(value) && value != std::floor(value))
  {
    refuse(setting, text, "a whole number");
  }
  return value;
}

/// What one call of the setter takes, of what was written once.
std::vector<SettingValue> valuesOf(const Setting& setting, const std::string& text)
{
  if (setting.kind == Kind::Choice)
  {
    const auto found = std::find_if(
      setting.choices.begin(), setting.choices.end(), [&](const SettingChoice& choice) { return text == choice.word; });
    if (found == setting.choices.end())
    {
      refuseWord(setting, text);
    }
    return { static_cast<double>(found->value) };
  }
  if (setting.kind == Kind::Axes)
  {
    if (text.find_first_not_of("xyz") != std::string::npos)
    {
      refuse(setting, text, "axes");
    }
    std::vector<SettingValue> flags;
    for (const char axis : { 'x', 'y', 'z' })
    {
      flags.emplace_back(text.find(axis) == std::string::npos ? 0.0 : 1.0);
    }
    return flags;
  }
  std::vector<std::string> parts{ text };
  if (setting.kind == Kind::List && setting.types.size() == 2 && setting.types[0] == Type::Text)
  {
    auto [key, value] = keyValue("--" + std::string(setting.word), text, form(setting));
    parts = { std::move(key), std::move(value) };
  }
  else if (setting.types.size() > 1)
  {
    parts = split(text, ',');
  }
  if (parts.size() != setting.types.size())
  {
    refuse(setting, text, fmt::format("{} numbers", setting.types.size()));
  }
  std::vector<SettingValue> values;
  for (std::size_t i = 0; i < parts.size(); ++i)
  {
    values.push_back(valueOf(setting, i, parts[i]));
  }
  return values;
}

/// One text a call of the setter: what is listed may be written again and again, or once with commas between.
std::vector<std::string> written(const Setting& setting, const std::vector<std::string>& texts)
{
  if (setting.kind != Kind::List || (setting.types.size() > 1 && setting.types[0] != Type::Text))
  {
    return texts;
  }
  if (setting.types[0] == Type::Text)
  {
    return listItems(texts);
  }
  std::vector<std::string> items;
  for (const std::string& text : texts)
  {
    const std::vector<std::string> parts = split(text, ',');
    items.insert(items.end(), parts.begin(), parts.end());
  }
  return items;
}

std::vector<double> numbersOf(const std::vector<SettingValue>& values)
{
  std::vector<double> numbers;
  for (const SettingValue& value : values)
  {
    if (const double* const found = std::get_if<double>(&value))
    {
      numbers.push_back(*found);
    }
  }
  return numbers;
}

} // namespace

void SettingOptions::declare(CLI::App& command, const std::string& className, const std::vector<std::string>& leave)
{
  for (const Setting& setting : settingsOf(className))
  {
    if (std::find(leave.begin(), leave.end(), setting.word) != leave.end())
    {
      continue;
    }
    Option& option = *(options_[setting.word] = std::make_unique<Option>(Option{ &setting, {} }));
    const std::string group = setting.group[0] == '\0' ? "Settings" : setting.group;
    const bool on = setting.off[0] != '\0'; // by itself
    if (setting.kind == Kind::Switch)
    {
      command
        .add_flag(fmt::format("--{}", on ? setting.off : setting.word), on ? option.off : option.on,
          on ? fmt::format("Not: {}", setting.text) : setting.text)
        ->group(group);
      continue;
    }
    CLI::Option* const added = command.add_option(fmt::format("--{}", setting.word), option.texts, setting.text);
    added->type_name(form(setting))->allow_extra_args(false)->group(group);
    if (setting.kind != Kind::List)
    {
      added->expected(1)->default_str(setting.standard);
    }
  }
}

void SettingOptions::give(vtkObject* object) const
{
  for (const auto& [word, option] : options_)
  {
    const Setting& setting = *option->setting;
    if (option->on || option->off)
    {
      setting.set(object, { option->on ? 1.0 : 0.0 });
    }
    for (const std::string& text : written(setting, option->texts))
    {
      const std::vector<SettingValue> values = valuesOf(setting, text);
      if (setting.values != nullptr)
      {
        checkSetting(setting, numbersOf(values));
      }
      setting.set(object, values);
    }
  }
}

bool SettingOptions::given(const std::string& word) const
{
  const auto found = options_.find(word);
  return found != options_.end() && (!found->second->texts.empty() || found->second->on || found->second->off);
}

} // namespace lamella::cli
