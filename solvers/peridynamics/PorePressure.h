#pragma once

#include "peridynamics/BondLattice.h"
#include "peridynamics/NodeField.h"

#include <cstdint>
#include <span>
#include <vector>

/// A pressure in empty phases (the water of a cell, the air of a foam) on the solid around them.
namespace lamella::peridynamics
{

/// The closed pores of chosen empty phases. The pressure acts on every face between a node of theirs and a solid one
/// with the force p δx^(d−1) along its normal, spread evenly over the solid nodes behind the face, as many as a bond
/// reaches or as there are: nodes at a surface are soft, and one layer alone would be stretched too much. The vector
/// areas of a closed surface add up to nothing, and so do their moments, of a surface of pixels exactly, wherever along
/// its normal a force acts: whatever a closed pore does to the solid is in balance.
///
/// A pore that reaches a free side, or that has a face in common with an empty phase that was not chosen, is open: it
/// holds no pressure.
class PorePressure
{
public:
  /// Collective.
  /// @param phase of the nodes of slab(), in lattice order
  /// @param chosen the phases; none: all that are empty
  /// @param closedSides sides that are not periodic close pores, as a wall or a mirror would; else they are free
  /// @throws InputError: an array of the wrong length
  /// @throws ParameterError: a chosen phase that has solid nodes
  /// @throws NoPathError: no pore that is closed and has a solid wall
  PorePressure(const BondLattice& bonds, std::span<const std::uint8_t> phase, std::span<const std::uint8_t> chosen,
    bool closedSides);

  /// The forces of a pressure; zero on all other nodes, rim filled. Collective.
  /// @param pressure above that outside [Pa]; negative: suction
  /// @param load in and out of the lattice's layout [N], [N/m] in the plane
  void apply(const BondLattice& bonds, double pressure, NodeField<double>& load) const;

  /// Nodes (by position, own ones) that came loose are no wall any more, and part of the pore beside them; a pore that
  /// they closed may be open then. Collective.
  void remove(const BondLattice& bonds, const std::vector<std::int64_t>& nodes);
  [[nodiscard]] bool removed(std::int64_t index) const noexcept { return removed_[index] != 0; }

  /// Faces that feel the pressure now, of all ranks.
  [[nodiscard]] std::int64_t faces() const noexcept { return faces_; }
  /// Of the closed pores of the unbroken sample, of all ranks [m³], [m²] in the plane.
  [[nodiscard]] double volume() const noexcept { return volume_; }
  /// Nodes of the chosen phases in open pores, of the unbroken sample and of all ranks.
  [[nodiscard]] std::int64_t openNodes() const noexcept { return openNodes_; }

private:
  /// Fills what is open from the sides and from other empty phases, and counts faces.
  void flood(const BondLattice& bonds);
  template <class F>
  void forEachFace(F&& f) const;

  NodeLayout layout_;
  AlignedArray<std::uint8_t> kind_; ///< of every node: solid, closed, or open; rim filled
  AlignedArray<std::uint8_t> removed_;
  bool closedSides_;
  std::int64_t faces_ = 0;
  std::int64_t openNodes_ = 0;
  double volume_ = 0;
};

/// Takes the rigid motion that fits best out of displacements: of a sample that nothing holds they are only known up to
/// one. Rotations only about axes across which no side is periodic. Collective; the rim is filled.
/// @param pores tells which nodes are no part of the sample any more
void takeOutRigidMotion(const BondLattice& bonds, const PorePressure& pores, NodeField<double>& u);

} // namespace lamella::peridynamics
