#pragma once

#include "io/RunCheckpoint.h"
#include "peridynamics/BondLattice.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

/// What checkpoints of fracture, in steps of load or of time, have in common.
namespace lamella::peridynamics
{

using io::CheckpointOptions;

/// Lines "what: value" of all about the bonds that a run depends on; before any breaks. The same for any number of
/// ranks. Collective.
[[nodiscard]] std::string sceneOf(const BondLattice& bonds);
/// SHA-256 of what a row of this rank's nodes is, over all rows of the lattice in order; collective.
/// @param row called with y, z; returns bytes
[[nodiscard]] std::string hashOfRows(
  const BondLattice& bonds, const std::function<std::string(std::int64_t, std::int64_t)>& row);

/// A field of all ranks, shape (nz, ny, nx, components); on rank 0, nothing on the others. Collective.
[[nodiscard]] io::CheckpointArray gathered(
  const BondLattice& bonds, const NodeField<double>& field, std::string unit, std::string description);
/// The field again, by any number of ranks; its rim not filled.
/// @throws InputError when it is of another lattice
[[nodiscard]] NodeField<double> scattered(
  const BondLattice& bonds, const io::Checkpoint& checkpoint, const std::string& name);

/// x, y, z of the first nodes, then places in Stencil::half(): shape (n, 4).
[[nodiscard]] io::CheckpointArray arrayOf(const std::vector<Bond>& bonds);
/// @param name of such an array
/// @throws InputError where they are of another lattice
[[nodiscard]] std::vector<Bond> bondsIn(
  const io::Checkpoint& checkpoint, const std::string& name, const BondLattice& bonds);

} // namespace lamella::peridynamics
