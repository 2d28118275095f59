#include "program/SettingOptions.h"

#include "SettingTable.h"
#include "session/Session.h"
#include "session/Text.h"
#include "session/Units.h"

#include "core/Error.h"
#include "lattice/PhaseNames.h"
#include "peridynamics/PairTable.h"

#include <vtkObject.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace lamella::cli
{

namespace
{

using SettingKind = Setting::Kind;
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
  if (setting.colour)
    return setting.types[0] == Type::Text ? upper(setting.parts[0]) + "=COLOUR" : "COLOUR";
  switch (setting.kind)
  {
    case SettingKind::Switch:
      return "";
    case SettingKind::Choice:
    case SettingKind::Text:
      std::transform(setting.choices.begin(), setting.choices.end(), std::back_inserter(words),
        [](const SettingChoice& choice) { return choice.word; });
      return words.empty() ? "NAME" : fmt::format("{}", fmt::join(words, "|"));
    case SettingKind::File:
      return "FILE";
    case SettingKind::Axes:
      return "AXES";
    case SettingKind::Whole:
      std::transform(setting.names.begin(), setting.names.end(), std::back_inserter(words),
        [](const SettingChoice& name) { return name.word; });
      return fmt::format("{}{}NUMBER", fmt::join(words, "|"), words.empty() ? "" : "|");
    case SettingKind::Number:
      return std::string_view(setting.unit) == "pixels"                    ? "PIXELS"
        : setting.unit[0] == '\0' && setting.low == 0 && setting.high == 1 ? "SHARE"
                                                                           : "NUMBER";
    case SettingKind::List:
      if (setting.types.size() == 1)
        return setting.types[0] == Type::Text ? "NAME" : "LIST";
      if (setting.types.size() == 2 && setting.types[0] == Type::Text)
      {
        const std::string second = upper(setting.parts[1]);
        return upper(setting.parts[0]) + "=" +
          (setting.types[1] != Type::Text ? "VALUE"
              : second == "LIKE"          ? upper(setting.parts[0])
                                          : second);
      }
      break;
    case SettingKind::Vector:
      break;
  }
  std::transform(setting.parts.begin(), setting.parts.end(), std::back_inserter(words), upper);
  for (std::size_t part = 0; part < words.size() && !setting.flat.empty(); ++part)
  {
    const bool flat = std::find(setting.flat.begin(), setting.flat.end(), part) != setting.flat.end();
    words[part].insert(0, part == 0 ? "" : ",");
    if (flat)
      words[part] = fmt::format("[{}]", words[part]);
  }
  const std::string last = std::isnan(setting.rest) || words.empty() ? "" : fmt::format("[,{}]", words.back());
  if (!last.empty())
    words.pop_back();
  return fmt::format("{}{}", fmt::join(words, setting.flat.empty() ? "," : ""), last);
}

/// @param whole what was written, of which `text` is a part
[[noreturn]] void refuse(
  const Setting& setting, const std::string& text, const std::string& what, const std::string& whole = "")
{
  const std::string where = whole.empty() || whole == text ? "" : fmt::format(" {}:", whole);
  throw ParameterError(fmt::format("{}{} '{}' is not {}", nameOf(setting), where, text, what),
    fmt::format("write it as --{} {}", setting.word, form(setting)));
}

double number(const Setting& setting, std::size_t part, const std::string& text, const std::string& whole)
{
  const std::string unit = unitOf(setting, part);
  std::optional<double> value = toNumber(text);
  if (!value && unit == "m")
    return coordinate("--" + std::string(setting.word), text);
  if (!value && unit == "Pa")
    value = pascals(text);
  if (!value && unit == "Pa √m")
    value = pascalRootMetres(text);
  if (!value && unit == "s")
    value = secondsFrom(text);
  if (!value && unit.empty() && text.ends_with('%'))
  {
    value = toNumber(std::string_view(text).substr(0, text.size() - 1));
    value = value ? std::optional(*value / 100) : value;
  }
  if (!value)
    refuse(setting, text, "a number", whole);
  return *value;
}

SettingValue valueOf(const Setting& setting, std::size_t part, const std::string& text, const std::string& whole)
{
  const Type type = setting.types[part];
  if (type == Type::Text)
    return text;
  const double value = number(setting, part, text, whole);
  if (type == Type::Whole && std::isfinite(value) && value != std::floor(value))
    refuse(setting, text, "a whole number");
  return value;
}

/// Three numbers from 0 to 1: "#RRGGBB" or one of a few names.
std::vector<std::string> colourParts(const Setting& setting, const std::string& text)
{
  static const std::map<std::string, std::string> names{ { "white", "#ffffff" }, { "black", "#000000" },
    { "gray", "#808080" }, { "lightgray", "#d4d4d4" }, { "darkgray", "#404040" } };
  const auto named = names.find(text);
  const std::string hex = named == names.end() ? text : named->second;
  if (hex.size() != 7 || hex[0] != '#' || hex.find_first_not_of("0123456789abcdefABCDEF", 1) != std::string::npos)
  {
    throw ParameterError(fmt::format("{} '{}' is not a colour", nameOf(setting), text),
      "write white, black, gray, lightgray, darkgray or #RRGGBB, such as '#f4ede4'");
  }
  std::vector<std::string> parts;
  for (std::size_t i = 1; i < hex.size(); i += 2)
    parts.push_back(fmt::format("{}", std::stoi(hex.substr(i, 2), nullptr, 16) / 255.0));
  return parts;
}

/// What one call of the setter takes, of what was written once.
std::vector<SettingValue> valuesOf(const Setting& setting, const std::string& text)
{
  if (setting.kind == SettingKind::Choice)
  {
    const auto found = std::find_if(
      setting.choices.begin(), setting.choices.end(), [&](const SettingChoice& choice) { return text == choice.word; });
    if (const auto value = toNumber(text); found == setting.choices.end() && value && toNumber(setting.choices[0].word))
      checkSetting(setting, { *value }); // as a class says it
    if (found == setting.choices.end())
      refuseWord(setting, text);
    return { static_cast<double>(found->value) };
  }
  const auto& words = setting.choices;
  if (!words.empty() &&
    std::none_of(words.begin(), words.end(), [&](const SettingChoice& choice) { return text == choice.word; }))
    refuseWord(setting, text);
  if (setting.kind == SettingKind::Axes)
  {
    if (text != "none" && text != "all" && text.find_first_not_of("xyz,") != std::string::npos)
      refuse(setting, text, "axes");
    std::vector<SettingValue> flags;
    for (const char axis : { 'x', 'y', 'z' })
      flags.emplace_back(text == "all" || (text != "none" && text.find(axis) != std::string::npos) ? 1.0 : 0.0);
    return flags;
  }
  std::vector<std::string> parts{ text };
  const auto called = std::find_if(
    setting.names.begin(), setting.names.end(), [&](const SettingChoice& name) { return text == name.word; });
  if (called != setting.names.end())
    return { static_cast<double>(called->value) };
  if (setting.colour)
  {
    const bool ofOne = setting.types[0] == Type::Text;
    const auto [key, value] =
      ofOne ? keyValue("--" + std::string(setting.word), text, form(setting)) : std::pair(std::string(), text);
    parts = colourParts(setting, value);
    if (ofOne)
      parts.insert(parts.begin(), key);
  }
  else if (setting.kind == SettingKind::List && setting.types.size() == 2 && setting.types[0] == Type::Text)
  {
    auto [key, value] = keyValue("--" + std::string(setting.word), text, form(setting));
    parts = { std::move(key), std::move(value) };
  }
  else if (setting.types.size() > 1)
  {
    parts = split(text, ',');
    if (parts.size() + setting.flat.size() == setting.types.size())
      for (const std::size_t part : setting.flat)
        parts.insert(parts.begin() + static_cast<std::ptrdiff_t>(part), "0");
  }
  const bool shorter = !std::isnan(setting.rest) && parts.size() + 1 == setting.types.size();
  if (parts.size() != setting.types.size() && !shorter)
  {
    const std::size_t left = std::isnan(setting.rest) ? setting.flat.size() : 1;
    refuse(setting, text,
      fmt::format(
        "{}{} numbers", left == 0 ? "" : fmt::format("{} or ", setting.types.size() - left), setting.types.size()));
  }
  std::vector<SettingValue> values;
  for (std::size_t i = 0; i < parts.size(); ++i)
    values.push_back(valueOf(setting, i, parts[i], text));
  if (shorter)
    values.push_back(std::isinf(setting.rest) ? values.back() : SettingValue(setting.rest));
  return values;
}

/// One text a call of the setter: what is listed may be written again and again, or once with commas between.
std::vector<std::string> written(const Setting& setting, const std::vector<std::string>& texts, bool byPhase)
{
  if (byPhase)
    return listItems(texts);
  if (setting.kind != SettingKind::List || (setting.types.size() > 1 && setting.types[0] != Type::Text))
    return texts;
  if (setting.types[0] == Type::Text)
    return listItems(texts);
  std::vector<std::string> items;
  for (const std::string& text : texts)
  {
    const std::vector<std::string> parts = split(text, ',');
    items.insert(items.end(), parts.begin(), parts.end());
  }
  return items;
}

const Setting* named(const std::vector<Setting>& settings, const std::string& word)
{
  const auto found =
    std::find_if(settings.begin(), settings.end(), [&](const Setting& one) { return word == one.word; });
  return found == settings.end() ? nullptr : &*found;
}

/// The setting itself where it is the class's; else the class's of that word, or null. (Two of a class may have one
/// word, where never both count.)
const Setting* ownOf(const std::vector<Setting>& settings, const Setting& setting)
{
  const bool is = std::any_of(settings.begin(), settings.end(), [&](const Setting& one) { return &one == &setting; });
  return is ? &setting : named(settings, setting.word);
}

/// What gives a number of all to phases one by one; null where nothing does.
const Setting* ofPhases(const std::vector<Setting>& settings, const Setting& setting)
{
  if (setting.kind != SettingKind::Number)
    return nullptr;
  const Setting* const own = named(settings, std::string("phase-") + setting.word);
  const std::string walls = "Walls";
  return own != nullptr || setting.group != walls ? own : named(settings, "phase-constant");
}

std::vector<double> numbersOf(const std::vector<SettingValue>& values)
{
  std::vector<double> numbers;
  for (const SettingValue& value : values)
    if (const double* const found = std::get_if<double>(&value))
      numbers.push_back(*found);
  return numbers;
}

/// @throws ParameterError for numbers out of range
void checkNumbers(const Setting& setting, const std::vector<SettingValue>& values)
{
  if (setting.values != nullptr || setting.types[0] != Type::Text)
    checkSetting(setting, numbersOf(values));
}

/// Of NAME=VALUE: refuses a second value of a name. @param before what was given of others
void requireOne(
  const Setting& setting, std::map<std::string, SettingValue>& before, const std::vector<SettingValue>& values)
{
  const auto& name = std::get<std::string>(values[0]);
  const auto shown = [](const SettingValue& value)
  {
    const double* const number = std::get_if<double>(&value);
    return number != nullptr ? fmt::format("{:g}", *number) : std::get<std::string>(value);
  };
  if (const auto [entry, added] = before.try_emplace(name, values[1]); !added && entry->second != values[1])
  {
    throw ParameterError(
      fmt::format("{} gives '{}' two values, {} and {}", nameOf(setting), name, shown(entry->second), shown(values[1])),
      "give every name one value");
  }
}

/// Parts a number from how far it may be off, where that can be told.
std::pair<std::string, std::string> parted(const Setting* uncertainty, const std::string& text)
{
  return uncertainty != nullptr ? splitUncertainty(text) : std::pair(text, std::string());
}

/// Refuses what give() would refuse whatever else was given. @throws ParameterError
void check(const Setting& setting, const Setting* uncertainty, const std::string& given, bool byPhase)
{
  for (const std::string& whole : written(setting, { given }, byPhase))
  {
    const auto [text, half] = parted(uncertainty, whole);
    if (text != whole)
      (void)number(setting, 1, half, whole);
    const std::size_t sign = byPhase ? text.find('=') : std::string::npos;
    const std::vector<SettingValue> values =
      valuesOf(setting, sign == std::string::npos ? text : text.substr(sign + 1));
    checkNumbers(setting, values);
  }
}

} // namespace

