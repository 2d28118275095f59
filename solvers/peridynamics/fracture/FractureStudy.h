#pragma once

#include "peridynamics/ElasticStudy.h"
#include "peridynamics/fracture/Fracture.h"
#include "peridynamics/fracture/NodeDamage.h"

#include <functional>
#include <optional>

/// The whole job of quasi-static fracture: from phases and materials to strength, curve, broken bonds and fields.
namespace lamella::peridynamics
{

/// Its displacement is that of an equilibrium of its own, which the run does not see: asking for a state changes
/// nothing that breaks. Pieces that came loose move as the mean strain has it.
struct FractureState : BrokenState
{
  std::int64_t hinges = 0;     ///< as EquilibriumResult
  std::int64_t iterations = 0; ///< of the equilibrium
};

struct FractureStudyOptions
{
  Loading loading{}; ///< the strain's sign is the direction, its size is of no account
  /// Its method and its cracks are of no account (with contact these are the notches), and its progress may come more
  /// seldom than every event.
  FractureOptions fracture{};
  /// None: FractureMethod::Events where it can be had (no periodic side, strict breaking, neither contact nor turning
  /// points), else Accurate.
  std::optional<FractureMethod> method{};
  std::vector<double> atStrains{};           ///< states to keep: imposed strains
  std::vector<std::int64_t> atBroken{};      ///< likewise: numbers of broken bonds
  bool displacement = true;                  ///< of the states; not computed when off
  bool stress = false;                       ///< of every node; needs displacements
  bool energyDensity = false;                ///< likewise
  std::function<void(FractureState)> keep{}; ///< given the states as they come, the end last; called on every rank
  int threads = 0;                           ///< 0: as many as OpenMP would take
  double memory = 0;                         ///< bytes that may be taken on this machine; 0: what is free
};

/// A state, and the path that follows every snap-back beside it.
struct FractureCurvePoint
{
  double strain = 0;         ///< imposed; never falls
  double stress = 0;         ///< at it [Pa]
  std::int64_t broken = 0;   ///< bonds so far
  double criticalStrain = 0; ///< where the state is that only just breaks the next bond: less in an avalanche
  double criticalStress = 0; ///< at that [Pa]
};

struct FractureResult : SampleCounts
{
  FractureRecord record;
  FractureMethod method = FractureMethod::Events;
  CurvePoint peak;            ///< the largest stress; that of the end where it is reached there, at the largest strain
  std::vector<BondEnds> ends; ///< of the broken bonds
  /// From the unloaded sample on: a point for every event, just before it, one for what each avalanche left, and the
  /// end.
  std::vector<FractureCurvePoint> curve;
  /// Σ ½ k s₀² |ξ|: what the broken bonds held when they were just critical [J], [J/m] in the plane. The sample loses
  /// more, for at each break its neighbours spring back.
  double brokenEnergy = 0;
  std::vector<double> missedStrains;       ///< states asked for that the run ended before
  std::vector<std::int64_t> missedNumbers; ///< likewise, of broken bonds
  std::int64_t continuedAt = 0;            ///< events in FractureOptions::continueFrom; 0: from the unbroken sample
  std::int64_t checkpointAt = 0;           ///< events in the last checkpoint that was written; 0: none
  std::int64_t statesBefore = 0;           ///< states asked for that lie before the one it went on from

  int axis = 0;      ///< of loading
  double area = 0;   ///< of a section across the axis, voids included [m²]; of a picture [m], a metre deep
  double length = 0; ///< between the inner layers of the platens [m]
  std::array<std::int64_t, 2> lowPlaten{}; ///< [first, last) layer along the axis
  std::array<std::int64_t, 2> highPlaten{};
  std::int64_t loosePieces = 0; ///< of the unbroken sample
  std::int64_t looseNodes = 0;
  double poreVolume = 0;             ///< LoadCase::Pressure: of the closed pores [m³], [m²] of a picture
  std::int64_t openNodes = 0;        ///< of the phases that the pressure acts in, but open: under none
  std::vector<std::string> warnings; ///< each one line, with its numbers

  double bondSeconds = 0;  ///< making the bonds
  double firstSeconds = 0; ///< platens, loose pieces, first equilibrium
  double stateSeconds = 0; ///< fields of the states
  std::int64_t bytes = 0;  ///< of all ranks: bonds and solver
};

/// @param phase, grain as BondLattice
/// @throws what BondLattice and QuasiStaticFracture throw; ParameterError where no bond can break, for states that are
/// not positive, and for fields that need displacements without these; MemoryError before anything is allocated;
/// Cancelled when progress asks to stop
[[nodiscard]] FractureResult studyFracture(const BondModel& model, const Lattice& lattice,
  std::span<const std::uint8_t> phase, std::span<const std::int32_t> grain, const FractureStudyOptions& options,
  const Communicator& comm);

/// Bytes that one rank takes at most, the states kept not counted.
/// @throws ParameterError as BondLattice::bytesNeeded()
[[nodiscard]] double fractureBytes(
  const BondModel& model, const Lattice& lattice, bool grains, const FractureStudyOptions& options, int ranks);

/// The bonds of a state that a run came through, made anew: what is left after so many broken ones, in the order of the
/// run. The sample is as studyFracture() takes it, or studyDynamics(). Collective.
/// @param held how platens hold it: bonds of pieces that came loose are taken out then, as studyFracture() does; null
/// where they fly on, as in studyDynamics()
/// @param contact FractureOptions::contact: fills in displacements of the state, of own nodes, whose closed bonds are
/// there then; else empty
[[nodiscard]] BondLattice remainingBonds(const BondModel& model, const Lattice& lattice,
  std::span<const std::uint8_t> phase, std::span<const std::int32_t> grain, std::span<const Bond> broken,
  const Loading* held, const std::function<void(NodeField<double>&)>& contact, const Communicator& comm);

/// The bonds that notches cut, in order; the same on every rank. Collective.
/// @param bonds of this model, none broken yet
[[nodiscard]] std::vector<KnownBond> notchedBonds(const BondLattice& bonds, const BondModel& model,
  const Lattice& lattice, std::span<const std::uint8_t> phase, std::span<const std::int32_t> grain);

/// The curve of a record, see FractureResult::curve.
[[nodiscard]] std::vector<FractureCurvePoint> fractureCurve(const FractureRecord& record);

/// See FractureResult::brokenEnergy. Collective.
/// @param model that the bonds were made of
/// @param ends of the broken bonds
[[nodiscard]] double brokenEnergy(const BondLattice& bonds, const BondModel& model,
  const std::vector<BrokenBond>& broken, const std::vector<BondEnds>& ends);

/// Middle of a bond [m]; of one that crosses a periodic side beyond it.
[[nodiscard]] std::array<double, 3> middleOf(const Lattice& lattice, const Stencil& stencil, const Bond& bond);

} // namespace lamella::peridynamics
