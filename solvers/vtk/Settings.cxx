#include "Settings.h"

#include "SettingTable.h"

#include "lattice/Error.h"
#include "lattice/Plausible.h"
#include "lattice/Suggestion.h"

#include "vtkObject.h"

#include <fmt/format.h>

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
  {
    return ends ? "a number " + (setting.highOpen ? high : "up to " + high) : "a finite number";
  }
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
  {
    return "is not a number";
  }
  if (std::isinf(value) && (setting.highOpen || value < 0 || std::isfinite(setting.high)))
  {
    return "is not finite";
  }
  if (std::isfinite(setting.low) && (setting.lowOpen ? !(value > setting.low) : value < setting.low))
  {
    return fmt::format("is {} {}", setting.lowOpen ? "not above" : "below", setting.low);
  }
  if (std::isfinite(setting.high) && (setting.highOpen ? !(value < setting.high) : value > setting.high))
  {
    return fmt::format("is {} {}", setting.highOpen ? "not below" : "above", setting.high);
  }
  return "";
}

std::string remedy(const Setting& setting)
{
  if (setting.choices.empty())
  {
    return "choose " + allowed(setting);
  }
  std::string list;
  for (const SettingChoice& choice : setting.choices)
  {
    const std::string number = std::to_string(choice.value);
    list += (list.empty() ? "" : ", ") + (choice.word == number ? number : fmt::format("{} ({})", choice.word, number));
  }
  return "choose one of " + list;
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
    {
      wrong = "is not between 1e-30 and 1e30"; // no material's, no sample's
    }
    if (!wrong.empty())
    {
      const std::string name = values.size() > 1 && i < setting.parts.size() ? setting.parts[i] : "";
      const std::string part = name.empty() ? "" : fmt::format(" ({})", name.substr(0, name.find(" ["))); // no unit
      throw ParameterError(fmt::format("{}{} {} {}", nameOf(setting), part, values[i], wrong), remedy(setting));
    }
  }
  if (values.size() == 2 && setting.parts.size() == 2 && setting.parts[0] == std::string("from") &&
    values[0] > values[1])
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
      if (values.size() != 1 || values.front() != setting.unset)
      {
        checkSetting(setting, values);
      }
    }
  }
}

} // namespace lamella
