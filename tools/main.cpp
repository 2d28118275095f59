// lamella: one program, sub-commands. docs/commands/ has a page for each.
#include "Commands.h"
#include "GridFile.h"
#include "Help.h"
#include "Session.h"
#include "Text.h"

#include "io/Provenance.h"
#include "lamella/Version.h"

#include <vtkVersion.h>

#include <CLI/Config.hpp>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lamella::cli
{

namespace
{

std::string versionText()
{
  char library[MPI_MAX_LIBRARY_VERSION_STRING] = {};
  int length = 0;
  MPI_Get_library_version(library, &length); // may be called before MPI_Init
  std::string mpi(library, static_cast<std::size_t>(length));
  mpi.erase(std::min(mpi.size(), mpi.find_first_of(",\n"))); // the rest tells who packaged it
  return std::string("lamella ") + lamella::version() + " (commit " + lamella::commit() + ")\nVTK " +
    vtkVersion::GetVTKVersionFull() + "\nMPI " + mpi + "\n";
}

/// The sub-command that was typed, down to the last one.
CLI::App* innermost(CLI::App* app)
{
  for (CLI::App* command : app->get_subcommands())
  {
    return innermost(command);
  }
  return app;
}

std::string fullName(const CLI::App* app)
{
  return app->get_parent() == nullptr ? app->get_name() : fullName(app->get_parent()) + " " + app->get_name();
}

std::vector<std::string> optionNames(const CLI::App* app)
{
  std::vector<std::string> names;
  for (const CLI::Option* option : app->get_options())
  {
    for (const std::string& name : option->get_lnames())
    {
      names.push_back("--" + name);
    }
    for (const std::string& name : option->get_snames())
    {
      names.push_back("-" + name);
    }
  }
  return names;
}

std::vector<std::string> commandNames(const CLI::App* app)
{
  std::vector<std::string> names;
  for (const CLI::App* command : app->get_subcommands([](const CLI::App*) { return true; }))
  {
    names.push_back(command->get_name());
  }
  return names;
}

/// Which other sub-command has this option?
std::optional<std::string> ownerOf(const CLI::App* app, const std::string& option)
{
  const auto names = optionNames(app);
  if (app->get_parent() != nullptr && std::find(names.begin(), names.end(), option) != names.end())
  {
    return fullName(app);
  }
  for (const CLI::App* command : app->get_subcommands([](const CLI::App*) { return true; }))
  {
    if (auto owner = ownerOf(command, option))
    {
      return owner;
    }
  }
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
    {
      return ParameterError("which command?", "there are " + quotedList(commands, "and") + "; " + help);
    }
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

int run(Session& session, std::vector<std::string> words)
{
  CLI::App root("Predicts from a picture what a material made of cells or grains will do.", "lamella");
  root.formatter(std::make_shared<HelpFormatter>());
  root.set_help_flag("-h,--help", "Print this help and exit");
  bool version = false;
  root.add_flag("--version", version, "Print version, commit, VTK and MPI, and exit");
  addExamples(root,
    { "lamella generate softwood -o tissue.png",
      "lamella diffusion tissue.png --conductivity lumen=0.023 --conductivity wall=1 -o heat.vti",
      "lamella snapshot heat_y.vti -o heat.png", "lamella info heat_y.vti" });
  const std::vector<Command> commands{ generateCommand(root), diffusionCommand(root), transientCommand(root),
    fluxMapCommand(root), packingCommand(root), bridgesCommand(root), equilibriumCommand(root), fractureCommand(root),
    dynamicsCommand(root), compressionCommand(root), stiffnessCommand(root), poreFloodFillCommand(root),
    micrographCommand(root), stressPdfCommand(root), crackPathCommand(root), compressionCurveCommand(root),
    collapseMapCommand(root), snapshotCommand(root), infoCommand(root) };
  root.require_subcommand(0, 1);

  const std::string commandLine = io::quoteCommand(words);
  try
  {
    std::vector<std::string> reversed(words.rbegin(), words.rend() - 1); // the parser wants them last to first
    root.parse(reversed);
  }
  catch (const CLI::CallForHelp&)
  {
    session.print(root.help()); // that of the command that was typed
    return exitOk;
  }
  catch (const CLI::ParseError& error)
  {
    throw explain(root, error);
  }
  if (version)
  {
    session.print(versionText());
    return exitOk;
  }
  for (const Command& command : commands)
  {
    if (command.app->parsed())
    {
      command.run(session, commandLine);
      return exitOk;
    }
  }
  if (words.size() > 1)
  {
    throw ParameterError("which command?", "see lamella --help");
  }
  session.print(root.help());
  return exitUsage;
}

void addOverwrite(CLI::App& command, CommonOptions& options)
{
  command.add_flag("--overwrite", options.overwrite, "Replace a file that exists")->group("Output");
}

} // namespace

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
  {
    text += "  " + example + "\n";
  }
  command.footer(text);
}

} // namespace lamella::cli

int main(int argc, char** argv)
{
  using namespace lamella::cli;
  Session session(argc, argv);
  const VtkMessages messages;
  std::vector<std::string> words{ "lamella" };
  words.insert(words.end(), argv + 1, argv + argc);
  try
  {
    return run(session, std::move(words));
  }
  catch (const FailedElsewhere& error)
  {
    return session.fail(error);
  }
  catch (const std::exception& error)
  {
    return session.fail(error);
  }
}
