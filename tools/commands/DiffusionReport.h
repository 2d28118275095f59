#pragma once

#include "files/Input.h"

#include "SteadyFindings.h"
#include "io/Provenance.h"
#include "lattice/AxisNames.h"

#include <cstdint>
#include <string>
#include <vector>

namespace lamella::cli
{

/// Everything that `lamella diffusion` tells.
struct DiffusionReport
{
  std::string file;
  const Sample* sample = nullptr;
  SteadyFindings found;
  bool estimated = true; ///< the error
  int threads = 1;
  int ranks = 1;
  double seconds = 0;               ///< wall, reading and writing included
  std::uint64_t peakMemory = 0;     ///< bytes, the largest of all ranks
  std::vector<std::string> written; ///< files
  io::Provenance provenance;
};

/// One JSON object, indented: docs/commands/diffusion.md is its contract.
[[nodiscard]] std::string toJson(const DiffusionReport& report);

/// The same for people.
[[nodiscard]] std::string toTable(const DiffusionReport& report);

/// Bytes that this process held at its largest.
[[nodiscard]] std::uint64_t peakMemoryBytes();

} // namespace lamella::cli
