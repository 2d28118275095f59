#pragma once

#include <CLI/App.hpp>

#include <string>

/// What shells and `man` want of a program, made from the options themselves.
namespace lamella::cli
{

/// A script that completes commands, options, and values where an option takes one of a few words.
/// @param shell bash, zsh or fish
/// @throws ParameterError another shell
[[nodiscard]] std::string shellCompletion(const CLI::App& root, const std::string& shell);

/// The manual page in roff: every command with its options and examples.
[[nodiscard]] std::string manualPage(const CLI::App& root);

/// A table in Markdown of the options of every command, under its name, but for those that tell the sample: what the
/// pages in docs/commands show (tests/docs/option_tables.py).
[[nodiscard]] std::string optionTables(const CLI::App& root);

} // namespace lamella::cli
