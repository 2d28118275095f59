#pragma once

#include "generators/Generators.h"

#include <CLI/App.hpp>

#include <cstdint>
#include <string>

/// The options of `lamella generate` that say what a tissue is like.
namespace lamella::cli
{

/// As they are written; the functions below fill in their kind's defaults.
struct TissueChoice
{
  std::string fraction, ring, rayEvery;
  double scatter = 0;
  std::uint64_t seed = 1;
  std::string tangential, radialEarly, radialLate, length; ///< softwood
  std::string fibre, vesselDiameter, vesselShare;          ///< hardwood
  double earlyEnd = 0, multiples = 0;                      ///< hardwood
};

void addSoftwoodOptions(CLI::App& command, TissueChoice& choice);
void addHardwoodOptions(CLI::App& command, TissueChoice& choice);

/// In numbers, but for box and spacing. @throws ParameterError
[[nodiscard]] generators::SoftwoodOptions softwoodOptions(const TissueChoice& choice);
[[nodiscard]] generators::HardwoodOptions hardwoodOptions(const TissueChoice& choice);

/// A share within bounds. @throws ParameterError
[[nodiscard]] double fractionBetween(const std::string& option, const std::string& text, double low, double high);

} // namespace lamella::cli
