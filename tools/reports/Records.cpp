#include "reports/Records.h"

#include "reports/Html.h"
#include "reports/JsonHtml.h"

#include <fmt/format.h>

#include <algorithm>

namespace lamella::reports
{

namespace
{

constexpr std::size_t mostRecords = 200; // that are shown
constexpr int mostSteps = 10;            // back to what something was made from

std::string textIn(const cli::Json& json, const char* key)
{
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : "";
}

std::string inputsHtml(const cli::Json& record)
{
  const auto inputs = record.find("inputs");
  std::string html;
  if (inputs == record.end() || !inputs->is_array())
    return html;
  for (const cli::Json& input : *inputs)
  {
    if (input.is_object())
    {
      const std::string hash = textIn(input, input.contains("sha256") ? "sha256" : "sha256_of_ends");
      html += (html.empty() ? "" : "<br>") + escaped(textIn(input, "name")) + " <code>" + escaped(hash.substr(0, 16)) +
        "</code>";
    }
  }
  return html;
}

/// @param files HTML
void addRows(std::string& html, const std::string& files, const cli::Json& record, int step)
{
  const auto cell = [&](const char* key) { return record.contains(key) ? valueHtml(record[key]) : std::string("–"); };
  html += "<tr><td class=\"wide\">" + files + "</td><td class=\"wide\"><code>" + cell("command") + "</code></td><td>" +
    cell("version") + " <code>" + cell("commit") + "</code></td><td>" + cell("date") + "</td><td>" + cell("seed") +
    "</td><td>" + inputsHtml(record) + "</td></tr>\n";
  const auto parameters = record.find("parameters");
  if (step < mostSteps && parameters != record.end() && parameters->is_object() && parameters->contains("made_from") &&
    (*parameters)["made_from"].is_object())
    addRows(html, "made from", (*parameters)["made_from"], step + 1);
}

} // namespace

std::string recordsHtml(const std::vector<JsonFile>& records)
{
  std::vector<JsonFile> once; // names as HTML
  for (const JsonFile& record : records)
  {
    if (!record.json.is_object())
      continue;
    const auto same =
      std::find_if(once.begin(), once.end(), [&](const JsonFile& one) { return one.json == record.json; });
    if (same == once.end())
      once.push_back({ escaped(record.name), record.json });
    else
      same->name += "<br>" + escaped(record.name);
  }
  if (once.empty())
    return "";
  std::string html = "<div class=\"table\"><table class=\"record\">\n<tr><th>file</th><th>command</th><th>version, "
                     "commit</th><th>date</th>"
                     "<th>seed</th><th>inputs, SHA-256</th></tr>\n";
  for (std::size_t i = 0; i < std::min(mostRecords, once.size()); ++i)
    addRows(html, once[i].name, once[i].json, 0);
  html += "</table></div>\n";
  return once.size() <= mostRecords
    ? html
    : html + fmt::format("<p class=\"note\">{} of {} records</p>\n", mostRecords, once.size());
}

} // namespace lamella::reports
