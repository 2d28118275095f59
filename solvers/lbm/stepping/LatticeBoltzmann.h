#pragma once

#include "core/Error.h"
#include "io/RunCheckpoint.h"
#include "lattice/Decomposition.h"
#include "lattice/Lattice.h"
#include "lbm/Links.h"
#include "lbm/SteadyDiffusion.h"

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

enum class Collision
{
  Auto, ///< TRT, always
  BGK, ///< one relaxation time, as in the first paper: D = (τ − ½) δx²/(3 δt); faces and mirrors on the outer nodes
  TRT ///< two relaxation times, Λ⁺Λ⁻ = ¼ in every node, Λ⁻ = 3 D δt/δx²; faces half a spacing outside the outer nodes
};
[[nodiscard]] const char* name(Collision collision) noexcept;

struct SteppingOptions
{
  Stencil stencil = Stencil::D2Q5;
  Collision collision = Collision::Auto;
  std::array<Boundary, 3> sides{ Boundary::Fixed, Boundary::Insulated, Boundary::Insulated };
  /// Values on the low and the high face of each axis whose sides are fixed.
  std::array<std::array<double, 2>, 3> faceValues{ { { 1, 0 }, { 1, 0 }, { 1, 0 } } };
  int axis = 0; ///< along which the flux is watched
  /// Where the sides of `axis` are periodic: by how much the value falls over a box length (a mean gradient).
  double drop = 0;
  /// Only the state at rest is wanted: pieces that reach neither face (periodic: that no flux crosses) are not stored,
  /// stepping starts with a value that falls evenly from face to face, and time is a means (relaxation 0: the scale
  /// that comes to rest soonest).
  bool steady = false;
  /// τ − ½ (TRT: Λ⁻) of the phase that conducts best. 0: from the time step; without one, TRT ½, BGK ½, and see
  /// `steady`.
  double relaxation = 0;
  double timeStep = 0; ///< [s]; 0: from the relaxation. Not both
  int threads = 1;
  double memory = 0; ///< bytes that each rank may take; 0: what the machine has
  Progress progress;
  io::CheckpointOptions checkpoint; ///< `every` in steps
};

/// The steps allowed were not enough to come to rest; more may be.
class StepLimitError : public DivergenceError
{
  using DivergenceError::DivergenceError;
};

struct RestOptions
{
  double tolerance = 1e-8; ///< estimated relative error of the flux through either face, and how far they differ
  std::int64_t maxSteps = 10'000'000;
};

struct RestResult
{
  double effective = 0;  ///< mean of what the two faces say [m²/s]
  double inletFlux = 0;  ///< effective diffusivity seen at the low face (periodic: at the low side)
  double outletFlux = 0; ///< the same at the high face (periodic: half-way across)
  /// |inlet − outlet| over the mean; at rest the worst of this, of what crosses any plane between and, with two
  /// relaxation times, of what is dissipated over the fall of the value, against that mean.
  double balance = 0;
  double change = 0; ///< estimated relative error that stepping leaves in the worse of the two
  std::int64_t steps = 0;
};

/// What run() notes where it is to stop on the way.
struct SteppingRecord
{
  std::int64_t steps = 0;
  double time = 0;                  ///< [s]
  std::array<double, 2> faceFlux{}; ///< NaN where √(D t) of the best phase on the face is below the spacing yet
  double mean = 0;
};

struct SteppingStatistics
{
  std::int64_t nodes = 0;   ///< in the box
  std::int64_t stored = 0;  ///< that take part
  std::int64_t skipped = 0; ///< that do not conduct, or (steady) are cut off
  std::int64_t steps = 0;
  std::int64_t updates = 0;  ///< of nodes
  double seconds = 0;        ///< wall, stepping alone
  std::uint64_t bytes = 0;   ///< in arrays, all ranks
  double bytesPerUpdate = 0; ///< that a step reads and writes in memory at most, a node: see LatticeBoltzmann
};

