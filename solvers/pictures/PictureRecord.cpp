#include "pictures/PictureRecord.h"

#include <nlohmann/json.hpp>

#include <fstream>
#include <iterator>

namespace lamella::micrograph
{

using Json = nlohmann::ordered_json;

std::string toJson(const PictureRecord& record)
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

std::optional<PictureRecord> parseRecord(std::string_view text)
{
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("provenance"))
    return std::nullopt;
  try
  {
    PictureRecord record;
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

std::optional<PictureRecord> readRecordBeside(const std::filesystem::path& raw)
{
  std::ifstream beside(recordBeside(raw));
  return beside ? parseRecord(std::string(std::istreambuf_iterator<char>(beside), {})) : std::nullopt;
}

} // namespace lamella::micrograph
