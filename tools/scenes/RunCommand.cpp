#include "scenes/Estimate.h"
#include "scenes/Measures.h"
#include "scenes/Rehearsal.h"
#include "scenes/ResultTables.h"
#include "scenes/Results.h"
#include "scenes/SampleRunner.h"
#include "scenes/Sharing.h"
#include "scenes/StageCheckpoint.h"

#include "commands/WindowReport.h"
#include "files/JsonReport.h"
#include "files/Record.h"
#include "files/ResultFiles.h"
#include "program/CommandLine.h"
#include "session/OutputFile.h"
#include "session/Stopped.h"
#include "session/Text.h"

#include "core/Error.h"
#include "core/Memory.h"
#include "io/Provenance.h"
#include "lamella/Version.h"

#include <vtkDoubleArray.h>
#include <vtkStringArray.h>
#include <vtkTable.h>

#include <fmt/format.h>

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <set>

namespace lamella::cli
{

namespace
{

namespace fs = std::filesystem;

struct RunOptions
{
  CommonOptions common;
  std::string file;
  std::string results;
  int jobs = 1;
  std::vector<std::string> set;
  bool dryRun = false;
  bool yes = false;
  bool statistics = false;
  const CLI::App* app = nullptr; ///< knows the words that are keys of the scene
};

constexpr double many = 1e4;
constexpr double tooMany = 1e6;

/// "--fracture.horizon 4" and "--fracture.horizon=4": what is no option of run. @throws ParameterError
void setFromWords(SceneFile& scene, const RunOptions& o)
{
  const std::vector<std::string> words = o.app->remaining();
  for (std::size_t i = 0; i < words.size(); ++i)
  {
    const std::string& word = words[i];
    const std::size_t equals = word.find('=');
    const std::string name = word.substr(0, equals);
    if (!name.starts_with("--"))
      throw ParameterError("'" + word + "' is one word too many for lamella run", "see lamella run --help");
    if (name.find('.') == std::string::npos)
    {
      throw ParameterError("'" + name + "' is not an option of lamella run",
        suggestion(name, optionNames(o.app), "a key of the scene is written with its section: --fracture.horizon 4"));
    }
    if (equals == std::string::npos && i + 1 == words.size())
      throw ParameterError(name + " has no value", "write " + name + "=VALUE");
    setKey(scene, name.substr(2), equals == std::string::npos ? words[++i] : word.substr(equals + 1));
  }
  for (const std::string& text : o.set)
  {
    const auto [key, value] = keyValue("--set", text, "KEY=VALUE");
    setKey(scene, key, value);
  }
}

/// A line that somebody types; empty at the end of the input. @throws Cancelled after Ctrl-C, which ends no read
std::string typedLine()
{
  pollfd input{ STDIN_FILENO, POLLIN, 0 };
  constexpr int patience = 100; // [ms]: a signal may come between a look and the wait
  for (int ready = 0; ready == 0 || (ready < 0 && errno == EINTR); ready = ::poll(&input, 1, patience))
    Session::checkInterrupt();
  std::string line;
  if (!std::getline(std::cin, line))
    std::cerr << "\n";
  return line;
}

/// Asks, where somebody sits there. @throws ParameterError where not, or for no
void confirm(Session& session, double count)
{
  const std::string what = fmt::format("this sweep has {} samples",
    count < 1e15 ? grouped(static_cast<std::int64_t>(count)) : fmt::format("{:.3g}", count));
  if (count > tooMany)
    throw ParameterError(what + fmt::format(", more than {:.0e}", tooMany), "give fewer values, or several scenes");
  const bool asks = session.ranks() == 1 && ::isatty(STDIN_FILENO) == 1 && ::isatty(STDERR_FILENO) == 1;
  if (asks)
  {
    std::cerr << what << ". Run them? [y/N] " << std::flush;
    const std::string answer = typedLine();
    if (answer == "y" || answer == "Y" || answer == "yes")
      return;
    throw ParameterError(what + ", and was not run", "look at it with --dry-run first");
  }
  throw ParameterError(what, "look at it with --dry-run, and add --yes to run them");
}

/// What an option cannot be is told before anything runs.
void tryWords(const SamplePlan& plan)
{
  const auto read = [](const SceneStage& stage, std::vector<std::string> words)
  {
    const CommandSet commands;
    try
    {
      static_cast<void>(parseWords(commands.root(), words));
    }
    catch (const ParameterError& error)
    {
      throwAt(error, stage);
    }
  };
  for (const PlannedStage& planned : plan.stages)
  {
    std::vector<std::string> words = planned.words;
    if (planned.stage->command == "snapshot")
      words.emplace_back("--output=picture.png");
    read(*planned.stage, words);
    for (const PlannedEach& each : planned.each)
    {
      words = split(each.each->words, ' ');
      words.emplace_back("memory:step.vti");
      words.insert(words.end(), each.options.begin(), each.options.end());
      if (each.each->command == "snapshot")
        words.emplace_back("--output=picture.png");
      read(*each.each, words);
    }
  }
}

std::string timeText(double seconds)
{
  return seconds < 100 ? fmt::format("{:.2g} s", seconds)
    : seconds < 6000   ? fmt::format("{:.0f} min", seconds / 60)
    : seconds < 3e5    ? fmt::format("{:.1f} h", seconds / 3600)
                       : fmt::format("{:.1f} days", seconds / 86400);
}

std::string settingText(const Json& settings)
{
  std::string text;
  for (const auto& [key, value] : settings.items())
    text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", key, wordOf(value));
  return text;
}

/// A run of a scene.
class Run
{
public:
  Run(Session& session, const RunOptions& options, const std::string& commandLine)
    : session_(session)
    , options_(options)
    , commandLine_(commandLine)
    , scene_(understood())
    , sweep_(scene_)
  {
  }

