#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

/// Telling people what they probably meant.
namespace lamella
{

/// The candidate that is fewest edits (insert, delete, replace, swap of neighbours) away from `word`, where that is few
/// enough to be a slip: at most a third of its letters, and at least one letter right.
[[nodiscard]] std::optional<std::string> closest(std::string_view word, std::span<const std::string> candidates);

/// "did you mean 'X'?" where something is close, else `otherwise`.
[[nodiscard]] std::string suggestion(
  std::string_view word, std::span<const std::string> candidates, std::string_view otherwise);

/// 'a', 'b' or 'c'; of a long list the first 16 and how many there are besides
[[nodiscard]] std::string quotedList(std::span<const std::string> words, std::string_view last = "or");

} // namespace lamella
