#include "program/ShellPages.h"

#include "program/CommandLine.h"
#include "program/Help.h"
#include "session/Text.h"

#include "lamella/Version.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <functional>
#include <iterator>
#include <string_view>
#include <vector>

namespace lamella::cli
{

namespace
{

const std::array<std::string, 3> shells{ "bash", "zsh", "fish" };

std::vector<const CLI::App*> commandsOf(const CLI::App& app)
{
  return app.get_subcommands([](const CLI::App*) { return true; });
}

std::vector<std::string> namesOf(const std::vector<const CLI::App*>& commands)
{
  std::vector<std::string> names;
  std::transform(commands.begin(), commands.end(), std::back_inserter(names),
    [](const CLI::App* command) { return command->get_name(); });
  return names;
}

/// Words of the version before are in no group, and not told.
std::vector<const CLI::Option*> shown(const CLI::App& command)
{
  return command.get_options([](const CLI::Option* option) { return !option->get_group().empty(); });
}

/// A cell of a table in Markdown.
std::string cell(const std::string& text)
{
  std::string safe;
  for (const char c : text)
    safe += c == '|' ? "\\|" : std::string(1, c);
  return safe;
}

/// Calls `what` with every command below, and its words after the program's name.
void eachCommand(const CLI::App& app, const std::string& words,
  const std::function<void(const CLI::App& command, const std::string& words)>& what)
{
  for (const CLI::App* command : commandsOf(app))
  {
    const std::string more = words.empty() ? command->get_name() : words + " " + command->get_name();
    what(*command, more);
    eachCommand(*command, more, what);
  }
}

/// The words that an option takes one of, if it is such a one: its type reads x|y|z|all.
std::vector<std::string> choicesOf(const CLI::Option& option)
{
  const std::string type = option.get_type_size() == 0 ? "" : option.get_type_name();
  const bool words = type.find('|') != std::string::npos &&
    std::all_of(type.begin(), type.end(),
      [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '|' || c == '-'; });
  return words ? split(type, '|') : std::vector<std::string>{};
}

std::string bashCompletion(const CLI::App& root)
{
  std::string paths;
  std::string words = fmt::format(
    "    '') words='{} {}' ;;\n", fmt::join(namesOf(commandsOf(root)), " "), fmt::join(optionNames(&root), " "));
  std::string values;
  eachCommand(root, "",
    [&](const CLI::App& command, const std::string& path)
    {
      paths += fmt::format("{}'{}'", paths.empty() ? "" : " | ", path);
      std::vector<std::string> all = namesOf(commandsOf(command));
      const std::vector<std::string> options = optionNames(&command);
      all.insert(all.end(), options.begin(), options.end());
      words += fmt::format("    '{}') words='{}' ;;\n", path, fmt::join(all, " "));
      for (const CLI::Option* option : shown(command))
        for (const std::string& name : choicesOf(*option).empty() ? std::vector<std::string>{} : option->get_lnames())
          values += fmt::format("    '{} --{}') words='{}' ;;\n", path, name, fmt::join(choicesOf(*option), " "));
    });
  constexpr std::string_view text =
    R"(# Completes the words of lamella {0} in bash and zsh: source <(lamella --completion bash)
[[ -z ${{ZSH_VERSION-}} ]] || {{ autoload -U +X bashcompinit && bashcompinit; }}
_lamella() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}} command='' words='' i
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case "${{command:+$command }}${{COMP_WORDS[i]}}" in
      {1}) command="${{command:+$command }}${{COMP_WORDS[i]}}" ;;
    esac
  done
  case $command in
{2}  esac
  case "$command $before" in
{3}  esac
  # shellcheck disable=SC2207 # words have no blanks
  COMPREPLY=($(compgen -W "$words" -- "$word"))
}}
complete -o default -F _lamella lamella
)";
  return fmt::format(text, version(), paths, words, values);
}

std::string fishQuoted(const std::string& text)
{
  std::string quoted("'");
  for (const char c : text)
    quoted += c == '\'' || c == '\\' ? std::string("\\") + c : std::string(1, c);
  return quoted + "'";
}

