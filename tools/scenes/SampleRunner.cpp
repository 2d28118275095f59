#include "scenes/SampleRunner.h"

#include "scenes/Memory.h"
#include "scenes/Movie.h"
#include "scenes/StageCheckpoint.h"

#include "files/Collection.h"
#include "files/GridFile.h"
#include "files/JsonReport.h"
#include "files/Record.h"
#include "files/ResultFiles.h"
#include "program/CommandLine.h"
#include "session/OutputFile.h"
#include "session/Text.h"

#include "core/Clock.h"
#include "core/Error.h"
#include "core/Passes.h"
#include "io/Provenance.h"
#include "vtkLatticeConversion.h"

#include <vtkCellArray.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkInformation.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkTable.h>

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

namespace lamella::cli
{

namespace
{

namespace fs = std::filesystem;

/// Numbers of a state that tell where in the run it is.
Json placeOf(vtkDataObject* state, int number)
{
  Json step{ { "step", number } };
  for (const char* const name :
    { "time", "strain", "stress", "broken_bonds", "relaxation_steps", "packing_fraction", "unbalanced_force" })
    if (const std::vector<double> found = fieldNumbers(state, name);
        found.size() == 1) // of grains the stress is a tensor
      step[name] = jsonNumber(found.front());
  return step;
}

/// Whether a step comes after another one.
bool follows(const Json& place, const Json& before)
{
  for (const char* const name : { "time", "strain", "broken_bonds" })
    if (place.contains(name) && before.contains(name) && place[name] != before[name])
      return place[name] > before[name];
  return false;
}

/// Whether a stage may go on from a checkpoint: what is wanted of it at its end must not be states before that, which
/// would be missing then.
bool canGoOn(const PlannedStage& planned)
{
  const bool states = planned.stage->command == "transient" ||
    std::ranges::any_of(
      planned.words, [](const std::string& word) { return word.starts_with("--at-") || word.starts_with("--frames"); });
  return planned.stage->ports->steps && planned.stage->ports->solver && (planned.lastStateOnly || !states) &&
    std::ranges::find(planned.words, "--stiffness-only") == planned.words.end();
}

/// Of a command's report what stays in the record: where it comes from stands there once.
Json kept(Json report)
{
  for (const char* const key : { "provenance", "version", "commit", "file", "written", "files" })
    report.erase(key);
  return report;
}

void addTo(std::vector<std::string>& list, const std::vector<std::string>& more)
{
  for (const std::string& text : more)
    if (std::ranges::find(list, text) == list.end())
      list.push_back(text);
}

} // namespace

/// What runs on the steps of a stage.
class SampleRunner::Steps
{
public:
  /// @param kept where they are told while the stage runs, or null
  Steps(SampleRunner& runner, const PlannedStage& planned, fs::path folder, std::vector<std::string>& warnings,
    StageCheckpoint* kept)
    : runner_(runner)
    , planned_(planned)
    , folder_(std::move(folder))
    , warnings_(warnings)
    , kept_(kept)
    , rows_(planned.each.size(), Json::array())
    , pictures_(planned.each.size())
  {
    if (kept_ != nullptr)
    {
      before_ = kept_->there() ? kept_->steps() : std::vector<Json>();
      goesOn_ = kept_->there();
      if (!goesOn_)
        kept_->begin({});
    }
  }

  /// A state that the run has come to.
  void take(vtkDataObject* state)
  try
  {
    if (std::exchange(goesOn_, false))
      takeBack(placeOf(state, 0));
    const Json place = placeOf(state, number_);
    Json line{ { "number", number_ }, { "place", place }, { "rows", Json::object() }, { "pictures", Json::object() } };
    std::vector<std::string> told;
    for (std::size_t i = 0; i < planned_.each.size(); ++i)
    {
      const PlannedEach& each = planned_.each[i];
      if (number_ % each.each->every != 0)
        continue;
      if (each.broken)
        rows_[i].push_back(place); // done at the end, when it is known which bonds these are
      else
        run(i, state, place, told);
      line["rows"][std::to_string(i)] = rows_[i].back();
      if (each.each->command == "snapshot")
        line["pictures"][std::to_string(i)] = pictures_[i].back().filename().string();
    }
    addTo(warnings_, told);
    line["warnings"] = told;
    if (kept_ != nullptr)
      kept_->add(line);
    ++number_;
  }
  catch (...)
  {
    if (kept_ != nullptr)
      kept_->hold();
    throw;
  }

