#pragma once

#include "session/Session.h"

#include <CLI/App.hpp>

#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace lamella::cli
{

/// What every sub-command takes.
struct CommonOptions
{
  bool json = false;
  bool quiet = false;
  bool overwrite = false;
};

/// One sub-command: where its options are declared, and what it does. `words` is the command line, for the record.
struct Command
{
  CLI::App* app;
  std::function<void(Session&, const std::string& commandLine)> run;
};

[[nodiscard]] Command generateCommand(CLI::App& root);
[[nodiscard]] Command diffusionCommand(CLI::App& root);
[[nodiscard]] Command fitCommand(CLI::App& root);
[[nodiscard]] Command transientCommand(CLI::App& root);
[[nodiscard]] Command equilibriumCommand(CLI::App& root);
[[nodiscard]] Command dynamicsCommand(CLI::App& root);
[[nodiscard]] Command fractureCommand(CLI::App& root);
[[nodiscard]] Command compressionCommand(CLI::App& root);
[[nodiscard]] Command stiffnessCommand(CLI::App& root);
[[nodiscard]] Command bondStiffnessCommand(CLI::App& root);
[[nodiscard]] Command fluxMapCommand(CLI::App& root);
[[nodiscard]] Command micrographCommand(CLI::App& root);
[[nodiscard]] Command packingCommand(CLI::App& root);
[[nodiscard]] Command bridgesCommand(CLI::App& root);
[[nodiscard]] Command poreFloodFillCommand(CLI::App& root);
[[nodiscard]] Command stressPdfCommand(CLI::App& root);
[[nodiscard]] Command crackPathCommand(CLI::App& root);
[[nodiscard]] Command compressionCurveCommand(CLI::App& root);
[[nodiscard]] Command collapseMapCommand(CLI::App& root);
[[nodiscard]] Command snapshotCommand(CLI::App& root);
[[nodiscard]] Command convertCommand(CLI::App& root);
[[nodiscard]] Command reportCommand(CLI::App& root);
[[nodiscard]] Command infoCommand(CLI::App& root);
[[nodiscard]] Command runCommand(CLI::App& root);

/// An option in a group of the help. One that may be given several times takes one value each time.
/// @param type what its value is called there
template <class Value>
CLI::Option* addOption(
  CLI::App& command, const char* group, const char* names, Value& value, const std::string& text, const char* type)
{
  CLI::Option* const option = command.add_option(names, value, text)->type_name(type)->group(group);
  if constexpr (std::is_same_v<Value, std::vector<std::string>>)
    option->allow_extra_args(false);
  return option;
}

/// --json, --quiet
void addReportOptions(CLI::App& command, CommonOptions& options);
/// -o, --overwrite
CLI::Option* addOutputOptions(
  CLI::App& command, std::string& output, CommonOptions& options, const std::string& description);
/// A file of results to write.
CLI::Option* addResultFile(CLI::App& command, const char* names, std::string& file, const std::string& description,
  const char* type = "FILE.csv");
/// --overwrite, --json, --quiet
void addResultOptions(CLI::App& command, CommonOptions& options);
/// A section at the end of the help.
void addExamples(CLI::App& command, const std::vector<std::string>& examples);

/// A command that all ranks do together.
template <class Options>
[[nodiscard]] Command jointCommand(CLI::App* app, std::shared_ptr<Options> options,
  std::type_identity_t<void (*)(Session&, const Options&, const std::string& commandLine)> run)
{
  return { app,
    [options = std::move(options), run](Session& session, const std::string& line)
    {
      session.setQuiet(options->common.quiet);
      run(session, *options, line);
    } };
}

/// A command that one rank does by itself.
template <class Options>
[[nodiscard]] Command aloneCommand(CLI::App* app, std::shared_ptr<Options> options,
  std::type_identity_t<void (*)(Session&, const Options&, const std::string& commandLine)> run)
{
  return { app,
    [options = std::move(options), run](Session& session, const std::string& line)
    {
      session.setQuiet(options->common.quiet);
      session.onRoot([&] { run(session, *options, line); });
    } };
}

} // namespace lamella::cli
