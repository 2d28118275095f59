#pragma once

#include "session/OutputFile.h"

#include <cstdint>
#include <string>
#include <vector>

class vtkDataObject;
class vtkTable;

namespace lamella::cli
{

/// The files that a command writes: grids, and tables as NAME.csv with provenance and units in NAME.csv.json beside.
///
/// They are opened before anything is computed, so that a name that cannot be written is told at once. An empty name
/// stands for no file; `option` is what the command line calls the name.
class ResultFiles
{
public:
  /// @throws ParameterError for another ending; OutputError
  void addGrid(
    const std::string& option, const std::string& name, const std::string& ending, vtkDataObject* grid, bool overwrite);
  /// @throws ParameterError for another ending than .csv; OutputError
  void addTable(const std::string& option, const std::string& name, vtkTable* table, bool overwrite);

  /// @param bytes that each grid will take @throws OutputError where the disk has less room
  void needGrids(std::uint64_t bytes) const;

  /// Writes all of them and gives them their names once all are written.
  /// @param provenance JSON text (io/Provenance.h)
  /// @param metres whether lengths in tables are in metres; else they are in pixels
  /// @returns the names, those of grids first
  /// @throws OutputError; Cancelled
  [[nodiscard]] std::vector<std::string> write(const std::string& provenance, bool metres = true);

private:
  struct Grid
  {
    vtkDataObject* data;
    OutputFile file;
  };
  struct Table
  {
    vtkTable* table;
    OutputFile csv;
    OutputFile record;
  };
  std::vector<Grid> grids_;
  std::vector<Table> tables_;
};

} // namespace lamella::cli
