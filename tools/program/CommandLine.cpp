#include "program/CommandLine.h"

#include "session/Text.h"

#include <CLI/Config.hpp>

#include <algorithm>
#include <optional>

namespace lamella::cli
{

CLI::App* innermost(CLI::App* app)
{
  for (CLI::App* command : app->get_subcommands())
    return innermost(command);
  return app;
}

std::vector<std::string> optionNames(const CLI::App* app)
{
  std::vector<std::string> names;
  // Words of the version before are in no group, and not told.
  for (const CLI::Option* option : app->get_options([](const CLI::Option* one) { return !one->get_group().empty(); }))
  {
    for (const std::string& name : option->get_lnames())
      names.push_back("--" + name);
    for (const std::string& name : option->get_snames())
      names.push_back("-" + name);
  }
  return names;
}

namespace
{

std::string fullName(const CLI::App* app)
{
  return app->get_parent() == nullptr ? app->get_name() : fullName(app->get_parent()) + " " + app->get_name();
}

std::vector<std::string> commandNames(const CLI::App* app)
{
  std::vector<std::string> names;
  for (const CLI::App* command : app->get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  return names;
}

/// Which other sub-command has this option?
std::optional<std::string> ownerOf(const CLI::App* app, const std::string& option)
{
  const auto names = optionNames(app);
  if (app->get_parent() != nullptr && std::find(names.begin(), names.end(), option) != names.end())
    return fullName(app);
  for (const CLI::App* command : app->get_subcommands([](const CLI::App*) { return true; }))
    if (auto owner = ownerOf(command, option))
      return owner;
  return std::nullopt;
}

/// What is wrong with the command line, and what was probably meant. The parser's own messages do not tell the latter.
ParameterError explain(CLI::App& root, const CLI::ParseError& error)
{
  CLI::App* app = innermost(&root);
  const std::string help = "see " + fullName(app) + " --help";
  const std::vector<std::string> commands = commandNames(app);
  for (const std::string& word : root.remaining(true))
  {
    if (word.size() > 1 && word[0] == '-')
    {
      const std::string name = word.substr(0, word.find('='));
      std::string otherwise = help;
      if (const auto owner = ownerOf(&root, name))
      {
        otherwise = "it is an option of " + *owner;
        return ParameterError("'" + name + "' is not an option of " + fullName(app), otherwise);
      }
      return ParameterError(
        "'" + name + "' is not an option of " + fullName(app), suggestion(name, optionNames(app), otherwise));
    }
    if (!commands.empty())
    {
      return ParameterError("'" + word + "' is not a command of " + fullName(app),
        suggestion(word, commands, "there are " + quotedList(commands, "and")));
    }
    return ParameterError("'" + word + "' is one word too many for " + fullName(app), help);
  }
  if (dynamic_cast<const CLI::RequiredError*>(&error) != nullptr)
  {
    if (!commands.empty())
      return ParameterError("which command?", "there are " + quotedList(commands, "and") + "; " + help);
    for (const CLI::Option* option : app->get_options())
    {
      if (option->get_required() && option->count() == 0)
      {
        const bool positional = option->get_positional();
        const std::string name = positional ? option->get_name(true)
          : option->get_snames().empty()    ? "--" + option->get_lnames().front()
                                            : "-" + option->get_snames().front();
        return ParameterError(
          name + " is missing", (positional ? "" : "add " + name + " " + option->get_type_name() + "; ") + help);
      }
    }
  }
  if (dynamic_cast<const CLI::ConversionError*>(&error) != nullptr)
  {
    // "Could not convert: --refine = 1.5"
    const std::string text = error.what();
    const std::size_t name = text.find("--");
    const std::size_t equals = text.find(" = ");
    if (name != std::string::npos && equals != std::string::npos && name < equals)
    {
      const std::string value = text.substr(equals + 3);
      return ParameterError(
        text.substr(name, equals - name) + " '" + value + "' is not a " + (toNumber(value) ? "whole number" : "number"),
        help);
    }
  }
  std::string message = error.what();
  std::replace(message.begin(), message.end(), '\n', ' ');
  return ParameterError(message, help);
}

void addOverwrite(CLI::App& command, CommonOptions& options)
{
  command.add_flag("--overwrite", options.overwrite, "Replace a file that exists")->group("Output");
}

} // namespace

std::vector<Command> addCommands(CLI::App& root)
{
  return { generateCommand(root), diffusionCommand(root), transientCommand(root), fluxMapCommand(root),
    packingCommand(root), bridgesCommand(root), equilibriumCommand(root), fractureCommand(root), dynamicsCommand(root),
    compressionCommand(root), stiffnessCommand(root), bondStiffnessCommand(root), poreFloodFillCommand(root),
    micrographCommand(root), stressPdfCommand(root), crackPathCommand(root), compressionCurveCommand(root),
    collapseMapCommand(root), fitCommand(root), snapshotCommand(root) };
}

bool parseWords(CLI::App& root, const std::vector<std::string>& words)
{
  try
  {
    std::vector<std::string> reversed(words.rbegin(), words.rend()); // the parser wants them last to first
    root.parse(reversed);
  }
  catch (const CLI::CallForHelp&)
  {
    return false;
  }
  catch (const CLI::ParseError& error)
  {
    throw explain(root, error);
  }
  return true;
}

void addReportOptions(CLI::App& command, CommonOptions& options)
{
  command.add_flag("--json", options.json, "Print one JSON object to standard output, and nothing else")
    ->group("Report");
  command.add_flag("--quiet", options.quiet, "No progress bar and no table")->group("Report");
}

CLI::Option* addResultFile(
  CLI::App& command, const char* names, std::string& file, const std::string& description, const char* type)
{
  return command.add_option(names, file, description)->type_name(type)->group("Output");
}

void addResultOptions(CLI::App& command, CommonOptions& options)
{
  addOverwrite(command, options);
  addReportOptions(command, options);
}

CLI::Option* addOutputOptions(
  CLI::App& command, std::string& output, CommonOptions& options, const std::string& description)
{
  CLI::Option* option = addResultFile(command, "-o,--output", output, description, "FILE");
  addOverwrite(command, options);
  return option;
}

void addExamples(CLI::App& command, const std::vector<std::string>& examples)
{
  std::string text = "\nExamples:\n";
  for (const std::string& example : examples)
    text += "  " + example + "\n";
  command.footer(text);
}

} // namespace lamella::cli
