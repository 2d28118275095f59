#pragma once

#include <CLI/Formatter.hpp>

#include <string>

namespace lamella::cli
{

/// An option as people read it: its names with what they take, and its description with its default.
struct OptionWords
{
  std::string names;
  std::string description;
};

[[nodiscard]] OptionWords optionWords(const CLI::Option& option);

/// The layout of --help: two columns, wrapped at 100, defaults in brackets.
class HelpFormatter : public CLI::Formatter
{
public:
  HelpFormatter();
  [[nodiscard]] std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;
  [[nodiscard]] std::string make_usage(const CLI::App* app, std::string name) const override;
  [[nodiscard]] std::string make_option(const CLI::Option* option, bool positional) const override;
  [[nodiscard]] std::string make_group(
    std::string group, bool positional, std::vector<const CLI::Option*> options) const override;
  [[nodiscard]] std::string make_subcommand(const CLI::App* command) const override;
};

} // namespace lamella::cli