void SettingOptions::declare(CLI::App& command, const std::string& className, const std::vector<std::string>& leave,
  const std::map<std::string, std::string>& defaults)
{
  const std::vector<Setting>& settings = settingsOf(className);
  for (const Setting& setting : settings)
    if (!options_.contains(setting.word) && std::find(leave.begin(), leave.end(), setting.word) == leave.end())
      add(command, settings, setting, "", true, leave);
  standards(command, defaults);
}

void SettingOptions::declareSome(CLI::App& command, const std::string& className, const std::vector<std::string>& words,
  const std::string& group, bool early)
{
  const std::vector<Setting>& settings = settingsOf(className);
  for (const std::string& word : words)
    add(command, settings, *named(settings, word), group, early);
}

void SettingOptions::declareKind(CLI::App& command, const std::string& className,
  const std::pair<std::string, int>& choice, const std::map<std::string, std::string>& defaults)
{
  kind_ = choice;
  const std::vector<Setting>& settings = settingsOf(className);
  for (const Setting& setting : settings)
  {
    const std::vector<int>& values = setting.withValues;
    const bool counts =
      setting.with != choice.first || std::find(values.begin(), values.end(), choice.second) != values.end();
    if (counts && setting.word != choice.first)
      add(command, settings, setting);
  }
  standards(command, defaults);
}

