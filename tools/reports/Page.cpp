#include "reports/Page.h"

#include "reports/Chart.h"
#include "reports/DataTable.h"
#include "reports/Html.h"
#include "reports/JsonHtml.h"
#include "reports/Pictures.h"
#include "reports/Records.h"
#include "reports/SweepPlan.h"

#include "session/Text.h"

#include "core/Error.h"
#include "core/Memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

namespace lamella::reports
{

namespace fs = std::filesystem;

namespace
{

constexpr std::size_t mostCurves = 40;       // in one chart
constexpr std::size_t mostWarnings = 50;     //
constexpr std::size_t frameBytes = 64 << 10; // of a page, around its sections, at most
constexpr int gridWidth = 1800;              // pixels that pictures side by side share
constexpr int cellWidth = 400;               // of a picture, where as many stand side by side as there is room for

std::size_t pieces(const std::vector<SectionPlan>& sections)
{
  std::size_t count = 0;
  for (const SectionPlan& section : sections)
  {
    count += section.figures.size() + section.curves.size() + section.charts.size() + section.tables.size() +
      pieces(section.sections);
    for (const GridPlan& grid : section.grids)
      count += grid.cells.size();
  }
  return count;
}

std::string imageHtml(const EmbeddedPicture& picture, const std::string& words)
{
  const std::string size =
    picture.width > 0 ? fmt::format(" width=\"{}\" height=\"{}\"", picture.width, picture.height) : "";
  return "<img alt=\"" + escaped(words) + "\"" + size + " src=\"" + picture.source + "\">";
}

/// A page while it is being written.
class Writer
{
public:
  Writer(fs::path folder, const PageOptions& options, PageOfResults& page)
    : folder_(std::move(folder))
    , options_(options)
    , page_(page)
  {
  }

  void write(const Plan& plan, const Found& found);

private:
  // Parts of the page, from the top.
  void writeContents(const std::vector<SectionPlan>& sections);
  void writeSection(const SectionPlan& section, const std::string& id, int level);
  void writeComparison(const std::vector<ComparisonPlan>& rows);
  void writeFigure(const FigurePlan& plan);
  void writeCurves(const CurvesPlan& plan);
  void writeChart(const std::string& drawn, const std::string& captionHtml);
  void writeGrids();
  std::string pictureHtml(const GridPlan::Cell& cell, int mostWide, std::size_t mostBytes);
  void writeTable(const TablePlan& plan);
  void writeScenes(const Found& found);
  void writeReports(const Found& found);
  void writeTimes(const Plan& plan, const Found& found);
  void writeWarnings(const Plan& plan, const Found& found);
  void writeProvenance(const Found& found);
  void writeOthers(const Found& found);

  void add(const std::string& html) { body_ += html; }
  void heading(const std::string& text) { add("<h2>" + escaped(text) + "</h2>\n"); }
  /// Names what is missing or damaged where it would stand.
  std::string missingHtml(const std::string& file, const Error& error)
  {
    page_.problems.emplace_back(error.what());
    return "<p class=\"missing\">" + escaped(file) + " is not shown: " + escaped(error.what()) + "</p>\n";
  }
  void missing(const std::string& file, const Error& error) { add(missingHtml(file, error)); }
  /// Leaves a part out that would make the page too large: half of it is for pictures side by side.
  template <typename Part>
  void bounded(const std::string& what, Part part)
  {
    const std::size_t begin = body_.size();
    part();
    if (mostBytes_ > 0 && body_.size() > mostBytes_ / 2)
    {
      body_.resize(begin);
      std::erase_if(grids_, [&](const auto& grid) { return grid.first > begin; });
      page_.problems.push_back(fmt::format(
        "there is no room for {} in a page of {} at most", what, bytesText(static_cast<double>(mostBytes_))));
    }
  }
  void step()
  {
    ++done_;
    if (options_.progress)
      options_.progress(static_cast<double>(done_) / static_cast<double>(std::max<std::size_t>(1, count_)));
  }
  [[nodiscard]] fs::path placeOf(const std::string& file) const { return requireWithin(folder_, folder_ / file); }
  const DataTable& table(const std::string& file)
  {
    std::unique_ptr<DataTable>& kept = tables_[file];
    if (!kept)
      kept = std::make_unique<DataTable>(placeOf(file));
    return *kept;
  }
  /// One side of a comparison.
  struct Cell
  {
    std::string html;
    std::optional<Measured> number;
  };
  Cell cellOf(const std::optional<Said>& said, const ComparisonPlan& row, bool asWritten);
  /// @pre no text
  Measured measured(const Said& said);