  void operator()()
  {
    if (options_.jobs < 1 || options_.jobs > 256)
    {
      throw ParameterError(
        fmt::format("--jobs {} is not from 1 to 256", options_.jobs), "give the number of processes");
    }
    if (options_.jobs > 1 && session_.ranks() > 1)
      throw ParameterError("--jobs within mpirun", "leave it out: each rank takes samples");
    tryWords(planOf(0));
    checkMeasuresAhead(scene_);
    if (options_.dryRun)
    {
      session_.onRoot([&] { dryRun(); });
      return;
    }
    if (sweep_.count() > many && !options_.yes)
      session_.onRoot([&] { confirm(session_, sweep_.count()); });
    session_.onRoot([&] { results_ = std::make_unique<Results>(folder(), scene_.source, true); });
    if (!session_.root())
      results_ = std::make_unique<Results>(folder(), scene_.source, false);
    planAll();
    const std::size_t before = samples_.size() - unfinished_.size();
    work();
    session_.onRoot([&] { finish(before); });
  }

private:
  Scene understood()
  {
    SceneFile file = readSceneFile(options_.file);
    setFromWords(file, options_);
    return understand(std::move(file), commands_);
  }

  [[nodiscard]] fs::path folder() const
  {
    if (!options_.results.empty())
      return options_.results;
    return scene_.results.empty() ? fs::path(scene_.source.file).stem().string() + ".results" : scene_.results;
  }

  [[nodiscard]] SamplePlan planOf(std::size_t sample) { return makePlan(scene_, sweep_, sample, commands_, files_); }

  /// All samples, and those of them that have to run: each once, also where two settings come to the same.
  void planAll()
  {
    const auto count = static_cast<std::size_t>(sweep_.count());
    std::set<std::string> known;
    for (std::size_t i = 0; i < count; ++i)
    {
      SamplePlan plan = planOf(i);
      if (known.insert(plan.key).second && !results_->load(plan.key))
        unfinished_.push_back(i);
      plan.stages.clear(); // made again for those that run
      samples_.push_back({ std::move(plan), std::nullopt });
      Session::checkInterrupt();
    }
  }

  void work()
  {
    if (unfinished_.empty())
      return;
    std::function<bool(double, const std::string&)> told; // of the sample that runs
    std::unique_ptr<SampleRunner> runner;
    Sharing sharing;
    sharing.jobs = options_.jobs;
    sharing.died = [&](std::size_t task, const std::string& how)
    {
      results_->saveFailure(samples_[unfinished_[task]].plan.key, how,
        "it may have run out of memory: lamella run --dry-run tells how much is wanted", exitMemory);
    };
    sharing.work = [&](std::size_t task, const std::function<bool(double, const std::string&)>& tell)
    {
      told = tell;
      if (!runner) // in the process that works
      {
        runner = std::make_unique<SampleRunner>(
          scene_, commandLine_, [&](double share, const std::string& what) { return told(share, what); });
      }
      runOne(*runner, unfinished_[task]);
    };
    try
    {
      shareOut(session_, sharing, unfinished_.size());
    }
    catch (const Cancelled&)
    {
      session_.endProgress();
      const auto begun = std::ranges::count_if(unfinished_,
        [&](std::size_t sample) { return StageCheckpoint::any(results_->folderOf(samples_[sample].plan.key)); });
      throw Stopped(fmt::format("finished samples are in '{}'; the same command goes on from them{}", folder().string(),
        begun > 0 ? fmt::format(", and from the {} of {} that {} not", begun > 1 ? "checkpoints" : "checkpoint", begun,
                      begun > 1 ? "are" : "is")
                  : ""));
    }
  }

