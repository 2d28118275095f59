#include "reports/DataTable.h"

#include "session/Text.h"

#include "core/Error.h"
#include "core/Memory.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>
#include <limits>
#include <utility>

namespace lamella::reports
{

namespace fs = std::filesystem;

namespace
{

/// The path, if it is one to read.
fs::path checked(const fs::path& path)
{
  std::error_code none;
  const std::uintmax_t size = fs::is_regular_file(path, none) ? fs::file_size(path, none) : 0;
  if (size > largestTable)
  {
    throw InputError("'" + path.string() + "' holds " + bytesText(static_cast<double>(size)) + "; tables of up to " +
        bytesText(static_cast<double>(largestTable)) + " are read",
      "make a table of means for the page");
  }
  return path;
}

bool same(const std::string& cell, const std::string& wanted)
{
  const auto a = toNumber(cell);
  const auto b = toNumber(wanted);
  return a && b ? *a == *b : cell == wanted;
}

} // namespace

DataTable::DataTable(const fs::path& path)
  : table_(checked(path), "a table begins with a line of names, and has one line a row")
  , name_(path.filename().string())
{
  const fs::path record = path.string() + ".json";
  std::error_code none;
  std::ifstream beside;
  if (!fs::is_symlink(record, none)) // it may lead out of the folder (Folder.h)
    beside.open(record);
  const auto json = beside.is_open() ? nlohmann::json::parse(beside, nullptr, false) : nlohmann::json();
  if (!json.is_object() || !json.contains("columns") || !json["columns"].is_object())
    return;
  for (const auto& [name, about] : json["columns"].items())
  {
    for (const auto& [key, kept] : { std::pair{ "unit", &units_ }, { "meaning", &meanings_ } })
      if (about.is_object() && about.contains(key) && about[key].is_string())
        (*kept)[name] = about[key].template get<std::string>();
  }
}

std::size_t DataTable::column(const std::string& name) const
{
  const auto found = std::find(names().begin(), names().end(), name);
  if (found == names().end())
  {
    throw InputError("'" + name_ + "' has no column '" + name + "'",
      suggestion(name, names(), "it has " + quotedList(names(), "and")));
  }
  return static_cast<std::size_t>(found - names().begin());
}

std::string DataTable::text(std::size_t row, std::size_t column) const
{
  const std::string& cell = table_.text(row, column);
  const std::size_t begin = cell.find_first_not_of(" \t\r\n");
  return begin == std::string::npos ? "" : cell.substr(begin, cell.find_last_not_of(" \t\r\n") + 1 - begin);
}

double DataTable::number(std::size_t row, std::size_t column) const
{
  return toNumber(text(row, column)).value_or(std::numeric_limits<double>::quiet_NaN());
}

std::vector<double> DataTable::numbers(std::size_t column) const
{
  std::vector<double> values(rows());
  for (std::size_t row = 0; row < values.size(); ++row)
    values[row] = number(row, column);
  return values;
}

bool DataTable::isNumeric(std::size_t column) const
{
  bool some = false;
  for (std::size_t row = 0; row < rows(); ++row)
  {
    const std::string cell = text(row, column);
    if (!cell.empty())
    {
      if (!toNumber(cell))
        return false;
      some = true;
    }
  }
  return some;
}

std::string DataTable::unit(const std::string& name) const
{
  const auto found = units_.find(name);
  return found == units_.end() || found->second == "1" ? "" : found->second;
}

std::string DataTable::label(const std::string& name) const
{
  const std::string of = unit(name);
  return of.empty() ? name : name + " [" + of + "]";
}

std::string DataTable::meaning(const std::string& name) const
{
  const auto found = meanings_.find(name);
  return found == meanings_.end() ? name : found->second;
}

std::size_t DataTable::row(const std::map<std::string, std::string>& cells) const
{
  std::vector<std::pair<std::size_t, std::string>> wanted;
  std::string words;
  for (const auto& [name, value] : cells)
  {
    wanted.emplace_back(column(name), value);
    words += (words.empty() ? "" : ", ") + name + " = " + value;
  }
  std::vector<std::size_t> found;
  for (std::size_t row = 0; row < rows(); ++row)
    if (std::all_of(wanted.begin(), wanted.end(), [&](const auto& w) { return same(text(row, w.first), w.second); }))
      found.push_back(row);
  if (found.size() != 1)
  {
    const std::string of = words.empty() ? "" : " with " + words;
    throw InputError("'" + name_ + "' has " + (found.empty() ? "no row" : std::to_string(found.size()) + " rows") + of,
      "name in \"where\" the columns and values that one row alone has");
  }
  return found.front();
}

} // namespace lamella::reports
