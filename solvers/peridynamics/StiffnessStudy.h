#pragma once

#include "elasticity/StiffnessError.h"
#include "peridynamics/ElasticStudy.h"
#include "peridynamics/PeriodicCell.h"
#include "peridynamics/SideMatch.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

/// The whole job of an effective stiffness: from phases and materials to the tensor and its error.
namespace lamella::peridynamics
{

struct StiffnessOptions
{
  EquilibriumOptions equilibrium{}; ///< small strains only
  /// Of the picture as well as of the lattice, from coarser pictures of the same cell (StiffnessError.h): every second,
  /// third and fourth pixel. Takes at most workOfEstimate times the work of the cell itself.
  bool estimateError = true;
  int nodesPerPixel = 1; ///< along each axis: pixels that were split before they came here
  int threads = 0;       ///< 0: as many as OpenMP would take
  double memory = 0;     ///< bytes that may be taken on this machine; 0: what is free
};

/// Nodes times iterations (and ten for what comes before them) that an estimate may take over those of the cell. What
/// it has by then counts; if it has nothing by then, the error is not known.
inline constexpr double workOfEstimate = 4;

using elasticity::StiffnessStep;

struct StiffnessResult : SampleCounts
{
  EffectiveStiffness cell; ///< at the sample's own spacing
  elasticity::StiffnessError error;
  std::vector<StiffnessStep> steps; ///< every solve, in order

  std::array<elasticity::SideMatch, 3> sides{};
  std::vector<std::string> warnings; ///< each one line, with its numbers

  double bondSeconds = 0;  ///< making the bonds
  double setupSeconds = 0; ///< of the solver
  double solveSeconds = 0;
  double measureSeconds = 0;  ///< all else at the sample's own spacing
  double estimateSeconds = 0; ///< everything for the error
  std::int64_t bytes = 0;     ///< of all ranks: bonds, solver and fields
};

/// @param model its `periodic` does not matter: every side is
/// @param phase, grain as BondLattice
/// @throws what BondLattice and effectiveStiffness() throw; MemoryError before anything is allocated
[[nodiscard]] StiffnessResult studyStiffness(const BondModel& model, const Lattice& lattice,
  std::span<const std::uint8_t> phase, std::span<const std::int32_t> grain, const StiffnessOptions& options,
  const Communicator& comm);

/// Bytes that one rank takes at most, without the estimate. @throws ParameterError as BondLattice::bytesNeeded()
[[nodiscard]] double stiffnessBytes(
  const BondModel& model, const Lattice& lattice, bool grains, const StiffnessOptions& options, int ranks);

} // namespace lamella::peridynamics
