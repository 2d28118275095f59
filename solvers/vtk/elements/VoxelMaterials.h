#pragma once

#include "PhaseIds.h"

#include "elasticity/VoxelStiffness.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// From what people say of phases to the materials of elements. Not installed.
namespace lamella
{

struct VoxelSettings
{
  using Values = std::map<std::string, double>;

  Values young{}, poisson{}, youngAcross{}, poissonAcross{}, shear{}, expansion{}, expansionAcross{};
  /// How far these may be off, by phase: half of the interval that holds them 19 times out of 20.
  Values youngUncertainty{}, poissonUncertainty{}, youngAcrossUncertainty{}, poissonAcrossUncertainty{},
    shearUncertainty{};
  std::map<std::string, std::string> stiffness{}; ///< by phase: numbers with spaces between them
  std::vector<std::string> rigid{};
  std::vector<std::string> voids{}; ///< none: by their names
  elasticity::Continuum continuum = elasticity::Continuum::PlaneStress;
};

/// A number that a material is told by: what VoxelMaterial::changes count.
struct MaterialNumber
{
  std::string property; ///< young, poisson, young-across, poisson-across, shear
  std::string phase;
  double value = 0;
  double uncertainty = 0; ///< 0: not told

  [[nodiscard]] std::string name() const { return property + ":" + phase; }
};

/// The materials of an image's phases.
class VoxelMaterials
{
public:
  /// @param nodes by id, how many have it in the whole image; phases without nodes need no material
  /// @throws ParameterError
  VoxelMaterials(const VoxelSettings& settings, const PhaseIds& phases, std::span<const std::int64_t> nodes);

  /// Of greys that are shares of two phases, low and high.
  /// @param shares of high, by id
  VoxelMaterials(const VoxelSettings& settings, std::span<const double> shares);

  [[nodiscard]] const std::vector<elasticity::VoxelMaterial>& materials() const noexcept { return materials_; }
  [[nodiscard]] bool turn() const noexcept { return turn_; }                  ///< some phase follows an axis
  [[nodiscard]] bool turnsAcrossSurfaces() const noexcept { return layers_; } ///< the axes are those of the shares
  [[nodiscard]] bool isVoid(std::uint8_t id) const { return id < void_.size() && void_[id]; }
  /// Constants of each phase that is there, by name.
  [[nodiscard]] const nlohmann::json& told() const noexcept { return told_; }
  /// Of all phases that are there and told by constants; where greys are shares, of low and high.
  [[nodiscard]] const std::vector<MaterialNumber>& numbers() const noexcept { return numbers_; }
  /// Some number may be off.
  [[nodiscard]] bool uncertain() const;
  /// Plane bulk and shear modulus (of volumes the usual ones) by id [Pa]; 0 of voids. Empty: not all are isotropic.
  struct Isotropic
  {
    std::vector<double> bulk, shear;
  };
  [[nodiscard]] const Isotropic& isotropic() const noexcept { return isotropic_; }
  /// Of a picture's point, by its stress in the plane and its change: in plane stress the strain across the plane, in
  /// plane strain the stress [Pa]; NaN of a tensor of the plane alone, and where two solids share the point.
  [[nodiscard]] double acrossPlane(
    std::uint8_t id, double xx, double yy, double xy, const std::array<float, 3>& axis, double change) const;

private:
  struct Phase
  {
    std::array<double, 2> expansion{ 0, 0 };       ///< along, across
    std::optional<elasticity::AcrossPlane> across; ///< of pictures, where it is known
    bool transverse = false;
  };

  std::vector<elasticity::VoxelMaterial> materials_;
  std::vector<Phase> phases_;
  std::vector<bool> void_;
  bool turn_ = false;
  bool layers_ = false;
  bool strain_ = false; ///< plane strain
  nlohmann::json told_ = nlohmann::json::object();
  std::vector<MaterialNumber> numbers_;
  Isotropic isotropic_;
};

/// By id, of greys that are shares. @throws ParameterError where phases have names
[[nodiscard]] std::vector<double> sharesOf(const PhaseIds& phases, double none, double all);

/// Components of a mean strain or stress as numbers in Voigt's order, NaN where they are not given; empty: none is.
/// @throws ParameterError for a component that there is not
[[nodiscard]] std::vector<double> voigtVector(
  const std::map<std::string, double>& components, int dimension, const char* what);

} // namespace lamella
