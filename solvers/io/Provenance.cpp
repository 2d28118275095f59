#include "io/Provenance.h"

#include "core/Error.h"
#include "lamella/Version.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <limits>
#include <system_error>

namespace lamella::io
{

namespace fs = std::filesystem;

std::string timestamp()
{
  std::time_t now = std::time(nullptr);
  // nothing here changes the environment
  if (const char* epoch = std::getenv("SOURCE_DATE_EPOCH"); // NOLINT(concurrency-mt-unsafe)
      epoch != nullptr && *epoch != '\0')
  {
    char* end = nullptr;
    const long long value = std::strtoll(epoch, &end, 10);
    if (*end == '\0' && value >= 0)
      now = static_cast<std::time_t>(value);
  }
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

Provenance makeProvenance(std::string command)
{
  Provenance provenance;
  provenance.version = lamella::version();
  provenance.commit = lamella::commit();
  provenance.command = std::move(command);
  provenance.date = timestamp();
  return provenance;
}

namespace
{

[[noreturn]] void unreadable(const fs::path& path)
{
  throw InputError("cannot read '" + path.string() + "': " + std::generic_category().message(errno),
    "check the path and its permissions");
}

/// Feeds a file, or its next `most` bytes, to the hash and returns how many they were.
std::uint64_t hashBytes(std::ifstream& file, const fs::path& path, Sha256& hash,
  std::uint64_t most = std::numeric_limits<std::uint64_t>::max())
{
  std::vector<char> buffer(std::size_t{ 1 } << 18);
  std::uint64_t bytes = 0;
  while (file && bytes < most)
  {
    file.read(buffer.data(), static_cast<std::streamsize>(std::min<std::uint64_t>(buffer.size(), most - bytes)));
    const auto got = static_cast<std::size_t>(file.gcount());
    hash.update(std::as_bytes(std::span(buffer.data(), got)));
    bytes += got;
  }
  if (!file && !file.eof())
    unreadable(path);
  return bytes;
}

/// Feeds a file to the hash, both ends of it where it is a large one, and returns its size.
std::uint64_t hashFile(const fs::path& path, Sha256& hash, bool ends)
{
  std::ifstream file(path, std::ios::binary);
  if (!ends)
    return hashBytes(file, path, hash);
  (void)hashBytes(file, path, hash, hashedEnd);
  if (!file.seekg(-static_cast<std::streamoff>(hashedEnd), std::ios::end))
    unreadable(path);
  (void)hashBytes(file, path, hash);
  std::error_code failed;
  return fs::file_size(path, failed);
}

} // namespace

InputFile describeInput(const fs::path& path)
{
  std::vector<fs::path> files;
  std::error_code failed;
  if (fs::is_directory(path, failed))
  {
    for (const fs::directory_entry& entry : fs::directory_iterator(path, failed))
      if (entry.is_regular_file(failed))
        files.push_back(entry.path());
    std::sort(files.begin(), files.end());
  }
  else
  {
    files.push_back(path);
  }
  InputFile input;
  input.name = path.string();
  input.ends = files.size() == 1 && fs::is_regular_file(path, failed) && fs::file_size(path, failed) > wholeHashLimit;
  Sha256 hash;
  for (const fs::path& file : files)
    input.bytes += hashFile(file, hash, input.ends);
  input.sha256 = hash.finish();
  return input;
}

std::string toJson(const Provenance& provenance, int indent)
{
  nlohmann::ordered_json json;
  json["program"] = provenance.program;
  json["version"] = provenance.version;
  json["commit"] = provenance.commit;
  json["command"] = provenance.command;
  json["date"] = provenance.date;
  if (provenance.seed)
    json["seed"] = *provenance.seed;
  if (!provenance.parameters.empty())
    json["parameters"] = nlohmann::ordered_json::parse(provenance.parameters);
  json["inputs"] = nlohmann::ordered_json::array();
  for (const InputFile& input : provenance.inputs)
  {
    nlohmann::ordered_json entry;
    entry["name"] = input.name;
    entry["bytes"] = input.bytes;
    entry[input.ends ? "sha256_of_ends" : "sha256"] = input.sha256;
    json["inputs"].push_back(std::move(entry));
  }
  // File names may hold bytes that are not UTF-8: they are replaced, not refused.
  return json.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

Provenance provenanceFromJson(std::string_view text)
{
  const auto json = nlohmann::ordered_json::parse(text, nullptr, false);
  if (!json.is_object())
  {
    throw InputError(
      "the provenance record is not a JSON object", "the file was not written by lamella, or was changed");
  }
  const auto string = [](const nlohmann::ordered_json& object, const char* key)
  {
    const auto found = object.find(key);
    return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
  };
  Provenance provenance;
  provenance.program = string(json, "program");
  provenance.version = string(json, "version");
  provenance.commit = string(json, "commit");
  provenance.command = string(json, "command");
  provenance.date = string(json, "date");
  if (const auto seed = json.find("seed"); seed != json.end() && seed->is_number_integer())
    provenance.seed = seed->get<std::uint64_t>();
  if (const auto parameters = json.find("parameters"); parameters != json.end() && parameters->is_object())
    provenance.parameters = parameters->dump();
  if (const auto inputs = json.find("inputs"); inputs != json.end() && inputs->is_array())
  {
    for (const auto& entry : *inputs)
    {
      if (entry.is_object())
      {
        const auto bytes = entry.find("bytes");
        const bool ends = entry.contains("sha256_of_ends");
        provenance.inputs.push_back({ string(entry, "name"),
          bytes != entry.end() && bytes->is_number_unsigned() ? bytes->get<std::uint64_t>() : 0,
          string(entry, ends ? "sha256_of_ends" : "sha256"), ends });
      }
    }
  }
  return provenance;
}

std::string quoteCommand(std::span<const std::string> words)
{
  std::string line;
  for (const std::string& word : words)
  {
    if (!line.empty())
      line += ' ';
    const bool plain = !word.empty() &&
      word.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_=+,./:@%^") ==
        std::string::npos;
    if (plain)
    {
      line += word;
      continue;
    }
    line += '\'';
    for (const char c : word)
      line += c == '\'' ? std::string("'\\''") : std::string(1, c);
    line += '\'';
  }
  return line;
}

} // namespace lamella::io
