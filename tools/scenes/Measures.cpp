#include "scenes/Measures.h"

#include "scenes/Contents.h"

#include "files/JsonReport.h"
#include "session/Text.h"

#include "statistics/WindowError.h"
#include "vtkLatticeConversion.h"

#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkStringArray.h>
#include <vtkTable.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace lamella::cli
{

namespace
{

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// Columns that grow row by row; a value that is not there is unknown. Numbers, unless a text comes.
class Columns
{
public:
  void declare(const std::string& name)
  {
    if (!index_.contains(name))
    {
      index_[name] = names_.size();
      names_.push_back(name);
      values_.emplace_back(rows_);
    }
  }
  /// Unit and meaning of its numbers.
  void describe(const std::string& name, const std::string& unit, const std::string& meaning)
  {
    declare(name);
    about_[name] = { unit, meaning };
  }
  [[nodiscard]] bool described(const std::string& name) const { return about_.contains(name); }
  void newRow()
  {
    ++rows_;
    for (auto& column : values_)
      column.emplace_back();
  }
  void set(const std::string& name, const Json& value)
  {
    declare(name);
    values_[index_[name]].back() = value;
  }
  [[nodiscard]] vtkSmartPointer<vtkTable> table(const std::string& creator) const
  {
    auto table = vtkSmartPointer<vtkTable>::New();
    for (std::size_t c = 0; c < names_.size(); ++c)
    {
      const auto& column = values_[c];
      if (std::ranges::any_of(column, [](const Json& value) { return value.is_string(); }))
      {
        vtkNew<vtkStringArray> texts;
        texts->SetName(names_[c].c_str());
        for (const Json& value : column)
          texts->InsertNextValue(value.is_null() ? "" : wordOf(value));
        table->AddColumn(texts);
        continue;
      }
      vtkNew<vtkDoubleArray> numbers;
      numbers->SetName(names_[c].c_str());
      for (const Json& value : column)
      {
        numbers->InsertNextValue(value.is_boolean() ? (value.get<bool>() ? 1 : 0)
            : value.is_number()                     ? value.get<double>()
                                                    : unknown);
      }
      const auto about = about_.find(names_[c]);
      const auto [unit, meaning] = about == about_.end() ? std::pair(std::string(), names_[c]) : about->second;
      lamella::describe(numbers, unit, meaning, creator);
      table->AddColumn(numbers);
    }
    return table;
  }

private:
  std::vector<std::string> names_;
  std::vector<std::vector<Json>> values_;
  std::map<std::string, std::size_t> index_;
  std::map<std::string, std::pair<std::string, std::string>> about_;
  std::size_t rows_ = 0;
};

/// The key of a list's items by which they are called.
std::string calledBy(const Json& item)
{
  for (const char* const key : { "name", "phase", "axis", "direction" })
    if (item.is_object() && item.contains(key) && item[key].is_string())
      return item[key].get<std::string>();
  return "";
}

/// Numbers that say what a run cost, not what it found.
bool isCost(const std::string& key)
{
  static const std::set<std::string> costs{ "bytes", "threads", "ranks", "peak_memory", "memory", "statistics",
    "updates_per_second", "bytes_per_point", "checkpoints", "last_checkpoint", "continued_at", "states_before" };
  return costs.contains(key) || key.find("seconds") != std::string::npos || key.find("memory") != std::string::npos ||
    key.find("bytes") != std::string::npos;
}

/// All numbers of a report, by their paths.
void flatten(const Json& value, const std::string& path, const auto& take)
{
  if (value.is_number() || value.is_boolean())
  {
    take(path, value);
  }
  else if (value.is_object())
  {
    for (const auto& [key, item] : value.items())
      if (!isCost(key))
        flatten(item, path.empty() ? key : path + "." + key, take);
  }
  else if (value.is_array())
  {
    for (const Json& item : value)
      if (const std::string name = calledBy(item); !name.empty())
        flatten(item, path + "." + name, take);
  }
}

/// One element of a path. Null where it leads nowhere.
const Json* child(const Json& at, const std::string& element)
{
  if (at.is_object())
  {
    const auto found = at.find(element);
    return found == at.end() ? nullptr : &*found;
  }
  if (at.is_array())
  {
    if (const auto number = toInteger(element))
    {
      return *number >= 0 && static_cast<std::size_t>(*number) < at.size() ? &at[static_cast<std::size_t>(*number)]
                                                                           : nullptr;
    }
    const auto found = std::ranges::find_if(at, [&](const Json& item) { return calledBy(item) == element; });
    return found == at.end() ? nullptr : &*found;
  }
  return nullptr;
}

/// A stage's name may hold a dot.
std::pair<const Json*, std::string> stageOf(const Json& stages, const std::string& path)
{
  std::pair<const Json*, std::string> found{ nullptr, "" };
  std::size_t longest = 0;
  for (const auto& [name, report] : stages.items())
  {
    if (path.starts_with(name + ".") && name.size() >= longest)
    {
      found = { &report, path.substr(name.size() + 1) };
      longest = name.size();
    }
  }
  return found;
}

/// Names may hold dots too: "1.5" of a list of thresholds. The longest that fits is taken.
const Json* walk(const Json& at, const std::string& path)
{
  for (std::size_t end = path.size(); end != std::string::npos && end > 0; end = path.rfind('.', end - 1))
  {
    if (const Json* const below = child(at, path.substr(0, end)))
    {
      if (end == path.size())
        return below;
      if (const Json* const found = walk(*below, path.substr(end + 1)))
        return found;
    }
  }
  return nullptr;
}

std::vector<std::string> keysAt(const Json& at)
{
  std::vector<std::string> keys;
  if (at.is_object())
    for (const auto& [key, value] : at.items())
      keys.push_back(key);
  else if (at.is_array())
    for (const Json& item : at)
      keys.push_back(calledBy(item));
  return keys;
}

[[noreturn]] void noSuchKey(const SceneMeasure& measure, const std::string& stage, const std::string& rest,
  const std::string& element, const std::vector<std::string>& keys)
{
  sceneError(measure.where, fmt::format("{} = \"{}\": {} reports no '{}'", measure.name, measure.path, stage, rest),
    suggestion(element, keys, keys.empty() ? "it is a number already" : "there are " + quotedList(keys, "and")));
}

/// The stage that a measure is of: the longest name that fits, as in stageOf(). Null where there is none.
const SceneStage* stageOf(const Scene& scene, const std::string& path)
{
  const SceneStage* stage = nullptr;
  for (const SceneStage& one : scene.stages)
    if (path.starts_with(one.name + ".") && (stage == nullptr || one.name.size() >= stage->name.size()))
      stage = &one;
  return stage;
}

std::string measureUnit(const Scene& scene, const std::string& path)
{
  const SceneStage* const stage = stageOf(scene, path);
  return stage == nullptr ? "" : reportUnit(stage->command, path.substr(stage->name.size() + 1));
}

/// Whether a path leads along these keys; one that stands for any name may hold dots: "y@0.12".
bool leads(const std::vector<ReportKeys>& keys, const std::string& path)
{
  for (std::size_t end = path.find('.');; end = path.find('.', end + 1))
  {
    const bool last = end == std::string::npos;
    const ReportKeys* const key = keyOf(keys, path.substr(0, end));
    if (key != nullptr &&
      (key->below.empty() || (last ? path.find('.') == end : leads(key->below, path.substr(end + 1)))))
      return true;
    if (last)
      return false;
  }
}

/// Whether a path is one of these keys. @throws ParameterError
void checkAhead(const SceneMeasure& measure, const SceneStage& stage, const std::vector<ReportKeys>& keys)
{
  const std::string rest = measure.path.substr(stage.name.size() + 1);
  if (leads(keys, rest))
    return;
  const std::vector<ReportKeys>* level = &keys;
  for (const std::string& element : split(rest, '.'))
  {
    std::vector<std::string> names;
    for (const ReportKeys& key : *level)
      names.push_back(key.name);
    const ReportKeys* const found = keyOf(*level, element);
    if (found == nullptr)
      noSuchKey(measure, stage.name, rest, element, names);
    if (found->below.empty())
      return;
    level = &found->below;
  }
}

void addSettings(Columns& columns, const Sweep& sweep, const Json& settings)
{
  for (const SweepAxis& axis : sweep.axes())
  {
    columns.describe(axis.path, axis.unit, axis.path);
    const Json& value = settings.at(axis.path);
    columns.set(axis.path, value.is_array() || value.is_object() ? Json(value.dump()) : value);
  }
}

} // namespace

std::optional<Json> findMeasure(const Json& stages, const std::string& path)
{
  const auto [report, rest] = stageOf(stages, path);
  const Json* const found = report == nullptr ? nullptr : walk(*report, rest);
  return found == nullptr ? std::nullopt : std::optional(*found);
}

void checkMeasuresAhead(const Scene& scene)
{
  for (const SceneMeasure& measure : scene.measures)
  {
    const SceneStage* const stage = stageOf(scene, measure.path);
    const auto keys = stage == nullptr ? std::nullopt : reportKeys(stage->command);
    if (keys)
      checkAhead(measure, *stage, *keys);
  }
}

void checkMeasures(const Scene& scene, const Json& stages)
{
  for (const SceneMeasure& measure : scene.measures)
  {
    const auto [report, rest] = stageOf(stages, measure.path);
    if (report == nullptr)
      continue;
    const Json* const found = walk(*report, rest);
    const Json* at = found == nullptr ? report : found;
    for (const std::string& element : found == nullptr ? split(rest, '.') : std::vector<std::string>{})
    {
      const Json* const next = child(*at, element);
      if (next == nullptr && !at->is_null())
      {
        const std::vector<std::string> keys = keysAt(*at);
        noSuchKey(measure, measure.path.substr(0, measure.path.size() - rest.size() - 1), rest, element, keys);
      }
      if (next == nullptr)
        break;
      at = next;
    }
    if (at->is_object() || at->is_array())
    {
      const std::vector<std::string> keys = keysAt(*at);
      sceneError(measure.where, fmt::format("{} = \"{}\" is not one number", measure.name, measure.path),
        "go on to one of " + quotedList(keys));
    }
  }
}

vtkSmartPointer<vtkTable> sampleTable(const Scene& scene, const Sweep& sweep, const std::vector<SampleResult>& samples)
{
  Columns columns;
  columns.declare("sample");
  for (const SampleResult& sample : samples)
  {
    columns.newRow();
    columns.set("sample", sample.plan.key);
    addSettings(columns, sweep, sample.plan.settings);
    columns.set("status", sample.record ? "done" : "failed");
    for (const SceneMeasure& measure : scene.measures)
    {
      if (!columns.described(measure.name))
        columns.describe(measure.name, measureUnit(scene, measure.path), measure.path);
      if (sample.record)
      {
        if (const auto value = findMeasure(sample.record->at("stages"), measure.path))
          columns.set(measure.name, *value);
      }
    }
    if (scene.measures.empty() && sample.record)
      for (const auto& [stage, report] : sample.record->at("stages").items())
      {
        flatten(
          report, stage,
          [&](const std::string& path, const Json& value)
          {
            if (!columns.described(path))
              columns.describe(path, measureUnit(scene, path), path);
            columns.set(path, value);
          });
      }
  }
  return columns.table("lamella run");
}

vtkSmartPointer<vtkTable> costTable(const std::vector<SampleResult>& samples)
{
  Columns columns;
  columns.declare("sample");
  columns.describe("seconds", "s", "wall time");
  columns.describe("peak_memory", "bytes", "largest memory of its process");
  for (const SampleResult& sample : samples)
  {
    columns.newRow();
    columns.set("sample", sample.plan.key);
    if (!sample.record)
      continue;
    for (const char* const key : { "seconds", "peak_memory", "date", "commit" })
      columns.set(key, sample.record->value(key, Json(nullptr)));
    const Json stages = sample.record->value("stage_seconds", Json::object());
    for (const auto& [stage, seconds] : stages.items())
    {
      columns.describe("seconds." + stage, "s", "wall time of " + stage);
      columns.set("seconds." + stage, seconds);
    }
  }
  return columns.table("lamella run");
}

std::vector<std::string> averagedOver(const Scene& scene, const Sweep& sweep)
{
  std::vector<std::string> keys;
  for (const SweepAxis& axis : sweep.axes())
  {
    const bool said = std::ranges::find(scene.averageOver, axis.path) != scene.averageOver.end();
    if (scene.averageGiven ? said : axis.path.ends_with(".seed"))
      keys.push_back(axis.path);
  }
  return keys;
}

vtkSmartPointer<vtkTable> settingTable(const Scene& scene, const Sweep& sweep, vtkTable* samples)
{
  const std::vector<std::string> over = averagedOver(scene, sweep);
  std::vector<std::string> settings;
  for (const SweepAxis& axis : sweep.axes())
    if (std::ranges::find(over, axis.path) == over.end())
      settings.push_back(axis.path);
  auto* const status = vtkStringArray::SafeDownCast(samples->GetColumnByName("status"));
  // rows of each setting, in the order in which settings come
  std::vector<std::vector<vtkIdType>> groups;
  std::map<std::string, std::size_t> known;
  for (vtkIdType row = 0; row < samples->GetNumberOfRows(); ++row)
  {
    std::string key;
    for (const std::string& name : settings)
      key += samples->GetValueByName(row, name.c_str()).ToString() + "\n";
    const auto [at, added] = known.try_emplace(key, groups.size());
    if (added)
      groups.emplace_back();
    groups[at->second].push_back(row);
  }
  Columns columns;
  for (const std::vector<vtkIdType>& rows : groups)
  {
    columns.newRow();
    for (const std::string& name : settings)
    {
      if (auto* const numbers = vtkDataArray::SafeDownCast(samples->GetColumnByName(name.c_str())))
        columns.describe(name, description(numbers)[0], name);
      const vtkVariant value = samples->GetValueByName(rows.front(), name.c_str());
      columns.set(name, value.IsString() ? Json(value.ToString()) : Json(value.ToDouble()));
    }
    columns.set("n",
      static_cast<double>(std::ranges::count_if(rows, [&](vtkIdType row) { return status->GetValue(row) == "done"; })));
    for (vtkIdType c = 0; c < samples->GetNumberOfColumns(); ++c)
    {
      auto* const column = vtkDoubleArray::SafeDownCast(samples->GetColumn(c));
      if (column == nullptr ||
        std::ranges::any_of(sweep.axes(), [&](const SweepAxis& axis) { return axis.path == column->GetName(); }))
        continue;
      std::vector<double> values;
      for (const vtkIdType row : rows)
        if (const double value = column->GetValue(row); std::isfinite(value))
          values.push_back(value);
      const bool spread = values.size() > 1;
      const statistics::WindowError found = spread ? statistics::sampleError(values) : statistics::WindowError{};
      const double error = spread ? found.deviation : unknown;
      const std::string name = column->GetName();
      const auto [unit, meaning, creator] = description(column);
      columns.describe(name + ".mean", unit, "mean of " + meaning);
      columns.describe(name + ".deviation", unit, "standard deviation of " + meaning);
      columns.describe(name + ".error", unit, "standard error of the mean of " + meaning);
      columns.describe(
        name + ".half_width", unit, "half of the interval that holds the mean of " + meaning + " (95 %)");
      columns.set(name + ".mean", spread ? Json(found.value) : values.empty() ? Json(nullptr) : Json(values.front()));
      columns.set(name + ".deviation", jsonNumber(error * std::sqrt(static_cast<double>(values.size()))));
      columns.set(name + ".error", jsonNumber(error));
      columns.set(name + ".half_width", jsonNumber(spread ? (found.high - found.low) / 2 : unknown));
    }
  }
  return columns.table("lamella run");
}

vtkSmartPointer<vtkTable> stepTable(const Sweep& sweep, const std::vector<SampleResult>& samples, const SceneEach& each)
{
  Columns columns;
  for (const SampleResult& sample : samples)
  {
    if (!sample.record || !sample.record->at("steps").contains(each.name))
      continue;
    for (const Json& step : sample.record->at("steps").at(each.name))
    {
      columns.newRow();
      columns.set("sample", sample.plan.key);
      addSettings(columns, sweep, sample.plan.settings);
      for (const auto& [key, value] : step.items())
      {
        if (key == "report")
          continue;
        columns.describe(key, key == "time" ? "s" : key == "stress" ? "Pa" : "", key);
        columns.set(key, value);
      }
      flatten(step.at("report"), "",
        [&](const std::string& path, const Json& value)
        {
          if (!columns.described(path))
            columns.describe(path, reportUnit(each.command, path), path);
          columns.set(path, value);
        });
    }
  }
  return columns.table("lamella run");
}

} // namespace lamella::cli
