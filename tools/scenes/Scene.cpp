#include "scenes/Scene.h"

#include "program/CommandLine.h"
#include "session/Text.h"
#include "session/Units.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <set>
#include <utility>

namespace lamella::cli
{

namespace
{

/// Options that a scene sees to itself.
const std::set<std::string> managed{ "json", "quiet", "overwrite", "help", "checkpoint", "checkpoint-every", "continue",
  "stats" };

bool isManaged(const Ports& ports, const std::string& option)
{
  return managed.contains(option) || output(ports, option) != nullptr || option == "csv";
}

/// What a scene may say of a command: the long names of its options.
std::vector<std::string> keysFor(const CLI::App* app, const Ports& ports)
{
  std::vector<std::string> keys;
  for (const std::string& name : optionNames(app))
    if (name.starts_with("--") && !isManaged(ports, name.substr(2)))
      keys.push_back(name.substr(2));
  return keys;
}

bool contains(const std::vector<std::string>& list, const std::string& word)
{
  return std::ranges::find(list, word) != list.end();
}

[[noreturn]] void unknownKey(
  const SceneSection& section, const SceneKey& key, const std::vector<std::string>& known, const std::string& otherwise)
{
  sceneError(
    key.where, fmt::format("'{}' is no key of [{}]", key.name, section.kind), suggestion(key.name, known, otherwise));
}

/// Why a key that a command has is none here.
std::string whyManaged(const std::string& key)
{
  if (key == "checkpoint" || key == "checkpoint-every" || key == "continue")
  {
    return "a scene goes on from checkpoints by itself; before the first section, checkpoint = \"10min\" says how "
           "often "
           "it keeps one";
  }
  return key == "json" || key == "quiet" || key == "overwrite" || key == "stats"
    ? "it is for lamella run itself: lamella run SCENE --" + key
    : "files are not named in a scene; write = [\"" + key + "\"] writes it beside the results";
}

/// Whether a message has this as a word of its own.
bool names(const std::string& message, const std::string& name)
{
  const auto within = [](char letter)
  { return std::isalnum(static_cast<unsigned char>(letter)) != 0 || letter == '-'; };
  for (std::size_t at = message.find(name); at != std::string::npos; at = message.find(name, at + 1))
  {
    const std::size_t end = at + name.size();
    if ((at == 0 || !within(message[at - 1])) && (end == message.size() || !within(message[end])))
      return true;
  }
  return false;
}

/// Whether a message has a text of this value, a key of this table, or the name of a NAME=VALUE, in quotes.
bool quotes(const std::string& message, const Json& value)
{
  const auto quoted = [&](const std::string& text) { return message.find("'" + text + "'") != std::string::npos; };
  if (value.is_string())
  {
    const std::string text = value.get<std::string>();
    return quoted(text) || quoted(text.substr(0, text.find('=')));
  }
  if (!value.is_structured())
    return false;
  return std::ranges::any_of(value.items(),
    [&](const auto& item) { return (value.is_object() && quoted(item.key())) || quotes(message, item.value()); });
}

class Reader
{
public:
  Reader(SceneFile source, const CommandSet& commands)
    : commands_(commands)
  {
    scene_.source = std::move(source);
  }

  Scene operator()()
  {
    readTop();
    for (const SceneSection& section : scene_.source.sections)
      readSection(section);
    shareMaterial();
    finish();
    return std::move(scene_);
  }

private:
  void readTop()
  {
    static const std::vector<std::string> known{ "title", "results", "average-over", "checkpoint" };
    for (const SceneKey& key : scene_.source.keys)
    {
      if (!contains(known, key.name))
      {
        sceneError(key.where, "'" + key.name + "' is no key of a scene",
          suggestion(key.name, known,
            "keys of commands stand below their [section]; before the first there are " + quotedList(known, "and")));
      }
      if (key.name == "average-over")
      {
        scene_.averageGiven = true;
        scene_.averageOver = texts(key);
        continue;
      }
      if (key.name == "checkpoint")
      {
        scene_.checkpoint = secondsBetween(key);
        continue;
      }
      if (!key.value.is_string())
        sceneError(key.where, fmt::format("{} = {} is not a text", key.name, key.value.dump()), "write it in quotes");
      (key.name == "title" ? scene_.title : scene_.results) = key.value.get<std::string>();
    }
  }