void SettingOptions::standards(CLI::App& command, const std::map<std::string, std::string>& defaults)
{
  for (const auto& [word, standard] : defaults)
  {
    options_.at(word)->standard = standard;
    command.get_option("--" + word)->default_str(standard);
  }
}

void SettingOptions::add(CLI::App& command, const std::vector<Setting>& settings, const Setting& setting,
  std::string group, bool early, const std::vector<std::string>& leave)
{
  // Written as what it is of, PHASE=VALUE.
  const std::string word = setting.word;
  if (setting.uncertaintyOf[0] != '\0' || word == "phase-constant" ||
    (word.starts_with("phase-") && named(settings, word.substr(6)) != nullptr))
    return;
  Option& option =
    *(options_[setting.word] = std::make_unique<Option>(Option{ &setting, {}, false, false, {}, nullptr }));
  for (const Setting& other : settings)
    if (word == other.uncertaintyOf && std::find(leave.begin(), leave.end(), other.word) == leave.end())
      option.uncertainty = &other;
  if (group.empty())
    group = setting.group[0] == '\0' ? "Settings" : setting.group;
  const bool on = setting.off[0] != '\0'; // by itself
  if (setting.kind == SettingKind::Switch)
  {
    command
      .add_flag(fmt::format("--{}", on ? setting.off : setting.word), on ? option.off : option.on,
        !on                            ? setting.text
          : setting.offText[0] != '\0' ? setting.offText
                                       : fmt::format("Not: {}", setting.text))
      ->group(group);
    return;
  }
  const bool byPhase = ofPhases(settings, setting) != nullptr;
  CLI::Option* const added = command.add_option(fmt::format("--{}", setting.word), option.texts, setting.text);
  added->type_name(form(setting) + (byPhase ? "|PHASE=VALUE" : "") + (option.uncertainty != nullptr ? "[±HALF]" : ""))
    ->allow_extra_args(false)
    ->group(group);
  // What is wrong with a value is told when the words are read, by a scene before its first sample.
  if (early)
    added->each([&setting, uncertainty = option.uncertainty, byPhase](const std::string& text)
      { check(setting, uncertainty, text, byPhase); });
  if (setting.kind != SettingKind::List)
    added->default_str(setting.standard);
  if (setting.kind != SettingKind::List && !byPhase)
    added->expected(1);
}

