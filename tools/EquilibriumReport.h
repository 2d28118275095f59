#pragma once

#include "io/Provenance.h"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

class vtkImageData;

/// What `lamella equilibrium` tells.
namespace lamella::cli
{

struct EquilibriumReport
{
  std::string file;
  vtkImageData* image = nullptr; ///< output of vtkBondEquilibrium
  std::string pixelSizeSource;
  io::Provenance provenance;
  std::vector<std::string> written;
  int refine = 1;
  int threads = 1;
  int ranks = 1;
  double seconds = 0;
};

[[nodiscard]] std::string toJson(const EquilibriumReport& report);
[[nodiscard]] std::string toTable(const EquilibriumReport& report);

} // namespace lamella::cli
