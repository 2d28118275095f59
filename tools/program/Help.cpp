#include "program/Help.h"

#include "session/Text.h"

#include <CLI/App.hpp>

#include <algorithm>
#include <cstddef>
#include <utility>

namespace lamella::cli
{

HelpFormatter::HelpFormatter()
{
  label("Positionals", "Input");
  label("Subcommands", "Commands");
}

namespace
{

constexpr std::size_t column = 30;
constexpr std::size_t lineEnd = 100;

/// Characters as they are seen: UTF-8 continuation bytes take no room.
std::size_t seenWidth(const std::string& text)
{
  return static_cast<std::size_t>(std::count_if(
    text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

/// Name on the left, description wrapped on the right.
std::string entry(const std::string& name, const std::string& description)
{
  std::string text("  ");
  text += name;
  std::size_t at = seenWidth(text);
  if (at + 2 > column)
  {
    text += '\n';
    at = 0;
  }
  text.append(column - at, ' ');
  at = column;
  for (const std::string& word : split(description, ' '))
  {
    if (at > column && at + 1 + seenWidth(word) > lineEnd)
    {
      text.append("\n").append(column, ' ');
      at = column;
    }
    if (at > column)
    {
      text += ' ';
      ++at;
    }
    text += word;
    at += seenWidth(word);
  }
  return text + "\n";
}

} // namespace

std::string HelpFormatter::make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const
{
  std::string text = CLI::Formatter::make_help(app, std::move(name), mode);
  for (std::size_t at = text.find("\n\n\n"); at != std::string::npos; at = text.find("\n\n\n", at))
    text.erase(at, 1);
  while (text.ends_with("\n\n"))
    text.pop_back();
  return text;
}

std::string HelpFormatter::make_usage(const CLI::App* app, std::string name) const
{
  std::string text("\nUsage: ");
  text += name;
  for (const CLI::Option* option : app->get_options([](const CLI::Option* o) { return o->get_positional(); }))
    text.append(" ").append(option->get_name(true));
  text += app->get_subcommands([](const CLI::App*) { return true; }).empty() ? " [options]" : " COMMAND [options]";
  return text + "\n";
}

OptionWords optionWords(const CLI::Option& option)
{
  OptionWords words{ "", option.get_description() };
  const bool positional = option.get_positional();
  if (positional)
  {
    words.names = option.get_name(true);
  }
  else
  {
    for (const std::string& letter : option.get_snames())
      words.names.append(words.names.empty() ? "-" : ", -").append(letter);
    for (const std::string& word : option.get_lnames())
      words.names.append(words.names.empty() ? "--" : ", --").append(word);
    if (option.get_type_size() != 0 && !option.get_type_name().empty())
      words.names.append(" ").append(option.get_type_name());
  }
  if (option.get_required() && !positional)
    words.description += " (needed)";
  if (!option.get_default_str().empty())
    words.description.append(" [").append(option.get_default_str()).append("]");
  return words;
}

std::string HelpFormatter::make_option(const CLI::Option* option, bool /*positional*/) const
{
  const OptionWords words = optionWords(*option);
  return entry(words.names, words.description);
}

std::string HelpFormatter::make_group(std::string group, bool positional, std::vector<const CLI::Option*> options) const
{
  std::string text("\n");
  text.append(group).append(":\n");
  for (const CLI::Option* option : options)
    text += make_option(option, positional);
  return text;
}

std::string HelpFormatter::make_subcommand(const CLI::App* command) const
{
  return entry(command->get_name(), command->get_description());
}

} // namespace lamella::cli
