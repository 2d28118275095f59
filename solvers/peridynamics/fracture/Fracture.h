#pragma once

#include "peridynamics/BondForces.h"
#include "peridynamics/BondLattice.h"
#include "peridynamics/Loading.h"
#include "peridynamics/fracture/CrackContact.h"
#include "peridynamics/fracture/FractureCheckpoint.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

/// Quasi-static fracture in small strain: the load rises until a bond is critical; it breaks, the sample comes to
/// equilibrium again, and so on until none is critical; then the load rises further. This is the scheme of the first
/// paper's figure 15 (which breaks all critical bonds at once: Batched), with the ramp between two breaks jumped by
/// scaling, since between breaks everything is in proportion to the load. Done fast: docs/solvers/fracture.md.
namespace lamella::peridynamics
{

enum class FractureMethod
{
  /// Local corrections around every break, global ones now and then; sides not periodic. Samples of a hundred nodes or
  /// fewer are solved as Accurate does. On any number of ranks, which all hold the whole sample and share out the
  /// global corrections: the same bonds in the same order, and the same numbers to the last bit.
  Events,
  Accurate ///< one equilibrium a break, to FractureOptions::tolerance: slow, to check against; any number of ranks
};

enum class Breaking
{
  Strict, ///< one bond at a time, the most critical
  Batched ///< all that are critical at once, as in the papers; after the peak the path depends on it. Accurate only
};

/// How FractureMethod::Events trades time for accuracy. With the defaults the peak was within 0.02 % and 98 to 100 % of
/// the broken bonds were those of FractureMethod::Accurate, on cemented grains and on wood.
struct EventOptions
{
  /// Nodes around a broken bond that are corrected on the finest level. 0: 12 in the plane, 6 in space.
  int radius = 0;
  /// On each coarser one, beyond what the finer one's window covers. 0: 6 in the plane, 4 in space.
  int coarseRadius = 0;
  double reduction = 0.02; ///< of the residual around the bond, over the force that it carried
  int maxCycles = 12;      ///< around a bond
  /// Events of an avalanche between two global corrections; in the plane between two of a wide window around them, and
  /// every fifth is global.
  int globalEvery = 20;
  int globalIterations = 6;      ///< of conjugate gradients in a global correction, at most
  double globalTolerance = 1e-4; ///< of its residual force, as EquilibriumOptions::tolerance counts
  /// Where a second bond is as near to its limit as this, a global correction to rivalTolerance says which of them
  /// breaks: globalEvery local corrections leave errors of some 0.5 %, and the margin grows with their number. In the
  /// plane a wide window is corrected first, and the whole lattice where the second is ten times nearer still. 0:
  /// never, which is sooner by a third to a half; the peak is the same, but after it cracks in thin walls may take
  /// another way.
  double rivals = 5e-3;
  double rivalTolerance = 5e-5;
  /// The same before the load rises, on which the peak depends. 0: 1e-6 in the plane, 2e-6 in space, and where little
  /// is carried 5e-4 of that, but not below 1e-7.
  double riseTolerance = 0;
  /// The same where the stress stays a twentieth below the largest so far: no strength depends on it any more.
  double softeningTolerance = 5e-6;

