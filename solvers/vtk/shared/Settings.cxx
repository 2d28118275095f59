#include "Settings.h"

#include "SettingTable.h"

#include "core/Error.h"
#include "core/Plausible.h"
#include "core/Suggestion.h"

#include "vtkObject.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace lamella
{

namespace
{

std::map<std::string, SettingTables::Table>& registered()
{
  static std::map<std::string, SettingTables::Table> tables;
  return tables;
}

std::string allowed(const Setting& setting)
{
  const bool ends = std::isfinite(setting.high);
  const std::string high = fmt::format("{}{}", setting.highOpen ? "below " : "", setting.high);
  if (!std::isfinite(setting.low))
    return ends ? "a number " + (setting.highOpen ? high : "up to " + high) : "a finite number";
  if (setting.lowOpen)
  {
    return fmt::format(
      "a number above {}{}", setting.low, ends ? (setting.highOpen ? " and " : " and up to ") + high : "");
  }
  return ends ? fmt::format("a number from {} to {}", setting.low, high) : fmt::format("{} or more", setting.low);
}

/// What is wrong with a number, or nothing.
std::string fault(const Setting& setting, double value)
{
  if (!setting.choices.empty())
  {
    const bool known = std::any_of(setting.choices.begin(), setting.choices.end(),
      [value](const SettingChoice& choice) { return choice.value == value; });
    return known ? "" : "is none of its choices";
  }
  if (std::isnan(value))
    return "is not a number";
  if (std::isinf(value) && (setting.highOpen || value < 0 || std::isfinite(setting.high)))
    return "is not finite";
  if (std::isfinite(setting.low) && (setting.lowOpen ? !(value > setting.low) : value < setting.low))
    return fmt::format("is {} {}", setting.lowOpen ? "not above" : "below", setting.low);
  if (std::isfinite(setting.high) && (setting.highOpen ? !(value < setting.high) : value > setting.high))
    return fmt::format("is {} {}", setting.highOpen ? "not below" : "above", setting.high);
  return "";
}

std::string remedy(const Setting& setting)
{
  if (setting.choices.empty())
    return "choose " + allowed(setting);
  std::string list;
  for (const SettingChoice& choice : setting.choices)
  {
    const std::string number = std::to_string(choice.value);
    list += (list.empty() ? "" : ", ") + (choice.word == number ? number : fmt::format("{} ({})", choice.word, number));
  }
  return "choose one of " + list;
}

nlohmann::json valueAsJson(const Setting& setting, const std::vector<double>& values)
{
  const auto one = [&](std::size_t i) -> nlohmann::json
  {
    switch (setting.types[std::min(i, setting.types.size() - 1)])
    {
      case Setting::Type::Switch:
        return values[i] != 0;
      case Setting::Type::Whole:
        return static_cast<std::int64_t>(values[i]);
      default:
        return values[i];
    }
  };
  const auto choice = std::find_if(setting.choices.begin(), setting.choices.end(),
    [&](const SettingChoice& found) { return found.value == values.front(); });
  if (choice != setting.choices.end())
    return choice->word;
  if (values.size() == 1)
    return one(0);
  nlohmann::json list = nlohmann::json::array();
  for (std::size_t i = 0; i < values.size(); ++i)
    list.push_back(one(i));
  return list;
}

} // namespace

SettingTables::SettingTables(const std::map<std::string, Table>& byClass)
{
  registered().insert(byClass.begin(), byClass.end());
}

const std::vector<Setting>& settingsOf(const std::string& className)
{
  static const std::vector<Setting> none;
  const auto found = registered().find(className);
  return found == registered().end() ? none : found->second();
}

std::string unitOf(const Setting& setting, std::size_t part)
{
  const std::string name = part < setting.parts.size() ? setting.parts[part] : "";
  const std::size_t begin = name.find(" [");
  return begin == std::string::npos ? setting.unit : name.substr(begin + 2, name.size() - begin - 3);
}

std::string unitOfWord(const std::string& word)
{
  std::string unit;
  for (const auto& [className, table] : registered())
  {
    for (const Setting& setting : table())
    {
      const std::string own = unitOf(setting, std::max<std::size_t>(1, setting.parts.size()) - 1);
      if (setting.word != word || own.empty())
        continue;
      if (!unit.empty() && own != unit)
        return "";
      unit = own;
    }
  }
  return unit;
}

std::string nameOf(const Setting& setting)
{
  std::string name = setting.word;
  std::replace(name.begin(), name.end(), '-', ' ');
  return name;
}

void checkSetting(const Setting& setting, const std::vector<double>& values)
{
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    std::string wrong = fault(setting, values[i]);
    if (wrong.empty() && setting.unit[0] != '\0' && values[i] != 0 && std::isfinite(values[i]) &&
      !plausible(std::fabs(values[i])))
      wrong = "is not between 1e-30 and 1e30"; // no material's, no sample's
    if (!wrong.empty())
    {
      const std::string name = values.size() > 1 && i < setting.parts.size() ? setting.parts[i] : "";
      const std::string part = name.empty() ? "" : fmt::format(" ({})", name.substr(0, name.find(" ["))); // no unit
      throw ParameterError(fmt::format("{}{} {} {}", nameOf(setting), part, values[i], wrong), remedy(setting));
    }
  }
  const std::string first = setting.parts.empty() ? "" : setting.parts[0];
  if (values.size() == 2 && (first == "from" || first == "minimum") && values[0] > values[1])
  {
    throw ParameterError(
      fmt::format("{} {} to {} is empty", nameOf(setting), values[0], values[1]), "give the lower end first");
  }
}

