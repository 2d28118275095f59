#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>

namespace lamella
{

/// Whether a phase of this name usually holds nothing: void, pore, lumen, air or 0, in letters of either case.
[[nodiscard]] bool isVoidName(std::string name);

/// Which of these phases somebody means by a name: the one that is called so or, where none is, the only one that is
/// called by another word for the same. Words for the same are void, pore, lumen and air; wall and secondary wall;
/// middle lamella and lamella. So what was typed for a picture fits its outlines, and a file of an earlier version.
/// @return its place in `names`, or nothing
[[nodiscard]] std::optional<std::size_t> phaseMeant(std::span<const std::string> names, const std::string& said);

/// The entry of a table by names that is meant for phase `id`: its own name wins over another word for it.
template <class Value>
[[nodiscard]] typename std::map<std::string, Value>::const_iterator entryOf(
  const std::map<std::string, Value>& table, std::span<const std::string> names, std::size_t id)
{
  auto found = table.find(names[id]);
  for (auto entry = table.begin(); found == table.end() && entry != table.end(); ++entry)
    found = phaseMeant(names, entry->first) == id ? entry : found;
  return found;
}

} // namespace lamella