  /// riseTolerance, or what it is without one.
  /// @param carried as FractureRecord::carried: tolerances count over the force under even strain
  [[nodiscard]] double beforeRise(int dimension, double carried) const noexcept
  {
    constexpr double least = 1e-7; // states are in single precision
    if (riseTolerance > 0)
      return riseTolerance;
    return std::clamp(5e-4 * carried, least, dimension == 3 ? 2e-6 : 1e-6);
  }
};

/// Where a fracture stands, for FractureOptions::progress.
struct FractureProgress
{
  double share = 0;            ///< done, 0 … 1; never falls. A guess before the peak
  std::int64_t broken = 0;     ///< bonds so far
  double strain = 0;           ///< now
  double stress = 0;           ///< now [Pa]
  double peakStress = 0;       ///< so far [Pa]
  std::int64_t checkpoint = 0; ///< events in the last file that this run wrote; 0: none yet
  double equilibrium = 1;      ///< share of the first equilibrium that is done; until then the others are 0
};

struct FractureOptions
{
  FractureMethod method = FractureMethod::Events;
  Breaking breaking = Breaking::Strict;
  /// Ends when the stress has fallen to this share of the peak; 0: not before nothing holds or nothing breaks any more,
  /// which may take long, for hinges never part in small strain.
  double stopShare = 0.05;
  double maxStrain = std::numeric_limits<double>::infinity(); ///< ends before the strain is raised beyond
  /// The strain is raised to multiples of this, each time to the first at which a bond is critical (the papers' way, in
  /// which batches are larger and fewer); 0: to where the next bond just is.
  double strainStep = 0;
  std::int64_t maxBroken = std::numeric_limits<std::int64_t>::max(); ///< ends after so many broken bonds
  /// Cracks close: a bond that broke carries compression as before where its ends are nearer than at first
  /// (CrackContact). Pieces that come loose stay, for others may press on them. Accurate only; not under a pressure.
  bool contact = false;
  /// With contact: bonds that are broken from the beginning, as those that a notch cut. Of the whole lattice, on every
  /// rank.
  std::vector<KnownBond> cracks{};
  /// Strains at which the load turns round, positive along it: from 0 to the first, on to the next and so on, over 0 to
  /// the other side where signs differ, until the last is reached. Empty: the strain rises only. stopShare is of no
  /// account then. Accurate only; not under a pressure, with neither strainStep nor maxStrain.
  std::vector<double> turningPoints{};
  double tolerance = 1e-6; ///< of an equilibrium, as EquilibriumOptions::tolerance; at most 1e-3
  EventOptions events{};
  /// Events after which all that is only there to save work is made anew, whether a checkpoint is written or not: so
  /// the same bonds break with checkpoints and without, and in a run that goes on from one. 0: never, and no
  /// checkpoints.
  std::int64_t renewEvery = 500;
  CheckpointOptions checkpoint{};       ///< at renewals only
  std::filesystem::path continueFrom{}; ///< a checkpoint of the same scene; empty: from the unbroken sample
  /// As those of DynamicsOptions.
  std::function<void(io::Checkpoint&)> keepWith{};
  std::function<void(const io::Checkpoint&)> takeBack{};
  /// Called after every iteration of the first equilibrium, where true makes the constructor throw Cancelled, and after
  /// every event, where true asks to stop, see FractureEnd::Interrupted.
  std::function<bool(const FractureProgress&)> progress{};
};

struct BrokenBond
{
  Bond bond;
  std::int64_t event = 0; ///< from 1; bonds of a batch share it
  double strain = 0;      ///< imposed when it broke; negative against the loading, as are the others
  /// At which it was just critical: the strain itself when the load had been raised to it, less in an avalanche. Taken
  /// as the load, this is the path that follows every snap-back; in strict breaking the bonds and their order are the
  /// same under either control.
  double criticalStrain = 0;
  double stress = 0; ///< at the imposed strain, before it broke [Pa]
};

/// A state in which no bond is critical, or one just is.
struct CurvePoint
{
  double strain = 0;
  double stress = 0;       ///< [Pa]
  std::int64_t broken = 0; ///< bonds so far
};

/// From one turning point of the load to the next, or from 0 to the first. Work and energies are those of a volume of
/// the box between the platens [J/m³].
struct LoadBranch
{
  double from = 0; ///< strain
  double to = 0;
  double stress = 0;   ///< at its end [Pa]
  double modulus = 0;  ///< stress over strain there [Pa]: the slope of what is left on that side; NaN at a strain of 0
  double work = 0;     ///< ∫ σ dε: negative where the sample gives more back than it takes
  double released = 0; ///< of it: what the sample neither held before nor holds at the end; went with the breaks
  std::int64_t broken = 0; ///< bonds on the way
};

enum class FractureEnd
{
  Running,    ///< run() has not been called
  StressFell, ///< to FractureOptions::stopShare of the peak
  Severed,    ///< no piece reaches from platen to platen any more
  /// No bond that can break is stretched, or it would take a thousand times the strain of the first break.
  NothingBreaks,
  MaxStrain,
  MaxBroken,
  Interrupted, ///< by FractureOptions::progress; run() goes on
  PoresOpen,   ///< LoadCase::Pressure: walls have parted, and no pressure is in balance any more
  LastTurn     ///< the last of FractureOptions::turningPoints was reached
};
[[nodiscard]] std::string describe(FractureEnd end);

/// What was visited, and what it cost.
struct FractureStatistics
{
  std::int64_t events = 0;
  std::int64_t raises = 0;           ///< of the load; each jumps the elastic ramp up to the next break
  std::int64_t equilibria = 0;       ///< over the whole sample
  std::int64_t globalIterations = 0; ///< of conjugate gradients, over all of these
  std::int64_t localCycles = 0;
  std::int64_t nodesVisited = 0; ///< of the finest level, by local cycles
  std::int64_t searches = 0;     ///< for loose pieces, where two ends had no neighbour in common
  std::int64_t loosePieces = 0;  ///< taken out since the start
  std::int64_t looseNodes = 0;
  std::int64_t looseBonds = 0; ///< of these pieces, taken out unbroken
  double globalSeconds = 0;    ///< wall time
  double localSeconds = 0;
  double searchSeconds = 0; ///< for the most critical bond, and for loose pieces
  double totalSeconds = 0;
  std::int64_t checkpoints = 0; ///< that were written
  double checkpointSeconds = 0;
  std::int64_t bytes = 0; ///< of all that is held beside the bonds, on this rank
};

struct FractureRecord
{
  FractureEnd end = FractureEnd::Running;
  std::vector<BrokenBond> broken; ///< in the order in which they broke
  /// Strain control: the strain never falls, but with turning points, where the curve has the passages of 0, too; from
  /// point to point it is straight.
  std::vector<CurvePoint> curve;
  std::vector<LoadBranch> branches; ///< that are done, with turning points
  CurvePoint peak;                  ///< the largest stress
  CurvePoint trough;                ///< the largest against the loading: negative, or 0
  CurvePoint first;                 ///< when the first bond broke
  double modulus = 0;               ///< stress over strain of the unbroken sample [Pa]
  /// Largest difference of the force through a section to that on the platens, over the latter, at the first
  /// equilibrium: the modulus and the first break may be off by as much. 0 in a run that goes on.
  double imbalance = 0;
  /// Force on the platens at the first equilibrium over the one under even strain. Residuals count over the latter, so
  /// a tolerance leaves about tolerance/carried of stresses and strengths. 0 in a run that goes on.
  double carried = 0;
  FractureStatistics statistics;
};

/// Lines "what: value" of all about a load and its options that decides over the bonds that break. Limits do not.
[[nodiscard]] std::string sceneOf(const Loading& loading, const FractureOptions& options);
/// The same of the forces on the sample; empty where platens load it. Collective.
[[nodiscard]] std::string sceneOf(const BondLattice& bonds, const LoadedSample& sample);

/// What the method does between two breaks.
class FractureEngine;
enum class Nearness;
struct EngineState;
class PlatenForce;

/// Breaks a sample under a strain that only rises.
class QuasiStaticFracture
{
public:
  /// Solves the first equilibrium, or goes on from FractureOptions::continueFrom: the same bonds then break, in the
  /// same order and to the last bit of every number on one rank or as many as wrote it, as if the run had not been
  /// stopped; on another number of ranks as near as these agree anyway.
  /// @param bonds not broken yet, also when it goes on; loses the bonds that break, and all bonds of pieces that come
  /// loose; must outlive this
  /// @param loading Stretch, Shear or Biaxial; its strain only gives the direction and the scale: the record's strains
  /// and stresses are positive along it. Or Pressure, of which the sign counts alone: the pores are made larger (or
  /// smaller, under suction) by what is the strain then, their volume's share, and the stress is the pressure. The most
  /// critical bond is the same where the pressure is held instead, and so is the peak
  /// @param phase as applyLoading()
  /// @throws ParameterError: options outside their range, a traction (the load cannot be held after the peak), no
  /// strain; with FractureMethod::Events periodic sides, batches, a pressure, contact, ranks with different instruction
  /// sets; contact or turning points under a pressure; turning points with FractureMethod::Events or limits that do not
  /// go with them
  /// @throws NoPathError: a sample already in two pieces, that contact does not hold either; as applyLoading() and
  /// Equilibrium otherwise
  /// @throws InputError: a first equilibrium in which sections bear another force than the platens, by more than 0.5 %:
  /// only hinges reach through, or the tolerance is too loose for the sample
  /// @throws InputError: a checkpoint of another scene, cut off, damaged or newer; a place where none can be written
  /// @throws Cancelled: FractureOptions::progress asked for it; no bond is broken then
  QuasiStaticFracture(
    BondLattice& bonds, const Loading& loading, FractureOptions options = {}, std::span<const std::uint8_t> phase = {});
  ~QuasiStaticFracture();
  QuasiStaticFracture(const QuasiStaticFracture&) = delete;
  QuasiStaticFracture& operator=(const QuasiStaticFracture&) = delete;