void SettingOptions::formerly(
  CLI::App& command, const std::string& old, const std::string& word, const std::string& on, int part)
{
  Option* const option = options_.at(word).get();
  Former& former = *former_.emplace_back(std::make_unique<Former>(Former{ old, option, on, {}, false, part }));
  if (option->setting->kind == SettingKind::Switch && on.empty())
  {
    command.add_flag("--" + old, former.used)->group("");
    return;
  }
  command.add_option("--" + old, former.texts)->allow_extra_args(false)->group("");
}

void SettingOptions::tellFormer(Session& session) const
{
  for (const auto& former : former_)
  {
    if (former->used || !former->texts.empty())
    {
      session.warn(fmt::format("--{} is called --{} now; the next version does not know --{} any more", former->old,
        former->option->off || former->option->setting->off[0] == '\0' ? former->option->setting->word
                                                                       : former->option->setting->off,
        former->old));
    }
  }
}

void SettingOptions::give(vtkObject* object) const
{
  for (const auto& former : former_)
  {
    Option& option = *former->option;
    if (former->part >= 0 && !former->texts.empty())
    {
      std::vector<std::string> parts =
        split(option.texts.empty() ? option.setting->standard : option.texts.back(), ',');
      parts.at(static_cast<std::size_t>(former->part)) = former->texts.back();
      option.texts.push_back(fmt::format("{}", fmt::join(parts, ",")));
      continue;
    }
    if (option.setting->kind != SettingKind::Switch)
    {
      option.texts.insert(option.texts.end(), former->texts.begin(), former->texts.end());
      continue;
    }
    const bool on = former->used || (!former->texts.empty() && former->texts.back() == former->on);
    if (on)
      (option.setting->off[0] == '\0' ? option.on : option.off) = true;
  }
  const std::vector<Setting>& own = settingsOf(object->GetClassName());
  if (!kind_.first.empty())
    named(own, kind_.first)->set(object, { static_cast<double>(kind_.second) });
  for (const auto& [word, option] : options_)
  {
    const Setting* const setting = ownOf(own, *option->setting);
    if (setting == nullptr)
      continue;
    if (option->texts.empty() && !option->standard.empty())
      setting->set(object, valuesOf(*setting, option->standard));
    if (option->on || option->off)
      setting->set(object, { option->on ? 1.0 : 0.0 });
    const Setting* const byPhase = ofPhases(own, *setting);
    std::map<std::string, SettingValue> before;
    const Setting* const uncertainty = option->uncertainty != nullptr ? ownOf(own, *option->uncertainty) : nullptr;
    for (const std::string& whole : written(*setting, option->texts, byPhase != nullptr))
    {
      const auto [text, half] = parted(uncertainty, whole);
      const std::size_t sign = byPhase != nullptr ? text.find('=') : std::string::npos;
      std::vector<SettingValue> values = valuesOf(*setting, sign == std::string::npos ? text : text.substr(sign + 1));
      checkNumbers(*setting, values);
      if (setting->kind == SettingKind::List && values.size() == 2 && setting->types[0] == Type::Text)
        requireOne(*setting, before, values);
      if (sign != std::string::npos)
      {
        values.insert(values.begin(), text.substr(0, sign));
        if (byPhase->types.size() == 3)
          values.insert(values.begin() + 1, word);
      }
      (sign == std::string::npos ? setting : byPhase)->set(object, values);
      if (text != whole)
        uncertainty->set(object, { values[0], number(*setting, 1, half, whole) });
    }
  }
  for (const auto& [word, option] : options_)
  {
    const Setting* const setting = ownOf(own, *option->setting);
    const Setting* const other = setting != nullptr ? named(own, setting->with) : nullptr;
    const bool set = setting != nullptr && (option->on || option->off || !option->texts.empty());
    if (!set || other == nullptr || other->values == nullptr)
      continue;
    const auto value = static_cast<int>(other->values(object).front());
    if (std::find(setting->withValues.begin(), setting->withValues.end(), value) == setting->withValues.end())
      refuseIdle(*setting);
  }
}

