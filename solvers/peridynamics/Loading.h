#pragma once

#include "peridynamics/BondLattice.h"
#include "peridynamics/Equilibrium.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace lamella::peridynamics
{

/// What is done to the sample. The low platen never moves. Sides without a platen are free (or periodic, as the bonds).
enum class LoadCase
{
  Stretch, ///< the high platen moves along the axis
  Shear,   ///< it moves across
  Biaxial, ///< smooth platens on all sides: strain along the axis, lateralStrain along the others
  Traction ///< a force spread evenly over the layers of the high platen, which is not stiff
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
  int layers = 0; ///< layers of nodes that a platen holds; 0: as many as a bond reaches
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
};

/// @throws ParameterError: values that are not finite, an axis that is periodic, platens that meet
/// @throws NoPathError: no piece of the sample reaches from platen to platen; says how many pieces there are
[[nodiscard]] LoadedSample applyLoading(const BondLattice& bonds, const Loading& loading);

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
