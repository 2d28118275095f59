#pragma once

#include "peridynamics/ElasticStudy.h"
#include "peridynamics/fracture/Dynamics.h"
#include "peridynamics/fracture/Fracture.h"
#include "peridynamics/fracture/NodeDamage.h"
#include "peridynamics/fracture/SideLoads.h"

#include <array>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

/// The whole job of bonds in motion: from phases, materials and densities to a history with every energy, broken bonds
/// and fields.
namespace lamella::peridynamics
{

/// A point of the history.
struct MotionPoint
{
  std::int64_t step = 0;
  double time = 0; ///< [s]
  /// Of the platens of a pull; else how far the two sides have moved apart on the mean, over the distance between them.
  double strain = 0;
  /// Of a pull the mean force on both platens over the section, else the mean over the box, along the axis [Pa].
  double stress = 0;
  double rate = 1; ///< of the imposed speeds, over what they are without regulation
  EnergyBalance energies;
  std::int64_t broken = 0; ///< bonds
};

struct MotionState : BrokenState
{
  double time = 0;                             ///< [s]
  std::optional<NodeField<double>> velocity{}; ///< [m/s]
};

enum class MotionEnd
{
  Time,
  StressFell, ///< of a pull, to MotionEnds::stopShare of the peak
  MaxStrain,
  MaxBroken
};
[[nodiscard]] std::string describe(MotionEnd end);

/// A pull by two platens, as SlowPull begins it.
struct PullOptions
{
  Loading loading{};     ///< Stretch or Shear; the strain's sign is the direction, its size is of no account
  double strainRate = 0; ///< Γ₀ [1/s]; 0: as `transits` says
  /// Travel times of a wave from platen to platen until the strain at which the first bond breaks in small strains.
  double transits = 30;
  /// Starts at this share of that strain, in equilibrium and with the speeds that the pull would have given it, 0 … 1.
  double startShare = 0.98;
};

/// The speeds give way to what breaks: RegulatedRate.
struct RegulationOptions
{
  double relaxation = 0;      ///< τ [s]; 0: the speeds are constant
  double referenceEnergy = 0; ///< ω₀ [J], [J/m in 2D]; 0: as referenceCrack says
  /// Δℓ [m]: ω₀ opens a crack of that length (in space that square) in the pair of phases with the least fracture
  /// energy; 0: a hundredth of the sample's shortest side.
  double referenceCrack = 0;
  double start = 1; ///< 0 … 1, of the speeds at first; below 1 only with a relaxation time
};

/// The first that comes.
struct MotionEnds
{
  double time = std::numeric_limits<double>::infinity();          ///< [s]
  double stopShare = 0.05;                                        ///< of a pull, once a bond has broken
  double strain = std::numeric_limits<double>::infinity();        ///< a pull ends at 1 at the latest
  std::int64_t broken = std::numeric_limits<std::int64_t>::max(); ///< bonds, or a few more
};

struct DynamicsStudyOptions
{
  /// Its densities and its rate are of no account.
  DynamicsOptions motion{};
  std::vector<double> densities{}; ///< by phase [kg/m³]; 0, and what is beyond: DynamicsOptions::density
  std::optional<PullOptions> pull{};
  /// Without a pull: nodes that keep a velocity, and tractions.
  std::vector<MovedNodes> moved{};
  std::vector<SideTraction> tractions{};
  int axis = -1;                             ///< of strain and stress without a pull; -1 the last one
  std::array<double, 3> velocity{ 0, 0, 0 }; ///< of all that is free, at the start [m/s]
  /// Fills velocities at the start to be added [m/s]; collective.
  std::function<void(NodeField<double>&)> startVelocity{};
  RegulationOptions regulation{};
  MotionEnds ends{};
  std::int64_t every = 0;        ///< steps between two points of the history; 0: 500 until the end's time, at least
                                 ///< 20 steps apart; else every 10 steps
  std::vector<double> atTimes{}; ///< states to keep, at the nearest step [s]
  std::vector<std::int64_t> atBroken{};    ///< likewise, at the first point of the history with so many broken bonds
  bool displacement = true;                ///< of the states
  bool velocities = true;                  ///< likewise
  bool stress = false;                     ///< of every node
  bool energyDensity = false;              ///< likewise
  std::function<void(MotionState)> keep{}; ///< given the states as they come, the end last; called on every rank
  /// Called with the point reached and the share that is done, some times a second at most; true asks to stop.
  std::function<bool(const DynamicsProgress&, double)> progress{};
  int threads = 0;   ///< 0: as many as OpenMP would take
  double memory = 0; ///< bytes that may be taken on this machine; 0: what is free
};

struct DynamicsResult : SampleCounts
{
  MotionEnd end = MotionEnd::Time;
  std::vector<MotionPoint> history; ///< from the start on, the end last; of a run that went on, of all its parts
  MotionPoint peak;                 ///< of the history, the largest stress
  std::vector<DynamicBreak> broken;
  std::vector<BondEnds> ends;      ///< of these
  double step = 0;                 ///< [s]
  double stable = 0;               ///< the largest stable step [s]
  double viscosity = 0;            ///< ν [kg/s], [kg/(m s) in 2D]
  double density = 0;              ///< mean over the box [kg/m³]
  double referenceEnergy = 0;      ///< ω₀ [J], [J/m]; 0 without regulation
  double modulus = 0;              ///< of a pull: stress over strain of the unbroken sample [Pa]; else NaN
  double firstBreak = 0;           ///< of a pull: strain at which the first bond breaks in small strains; else NaN
  double strainRate = 0;           ///< of a pull, at a rate of 1 [1/s]; else NaN
  double travelTime = 0;           ///< of a pull: of a wave from platen to platen [s]; else NaN
  std::vector<double> missedTimes; ///< states asked for that the run ended before
  std::vector<std::int64_t> missedNumbers;
  std::int64_t continuedAt = 0;  ///< steps in DynamicsOptions::continueFrom; 0: from the start
  std::int64_t checkpointAt = 0; ///< steps in the last checkpoint that was written; 0: none
  std::int64_t checkpoints = 0;  ///< written
  std::int64_t statesBefore = 0; ///< states asked for that lie before the one it went on from

