#include "commands/CrackReport.h"

#include "files/TableText.h"
#include "session/Text.h"

#include "vtkCrackPath.h"
#include "vtkLatticeConversion.h"

#include <vtkPolyData.h>
#include <vtkTable.h>

#include <fmt/format.h>

#include <cmath>

namespace lamella::cli
{

namespace
{

std::string text(const Json& value, const char* form, double scale = 1)
{
  return value.is_null() ? std::string("-") : fmt::format(fmt::runtime(form), scale * value.get<double>());
}

std::string micrometres(const Json& metres)
{
  return text(metres, "{:.4g} µm", 1e6);
}

std::string line(const std::string& name, const std::string& words)
{
  return fmt::format("  {:<14}{}\n", name, words);
}

/// The axes that a list of flags names.
std::string axes(const Json& flags)
{
  std::string names;
  for (const Json& axis : flags)
    names += (names.empty() ? "" : " and ") + axis.get<std::string>();
  return names;
}

Json namesOf(const std::vector<double>& flags)
{
  Json names = Json::array();
  for (std::size_t a = 0; a < flags.size(); ++a)
    if (flags[a] != 0)
      names.push_back(std::string(1, "xyz"[a]));
  return names;
}

std::string pathsText(const Json& json)
{
  std::string rows = fmt::format("\n  {:>5}{:>6}{:>14}{:>11}{:>10}{:>9}{:>10}  {}\n", "path", "crack", "length",
    "tortuosity", "angle", "spread", "bonds", "from, to");
  constexpr std::size_t most = 12;
  for (std::size_t i = 0; i < std::min(most, json["paths"].size()); ++i)
  {
    const Json& p = json["paths"][i];
    rows += fmt::format("  {:>5}{:>6}{:>15}{:>11}{:>11}{:>10}{:>10}  {}\n", p["path"].get<int>(), p["crack"].get<int>(),
      micrometres(p["length"]), text(p["tortuosity"], "{:.4f}"), text(p["angle"], "{:.1f}°"),
      text(p["angle_spread"], "{:.1f}°"), grouped(p["bonds"].get<std::int64_t>()),
      p["begins_at"].get<std::string>() + ", " + p["ends_at"].get<std::string>());
  }
  if (json["paths"].size() > most)
    rows += fmt::format("  and {} more\n", json["paths"].size() - most);
  return rows;
}

std::string pairsText(const Json& json)
{
  const bool space = json["dimension"] == 3;
  std::string rows =
    fmt::format("\n  {:<24}{:>14}{:>10}{:>10}\n", "between", space ? "counted area" : "length", "share", "bonds");
  for (const Json& p : json["pairs"])
  {
    rows += fmt::format("  {:<24}{:>{}}{:>10}{:>10}\n", p["pair"].get<std::string>(),
      space ? text(p["counted_area"], "{:.4g} mm²", 1e6) : micrometres(p["length"]), 15,
      text(space ? p["share_of_counted"] : p["share"], "{:.2f} %", 100), grouped(p["bonds"].get<std::int64_t>()));
  }
  return rows;
}

} // namespace

Json reportOf(const CrackReport& report)
{
  vtkPolyData* const paths = report.filter->GetOutput();
  const auto numbers = [&](const char* name) { return fieldNumbers(paths, name); };
  const auto number = [&](const char* name) { return jsonNumber(numbers(name).at(0)); };
  const auto whole = [&](const char* name) { return Json(std::llround(numbers(name).at(0))); };
  const bool plane = !numbers("crack_length").empty();
  Json json;
  json["file"] = report.file;
  json["phases_file"] = report.phases.empty() ? Json(nullptr) : Json(report.phases);
  json["dimension"] = plane ? 2 : 3;
  json["horizon"] = number("horizon");
  json["broken_bonds"] = whole("broken_bonds");
  if (plane)
  {
    json["cracks"] = whole("crack_count");
    json["length"] = number("crack_length");
    const auto place = [&](const char* name) {
      return Json{ { "x", jsonNumber(numbers(name).at(0)) }, { "y", jsonNumber(numbers(name).at(1)) } };
    };
    json["main"] = { { "length", number("main_length") }, { "through", namesOf(numbers("main_through")) },
      { "start", place("main_start") }, { "tip", place("main_tip") }, { "extension", number("main_extension") } };
    json["through"] = Json::object();
    for (std::size_t axis = 0; axis < 2; ++axis)
    {
      const auto along = [&](const char* name) { return jsonNumber(numbers(name).at(axis)); };
      if (!along("through_length").is_null())
      {
        json["through"][std::string(1, "xy"[axis])] = { { "length", along("through_length") },
          { "in_voids", along("through_in_voids") }, { "in_solid", along("through_in_solid") },
          { "chord", along("through_chord") }, { "tortuosity", along("through_tortuosity") } };
      }
    }
    json["angle"] = number("crack_angle");
    json["angle_spread"] = number("crack_angle_spread");
    json["left_out"] = { { "cracks", whole("left_out_cracks") }, { "length", number("left_out_length") },
      { "spurs", whole("left_out_spurs") }, { "bonds", whole("left_out_bonds") } };
    json["crushed_pieces"] = whole("crushed_pieces");
  }
  json[plane ? "counted_length" : "counted_area"] = number("counted_size");
  json["count_anisotropy"] = number("count_anisotropy");
  json["normals"] = numbers("crack_normals");
  json["paths"] = jsonRows(report.filter->GetPathTable());
  json["pairs"] = jsonRows(report.filter->GetPairTable());
  if (!numbers("fragment_count").empty())
  {
    json["fragments"] = { { "count", whole("fragment_count") }, { "largest_share", number("fragment_largest") },
      { "severed", namesOf(numbers("severed")) } };
  }
  return json;
}

std::string tableOf(const Json& json)
{
  const bool plane = json["dimension"] == 2;
  std::string words = fmt::format("{}: {} broken bonds, horizon {:g}\n\n", json["file"].get<std::string>(),
    grouped(json["broken_bonds"].get<std::int64_t>()), json["horizon"].get<double>());
  if (plane)
  {
    const std::string through = axes(json["main"]["through"]);
    words += line("cracks",
      fmt::format("{}, {} together", grouped(json["cracks"].get<std::int64_t>()), micrometres(json["length"])));
    words += line("longest",
      micrometres(json["main"]["length"]) +
        (through.empty() ? ", ends within the sample" : ", from side to side along " + through));
    if (const Json& tip = json["main"]["tip"]; !tip["x"].is_null())
    {
      const Json& start = json["main"]["start"];
      words += line("tip",
        fmt::format("at {}, {}; {} along the crack from {}, {}", micrometres(tip["x"]), micrometres(tip["y"]),
          micrometres(json["main"]["extension"]), micrometres(start["x"]), micrometres(start["y"])));
    }
    for (const auto& [axis, way] : json["through"].items())
    {
      words += line("through",
        fmt::format("along {}: {}, of which {} across voids, {} unbroken; tortuosity {}", axis,
          micrometres(way["length"]), micrometres(way["in_voids"]), micrometres(way["in_solid"]),
          text(way["tortuosity"], "{:.4f}")));
    }
    words +=
      line("direction", text(json["angle"], "{:.1f}°") + " to x, spread " + text(json["angle_spread"], "{:.1f}°"));
    words += line("counted",
      micrometres(json["counted_length"]) + " by the number of broken bonds" +
        text(json["count_anisotropy"], " (± {:.1f} % by direction)", 100));
    const Json& left = json["left_out"];
    words += line("left out",
      fmt::format("{} cracks too short, {} spurs; {} broken bonds lie off the paths",
        grouped(left["cracks"].get<std::int64_t>()), grouped(left["spurs"].get<std::int64_t>()),
        grouped(left["bonds"].get<std::int64_t>())));
  }
  else
  {
    words += line("area",
      text(json["counted_area"], "{:.4g} mm²", 1e6) + " by the number of broken bonds" +
        text(json["count_anisotropy"], " (± {:.1f} % by direction)", 100));
  }
  if (json.contains("fragments"))
  {
    const Json& f = json["fragments"];
    const std::string severed = axes(f["severed"]);
    words += line("fragments",
      fmt::format("{}, the largest {} of the solid; {}", grouped(f["count"].get<std::int64_t>()),
        text(f["largest_share"], "{:.2f} %", 100),
        severed.empty() ? "some reach from side to side" : "severed along " + severed));
  }
  if (!json["paths"].empty())
    words += pathsText(json);
  if (!json["pairs"].empty())
    words += pairsText(json);
  words += wroteText(json["files"].get<std::vector<std::string>>());
  return words;
}

} // namespace lamella::cli
