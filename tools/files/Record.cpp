#include "files/Record.h"

#include "session/Workspace.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>
#include <iterator>

namespace lamella::cli
{

using Json = nlohmann::ordered_json;

std::string toJson(const Record& record)
{
  Json json;
  json["provenance"] = record.provenance.empty() ? Json::object() : Json::parse(record.provenance);
  Json phases = Json::object();
  for (const auto& [grey, name] : record.phases)
    phases[std::to_string(grey)] = name;
  json["phases"] = std::move(phases);
  if (record.pixelSize)
    json["pixel_size"] = *record.pixelSize;
  if (record.size)
  {
    json["size"] = *record.size;
    json["bits"] = record.bits;
  }
  // ASCII only: what PNG and TIFF readers expect of a description.
  return json.dump(-1, ' ', true, Json::error_handler_t::replace);
}

std::optional<Record> parseRecord(std::string_view text)
{
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("provenance"))
    return std::nullopt;
  try
  {
    Record record;
    record.provenance = json.at("provenance").dump();
    if (json.contains("phases"))
      for (const auto& [grey, name] : json.at("phases").items())
        record.phases[std::stoi(grey)] = name.get<std::string>();
    if (json.contains("pixel_size") && json.at("pixel_size").is_number())
    {
      const auto size = json.at("pixel_size").get<double>();
      record.pixelSize = size > 0 ? std::optional(size) : std::nullopt;
    }
    if (json.contains("size"))
      record.size = json.at("size").get<std::array<std::int64_t, 3>>();
    record.bits = json.value("bits", 8);
    return record;
  }
  catch (const std::exception&) // somebody else's JSON
  {
    return std::nullopt;
  }
}

std::filesystem::path recordBeside(const std::filesystem::path& raw)
{
  return raw.string() + ".json";
}

std::optional<Record> readRecordBeside(const std::filesystem::path& raw)
{
  std::ifstream beside(recordBeside(raw));
  return beside ? parseRecord(std::string(std::istreambuf_iterator<char>(beside), {})) : std::nullopt;
}

io::Provenance recordRun(
  const SceneWishes* scene, const std::string& commandLine, const std::string& file, const std::string& before)
{
  io::Provenance record = io::makeProvenance(commandLine);
  if (!file.empty() && !Workspace::holds(file)) // data in memory tell themselves what they were made from
  {
    std::error_code failed;
    record.inputs.push_back(
      std::filesystem::exists(file, failed) ? io::describeInput(file) : io::InputFile{ file, 0, "" });
  }
  Json parameters;
  if (scene != nullptr && !scene->record.empty())
    parameters["scene"] = Json::parse(scene->record);
  const Json old = Json::parse(before, nullptr, false);
  if (old.is_object())
  {
    parameters["made_from"] = old;
    if (const auto seed = old.find("seed"); seed != old.end() && seed->is_number_unsigned())
      record.seed = seed->get<std::uint64_t>();
  }
  if (!parameters.empty())
    record.parameters = parameters.dump();
  return record;
}

void addRecord(Json& json, const io::Provenance& run)
{
  json["version"] = run.version;
  json["commit"] = run.commit;
  json["provenance"] = Json::parse(io::toJson(run));
}

std::vector<std::uint8_t> greysOfPhases(const PhaseTable& phases)
{
  std::vector<std::uint8_t> greys;
  const std::size_t last = std::max<std::size_t>(phases.size(), 2) - 1;
  for (std::size_t id = 0; id < phases.size(); ++id)
    greys.push_back(static_cast<std::uint8_t>(255 * id / last));
  return greys;
}

} // namespace lamella::cli
