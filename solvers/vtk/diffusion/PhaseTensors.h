#pragma once

#include "PhaseIds.h"

#include "lbm/DirectedDiffusivity.h"
#include "vtkPieces.h"

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

class vtkDataArray;

/// Conductivities that are tensors, of phases and of voxels. Not installed.
namespace lamella
{

/// What was given of an image's phases, by id.
struct PhaseTensors
{
  std::vector<lbm::DirectedDiffusivity::Source> source; ///< empty: no phase with nodes has a tensor
  std::vector<lbm::SymmetricTensor<double>> ofPhase;    ///< likewise
  std::map<std::string, double> conductivity;           ///< by word: what was given, and 1 for each tensor
};

/// @param conductivity by word  @param tensors numbers by word, with spaces between them
/// @param nodes by id  @param byVoxel whether the voxels have tensors: phases with nothing else take theirs
/// @throws ParameterError: numbers that are no tensor; a phase that has a conductivity, too
[[nodiscard]] PhaseTensors phaseTensors(const PhaseIds& phases, const std::map<std::string, double>& conductivity,
  const std::map<std::string, std::string>& tensors, std::span<const std::int64_t> nodes, bool byVoxel, int dimension);

/// Collective. The tensors of the whole image's voxels.
/// @param array of the piece, 6 components (xx, yy, zz, xy, yz, xz) or 9 by rows; null where that is empty
/// @throws InputError on every rank: another number of components, or 9 that are not symmetric
[[nodiscard]] std::vector<lbm::SymmetricTensor<float>> gatherTensors(
  const Lattice& lattice, const lbm::Block& held, vtkDataArray* array, const Team& team);

} // namespace lamella
