#pragma once

#include "PhaseIds.h"

#include "lattice/Phases.h"
#include "lbm/SteadyDiffusion.h"

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

class vtkDataArray;

/// What links one by one want of an image: all of it on every rank. Not installed.
namespace lamella
{

/// Collective. The whole image's phases.
[[nodiscard]] PhaseImage gatherPhases(
  const Lattice& lattice, const lbm::Block& held, const PhaseIds& phases, const Team& team);

/// Collective. The directions along the walls of the whole image; of two components the third is 0.
/// @param array of the piece; null where that is empty
[[nodiscard]] std::vector<std::array<float, 3>> gatherAxes(
  const Lattice& lattice, const lbm::Block& held, vtkDataArray* array, const Team& team);

/// Conductivities across the walls by id, as conductivityById() has those along them; empty where no phase with nodes
/// conducts differently across.
/// @param across by the words that `along` has; phases that it does not name conduct as along
/// @throws ParameterError as conductivityById(); for a phase with none along
[[nodiscard]] std::vector<double> acrossById(const PhaseIds& phases, const std::map<std::string, double>& along,
  const std::map<std::string, double>& across, std::span<const std::int64_t> nodes);

/// How far conductivities may be off, by id; 0 where that is not told, empty where none is.
/// @param across where they are of conductivities across: of which phases there are some
/// @param given  by the words of `conductivity`
/// @throws ParameterError: negative, not finite, or of a phase that has no conductivity
[[nodiscard]] std::vector<double> uncertaintyById(const PhaseIds& phases,
  const std::map<std::string, double>& conductivity, const std::map<std::string, double>* across,
  const std::map<std::string, double>& given, std::span<const std::int64_t> nodes);

} // namespace lamella
