#include "scenes/Plan.h"

#include "session/Text.h"
#include "session/Workspace.h"

#include "core/Error.h"
#include "io/Provenance.h"
#include "lamella/Version.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace lamella::cli
{

namespace
{

/// Where data come from: a stage, its output, and what the user said behind the colon.
struct PortSource
{
  std::size_t stage = 0;
  const Port* port = nullptr;
  std::string part; ///< "y" of of = "diffusion:y"
};

class Planner
{
public:
  Planner(const Scene& scene, const Setting& setting, const CommandSet& commands)
    : scene_(scene)
    , setting_(setting)
    , commands_(commands)
    , planned_(scene.stages.size())
    , needed_(scene.stages.size(), false)
    , words_(scene.stages.size())
    , lookedAt_(scene.stages.size())
  {
  }

  std::vector<PlannedStage> operator()(std::vector<std::string>& skipped)
  {
    for (std::size_t i = 0; i < planned_.size(); ++i)
      planned_[i].stage = &scene_.stages[i];
    markRoots();
    for (std::size_t i = planned_.size(); i-- > 0;)
      if (needed_[i])
        join(i);
    std::vector<PlannedStage> running;
    std::vector<std::size_t> place(planned_.size());
    for (std::size_t i = 0; i < planned_.size(); ++i)
    {
      if (!needed_[i])
      {
        skipped.push_back(scene_.stages[i].name + ": nothing asks for it");
        continue;
      }
      finish(i, skipped);
      for (std::size_t& input : planned_[i].inputs)
        input = place[input];
      place[i] = running.size();
      running.push_back(std::move(planned_[i]));
    }
    return running;
  }

private:
  [[nodiscard]] std::size_t indexOf(const std::string& name) const
  {
    return static_cast<std::size_t>(std::ranges::find(scene_.stages, name, &SceneStage::name) - scene_.stages.begin());
  }

  void markRoots()
  {
    for (std::size_t i = 0; i < planned_.size(); ++i)
    {
      const SceneStage& stage = scene_.stages[i];
      needed_[i] = scene_.measures.empty() || stage.command == "snapshot" || !stage.write.empty();
      for (const std::string& option : stage.write)
      {
        want(i, option);
        if (option == "output")
        {
          planned_[i].arrays.reset();
          planned_[i].lastStateOnly = false;
        }
      }
    }
    for (const SceneMeasure& measure : scene_.measures)
    {
      const std::string name = split(measure.path, '.').front();
      std::size_t stage = indexOf(name);
      for (std::size_t i = 0; i < planned_.size(); ++i) // of several of a kind "stress-pdf.0.mean"
        stage = measure.path.starts_with(scene_.stages[i].name + ".") ? i : stage;
      needed_.at(stage) = true;
    }
    for (const SceneEach& each : scene_.each)
    {
      const std::size_t i = stageWithSteps(each);
      needed_[i] = true;
      const bool broken = std::string(each.ports->takes.front().kind) == "broken";
      PlannedEach run{ &each, {}, broken };
      for (const SceneOption& option : each.options)
      {
        const auto words = wordsFor(option, setting_);
        run.options.insert(run.options.end(), words.begin(), words.end());
      }
      want(i, "output"); // what options of states ask for
      if (broken)
        want(i, "broken");
      else
        wantArrays(i, each, run.options);
      planned_[i].each.push_back(std::move(run));
    }
  }

  [[nodiscard]] std::size_t stageWithSteps(const SceneEach& each) const
  {
    std::string there;
    for (std::size_t i = scene_.stages.size(); i-- > 0;)
    {
      const SceneStage& stage = scene_.stages[i];
      const Port* const gives = stage.ports->steps ? output(*stage.ports, "output") : nullptr;
      const bool broken = std::string(each.ports->takes.front().kind) == "broken";
      const bool suits = gives != nullptr &&
        (broken ? output(*stage.ports, "broken") != nullptr : fits(each.ports->takes.front(), gives->kind));
      if (suits && (each.of.empty() || each.of == stage.name))
        return i;
    }
    sceneError(each.ofWhere,
      each.of.empty() ? "no stage of this scene comes to steps on which " + each.command + " runs"
                      : "'" + each.of + "' comes to no steps on which " + each.command + " runs",
      "steps are states of fracture, dynamics, compression, transient and packing");
  }

  void want(std::size_t stage, const std::string& option)
  {
    const SceneStage& s = scene_.stages[stage];
    const Port* const port = output(*s.ports, option);
    planned_[stage].outputs[option] =
      Workspace::nameOf(option == "output" ? s.name : s.name + "_" + option, endingOf(s, *port));
  }

  /// What [sample] names, in this sample of a sweep.
  [[nodiscard]] std::string fileOf(const SceneStage& stage) const
  {
    if (!stage.file)
      return "";
    const auto swept = setting_.find(stage.file->path);
    return (swept != setting_.end() ? swept->second : stage.file->value).get<std::string>();
  }

  /// A packing that is read stays what it is.
  [[nodiscard]] std::string endingOf(const SceneStage& stage, const Port& port) const
  {
    return isGrains(stage) ? ".vtp" : port.ending;
  }
  [[nodiscard]] bool isGrains(const SceneStage& stage) const
  {
    return stage.command == "read" && std::filesystem::path(fileOf(stage)).extension() == ".vtp";
  }
  [[nodiscard]] std::string kindOf(const SceneStage& stage, const Port& port) const
  {
    return isGrains(stage) ? "grains" : port.kind;
  }

  /// Where a stage says what it takes its data from: the line of its key, or the section.
  static const std::string& placeOf(const SceneStage& stage, const std::string& of)
  {
    const auto option =
      std::ranges::find_if(stage.options, [&](const SceneOption& each) { return !of.empty() && each.value == of; });
    return of != stage.of && option != stage.options.end() ? option->where : stage.ofWhere;
  }

  /// The last stage before `stage` that gives what a port takes.
  [[nodiscard]] PortSource source(std::size_t stage, const Port& input, const std::string& of) const
  {
    const SceneStage& taker = scene_.stages[stage];
    const std::vector<std::string> parts = split(of, ':');
    for (std::size_t i = stage; i-- > 0;)
    {
      const SceneStage& giver = scene_.stages[i];
      if (!of.empty() && giver.name != parts.front())
        continue;
      for (const Port& port : giver.ports->gives)
        if (fits(input, kindOf(giver, port)))
          return { i, &port, parts.size() > 1 ? parts[1] : "" };
    }
    std::vector<std::string> givers;
    for (const Ports& ports : allPorts())
      if (std::ranges::any_of(ports.gives, [&](const Port& port) { return fits(input, port.kind); }))
        givers.emplace_back(ports.command);
    std::string kinds = input.kind;
    std::replace(kinds.begin(), kinds.end(), '|', '/');
    sceneError(placeOf(taker, of),
      of.empty() ? fmt::format("[{}] takes {}, and no section above it gives that", taker.name, kinds)
                 : fmt::format("[{}] takes {}, and '{}' gives no such thing above it", taker.name, kinds, of),
      quotedList(givers) + (givers.size() > 1 ? " give it" : " gives it"));
  }

  /// Where a stage's data come from, and what that asks of the stages that give them.
  void join(std::size_t i)
  {
    const SceneStage& stage = scene_.stages[i];
    PlannedStage& planned = planned_[i];
    std::vector<std::string> options;
    for (const SceneOption& option : stage.options)
    {
      const auto accepted = std::ranges::find(stage.ports->accepts, option.name, &Port::option);
      auto words = wordsFor(option, setting_);
      if (accepted != stage.ports->accepts.end())
      {
        const std::string dashed = "--" + option.name + "=";
        words.front() = dashed + take(i, *accepted, words.front().substr(dashed.size()), options);
      }
      options.insert(options.end(), words.begin(), words.end());
    }
    planned.words = split(stage.words, ' ');
    planned.file = fileOf(stage);
    if (!planned.file.empty())
      planned.words.push_back(planned.file);
    for (const Port& input : stage.ports->takes)
    {
      const bool own = &input != &stage.ports->takes.front(); // `of` is for the first
      planned.words.push_back(take(i, input, own ? "" : stage.of, options));
      if (std::string(input.option) == "POINTS")
        planned_[planned.inputs.back()].lastStateOnly = false;
    }
    words_[i] = std::move(options);
  }

  /// @returns the name of the data
  std::string take(std::size_t i, const Port& input, const std::string& of, const std::vector<std::string>& options)
  {
    const PortSource from = source(i, input, of);
    requireDirection(i, from);
    needed_[from.stage] = true;
    planned_[i].inputs.push_back(from.stage);
    want(from.stage, from.port->option);
    if (from.port->option == std::string("output"))
      wantArrays(from.stage, scene_.stages[i], options);
    std::filesystem::path name = planned_[from.stage].outputs.at(from.port->option);
    return from.part.empty() ? name.string() : name.stem().string() + "_" + from.part + name.extension().string();
  }

  /// A diffusion along several directions gives a field for each, and so does a fit by one.
  void requireDirection(std::size_t taker, const PortSource& from) const
  {
    const SceneStage& giver = scene_.stages[from.stage];
    if ((giver.words != "diffusion" && giver.words != "fit diffusion") || from.port->option != std::string("output"))
      return;
    std::string direction = "all";
    for (const SceneOption& option : giver.options)
      direction = option.name == "direction" ? wordsFor(option, setting_).front().substr(12) : direction;
    const std::string hint = "write of = \"" + giver.name + ":x\", or another direction";
    if (direction == "all" && from.part.empty())
    {
      sceneError(scene_.stages[taker].ofWhere,
        fmt::format(
          "[{}] takes one field, and [{}] gives one for each direction", scene_.stages[taker].name, giver.name),
        hint);
    }
    if (direction == "all" && from.part != "x" && from.part != "y" && from.part != "z")
      sceneError(scene_.stages[taker].ofWhere, fmt::format("'{}:{}' is no direction", giver.name, from.part), hint);
    if (direction != "all" && !from.part.empty())
    {
      sceneError(scene_.stages[taker].ofWhere,
        fmt::format("[{}] has one direction only, and no '{}:{}'", giver.name, giver.name, from.part),
        "write of = \"" + giver.name + "\"");
    }
  }

  /// The arrays of states that a stage looks at.
  void wantArrays(std::size_t giver, const SceneStage& taker, const std::vector<std::string>& options)
  {
    const auto look = [&](const std::string& name)
    {
      lookedAt_[giver].insert(name);
      if (planned_[giver].arrays) // else all are wanted
        planned_[giver].arrays->insert(name);
    };
    std::string array;
    std::string preset;
    for (const std::string& word : options)
    {
      array = word.starts_with("--array=") ? word.substr(8) : array;
      preset = word.starts_with("--preset=") ? word.substr(9) : preset;
    }
    if (taker.command == "stress-pdf")
      look(array.empty() ? "stress" : array);
    else if (taker.command == "flux-map")
      look("flux");
    else if (taker.command == "collapse-map")
      look("deformation_gradient");
    else if (taker.command == "snapshot" && array.empty() && (preset.empty() || preset == "auto" || preset == "scalar"))
      look("displacement"); // whatever the picture takes by itself is there
    else if (taker.command == "snapshot")
      look(array.empty() ? preset : array);
  }

  /// Flags of a command that ask for arrays of its states: --stress, --flux.
  [[nodiscard]] std::vector<std::string> arrayFlags(const SceneStage& stage) const
  {
    const std::vector<std::string> groups{ "Output", "State shown",
      "Time" }; // of the headers' settings that give arrays
    std::vector<std::string> flags;
    for (const CLI::Option* option : commands_.find(stage.words)->get_options())
      if (std::ranges::find(groups, option->get_group()) != groups.end() && shapeOf(option) == Shape::Flag &&
        option->get_lnames().front() != "overwrite")
        flags.push_back(option->get_lnames().front());
    return flags;
  }

  /// The words of a stage, now that it is known what is wanted of it.
  void finish(std::size_t i, std::vector<std::string>& skipped)
  {
    const SceneStage& stage = scene_.stages[i];
    PlannedStage& planned = planned_[i];
    std::vector<std::string> left;
    for (const std::string& flag : arrayFlags(stage))
    {
      std::string array = flag;
      std::replace(array.begin(), array.end(), '-', '_');
      const auto given = std::ranges::find(words_[i], "--" + flag);
      const bool written = !planned.outputs.contains("output") ? false : !planned.arrays.has_value();
      const bool wanted = lookedAt_[i].contains(array);
      if (wanted && given == words_[i].end())
      {
        words_[i].push_back("--" + flag);
      }
      else if (!wanted && !written)
      {
        if (given != words_[i].end())
          words_[i].erase(given);
        left.push_back(flag);
      }
      else if (!wanted && given == words_[i].end())
      {
        left.push_back(flag);
      }
    }
    for (const Port& port : stage.ports->gives)
      if (!planned.outputs.contains(port.option))
        left.emplace_back(port.option == std::string("output") ? port.kind : port.option);
    if (!left.empty() && stage.command != "snapshot")
    {
      std::string list;
      for (const std::string& word : left)
        list += (list.empty() ? "" : ", ") + word;
      skipped.push_back(stage.name + ": " + list);
    }
    planned.words.insert(planned.words.end(), words_[i].begin(), words_[i].end());
    if (stage.command == "snapshot")
      return; // its runner names the file
    for (const auto& [option, name] : planned.outputs)
      planned.words.push_back("--" + option + "=" + name);
    if (!planned.outputs.contains("output"))
      dropStateOptions(planned);
  }

  /// States that nobody looks at are not made: a command refuses to keep states and write none. Those of transient say
  /// where its history has points, and where it ends.
  static void dropStateOptions(PlannedStage& planned)
  {
    if (planned.stage->ports->steps && planned.stage->command != "transient")
    {
      std::vector<std::string> options{ "--at-strain=", "--at-broken=", "--at-time=", "--every=" };
      if (planned.stage->command == "dynamics") // where its states are points of the history, they stay
        options.emplace_back("--frames=");
      std::erase_if(planned.words,
        [&](const std::string& word)
        { return std::ranges::any_of(options, [&](const std::string& o) { return word.starts_with(o); }); });
    }
  }

  const Scene& scene_;
  const Setting& setting_;
  const CommandSet& commands_;
  std::vector<PlannedStage> planned_;
  std::vector<bool> needed_;
  std::vector<std::vector<std::string>> words_; ///< options of each
  std::vector<std::set<std::string>> lookedAt_; ///< arrays of the states of each, by what runs on them
};

/// Which words of a command line name files of the user.
std::vector<std::string> filesOf(const PlannedStage& stage, const CommandSet& commands)
{
  std::vector<std::string> files;
  if (!stage.file.empty())
    files.push_back(stage.file);
  for (const CLI::Option* option : commands.find(stage.stage->words)->get_options())
  {
    if (!option->get_lnames().empty() && option->get_type_name().starts_with("FILE"))
    {
      const std::string dashed = "--" + option->get_lnames().front() + "=";
      for (const std::string& word : stage.words)
        if (word.starts_with(dashed) && !word.starts_with(dashed + "memory:"))
          files.push_back(word.substr(dashed.size()));
    }
  }
  return files;
}

} // namespace

const std::string& FileHashes::of(const std::string& file)
{
  const auto found = known_.find(file);
  return found != known_.end() ? found->second : known_[file] = io::describeInput(file).sha256;
}

SamplePlan makePlan(
  const Scene& scene, const Sweep& sweep, std::size_t sample, const CommandSet& commands, FileHashes& files)
{
  const Setting setting = sweep.setting(sample);
  SamplePlan plan;
  plan.stages = Planner(scene, setting, commands)(plan.skipped);
  plan.settings = Json::object();
  for (const SweepAxis& axis : sweep.axes())
    plan.settings[axis.path] = setting.at(axis.path);
  Json identity{ { "version", version() }, { "stages", Json::array() } };
  for (const PlannedStage& stage : plan.stages)
  {
    Json one{ { "words", stage.words }, { "write", stage.stage->write }, { "name", stage.stage->name } };
    for (const std::string& file : filesOf(stage, commands))
    {
      if (!std::filesystem::exists(file))
      {
        throw InputError(stage.stage->where + ": there is no file '" + file + "'",
          "names are looked up from the folder in which lamella runs");
      }
      one["files"].push_back(files.of(file));
    }
    for (const PlannedEach& each : stage.each)
    {
      one["each"].push_back({ { "name", each.each->name }, { "run", each.each->words }, { "options", each.options },
        { "every", each.each->every }, { "movie", each.each->movie } });
    }
    identity["stages"].push_back(std::move(one));
  }
  const std::string text = identity.dump(-1, ' ', true, Json::error_handler_t::replace);
  io::Sha256 hash;
  hash.update(std::as_bytes(std::span(text)));
  plan.key = hash.finish().substr(0, 16);
  return plan;
}

} // namespace lamella::cli
