#pragma once

#include "lattice/Lattice.h"
#include "peridynamics/Material.h"

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// What a scene says about the bonds of a sample.
namespace lamella::peridynamics
{

/// A cut made before loading: a segment in 2D, a parallelogram in space (a half plane is one that reaches beyond the
/// sample). It takes away the bonds that cross it. Where it runs through nodes it counts as moved by a millionth of a
/// spacing to the right of `along` (in space, along `along` × `across`): so no bond lies within it.
struct Notch
{
  std::array<double, 3> corner{ 0, 0, 0 }; ///< [m], in the coordinates of the lattice
  std::array<double, 3> along{ 0, 0, 0 };  ///< from the corner to the other end [m]
  std::array<double, 3> across{ 0, 0, 0 }; ///< the second edge in space [m]; not used in 2D
};

enum class VoidBonds
{
  Keep, ///< a bond between two solid nodes stays where it crosses a thin void, as in the papers
  Cut   ///< it goes when any node that its line comes within half a spacing of, along an axis, is void
};

/// Bonds of a pair of phases.
struct PhasePair
{
  BondMaterial material; ///< of all its bonds, or of those within one grain
  std::optional<BondMaterial>
    betweenGrains{}; ///< of bonds between two different grains (ids not 0), by BondModel::pairByGrain
};

struct BondModel
{
  Continuum continuum = Continuum::PlaneStress;
  double horizon = 3; ///< h/δx, 1 to 8
  Micromodulus micromodulus = Micromodulus::Continuum;
  /// By the ids of the two phases, the lesser first.
  std::map<std::pair<std::uint8_t, std::uint8_t>, PhasePair> pairs{};
  bool pairByGrain = false;
  /// Pairs with different numbers here, in the order of describePairs(), are of different kinds even where they are of
  /// one material: for derivatives. Empty: pairs of one material are of one kind.
  std::vector<int> pairGroups{};
  std::vector<std::uint8_t> voids{ 0 }; ///< phases that carry no bonds
  VoidBonds voidBonds = VoidBonds::Keep;
  /// The energy method of Madenci and Oterkus, Peridynamic Theory and Its Applications (2014), section 4.2: strained
  /// along axis a alone a node's bonds hold a share wₐ of the energy that they would in the bulk, and k of a bond along
  /// n is taken over √(Σ nₐ² wₐ²), wₐ² the mean of its ends'. Shares below a quarter count as a quarter. Bonds that
  /// were not there before notches were cut are what is missing; materials do not matter.
  bool surfaceCorrection = false;
  std::vector<Notch> notches{};
  std::array<bool, 3> periodic{ false, false, false };
  std::vector<std::string> phaseNames{}; ///< for messages; a phase without a name goes by its number
};

/// The bonds of a node, weighted where the micromodulus is isotropic and they can be.
/// @throws ParameterError as Stencil
[[nodiscard]] Stencil bondStencil(const BondModel& model);

/// Bonds that behave alike; numbered from 1, 0 is no bond.
struct BondKind
{
  /// k = c δx^(2d): force of a bond over its elongation s [N in space, N/m in the plane], but for Offset::weight
  double stiffness = 0;
  double criticalStretch = 0; ///< s₀; may be infinite

  bool operator==(const BondKind&) const = default;
};

/// Which kind the bonds of each pair of phases are of.
class BondKinds
{
public:
  /// @param spacing δx [m]
  /// @throws ParameterError: a value that is not positive and finite; no pair at all; pairByGrain with no pair that
  /// says what is between grains; more than 255 kinds
  BondKinds(const BondModel& model, const Stencil& stencil, double spacing);

  /// Kinds 1 … size() - 1; [0] is no bond.
  [[nodiscard]] const std::vector<BondKind>& kinds() const noexcept { return kinds_; }
  /// Kind of a bond between two phases, 0 if one of them is void, -1 without data.
  [[nodiscard]] int within(std::uint8_t a, std::uint8_t b) const noexcept { return within_[position(a, b)]; }
  /// The same where grains differ.
  [[nodiscard]] int between(std::uint8_t a, std::uint8_t b) const noexcept { return between_[position(a, b)]; }
  /// By pair, in the order of describePairs().
  [[nodiscard]] const std::vector<int>& ofPairs() const noexcept { return ofPairs_; }
  [[nodiscard]] bool isVoid(std::uint8_t phase) const noexcept { return void_[phase]; }

private:
  static std::size_t position(std::uint8_t a, std::uint8_t b) noexcept { return std::size_t{ a } * 256 + b; }

  std::vector<BondKind> kinds_;
  std::vector<int> ofPairs_;
  std::vector<std::int16_t> within_;
  std::vector<std::int16_t> between_;
  std::array<bool, 256> void_{};
};

/// "wall and lamella", by the model's names.
[[nodiscard]] std::string pairName(const BondModel& model, std::uint8_t a, std::uint8_t b);

} // namespace lamella::peridynamics
