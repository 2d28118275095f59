#pragma once

#include "io/Provenance.h"

#include <string>
#include <vector>

class vtkPoreFloodFill;

/// What `lamella pore-flood-fill` tells.
namespace lamella::cli
{

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

} // namespace lamella::cli
