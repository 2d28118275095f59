#pragma once

#include "io/Provenance.h"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

class vtkPoreFloodFill;
class vtkTable;

/// What `lamella pore-flood-fill` tells.
namespace lamella::cli
{

using Json = nlohmann::ordered_json;

struct PoreReport
{
  std::string file;
  vtkPoreFloodFill* filter; ///< updated
  bool metres;              ///< the pixel size is known
  io::Provenance provenance;
  std::vector<std::string> written;
  int ranks = 1;
  double seconds = 0;
};

[[nodiscard]] std::string toJson(const PoreReport& report);
[[nodiscard]] std::string toTable(const PoreReport& report);

/// A table as comma-separated values: a row of names, then one row a row, numbers with all their digits.
[[nodiscard]] std::string toCsv(vtkTable* table);

/// Units and meaning of the columns.
/// @param metres the pixel size is known; otherwise lengths are in pixels
[[nodiscard]] Json unitsOf(vtkTable* table, bool metres);

} // namespace lamella::cli