std::string fishCompletion(const CLI::App& root)
{
  std::string text =
    fmt::format("# Completes the words of lamella {} in fish: lamella --completion fish | source\n", version());
  const auto options = [&text](const CLI::App& command, const std::string& where)
  {
    for (const CLI::Option* option : shown(command))
    {
      if (option->get_positional())
      {
        continue;
      }
      text += "complete -c lamella -n " + fishQuoted(where);
      for (const std::string& letter : option->get_snames())
      {
        text += " -s " + letter;
      }
      for (const std::string& name : option->get_lnames())
      {
        text += " -l " + name;
      }
      text += option->get_type_size() == 0 ? "" : " -r";
      if (const auto choices = choicesOf(*option); !choices.empty())
      {
        text += fmt::format(" -f -a '{}'", fmt::join(choices, " "));
      }
      text += " -d " + fishQuoted(option->get_description()) + "\n";
    }
  };
  const auto commands = [&text](const CLI::App& app, const std::string& where)
  {
    for (const CLI::App* command : commandsOf(app))
    {
      text += fmt::format("complete -c lamella -f -n {} -a {} -d {}\n", fishQuoted(where), command->get_name(),
        fishQuoted(command->get_description()));
    }
  };
  commands(root, "__fish_use_subcommand");
  options(root, "__fish_use_subcommand");
  eachCommand(root, "",
    [&](const CLI::App& command, const std::string& path)
    {
      std::string where;
      for (const std::string& word : split(path, ' '))
        where += (where.empty() ? "" : "; and ") + ("__fish_seen_subcommand_from " + word);
      commands(command, where);
      options(command, where);
    });
  return text;
}

/// Text as roff wants it: hyphens that can be copied, nothing that it takes for a request.
std::string roff(const std::string& text)
{
  std::string safe;
  for (const char c : text)
  {
    const bool lineBegins = safe.empty() || safe.back() == '\n';
    safe += lineBegins && (c == '.' || c == '\'') ? "\\&" : "";
    safe += c == '\\' ? "\\e" : c == '-' ? "\\-" : std::string(1, c);
  }
  return safe;
}

std::string roffOptions(const CLI::App& command)
{
  std::string text;
  for (const CLI::Option* option : shown(command))
  {
    const OptionWords words = optionWords(*option);
    text += ".TP\n.B " + roff(words.names) + "\n" + roff(words.description) + "\n";
  }
  return text;
}

std::string roffExamples(const CLI::App& command)
{
  std::string text = command.get_footer();
  text.erase(0, text.find_first_not_of('\n'));
  return text.empty() ? "" : ".PP\n.EX\n" + roff(text) + ".EE\n";
}

std::string optionRow(const CLI::Option& option)
{
  std::string names;
  for (const std::string& letter : option.get_snames())
    names += (names.empty() ? "`-" : "`, `-") + letter;
  for (const std::string& word : option.get_lnames())
    names += (names.empty() ? "`--" : "`, `--") + word;
  if (option.get_type_size() != 0 && !option.get_type_name().empty())
    names += " " + option.get_type_name();
  return fmt::format("| {}` | {} | {} |\n", cell(names),
    option.get_required() ? "needed" : cell(option.get_default_str()), cell(option.get_description()));
}

} // namespace

std::string shellCompletion(const CLI::App& root, const std::string& shell)
{
  if (shell == "fish")
    return fishCompletion(root);
  if (shell == "bash" || shell == "zsh")
    return bashCompletion(root);
  const std::vector<std::string> known(shells.begin(), shells.end());
  throw ParameterError("--completion '" + shell + "' is not a shell that is known",
    suggestion(shell, known, "it takes bash, zsh or fish"));
}

std::string optionTables(const CLI::App& root)
{
  std::string text;
  eachCommand(root, "",
    [&text](const CLI::App& command, const std::string& path)
    {
      text += "# " + path + "\n";
      std::vector<std::string> groups;
      const auto options = shown(command);
      // What all commands say of the sample that they read stands on a page of its own.
      const bool reads =
        std::any_of(options.begin(), options.end(), [](const CLI::Option* option) { return option->get_positional(); });
      for (const CLI::Option* option : options)
      {
        const std::string& group = option->get_group();
        if (!option->get_positional() && !(reads && group == "Sample") && option->get_name() != "--help" &&
          std::find(groups.begin(), groups.end(), group) == groups.end())
          groups.push_back(group);
      }
      for (const std::string& group : groups)
      {
        text += "## " + group + "\n";
        for (const CLI::Option* option : shown(command))
          text += option->get_group() == group && option->get_name() != "--help" && !option->get_positional()
            ? optionRow(*option)
            : "";
      }
    });
  return text;
}

std::string manualPage(const CLI::App& root)
{
  std::string text =
    fmt::format(".TH LAMELLA 1 \"\" \"lamella {}\"\n.SH NAME\nlamella \\- {}\n.SH SYNOPSIS\n.B lamella\n"
                "COMMAND [options]\n.SH OPTIONS\n",
      version(), roff(root.get_description()));
  text += roffOptions(root) + roffExamples(root) + ".SH COMMANDS\n";
  eachCommand(root, "",
    [&text](const CLI::App& command, const std::string& path)
    {
      text += ".SS lamella " + roff(path) + "\n" + roff(command.get_description()) + "\n";
      text += roffOptions(command) + roffExamples(command);
    });
  return text;
}

} // namespace lamella::cli