  int axis = 0;      ///< of strain and stress
  double area = 0;   ///< of a section across the axis, voids included [m²]; of a picture [m], a metre deep
  double length = 0; ///< between the inner layers of the sides [m]
  std::array<std::int64_t, 2> lowPlaten{}; ///< [first, last) of the sides
  std::array<std::int64_t, 2> highPlaten{};
  std::int64_t loosePieces = 0; ///< of a pull: pieces that no platen holds; they stay where they are
  std::int64_t looseNodes = 0;
  std::vector<std::string> warnings; ///< each one line, with its numbers

  double bondSeconds = 0;   ///< making the bonds
  double startSeconds = 0;  ///< masses, loads, equilibrium of a pull
  double motionSeconds = 0; ///< with its history
  double stateSeconds = 0;  ///< fields of the states
  std::int64_t bytes = 0;   ///< of all ranks: bonds and motion
};

/// @param phase, grain as BondLattice
/// @throws what BondLattice, SlowPull, BondDynamics, imposeMotion() and tractionLoad() throw; ParameterError where
/// nothing moves the sample, where no end is told, and for numbers outside their range; MemoryError before anything is
/// allocated; Cancelled when progress asks to stop
[[nodiscard]] DynamicsResult studyDynamics(const BondModel& model, const Lattice& lattice,
  std::span<const std::uint8_t> phase, std::span<const std::int32_t> grain, const DynamicsStudyOptions& options,
  const Communicator& comm);

/// Bytes that one rank takes at most, the states kept not counted.
/// @throws ParameterError as BondLattice::bytesNeeded()
[[nodiscard]] double dynamicsBytes(
  const BondModel& model, const Lattice& lattice, bool grains, const DynamicsStudyOptions& options, int ranks);

} // namespace lamella::peridynamics
