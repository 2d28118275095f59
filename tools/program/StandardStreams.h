#pragma once

#include "session/Session.h"

#include "core/PartFile.h"

#include <CLI/App.hpp>

#include <optional>

namespace lamella::cli
{

/// `-` among the words of a command, which are read already: standard input where a sample is read, standard output
/// where a result is written (OutputFile::isStandardOutput()).
///
/// Readers go back and forth in a file: standard input becomes one, in the folder for temporary files, with the ending
/// that its first bytes tell. It goes away with this object.
class StandardStreams
{
public:
  /// @throws ParameterError where `-` can be neither, or two want the same; InputError where nothing comes, from a
  /// terminal, or what has no first bytes that are known; OutputError; Cancelled
  StandardStreams(Session& session, CLI::App& command);

private:
  std::optional<PartFile> input_; ///< of rank 0
};

} // namespace lamella::cli
