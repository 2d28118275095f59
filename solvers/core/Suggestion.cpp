#include "core/Suggestion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

namespace lamella
{
namespace
{

/// Optimal string alignment distance: Levenshtein's, with swaps of neighbours as one edit.
std::size_t editDistance(std::string_view a, std::string_view b)
{
  std::vector<std::size_t> before2(b.size() + 1);
  std::vector<std::size_t> before(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(before.begin(), before.end(), std::size_t{ 0 });
  for (std::size_t i = 1; i <= a.size(); ++i)
  {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j)
    {
      row[j] = std::min({ before[j] + 1, row[j - 1] + 1, before[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1) });
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before2[j - 2] + 1);
    }
    std::swap(before2, before);
    std::swap(before, row);
  }
  return before[b.size()];
}

} // namespace

std::optional<std::string> closest(std::string_view word, std::span<const std::string> candidates)
{
  std::optional<std::string> best;
  std::size_t bestDistance = 0;
  for (const std::string& candidate : candidates)
  {
    const std::size_t distance = editDistance(word, candidate);
    const std::size_t allowed = std::max<std::size_t>(1, (std::max(word.size(), candidate.size()) + 1) / 3);
    const bool prefix = word.size() >= 3 && candidate.starts_with(word);
    if (((distance <= allowed && distance < word.size()) || prefix) && (!best || distance < bestDistance))
    {
      best = candidate;
      bestDistance = distance;
    }
  }
  return best;
}

std::string suggestion(std::string_view word, std::span<const std::string> candidates, std::string_view otherwise)
{
  if (const auto found = closest(word, candidates))
    return "did you mean '" + *found + "'?";
  return std::string(otherwise);
}

std::string quotedList(std::span<const std::string> words, std::string_view last)
{
  constexpr std::size_t most = 16;
  std::string text;
  for (std::size_t i = 0; i < std::min(most, words.size()); ++i)
  {
    const std::string between = i == 0 ? "" : i + 1 < words.size() ? ", " : fmt::format(" {} ", last);
    text += fmt::format("{}'{}'", between, words[i]);
  }
  return words.size() > most ? fmt::format("{} {} {} more", text, last, words.size() - most) : text;
}

} // namespace lamella