void refuseWord(const Setting& setting, const std::string& word)
{
  std::vector<std::string> words;
  std::transform(setting.choices.begin(), setting.choices.end(), std::back_inserter(words),
    [](const SettingChoice& choice) { return choice.word; });
  throw ParameterError(
    fmt::format("{} '{}' is none of its choices", nameOf(setting), word), suggestion(word, words, remedy(setting)));
}

void refuseSize(double value)
{
  throw ParameterError(fmt::format("{:.0f} is too large for a whole number", value), "give a smaller one");
}

void refuseIdle(const Setting& setting)
{
  throw ParameterError(fmt::format("{} counts only with {}", nameOf(setting), setting.withText),
    fmt::format("leave {} out, or choose {}", nameOf(setting), setting.withText));
}

void checkSettings(vtkObject* object)
{
  for (const Setting& setting : settingsOf(object->GetClassName()))
  {
    if (setting.values != nullptr)
    {
      const std::vector<double> values = setting.values(object);
      if (std::any_of(values.begin(), values.end(), [&](double value) { return value != setting.unset; }))
        checkSetting(setting, values);
    }
  }
}

nlohmann::json settingsAsJson(vtkObject* object)
{
  const std::vector<Setting>& settings = settingsOf(object->GetClassName());
  const auto counts = [&](const Setting& setting)
  {
    const auto other = std::find_if(settings.begin(), settings.end(),
      [&](const Setting& one) { return one.values != nullptr && one.word == std::string_view(setting.with); });
    return other == settings.end() ||
      std::find(setting.withValues.begin(), setting.withValues.end(),
        static_cast<int>(other->values(object).front())) != setting.withValues.end();
  };
  nlohmann::json json = nlohmann::json::object();
  for (const Setting& setting : settings)
  {
    if (setting.values != nullptr && counts(setting))
    {
      std::string key = setting.word;
      std::replace(key.begin(), key.end(), '-', '_');
      json[key] = valueAsJson(setting, setting.values(object));
    }
  }
  return json;
}

void printSettings(vtkObject* object, ostream& os, vtkIndent indent)
{
  for (const Setting& setting : settingsOf(object->GetClassName()))
    if (setting.values != nullptr)
      os << indent << setting.word << ": " << valueAsJson(setting, setting.values(object)).dump() << "\n";
}

} // namespace lamella