  /// Runs a sample and keeps what it found, or why it did not.
  void runOne(SampleRunner& runner, std::size_t sample)
  {
    const SamplePlan plan = planOf(sample);
    Json record;
    try
    {
      record = runner.run(plan, results_->folderOf(plan.key));
    }
    catch (const Cancelled&)
    {
      throw;
    }
    catch (const OutputError&)
    {
      throw; // the disk: no other sample would fare better
    }
    catch (const Error& error)
    {
      StageCheckpoint::removeAll(results_->folderOf(plan.key));
      results_->saveFailure(plan.key, error.what(), error.hint(), exitCode(error));
      return;
    }
    catch (const std::bad_alloc&)
    {
      results_->saveFailure(
        plan.key, "there is not enough memory", "lamella run --dry-run tells how much is wanted", exitMemory);
      return;
    }
    record["key"] = plan.key;
    record["version"] = version();
    record["commit"] = commit();
    record["command"] = commandLine_;
    record["date"] = io::timestamp();
    results_->save(plan.key, record);
    StageCheckpoint::removeAll(results_->folderOf(plan.key));
    checkMeasures(scene_, record.at("stages"));
  }

  // --- what is told ---

  void dryRun()
  {
    const SamplePlan first = planOf(0);
    Rehearsal rehearsal(scene_, first);
    const Estimator estimate(scene_, rehearsal);
    const std::vector<std::string> failures = rehearsal();
    const double count = sweep_.count();
    std::string text = fmt::format("{} {}\n", count < 1e15 ? grouped(static_cast<std::int64_t>(count)) : "very many",
      count == 1 ? "sample" : "samples");
    for (const SweepAxis& axis : sweep_.axes())
    {
      text += fmt::format("  {:<28} {} values, {} to {}\n", axis.path, axis.values.size(), wordOf(axis.values.front()),
        wordOf(axis.values.back()));
    }
    // of a large sweep some settings stand for all
    const auto whole = static_cast<std::size_t>(std::min(count, 1e6));
    const std::size_t every = std::max<std::size_t>(1, whole / 1000);
    double seconds = 0;
    double bytes = 0;
    double looked = 0;
    std::size_t there = 0;
    for (std::size_t i = 0; i < whole; i += every)
    {
      const SamplePlan plan = planOf(i);
      const SampleCost cost = estimate(plan);
      const Results known(folder(), scene_.source, false);
      const bool done = known.load(plan.key).has_value();
      there += done ? 1 : 0;
      seconds += done ? 0 : cost.seconds;
      bytes = std::max(bytes, cost.bytes);
      looked += 1;
    }
    seconds *= count / looked;
    const SampleCost cost = estimate(first);
    text += fmt::format("\n  {} nodes in the first sample\n", grouped(static_cast<std::int64_t>(cost.nodes)));
    Json stages = Json::array();
    for (std::size_t i = 0; i < first.stages.size(); ++i)
    {
      const Cost& one = cost.stages[i];
      std::string steps;
      for (const PlannedEach& each : first.stages[i].each)
        steps += fmt::format("{}{}", steps.empty() ? ", on its steps " : ", ", each.each->command);
      text += fmt::format("  {:<16} {:.2g} {}, about {}, {}{}\n", one.stage, one.work, one.unit, timeText(one.seconds),
        bytesText(one.bytes), steps);
      stages.push_back({ { "name", one.stage }, { "command", first.stages[i].words }, { "work", one.work },
        { "unit", one.unit }, { "seconds", one.seconds }, { "bytes", one.bytes } });
    }
    for (const std::string& skipped : first.skipped)
      text += "  left out: " + skipped + "\n";
    for (const std::string& failure : failures)
      text += "  the first sample fails: " + failure + "\n";
    const double processes = std::max(options_.jobs, session_.ranks());
    text += fmt::format("\n  memory: up to {} a process{}; {} are free\n", bytesText(bytes),
      processes > 1 ? fmt::format(", {} in all", bytesText(bytes * processes)) : "",
      bytesText(static_cast<double>(availableMemory())));
    text += fmt::format("  time: {} in all{}; an order of magnitude\n", timeText(seconds / processes),
      processes > 1 ? fmt::format(" on {:.0f} processes", processes) : "");
    text += fmt::format("  results: {}{}\n", folder().string(),
      there > 0 ? fmt::format(", where {} are finished already", grouped(static_cast<std::int64_t>(there))) : "");
    if (options_.common.json)
    {
      Json json{ { "samples", count }, { "finished", there }, { "nodes", cost.nodes }, { "memory", bytes },
        { "seconds", seconds }, { "stages", stages }, { "left_out", first.skipped }, { "fails", failures },
        { "results", folder().string() } };
      text = dump(json);
    }
    session_.print(text);
  }

