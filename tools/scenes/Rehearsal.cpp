#include "scenes/Rehearsal.h"

#include "scenes/Contents.h"
#include "scenes/Measures.h"
#include "scenes/Memory.h"

#include "session/Text.h"

#include "core/Error.h"
#include "vtkLatticeConversion.h"

#include <vtkDataSet.h>
#include <vtkImageData.h>
#include <vtkPointData.h>

#include <fmt/format.h>

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <optional>

namespace lamella::cli
{

namespace
{

namespace fs = std::filesystem;

/// Only what makes the sample, with what it gives kept.
SamplePlan sampleOnly(SamplePlan plan)
{
  std::erase_if(plan.stages,
    [](const PlannedStage& stage)
    {
      return output(*stage.stage->ports, "output") == nullptr ||
        (!stage.stage->ports->takes.empty() && stage.stage->command != "bridges");
    });
  for (PlannedStage& stage : plan.stages)
  {
    stage.each.clear();
    if (!stage.outputs.contains("output"))
    {
      const Port* const port = output(*stage.stage->ports, "output");
      stage.outputs["output"] = Workspace::nameOf(stage.stage->name, port->ending);
      stage.words.push_back("--output=" + stage.outputs["output"]);
    }
  }
  return plan;
}

/// A picture that nobody will see.
class NoPicture
{
public:
  NoPicture()
    : file_(fs::temp_directory_path() / fmt::format("lamella-dry-run-{}.png", ::getpid()))
  {
  }
  ~NoPicture()
  {
    std::error_code ignored;
    fs::remove(file_, ignored);
  }
  NoPicture(const NoPicture&) = delete;
  NoPicture& operator=(const NoPicture&) = delete;
  [[nodiscard]] std::vector<std::string> words() const { return { "--output=" + file_.string(), "--overwrite" }; }

private:
  fs::path file_;
};

/// The data of an array that a command is told to look at; nothing: what there is.
std::optional<std::string> arrayAsked(const std::string& command, const std::vector<std::string>& words)
{
  std::string array = command == "stress-pdf" ? "stress" : "";
  std::string preset;
  for (const std::string& word : words)
  {
    array = word.starts_with("--array=") ? word.substr(8) : array;
    preset = word.starts_with("--preset=") ? word.substr(9) : preset;
  }
  if (array.empty() && !preset.empty() && preset != "auto" && preset != "scalar")
    array = preset == "pores" ? "pore_size" : preset;
  return array.empty() ? std::nullopt : std::optional(array);
}

} // namespace

Rehearsal::Rehearsal(const Scene& scene, const SamplePlan& first)
  : scene_(scene)
  , plan_(first)
  , made_(sampleOnly(first))
  , bytesBefore_(static_cast<double>(memoryNow()))
  , runner_(scene, "",
      [this](double share, const std::string&) { return !Session::interrupted() && (looks_ < 0 || !works(share)); })
{
  const Json record = runner_.run(made_, "");
  checkMeasures(scene_, record.at("stages"));
}

std::vector<std::string> Rehearsal::operator()()
{
  checkPhasesOfMeasures();
  checkArrays();
  for (const PlannedStage& stage : plan_.stages)
  {
    if (isMade(stage))
      continue;
    rehearse(stage, std::ranges::all_of(stage.inputs, [&](std::size_t input) { return isMade(plan_.stages[input]); }));
    for (const PlannedEach& each : stage.each)
    {
      PlannedStage step;
      step.stage = each.each;
      step.words = split(each.each->words, ' ');
      step.words.emplace_back("memory:step.vti");
      step.words.insert(step.words.end(), each.options.begin(), each.options.end());
      rehearse(step, false);
    }
  }
  return failures_;
}

bool Rehearsal::isMade(const PlannedStage& stage) const
{
  return std::ranges::any_of(
    made_.stages, [&](const PlannedStage& made) { return made.stage == stage.stage; });
}

bool Rehearsal::works(double share)
{
  // filters tell of a share of 0 each time they are asked what they will give and once they begin, where some stay; of
  // all of it when they end, also with an error
  constexpr int most = 8;
  return share < 1 && (share > 0 || ++looks_ > most);
}

/// @param ready whether its data are there; else only what a command looks at before its data
void Rehearsal::rehearse(const PlannedStage& stage, bool ready)
{
  const NoPicture picture;
  PlannedStage running = stage;
  if (stage.stage->command == "snapshot")
  {
    const std::vector<std::string> words = picture.words();
    running.words.insert(running.words.end(), words.begin(), words.end());
  }
  looks_ = 0;
  try
  {
    runner_.rehearse(running);
  }
  catch (const Cancelled&)
  {
    Session::checkInterrupt();
  }
  catch (const InputError&)
  {
    if (ready)
      throw;
  }
  catch (const NoPathError& error)
  {
    failures_.emplace_back(error.what());
  }
  catch (const MemoryError& error)
  {
    failures_.push_back(stage.stage->where + ": [" + stage.stage->name + "] " + error.what());
  }
  catch (const DivergenceError& error)
  {
    failures_.emplace_back(error.what());
  }
}

void Rehearsal::checkPhasesOfMeasures() const
{
  std::vector<std::string> phases;
  for (const PlannedStage& stage : made_.stages)
  {
    const auto data = Workspace::find(stage.outputs.at("output"));
    if (auto* const image = vtkImageData::SafeDownCast(data))
      phases = toPhaseImage(image, "phase", Voxels::Any).phases.names();
  }
  std::vector<std::string> known = phases;
  known.emplace_back("all"); // of stress-pdf
  for (const SceneMeasure& measure : scene_.measures)
  {
    const std::vector<std::string> parts = split(measure.path, '.');
    const std::size_t at = parts.size() > 2 && parts[1] == "phases" ? 2 : 0;
    if (at > 0 && !phases.empty() && !toInteger(parts[at]) && std::ranges::find(known, parts[at]) == known.end())
    {
      sceneError(measure.where,
        fmt::format("{} = \"{}\": '{}' is no phase of this sample", measure.name, measure.path, parts[at]),
        suggestion(parts[at], phases, "its phases are " + quotedList(phases, "and")));
    }
  }
}

void Rehearsal::checkArrays() const
{
  for (const PlannedStage& stage : plan_.stages)
  {
    for (const std::size_t input : stage.inputs)
    {
      const PlannedStage& giver = plan_.stages[input];
      const auto given = giver.outputs.find("output");
      const std::string stem = given == giver.outputs.end() ? "" : fs::path(given->second).replace_extension().string();
      if (std::ranges::any_of(stage.words,
            [&](const std::string& word)
            {
              const std::string name = fs::path(word).replace_extension().string();
              return !stem.empty() && (name == stem || name.starts_with(stem + "_"));
            }))
        checkArray(*stage.stage, stage.words, giver);
    }
    for (const PlannedEach& each : stage.each)
      if (!each.broken)
        checkArray(*each.each, each.options, stage);
  }
}

/// What a taker looks at must be among what its giver's data carry, or the sample brings along.
void Rehearsal::checkArray(
  const SceneStage& taker, const std::vector<std::string>& words, const PlannedStage& giver) const
{
  const auto asked = arrayAsked(taker.command, words);
  std::vector<std::string> there = arraysGiven(giver.stage->command, "output");
  if (!asked || there.empty() || isMade(giver))
    return;
  for (const PlannedStage& stage : made_.stages)
  {
    const auto data = Workspace::find(stage.outputs.at("output"));
    auto* const set = vtkDataSet::SafeDownCast(data);
    for (int i = 0; set != nullptr && i < set->GetPointData()->GetNumberOfArrays(); ++i)
    {
      const char* const name = set->GetPointData()->GetArrayName(i);
      if (name != nullptr && std::ranges::find(there, name) == there.end())
        there.emplace_back(name);
    }
  }
  if (std::ranges::find(there, *asked) == there.end())
  {
    const auto option =
      std::ranges::find_if(taker.options, [](const SceneOption& o) { return o.name == "array" || o.name == "preset"; });
    sceneError(option == taker.options.end() ? taker.where : option->where,
      fmt::format("[{}] looks at the array '{}', which {} does not give", taker.name, *asked, giver.stage->name),
      suggestion(*asked, there, "it gives " + quotedList(there, "and")));
  }
}

} // namespace lamella::cli
