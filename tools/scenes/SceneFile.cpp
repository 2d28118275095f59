#include "scenes/SceneFile.h"

#include "files/GridFile.h"
#include "session/Text.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <toml++/toml.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

namespace lamella::cli
{

namespace
{

constexpr std::size_t largest = std::size_t{ 16 } << 20; // of a scene

std::string place(const std::string& file, const toml::source_region& source)
{
  return file.empty() ? "the command line" : fmt::format("{}:{}", file, source.begin.line);
}

/// @throws ParameterError for dates and times
Json toJson(const toml::node& node, const std::string& file)
{
  switch (node.type())
  {
    case toml::node_type::string:
      return node.as_string()->get();
    case toml::node_type::integer:
      return node.as_integer()->get();
    case toml::node_type::floating_point:
      return node.as_floating_point()->get();
    case toml::node_type::boolean:
      return node.as_boolean()->get();
    case toml::node_type::array:
    {
      Json list = Json::array();
      for (const toml::node& item : *node.as_array())
        list.push_back(toJson(item, file));
      return list;
    }
    case toml::node_type::table:
    {
      // toml++ sorts keys; the file's order is the order of sweeps
      std::vector<std::pair<toml::source_position, std::pair<std::string, Json>>> entries;
      for (const auto& [key, value] : *node.as_table())
        entries.push_back({ value.source().begin, { std::string(key.str()), toJson(value, file) } });
      std::stable_sort(entries.begin(), entries.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
      Json table = Json::object();
      for (auto& [position, entry] : entries)
        table[entry.first] = std::move(entry.second);
      return table;
    }
    default:
      sceneError(place(file, node.source()), "dates and times mean nothing here", "write it in quotes");
  }
}

/// Is it a section or a list of them?
bool isSection(const toml::node& node)
{
  return node.is_table() || node.is_array_of_tables();
}

/// The keys of a table in the order of the file; of the whole file those that are no sections.
std::vector<SceneKey> keysOf(const toml::table& table, const std::string& file, bool whole = false)
{
  std::vector<std::pair<toml::source_position, SceneKey>> keys;
  for (const auto& [key, value] : table)
  {
    if (whole && isSection(value))
      continue;
    // of `[fracture.young]` the value begins at its first key; the name is in the line of the header
    keys.push_back(
      { value.source().begin, { std::string(key.str()), toJson(value, file), place(file, key.source()) } });
  }
  std::stable_sort(keys.begin(), keys.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<SceneKey> sorted;
  for (auto& [position, key] : keys)
    sorted.push_back(std::move(key));
  return sorted;
}

SceneSection sectionOf(
  const std::string& kind, const std::string& name, const toml::table& table, const std::string& file)
{
  SceneSection section{ kind, name, place(file, table.source()), keysOf(table, file) };
  if (const SceneKey* const given = section.find("name"))
  {
    section.name = section.text("name");
    if (section.name.empty() || section.name.find_first_of(".:/ ") != std::string::npos)
    {
      sceneError(given->where, "name '" + section.name + "' cannot be a name of files",
        "write it without blanks, dots, colons and slashes");
    }
  }
  return section;
}

/// One value as the command line gives it.
Json valueOf(const std::string& text)
{
  try
  {
    const toml::table parsed = toml::parse("value = " + text);
    if (parsed.size() == 1)
      return toJson(*parsed.get("value"), "");
  }
  catch (const toml::parse_error&) // a word without quotes
  {
  }
  return text;
}

} // namespace

void sceneError(const std::string& where, const std::string& what, const std::string& hint)
{
  throw ParameterError(where + ": " + what, hint);
}

const SceneKey* SceneSection::find(const std::string& key) const
{
  const auto found = std::ranges::find(keys, key, &SceneKey::name);
  return found == keys.end() ? nullptr : &*found;
}

std::string SceneSection::text(const std::string& key) const
{
  const SceneKey* const found = find(key);
  if (found == nullptr)
    return "";
  if (!found->value.is_string())
    sceneError(found->where, fmt::format("{} = {} is not a text", key, found->value.dump()), "write it in quotes");
  return found->value.get<std::string>();
}

SceneFile readSceneFile(const std::string& path)
{
  requireFile(path);
  std::error_code ignored;
  if (std::filesystem::file_size(path, ignored) > largest)
    throw InputError("'" + path + "' is too large to be a scene", "a scene is a text of some lines, in TOML");
  std::ifstream stream(path, std::ios::binary);
  SceneFile scene;
  scene.file = path;
  scene.text.assign(std::istreambuf_iterator<char>(stream), {});
  const std::string file = std::filesystem::path(path).filename().string();
  toml::table root;
  try
  {
    root = toml::parse(scene.text);
  }
  catch (const toml::parse_error& error)
  {
    std::string what(error.description());
    std::replace(what.begin(), what.end(), '\n', ' ');
    sceneError(place(file, error.source()), what, "scenes are TOML: key = value, texts in quotes, [section]");
  }
  std::vector<std::pair<toml::source_position, SceneSection>> sections;
  for (const auto& [key, node] : root)
  {
    const std::string kind(key.str());
    if (const toml::table* const table = node.as_table(); table != nullptr)
    {
      sections.push_back({ key.source().begin, sectionOf(kind, kind, *table, file) });
    }
    else if (node.is_array_of_tables())
    {
      int index = 0;
      for (const toml::node& item : *node.as_array())
      {
        sections.push_back(
          { item.source().begin, sectionOf(kind, fmt::format("{}.{}", kind, index++), *item.as_table(), file) });
      }
    }
  }
  std::stable_sort(sections.begin(), sections.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  scene.keys = keysOf(root, file, true);
  std::map<std::string, std::string> names;
  for (auto& [position, section] : sections)
  {
    if (const auto [at, added] = names.try_emplace(section.name, section.where); !added)
    {
      sceneError(section.where, "there are two sections called '" + section.name + "'",
        "the other is at " + at->second + "; give one of them another name");
    }
    scene.sections.push_back(std::move(section));
  }
  if (scene.sections.empty())
  {
    throw InputError("'" + path + "' holds no section",
      "a scene says what the sample is and what is done with it: [sample], [diffusion] ...; see lamella run --help");
  }
  return scene;
}

void setKey(SceneFile& scene, const std::string& path, const std::string& value)
{
  const std::string where = "the command line";
  std::vector<std::string> parts = split(path, '.');
  const Json given = valueOf(value);
  const auto set = [&](std::vector<SceneKey>& keys, const std::string& name) -> SceneKey&
  {
    const auto found = std::ranges::find(keys, name, &SceneKey::name);
    SceneKey& key = found == keys.end() ? keys.emplace_back() : *found;
    key.name = name;
    key.where = where;
    return key;
  };
  if (parts.size() == 1)
  {
    set(scene.keys, path).value = given;
    return;
  }
  auto section = scene.sections.end();
  std::size_t used = 1;
  if (parts.size() > 2) // "each.0.every"
  {
    section = std::ranges::find(scene.sections, parts[0] + "." + parts[1], &SceneSection::name);
    used = 2;
  }
  if (section == scene.sections.end())
  {
    section = std::ranges::find(scene.sections, parts[0], &SceneSection::name);
    used = 1;
  }
  if (section == scene.sections.end())
  {
    std::vector<std::string> names;
    for (const SceneSection& each : scene.sections)
      names.push_back(each.name);
    throw ParameterError("'" + path + "': the scene has no section '" + parts[0] + "'",
      suggestion(parts[0], names, "it has " + quotedList(names, "and")));
  }
  SceneKey& key = set(section->keys, parts[used]);
  std::string rest;
  for (std::size_t i = used + 1; i < parts.size(); ++i)
    rest += (rest.empty() ? "" : ".") + parts[i];
  if (rest.empty())
  {
    key.value = given;
    return;
  }
  if (!key.value.is_object())
    key.value = Json::object();
  key.value[rest] = given;
}

std::string wordOf(const Json& value)
{
  if (value.is_string())
    return value.get<std::string>();
  if (value.is_number_float())
    return fmt::format("{}", value.get<double>());
  return value.dump();
}

} // namespace lamella::cli
