#include "files/JsonReport.h"
#include "files/Record.h"
#include "program/Commands.h"
#include "reports/Page.h"
#include "session/OutputFile.h"
#include "session/Text.h"

#include "core/Clock.h"
#include "core/Memory.h"
#include "io/Provenance.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>

namespace lamella::cli
{

namespace
{

constexpr int narrowest = 100;
constexpr int widest = 20000; // pixels

struct ReportOptions
{
  CommonOptions common;
  std::string folder;
  std::string output;
  std::string title;
  int pictureWidth = 1600;
  bool strict = false;
};

std::string wordsOf(const Json& json)
{
  const auto count = [&](const char* key) { return json[key].get<std::size_t>(); };
  std::string text = fmt::format("{}: {} pictures, {} charts, {} tables; {}\n", json["title"].get<std::string>(),
    count("pictures"), count("charts"), count("tables"), bytesText(json["bytes"].get<double>()));
  if (count("scaled") > 0)
    text += fmt::format("pictures scaled down to the page's width: {}\n", count("scaled"));
  return text + wroteText({ json["output"].get<std::string>() });
}

void report(Session& session, const ReportOptions& o, const std::string& commandLine)
{
  if (o.pictureWidth < narrowest || o.pictureWidth > widest)
  {
    throw ParameterError(fmt::format("--picture-width {} is not between {} and {}", o.pictureWidth, narrowest, widest),
      "give the pixels that the widest pictures keep");
  }
  const auto start = Clock::now();
  const std::filesystem::path folder = o.folder;
  std::error_code none;
  if (!std::filesystem::is_directory(folder, none))
  {
    throw InputError(std::filesystem::exists(folder, none) ? "'" + o.folder + "' is a file, not a folder"
                                                           : "there is no folder '" + o.folder + "'",
      "give the folder that a command, a scene or a study wrote to");
  }
  const std::filesystem::path page = o.output.empty() ? folder / "report.html" : std::filesystem::path(o.output);
  if (page.extension() != ".html" && page.extension() != ".htm")
    throw ParameterError("-o '" + page.string() + "': pages are written as .html", "end the name in .html");
  OutputFile file(page, o.common.overwrite);
  const io::Provenance run = recordRun(session, commandLine, "", "");
  reports::PageOptions options;
  options.title = o.title;
  options.mostWide = o.pictureWidth;
  options.made = "Made by lamella " + run.version + " (commit " + run.commit + "), " + run.date + ": " + run.command;
  options.progress = [&](double share)
  {
    session.progress(share, "pictures and tables");
    Session::checkInterrupt();
  };
  const reports::PageOfResults made = reports::pageOf(folder, page, options);
  session.endProgress();
  file.needs(made.html.size());
  file.write(made.html);
  file.commit();
  for (const std::string& problem : made.problems)
    session.warn(problem);
  Json json;
  json["folder"] = o.folder;
  json["output"] = page.string();
  json["title"] = made.title;
  json["ordered"] = made.ordered;
  json["pictures"] = made.figures;
  json["scaled"] = made.scaled;
  json["charts"] = made.charts;
  json["tables"] = made.tables;
  json["bytes"] = made.html.size();
  json["problems"] = made.problems;
  json["seconds"] = secondsSince(start);
  printReport(session, o.common, json, run, wordsOf);
  if (o.strict && !made.problems.empty())
  {
    throw InputError(
      fmt::format("{} of the pieces are missing or damaged; the page is written and names them", made.problems.size()),
      "make them anew, or leave out --strict");
  }
}

} // namespace

Command reportCommand(CLI::App& root)
{
  CLI::App* app = root.add_subcommand("report", "One page, of one file, of a folder of results");
  auto o = std::make_shared<ReportOptions>();
  app->add_option("RESULTS", o->folder, "The folder; its report.json, if there is one, orders the page")->required();
  addOption(
    *app, "Page", "--title", o->title, "The page's title; report.json's, or the folder's name, when not given", "TEXT");
  addOption(
    *app, "Page", "--picture-width", o->pictureWidth, "Wider pictures are scaled down to so many pixels", "PIXELS")
    ->capture_default_str();
  app->add_flag("--strict", o->strict, "Fail when a piece is missing or damaged; the page is written all the same")
    ->group("Page");
  addResultFile(*app, "-o,--output", o->output, "The page; RESULTS/report.html when not given", "FILE.html");
  addResultOptions(*app, o->common);
  addExamples(*app,
    { "lamella report results/demo", "lamella report results/demo -o page.html --title \"Softwood\"",
      "lamella report results/frank-2020 --strict --overwrite" });
  return aloneCommand(app, o, report);
}

} // namespace lamella::cli
