#pragma once

#include "program/Commands.h"

#include <string>
#include <vector>

/// The words of a command line: what the commands are, how words are read, what was probably meant by those that are
/// not known.
namespace lamella::cli
{

/// Declares the commands that work on data, in the order of the help.
[[nodiscard]] std::vector<Command> addCommands(CLI::App& root);

/// Reads words. @returns whether there is something to do; not when help was asked for
/// @throws ParameterError
[[nodiscard]] bool parseWords(CLI::App& root, const std::vector<std::string>& words);

/// The sub-command that was typed, down to the last one.
[[nodiscard]] CLI::App* innermost(CLI::App* app);

/// The long names of an app's options, with their dashes, and the short ones.
[[nodiscard]] std::vector<std::string> optionNames(const CLI::App* app);

} // namespace lamella::cli
