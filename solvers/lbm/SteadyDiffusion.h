#pragma once

#include "lattice/Decomposition.h"
#include "lattice/Lattice.h"

#include <mpi.h>

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace lamella::lbm
{

struct LinkTable;
struct DirectedDiffusivity;

/// What a link conducts, by the ids at its two ends: link[a * ids + b], symmetric, finite, ≥ 0, in the unit of the
/// diffusivities. A node's own, link[a * ids + a], is what it conducts to a wall, and its diffusivity. Or three such
/// tables one after the other, by the axis of the link, with the same diffusivities.
struct PairTable
{
  std::size_t ids = 0;
  std::vector<double> link;
};

enum class Stencil
{
  D2Q5,
  D2Q9,
  D3Q7,
  D3Q19,
  Q1 ///< no links: trilinear elements between the corners of voxels, in pictures bilinear ones
};
[[nodiscard]] const char* name(Stencil stencil) noexcept;

/// What bounds the box. Insulated: value 1 and 0 on the two faces of the direction that is solved for, half a spacing
/// outside the outer nodes, and no flux through all others. Periodic: a cell of an infinite medium under a mean
/// gradient; every side is periodic and the full effective tensor follows. Mixed: values on the two faces, periodic
/// across.
enum class Sides
{
  Insulated,
  Periodic,
  Mixed
};

enum class Method
{
  Auto,
  LeanMultigrid,     ///< geometric multigrid on blocks of nodes, 8.5 bytes a node; every node conducts
  PieceMultigrid,    ///< the same on pieces of blocks: any contrast, and phases that do not conduct
  Multigrid,         ///< operator-dependent geometric multigrid, conjugate gradients; every node conducts
  AlgebraicMultigrid ///< conducting nodes only, compact; phases of conductivity 0 are neither stored nor visited
};
[[nodiscard]] const char* name(Method method) noexcept;

/// Called now and then with the share done (0 … 1) and what is being done; returning false cancels (throws Cancelled).
using Progress = std::function<bool(double, const char*)>;

struct SteadyOptions
{
  Stencil stencil = Stencil::D2Q5;
  Sides sides = Sides::Insulated;
  Method method = Method::Auto;
  double tolerance = 1e-8; ///< largest relative error of the effective value and of the flux through either face
  /// Largest relative error of the field in the energy norm, which is that of its flux; infinity when only the
  /// effective value is wanted, for which the square root of the tolerance will do.
  double fieldTolerance = 1e-6;
  /// One answer among many, whose scatter is far larger than the tolerance: the first estimate of the error that there
  /// is is believed. Where it is wrong the value is off by some times the tolerance.
  bool rough = false;
  int maxIterations = 500;
  int threads = 1;
  Progress progress;
  /// Conductivities of links by the phase ids at both ends instead of harmonic means; straight links only. Or none.
  std::shared_ptr<const PairTable> pairs;
  /// Conductivities of the links one by one instead of harmonic means of the phases': D2Q5, or with diagonals D2Q9
  /// (linksOf(), directedLinks()).
  std::shared_ptr<const LinkTable> links;
  /// With Q1: a tensor in every node of this rank's block. The diffusivities are then directed->larger(). Or none.
  std::shared_ptr<const DirectedDiffusivity> directed;
};

/// How an effective conductivity changes with those that it is made of, at its own direction: ∂K/∂k, one number each.
struct ConductivityDerivatives
{
  std::vector<double> along;     ///< by phase id; of shares of the low and of the high phase. NaN: it does not conduct
  std::vector<double> across;    ///< of phases that conduct along and across an axis; empty where none does
  std::vector<double> membranes; ///< by resistance, of each membrane (Membranes.h); empty where there is none
};

/// How it changes where a surface between two phases is moved: by pair of ids, [a * ids + b] with a < b.
struct SurfaceDerivatives
{
  std::vector<double> shift; ///< ∂K/∂δ, a growing into b; per spacing along x
  std::vector<double> area;  ///< of the surface, per spacing along x: squares of it over cubes (lengths over squares)
};

using lamella::Block;
using lamella::decompose;

/// Layers along z of a rank's block: from the first one on, the last not included.
struct Layers
{
  std::int64_t first = 0;
  std::int64_t last = 0;
};

/// Answer for one direction.
struct SteadyResult
{
  std::array<double, 3> effective{ 0, 0, 0 }; ///< column of the effective tensor: mean flux / mean gradient, -q_i/G
  double inletFlux = 0;                       ///< effective conductivity seen at the face of value 1
  double outletFlux = 0;                      ///< the same at the face of value 0
  double balance = 0;                         ///< worse of |inlet − energy| and |outlet − energy|, over the energy
  int iterations = 0;
  double solverError = 0;   ///< estimated relative error that iteration leaves in the effective value
  double residual = 0;      ///< relative 2-norm of the residual, in double
  double setupSeconds = 0;  ///< wall
  double solveSeconds = 0;  ///< wall
  std::int64_t nodes = 0;   ///< nodes in the box
  std::int64_t stored = 0;  ///< nodes that the solver stored and visited
  std::int64_t skipped = 0; ///< nodes that do not conduct or are cut off from both faces
  std::uint64_t bytes = 0;  ///< in the solver's arrays at their largest, all ranks
  Method method = Method::Auto;
};

/// Steady diffusion div(D grad u) = 0 on a picture: the symmetric positive definite system that is exactly the steady
/// state of two-relaxation-time lattice Boltzmann with Λ⁺Λ⁻ = ¼: link conductance 6 w_q × harmonic mean of the two
/// diffusivities, 12 D w_q to a wall value half-way, diagonal links reflected specularly at insulated sides.
///
/// With D2Q5 and D3Q7 this is the cell-centred finite volume scheme with harmonic faces. Q1 is another scheme: elements
/// (ElementSystem.h), for tensors of any ratio and direction.
///
/// Solved by multigrid (Method). Multigrid and AlgebraicMultigrid: conjugate gradients in single precision,
/// preconditioned by one cycle, on a field and its residual in double. LeanMultigrid and PieceMultigrid: plain cycles
/// on a field in single precision, without residual; auto takes them for volumes of which the value is wanted, or where
/// memory is short. The effective conductivity is the energy uᵀAu, whose error is the square of the field's. At the end
/// a Galerkin correction over the planes across the direction makes the flux through each of them, both faces included,
/// equal to that energy (PlaneBalance).
class SteadyDiffusion
{
public:
  /// @param lattice     the whole box
  /// @param block       the part this rank holds (decompose()); the whole box on one rank
  /// @param phase       block.size[0] * block.size[1] * block.size[2] phase ids of this rank, which outlive the solver
  /// @param diffusivity one value a phase id, finite and ≥ 0; 0: does not conduct
  /// @throws ParameterError (stencil against dimension, values out of range, links that do not fit), MemoryError
  SteadyDiffusion(const Lattice& lattice, const Block& block, std::span<const std::uint8_t> phase,
    std::span<const double> diffusivity, SteadyOptions options, MPI_Comm comm = MPI_COMM_SELF);
  /// The same, ids handed over.
  SteadyDiffusion(const Lattice& lattice, const Block& block, std::vector<std::uint8_t>&& phase,
    std::span<const double> diffusivity, SteadyOptions options, MPI_Comm comm = MPI_COMM_SELF);
  ~SteadyDiffusion();
  SteadyDiffusion(SteadyDiffusion&&) noexcept;
  SteadyDiffusion& operator=(SteadyDiffusion&&) noexcept;

  /// Does a conducting path lead across the box along `axis`?
  [[nodiscard]] bool percolates(int axis);

  /// Solves with value 1 on the low face of `axis` and 0 on the high one (periodic: mean gradient −1 per box length).
  /// @throws NoPathError, DivergenceError, Cancelled
  SteadyResult solve(int axis);

  /// The field of the last solve on this rank's block, 0 … 1; NaN where nothing conducts.
  /// Periodic: the linear part included, so it runs from 1 to 0 on average.
  void value(std::span<double> out) const;

  /// Flux of the last solve on this rank's block: three components a node (interleaved), −D grad u with u per metre of
  /// lattice spacing; the mean over the box times the box length is the effective column. 0 where nothing conducts.
  void flux(std::span<double> out) const;

  /// The same of some layers alone, so that a field that is large can be handed on without being held. Collective:
  /// every rank takes part in the first one, with layers or none.
  void value(std::span<double> out, Layers layers) const;
  void flux(std::span<double> out, Layers layers) const;

  /// Of the last solve, from the energy of its field alone: that is a minimum over fields, so to first order it changes
  /// with the conductivities as if the field stayed. K = Σ k ∂K/∂k. As exact as the field (fieldTolerance, or the root
  /// of tolerance). Memory while it runs: none; 16 bytes a node of the algebraic methods.
  /// Collective.
  /// @throws ParameterError for links that were given one by one
  [[nodiscard]] ConductivityDerivatives derivatives() const;
  /// The same of links that were given by pairs of ids, by the logarithm of each: [a * ids + b], a ≤ b; where tables
  /// were given by axis, three such.
  [[nodiscard]] std::vector<double> pairDerivatives() const;
  /// What moving the surfaces between phases does, from the field alone (SurfaceDerivatives.h): 0.73 to 1.01 of what it
  /// does, on elements 0.91 to 1.02. 16 bytes a node while it runs, of lean multigrid and elements none; on ranks of
  /// elements each has all phases for a while. Collective.
  /// @throws ParameterError for links that were given, as along and across on d2q9
  [[nodiscard]] SurfaceDerivatives surfaceDerivatives() const;

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The method that takes the least memory; what auto falls back on where another one does not fit.
[[nodiscard]] Method leanest(const Lattice& lattice, Stencil stencil, bool everyNodeConducts) noexcept;

/// Ranks that share the solver's arrays out: all of them; of elements, in a box with less than two layers a rank along
/// the longer one of y and z, none, for then every rank works on all of it.
[[nodiscard]] int ranksSharing(const Lattice& lattice, Stencil stencil, int ranks) noexcept;

/// Bytes that solving on this many nodes takes in solver arrays, before anything is allocated.
[[nodiscard]] std::uint64_t estimateBytes(
  const Lattice& lattice, Stencil stencil, Method method, std::int64_t conducting);

} // namespace lamella::lbm