  /// 600, "10min", or false for nothing.
  static std::optional<double> secondsBetween(const SceneKey& key)
  {
    // no checkpoint before some time has passed, however short: see io::CheckpointOptions
    constexpr double least = 1e-9;
    if (key.value == false)
      return std::nullopt;
    const std::string text = wordOf(key.value);
    const auto seconds = secondsFrom(toNumber(text) ? text + "s" : text);
    if (key.value.is_boolean() || !seconds)
    {
      sceneError(key.where, fmt::format("checkpoint = {} is no time", key.value.dump()),
        "write seconds, \"30s\", \"10min\" or \"1h\", or false for none");
    }
    return std::max(least, *seconds);
  }

  static std::vector<std::string> texts(const SceneKey& key)
  {
    std::vector<std::string> list;
    for (const Json& item : key.value.is_array() ? key.value : Json::array({ key.value }))
    {
      if (!item.is_string())
      {
        sceneError(key.where, fmt::format("{} = {} is no list of texts", key.name, key.value.dump()),
          "write [\"one\", \"two\"]");
      }
      list.push_back(item.get<std::string>());
    }
    return list;
  }

  void readSection(const SceneSection& section)
  {
    if (section.kind == "sample")
    {
      readSample(section);
    }
    else if (section.kind == "material")
    {
      material_ = &section;
    }
    else if (section.kind == "measure")
    {
      readMeasures(section);
    }
    else if (section.kind == "each" || section.kind == "picture")
    {
      readEach(section);
    }
    else if (portsOf(section.kind) != nullptr && section.kind != "read" && section.kind != "generate" &&
      section.kind != "micrograph" && section.kind != "snapshot")
    {
      SceneStage stage;
      const std::vector<std::string> ways = commands_.namesBelow(section.kind);
      readStage(stage, section, ways.empty() ? section.kind : section.kind + " " + solverOf(section, ways),
        ways.empty() ? std::vector<std::string>{} : std::vector<std::string>{ "solver" });
      scene_.stages.push_back(std::move(stage));
    }
    else
    {
      std::vector<std::string> known{ "sample", "material", "measure", "each", "picture" };
      for (const Ports& ports : allPorts())
        known.emplace_back(ports.command);
      const std::string in = section.kind == "snapshot"
        ? "pictures are [[picture]], or [[each]] with run = \"snapshot\""
        : "a sample is made in [sample], with " + section.kind + " = ...";
      const bool placed = portsOf(section.kind) != nullptr;
      sceneError(section.where, "there is no section [" + section.kind + "]",
        placed ? in : suggestion(section.kind, known, "there are " + quotedList(known, "and")));
    }
  }

  /// Of a command that is one of several, [fit]: which one.
  static std::string solverOf(const SceneSection& section, const std::vector<std::string>& ways)
  {
    const std::string solver = section.text("solver");
    if (!contains(ways, solver))
    {
      const SceneKey* const given = section.find("solver");
      sceneError(given != nullptr ? given->where : section.where,
        given == nullptr ? "[" + section.kind + "] does not say what was measured"
                         : "'" + solver + "' is no solver of [" + section.kind + "]",
        suggestion(solver, ways, "write solver = \"NAME\" with one of " + quotedList(ways)));
    }
    return solver;
  }

  void readSample(const SceneSection& section)
  {
    static const std::vector<std::string> ways{ "file", "generate", "micrograph", "packing" };
    std::vector<std::string> given;
    for (const std::string& way : ways)
      if (section.find(way) != nullptr)
        given.push_back(way);
    for (const SceneKey& key : section.keys)
      if (given.empty() && closest(key.name, ways))
        unknownKey(section, key, ways, "");
    if (given.size() != 1)
    {
      sceneError(given.empty() ? section.where : section.find(given[1])->where,
        given.empty() ? "[sample] does not say what the sample is"
                      : "[sample] has both '" + given[0] + "' and '" + given[1] + "'",
        "give one of file = \"NAME\", generate = \"softwood\", micrograph = \"NAME\" and packing = true");
    }
    const std::string& way = given.front();
    SceneStage stage;
    std::string words = way == "file" ? "read" : way;
    if (way == "packing")
    {
      const Json& value = section.find(way)->value;
      if (!value.is_boolean() || !value.get<bool>())
      {
        sceneError(section.find(way)->where, "packing = " + value.dump(),
          "write packing = true; grains of your own are read with read = \"grains.csv\"");
      }
    }
    else if (way == "generate")
    {
      const std::string kind = section.text(way);
      const std::vector<std::string> kinds = commands_.namesBelow("generate");
      if (!contains(kinds, kind))
      {
        sceneError(section.find(way)->where, "'" + kind + "' is no sample that is generated",
          suggestion(kind, kinds, "there are " + quotedList(kinds, "and")));
      }
      words += " " + kind;
    }
    else
    {
      const SceneKey& key = *section.find(way);
      const Json list = key.value.is_array() ? key.value : Json::array({ key.value });
      if (!std::ranges::all_of(list, [](const Json& name) { return name.is_string(); }))
        sceneError(key.where, fmt::format("{} = {} is not a text", way, key.value.dump()), "write it in quotes");
      stage.file = SceneOption{ way, section.name + "." + way, key.where, key.value };
    }
    readStage(stage, section, words, { way });
    scene_.stages.insert(scene_.stages.begin(), std::move(stage));
  }