  /// Goes on until it ends; after Interrupted (and after MaxStrain or MaxBroken, with greater limits) it can be called
  /// again and breaks the same bonds as if it had not stopped. Collective.
  FractureEnd run();
  void setLimits(double maxStrain, std::int64_t maxBroken);

  [[nodiscard]] const FractureRecord& record() const noexcept { return record_; }
  /// Events in the last checkpoint that this run wrote; 0: none.
  [[nodiscard]] std::int64_t checkpointAt() const noexcept { return writtenAt_; }
  /// The imposed strain now.
  [[nodiscard]] double strain() const noexcept;
  /// Displacements at the imposed strain, at an equilibrium of its own, to FractureOptions::tolerance [m]. With
  /// FractureMethod::Events what breaks after that breaks from there, and may differ in near ties. Collective.
  [[nodiscard]] NodeField<double> displacement();
  [[nodiscard]] const LoadedSample& sample() const noexcept { return sample_; }

private:
  [[nodiscard]] double stress(double load) const;
  [[nodiscard]] bool fell(double stress) const;
  [[nodiscard]] double nextLoad(double critical) const;
  /// Before a rise to where a bond of this s/s₀ at unit load breaks.
  [[nodiscard]] Nearness nearness(double ratio) const;
  void raise(double load);
  void breakCritical(const StretchMaximum& most);
  bool report();
  FractureEnd step();
  // With turning points: FractureCycles.cpp
  FractureEnd stepOnBranch();
  void moveTo(double load);
  void turnBack();
  /// Where cracks close: they are open from now on, but for what the load presses.
  void openCracks();
  /// @return the state to go on from
  EngineState restore(const PlatenForce& platens);
  void save();
  void saveBranches(io::Checkpoint& checkpoint) const;
  /// @throws InputError where turning points that it has passed are others
  void restoreBranches(const io::Checkpoint& checkpoint);
  [[nodiscard]] FractureStatistics statistics() const;

