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

} // namespace lamella::cli
