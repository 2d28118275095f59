#pragma once

#include "PhaseIds.h"

#include "lbm/Membranes.h"

#include <map>
#include <string>
#include <vector>

/// Membranes as people write them: by the names of two phases. Not installed.
namespace lamella
{

struct NamedMembrane
{
  std::string name; ///< of both phases, as lumen-wall
  lbm::Membrane membrane;
  bool there = true; ///< the image has both phases
};

/// @param resistances, permeances by pair; a pair is in one of them, and once
/// @throws ParameterError for what is no pair of two phases of the image, a pair that is given twice, and numbers that
/// cannot be
[[nodiscard]] std::vector<NamedMembrane> namedMembranes(const PhaseIds& phases,
  const std::map<std::string, double>& resistances, const std::map<std::string, double>& permeances);

} // namespace lamella
