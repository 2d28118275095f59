#include "files/Record.h"

#include "session/Workspace.h"

#include <nlohmann/json.hpp>

#include <algorithm>

namespace lamella::cli
{

using Json = nlohmann::ordered_json;

io::Provenance recordRun(
  const SceneWishes* scene, const std::string& commandLine, const std::string& file, const std::string& before)
{
  io::Provenance record = io::makeProvenance(commandLine);
  if (!file.empty() && !Workspace::holds(file)) // data in memory tell themselves what they were made from
  {
    std::error_code failed;
    record.inputs.push_back(
      std::filesystem::exists(file, failed) ? io::describeInput(file) : io::InputFile{ file, 0, "" });
    record.inputs.back().name = Session::named(file);
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
