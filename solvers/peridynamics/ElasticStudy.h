#pragma once

#include "peridynamics/BondLattice.h"
#include "peridynamics/BondModel.h"
#include "peridynamics/BreakSensitivity.h"
#include "peridynamics/Equilibrium.h"
#include "peridynamics/Loading.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// The whole elastic job: from phases and materials to displacement, stress, stiffness and the load of the first break.
namespace lamella::peridynamics
{

struct ElasticOptions
{
  Loading loading{};
  EquilibriumOptions equilibrium{};
  bool stress = false;        ///< stress of every node; not computed unless asked for
  bool energyDensity = false; ///< likewise
  /// How the stress of the first break changes with each pair's stiffness: one more solve. Small strains only.
  bool sensitivity = false;
  int threads = 0;   ///< 0: as many as OpenMP would take
  double memory = 0; ///< bytes that may be taken on this machine; 0: what is free
};

/// How thick a phase is, by the shortest of the straight runs along the axes through each of its nodes.
struct PhaseThickness
{
  std::uint8_t phase = 0;
  std::int64_t nodes = 0;
  double median = 0;    ///< nodes across; 2h/δx + 1 stands for that and more, and runs that reach an edge count so
  double thinShare = 0; ///< share of its nodes where it is thinner than the horizon
};

/// What a sample is made of, before anything breaks.
struct SampleCounts
{
  std::int64_t nodes = 0;
  std::int64_t solidNodes = 0;
  std::int64_t bonds = 0;
  StripCounts strips;                    ///< of all ranks: runs of 16 nodes that the sums skip, and that they visit
  std::vector<PhaseThickness> thickness; ///< of the phases that carry bonds, when there is more than one
};

/// The bond that breaks first as the load grows from nothing.
struct FirstBreak
{
  double ratio = 0;  ///< s/s₀ at the load given
  double strain = 0; ///< at which it breaks: strain/ratio
  double stress = 0; ///< [Pa] likewise, as ElasticResult::effectiveStress
  Bond bond;
  std::array<double, 3> position{};     ///< of its middle, in the coordinates of the lattice [m]
  std::array<std::uint8_t, 2> phases{}; ///< of its ends
};

struct ElasticResult : SampleCounts
{
  EquilibriumResult solve;
  NodeField<double> displacement;                 ///< [m], own nodes and rim
  std::optional<NodeField<double>> stress;        ///< [Pa] 3 or 6 components as nodalStress(); own nodes
  std::optional<NodeField<double>> energyDensity; ///< [J/m³]

  int axis = 0;                ///< of loading
  int across = 0;              ///< component of displacement and force along which the load acts
  double area = 0;             ///< of a section across the axis, voids included [m²]; of a picture [m], a metre deep
  double length = 0;           ///< between the inner layers of the platens [m]
  double strain = 0;           ///< that was applied; of a traction, or a pressure in pores, the one that it causes
  Reactions reactions;         ///< [N], [N/m]
  double effectiveStress = 0;  ///< pull of the sample on the high platen along `across`, over the area [Pa]
  double effectiveModulus = 0; ///< effectiveStress/strain [Pa]; a shear modulus where the load is shear
  /// Mean over the whole box, platens and voids included [Pa]: xx, yy, zz, xy, yz, xz.
  std::array<double, 6> meanStress{};
  double elasticEnergy = 0; ///< [J], [J/m]
  /// Nothing where no bond is stretched or none can break, and in large strains, where nothing can be scaled.
  std::optional<FirstBreak> firstBreak;
  /// By pair, in the order of describePairs(); where it was asked for and a bond breaks.
  std::optional<BreakSensitivity> sensitivity;
  double largestRatio = 0; ///< s/s₀ at this load, large strains included

  std::array<std::int64_t, 2> lowPlaten{}; ///< [first, last) layer along the axis
  std::array<std::int64_t, 2> highPlaten{};
  std::int64_t loosePieces = 0;
  std::int64_t looseNodes = 0;
  double poreVolume = 0;             ///< of the pores under pressure [m³], [m²] of a picture
  std::int64_t openNodes = 0;        ///< of the phases that the pressure acts in, but open: under none
  std::vector<std::string> warnings; ///< each one line, with its numbers