  void finish(std::size_t before)
  {
    std::vector<std::string> failures;
    std::optional<Json> firstFailure;
    std::map<std::string, std::size_t> warnings;
    std::set<std::string> commits;
    for (SampleResult& sample : samples_)
    {
      sample.record = results_->load(sample.plan.key);
      if (sample.record)
      {
        for (const Json& warning : sample.record->value("warnings", Json::array()))
          ++warnings[warning.get<std::string>()];
        commits.insert(sample.record->value("commit", ""));
        continue;
      }
      const Json failure = results_->failure(sample.plan.key).value_or(Json{ { "error", "it was not computed" } });
      if (!firstFailure)
        firstFailure = failure;
      failures.push_back(settingText(sample.plan.settings));
    }
    for (const auto& [warning, count] : warnings)
    {
      session_.warn(
        samples_.size() == 1 ? warning : fmt::format("{} of {} samples: {}", count, samples_.size(), warning));
    }
    if (commits.size() > 1)
    {
      session_.warn(fmt::format("samples were computed by {} builds of lamella (times.csv tells which); remove the "
                                "folder '{}' to compute all by this one",
        commits.size(), (folder() / "samples").string()));
    }
    for (const SampleResult& sample : samples_)
    {
      if (sample.record)
      {
        checkMeasures(scene_, sample.record->at("stages"));
        break;
      }
    }
    const std::vector<std::string> written = writeTables();
    report(before, failures.size(), written);
    if (!failures.empty())
      throwFailed(failures, *firstFailure);
  }

  /// @returns the names of the files
  std::vector<std::string> writeTables()
  {
    samplesTable_ = sampleTable(scene_, sweep_, samples_);
    settingsTable_ = settingTable(scene_, sweep_, samplesTable_);
    std::vector<std::pair<std::string, vtkSmartPointer<vtkTable>>> tables{ { "table", samplesTable_ },
      { "settings", settingsTable_ } };
    for (const SceneEach& each : scene_.each)
    {
      if (auto table = stepTable(sweep_, samples_, each); table->GetNumberOfRows() > 0)
      {
        std::string name = each.name;
        std::replace(name.begin(), name.end(), '.', '_');
        tables.emplace_back("steps_" + name, std::move(table));
      }
    }
    tables.emplace_back("times", costTable(samples_));
    io::Provenance run = recordRun(session_, commandLine_, scene_.source.file, "");
    Json scene{ { "file", scene_.source.file }, { "text", scene_.source.text } };
    if (!scene_.title.empty())
      scene["title"] = scene_.title;
    run.parameters = Json{ { "scene", std::move(scene) } }.dump(-1, ' ', false, Json::error_handler_t::replace);
    const std::string provenance = io::toJson(run);
    ResultFiles files;
    std::vector<std::pair<std::string, vtkTable*>> all;
    for (const auto& [name, table] : tables)
    {
      files.addTable("results", (folder() / (name + ".csv")).string(), table, true);
      all.emplace_back(name, table.Get());
    }
    const auto unsized = [](const Json& stage)
    { return stage.contains("pixel_size") && stage["pixel_size"].is_null(); };
    const bool metres = std::ranges::none_of(samples_,
      [&](const SampleResult& sample)
      { return sample.record && std::ranges::any_of(sample.record->at("stages"), unsized); });
    std::vector<std::string> written = files.write(provenance, metres);
    const fs::path archive = folder() / "results.h5";
    writeArchive(archive, all, provenance);
    written.push_back(archive.string());
    return written;
  }

