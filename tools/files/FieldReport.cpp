#include "files/FieldReport.h"

#include "session/Text.h"

#include "lattice/AxisNames.h"
#include "vtkLatticeConversion.h"

#include <vtkDataObject.h>

#include <fmt/format.h>

#include <cmath>

namespace lamella::cli
{

double Fields::operator()(const std::string& name, std::size_t i) const
{
  return fieldNumbers(data, name.c_str()).at(i);
}

std::int64_t Fields::whole(const std::string& name, std::size_t i) const
{
  return std::llround((*this)(name, i));
}

std::string Fields::text(const std::string& name) const
{
  return fieldText(data, name.c_str()).value_or("");
}

std::vector<double> Fields::numbers(const std::string& name) const
{
  return fieldNumbers(data, name.c_str());
}

Json Fields::vector(const std::string& name) const
{
  Json json = Json::array();
  for (int c = 0; c < dimension; ++c)
    json.push_back(jsonNumber((*this)(name, static_cast<std::size_t>(c))));
  return json;
}

Json Fields::matrix(const std::string& name) const
{
  const std::vector<double> all = numbers(name);
  Json rows = Json::array();
  for (int row = 0; row < dimension && all.size() == 9; ++row)
  {
    Json line = Json::array();
    for (int column = 0; column < dimension; ++column)
      line.push_back(jsonNumber(all[static_cast<std::size_t>(3 * row + column)]));
    rows.push_back(std::move(line));
  }
  return rows;
}

void addKeys(Json& json, const Fields& f, std::initializer_list<Key> keys, const std::string& prefix)
{
  for (const Key& key : keys)
  {
    const std::string field = prefix + (key.field != nullptr ? key.field : key.name);
    Json& value = json[key.name];
    switch (key.kind)
    {
      case Key::Kind::Number:
        value = jsonNumber(f(field, key.at));
        break;
      case Key::Kind::Whole:
        value = f.whole(field, key.at);
        break;
      case Key::Kind::Text:
        value = f.text(field);
        break;
      case Key::Kind::Texts:
        value = fieldTexts(f.data, field.c_str());
        break;
      case Key::Kind::Flag:
        value = f(field, key.at) != 0;
        break;
      case Key::Kind::Vector:
        value = f.vector(field);
        break;
      case Key::Kind::Matrix:
        value = f.matrix(field);
        break;
    }
  }
}

Json keysOf(const Fields& f, std::initializer_list<Key> keys, const std::string& prefix)
{
  Json json = Json::object();
  addKeys(json, f, keys, prefix);
  return json;
}

std::string shown(const Json& value, const char* form, double scale)
{
  return value.is_number() ? fmt::format(fmt::runtime(form), scale * value.get<double>()) : "-";
}

std::string counted(const Json& value)
{
  return grouped(value.get<std::int64_t>());
}

Json rowsOf(const std::vector<double>& numbers, std::size_t columns)
{
  Json rows = Json::array();
  for (auto row = numbers.begin(); row != numbers.end(); row += static_cast<std::ptrdiff_t>(columns))
    rows.push_back(std::vector<double>(row, row + static_cast<std::ptrdiff_t>(columns)));
  return rows;
}

std::vector<std::string> axesOf(const std::vector<double>& flags)
{
  std::vector<std::string> names;
  for (std::size_t axis = 0; axis < flags.size() && axis < 3; ++axis)
    if (flags[axis] != 0)
      names.emplace_back(axisNames[axis]);
  return names;
}

Json phasesJson(const std::vector<std::string>& names, const std::vector<double>& fractions)
{
  Json phases = Json::array();
  for (std::size_t id = 0; id < fractions.size() && id < names.size(); ++id)
    phases.push_back({ { "name", names[id] }, { "fraction", fractions[id] } });
  return phases;
}

} // namespace lamella::cli
