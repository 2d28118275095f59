#pragma once

#include "io/Checkpoint.h"
#include "peridynamics/BondLattice.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

/// What checkpoints of fracture, in steps of load or of time, have in common.
namespace lamella::peridynamics
{

struct CheckpointOptions
{
  std::filesystem::path path{}; ///< none: no checkpoints. Replaced whenever there is a newer state
  std::int64_t every = 0;       ///< events, or steps in time, between two files at least
  std::string provenance{};     ///< io::toJson(); goes into the file as it is
  /// Called on rank 0 when a file cannot be written (a full disk): the last good one stays, the run goes on.
  std::function<void(const std::string&)> warn{};
};

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
[[nodiscard]] std::vector<Bond> bondsIn(const io::Checkpoint& checkpoint, const BondLattice& bonds);

/// Writes on rank 0; says there, by CheckpointOptions::warn, what stands in the way. Collective.
/// @return whether it was written
bool write(const io::Checkpoint& checkpoint, const CheckpointOptions& options, const Communicator& comm);
/// Read by rank 0 for all. @throws InputError on all ranks alike: see io::decode(), io::expectScene()
[[nodiscard]] io::Checkpoint readCheckpoint(
  const std::filesystem::path& path, const std::string& kind, const std::string& scene, const Communicator& comm);
/// Refuses a place where no file can be written, before the run. @throws InputError on all ranks. Collective.
void checkPlace(const CheckpointOptions& options, const Communicator& comm);

} // namespace lamella::peridynamics
