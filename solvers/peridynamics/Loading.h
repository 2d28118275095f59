#pragma once

#include "peridynamics/BondLattice.h"
#include "peridynamics/Equilibrium.h"
#include "peridynamics/PorePressure.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lamella::peridynamics
{

/// What is done to the sample. The low platen never moves. Sides without a platen are free (or periodic, as the bonds).
enum class LoadCase
{
  Stretch,  ///< the high platen moves along the axis
  Shear,    ///< it moves across
  Biaxial,  ///< smooth platens on all sides: strain along the axis, lateralStrain along the others
  Traction, ///< a force spread evenly over the layers of the high platen, which is not stiff
  /// A pressure in closed pores (PorePressure), and no platens. Strain is what the pores gain of their volume, stress
  /// the pressure.
  Pressure
};

struct Loading
{
  LoadCase load = LoadCase::Stretch;
  int axis = -1;            ///< of loading; -1 the last one: y in 2D, z in 3D
  double strain = 1e-3;     ///< movement of the high platen over the distance between the platens; tension positive
  double lateralStrain = 0; ///< see LoadCase::Biaxial
  double traction = 0;      ///< [Pa], tension positive
  bool smooth = false;      ///< Stretch: platens hold the component along the axis only
  /// All layers of a platen move alike. Otherwise they move as the mean strain has it, as if the sample went on, and a
  /// uniform sample is strained uniformly up to its ends; with rigid platens bonds that reach into them are stretched
  /// more than the rest.
  bool rigid = false;
  int layers = 0;        ///< layers of nodes that a platen, or a straight side, holds; 0: as many as a bond reaches
  double pressure = 1e5; ///< above that outside [Pa]; negative: suction, as of water under tension
  std::vector<std::uint8_t> pressureIn{}; ///< the empty phases that it acts in; none: all of them
  /// Pressure: the sides of the box are planes that do not move, as if the sample went on as its mirror image, and
  /// close the pores that they cut. Else the sides are free, and those pores open.
  bool straightSides = false;
};

/// A sample ready for Equilibrium.
struct LoadedSample
{
  FixedComponents fixed;
  NodeField<double> displacement;        ///< of fixed components, and a first guess of the others [m]
  std::optional<NodeField<double>> load; ///< forces on the nodes [N], [N/m in 2D]
  std::int64_t loosePieces = 0;          ///< pieces that no platen holds: taken out, they stay where they are
  std::int64_t looseNodes = 0;
  std::array<std::int64_t, 2> lowLayers{}; ///< of the platens: [first, last) layer of the whole lattice
  std::array<std::int64_t, 2> highLayers{};
  std::optional<PorePressure> pores{}; ///< Pressure
  double pressure = 0;                 ///< likewise: that of the load [Pa]
  bool held = true; ///< a component is fixed somewhere; else displacements are known up to a rigid motion
};

/// @param phase of the nodes of slab(), in lattice order: for Pressure, which tells empty phases apart
/// @throws ParameterError: values that are not finite, an axis that is periodic, platens that meet; as PorePressure
/// @throws NoPathError: no piece of the sample reaches from platen to platen; says how many pieces there are; no pore
/// that holds a pressure
[[nodiscard]] LoadedSample applyLoading(
  const BondLattice& bonds, const Loading& loading, std::span<const std::uint8_t> phase = {});

/// Pieces that a sample under pressure lost.
struct LostPieces
{
  std::int64_t pieces = 0;   ///< of all ranks
  std::int64_t nodes = 0;    ///< likewise
  std::vector<Bond> bonds{}; ///< of these pieces, that this rank found
};
/// Of a sample under pressure, after bonds broke: what straight sides hold remains, and where they hold nothing the
/// largest piece; other pieces are taken out, and the load is that on what remains. Collective.
[[nodiscard]] LostPieces looseUnderPressure(const BondLattice& bonds, LoadedSample& sample);

/// How much larger the pressure makes the pores, over their volume [1]: the load's work over p V. Of the sign of the
/// pressure. Collective. @param u at equilibrium under the load
[[nodiscard]] double poreStrain(const BondLattice& bonds, const LoadedSample& sample, const NodeField<double>& u);

/// What the residual does on the way, over what the load does: the relative error of the mean movement, but for what is
/// of second order. Collective. @param force on all nodes, of bonds and load
[[nodiscard]] double workOfResidual(
  const BondLattice& bonds, const LoadedSample& sample, const NodeField<double>& u, const NodeField<double>& force);

/// Force that the sample exerts on the low and high platen, by component [N], [N/m in 2D]; their sum vanishes at
/// equilibrium without a load. Collective.
struct Reactions
{
  std::array<double, 3> low{};
  std::array<double, 3> high{};
};
[[nodiscard]] Reactions reactions(
  const BondLattice& bonds, const LoadedSample& sample, const NodeField<double>& u, int axis, bool nonlinear);

} // namespace lamella::peridynamics
