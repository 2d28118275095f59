#include "lattice/PhaseNames.h"

#include "core/Lower.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace lamella
{

namespace
{

/// The number of the thing that a name is a word for; 0 for a name of its own.
int thing(const std::string& name)
{
  struct Word
  {
    const char* name;
    int thing;
  };
  static constexpr std::array<Word, 8> words{ { { "void", 1 }, { "pore", 1 }, { "lumen", 1 }, { "air", 1 },
    { "wall", 2 }, { "secondary wall", 2 }, { "middle lamella", 3 }, { "lamella", 3 } } };
  const auto* const found = std::find_if(words.begin(), words.end(), [&](const Word& w) { return name == w.name; });
  return found == words.end() ? 0 : found->thing;
}

} // namespace

bool isVoidName(std::string name)
{
  name = lower(name);
  return name == "void" || name == "pore" || name == "lumen" || name == "air" || name == "0";
}

std::optional<std::size_t> phaseMeant(std::span<const std::string> names, const std::string& said)
{
  const auto same = std::find(names.begin(), names.end(), said);
  if (same != names.end())
    return static_cast<std::size_t>(same - names.begin());
  const int meant = thing(said);
  const auto fits = [&](const std::string& name) { return thing(name) == meant; };
  const auto first = std::find_if(names.begin(), names.end(), fits);
  if (meant == 0 || first == names.end() || std::find_if(first + 1, names.end(), fits) != names.end())
    return std::nullopt;
  return static_cast<std::size_t>(first - names.begin());
}

} // namespace lamella
