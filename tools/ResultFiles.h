#pragma once

#include "OutputFile.h"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

class vtkTable;

namespace lamella::cli
{

/// The tables that a command writes: NAME.csv, and beside each NAME.csv.json with its provenance and units.
class TableFiles
{
public:
  /// Opens both files, so that a name that cannot be written is told before anything is computed; an empty name stands
  /// for no file.
  /// @param option what the command line calls the name
  /// @throws ParameterError for another ending than .csv; OutputError
  void add(const std::string& option, const std::string& name, vtkTable* table, bool overwrite);

  /// Writes all of them and gives them their names once all are written.
  /// @returns the names
  /// @throws OutputError; Cancelled
  [[nodiscard]] std::vector<std::string> write(const nlohmann::ordered_json& provenance);

private:
  struct File
  {
    vtkTable* table;
    OutputFile csv;
    OutputFile record;
  };
  std::vector<File> files_;
};

} // namespace lamella::cli