std::vector<std::string> SettingOptions::idle(const std::string& className) const
{
  std::vector<std::string> words;
  for (const auto& [word, option] : options_)
    if (given(word) && named(settingsOf(className), word) == nullptr)
      words.push_back(word);
  return words;
}

bool SettingOptions::given(const std::string& word) const
{
  const auto found = options_.find(word);
  if (found == options_.end())
    return false;
  const bool before = std::any_of(former_.begin(), former_.end(),
    [&](const auto& former)
    { return former->option == found->second.get() && (former->used || !former->texts.empty()); });
  return before || !found->second->texts.empty() || found->second->on || found->second->off;
}

std::string SettingOptions::firstGiven(const std::vector<std::string>& words) const
{
  const auto found = std::find_if(words.begin(), words.end(), [this](const std::string& word) { return given(word); });
  if (found == words.end())
    return "";
  const Setting& setting = *options_.at(*found)->setting;
  return fmt::format("--{}", setting.off[0] != '\0' ? setting.off : setting.word);
}

std::string SettingOptions::text(const std::string& word) const
{
  const auto found = options_.find(word);
  return found == options_.end() || found->second->texts.empty() ? "" : found->second->texts.back();
}

std::size_t SettingOptions::count(const std::string& word) const
{
  const auto found = options_.find(word);
  return found == options_.end() ? 0 : written(*found->second->setting, found->second->texts, false).size();
}

