#pragma once

#include "vtkObject.h"

#include <limits>
#include <map>
#include <string>

/// What objects list, by name or in order: they are modified where it changes. Not installed.
namespace lamella
{

/// An empty name is ignored: an empty row in a panel.
template <typename Value>
void setNamed(vtkObject* object, std::map<std::string, Value>& table, const char* name, const Value& value)
{
  if (name == nullptr || *name == '\0')
    return;
  const auto [entry, added] = table.try_emplace(name, value);
  if (!added && entry->second == value)
    return;
  entry->second = value;
  object->Modified();
}

/// NaN where nothing has that name.
[[nodiscard]] inline double named(const std::map<std::string, double>& table, const char* name)
{
  const auto entry = table.find(name != nullptr ? name : "");
  return entry != table.end() ? entry->second : std::numeric_limits<double>::quiet_NaN();
}

template <typename List>
void removeAll(vtkObject* object, List& list)
{
  if (list.empty())
    return;
  list.clear();
  object->Modified();
}

} // namespace lamella