  void readEach(const SceneSection& section)
  {
    SceneEach each;
    const bool picture = section.kind == "picture";
    std::string words = picture ? "snapshot" : section.text("run");
    std::vector<std::string> known;
    for (const Ports& ports : allPorts())
      if (!ports.takes.empty() && !ports.solver && ports.command != std::string("bridges"))
        known.emplace_back(ports.command);
    if (!contains(known, words))
    {
      const SceneKey* const run = section.find("run");
      sceneError(run != nullptr ? run->where : section.where,
        words.empty() ? "[[each]] does not say what runs on each step" : "'" + words + "' does not run on steps",
        suggestion(words, known, "write run = \"NAME\" with one of " + quotedList(known)));
    }
    if (const SceneKey* const write = section.find("write"))
    {
      sceneError(
        write->where, "write is for stages", "what runs on steps fills tables; its pictures are written anyway");
    }
    std::vector<std::string> own{ "run", "every", "movie" };
    readStage(each, section, words, picture ? std::vector<std::string>{} : own);
    if (!picture)
    {
      if (const SceneKey* const every = section.find("every"))
      {
        if (!every->value.is_number_integer() || every->value.get<std::int64_t>() < 1)
        {
          sceneError(every->where, "every = " + every->value.dump() + " is no whole number above 0",
            "every = 10 takes each tenth step");
        }
        each.every = static_cast<int>(every->value.get<std::int64_t>());
      }
      each.movie = section.text("movie");
      if (!each.movie.empty() && (words != "snapshot" || std::filesystem::path(each.movie).extension() != ".ogv"))
      {
        sceneError(section.find("movie")->where, "movie = \"" + each.movie + "\" of " + words,
          "movies are made of run = \"snapshot\" and end in .ogv");
      }
      scene_.each.push_back(std::move(each));
      return;
    }
    scene_.stages.push_back(std::move(each));
  }

  /// @param own keys that have been looked at
  void readStage(SceneStage& stage, const SceneSection& section, const std::string& words, std::vector<std::string> own)
  {
    stage.name = section.name;
    stage.words = words;
    stage.command = split(words, ' ').front();
    stage.where = section.where;
    stage.ports = portsOf(stage.command);
    CLI::App* const app = commands_.find(words);
    stage.of = section.text("of");
    const SceneKey* const of = section.find("of");
    stage.ofWhere = of != nullptr ? of->where : section.where;
    own.insert(own.end(), { "of", "write", "name" });
    if (const SceneKey* const write = section.find("write"))
      readWrite(stage, *write);
    std::vector<std::string> known = keysFor(app, *stage.ports);
    std::vector<std::string> all = known;
    all.insert(all.end(), own.begin(), own.end());
    for (const SceneKey& key : section.keys)
    {
      if (contains(own, key.name))
        continue;
      if (!contains(known, key.name))
      {
        const bool there = app->get_option_no_throw("--" + key.name) != nullptr;
        unknownKey(section, key, all,
          there ? whyManaged(key.name)
                : "see lamella " + (words == "read" ? "run" : words) +
              " --help: its options, without dashes, are the keys");
      }
      stage.options.push_back(optionOf(app, key, section.name));
    }
  }

  static SceneOption optionOf(CLI::App* app, const SceneKey& key, const std::string& section)
  {
    return { key.name, section + "." + key.name, key.where, key.value, shapeOf(app->get_option("--" + key.name)) };
  }

  static void readWrite(SceneStage& stage, const SceneKey& key)
  {
    std::vector<std::string> names;
    for (const Port& port : stage.ports->gives)
      names.emplace_back(port.option);
    if (key.value.is_boolean())
    {
      stage.write = key.value.get<bool>() ? std::vector<std::string>{ names.front() } : std::vector<std::string>{};
      return;
    }
    stage.write = texts(key);
    for (const std::string& name : stage.write)
    {
      if (!contains(names, name))
      {
        sceneError(key.where, "write: " + stage.command + " gives no '" + name + "'",
          suggestion(name, names, "it gives " + quotedList(names, "and")));
      }
    }
  }