  void report(std::size_t before, std::size_t failed, const std::vector<std::string>& written)
  {
    const std::size_t done = samples_.size() - failed;
    if (options_.common.json)
    {
      Json json{ { "samples", samples_.size() }, { "finished", done }, { "failed", failed },
        { "finished_before", before }, { "results", folder().string() }, { "files", written } };
      if (options_.statistics)
        json["statistics"] = statistics();
      addRecord(json, recordRun(session_, commandLine_, scene_.source.file, ""));
      session_.print(dump(json));
      return;
    }
    if (options_.common.quiet)
      return;
    std::string text = scene_.title.empty() ? "" : scene_.title + "\n\n";
    text += tableText();
    text += fmt::format("\n  {} of {} samples finished{}{}\n", done, samples_.size(),
      before > 0 ? fmt::format(", {} of them before", before) : "",
      failed > 0 ? fmt::format(", {} failed", failed) : "");
    if (options_.statistics)
      text += statisticsText(statistics());
    session_.print(text + wroteText(written));
  }

  /// What samples of one setting say together of their material, and how many would halve that.
  static std::string spreadText(
    const std::string& name, double count, double mean, std::optional<double> half, double deviation)
  {
    if (!half || !(count > 1) || mean == 0)
      return "";
    statistics::WindowError error;
    error.value = error.expected = mean;
    error.low = mean - *half;
    error.high = mean + *half;
    error.deviation = deviation; // of one of them
    error.quantile = *half / deviation * std::sqrt(count);
    return windowText(name + " ", error, "", 1);
  }

  /// The settings with mean and standard error of what the scene measures.
  std::string tableText()
  {
    std::vector<std::string> settings;
    for (vtkIdType c = 0;
         c < settingsTable_->GetNumberOfColumns() && settingsTable_->GetColumnName(c) != std::string("n"); ++c)
      settings.emplace_back(settingsTable_->GetColumnName(c));
    if (scene_.measures.empty())
      return "";
    constexpr vtkIdType most = 40;
    std::string text = "  ";
    for (const std::string& name : settings)
      text += fmt::format("{:<{}}", name, std::max<std::size_t>(name.size() + 2, 14));
    text += fmt::format("{:>5}", "n");
    for (const SceneMeasure& measure : scene_.measures)
      text += fmt::format("  {:>24}", measure.name);
    text += "\n";
    const auto number = [&](vtkIdType row, const std::string& name) -> std::optional<double>
    {
      auto* const column = vtkDoubleArray::SafeDownCast(settingsTable_->GetColumnByName(name.c_str()));
      return column == nullptr || !std::isfinite(column->GetValue(row)) ? std::nullopt
                                                                        : std::optional(column->GetValue(row));
    };
    for (vtkIdType row = 0; row < std::min(most, settingsTable_->GetNumberOfRows()); ++row)
    {
      text += "  ";
      for (const std::string& name : settings)
      {
        text += fmt::format("{:<{}}", settingsTable_->GetValueByName(row, name.c_str()).ToString(),
          std::max<std::size_t>(name.size() + 2, 14));
      }
      text += fmt::format("{:>5}", number(row, "n").value_or(0));
      for (const SceneMeasure& measure : scene_.measures)
      {
        const auto mean = number(row, measure.name + ".mean");
        const auto error = number(row, measure.name + ".error");
        text += fmt::format("  {:>24}",
          !mean     ? std::string("-")
            : error ? fmt::format("{:.6g} ± {:.2g}", *mean, *error)
                    : fmt::format("{:.6g}", *mean));
      }
      text += "\n";
    }
    if (settingsTable_->GetNumberOfRows() == 1)
    {
      std::string spread;
      for (const SceneMeasure& measure : scene_.measures)
        spread += spreadText(measure.name, number(0, "n").value_or(0), number(0, measure.name + ".mean").value_or(0),
          number(0, measure.name + ".half_width"), number(0, measure.name + ".deviation").value_or(0));
      text += spread.empty() ? "" : "  the mean of such samples is, with 95 % probability\n" + spread;
    }
    if (settingsTable_->GetNumberOfRows() > most)
      text += fmt::format("  … and {} more settings, in settings.csv\n", settingsTable_->GetNumberOfRows() - most);
    return text;
  }

