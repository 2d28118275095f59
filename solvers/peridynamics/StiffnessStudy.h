#pragma once

#include "peridynamics/ElasticStudy.h"
#include "peridynamics/PeriodicCell.h"
#include "peridynamics/SideMatch.h"

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

/// The whole job of an effective stiffness: from phases and materials to the tensor and its error.
namespace lamella::peridynamics
{

struct StiffnessOptions
{
  EquilibriumOptions equilibrium{}; ///< small strains only
  bool estimateError = true;        ///< solve with every node split in two along each axis as well
  /// Of the finer lattice. Where it would have more, both spacings of the estimate are solved on a centred part of the
  /// sample: the lattice's error is a local matter, and the part's relative change stands for the whole's.
  std::int64_t estimateNodes = std::int64_t{ 1 } << 20;
  int threads = 0;   ///< 0: as many as OpenMP would take
  double memory = 0; ///< bytes that may be taken on this machine; 0: what is free
};

/// One solve of a study.
struct StiffnessStep
{
  int refinement = 1; ///< nodes along each axis that a node of the sample was split in
  std::int64_t nodes = 0;
  std::vector<double> stiffness;        ///< [Pa], components²
  std::vector<std::int64_t> iterations; ///< one a unit strain
  double seconds = 0;                   ///< wall, bonds included
  bool part = false;                    ///< of a centred part of the sample
};

/// Of the spacing; what a horizon of so many spacings and its directions change stays on every lattice.
struct StiffnessError
{
  std::vector<double> components; ///< of each component [Pa]; empty: not known
  /// Of the diagonal's worst, relative; NaN: not known
  double relative = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> extrapolated; ///< tensor that an endlessly fine lattice is expected to have [Pa]
  ElasticConstants constants;       ///< of that; empty where it has no inverse that makes sense
  std::vector<double> ofConstants;  ///< as constantValues(); empty likewise
};

struct StiffnessResult : SampleCounts
{
  EffectiveStiffness cell; ///< at the sample's own spacing
  StiffnessError error;
  std::vector<StiffnessStep> steps; ///< every solve, in order

  std::array<SideMatch, 3> sides{};
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

/// Error of a tensor from two spacings with a ratio of two, at order 1: each component errs by twice the change to the
/// finer one, which lies half way to the limit.
/// @param stiffness of the whole sample
/// @param coarse, fine at its spacing and at half of it; of a part of the sample they are scaled by what the diagonals
/// of `stiffness` and `coarse` have to each other
[[nodiscard]] StiffnessError stiffnessError(std::span<const double> stiffness, std::span<const double> coarse,
  std::span<const double> fine, int dimension, double zero = 1e-9);

} // namespace lamella::peridynamics
