#pragma once

#include "elasticity/ElasticConstants.h"
#include "elasticity/Materials.h"
#include "elasticity/SideMatch.h"
#include "elasticity/StiffnessError.h"
#include "lattice/Lattice.h"

#include <array>
#include <cstdint>
#include <functional>
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
  Straight       ///< faces stay plane and slide on frictionless neighbours: mirror images of the box fill space
};

struct VoxelStiffnessOptions
{
  StiffnessSides sides = StiffnessSides::Periodic;
  /// Strains that phases take when nothing holds them, by phase id, Voigt's order, shears as angles: of a unit of
  /// temperature or moisture. Or none.
  std::vector<std::vector<double>> expansion;
  double tolerance = 1e-6; ///< of the energy of each unit strain, relative
  int maxIterations = 500; ///< of each
  /// Of the picture and the elements against the material, from coarser pictures of the same box (StiffnessError.h):
  /// every second, third and fourth voxel. About as much work as the box itself in space, twice that in the plane.
  bool estimateError = true;
  int nodesPerPixel = 1;                      ///< along each axis: pixels that were split before they came here
  int threads = 1;                            ///< above 0
  double memory = 0;                          ///< bytes that may be taken; 0: what is free
  std::function<bool(double share)> progress; ///< false cancels
};

struct VoxelStiffnessStep
{
  double every = 1;                     ///< pixels between those that are used, about; 1: the box
  int pictures = 1;                     ///< how many were solved
  std::int64_t nodes = 0;               ///< voxels of all of them
  std::vector<double> stiffness;        ///< [Pa], components², mean of them
  std::vector<std::int64_t> iterations; ///< one a unit strain, sums
  double seconds = 0;                   ///< wall
};

struct VoxelStiffness
{
  std::vector<double> stiffness; ///< components² by rows, Voigt's order, shears as angles [Pa]; symmetric
  std::vector<double> voigt;     ///< bound: all voxels follow the mean strain
  std::vector<double> reuss;     ///< bound: stress is uniform; 0 where there are voids
  std::vector<double>
    expansion;            ///< mean strain of the free box for the phases' `expansion`; empty where none was given
  double asymmetry = 0;   ///< of the tensor as solved, over the largest component
  double solverError = 0; ///< of the energies, relative: the largest
  ElasticConstants constants;
  StiffnessError error;
  std::vector<VoxelStiffnessStep> steps; ///< every solve, in order

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

/// Bytes that a box takes, phases included.
[[nodiscard]] double voxelStiffnessBytes(const Lattice& lattice, bool isotropic);

/// @param phase ids of lattice.count() voxels, x fastest
/// @param stiffness by phase id, of the lattice's dimension
/// @throws ParameterError: a phase without stiffness, or with one that is not positive definite; NoPathError: the solid
///   leads across the box along no axis; MemoryError before anything is allocated; DivergenceError; Cancelled
[[nodiscard]] VoxelStiffness studyVoxelStiffness(const Lattice& lattice, std::span<const std::uint8_t> phase,
  const std::vector<PhaseStiffness>& stiffness, const VoxelStiffnessOptions& options);

} // namespace lamella::elasticity