  /// After the run: what takes broken bonds.
  void finish()
  {
    for (std::size_t i = 0; i < planned_.each.size(); ++i)
    {
      if (planned_.each[i].broken)
      {
        const auto all = runner_.workspace_.get(planned_.outputs.at("broken"));
        for (const Json& place : std::exchange(rows_[i], Json::array()))
          run(i, firstBonds(all, place.at("broken_bonds").get<std::int64_t>()), place, warnings_);
      }
      if (const std::string& movie = planned_.each[i].each->movie; !movie.empty())
        writeMovie(pictures_[i], folder_ / movie);
    }
  }

  [[nodiscard]] Json record() const
  {
    Json all = Json::object();
    for (std::size_t i = 0; i < planned_.each.size(); ++i)
      all[planned_.each[i].each->name] = rows_[i];
    return all;
  }

private:
  /// Of a run that goes on from a checkpoint: what ran on the steps before it. Those after it come again.
  /// @param place of the first that comes @throws InputError where they do not fit together
  void takeBack(Json place)
  {
    std::vector<Json> taken;
    place.erase("step");
    for (const Json& line : before_)
    {
      Json known = line.at("place");
      known.erase("step");
      if (known == place)
        break;
      bool fits = follows(place, known);
      for (const auto& [each, row] : line.at("rows").items())
        rows_.at(std::stoul(each)).push_back(row);
      for (const auto& [each, name] : line.at("pictures").items())
      {
        pictures_.at(std::stoul(each)).push_back(folder_ / name.get<std::string>());
        fits = fits && fs::exists(pictures_.at(std::stoul(each)).back());
      }
      if (!fits)
        throw InputError("the steps of '" + kept_->file().string() + "' are not those of its run", "begin anew");
      addTo(warnings_, line.at("warnings").get<std::vector<std::string>>());
      taken.push_back(line);
    }
    number_ = static_cast<int>(taken.size());
    kept_->begin(taken);
  }

  void run(std::size_t i, vtkDataObject* data, const Json& place, std::vector<std::string>& warnings)
  {
    const PlannedEach& each = planned_.each[i];
    const std::string input = Workspace::nameOf(
      "step of " + planned_.stage->name, vtkPolyData::SafeDownCast(data) != nullptr ? ".vtp" : ".vti");
    Workspace& workspace = runner_.workspace_;
    workspace.put(input, data);
    std::vector<std::string> words = split(each.each->words, ' ');
    words.push_back(input);
    words.insert(words.end(), each.options.begin(), each.options.end());
    if (each.each->command == "snapshot")
    {
      fs::create_directories(folder_);
      const fs::path picture = folder_ / fmt::format("{}_{:04}.png", each.each->name, place.at("step").get<int>());
      words.insert(words.end(), { "--output=" + picture.string(), "--overwrite" });
      pictures_[i].push_back(picture);
    }
    const auto listening = std::exchange(runner_.onStep_, nullptr);
    const auto restore = [&]
    {
      runner_.onStep_ = listening;
      workspace.erase(input);
    };
    try
    {
      Json row = place;
      row["report"] = kept(runner_.runCommand(words, warnings));
      rows_[i].push_back(std::move(row));
    }
    catch (const ParameterError& error)
    {
      restore();
      throwAt(error, *each.each);
    }
    catch (const InputError& error)
    {
      restore();
      throwAt(error, *each.each);
    }
    restore();
  }

