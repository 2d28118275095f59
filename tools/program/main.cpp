// lamella: one program, sub-commands. docs/commands/ has a page for each.
#include "files/GridFile.h"
#include "program/CommandLine.h"
#include "program/Help.h"
#include "program/ShellPages.h"
#include "program/StandardStreams.h"
#include "session/QuietThreads.h"
#include "session/Session.h"

#include "io/Provenance.h"
#include "lamella/Version.h"

#include <vtkVersion.h>

#include <CLI/Config.hpp>

#include <algorithm>
#include <memory>
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

int run(Session& session, std::vector<std::string> words)
{
  CLI::App root("Predicts from a picture what a material made of cells or grains will do.", "lamella");
  root.formatter(std::make_shared<HelpFormatter>());
  root.set_help_flag("-h,--help", "Print this help and exit");
  bool version = false;
  root.add_flag("--version", version, "Print version, commit, VTK and MPI, and exit");
  std::string shell;
  root.add_option("--completion", shell, "Print a script that completes words in this shell, and exit")
    ->type_name("bash|zsh|fish");
  bool manual = false;
  root.add_flag("--man", manual, "Print the manual page, for man, and exit");
  bool tables = false;
  root.add_flag("--option-tables", tables, "Print the options of all commands as tables, for the documentation")
    ->group("");
  addExamples(root,
    { "lamella generate softwood -o tissue.png",
      "lamella diffusion tissue.png --conductivity lumen=0.023 --conductivity wall=1 -o heat.vti",
      "lamella snapshot heat_y.vti -o heat.png", "lamella info heat_y.vti" });
  std::vector<Command> commands = addCommands(root);
  commands.push_back(convertCommand(root));
  commands.push_back(runCommand(root));
  commands.push_back(reportCommand(root));
  commands.push_back(infoCommand(root));
  root.require_subcommand(0, 1);

  const std::string commandLine = io::quoteCommand(words);
  words.erase(words.begin());
  if (!parseWords(root, words))
  {
    session.print(root.help()); // that of the command that was typed
    return exitOk;
  }
  if (version)
  {
    session.print(versionText());
    return exitOk;
  }
  if (manual || root.count("--completion") > 0)
  {
    session.print(manual ? manualPage(root) : shellCompletion(root, shell));
    return exitOk;
  }
  if (tables)
  {
    session.print(optionTables(root));
    return exitOk;
  }
  for (const Command& command : commands)
  {
    if (command.app->parsed())
    {
      const StandardStreams streams(session, *innermost(&root));
      command.run(session, commandLine);
      return session.code();
    }
  }
  if (!words.empty())
    throw ParameterError("which command?", "see lamella --help");
  session.print(root.help());
  return exitUsage;
}

} // namespace

} // namespace lamella::cli

int main(int argc, char** argv)
{
  using namespace lamella::cli;
  beginWithQuietThreads(argv);
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
