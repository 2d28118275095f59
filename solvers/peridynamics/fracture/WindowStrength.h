#pragma once

#include "peridynamics/fracture/FractureStudy.h"
#include "statistics/WindowError.h"

#include <vector>

namespace lamella::peridynamics
{

/// Options of a sample's run for others like it: until the stress has fallen to nine tenths of the peak, without files
/// and states.
[[nodiscard]] FractureStudyOptions toThePeak(const FractureStudyOptions& sample);

/// Peak stresses [Pa] of the windows that a sample is cut into, halves and thirds of it along each axis, each between
/// platens of its own and pulled as the sample is; 0 where nothing, or nothing but hinges, leads across. Each runs
/// until its stress has fallen to nine tenths of its peak, and writes nothing. Each is one rank's, in turn; so they are
/// the same on any number of ranks. Collective.
///
/// @param phase, grain of the whole sample, on every rank  @param options as of the sample
/// @throws as studyFracture(), on every rank
[[nodiscard]] std::vector<statistics::WindowTiling> windowStrengths(const BondModel& model, const Lattice& lattice,
  std::span<const std::uint8_t> phase, std::span<const std::int32_t> grain, const FractureStudyOptions& options,
  const Communicator& comm = Communicator());

} // namespace lamella::peridynamics
