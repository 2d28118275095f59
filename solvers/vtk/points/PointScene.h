#pragma once

#include "PhaseIds.h"
#include "vtkPieces.h"

#include "lattice/Lattice.h"
#include "mpm/BodyContact.h"
#include "mpm/MaterialPoints.h"
#include "mpm/PointLaw.h"
#include "mpm/WallCells.h"
#include "mpm/WallMaterial.h"

#include <nlohmann/json.hpp>

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

class vtkDataObject;
class vtkImageData;
class vtkInformation;

/// Between images of phases and material points: what the classes on them share. Not installed.
namespace lamella
{

enum class WallLaw : std::uint8_t
{
  Isotropic,
  Orthotropic,
  Plastic,
  OrthotropicPlastic
};

/// Constants of a wall, in the order of constantNames.
enum class WallConstant : std::uint8_t
{
  Young,             ///< [Pa]; along the axis where there is one. 0: the law's own
  Transverse,        ///< Young's modulus across the axis [Pa]
  Poisson,           ///< along the axis
  TransversePoisson, ///< among the directions across it
  Shear,             ///< [Pa]; 0: from the others
  Barrier,           ///< over the greatest normal stiffness
  Yield,             ///< [Pa]; along the axis where there is one
  TransverseYield,   ///< [Pa], across the axis; 0: as along it
  ShearYield,        ///< [Pa], in shear along the axis; 0: from the others
  Hardening,         ///< [Pa]
  Density            ///< [kg/m³]
};
inline constexpr std::size_t wallConstants = 11;
/// As they are written.
inline constexpr std::array<const char*, wallConstants> wallConstantNames{ "young", "transverse", "poisson",
  "transverse-poisson", "shear", "barrier", "yield", "transverse-yield", "shear-yield", "hardening", "density" };

/// How an image becomes points, as people say it.
struct PointSettings
{
  std::optional<WallLaw> law{};           ///< none: orthotropic where the image has wall directions, else isotropic
  std::optional<mpm::PlaneState> plane{}; ///< none: stress; strain where walls yield
  std::array<double, wallConstants> wall{};
  std::map<std::string, std::map<WallConstant, double>> ofPhase{}; ///< what some phases have of their own
  std::vector<std::string> voids{};                                ///< none: by their names
  int perNode = 2;
  double cellsPerNode = 1; ///< of the grid, along each axis
};

/// The constant of this name. @throws ParameterError that lists all
[[nodiscard]] WallConstant wallConstant(const std::string& name);

/// An image, whatever pieces the pipeline made of it, as points of which each rank makes those of some rows of nodes
/// (layers of a volume). Everything that is not a plain look at a member is collective; errors are thrown by all.
class PointScene
{
public:
  /// @param piece of this rank; all of the image where it works alone
  /// @param team must outlive this
  /// @throws InputError, ParameterError
  PointScene(vtkImageData* piece, vtkInformation* phaseChoice, vtkInformation* axisChoice,
    const PointSettings& settings, const Team& team);

  /// Of the whole image.
  [[nodiscard]] const Lattice& lattice() const noexcept { return lattice_; }
  [[nodiscard]] double gridSpacing() const noexcept { return lattice_.spacing / settings_.cellsPerNode; }
  /// x, y or z; the last for −1. @throws ParameterError
  [[nodiscard]] int axis(int chosen) const;
  /// Lower and upper end of the image [m]; along the axes that are to be fitted those of its tissue.
  [[nodiscard]] std::array<std::array<double, 3>, 2> box(const std::array<bool, 3>& fitted) const;

  /// This rank's, of the image's dimension; their numbers are those that they have on one rank.
  /// @throws as mpm::pointsFromLattice() and the constants of the laws; MemoryError
  template <int Dim>
  [[nodiscard]] mpm::MaterialPoints<Dim> points() const;
  /// Of all ranks.
  [[nodiscard]] std::int64_t pointCount() const noexcept { return eachNode() * solidNodes_; }
  /// First number of the points that each rank is to give out, and one behind the last number: of all points a share as
  /// large as its piece of the image has of the nodes that are not void.
  [[nodiscard]] const std::vector<std::int64_t>& shares() const noexcept { return shares_; }
  template <int Dim>
  [[nodiscard]] std::shared_ptr<const mpm::PointLaw<Dim>> law() const;
  /// What is not joined. @param frictions by pair of phases, as peridynamics::findPair() reads it
  /// @throws ParameterError: a pair that the image does not know, of one phase, of a void, or given twice; a
  /// coefficient below 0; pairs that leave open what is joined
  [[nodiscard]] mpm::Bodies bodies(const std::map<std::string, double>& frictions) const;
  /// Of walls that are too thin for the grid, of too few points a cell, and of constants that are given for nothing.
  [[nodiscard]] std::vector<std::string> warnings() const;

  /// What an output says of its points: phases, law, grid. @returns the settings, for the provenance
  nlohmann::json describe(vtkDataObject* output) const;

private:
  [[nodiscard]] bool solid(std::size_t id) const; ///< whether points have this phase
  [[nodiscard]] bool held(std::size_t id, WallConstant constant) const;
  [[nodiscard]] double value(std::size_t id, WallConstant constant) const;
  [[nodiscard]] std::int64_t eachNode() const noexcept;
  void checkConstants() const;
  void findVoids();
  void shareOut();
  void measureWalls();

  PointSettings settings_;
  const Team& team_;
  WholeImage whole_;
  Lattice lattice_;
  Block own_; ///< rows, or layers, whose points this rank makes
  PhaseIds phases_;
  std::vector<std::int64_t> nodes_; ///< by phase, of the whole image
  std::vector<bool> void_;          ///< by phase
  std::vector<std::uint8_t> phase_; ///< of own nodes, all that is void in one phase
  std::uint8_t empty_ = 0;
  std::int64_t solidNodes_ = 0;
  std::vector<std::int64_t> shares_;
  mpm::WallCells cells_;
  std::vector<std::array<float, 3>> directions_; ///< of own nodes, or none
  WallLaw law_ = WallLaw::Isotropic;
  mpm::PlaneState plane_ = mpm::PlaneState::Stress;
};

extern template mpm::MaterialPoints<2> PointScene::points<2>() const;
extern template mpm::MaterialPoints<3> PointScene::points<3>() const;
extern template std::shared_ptr<const mpm::PointLaw<2>> PointScene::law<2>() const;
extern template std::shared_ptr<const mpm::PointLaw<3>> PointScene::law<3>() const;

} // namespace lamella