  void readMeasures(const SceneSection& section)
  {
    for (const SceneKey& key : section.keys)
    {
      if (!key.value.is_string() || key.value.get<std::string>().find('.') == std::string::npos)
      {
        sceneError(key.where, fmt::format("{} = {} says no number of a stage", key.name, key.value.dump()),
          "write NAME = \"STAGE.KEY\", with a key of what the command prints with --json: strength = "
          "\"fracture.peak_stress\"");
      }
      scene_.measures.push_back({ key.name, key.value.get<std::string>(), key.where });
    }
  }

  /// What [material] says goes to every solver that has such an option, unless its own section says otherwise.
  void shareMaterial()
  {
    if (material_ == nullptr)
      return;
    std::vector<std::string> known;
    for (const SceneKey& key : material_->keys)
    {
      bool taken = false;
      for (SceneStage& stage : scene_.stages)
      {
        CLI::App* const app = commands_.find(stage.words);
        if (!stage.ports->solver)
          continue;
        const std::vector<std::string> own = keysFor(app, *stage.ports);
        known.insert(known.end(), own.begin(), own.end());
        if (contains(own, key.name))
        {
          taken = true;
          if (std::ranges::find(stage.options, key.name, &SceneOption::name) == stage.options.end())
            stage.options.push_back(optionOf(app, key, "material"));
        }
      }
      if (!taken)
        unknownKey(*material_, key, known, "no solver of this scene has such an option");
    }
  }

  void finish()
  {
    if (scene_.stages.empty() || !scene_.stages.front().ports->takes.empty())
    {
      sceneError(std::filesystem::path(scene_.source.file).filename().string(), "there is no [sample]",
        "say what the sample is: [sample] with file = \"NAME\", generate = \"softwood\", micrograph = \"NAME\" or "
        "packing = true");
    }
    std::vector<std::string> names;
    for (const SceneStage& stage : scene_.stages)
      names.push_back(stage.name);
    const auto check = [&](const std::string& name, const std::string& where, const char* what)
    {
      if (!contains(names, name))
        sceneError(where, fmt::format("{} '{}' is no stage of this scene", what, name),
          suggestion(name, names, "there are " + quotedList(names, "and")));
    };
    for (const SceneMeasure& measure : scene_.measures)
      check(split(measure.path, '.').front(), measure.where, "measure:");
    for (const SceneEach& each : scene_.each)
      if (!each.of.empty())
        check(split(each.of, ':').front(), each.ofWhere, "of:");
    for (const SceneStage& stage : scene_.stages)
      if (!stage.of.empty())
        check(split(stage.of, ':').front(), stage.ofWhere, "of:");
  }

  const CommandSet& commands_;
  Scene scene_;
  const SceneSection* material_ = nullptr;
};

} // namespace

CommandSet::CommandSet()
  : root_(std::make_unique<CLI::App>("", "lamella"))
  , commands_(addCommands(*root_))
{
  commands_.push_back(readCommand(*root_));
}

CLI::App* CommandSet::find(const std::string& words) const
{
  CLI::App* app = root_.get();
  for (const std::string& word : split(words, ' '))
  {
    const auto found = app->get_subcommands([&](const CLI::App* below) { return below->get_name() == word; });
    if (found.empty())
      return nullptr;
    app = found.front();
  }
  return app;
}

std::vector<std::string> CommandSet::namesBelow(const std::string& words) const
{
  std::vector<std::string> names;
  for (const CLI::App* app : find(words)->get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(app->get_name());
  return names;
}

Shape shapeOf(const CLI::Option* option)
{
  if (option->get_items_expected_max() == 0)
    return Shape::Flag;
  const std::string type = option->get_type_name();
  if (option->get_expected_max() > 1)
    return type.find('=') != std::string::npos ? Shape::Pairs : Shape::List;
  return type.find(',') != std::string::npos || type == "LIST" ? Shape::Tuple : Shape::Single;
}

std::string lineOf(const SceneStage& stage, const std::string& message)
{
  // How sure it is: a name with dashes, what the message begins with, a value in quotes, a table that it speaks of.
  std::string line;
  std::pair<int, std::size_t> best{ 0, 0 };
  for (const SceneOption& option : stage.options)
  {
    std::string name = option.name;
    std::replace(name.begin(), name.end(), '-', ' ');
    const int sure = names(message, "--" + option.name)      ? 4
      : message.starts_with(name + " ")                      ? 3
      : quotes(message, option.value)                        ? 2
      : option.shape == Shape::Pairs && names(message, name) ? 1
                                                             : 0;
    if (sure > 0 && std::pair(sure, name.size()) > best) // max-strain before strain
    {
      best = { sure, name.size() };
      line = option.where;
    }
  }
  return line;
}

Scene understand(SceneFile source, const CommandSet& commands)
{
  return Reader(std::move(source), commands)();
}

} // namespace lamella::cli