  /// What was computed, and what was not, over all samples.
  Json statistics() const
  {
    Json stages = Json::object();
    std::map<std::string, std::size_t> skipped;
    Json calls = Json::object();
    for (const SampleResult& sample : samples_)
    {
      if (!sample.record)
        continue;
      const Json times = sample.record->value("stage_seconds", Json::object());
      for (const auto& [stage, seconds] : times.items())
      {
        Json& one = stages.contains(stage) ? stages[stage] : stages[stage] = Json::object();
        const Json reused = sample.record->value("reused", Json::array());
        const bool again = std::ranges::find(reused, Json(stage)) != reused.end();
        one["runs"] = one.value("runs", 0) + (again ? 0 : 1);
        one["seconds"] = one.value("seconds", 0.0) + seconds.get<double>();
      }
      const Json passes = sample.record->value("calls", Json::object());
      for (const auto& [what, count] : passes.items())
        calls[what] = calls.value(what, std::int64_t{ 0 }) + count.get<std::int64_t>();
      for (const Json& text : sample.record->value("skipped", Json::array()))
        ++skipped[text.get<std::string>()];
    }
    Json json{ { "stages", stages }, { "calls", calls }, { "left_out", Json::array() } };
    for (const auto& [text, count] : skipped)
      json["left_out"].push_back(text);
    return json;
  }

  static std::string statisticsText(const Json& json)
  {
    std::string text = "\n";
    for (const auto& [stage, one] : json["stages"].items())
    {
      text +=
        fmt::format("  {:<20} {:>6} runs  {:>10.3f} s\n", stage, one["runs"].get<int>(), one["seconds"].get<double>());
    }
    for (const auto& [what, count] : json["calls"].items())
      text += fmt::format("  {:<20} {:>6} times\n", what, count.get<std::int64_t>());
    for (const Json& left : json["left_out"])
      text += "  left out: " + left.get<std::string>() + "\n";
    return text;
  }

  [[noreturn]] void throwFailed(const std::vector<std::string>& failures, const Json& first) const
  {
    const std::string what = samples_.size() == 1
      ? first.value("error", "")
      : fmt::format("{} of {} samples failed, the first ({}): {}", failures.size(), samples_.size(), failures.front(),
          first.value("error", ""));
    const std::string hint = first.value("hint", "");
    switch (first.value("code", 1))
    {
      case exitUsage:
        throw ParameterError(what, hint);
      case exitNoPath:
        throw NoPathError(what, hint);
      case exitMemory:
        throw MemoryError(what, hint);
      case exitDiverged:
        throw DivergenceError(what, hint);
      default:
        throw InputError(what, hint);
    }
  }

  Session& session_;
  const RunOptions& options_;
  std::string commandLine_;
  CommandSet commands_;
  FileHashes files_;
  Scene scene_;
  Sweep sweep_;
  std::unique_ptr<Results> results_;
  std::vector<SampleResult> samples_;
  std::vector<std::size_t> unfinished_;
  vtkSmartPointer<vtkTable> samplesTable_;
  vtkSmartPointer<vtkTable> settingsTable_;
};

} // namespace

Command runCommand(CLI::App& root)
{
  CLI::App* app =
    root.add_subcommand("run", "Run a scene: samples, solvers, filters, pictures and sweeps as one file says them");
  auto o = std::make_shared<RunOptions>();
  o->app = app;
  app->allow_extras();
  app->add_option("SCENE", o->file, "The scene, in TOML; its keys are the options of the commands")->required();
  addOption(
    *app, "Scene", "--set", o->set, "Set a key, as fracture.horizon=4; or write --fracture.horizon 4", "KEY=VALUE")
    ->allow_extra_args(false);
  addOption(*app, "Samples", "--results", o->results, "Where results go; the scene's name with .results when not given",
    "FOLDER");
  addOption(*app, "Samples", "--jobs", o->jobs, "Processes that take samples; within mpirun its ranks do", "NUMBER")
    ->capture_default_str();
  app->add_flag("--dry-run", o->dryRun, "Only tell what would run, with its memory and time")->group("Samples");
  app->add_flag("--yes", o->yes, "Do not ask before sweeps of more than 10 000 samples")->group("Samples");
  addReportOptions(*app, o->common);
  app->add_flag("--stats", o->statistics, "Tell what was computed and what was left out")->group("Report");
  addExamples(*app,
    { "lamella run strength.toml --dry-run", "lamella run strength.toml --jobs 2 --stats",
      "lamella run strength.toml --fracture.horizon 4 --set 'sample.seed=\"1..20\"' --results horizon-4",
      "mpirun -n 4 lamella run strength.toml" });
  return { app,
    [o](Session& session, const std::string& line)
    {
      session.setQuiet(o->common.quiet);
      Run(session, *o, line)();
    } };
}

} // namespace lamella::cli