/// Lattice Boltzmann for diffusion ∂u/∂t = div(D grad u) in a picture of any number of phases, each with its own
/// diffusivity and all of capacity 1, in real time.
///
/// One relaxation time: Perré, Almeida, Ayouz & Frank, Annals of Forest Science 73 (2016) 147, eqs. 1 – 13; lengths are
/// (n − 1) δx between faces. Its answer depends on τ (warning()). Two relaxation times: Ginzburg, Adv. Water Resour. 28
/// (2005) 1171, with anti-bounce-back at the faces and specular insulated sides; lengths are n δx, and the state at
/// rest is SteadyDiffusion's whatever the time step.
///
/// Nodes of diffusivity 0 are neither stored nor visited; populations bounce back from them. Memory: 8 Q + 1 bytes a
/// stored node (Q = 5, 9, 6, 19 on D2Q5, D2Q9, D3Q7, D3Q19: the one at rest of D3Q7 weighs nothing), 3/2 bits a node,
/// and about 16 + 4 Q bytes for each run of nodes along x between two voids. A pair of steps reads and writes all of it
/// once at most, so an update moves 8 Q + ½ bytes, and less where several pairs fit the cache.
///
/// Steps come in pairs: every count of steps is even.
class LatticeBoltzmann
{
public:
  /// @param lattice     the whole box
  /// @param block       the part this rank holds: decompose()
  /// @param phase       block.count() phase ids of this rank
  /// @param diffusivity one a phase id [m²/s], finite and ≥ 0; 0: does not conduct
  /// @throws ParameterError, NoPathError (steady, no way across), MemoryError. Collective, as all members that say so
  LatticeBoltzmann(const Lattice& lattice, const Block& block, std::span<const std::uint8_t> phase,
    std::span<const double> diffusivity, SteppingOptions options, MPI_Comm comm = MPI_COMM_SELF);
  ~LatticeBoltzmann();
  LatticeBoltzmann(LatticeBoltzmann&&) noexcept;
  LatticeBoltzmann& operator=(LatticeBoltzmann&&) noexcept;

  /// Starts again at time 0 with this value everywhere (0 without a call), or these at the nodes of this rank's block
  /// (those that are not stored are not looked at). @throws ParameterError when one is not finite. Collective.
  void start(double value);
  void start(std::span<const double> value);

  /// @throws DivergenceError, which names step and quantity, within two passes of what went wrong. Collective.
  void advance(std::int64_t steps);
  /// Steps on to each of these numbers of steps, which are even and do not fall, notes a record there and calls `sink`.
  /// Checkpoints are written after every so many steps, at the end, and where it is cancelled. Collective.
  using Sink = std::function<void(const LatticeBoltzmann&)>;
  void run(std::span<const std::int64_t> steps, const Sink& sink);
  /// The same to the steps that are nearest to these times [s]: see stepsAt().
  void run(std::span<const double> times, const Sink& sink);
  /// The even number of steps whose end is nearest to this time [s].
  [[nodiscard]] std::int64_t stepsAt(double time) const;
  /// Of every stop of run() since the start, also before the checkpoint that this run went on from.
  [[nodiscard]] std::span<const SteppingRecord> records() const noexcept;
  /// Steps until the flux through both faces is at rest. @throws StepLimitError when maxSteps are not enough,
  /// DivergenceError, Cancelled
  RestResult rest(const RestOptions& options = {});

  [[nodiscard]] std::int64_t steps() const noexcept;
  [[nodiscard]] double time() const noexcept;       ///< [s]
  [[nodiscard]] double timeStep() const noexcept;   ///< [s]
  [[nodiscard]] double relaxation() const noexcept; ///< τ − ½ of the phase that conducts best

  /// The value on this rank's block, NaN where nothing is stored.
  void value(std::span<double> out) const;
  /// The flux on this rank's block, −D grad u [m/s]: three components a node, interleaved; 0 where nothing is stored.
  void flux(std::span<double> out) const;
  /// Mean flux through the low and the high face of the axis over the last step [m/s], positive along the axis; 0
  /// before the first. Collective.
  [[nodiscard]] std::array<double, 2> faceFlux() const;
  /// Mean of the value over the box, 0 where nothing is stored; what insulated sides conserve. Collective.
  [[nodiscard]] double mean() const;

  /// What a user should know of the accuracy at these relaxation times, or nothing.
  [[nodiscard]] std::string warning() const;
  /// What a run to so many steps does not resolve, or nothing: where √(D t) is less than a spacing, the value changes
  /// within a node. Populations carry a third or more of it away at once: fluxes beside such nodes can be off by all of
  /// themselves, and means by a few per cent of what is in these nodes.
  [[nodiscard]] std::string shortRunWarning(std::int64_t steps) const;
  [[nodiscard]] SteppingStatistics statistics() const; ///< collective

  [[nodiscard]] std::int64_t checkpoints() const noexcept;    ///< written by this object
  [[nodiscard]] std::int64_t lastCheckpoint() const noexcept; ///< steps in the last of them; 0: none
  /// Writes options.checkpoint.path now; goes on from one, after start(), to the same bits on any number of ranks.
  /// @throws InputError of another scene or kind. Collective.
  void save();
  void restore(const std::filesystem::path& path);

private:
  /// Writes a checkpoint, where they are asked for, if so many steps were taken since the last.
  void saveAfter(std::int64_t steps);
  /// After options.checkpoint.every, where its seconds have passed.
  void saveEvery();

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

} // namespace lamella::lbm
