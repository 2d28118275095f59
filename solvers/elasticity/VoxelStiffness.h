#pragma once

#include "core/Communicator.h"
#include "elasticity/ElasticConstants.h"
#include "elasticity/Materials.h"
#include "elasticity/SideMatch.h"
#include "elasticity/StiffnessError.h"
#include "lattice/Lattice.h"
#include "statistics/WindowError.h"

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// The whole job of an effective stiffness by elements, one a pixel or voxel: from phases and materials to the tensor
/// and its error.
namespace lamella::elasticity
{

enum class StiffnessSides
{
  Periodic,      ///< the box repeats; displacements but for the mean strain do, too
  UniformStrain, ///< all faces follow the mean strain: an upper bound
  UniformStress, ///< all faces are pulled by the mean stress: a lower bound; no void may touch them
  Straight,      ///< faces stay plane and slide on frictionless neighbours: mirror images of the box fill space
  Slip,          ///< between platens without friction, across each axis in turn; the other faces are free
  Grip           ///< between platens that hold, across each axis in turn; the other faces are free
};
[[nodiscard]] constexpr bool between(StiffnessSides sides) noexcept
{
  return sides == StiffnessSides::Slip || sides == StiffnessSides::Grip;
}

struct VoxelMaterial
{
  PhaseStiffness stiffness; ///< all 0: a void
  /// As axialModuli() gives them, of a phase whose axis is each voxel's own; all 0: `stiffness` holds as it is.
  std::array<double, 5> axial{};
  bool rigid = false; ///< its pieces move as bodies; both others are 0
  /// Strain that it takes when nothing holds it, of a unit of temperature or moisture: Voigt's order, shears as angles;
  /// of a phase with an axis along it and across it. Empty: none.
  std::vector<double> expansion;
  std::vector<ModulusChange> changes{}; ///< with each number it is told by; of one that is isotropic or has an axis
};

/// A macroscopic load. Components in Voigt's order, NaN where they are not given: what neither names has no strain, but
/// where some stress is given it has no stress. Between platens the one normal component that is given is the load.
struct VoxelLoad
{
  std::vector<double> strain;    ///< shears as angles; empty: none is given
  std::vector<double> stress;    ///< [Pa]; empty: none is given
  double change = 0;             ///< of temperature or moisture, for the materials' expansion
  std::span<const float> source; ///< by voxel, what `change` is times; empty: 1
};

/// Of a row of voxels along x, from threads of its own: displacements of voxels' centres from the box's centre [m],
/// strains (shears as angles) and stresses [Pa] by Voigt's order.
using VoxelFieldRow = std::function<void(std::int64_t row, std::int64_t plane, const double* const* displacement,
  const double* const* strain, const double* const* stress)>;

struct VoxelStiffnessOptions
{
  StiffnessSides sides = StiffnessSides::Periodic;
  bool tensor = true; ///< without it only a load is solved for, whose strains are all given
  /// How many numbers the materials' `changes` are by: how the tensor changes with them, from the fields of its solves,
  /// which are all kept till the end (voigtSize of them, 4 bytes a component and node). 0: not wanted.
  std::size_t numbers = 0;
  bool surfaces = false; ///< the same by where the surfaces between phases lie; not of shares
  /// Of voxels that two phases share (SharedVoxels.h): by phase id the share of the second. Axes of phases that have
  /// some then lead across the surface, unless they are given, and coarser pictures are means. Empty: whole voxels.
  std::vector<double> shares;
  std::optional<VoxelLoad> load;
  VoxelFieldRow fields;    ///< of the load, told of rows of fieldPlanes(); takes 4 bytes more a component and node
  double tolerance = 1e-6; ///< of the energy of each unit strain, relative
  int maxIterations = 500; ///< of each
  /// Of the picture and the elements against the material, from coarser pictures of the same box (StiffnessError.h):
  /// every second, third and fourth voxel. About as much work as the box itself in space, twice that in the plane.
  bool estimateError = true;
  /// Also solves the windows that the box is cut into, halves and thirds of it along each axis, with Straight sides:
  /// how far it speaks for the material that it was cut out of. About twice the work of the box.
  bool windowError = false;
  int nodesPerPixel = 1;                      ///< along each axis: pixels that were split before they came here
  int threads = 1;                            ///< of each rank, above 0
  Communicator ranks{ MPI_COMM_SELF };        ///< all with the same box and settings; they get the same answer
  double memory = 0;                          ///< bytes that may be taken on a machine; 0: what is free
  std::function<bool(double share)> progress; ///< false cancels
};

/// What a load came to.
struct VoxelLoaded
{
  std::vector<double> strain, stress; ///< means over the box, Voigt's order
  double energy = 0;                  ///< mean of σ : ε [Pa], with a change of σ : (ε − what is free)
  double solverError = 0;
  int iterations = 0;
  double seconds = 0;
  /// ∂ energy / ∂ number at that strain [Pa over the number's unit]; where the tensor was not solved for, and nothing
  /// expands.
  std::vector<double> changes;
};

/// How the tensor changes with where the surface between two phases that meet lies.
struct StiffnessSurface
{
  std::uint8_t first = 0, second = 0; ///< phase ids, the first one the lower
  double area = 0;                    ///< over the box's volume [1 / edge of a voxel along x]
  /// Where the first grows into the second by that edge: of `stiffness` [Pa], and of constantValues(); from the fields
  /// of the unit strains (ElasticSystem::surfaces).
  std::vector<double> change, constantChange;
};

struct VoxelStiffness
{
  /// Components² by rows, Voigt's order, shears as angles [Pa]; symmetric. Between platens the diagonal alone: stress
  /// over strain along each axis, free faces. Empty where it was not wanted.
  std::vector<double> stiffness;
  std::vector<double> voigt; ///< bound: all voxels follow the mean strain
  std::vector<double> reuss; ///< bound: stress is uniform; 0 where there are voids
  /// Mean strain of the free box for the materials' `expansion`; empty where none was given.
  std::vector<double> expansion;
  std::optional<VoxelLoaded> loaded;
  double asymmetry = 0;   ///< of the tensor as solved, over the largest component
  double solverError = 0; ///< of the energies, relative: the largest
  double zero = 1e-9;     ///< share of the tensor's largest eigenvalue at most which one counts as none
  ElasticConstants constants;
  /// By number ∂ stiffness / ∂ number, as `stiffness` [Pa over the number's unit]: by Hill's lemma the mean of
  /// ε_i : ∂C/∂number : ε_j over the fields of the unit strains, which to first order stay (of uniform stress the same
  /// of its inverse). Of the elements as they are integrated, so that differences of solves come to the same, where λ
  /// is 2 μ that from above. As exact as the fields: the root of `tolerance`. 0 of phases that count as rigid.
  std::vector<std::vector<double>> changes;
  std::vector<std::vector<double>> constantChanges; ///< the same of constantValues()
  std::vector<StiffnessSurface> surfaces;           ///< where they were asked for
  double changeSeconds = 0;                         ///< for all these, copies of the fields included
  StiffnessError error;
  std::vector<StiffnessStep> steps; ///< every solve, in order
  /// Of the diagonal's components, "xx" ..., and of the constants, by their names; without those that some window does
  /// not have. Empty: not asked for, or the box is too small to be cut.
  std::vector<statistics::WindowError> windows;
  double windowSeconds = 0;

