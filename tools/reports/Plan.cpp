#include "reports/Plan.h"

#include "session/Text.h"

#include "core/Error.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <utility>

namespace lamella::reports
{

namespace fs = std::filesystem;

namespace
{

using Json = nlohmann::ordered_json;

constexpr std::uintmax_t largestPlan = std::uintmax_t{ 16 } << 20; // [bytes]
constexpr int deepestHeading = 3;                                  // levels of headings in a page

[[noreturn]] void refuse(const std::string& place, const std::string& what, const std::string& hint)
{
  throw InputError("report.json: " + place + " " + what, hint);
}

/// An object of the file, which knows where it stands and which keys were asked for.
class Object
{
public:
  Object(const Json& json, std::string place)
    : json_(json)
    , place_(std::move(place))
  {
    if (!json.is_object())
      refuse(place_.empty() ? "the file" : place_, "is no object", "write it as { \"key\": value, ... }");
  }

  [[nodiscard]] std::string at(const std::string& key) const { return place_.empty() ? key : place_ + "." + key; }

  const Json* find(const std::string& key)
  {
    asked_.push_back(key);
    const auto found = json_.find(key);
    return found == json_.end() || found->is_null() ? nullptr : &*found;
  }

  std::string text(const std::string& key)
  {
    const Json* const value = find(key);
    if (value != nullptr && !value->is_string())
      refuse(at(key), "is no text", "write it in quotes");
    return value == nullptr ? "" : value->get<std::string>();
  }

  std::string required(const std::string& key)
  {
    std::string value = text(key);
    if (value.empty())
      refuse(at(key), "is missing", "add \"" + key + "\"");
    return value;
  }

  /// One text, or a list of paragraphs.
  std::string paragraphs(const std::string& key)
  {
    const Json* const value = find(key);
    if (value == nullptr || value->is_string())
      return value == nullptr ? "" : value->get<std::string>();
    std::string all;
    for (const std::string& one : texts(key))
      all += (all.empty() ? "" : "\n\n") + one;
    return all;
  }

  /// A list of texts, or one of them.
  std::vector<std::string> texts(const std::string& key)
  {
    const Json* const value = find(key);
    if (value != nullptr && value->is_string())
      return { value->get<std::string>() };
    if (value != nullptr &&
      (!value->is_array() ||
        !std::all_of(value->begin(), value->end(), [](const Json& one) { return one.is_string(); })))
      refuse(at(key), "is no list of texts", "write it as [\"one\", \"two\"]");
    return value == nullptr ? std::vector<std::string>{} : value->get<std::vector<std::string>>();
  }

  std::optional<double> number(const std::string& key)
  {
    const Json* const value = find(key);
    if (value != nullptr && !value->is_number())
      refuse(at(key), "is no number", "write it without quotes, as 0.25");
    return value == nullptr ? std::nullopt : std::optional(value->get<double>());
  }

  std::optional<int> whole(const std::string& key, int low, int high)
  {
    const auto value = number(key);
    if (value && !(*value >= low && *value <= high && *value == static_cast<int>(*value)))
    {
      refuse(at(key), "is no whole number from " + std::to_string(low) + " to " + std::to_string(high),
        "give such a number");
    }
    return value ? std::optional(static_cast<int>(*value)) : std::nullopt;
  }

  bool flag(const std::string& key)
  {
    const Json* const value = find(key);
    if (value != nullptr && !value->is_boolean())
      refuse(at(key), "is neither true nor false", "write true or false, without quotes");
    return value != nullptr && value->get<bool>();
  }

  /// A file of the folder, by its name from there.
  std::string file(const std::string& key)
  {
    const std::string name = required(key);
    const fs::path path = fs::path(name).lexically_normal();
    if (path.is_absolute() || path.begin()->string() == "..")
      refuse(at(key), "'" + name + "' lies outside the folder", "copy the file into the folder of the results");
    return path.string();
  }

  /// What `read` makes of each object of a list.
  template <typename Read>
  auto list(const std::string& key, Read read)
  {
    std::vector<decltype(read(std::declval<Object&>()))> all;
    const Json* const value = find(key);
    if (value != nullptr && !value->is_array())
      refuse(at(key), "is no list", "write it as [ { ... }, { ... } ]");
    for (std::size_t i = 0; value != nullptr && i < value->size(); ++i)
    {
      Object one((*value)[i], at(key) + "[" + std::to_string(i) + "]");
      all.push_back(read(one));
      one.done();
    }
    return all;
  }

