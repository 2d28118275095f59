#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace lamella::cli
{

using Json = nlohmann::ordered_json;

/// Something that is wrong with the scene itself, and so with all of its samples.
/// @param where "scene.toml:12", or "the command line"
[[noreturn]] void sceneError(const std::string& where, const std::string& what, const std::string& hint);

struct SceneKey
{
  std::string name;
  Json value;        ///< true, number, text, list or table of them
  std::string where; ///< "scene.toml:12", or "the command line"
};

struct SceneSection
{
  std::string kind; ///< as it is called in the file: "fracture", "each"
  std::string name; ///< one of its kind: the same; of several "each.0", or what their key `name` says
  std::string where;
  std::vector<SceneKey> keys;

  /// Null where there is none such.
  [[nodiscard]] const SceneKey* find(const std::string& key) const;
  /// A text; empty where it is not given. @throws ParameterError for anything else
  [[nodiscard]] std::string text(const std::string& key) const;
};

/// A scene as it stands in a file: words and numbers whose meaning is not looked at yet.
struct SceneFile
{
  std::string file;
  std::string text;
  std::vector<SceneKey> keys; ///< before the first section
  std::vector<SceneSection> sections;
};

/// @throws InputError where it cannot be read; ParameterError where it is no TOML, with file and line
[[nodiscard]] SceneFile readSceneFile(const std::string& path);

/// Sets a key as the command line says: "fracture.horizon" or "material.young.wall" or "each.0.every".
/// @param value as TOML; what is none is a text
/// @throws ParameterError for a section that is not there
void setKey(SceneFile& scene, const std::string& path, const std::string& value);

/// Texts, numbers, true and false as a word of a command line.
[[nodiscard]] std::string wordOf(const Json& value);

} // namespace lamella::cli
