#pragma once

#include "scenes/Ports.h"
#include "scenes/SceneFile.h"

#include "program/Commands.h"

#include <CLI/App.hpp>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lamella::cli
{

/// All commands, for a look at their options. Each run gets commands of its own.
class CommandSet
{
public:
  CommandSet();
  /// By its words: "fracture", "generate softwood". Null where there is none such.
  [[nodiscard]] CLI::App* find(const std::string& words) const;
  /// The names of those below: of all commands, or of a command's own.
  [[nodiscard]] std::vector<std::string> namesBelow(const std::string& words) const;
  [[nodiscard]] CLI::App& root() const { return *root_; }
  [[nodiscard]] const std::vector<Command>& commands() const { return commands_; }

private:
  std::unique_ptr<CLI::App> root_;
  std::vector<Command> commands_;
};

/// Reads a sample from a file: what [sample] with `file` is. Only scenes have it.
[[nodiscard]] Command readCommand(CLI::App& root);

/// How many values an option takes.
enum class Shape
{
  Flag,   ///< none: true or false in a scene
  Single, ///< one
  Tuple,  ///< one text of several with commas: a list of a scene becomes that
  List,   ///< any number, each a word
  Pairs   ///< any number of KEY=VALUE: a table of a scene becomes that
};
[[nodiscard]] Shape shapeOf(const CLI::Option* option);

/// A key of a scene that is an option of a command.
struct SceneOption
{
  std::string name;  ///< long, without dashes
  std::string path;  ///< "fracture.horizon"; the same for all stages that [material] tells
  std::string where; ///< "scene.toml:12"
  Json value;        ///< sweeps still in it
  Shape shape = Shape::Single;
};

/// A command that a scene runs.
struct SceneStage
{
  std::string name;                ///< "sample", "fracture"
  std::string command;             ///< "generate"
  std::string words;               ///< "generate softwood"
  std::optional<SceneOption> file; ///< of the user: what [sample] names, sweeps still in it; or none
  std::string of;                  ///< stage that gives the input, perhaps ":output"; empty: the last that fits
  std::string ofWhere;             ///< where that stands; the section where it does not
  std::vector<std::string> write;  ///< options of outputs that are written
  std::vector<SceneOption> options;
  std::string where;
  const Ports* ports = nullptr;
};

/// The line of the key that a message is about: the option that it names, or whose value it quotes. Empty: none of
/// them.
[[nodiscard]] std::string lineOf(const SceneStage& stage, const std::string& message);

/// A command that runs on each state of a stage.
struct SceneEach : SceneStage
{
  int every = 1;
  std::string movie; ///< of pictures: .ogv, or empty
};

struct SceneMeasure
{
  std::string name; ///< of the column
  std::string path; ///< "fracture.peak_stress"
  std::string where;
};

/// A scene whose words are known.
struct Scene
{
  SceneFile source;
  std::string title;
  std::string results;                  ///< folder
  std::vector<std::string> averageOver; ///< keys over which samples are averaged
  bool averageGiven = false;
  std::optional<double> checkpoint = 60; ///< wall time between two of a solver [s]; none: no checkpoints
  std::vector<SceneStage> stages;        ///< in the order in which they run
  std::vector<SceneEach> each;
  std::vector<SceneMeasure> measures; ///< none: all numbers
};

/// @throws ParameterError with file and line for what is not known, "did you mean" for what is close
[[nodiscard]] Scene understand(SceneFile source, const CommandSet& commands);

} // namespace lamella::cli
