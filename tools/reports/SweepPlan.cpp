#include "reports/SweepPlan.h"

#include "reports/Samples.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

namespace lamella::reports
{

namespace fs = std::filesystem;

namespace
{

constexpr std::size_t mostSeries = 8;  // in one chart: as many as there are colours
constexpr std::size_t mostCharts = 40; // of a page
constexpr std::size_t mostCells = 300; // pictures of a page
constexpr std::size_t mostGrids = 12;  //
constexpr std::size_t shownValues = 8; // of a key
constexpr std::size_t shownNames = 20; // of measures that do not change
constexpr double widely = 30;          // the largest over the least number on a logarithmic axis, at least
constexpr double lowPart = 0.25;       // of the largest number, below which their median lies then

/// The error of a measure that its command tells, where the scene measures that too.
struct ToldError
{
  std::string column;
  std::vector<double> values;
  bool relative = false;
};

std::optional<ToldError> toldError(const DataTable& table, const std::string& measure)
{
  struct Pair
  {
    const char* value;
    const char* error;
    bool relative;
  };
  constexpr std::array<Pair, 4> pairs{ { { ".effective.", ".estimated_errors.", true },
    { ".value", ".estimated_error", false }, { ".value", ".error", false }, { ".theta", ".theta_error", false } } };
  const std::string path = table.meaning(measure);
  const auto told = [&](const std::string& wanted, bool relative) -> std::optional<ToldError>
  {
    const auto column =
      std::ranges::find_if(table.names(), [&](const std::string& name) { return table.meaning(name) == wanted; });
    return column == table.names().end()
      ? std::nullopt
      : std::optional(ToldError{ *column, table.numbers(table.column(*column)), relative });
  };
  for (const Pair& pair : pairs)
  {
    const std::size_t at = path.rfind(pair.value);
    if (at == std::string::npos)
      continue;
    const std::string before = path.substr(0, at);
    const std::string behind = path.substr(at + std::string(pair.value).size());
    if (auto found = told(fmt::format("{}{}{}", before, pair.error, behind), pair.relative))
      return found;
    if (auto found = told(before + ".estimated_error", true); found && pair.relative) // the largest of all directions
      return found;
  }
  return std::nullopt;
}

/// Mean and standard deviation; not a number where there are not enough.
std::pair<double, double> meanAndDeviation(const std::vector<double>& values)
{
  const auto count = static_cast<double>(values.size());
  double sum = 0;
  for (const double value : values)
    sum += value;
  double squares = 0;
  for (const double value : values)
    squares += (value - sum / count) * (value - sum / count);
  return { sum / count, count > 1 ? std::sqrt(squares / (count - 1)) : std::numeric_limits<double>::quiet_NaN() };
}

/// Whether most numbers lie together at the low end, where a logarithmic axis alone tells them apart.
bool spreads(std::vector<double> values)
{
  std::ranges::sort(values);
  return values.size() > 2 && values.front() > 0 && values.back() / values.front() >= widely &&
    values[values.size() / 2] < lowPart * values.back();
}

/// "`a` and `b`"
std::string listed(const std::vector<std::string>& names)
{
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + literal(names[i]);
  return text;
}

std::vector<std::string> pathsOf(const std::vector<const SweptKey*>& keys)
{
  std::vector<std::string> paths;
  std::ranges::transform(keys, std::back_inserter(paths), &SweptKey::path);
  return paths;
}

/// A measure of the samples, without keys that it does not depend on.
struct Measure
{
  std::size_t column = 0;
  std::vector<const SweptKey*> keys;
  std::vector<const SweptKey*> idle;
  std::vector<std::size_t> rows; ///< one of those that differ in idle keys alone; where there is a number
};

Measure measureOf(const Samples& samples, std::size_t column)
{
  Measure measure{ column, {}, {}, {} };
  const std::vector<double> values = samples.table().numbers(column);
  const auto settingOf = [&](std::size_t row, const auto& counts)
  {
    std::vector<std::size_t> setting;
    for (const SweptKey& key : samples.keys())
      if (counts(key))
        setting.push_back(key.ofRow[row]);
    return setting;
  };
  for (const SweptKey& key : samples.keys())
  {
    std::map<std::vector<std::size_t>, double> known;
    bool matters = false;
    bool compared = false;
    for (std::size_t row = 0; row < values.size() && !matters; ++row)
    {
      if (!std::isfinite(values[row]))
        continue;
      const auto [at, added] =
        known.try_emplace(settingOf(row, [&](const SweptKey& other) { return &other != &key; }), values[row]);
      compared = compared || !added;
      matters = std::abs(values[row] - at->second) > roundOff * std::abs(at->second);
    }
    (matters || !compared ? measure.keys : measure.idle).push_back(&key);
  }
  const auto counts = [&](const SweptKey& key) { return std::ranges::find(measure.keys, &key) != measure.keys.end(); };
  std::set<std::vector<std::size_t>> known;
  for (std::size_t row = 0; row < values.size(); ++row)
    if (std::isfinite(values[row]) && known.insert(settingOf(row, counts)).second)
      measure.rows.push_back(row);
  return measure;
}

/// What is in one place of a chart.
struct Group
{
  std::vector<double> values;
  double told = std::numeric_limits<double>::quiet_NaN(); ///< error of the last one
};

/// A measure over a key, before means are taken.
struct Grouped
{
  std::vector<std::string> over;               ///< keys that means are taken over
  std::vector<std::string> names;              ///< of curves: what the other keys are there
  std::vector<std::map<double, Group>> curves; ///< by the place along x
};

/// What other keys are is told apart by curves, as far as there are colours.
Grouped grouped(
  const Samples& samples, const Measure& measure, const SweptKey& key, const std::optional<ToldError>& told)
{
  Grouped found;
  std::vector<const SweptKey*> apart;
  std::size_t series = 1;
  for (const SweptKey* const other : measure.keys)
  {
    const bool fits = !other->averaged && series * other->values.size() <= mostSeries;
    if (other == &key)
      continue;
    if (!fits)
    {
      found.over.push_back(other->path);
      continue;
    }
    series *= other->values.size();
    apart.push_back(other);
  }
  std::map<std::string, std::size_t> known;
  const std::vector<double> values = samples.table().numbers(measure.column);
  for (const std::size_t row : measure.rows)
  {
    std::string name;
    for (const SweptKey* const one : apart)
      name += (name.empty() ? "" : ", ") + one->text(one->ofRow[row]);
    const auto [at, added] = known.try_emplace(name, found.curves.size());
    if (added)
    {
      found.names.push_back(name);
      found.curves.emplace_back();
    }
    Group& group = found.curves[at->second][key.coordinates[key.ofRow[row]]];
    group.values.push_back(values[row]);
    if (told)
      group.told = told->values[row] * (told->relative ? std::abs(values[row]) : 1);
  }
  return found;
}

/// Means of a measure over a key, with bars. Nothing where there is no number.
std::optional<ChartPlan> chartOf(const Samples& samples, const Measure& measure, const SweptKey& key)
{
  const DataTable& table = samples.table();
  const std::string& name = table.names()[measure.column];
  const std::optional<ToldError> told = toldError(table, name);
  const Grouped found = grouped(samples, measure, key, told);
  std::vector<std::size_t> counts;
  for (const auto& curve : found.curves)
    for (const auto& [x, group] : curve)
      counts.push_back(group.values.size());
  if (counts.empty())
    return std::nullopt;
  const auto [least, most] = std::ranges::minmax(counts);
  ChartPlan plan;
  Chart& chart = plan.chart;
  chart.xLabel = table.label(key.path);
  chart.yLabel = table.label(name);
  chart.words = name + " over " + key.path;
  if (!key.numbers)
    chart.kinds = key.values;
  std::vector<double> means;
  bool bars = false;
  for (std::size_t i = 0; i < found.curves.size(); ++i)
  {
    Curve curve{ found.names[i], {}, {}, {} };
    for (const auto& [x, group] : found.curves[i])
    {
      const auto [mean, deviation] = meanAndDeviation(group.values);
      curve.x.push_back(x);
      curve.y.push_back(mean);
      curve.error.push_back(most > 1 ? deviation : group.told);
      means.push_back(mean);
      bars = bars || std::isfinite(curve.error.back());
    }
    chart.curves.push_back(std::move(curve));
  }
  chart.apart = bars && key.numbers && chart.curves.size() > 1;
  chart.logX = key.numbers && spreads(key.coordinates);
  chart.logY = spreads(means);
  plan.caption = fmt::format("{} over {}. ", literal(name), literal(key.path));
  if (most > 1)
  {
    plan.caption += fmt::format("Means of {}{} samples, over {}; bars: standard deviation of a sample.",
      least < most ? fmt::format("{} to ", least) : "", most, listed(found.over));
  }
  else
  {
    plan.caption += "One sample each";
    plan.caption += bars ? "; bars: its error as the command tells it, " + literal(told->column) + "." : ".";
  }
  plan.caption += chart.apart ? " Curves stand a few pixels apart." : "";
  return plan;
}

/// Each measure over each key; of those that are the same everywhere the value alone.
SectionPlan chartsOf(const Samples& samples)
{
  SectionPlan section;
  section.title = "Measures";
  const DataTable& table = samples.table();
  std::vector<std::string> same;
  std::size_t charts = 0;
  std::size_t leftOut = 0;
  for (const std::size_t measure : samples.measures())
  {
    const std::string& name = table.names()[measure];
    std::vector<double> values = table.numbers(measure);
    std::erase_if(values, [](double value) { return !std::isfinite(value); });
    if (values.empty())
      continue;
    const auto [low, high] = std::ranges::minmax(values);
    if (low == high && table.rows() > 1)
    {
      const std::string unit = table.unit(name);
      same.push_back(literal(name) + " " + numberText(low) + (unit.empty() ? "" : " " + unit));
      continue;
    }
    if (charts >= mostCharts)
    {
      ++leftOut;
      continue;
    }
    SectionPlan one;
    one.title = name;
    if (const std::string meaning = table.meaning(name); meaning != name)
      one.text = literal(meaning);
    const Measure of = measureOf(samples, measure);
    for (const SweptKey* const key : of.keys)
    {
      if (key->averaged)
        continue;
      if (auto chart = chartOf(samples, of, *key))
      {
        ++charts;
        one.charts.push_back(std::move(*chart));
      }
    }
    if (const std::vector<std::string> idle = pathsOf(of.idle); !idle.empty())
      one.text += (one.text.empty() ? "" : ". ") + std::string("It does not depend on ") + listed(idle) + ".";
    if (!one.charts.empty())
      section.sections.push_back(std::move(one));
  }
  if (leftOut > 0)
    section.text += fmt::format("Charts of {} measures are left out; `[measure]` in the scene chooses.\n\n", leftOut);
  if (!same.empty())
  {
    section.text += "The same in all samples: ";
    for (std::size_t i = 0; i < std::min(shownNames, same.size()); ++i)
      section.text += (i > 0 ? ", " : "") + same[i];
    section.text += same.size() > shownNames ? fmt::format(" and {} more.\n\n", same.size() - shownNames) : ".\n\n";
  }
  return section;
}

/// Files of a kind, by the folder of their sample.
struct FilesOfSamples
{
  std::map<std::string, std::string> files;
  std::map<std::string, std::size_t> counts; ///< of steps
  std::size_t steps = 0;                     ///< the most of a sample
};

/// "damage.png" of its own name, and of steps, "film_0004.png", "film.png".
std::string kindOf(const fs::path& file)
{
  const std::string stem = file.stem().string();
  const std::size_t score = stem.rfind('_');
  const bool step = score != std::string::npos && stem.size() == score + 5 &&
    std::all_of(
      stem.begin() + static_cast<std::ptrdiff_t>(score) + 1, stem.end(), [](char c) { return c >= '0' && c <= '9'; });
  return step ? stem.substr(0, score) : stem;
}

/// Files in the folders of samples, by their kind; the others are handed back.
std::map<std::string, FilesOfSamples> bySample(const std::vector<std::string>& files, std::vector<std::string>& others)
{
  std::map<std::string, FilesOfSamples> kinds;
  for (const std::string& file : files)
  {
    const std::size_t slash = file.find('/', std::string("samples/").size());
    if (!file.starts_with("samples/") || slash == std::string::npos)
    {
      others.push_back(file);
      continue;
    }
    FilesOfSamples& kind = kinds[kindOf(file)];
    const std::string sample = file.substr(0, slash);
    kind.files[sample] = file; // of steps the last
    kind.steps = std::max(kind.steps, ++kind.counts[sample]);
  }
  return kinds;
}

/// Curves that stages wrote, over their first column: one a sample, of the first samples of the settings.
SectionPlan sampleCurvesOf(const fs::path& path, const Found& found, const Samples& samples)
{
  SectionPlan section;
  section.title = "Curves";
  std::vector<std::string> others;
  for (const auto& [name, kind] : bySample(found.tables, others))
  {
    std::map<std::size_t, ChartPlan> charts; // by the column that is drawn
    const std::vector<std::size_t> rows = samples.some(mostSeries);
    const std::vector<std::string> captions = samples.captions(rows);
    for (std::size_t i = 0; i < rows.size(); ++i)
    {
      const auto file = kind.files.find(samples.folderOf(rows[i]));
      if (file == kind.files.end() || section.charts.size() >= mostCharts)
        continue;
      try
      {
        const DataTable table(requireWithin(path, path / file->second));
        const std::string& xName = table.names().front();
        const std::vector<double> x = table.numbers(0);
        if (!table.isNumeric(0) || x.size() < fewestPoints || !std::ranges::is_sorted(x))
          continue;
        for (std::size_t column = 1; column < table.names().size() && column <= drawnColumns; ++column)
        {
          if (!table.isNumeric(column))
            continue;
          const std::string& yName = table.names()[column];
          ChartPlan& plan = charts[column];
          plan.chart.xLabel = table.label(xName);
          plan.chart.yLabel = table.label(yName);
          plan.chart.words = fmt::format("{} over {}", yName, xName);
          plan.caption = fmt::format("{}: {} over {}", literal(name + ".csv"), literal(yName), literal(xName)) +
            (kind.files.size() > mostSeries ? fmt::format(", of up to {} of {} samples", mostSeries, kind.files.size())
                                            : "");
          plan.chart.curves.push_back({ captions[i], x, table.numbers(column), {} });
        }
      }
      catch (const Error&) // NOLINT(bugprone-empty-catch): curves that are there are shown
      {
      }
    }
    for (auto& [column, plan] : charts)
      section.charts.push_back(std::move(plan));
  }
  return section;
}

SectionPlan picturesOf(const Found& found, const std::optional<Samples>& samples)
{
  std::vector<std::string> others;
  const std::map<std::string, FilesOfSamples> kinds = bySample(found.pictures, others);
  SectionPlan section;
  section.title = "Pictures";
  if (kinds.size() > mostGrids)
    section.text = fmt::format("{} of {} kinds are shown, the first by name.", mostGrids, kinds.size());
  const std::size_t grids = std::min(mostGrids, kinds.size()) + (others.empty() ? 0 : 1);
  const std::size_t most = mostCells / std::max<std::size_t>(1, grids);
  for (const auto& [name, kind] : kinds)
  {
    if (section.sections.size() == mostGrids)
      break;
    GridPlan grid;
    std::size_t all = kind.files.size();
    if (samples)
    {
      all = samples->table().rows();
      const std::vector<std::size_t> rows = samples->some(most);
      std::set<std::size_t> last; // values of the key that changes fastest: one column each
      for (const std::size_t row : rows)
      {
        const auto file = kind.files.find(samples->folderOf(row));
        grid.cells.push_back({ file == kind.files.end() ? "" : file->second,
          samples->caption(row) + (samples->failed(row) ? " (failed)" : "") });
        if (!samples->keys().empty())
          last.insert(samples->keys().back().ofRow[row]);
      }
      const std::size_t columns = last.size() < 3 ? 4 : last.size(); // two pairs side by side
      grid.columns = columns <= 6 ? std::min(columns, rows.size()) : 0;
    }
    else
    {
      for (const auto& [sample, file] : kind.files)
        if (grid.cells.size() < most)
          grid.cells.push_back({ file, sample });
    }
    if (grid.cells.size() < all)
      grid.caption = fmt::format("{} of {} samples. ", grid.cells.size(), all);
    if (kind.steps > 1)
      grid.caption += fmt::format("The last of up to {} steps.", kind.steps);
    SectionPlan one;
    one.title = name;
    one.grids.push_back(std::move(grid));
    section.sections.push_back(std::move(one));
  }
  if (!others.empty())
  {
    others.resize(std::min(most, others.size()));
    GridPlan grid{ "", others.size() <= 3 ? others.size() : 0, {} };
    for (const std::string& file : others)
      grid.cells.push_back({ file, file });
    section.grids.push_back(std::move(grid));
  }
  return section;
}

bool isOfRun(const std::string& table)
{
  static const std::set<std::string> known{ "table.csv", "settings.csv", "times.csv" };
  return known.contains(table) || (table.starts_with("steps_") && table.find('/') == std::string::npos);
}

/// Means and deviations of settings, side by side; all of its columns where it is another table.
TablePlan meansOf(const fs::path& path)
{
  TablePlan plan{ "settings.csv", literal("settings.csv"), {}, shownRows };
  const DataTable table(path);
  const std::vector<std::string>& names = table.names();
  for (const std::string& name : names)
  {
    const std::string measure = name.substr(0, name.rfind('.'));
    const auto has = [&](const char* ending) { return std::ranges::find(names, measure + ending) != names.end(); };
    const bool family = has(".mean") && has(".deviation") && has(".error");
    if (family && name.ends_with(".mean"))
    {
      plan.caption = literal("settings.csv") + ": mean ± standard deviation of a sample";
      plan.columns.push_back({ name, measure, table.unit(name), {}, 1, measure + ".deviation" });
    }
    else if (!family)
      plan.columns.push_back({ name, "", "", {}, 1, "" });
  }
  return plan;
}

SectionPlan tablesOf(const fs::path& path, const Found& found)
{
  SectionPlan section;
  section.title = "Tables";
  for (const std::string& file : found.tables)
  {
    if (!isOfRun(file))
      continue;
    TablePlan table{ file, literal(file), {}, shownRows };
    try
    {
      if (file == "settings.csv")
        table = meansOf(requireWithin(path, path / file));
    }
    catch (const Error&) // NOLINT(bugprone-empty-catch): the page says what is wrong with the table
    {
    }
    const auto place = file == "settings.csv" ? section.tables.begin() : section.tables.end();
    section.tables.insert(place, std::move(table));
  }
  return section;
}

/// What the run itself says of its scene, beside its tables: "title", or "file".
std::string sceneText(const Found& found, const char* key)
{
  const auto beside = std::ranges::find(found.besides, "table.csv.json", &JsonFile::name);
  const cli::Json* at = beside == found.besides.end() ? nullptr : &beside->json;
  for (const char* const inner : { "provenance", "parameters", "scene", key })
    at = at != nullptr && at->is_object() && at->contains(inner) ? &(*at)[inner] : nullptr;
  return at != nullptr && at->is_string() ? at->get<std::string>() : "";
}

/// "0.3, 0.4, 0.5", or "1 to 100 (100 values)"
std::string valuesText(const SweptKey& key)
{
  const std::string unit = key.unit.empty() ? "" : " " + key.unit;
  const std::size_t count = key.values.size();
  const std::string more = count <= shownValues ? "" : fmt::format(" ({} values)", count);
  if (key.numbers && count > shownValues)
    return fmt::format("{} to {}{}", key.values.front(), key.values.back(), unit + more);
  std::string text;
  for (std::size_t i = 0; i < std::min(count, shownValues); ++i)
    text += (i > 0 ? ", " : "") + (key.numbers ? key.values[i] : literal(key.values[i]));
  return text + unit + (more.empty() ? "" : ", …" + more);
}

std::string sweptText(const Samples& samples)
{
  const std::size_t rows = samples.table().rows();
  std::size_t failed = 0;
  for (std::size_t row = 0; row < rows; ++row)
    failed += samples.failed(row) ? 1 : 0;
  std::string text = fmt::format(
    "{} {}{}.", rows, rows == 1 ? "sample" : "samples", failed > 0 ? fmt::format(", of which {} failed", failed) : "");
  text += samples.keys().empty() ? "\n\n" : " Swept:\n\n";
  for (const SweptKey& key : samples.keys())
    text += "- " + literal(key.path) + ": " + valuesText(key) + (key.averaged ? ", averaged over" : "") + "\n";
  return text + "\n";
}

} // namespace

Plan planOfSweep(const fs::path& path, const Found& found)
{
  std::optional<Samples> samples;
  try
  {
    samples.emplace(path);
  }
  catch (
    const Error&) // NOLINT(bugprone-empty-catch): no table yet, or one of another kind; what is wrong, the page says
  {
  }
  Found rest = found;
  rest.pictures.clear();
  if (samples)
    rest.notes.clear(); // how many are finished
  std::erase_if(rest.tables, [](const std::string& file) { return isOfRun(file) || file.starts_with("samples/"); });
  Plan plan = planOf(path, rest);
  plan.scene = true;
  plan.mostBytes = largestSweepPage;
  const std::string title = sceneText(found, "title");
  const std::string file = fs::path(sceneText(found, "file")).stem().string();
  plan.title = !title.empty() ? title : !file.empty() ? file : plan.title;
  std::vector<SectionPlan> sections;
  if (samples)
  {
    plan.text = sweptText(*samples) + plan.text;
    sections.push_back(chartsOf(*samples));
    sections.push_back(sampleCurvesOf(path, found, *samples));
    for (std::size_t row = 0; row < samples->table().rows(); ++row)
      if (const std::string name = samples->caption(row); samples->failed(row) && !name.empty())
        plan.names[samples->folderOf(row) + "/failure.json"] = name;
  }
  try
  {
    const DataTable times(requireWithin(path, path / "times.csv"));
    std::vector<double> seconds = times.numbers(times.column("seconds"));
    std::erase_if(seconds, [](double one) { return !std::isfinite(one); });
    const double all = std::accumulate(seconds.begin(), seconds.end(), 0.0);
    plan.times.push_back({ fmt::format("{} samples, one after the other", seconds.size()), all, std::nullopt, "" });
  }
  catch (const Error&) // NOLINT(bugprone-empty-catch): the page goes without
  {
  }
  sections.push_back(picturesOf(found, samples));
  sections.push_back(tablesOf(path, found));
  std::erase_if(sections,
    [](const SectionPlan& section)
    {
      return section.sections.empty() && section.charts.empty() && section.grids.empty() && section.tables.empty() &&
        section.text.empty();
    });
  plan.sections.insert(plan.sections.begin(), sections.begin(), sections.end());
  return plan;
}

} // namespace lamella::reports
