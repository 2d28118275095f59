#include "files/ResultFiles.h"

#include "files/GridFile.h"
#include "files/JsonReport.h"
#include "files/TableText.h"
#include "session/Session.h"
#include "session/Workspace.h"

#include "core/Error.h"
#include "vtkLatticeConversion.h"

#include <vtkDataObject.h>
#include <vtkTable.h>

#include <filesystem>

namespace lamella::cli
{

void ResultFiles::addGrid(
  const std::string& option, const std::string& name, const std::string& ending, vtkDataObject* grid, bool overwrite)
{
  if (!name.empty())
    grids_.push_back({ grid, openGrid(option, name, ending, overwrite) });
}

void ResultFiles::addTable(const std::string& option, const std::string& name, vtkTable* table, bool overwrite)
{
  if (name.empty())
    return;
  if (std::filesystem::path(name).extension() != ".csv")
    throw ParameterError(option + " '" + name + "': tables are written as .csv", "end the name in .csv");
  tables_.push_back({ table, OutputFile(name, overwrite), OutputFile(name + ".json", overwrite) });
}

void ResultFiles::needGrids(std::uint64_t bytes) const
{
  for (const Grid& grid : grids_)
    grid.file.needs(bytes);
}

std::vector<std::string> ResultFiles::write(const std::string& provenance, bool metres)
{
  std::vector<std::string> names;
  for (const Grid& grid : grids_)
  {
    setProvenance(grid.data, provenance);
    writeGrid(grid.data, grid.file);
    names.push_back(grid.file.path().string());
  }
  for (const Table& table : tables_)
  {
    if (table.csv.inMemory())
    {
      Workspace::keep(table.csv.path(), table.table);
    }
    else
    {
      table.csv.write(toCsv(table.table));
      const Json beside{ { "provenance", Json::parse(provenance) }, { "columns", unitsOf(table.table, metres) } };
      table.record.write(dump(beside));
    }
    names.push_back(table.csv.path().string());
  }
  Session::checkInterrupt();
  for (Grid& grid : grids_)
    grid.file.commit();
  for (Table& table : tables_)
  {
    table.csv.commit();
    table.record.commit();
  }
  return names;
}

} // namespace lamella::cli