  double bondSeconds = 0; ///< making the bonds
  double loadSeconds = 0; ///< platens, loose pieces
  double sensitivitySeconds = 0;
  double measureSeconds = 0; ///< all that comes after the solve
  std::int64_t bytes = 0;    ///< of all ranks: bonds, solver and fields
};

/// @param phase, grain as BondLattice
/// @throws what BondLattice, applyLoading() and Equilibrium throw; ParameterError where strain or traction is 0, and
/// for a sensitivity in large strains;
/// MemoryError before anything is allocated
[[nodiscard]] ElasticResult studyElastic(const BondModel& model, const Lattice& lattice,
  std::span<const std::uint8_t> phase, std::span<const std::int32_t> grain, const ElasticOptions& options,
  const Communicator& comm);

/// Bytes that one rank takes at most. @throws ParameterError as BondLattice::bytesNeeded()
[[nodiscard]] double elasticBytes(
  const BondModel& model, const Lattice& lattice, bool grains, const ElasticOptions& options, int ranks);

/// Bytes that all ranks together take at least, whatever the phases are: to refuse a file before it is read.
/// @param refinement each of the lattice's nodes into n × n (× n)
[[nodiscard]] double leastElasticBytes(const Lattice& lattice, double horizon, int refinement);

/// Mean of the nodes' stresses over the whole box [Pa]: xx, yy, zz, xy, yz, xz. Collective.
/// @param stress as nodalStress() gives it
/// @param continuum in plane strain zz is ν (xx + yy)
[[nodiscard]] std::array<double, 6> meanStress(
  const BondLattice& bonds, const NodeField<double>& stress, Continuum continuum);

/// The same from the forces of the bonds on the nodes, Σ −f ⊗ x: a pass over nodes instead of one over bonds. Not for
/// lattices with periodic sides. Collective.
[[nodiscard]] std::array<double, 6> meanStress(const BondLattice& bonds, const NodeField<double>& force,
  const NodeField<double>& displacement, bool nonlinear, Continuum continuum);

/// So many of OpenMP's threads for what this thread starts while it lives; 0: as many as before.
class ThreadScope
{
public:
  explicit ThreadScope(int count);
  ~ThreadScope();
  ThreadScope(const ThreadScope&) = delete;
  ThreadScope& operator=(const ThreadScope&) = delete;

private:
  int before_;
};

/// Collective. @param what needs it, a noun
/// @param given bytes that may be taken on this machine; 0: what is free
/// @throws MemoryError on every rank where one of them needs more
void requireMemory(const char* what, const Lattice& lattice, double need, double given, const Communicator& comm,
  const char* remedy = "take a smaller sample, a smaller horizon or a coarser lattice, or more machines");

/// What is said of pieces that applyLoading() took out.
[[nodiscard]] std::string looseWarning(std::int64_t pieces, std::int64_t nodes, std::int64_t solidNodes);

/// What is said of pores that hold no pressure.
[[nodiscard]] std::string openWarning(std::int64_t nodes);

/// What is said of a modulus that the solver's residual may leave off by this share; empty where that is little.
/// @param traction whether it is of forces that are given, where it is the work of what is left over
[[nodiscard]] std::string doubtWarning(double doubt, bool traction = false);

/// What a model's horizon means for a picture: a warning, or an empty string.
[[nodiscard]] std::string horizonWarning(const BondModel& model);

/// What a model's horizon means for a picture and for each of its phases, if they are several: one line each.
[[nodiscard]] std::vector<std::string> modelWarnings(
  const BondModel& model, const std::vector<PhaseThickness>& thickness);

/// Thickness of every phase that has nodes and is no void. Collective.
/// @param phase of the rank's slab
[[nodiscard]] std::vector<PhaseThickness> phaseThickness(
  const BondLattice& bonds, const BondModel& model, std::span<const std::uint8_t> phase);

/// Collective.
/// @param bonds none of them broken
/// @param phase of the rank's slab
[[nodiscard]] SampleCounts countSample(
  const BondLattice& bonds, const BondModel& model, std::span<const std::uint8_t> phase);

} // namespace lamella::peridynamics
