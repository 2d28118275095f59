#include "scenes/Results.h"

#include "files/JsonReport.h"
#include "files/Record.h"
#include "session/OutputFile.h"

#include "core/PartFile.h"
#include "io/Provenance.h"

#include <fstream>
#include <iterator>
#include <system_error>

namespace lamella::cli
{

namespace
{

namespace fs = std::filesystem;

constexpr const char* marker = "lamella-results.json";

void writeText(const fs::path& path, const std::string& text)
{
  OutputFile file(path, true);
  file.write(text);
  file.commit();
}

/// Empty, but for what a run leaves that is just beginning or was ended there, or was ended by a full disk: files that
/// are not whole yet, and a folder for samples without any.
bool isNew(const fs::path& folder)
{
  std::error_code failed;
  for (fs::directory_iterator at(folder, failed); !failed && at != fs::directory_iterator(); at.increment(failed))
  {
    std::error_code ignored;
    const bool samples = at->path().filename() == "samples" && at->is_directory(ignored) && !at->is_symlink(ignored) &&
      fs::is_empty(at->path(), ignored);
    if (!samples && !PartFile::isPart(at->path()))
      return fs::exists(folder / marker, ignored); // made meanwhile by another run
  }
  return true;
}

std::optional<Json> readJson(const fs::path& path)
{
  std::ifstream file(path, std::ios::binary);
  if (!file)
    return std::nullopt;
  Json json = Json::parse(std::string(std::istreambuf_iterator<char>(file), {}), nullptr, false);
  return json.is_object() ? std::optional(std::move(json)) : std::nullopt;
}

} // namespace

void makeFolder(const fs::path& folder)
{
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed)
  {
    throw OutputError("cannot make the folder '" + folder.string() + "': " + failed.message(),
      "choose another place with --results FOLDER");
  }
}

Results::Results(fs::path folder, const SceneFile& scene, bool make)
  : folder_(std::move(folder))
{
  if (!make)
    return;
  std::error_code ignored;
  if (fs::exists(folder_, ignored) && !fs::is_directory(folder_, ignored))
    throw OutputError("'" + folder_.string() + "' is a file, not a folder", "choose another one with --results FOLDER");
  const bool ours = fs::exists(folder_ / marker, ignored);
  if (!ours && !isNew(folder_))
  {
    throw OutputError("the folder '" + folder_.string() + "' holds other things than results of lamella run",
      "choose another one with --results FOLDER, or make room");
  }
  makeFolder(folder_);
  if (!ours) // before anything else: without it the folder is nobody's
    writeText(folder_ / marker, dump(Json{ { "format", 1 }, { "program", "lamella" }, { "made", io::timestamp() } }));
  makeFolder(folder_ / "samples");
  writeText(folder_ / "scene.toml", scene.text);
}

fs::path Results::folderOf(const std::string& key) const
{
  return folder_ / "samples" / key;
}

std::optional<Json> Results::load(const std::string& key) const
{
  std::optional<Json> record = readJson(folderOf(key) / "record.json");
  return record && record->value("key", "") == key && record->contains("stages") ? record : std::nullopt;
}

void Results::save(const std::string& key, const Json& record) const
{
  makeFolder(folderOf(key));
  writeText(folderOf(key) / "record.json", dump(record));
  std::error_code ignored;
  fs::remove(folderOf(key) / "failure.json", ignored);
}

void Results::saveFailure(const std::string& key, const std::string& message, const std::string& hint, int code) const
{
  makeFolder(folderOf(key));
  writeText(folderOf(key) / "failure.json",
    dump(Json{ { "error", message }, { "hint", hint }, { "code", code }, { "date", io::timestamp() } }));
}

std::optional<Json> Results::failure(const std::string& key) const
{
  return readJson(folderOf(key) / "failure.json");
}

} // namespace lamella::cli