void SettingOptions::checkNames(const std::vector<std::string>& phases) const
{
  const std::string known = "its phases are " + quotedList(phases, "and");
  for (const auto& [word, option] : options_)
  {
    const Setting& setting = *option->setting;
    const std::string part = word == "void" ? "Phase"
      : word == "relative-to"               ? "Bonds"
      : setting.parts.empty()               ? ""
                                            : setting.parts[0];
    const bool isName = setting.types[0] == Type::Text;
    const bool byPhase = setting.kind == SettingKind::Number;
    for (const std::string& text : written(setting, option->texts, byPhase))
    {
      if (byPhase && text.find('=') == std::string::npos)
        continue;
      const std::string first =
        text.substr(0, setting.kind == SettingKind::List || byPhase ? text.find('=') : std::string::npos);
      if ((byPhase || (isName && part == "Phase")) && !phaseMeant(phases, first))
      {
        throw ParameterError(fmt::format("--{} names '{}', which is no phase of this sample", word, first),
          suggestion(first, phases, known));
      }
      for (const std::string& pair : setting.parts.size() > 1 && std::string(setting.parts[1]) == "Like"
          ? std::vector<std::string>{ first, text.substr(std::min(text.size(), first.size() + 1)) }
          : std::vector<std::string>{ first })
      {
        if (isName && part == "Bonds" && !peridynamics::findPair(pair, phases))
        {
          throw ParameterError(
            fmt::format("--{} names '{}', which is no phase or pair of phases of this sample", word, pair),
            suggestion(pair, phases, known + "; a pair is written as " + phases.front() + "-" + phases.back()));
        }
      }
    }
  }
}

} // namespace lamella::cli
