#pragma once

#include "Input.h"

#include "io/Provenance.h"
#include "lbm/Bounds.h"
#include "lbm/DiffusionStudy.h"

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
  std::vector<double> conductivity; ///< by phase id; NaN where it has none and no node either
  std::vector<double> across;       ///< by phase id; empty where all conduct the same in every direction
  std::vector<double> fractions;    ///< by phase id
  lbm::StudyOptions options;
  std::vector<lbm::DiffusionAnswer> answers;
  lbm::Bounds bounds;
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

/// What a target error will take, for people.
[[nodiscard]] std::string planText(const lbm::TargetPlan& plan);

/// Why a target error was not reached, and what to do about it.
struct Shortfall
{
  std::string message;
  std::string hint;
};
[[nodiscard]] Shortfall shortfallOf(const DiffusionReport& report);

/// The tensor by rows, 9 numbers, NaN in columns that were not solved.
[[nodiscard]] std::array<double, 9> tensorOf(const std::vector<lbm::DiffusionAnswer>& answers, int dimension);

} // namespace lamella::cli
