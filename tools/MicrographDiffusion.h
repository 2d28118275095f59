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
using PhaseMaker = std::function<void(const micrograph::FittedContours&, micrograph::ContourLattice&)>;

/// Conductivities of lumen, wall and, where it has one of its own, lamella, with their names.
struct Conductivities
{
  std::vector<std::pair<std::string, double>> named;
  std::vector<double> values; ///< lumen, wall, lamella; the last only if it differs
};

/// What is solved, and how far.
struct MicrographProblem
{
  const micrograph::ContourSet& contours;
  const Conductivities& conductivities;
  std::vector<micrograph::CoarserOutlines> coarser; ///< of a picture; empty: the outlines are taken as they are
  double pixel = 0;                                 ///< of that picture [m]
  bool shares = false;                              ///< it has each pixel's share of lumen, not a mask
  double doubt = 0;                                 ///< about where walls begin [m]
  double spacing = 0;
  double targetError = 0; ///< 0: the pair of lattices alone
  std::vector<int> axes;
  int threads = 1;
};

/// NAME=VALUE, once or with commas between. @throws ParameterError
[[nodiscard]] Conductivities parseConductivities(const std::vector<std::string>& texts, bool hasLamella);

/// With a target the spacing is halved until the error bar is at most this part of the value, as far as half of the
/// memory that is free goes; what it takes is told before.
/// @throws MemoryError, NoPathError, Cancelled
[[nodiscard]] std::vector<lbm::ContourAnswer> solveMicrograph(
  Session& session, const MicrographProblem& problem, const PhaseMaker& phases);

} // namespace lamella::cli
