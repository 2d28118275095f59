#pragma once

#include "program/Commands.h"

#include "io/Provenance.h"

#include <nlohmann/json.hpp>

#include <functional>
#include <string>

/// Reports of commands, as one JSON object or as words made from it.
namespace lamella::cli
{

using Json = nlohmann::ordered_json;

/// JSON has no NaN and no infinity.
[[nodiscard]] Json jsonNumber(double value);

[[nodiscard]] std::string dump(const Json& json);

/// Prints the object with the keys of the run at its end, or its words, or nothing, as the options say.
/// @param words made from the object
void printReport(Session& session, const CommonOptions& options, Json json, const io::Provenance& run,
  const std::function<std::string(const Json&)>& words);

} // namespace lamella::cli