  fs::path folder_;
  const PageOptions& options_;
  PageOfResults& page_;
  std::string body_;
  std::map<std::string, std::unique_ptr<DataTable>> tables_;
  std::vector<JsonFile> records_;                              ///< provenance by file
  std::vector<std::pair<std::size_t, const GridPlan*>> grids_; ///< where they come, once all else is there
  std::size_t mostBytes_ = 0;                                  ///< of the page; 0: any
  std::size_t count_ = 0;
  std::size_t done_ = 0;
};

std::string captionOf(const std::string& number, const std::string& caption)
{
  const std::string before = number.empty() ? "" : "<b>" + escaped(number) + "</b> ";
  return before + (caption.empty() ? "" : markdownLine(caption));
}

void Writer::writeContents(const std::vector<SectionPlan>& sections)
{
  if (sections.size() < 4)
    return;
  add("<nav aria-label=\"Contents\"><ul>\n");
  for (std::size_t i = 0; i < sections.size(); ++i)
    add(fmt::format("<li><a href=\"#s{}\">{}</a></li>\n", i + 1, escaped(sections[i].title)));
  add("</ul></nav>\n");
}

void Writer::writeSection(const SectionPlan& section, const std::string& id, int level)
{
  add(fmt::format("<section id=\"{}\">\n<h{}>{}</h{}>\n", id, level, escaped(section.title), level));
  add(markdown(section.text));
  writeComparison(section.comparison);
  for (const FigurePlan& figure : section.figures)
  {
    writeFigure(figure);
    step();
  }
  for (const CurvesPlan& curves : section.curves)
  {
    bounded("a chart of " + curves.file, [&] { writeCurves(curves); });
    step();
  }
  for (const ChartPlan& plan : section.charts)
  {
    bounded(plan.chart.words, [&] { writeChart(svg(plan.chart), markdownLine(plan.caption)); });
    step();
  }
  for (const GridPlan& grid : section.grids)
  {
    add(markdown(grid.caption));
    grids_.emplace_back(body_.size(), &grid);
  }
  for (const TablePlan& table : section.tables)
  {
    bounded(table.file, [&] { writeTable(table); });
    step();
  }
  if (!section.discussion.empty())
    add("<div class=\"discussion\">\n" + markdown(section.discussion) + "</div>\n");
  for (std::size_t i = 0; i < section.sections.size(); ++i)
    writeSection(section.sections[i], id + "-" + std::to_string(i + 1), level + 1);
  add("</section>\n");
}

Measured Writer::measured(const Said& said)
{
  if (const auto* number = std::get_if<Measured>(&said))
    return *number;
  const auto& cell = std::get<CellPlan>(said);
  const DataTable& from = table(cell.file);
  const std::size_t row = from.row(cell.where);
  Measured found{ cell.factor * from.number(row, from.column(cell.column)), std::nullopt };
  if (!cell.error.empty())
    found.error = std::abs(cell.factor) * from.number(row, from.column(cell.error));
  if (!std::isfinite(found.value))
    throw InputError("'" + cell.file + "' has no number in the column '" + cell.column + "' there", "");
  return found;
}

std::string differenceHtml(
  const std::optional<Measured>& paper, const std::optional<Measured>& ours, const Rounding& rounding)
{
  if (!paper || !ours)
    return "";
  if (paper->value == 0)
    return numberHtml(ours->value, rounding);
  const double percent = 100 * (ours->value - paper->value) / std::abs(paper->value);
  const int decimals = std::abs(percent) < 9.95 ? 1 : 0;
  const std::string text = numberHtml(percent, { {}, decimals }) + " %";
  return percent == 0 ? "0" : percent > 0 ? "+" + text : text;
}

/// What one of the two says; nothing but a dash where it says nothing.
/// @param asWritten a number that stands in report.json keeps the digits that it has there
Writer::Cell Writer::cellOf(const std::optional<Said>& said, const ComparisonPlan& row, bool asWritten)
{
  if (!said)
    return { "–", std::nullopt };
  if (const auto* const words = std::get_if<std::string>(&*said))
    return { markdownLine(*words), std::nullopt };
  try
  {
    const Measured found = measured(*said);
    const bool written = asWritten && std::holds_alternative<Measured>(*said) && !found.error;
    const std::string number = written ? writtenHtml(found.value)
      : found.error                    ? numberHtml(found.value, *found.error, row.rounding)
                                       : numberHtml(found.value, row.rounding);
    return { number + (row.unit.empty() ? "" : " " + escaped(row.unit)), found };
  }
  catch (const Error& error)
  {
    page_.problems.emplace_back(error.what());
    return { "missing: " + escaped(error.what()), std::nullopt };
  }
}

void Writer::writeComparison(const std::vector<ComparisonPlan>& rows)
{
  if (rows.empty())
    return;
  add("<div class=\"table\"><table>\n<tr><th>quantity</th><th class=\"v\">the paper "
      "says</th><th>ours</th><th>difference</th>"
      "<th>why</th></tr>\n");
  for (const ComparisonPlan& row : rows)
  {
    const Cell paper = cellOf(row.paper, row, true);
    const Cell ours = cellOf(row.ours, row, false);
    const auto cell = [](const Cell& one) { return (one.number ? "<td class=\"v\">" : "<td>") + one.html + "</td>"; };
    add("<tr><td>" + markdownLine(row.what) + "</td>" + cell(paper) + cell(ours) + "<td>" +
      (row.difference.empty() ? differenceHtml(paper.number, ours.number, row.rounding)
                              : markdownLine(row.difference)) +
      "</td><td class=\"wide\">" + markdownLine(row.why) + "</td></tr>\n");
  }
  add("</table></div>\n");
}

void Writer::writeFigure(const FigurePlan& plan)
{
  try
  {
    const EmbeddedPicture picture = embed(placeOf(plan.file), options_.mostWide);
    ++page_.figures;
    std::string caption = captionOf(plan.number, plan.caption);
    if (picture.scaled())
    {
      ++page_.scaled;
      caption += fmt::format(" <span class=\"note\">(shown {} pixels wide; the file has {} × {})</span>", picture.width,
        picture.fullWidth, picture.fullHeight);
    }
    add("<figure>" + imageHtml(picture, plan.alt.empty() ? plan.file : plan.alt) + "\n<figcaption>" + caption +
      "</figcaption></figure>\n");
    if (!picture.provenance.empty())
      records_.push_back({ plan.file, cli::Json::parse(picture.provenance, nullptr, false) });
  }
  catch (const Error& error)
  {
    missing(plan.file, error);
  }
}

std::vector<double> numbersOf(const DataTable& table, const std::string& column, double factor)
{
  std::vector<double> numbers = table.numbers(table.column(column));
  std::for_each(numbers.begin(), numbers.end(), [&](double& number) { number *= factor; });
  return numbers;
}

/// One curve, or one for each value of the column `group`.
std::vector<Curve> curvesFrom(const DataTable& table, const CurvesPlan& plan)
{
  const std::vector<double> x = numbersOf(table, plan.x, plan.xFactor);
  const std::vector<double> error =
    plan.error.empty() ? std::vector<double>{} : numbersOf(table, plan.error, plan.yFactor);
  std::vector<Curve> curves;
  if (plan.group.empty())
  {
    for (const std::string& name : plan.y)
      curves.push_back({ plan.y.size() > 1 ? name : "", x, numbersOf(table, name, plan.yFactor), error });
    return curves;
  }
  const std::size_t group = table.column(plan.group);
  const std::vector<double> y = numbersOf(table, plan.y.front(), plan.yFactor);
  for (std::size_t row = 0; row < x.size(); ++row)
  {
    const std::string name = plan.group + " " + table.text(row, group);
    auto curve = std::find_if(curves.begin(), curves.end(), [&](const Curve& one) { return one.name == name; });
    if (curve == curves.end())
      curve = curves.insert(curves.end(), Curve{ name, {}, {}, {} });
    curve->x.push_back(x[row]);
    curve->y.push_back(y[row]);
    if (!error.empty())
      curve->error.push_back(error[row]);
  }
  return curves;
}

void Writer::writeCurves(const CurvesPlan& plan)
{
  try
  {
    Chart chart{ plan.xLabel.empty() ? plan.x : plan.xLabel, plan.yLabel.empty() ? plan.y.front() : plan.yLabel,
      plan.logX, plan.logY, plan.points, "", curvesFrom(table(plan.file), plan) };
    chart.words = chart.yLabel + " over " + chart.xLabel;
    const std::size_t all = chart.curves.size();
    chart.curves.resize(std::min(all, mostCurves));
    const std::string some =
      all > mostCurves ? fmt::format(" <span class=\"note\">({} of {} curves)</span>", mostCurves, all) : "";
    const std::string drawn = svg(chart);
    if (drawn.empty())
    {
      throw InputError(
        "'" + plan.file + "' has no numbers to draw in '" + plan.x + "' and '" + plan.y.front() + "'", "");
    }
    writeChart(drawn, markdownLine(plan.caption) + some);
  }
  catch (const Error& error)
  {
    missing(plan.file, error);
  }
}

void Writer::writeChart(const std::string& drawn, const std::string& captionHtml)
{
  ++page_.charts;
  add("<figure>" + drawn + "<figcaption>" + captionHtml + "</figcaption></figure>\n");
}

/// @param mostBytes 0: any
std::string Writer::pictureHtml(const GridPlan::Cell& cell, int mostWide, std::size_t mostBytes)
{
  std::string shown = "<p class=\"missing\">no picture</p>\n";
  if (!cell.file.empty())
  {
    try
    {
      const EmbeddedPicture picture = embed(placeOf(cell.file), mostWide, mostBytes);
      ++page_.figures;
      page_.scaled += picture.scaled() ? 1 : 0;
      shown = imageHtml(picture, cell.file) + "\n";
    }
    catch (const Error& error)
    {
      shown = missingHtml(cell.file, error);
    }
  }
  return "<figure>" + shown + "<figcaption>" + escaped(cell.caption) + "</figcaption></figure>\n";
}

/// Pictures side by side share the room that all else leaves.
void Writer::writeGrids()
{
  std::size_t pictures = 0;
  std::size_t around = 0; // of tags, names and captions
  for (const auto& [place, grid] : grids_)
  {
    for (const GridPlan::Cell& cell : grid->cells)
    {
      pictures += cell.file.empty() ? 0 : 1;
      around += 200 + escaped(cell.file).size() + escaped(cell.caption).size();
    }
  }
  const std::size_t taken = body_.size() + around + frameBytes;
  const std::size_t share = mostBytes_ == 0 ? 0
    : taken < mostBytes_                    ? (mostBytes_ - taken) / std::max<std::size_t>(1, pictures)
                                            : 1;
  std::string whole;
  std::size_t done = 0;
  for (const auto& [place, grid] : grids_)
  {
    whole += body_.substr(done, place - done);
    done = place;
    const int wide = grid->columns == 0 ? cellWidth : gridWidth / static_cast<int>(grid->columns);
    whole += fmt::format("<div class=\"grid c{}\">\n", grid->columns);
    for (const GridPlan::Cell& cell : grid->cells)
    {
      whole += pictureHtml(cell, std::min(wide, options_.mostWide), share);
      step();
    }
    whole += "</div>\n";
  }
  body_ = whole + body_.substr(done);
}

std::string cellHtml(const DataTable& table, std::size_t row, std::size_t column, const ColumnPlan& plan)
{
  const double value = table.number(row, column);
  if (!std::isfinite(value))
  {
    const std::string text = table.text(row, column);
    return text.empty() || toNumber(text) ? "–" : escaped(text);
  }
  if (!plan.error.empty())
  {
    const double error = std::abs(plan.factor) * table.number(row, table.column(plan.error));
    return numberHtml(plan.factor * value, error, plan.rounding);
  }
  return numberHtml(plan.factor * value, plan.rounding);
}

void Writer::writeTable(const TablePlan& plan)
{
  try
  {
    const DataTable& from = table(plan.file);
    std::vector<ColumnPlan> columns = plan.columns;
    for (std::size_t i = 0; plan.columns.empty() && i < from.names().size(); ++i)
      columns.push_back({ from.names()[i], "", "", {}, 1, "" });
    std::string html = "<div class=\"table\"><table>\n";
    html += plan.caption.empty() ? "" : "<caption>" + markdownLine(plan.caption) + "</caption>\n";
    html += "<tr>";
    std::vector<std::size_t> at;
    std::vector<const char*> kind; // of a cell: numbers stand at the right
    for (const ColumnPlan& column : columns)
    {
      at.push_back(from.column(column.name));
      static_cast<void>(column.error.empty() ? 0 : from.column(column.error)); // told before the table is begun
      const std::string unit = column.unit.empty() && column.factor == 1 ? from.unit(column.name) : column.unit;
      kind.push_back(from.isNumeric(at.back()) ? " class=\"n\">" : ">");
      html += std::string("<th") + kind.back() + escaped(column.label.empty() ? column.name : column.label) +
        (unit.empty() ? "" : " <span class=\"unit\">[" + escaped(unit) + "]</span>") + "</th>";
    }
    html += "</tr>\n";
    const std::size_t shown = std::min(plan.rows, from.rows());
    for (std::size_t row = 0; row < shown; ++row)
    {
      html += "<tr>";
      for (std::size_t i = 0; i < columns.size(); ++i)
        html += std::string("<td") + kind[i] + cellHtml(from, row, at[i], columns[i]) + "</td>";
      html += "</tr>\n";
    }
    html += "</table>\n";
    html += shown < from.rows()
      ? fmt::format("<p class=\"note\">{} of {} rows of {}</p>\n", shown, from.rows(), escaped(plan.file))
      : "";
    add(html + "</div>\n");
    ++page_.tables;
  }
  catch (const Error& error)
  {
    missing(plan.file, error);
  }
}

void Writer::writeScenes(const Found& found)
{
  if (found.scenes.empty())
    return;
  heading(found.scenes.size() == 1 ? "Scene" : "Scenes");
  for (const auto& [name, text] : found.scenes)
    add("<h3>" + escaped(name) + "</h3>\n<pre><code>" + escaped(text) + "</code></pre>\n");
}

void Writer::writeReports(const Found& found)
{
  if (found.reports.empty())
    return;
  heading("Reports");
  constexpr std::size_t most = 50;
  for (std::size_t i = 0; i < std::min(most, found.reports.size()); ++i)
  {
    add("<h3>" + escaped(found.reports[i].name) + "</h3>\n" +
      jsonHtml(found.reports[i].json, { "provenance", "version", "commit", "warnings" }));
  }
  if (found.reports.size() > most)
    add(fmt::format("<p class=\"note\">{} of {} reports, the first by name.</p>\n", most, found.reports.size()));
}

void Writer::writeTimes(const Plan& plan, const Found& found)
{
  std::vector<TimePlan> times = plan.times;
  if (!page_.ordered)
  {
    for (const JsonFile& report : found.reports)
      if (report.json.contains("seconds") && report.json["seconds"].is_number())
        times.push_back({ report.name, report.json["seconds"].get<double>(), std::nullopt, "" });
  }
  if (times.empty() && plan.machine.empty())
    return;
  heading("Times");
  if (!plan.machine.empty())
    add("<p>" + escaped(plan.machine) + "</p>\n");
  if (times.empty())
    return;
  add("<div class=\"table\"><table>\n<tr><th></th><th class=\"n\">by the clock</th><th class=\"n\">of "
      "processors</th><th></th>"
      "</tr>\n");
  double clock = 0;
  double processors = 0;
  for (const TimePlan& time : times)
  {
    clock += time.seconds.value_or(0);
    processors += time.processorSeconds.value_or(0);
    add("<tr><td>" + markdownLine(time.what) + "</td><td class=\"n\">" +
      (time.seconds ? timeText(*time.seconds) : "–") + "</td><td class=\"n\">" +
      (time.processorSeconds ? timeText(*time.processorSeconds) : "–") + "</td><td>" + markdownLine(time.note) +
      "</td></tr>\n");
  }
  if (times.size() > 1)
  {
    add("<tr><td><b>all</b></td><td class=\"n\">" + (clock > 0 ? timeText(clock) : "–") + "</td><td class=\"n\">" +
      (processors > 0 ? timeText(processors) : "–") + "</td><td></td></tr>\n");
  }
  add("</table></div>\n");
}

void Writer::writeWarnings(const Plan& plan, const Found& found)
{
  std::string html;
  std::size_t count = 0;
  for (const JsonFile& report : found.reports)
  {
    const auto name = plan.names.find(report.name);
    for (const char* const key : { "error", "errors", "warnings" })
    {
      const cli::Json said = report.json.contains(key) ? report.json[key] : cli::Json();
      for (const cli::Json& one : said.is_array() ? said
          : said.is_string()                      ? cli::Json::array({ said })
                                                  : cli::Json::array())
        if (++count <= mostWarnings)
          html += "<li>" + (name == plan.names.end() ? "" : escaped(name->second) + ": ") + escaped(report.name) +
            ": " + valueHtml(one) + "</li>\n";
    }
  }
  if (count > mostWarnings)
    html += fmt::format("<li>and {} more</li>\n", count - mostWarnings);
  if (!html.empty())
  {
    heading("Warnings and errors of the runs");
    add("<ul>\n" + html + "</ul>\n");
  }
}

void Writer::writeProvenance(const Found& found)
{
  for (const std::vector<JsonFile>* const files : { &found.reports, &found.besides })
  {
    for (const JsonFile& file : *files)
      if (file.json.contains("provenance"))
        records_.push_back({ file.name, file.json["provenance"] });
  }
  const std::string html = recordsHtml(records_);
  if (!html.empty())
  {
    heading("Provenance");
    add(html);
  }
}

void Writer::writeOthers(const Found& found)
{
  if (page_.ordered || found.others.empty())
    return;
  heading("Other files");
  add("<p class=\"note\">For ParaView, or for <code>lamella info</code>.</p>\n<ul>\n");
  constexpr std::size_t most = 100;
  for (std::size_t i = 0; i < std::min(most, found.others.size()); ++i)
  {
    const auto& [name, bytes] = found.others[i];
    add("<li>" + escaped(name) + ", " + bytesText(static_cast<double>(bytes)) + "</li>\n");
  }
  add(
    found.others.size() > most ? fmt::format("<li>and {} more</li>\n</ul>\n", found.others.size() - most) : "</ul>\n");
}

void Writer::write(const Plan& plan, const Found& found)
{
  page_.title = !options_.title.empty() ? options_.title : !plan.title.empty() ? plan.title : "Results";
  count_ = pieces(plan.sections);
  mostBytes_ = plan.mostBytes;
  bounded("the introduction", [&] { add(markdown(plan.text)); });
  writeContents(plan.sections);
  const std::size_t intro = body_.size();
  if (!plan.scene)
    writeScenes(found);
  for (std::size_t i = 0; i < plan.sections.size(); ++i)
    writeSection(plan.sections[i], "s" + std::to_string(i + 1), 2);
  if (plan.scene)
    bounded("the scene", [&] { writeScenes(found); });
  else if (!page_.ordered)
    writeReports(found);
  writeTimes(plan, found);
  bounded(
    "the warnings", [&] { writeWarnings(plan, found); });
  bounded(
    "the provenance", [&] { writeProvenance(found); });
  bounded("the names of other files", [&] { writeOthers(found); });
  writeGrids();
  std::string problems;
  for (std::size_t i = 0; i < page_.problems.size() && (mostBytes_ == 0 || problems.size() < frameBytes / 2); ++i)
    problems += "<li>" + escaped(page_.problems[i]) + "</li>\n";
  if (!problems.empty())
  {
    body_.insert(
      intro, "<div class=\"problems\"><p><b>Missing or damaged</b></p>\n<ul>\n" + problems + "</ul></div>\n");
  }
  page_.html = page(page_.title,
    "<h1>" + escaped(page_.title) + "</h1>\n" + body_ + "<footer>" + escaped(options_.made) + "</footer>\n");
}

} // namespace

PageOfResults pageOf(const fs::path& folder, const fs::path& own, const PageOptions& options)
{
  PageOfResults result;
  const Found found = look(folder, own, result.problems);
  std::error_code none;
  result.ordered = fs::exists(folder / "report.json", none);
  const Plan plan = result.ordered ? readPlan(requireWithin(folder, folder / "report.json"))
    : found.scene                  ? planOfSweep(folder, found)
                                   : planOf(folder, found);
  Writer(folder, options, result).write(plan, found);
  return result;
}

} // namespace lamella::reports
