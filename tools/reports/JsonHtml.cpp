#include "reports/JsonHtml.h"

#include "reports/Html.h"

#include <fmt/format.h>

#include <algorithm>

namespace lamella::reports
{

namespace
{

constexpr std::size_t mostValues = 16; // of a list on one line
constexpr std::size_t mostRows = 50;   // of a list of objects

bool isTable(const cli::Json& json)
{
  return json.is_array() && !json.empty() &&
    std::all_of(
      json.begin(), json.end(), [](const cli::Json& one) { return one.is_object() && !one.empty(); });
}

std::string tableHtml(const cli::Json& rows)
{
  std::vector<std::string> names;
  for (const cli::Json& row : rows)
  {
    for (const auto& [name, value] : row.items())
      if (std::find(names.begin(), names.end(), name) == names.end())
        names.push_back(name);
  }
  std::string html = "<table><tr>";
  for (const std::string& name : names)
    html += "<th>" + escaped(name) + "</th>";
  html += "</tr>\n";
  for (std::size_t i = 0; i < std::min(mostRows, rows.size()); ++i)
  {
    html += "<tr>";
    for (const std::string& name : names)
      html += "<td>" + (rows[i].contains(name) ? valueHtml(rows[i][name]) : "") + "</td>";
    html += "</tr>\n";
  }
  html += "</table>";
  return rows.size() <= mostRows ? html
                                 : html + fmt::format("<p class=\"note\">{} of {} rows</p>", mostRows, rows.size());
}

void addRows(
  std::string& html, const cli::Json& json, const std::string& before, const std::vector<std::string>& without)
{
  for (const auto& [name, value] : json.items())
  {
    if (std::find(without.begin(), without.end(), name) != without.end())
      continue;
    if (value.is_object() && !value.empty())
    {
      addRows(html, value, before + name + ".", {});
      continue;
    }
    html += "<tr><td>" + escaped(before + name) + "</td><td class=\"wide\">" +
      (isTable(value) ? tableHtml(value) : valueHtml(value)) + "</td></tr>\n";
  }
}

} // namespace

std::string valueHtml(const cli::Json& value)
{
  if (value.is_null())
    return "–";
  if (value.is_number_integer())
    return escaped(value.dump());
  if (value.is_number())
    return writtenHtml(std::stod(fmt::format("{:.6g}", value.get<double>())));
  if (value.is_boolean())
    return value.get<bool>() ? "yes" : "no";
  if (value.is_string())
    return escaped(value.get<std::string>());
  if (!value.is_array())
    return escaped(value.dump(-1, ' ', false, cli::Json::error_handler_t::replace));
  std::string html;
  for (std::size_t i = 0; i < std::min(mostValues, value.size()); ++i)
    html += (i > 0 ? ", " : "") + valueHtml(value[i]);
  return value.size() <= mostValues ? html : html + fmt::format(", … ({} in all)", value.size());
}

std::string jsonHtml(const cli::Json& json, const std::vector<std::string>& without)
{
  std::string rows;
  addRows(rows, json, "", without);
  return rows.empty() ? "" : "<div class=\"table\"><table>\n" + rows + "</table></div>\n";
}

} // namespace lamella::reports