  SampleRunner& runner_;
  const PlannedStage& planned_;
  fs::path folder_;
  std::vector<std::string>& warnings_;
  StageCheckpoint* kept_;
  std::vector<Json> before_; ///< what was told by the part of the run that came to an early end
  bool goesOn_ = false;      ///< from a checkpoint, and no step has come yet
  std::vector<Json> rows_;
  std::vector<std::vector<fs::path>> pictures_;
  int number_ = 0;
};

SampleRunner::SampleRunner(const Scene& scene, const std::string& commandLine, Progress progress)
  : scene_(scene)
  , commandLine_(commandLine)
  , progress_(std::move(progress))
{
  wishes_.record = Json{ { "file", scene.source.file }, { "text", scene.source.text } }.dump(
    -1, ' ', false, Json::error_handler_t::replace);
}

bool SampleRunner::tell(double share, const std::string& what) const
{
  return progress_(before_ + part_ * std::clamp(share, 0.0, 1.0), what);
}

Json SampleRunner::run(const SamplePlan& plan, const fs::path& folder)
{
  const auto start = Clock::now();
  const auto passes = passCounts();
  resetPeakMemory();
  Json record;
  record["settings"] = plan.settings;
  record["stages"] = Json::object();
  record["steps"] = Json::object();
  record["reused"] = Json::array();
  std::vector<std::string> warnings;
  Json seconds = Json::object();
  std::vector<std::string> keys;
  for (std::size_t i = 0; i < plan.stages.size(); ++i)
  {
    const PlannedStage& planned = plan.stages[i];
    const std::string& name = planned.stage->name;
    const auto begin = Clock::now();
    before_ = static_cast<double>(i) / static_cast<double>(plan.stages.size());
    part_ = 1.0 / static_cast<double>(plan.stages.size());
    std::string key = io::quoteCommand(planned.words);
    for (const std::size_t input : planned.inputs)
      key += "\n" + keys[input];
    keys.push_back(key);
    const auto before = done_.find(name);
    const bool files = planned.stage->command == "snapshot" || !planned.each.empty();
    if (before != done_.end() && before->second.key == key && !files)
    {
      record["reused"].push_back(name);
    }
    else
    {
      done_.erase(name); // should it fail, what it leaves is nobody's
      const bool takesLong = scene_.checkpoint && !folder.empty() && canGoOn(planned);
      Done result =
        takesLong ? performLong(planned, folder, record["steps"]) : perform(planned, folder, nullptr, record["steps"]);
      result.key = key;
      done_[name] = std::move(result);
    }
    write(planned, folder);
    record["stages"][name] = done_[name].report;
    addTo(warnings, done_[name].warnings);
    seconds[name] = secondsSince(begin);
    Session::checkInterrupt();
  }
  record["calls"] = Json::object();
  for (const auto& [what, count] : passesSince(passes))
    record["calls"][what] = count;
  record["skipped"] = plan.skipped;
  record["warnings"] = warnings;
  record["seconds"] = secondsSince(start);
  record["stage_seconds"] = std::move(seconds);
  record["peak_memory"] = peakMemory();
  return record;
}

void SampleRunner::rehearse(const PlannedStage& planned)
{
  std::vector<std::string> ignored;
  before_ = 0;
  part_ = 1;
  static_cast<void>(runStage(planned, nullptr, ignored));
}

SampleRunner::Done SampleRunner::perform(
  const PlannedStage& planned, const fs::path& folder, StageCheckpoint* kept, Json& steps)
{
  Done result;
  std::optional<Steps> watching;
  if (!planned.each.empty())
    watching.emplace(*this, planned, folder, result.warnings, kept);
  PlannedStage running = planned;
  if (planned.stage->command == "snapshot")
  {
    fs::create_directories(folder);
    running.words.push_back("--output=" + (folder / (planned.stage->name + ".png")).string());
    running.words.emplace_back("--overwrite");
  }
  if (kept != nullptr)
  {
    running.words.push_back("--checkpoint=" + kept->file().string());
    if (kept->there())
      running.words.push_back("--continue=" + kept->file().string());
  }
  try
  {
    result.report = runStage(running, watching ? &*watching : nullptr, result.warnings);
  }
  catch (...)
  {
    if (kept != nullptr)
      kept->release();
    throw;
  }
  if (kept != nullptr) // the steps before it are there
  {
    std::erase_if(
      result.warnings,
      [](const std::string& warning) { return warning.find("lie before the checkpoint") != std::string::npos; });
  }
  if (watching)
  {
    watching->finish();
    steps.update(watching->record());
  }
  return result;
}

SampleRunner::Done SampleRunner::performLong(const PlannedStage& planned, const fs::path& folder, Json& steps)
{
  StageCheckpoint kept(folder, planned.stage->name);
  wishes_.checkpointSeconds = *scene_.checkpoint;
  if (kept.there())
  {
    try
    {
      return perform(planned, folder, &kept, steps);
    }
    catch (const InputError&) // of another build, damaged: it cannot be used, and if it is not that, it comes again
    {
      kept.remove();
    }
  }
  return perform(planned, folder, &kept, steps);
}

Json SampleRunner::runStage(const PlannedStage& planned, Steps* steps, std::vector<std::string>& warnings)
{
  for (const auto& [option, name] : planned.outputs)
  {
    const fs::path path(name); // states and directions of a run before
    for (const std::string& old : workspace_.names())
      if (old == name || (old.starts_with(path.stem().string() + "_") && old.ends_with(path.extension().string())))
        workspace_.erase(old);
  }
  wishes_.lastStateOnly = planned.lastStateOnly;
  wishes_.arrays = planned.arrays;
  onStep_ = nullptr;
  if (steps != nullptr)
    onStep_ = [steps](vtkDataObject* state) { steps->take(state); };
  std::vector<std::string> words;
  for (const std::string& word : planned.words)
  {
    const fs::path path(word);
    const bool states =
      planned.stage->command == "collapse-map" && word.starts_with("memory:") && path.extension() == ".vtp";
    std::size_t found = 0;
    for (const std::string& name : states ? workspace_.names() : std::vector<std::string>{})
    {
      if (name.starts_with(path.stem().string() + "_") && name.ends_with(".vtp"))
      {
        words.push_back(name);
        ++found;
      }
    }
    if (found == 0)
      words.push_back(word);
  }
  try
  {
    Json report = kept(runCommand(words, warnings));
    onStep_ = nullptr;
    return report;
  }
  catch (const ParameterError& error)
  {
    throwAt(error, *planned.stage);
  }
  catch (const InputError& error)
  {
    throwAt(error, *planned.stage);
  }
  catch (const NoPathError& error)
  {
    throwAt(error, *planned.stage);
  }
  catch (const DivergenceError& error)
  {
    throwAt(error, *planned.stage);
  }
}

Json SampleRunner::runCommand(const std::vector<std::string>& words, std::vector<std::string>& warnings)
{
  CommandSet commands;
  std::vector<std::string> all = words;
  all.emplace_back("--json");
  static_cast<void>(parseWords(commands.root(), all));
  Session session([this](double share, const std::string& what) { return tell(share, what); });
  session.setScene(wishes_);
  session.setOnStep(onStep_);
  for (const Command& command : commands.commands())
    if (command.app->parsed())
      command.run(session, commandLine_);
  addTo(warnings, session.warnings());
  return Json::parse(session.printed());
}

void SampleRunner::write(const PlannedStage& planned, const fs::path& folder)
{
  const SceneStage& stage = *planned.stage;
  if (stage.write.empty() || stage.command == "snapshot" || folder.empty())
    return;
  fs::create_directories(folder);
  ResultFiles files;
  std::vector<vtkSmartPointer<vtkDataObject>> held;
  std::vector<std::string> states;
  std::vector<double> times;
  const auto add = [&](const std::string& name)
  {
    const std::string file = (folder / name.substr(std::string("memory:").size())).string();
    auto data = workspace_.get(name);
    if (auto* const table = vtkTable::SafeDownCast(data))
      files.addTable("write", file, table, true);
    else
      files.addGrid("write", file, fs::path(name).extension().string(), data, true);
    held.push_back(std::move(data));
  };
  for (const std::string& option : stage.write)
  {
    const fs::path name(planned.outputs.at(option));
    const std::vector<std::string> all = workspace_.names();
    for (const std::string& other : all)
    {
      const std::string stem = name.stem().string() + "_";
      if (option == "output" && other.starts_with(stem) && other.ends_with(name.extension().string()) &&
        std::ranges::none_of(planned.outputs, [&](const auto& o) { return o.second == other; }))
      {
        add(other);
        if (held.back()->GetInformation()->Has(vtkDataObject::DATA_TIME_STEP()) != 0)
        {
          states.push_back(fs::path(other.substr(std::string("memory:").size())).string());
          times.push_back(held.back()->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP()));
        }
      }
    }
    if (workspace_.has(name) && (option != "output" || states.empty()))
      add(name.string());
  }
  std::string before;
  if (!held.empty())
    before = provenance(held.front());
  static_cast<void>(files.write(io::toJson(recordRun(&wishes_, commandLine_, "", before))));
  if (!states.empty())
  {
    OutputFile collection(folder / (stage.name + ".pvd"), true);
    collection.write(collectionText(states, times));
    collection.commit();
  }
}

vtkSmartPointer<vtkDataObject> firstBonds(vtkDataObject* broken, std::int64_t count)
{
  auto* const all = vtkPolyData::SafeDownCast(broken);
  auto part = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetDataType(all->GetPoints() != nullptr ? all->GetPoints()->GetDataType() : VTK_DOUBLE);
  const vtkIdType some = std::min<vtkIdType>(count, all->GetNumberOfPoints());
  points->SetNumberOfPoints(some);
  vtkNew<vtkCellArray> vertices;
  for (vtkIdType i = 0; i < some; ++i)
  {
    points->SetPoint(i, all->GetPoint(i));
    vertices->InsertNextCell(1, &i);
  }
  part->SetPoints(points);
  part->SetVerts(vertices);
  part->GetPointData()->CopyAllocate(all->GetPointData(), some);
  part->GetPointData()->CopyData(all->GetPointData(), 0, some, 0);
  part->GetFieldData()->ShallowCopy(all->GetFieldData());
  return part;
}

} // namespace lamella::cli
