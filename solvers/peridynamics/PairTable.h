#pragma once

#include "peridynamics/BondModel.h"

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// The materials of a sample as people write them: by names of phases.
namespace lamella::peridynamics
{

/// What bonds between two phases are made of when nobody says.
enum class Mixing
{
  None,     ///< an error that names the pair
  Harmonic, ///< two half bonds in series: 2/(1/E + 1/E′); it breaks when the first half reaches its s₀
  Minimum   ///< the lesser E and the lesser s₀
};

/// A pair of phases by name: "grain" is bonds within that phase, "matrix-grain" between two phases, and "grain-grain"
/// between two different grains of one phase (which makes BondModel::pairByGrain true).
struct PairKey
{
  std::uint8_t first = 0; ///< the lesser id
  std::uint8_t second = 0;
  bool betweenGrains = false;

  auto operator<=>(const PairKey&) const = default;
};

/// @param names of the phases by id; a name may itself hold a "-"
/// @return nothing for a text that is no pair of these
[[nodiscard]] std::optional<PairKey> findPair(const std::string& text, std::span<const std::string> names);

/// The name that findPair() understands.
[[nodiscard]] std::string pairText(const PairKey& key, std::span<const std::string> names);

/// Tables by pair. A pair has a Young's modulus, and at most one of the other three.
struct PairTable
{
  using Values = std::map<std::string, double>;

  Values young{};           ///< E [Pa]
  Values fractureEnergy{};  ///< Gc [J/m²]
  Values toughness{};       ///< K [Pa √m]
  Values criticalStretch{}; ///< s₀
  /// Pairs that are like another one, in stiffness where they have no E of their own, and in fracture where they have
  /// nothing of their own about that.
  std::map<std::string, std::string> like{};
  /// Where this names a pair, all other values are multiples of that pair's in the same table.
  std::string relativeTo{};
  Mixing mixing = Mixing::None;
  /// Phases that carry no bonds. None given: those called void, pore, lumen or air, and one without a name whose id is
  /// 0, unless a table names them.
  std::vector<std::string> voids{};

  bool operator==(const PairTable&) const = default;

  /// Every name of a pair that occurs.
  [[nodiscard]] std::vector<std::string> pairs() const;
};

/// Puts the table into a model whose continuum, horizon and micromodulus are known: pairs, pairByGrain, voids,
/// phaseNames. Pairs and voids that the sample's phases do not have are left out, so that one table serves many
/// samples.
/// @param names of the phases by id
/// @param nodes of each phase in the whole sample; those without need no material
/// @param spacing δx [m]
/// @throws ParameterError: a value that is not positive and finite; fracture without a Young's modulus; a pair given
/// twice ("a-b" and "b-a"); `like` in a circle or of a pair without material; `relativeTo` without a value; a phase
/// that is void and has a material; a phase with nodes but without a material
void applyMaterials(const PairTable& table, std::span<const std::string> names, std::span<const std::int64_t> nodes,
  double spacing, BondModel& model);

/// What a model makes of one pair, for reports.
struct PairData
{
  PairKey key;
  std::string name;           ///< pairText()
  double youngsModulus = 0;   ///< E asked for [Pa]
  double criticalStretch = 0; ///< s₀; infinite where nothing breaks it
  double fractureEnergy = 0;  ///< Gc of the continuum [J/m²]; infinite likewise
  double toughness = 0;       ///< K [Pa √m]; infinite likewise
};
[[nodiscard]] std::vector<PairData> describePairs(const BondModel& model, double spacing);

/// One value of a table of materials, and what it does.
struct PairNumber
{
  std::string property; ///< "young", "fracture-energy", "toughness", "critical-stretch"
  std::string pair;     ///< as the table has it
  double value = 0;     ///< as the table has it
  /// ∂ log E/∂ log p and ∂ log s₀/∂ log p by pair, in the order of describePairs(). Of fracture energies and
  /// toughnesses s₀ hangs on E, too.
  std::vector<double> young, stretch;

  [[nodiscard]] std::string name() const { return property + ":" + pair; }
};

/// Pairs that every one of these values changes alike get one number: BondModel::pairGroups.
[[nodiscard]] std::vector<int> pairGroups(std::span<const PairNumber> numbers);

/// The values that some pair of the sample hangs on, by differences of the table's own rules (`like`, `relativeTo`,
/// mixing): to 1e-9; at a kink of Mixing::Minimum the mean of both sides.
/// @param names, nodes, spacing, model as applyMaterials() had them
[[nodiscard]] std::vector<PairNumber> pairNumbers(const PairTable& table, std::span<const std::string> names,
  std::span<const std::int64_t> nodes, double spacing, const BondModel& model);

} // namespace lamella::peridynamics