  /// Refuses keys that nobody asked for.
  void done() const
  {
    for (const auto& [key, value] : json_.items())
      if (std::find(asked_.begin(), asked_.end(), key) == asked_.end())
        refuse(at(key), "is not known", suggestion(key, asked_, "there are " + quotedList(asked_, "and")));
  }

private:
  const Json& json_;
  std::string place_;
  std::vector<std::string> asked_;
};

Rounding roundingOf(Object& object)
{
  Rounding rounding;
  rounding.digits = object.whole("digits", 1, 17);
  rounding.decimals = object.whole("decimals", 0, 17);
  return rounding;
}

FigurePlan figureOf(Object& object)
{
  return { object.file("file"), object.text("number"), object.text("caption"), object.text("alt") };
}

ColumnPlan columnOf(Object& object)
{
  return { object.required("name"), object.text("label"), object.text("unit"), roundingOf(object),
    object.number("factor").value_or(1), object.text("error") };
}

TablePlan tableOf(Object& object)
{
  TablePlan table{ object.file("file"), object.text("caption"), {}, 200 };
  table.rows = static_cast<std::size_t>(object.whole("rows", 1, 100000).value_or(200));
  const Json* const columns = object.find("columns");
  if (columns != nullptr && columns->is_array() && !columns->empty() && columns->front().is_string())
  {
    for (std::string& name : object.texts("columns"))
      table.columns.push_back({ std::move(name), "", "", {}, 1, "" });
    return table;
  }
  table.columns = object.list("columns", columnOf);
  return table;
}

CurvesPlan curvesPlanOf(Object& object)
{
  CurvesPlan curves{ object.file("file"), object.required("x"), object.texts("y"), object.text("group"),
    object.text("error"), object.text("x_label"), object.text("y_label"), object.number("x_factor").value_or(1),
    object.number("y_factor").value_or(1), false, false, object.flag("points"), object.text("caption") };
  if (curves.y.empty())
    refuse(object.at("y"), "is missing", "name one column or more: \"y\": [\"stress\"]");
  if ((curves.y.size() > 1 && !curves.group.empty()) || (curves.y.size() > 1 && !curves.error.empty()))
    refuse(object.at("y"), "names several columns, with \"group\" or \"error\"", "name one, or leave these out");
  const std::string log = object.text("log");
  if (!log.empty() && log != "x" && log != "y" && log != "xy")
    refuse(object.at("log"), "is '" + log + "'", "the logarithmic axes are \"x\", \"y\" or \"xy\"");
  curves.logX = log.starts_with('x');
  curves.logY = log.ends_with('y');
  return curves;
}

std::optional<Said> saidOf(Object& object, const std::string& key)
{
  const Json* const value = object.find(key);
  if (value == nullptr)
    return std::nullopt;
  if (value->is_string())
    return value->get<std::string>();
  if (value->is_number())
    return Measured{ value->get<double>(), std::nullopt };
  if (!value->is_object())
  {
    refuse(object.at(key), "is neither a number, a text nor an object",
      R"(write 0.38, "0.38", {"value": 0.38, "error": 0.02} or {"file": "means.csv", "column": "strength", "where": {"width": 1}})");
  }
  Object inner(*value, object.at(key));
  if (value->contains("value"))
  {
    const Measured measured{ inner.number("value").value_or(0), inner.number("error") };
    inner.done();
    return measured;
  }
  CellPlan cell{ inner.file("file"), inner.required("column"), {}, inner.text("error"),
    inner.number("factor").value_or(1) };
  if (const Json* const where = inner.find("where"))
  {
    if (!where->is_object())
      refuse(inner.at("where"), "is no object", "write it as {\"width\": 1}");
    for (const auto& [name, wanted] : where->items())
      cell.where[name] = wanted.is_string() ? wanted.get<std::string>() : wanted.dump();
  }
  inner.done();
  return cell;
}

ComparisonPlan comparisonOf(Object& object)
{
  return { object.required("what"), object.text("unit"), saidOf(object, "paper"), saidOf(object, "ours"),
    object.text("difference"), object.text("why"), roundingOf(object) };
}

SectionPlan sectionOf(Object& object, int depth)
{
  SectionPlan section;
  section.title = object.required("title");
  section.text = object.paragraphs("text");
  section.comparison = object.list("comparison", comparisonOf);
  section.figures = object.list("figures", figureOf);
  section.curves = object.list("curves", curvesPlanOf);
  section.tables = object.list("tables", tableOf);
  section.discussion = object.paragraphs("discussion");
  if (depth == deepestHeading && object.find("sections") != nullptr)
    refuse(
      object.at("sections"), "goes too deep", "sections have " + std::to_string(deepestHeading) + " levels at most");
  section.sections = object.list("sections", [&](Object& inner) { return sectionOf(inner, depth + 1); });
  return section;
}

TimePlan timeOf(Object& object)
{
  return { object.required("what"), object.number("seconds"), object.number("processor_seconds"), object.text("note") };
}

} // namespace

Plan readPlan(const fs::path& file)
{
  std::error_code none;
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    throw InputError("cannot read '" + file.string() + "': " + std::strerror(errno), "check its permissions");
  if (fs::file_size(file, none) > largestPlan)
    throw InputError("'" + file.string() + "' is larger than 16 MB", "it orders the page; numbers belong into tables");
  Json json;
  try
  {
    json = Json::parse(stream);
  }
  catch (const Json::exception& error) // of numbers beyond the range of double it is no parse_error
  {
    const std::string what = error.what(); // [json.exception.parse_error.101] parse error at line 2, column 3: ...
    throw InputError("'" + file.string() + "' is no JSON: " + what.substr(std::min(what.size(), what.find("] ") + 2)),
      "docs/commands/report.md says what it holds; without the file the page shows what lies in the folder");
  }
  Object object(json, "");
  Plan plan;
  plan.title = object.text("title");
  plan.text = object.paragraphs("text");
  plan.machine = object.text("machine");
  plan.sections = object.list("sections", [](Object& inner) { return sectionOf(inner, 1); });
  plan.times = object.list("times", timeOf);
  object.done();
  return plan;
}

} // namespace lamella::reports
