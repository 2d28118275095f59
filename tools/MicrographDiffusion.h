#pragma once

#include "Session.h"

#include "lbm/ContourDiffusion.h"
#include "micrograph/Contour.h"
#include "micrograph/ContourLattice.h"

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lamella::cli
{

/// Gives a lattice's walls the phases "secondary wall" 1 and "middle lamella" 2, or nothing to do so.
using PhaseMaker = std::function<void(micrograph::ContourLattice&)>;

/// Conductivities of lumen, wall and, where it has one of its own, lamella, with their names.
struct Conductivities
{
  std::vector<std::pair<std::string, double>> named;
  std::vector<double> values; ///< lumen, wall, lamella; the last only if it differs
};

/// NAME=VALUE, once or with commas between. @throws ParameterError
[[nodiscard]] Conductivities parseConductivities(const std::vector<std::string>& texts, bool hasLamella);

/// @param targetError the spacing is halved until the error bar is at most this part of the value, as far as memory
/// goes; 0: a pair of lattices alone
/// @throws MemoryError, NoPathError, Cancelled
[[nodiscard]] std::vector<lbm::ContourAnswer> solveMicrograph(Session& session, const micrograph::ContourSet& contours,
  const Conductivities& conductivities, double spacing, double targetError, const std::vector<int>& axes, int threads,
  const PhaseMaker& phases);

} // namespace lamella::cli
