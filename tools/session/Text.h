#pragma once

#include "core/Parse.h"
#include "core/Suggestion.h"

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

/// Reading what users type, and telling them what they probably meant. Everything throws ParameterError.
namespace lamella::cli
{

/// A length in metres: "0.5e-6", or with a unit: "0.5um", "500nm", "0.0005mm". Positive and finite.
[[nodiscard]] double lengthInMetres(const std::string& option, const std::string& text);

/// A share: "0.4" or "40%".
[[nodiscard]] double share(const std::string& option, const std::string& text);

/// A number above 0. @param hint where it is none @throws ParameterError
[[nodiscard]] double positive(const std::string& option, const std::string& text, const std::string& hint);

/// Refuses --threads that no machine has. @throws ParameterError
void checkThreads(int threads, const char* hint = "give the number of cores to use");

/// "KEY=VALUE" with neither empty.
[[nodiscard]] std::pair<std::string, std::string> keyValue(
  const std::string& option, const std::string& text, const std::string& form);

/// What an option was given that may be written again and again, or once with commas between: "a=1,b=2" is "a=1",
/// "b=2". A comma with no "=" behind it, as in "a=0,5" or "x-=5,free", separates nothing.
[[nodiscard]] std::vector<std::string> listItems(const std::vector<std::string>& texts);

/// The position of `text` among the words an option knows.
[[nodiscard]] std::size_t oneOf(const std::string& option, const std::string& text, std::span<const std::string> words);

/// 123456 as "123 456": counts for people.
[[nodiscard]] std::string grouped(std::int64_t count);

/// The last lines of a report.
[[nodiscard]] std::string wroteText(const std::vector<std::string>& files);

/// "400 × 300" or "200 × 200 × 200".
[[nodiscard]] std::string sizeText(const std::array<std::int64_t, 3>& size, int dimension);

} // namespace lamella::cli
