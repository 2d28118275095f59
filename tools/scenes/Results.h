#pragma once

#include "scenes/SceneFile.h"

#include <filesystem>
#include <optional>
#include <string>

namespace lamella::cli
{

/// One for results, with all above it. @throws OutputError
void makeFolder(const std::filesystem::path& folder);

/// The folder of a scene's results. Each sample has a folder of its own in it, named by its key: what is there is
/// finished, and never computed again, whatever the scene that asks for it is called.
class Results
{
public:
  /// @param make whether the folder is made where it is not there, and told what the scene is; one process does
  /// @throws OutputError for a folder that holds other things, or cannot be written
  Results(std::filesystem::path folder, const SceneFile& scene, bool make);

  [[nodiscard]] const std::filesystem::path& folder() const noexcept { return folder_; }
  [[nodiscard]] std::filesystem::path folderOf(const std::string& key) const;

  /// What a finished sample found; nothing where it is not finished.
  [[nodiscard]] std::optional<Json> load(const std::string& key) const;
  /// Whole or not at all. @throws OutputError
  void save(const std::string& key, const Json& record) const;
  /// Why a sample did not come to an end. It is tried again the next time.
  void saveFailure(const std::string& key, const std::string& message, const std::string& hint, int code) const;
  [[nodiscard]] std::optional<Json> failure(const std::string& key) const;

private:
  std::filesystem::path folder_;
};

} // namespace lamella::cli