  std::int64_t solidVoxels = 0;
  std::int64_t pieces = 0;                       ///< of the solid, over faces of voxels
  std::int64_t loosePieces = 0, looseVoxels = 0; ///< taken out: they carry nothing
  std::array<bool, 3> crosses{ false, false, false };
  std::array<SideMatch, 3> sides{};
  std::vector<std::string> warnings; ///< each one line, with its numbers

  std::size_t levels = 0;
  double setupSeconds = 0, solveSeconds = 0, estimateSeconds = 0;
  std::int64_t bytes = 0; ///< of all arrays alive at once
};

struct VoxelKinds
{
  bool isotropic = true; ///< all phases are
  bool turns = false;    ///< some follow axes
  bool fields = false;
  bool changes = false;
  int ranks = 1; ///< that share out the nodes; phases and axes each of them has
};
/// Bytes that a box takes of a rank, phases and axes included.
[[nodiscard]] double voxelStiffnessBytes(const Lattice& lattice, const VoxelKinds& kinds);

/// Planes of voxels across the last axis, first and one behind the last, of whose fields a rank is told.
[[nodiscard]] std::array<std::int64_t, 2> fieldPlanes(
  const Lattice& lattice, StiffnessSides sides, const Communicator& ranks);

/// @param phase     ids of lattice.count() voxels, x fastest
/// @param materials by phase id, of the lattice's dimension
/// @param axis      of each voxel, of any length, where some phase follows it; else empty
/// @throws ParameterError: a phase without stiffness, or with one that is not positive definite; NoPathError: the solid
///   leads across the box along no axis; MemoryError before anything is allocated; DivergenceError; Cancelled
[[nodiscard]] VoxelStiffness studyVoxelStiffness(const Lattice& lattice, std::span<const std::uint8_t> phase,
  const std::vector<VoxelMaterial>& materials, std::span<const std::array<float, 3>> axis,
  const VoxelStiffnessOptions& options);

} // namespace lamella::elasticity
