#include "TableFiles.h"

#include "Session.h"
#include "TableText.h"

#include "lattice/Error.h"

#include <filesystem>

namespace lamella::cli
{

void TableFiles::add(const std::string& option, const std::string& name, vtkTable* table, bool overwrite)
{
  if (name.empty())
  {
    return;
  }
  if (std::filesystem::path(name).extension() != ".csv")
  {
    throw ParameterError(option + " '" + name + "': tables are written as .csv", "end the name in .csv");
  }
  files_.push_back({ table, OutputFile(name, overwrite), OutputFile(name + ".json", overwrite) });
}

std::vector<std::string> TableFiles::write(const nlohmann::ordered_json& provenance)
{
  std::vector<std::string> names;
  for (const File& file : files_)
  {
    file.csv.write(toCsv(file.table));
    const nlohmann::ordered_json beside{ { "provenance", provenance }, { "columns", unitsOf(file.table, true) } };
    file.record.write(beside.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
    names.push_back(file.csv.path().string());
  }
  Session::checkInterrupt();
  for (File& file : files_)
  {
    file.csv.commit();
    file.record.commit();
  }
  return names;
}

} // namespace lamella::cli
