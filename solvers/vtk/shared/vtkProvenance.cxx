#include "vtkProvenance.h"

#include "vtkLatticeConversion.h"

#include "core/Error.h"
#include "io/Provenance.h"

#include "vtkDataObject.h"

namespace lamella
{
namespace
{

void addStep(io::Provenance& record, const std::string& step, const nlohmann::json& parameters)
{
  nlohmann::json all = nlohmann::json::parse(record.parameters, nullptr, false);
  if (!all.is_object())
    all = nlohmann::json::object();
  std::string key = step;
  for (int again = 2; all.contains(key); ++again)
    key = step + " " + std::to_string(again);
  all[key] = parameters;
  record.parameters = all.dump();
  record.command += (record.command.empty() ? "" : " | ") + step;
}

} // namespace

void beginProvenance(vtkDataObject* data, const std::string& step, const nlohmann::json& parameters,
  std::optional<std::uint64_t> seed, const std::optional<std::filesystem::path>& file)
{
  io::Provenance record = io::makeProvenance("");
  record.seed = seed;
  if (file)
    record.inputs.push_back(io::describeInput(*file));
  addStep(record, step, parameters);
  setProvenance(data, io::toJson(record));
}

void continueProvenance(vtkDataObject* data, const std::string& step, const nlohmann::json& parameters)
{
  io::Provenance record = io::makeProvenance("");
  const std::string before = provenance(data);
  if (!before.empty())
  {
    try
    {
      const io::Provenance source = io::provenanceFromJson(before);
      record.seed = source.seed;
      record.inputs = source.inputs;
      record.parameters = source.parameters;
      record.command = source.command;
    }
    catch (const Error&)
    {
      // Another program's text under our name: start afresh rather than fail a solve over it.
    }
  }
  addStep(record, step, parameters);
  setProvenance(data, io::toJson(record));
}

} // namespace lamella