  /// The whole sample, as every rank has it for events on several.
  struct Whole
  {
    Whole(const BondLattice& parts, const Loading& loading);
    Communicator alone;
    BondLattice bonds;
    LoadedSample sample;
  };
  /// @param resumed state to go on from, or null
  void makeEngine(bool accurate, const PlatenForce& platens, const EngineState* resumed);
  /// What the engine breaks, and its sample.
  [[nodiscard]] BondLattice& lattice() noexcept { return whole_ ? whole_->bonds : bonds_; }
  [[nodiscard]] const LoadedSample& loaded() const noexcept { return whole_ ? whole_->sample : sample_; }

  BondLattice& bonds_;
  FractureOptions options_;
  LoadedSample sample_;
  std::unique_ptr<Whole> whole_; ///< null where the engine works on the parts
  std::optional<CrackContact> contact_;
  double reference_ = 0;  ///< strain of the unit load
  double area_ = 1;       ///< [m²], [m] in the plane
  double load_ = 0;       ///< imposed strain over the reference
  double direction_ = 1;  ///< of the load now; -1: against the loading
  std::size_t turns_ = 0; ///< turning points that were reached
  LoadBranch branch_{};   ///< so far
  double share_ = 0;
  double firstRatio_ = 0; ///< s/s₀ at unit load of the bond that broke first
  std::unique_ptr<FractureEngine> engine_;
  FractureRecord record_;
  std::string scene_; ///< of the unbroken sample; empty where no file needs it
  io::CheckpointPace pace_;
  std::int64_t savedAt_ = 0;   ///< events
  std::int64_t writtenAt_ = 0; ///< likewise, of the last file of this run
  double started_ = 0;         ///< the clock when run() began
};

/// The phases at both ends of bonds, the lesser first, and whether the ends lie in two different grains.
struct BondEnds
{
  std::uint8_t low = 0;
  std::uint8_t high = 0;
  bool betweenGrains = false;
};
/// @param phase, grain as BondLattice takes them; grain may be empty
/// Collective; the same on every rank.
[[nodiscard]] std::vector<BondEnds> endsOf(const BondLattice& bonds, const std::vector<BrokenBond>& broken,
  std::span<const std::uint8_t> phase, std::span<const std::int32_t> grain);

} // namespace lamella::peridynamics
