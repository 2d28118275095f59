#include "commands/FilterRun.h"
#include "files/FieldReport.h"
#include "files/GridFile.h"
#include "files/Record.h"
#include "files/ResultFiles.h"
#include "program/Commands.h"
#include "program/SettingOptions.h"
#include "session/Text.h"
#include "session/Workspace.h"

#include "TextTable.h"
#include "core/Clock.h"
#include "io/Provenance.h"
#include "vtkCompressionCurve.h"
#include "vtkLatticeConversion.h"

#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkTable.h>

#include <fmt/format.h>

#include <algorithm>
#include <memory>

namespace lamella::cli
{

namespace
{

struct CompressionCurveOptions
{
  CommonOptions common;
  std::string file;
  std::string strain = "strain";
  std::string stress = "stress";
  SettingOptions settings;
  std::string output;
};

/// The same of a table in memory. @throws InputError
vtkSmartPointer<vtkTable> curveInMemory(const CompressionCurveOptions& o)
{
  const auto data = Workspace::find(o.file);
  auto* const whole = vtkTable::SafeDownCast(data);
  auto table = vtkSmartPointer<vtkTable>::New();
  for (const auto& [name, column] : { std::pair{ "strain", o.strain }, std::pair{ "stress", o.stress } })
  {
    auto* const found = whole != nullptr ? vtkDataArray::SafeDownCast(whole->GetColumnByName(column.c_str())) : nullptr;
    if (found == nullptr)
      throw InputError("'" + o.file + "' has no column '" + column + "'", "name the columns with strain and stress");
    vtkNew<vtkDoubleArray> values;
    values->DeepCopy(found);
    values->SetName(name);
    table->AddColumn(values);
  }
  return table;
}

/// The two columns of the file. @throws InputError
vtkSmartPointer<vtkTable> readCurve(const CompressionCurveOptions& o)
{
  if (Workspace::holds(o.file))
    return curveInMemory(o);
  const TextTable text(o.file, "name the columns with --strain and --stress");
  auto table = vtkSmartPointer<vtkTable>::New();
  for (const auto& [name, column] : { std::pair{ "strain", o.strain }, std::pair{ "stress", o.stress } })
  {
    const auto found = std::ranges::find(text.names(), column);
    if (found == text.names().end())
      text.lacks("'" + column + "'");
    vtkNew<vtkDoubleArray> values;
    values->SetName(name);
    for (std::size_t row = 0; row < text.rows(); ++row)
      values->InsertNextValue(text.number(row, static_cast<std::size_t>(found - text.names().begin())));
    describe(values, name == std::string("strain") ? "1" : "Pa", "column '" + column + "' of the file", "lamella");
    table->AddColumn(values);
  }
  return table;
}

Json reportOf(const CompressionCurveOptions& o, vtkTable* curve)
{
  Json json;
  json["file"] = o.file;
  json["rows"] = curve->GetNumberOfRows();
  using enum Key::Kind;
  const auto told = [&](std::initializer_list<Key> keys)
  {
    Json object = keysOf({ curve }, keys, "curve_");
    return object.front().is_null() ? Json(nullptr) : object; // what was not found is null as a whole
  };
  json["stiffness"] =
    told({ { "value", Number, "stiffness" }, { "error", Number, "stiffness_error" }, { "intercept" }, { "r2" },
      { "toe" }, { "low", Number, "fit_range" }, { "high", Number, "fit_range", 1 }, { "rows", Whole, "fit_rows" } });
  json["yield"] = told({ { "strain", Number, "yield_strain" }, { "stress", Number, "yield_stress" } });
  json["peak"] = told({ { "strain", Number, "peak_strain" }, { "stress", Number, "peak_stress" } });
  json["plateau"] = told({ { "stress", Number, "plateau_stress" }, { "low", Number, "plateau_range" },
    { "high", Number, "plateau_range", 1 }, { "end_strain", Number, "plateau_end_strain" } });
  json["densification"] =
    told({ { "strain", Number, "densification_strain" }, { "stress", Number, "densification_stress" },
      { "energy", Number, "densification_energy" }, { "efficiency", Number, "densification_efficiency" } });
  addKeys(json, { curve }, { { "energy" }, { "missing", Texts } }, "curve_");
  return json;
}

std::string curveTable(const Json& json)
{
  std::string text = fmt::format("{}: {} rows\n\n", json["file"].get<std::string>(), json["rows"].get<int>());
  const auto line = [&](const char* name, const Json& group, const auto& words)
  { text += fmt::format("  {:<14} {}\n", name, group.is_null() ? std::string("none") : words(group)); };
  const auto at = [](const Json& group, const char* key) { return group[key].template get<double>(); };
  const auto point = [&](const Json& p)
  { return fmt::format("{:.4g} Pa at a strain of {:.4g}", at(p, "stress"), at(p, "strain")); };
  line("stiffness", json["stiffness"],
    [&](const Json& s)
    {
      return fmt::format("{:.4g} ± {:.2g} Pa between strains of {:.4g} and {:.4g} ({} rows, R² {:.4f}, toe {:.2g})",
        at(s, "value"), at(s, "error"), at(s, "low"), at(s, "high"), s["rows"].get<int>(), at(s, "r2"), at(s, "toe"));
    });
  line("yield", json["yield"], point);
  line("first peak", json["peak"], point);
  line(
    "plateau", json["plateau"],
    [&](const Json& p)
    {
      return fmt::format(
        "{:.4g} Pa between strains of {:.4g} and {:.4g}", at(p, "stress"), at(p, "low"), at(p, "high"));
    });
  line(
    "densification", json["densification"],
    [&](const Json& d)
    {
      return fmt::format("at a strain of {:.4g}: {:.4g} J/m³ absorbed, efficiency {:.4f}", at(d, "strain"),
        at(d, "energy"), at(d, "efficiency"));
    });
  line("energy", json["energy"], [](const Json& e) { return fmt::format("{:.4g} J/m³ in all", e.get<double>()); });
  if (!json["missing"].empty())
    text += "\n";
  for (const Json& why : json["missing"])
    text += "  " + why.get<std::string>() + "\n";
  text += wroteText(json["files"].get<std::vector<std::string>>());
  return text;
}

void compressionCurve(Session& session, const CompressionCurveOptions& o, const std::string& commandLine)
{
  const auto start = Clock::now();
  vtkNew<vtkCompressionCurve> filter;
  o.settings.give(filter);
  requireFile(o.file);
  ResultFiles files;
  files.addTable("-o", o.output, filter->GetOutput(), o.common.overwrite);
  const vtkSmartPointer<vtkTable> table = readCurve(o);
  filter->SetInputData(table);
  runFilter(session, filter, "curve");
  tellWarnings(session);
  Json json = reportOf(o, filter->GetOutput());
  const io::Provenance run = recordRun(session, commandLine, o.file, "");
  json["files"] = files.write(io::toJson(run));
  json["seconds"] = secondsSince(start);
  printReport(session, o.common, json, run, curveTable);
}

} // namespace

Command compressionCurveCommand(CLI::App& root)
{
  CLI::App* app = root.add_subcommand("compression-curve",
    "Stiffness, collapse, plateau, densification and energy of a stress-strain curve in compression");
  auto o = std::make_shared<CompressionCurveOptions>();
  app->add_option("FILE", o->file, "A table as .csv, its first line the columns' names")->required();
  addOption(*app, "Curve", "--strain", o->strain, "Column of strains: fractions, rising, compression positive", "NAME");
  addOption(*app, "Curve", "--stress", o->stress, "Column of stresses [Pa], compression positive", "NAME");
  o->settings.declare(*app, "vtkCompressionCurve");
  addResultFile(*app, "-o,--output", o->output, "Write the curve with energy and efficiency, one row a row");
  addResultOptions(*app, o->common);
  addExamples(*app,
    { "lamella compression-curve curve.csv --json",
      "lamella compression-curve curve.csv --plateau-range 0.2,0.4 -o energy.csv",
      "lamella compression-curve test.csv --strain eps --stress sigma --stiffness-range 0,0.1 --window 0.01" });
  return aloneCommand(app, o, compressionCurve);
}

} // namespace lamella::cli
