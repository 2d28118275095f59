#pragma once

#include "PhaseIds.h"
#include "vtkLatticeConversion.h"
#include "vtkPieces.h"

#include "peridynamics/BondModel.h"
#include "peridynamics/ElasticStudy.h"
#include "peridynamics/NodeField.h"
#include "peridynamics/PairTable.h"

#include "vtkLamellaSolversVTKModule.h" // for the export macro

#include "vtkSmartPointer.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

class vtkDataArray;
class vtkDoubleArray;
class vtkImageData;
class vtkInformation;

/// Between images of phases and the peridynamic lattice: what the solver and the filters on its results share. Not
/// installed.
namespace lamella
{

/// A model of bonds as people write it; the same for every sample.
struct BondSettings
{
  peridynamics::PairTable materials{};
  std::optional<peridynamics::Continuum> continuum{}; ///< none: plane stress for pictures, space for volumes
  double horizon = 3;
  /// None: isotropic in volumes, as in the literature in pictures.
  std::optional<peridynamics::Micromodulus> micromodulus{};
  peridynamics::VoidBonds voidBonds = peridynamics::VoidBonds::Keep;
  bool surfaceCorrection = false;
  bool largeStrains = false;
  std::vector<peridynamics::Notch> notches{};
  std::array<bool, 3> periodic{ false, false, false };
};

[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT nlohmann::json toJson(const BondSettings& settings);
/// Values that were meant in another unit, as it seems: a slip that nothing else tells.
[[nodiscard]] std::vector<std::string> unitDoubts(const peridynamics::PairTable& materials);
/// @throws InputError for what toJson() did not write
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT BondSettings bondSettingsFromJson(const std::string& text);

/// An image as the rank's slab of a sample, whatever pieces the pipeline made.
class VTKLAMELLASOLVERSVTK_EXPORT BondScene
{
public:
  /// Collective. @throws Error on every rank
  BondScene(vtkImageData* piece, vtkInformation* phaseChoice, vtkInformation* grainChoice, const BondSettings& settings,
    const Team& team);

  [[nodiscard]] const Lattice& lattice() const noexcept { return whole_.lattice; }
  [[nodiscard]] const peridynamics::BondModel& model() const noexcept { return model_; }
  [[nodiscard]] const PhaseIds& phases() const noexcept { return phases_; }
  [[nodiscard]] const Block& slab() const noexcept { return slab_; }
  /// Of the slab. Grains are empty when the model does not ask for them.
  [[nodiscard]] std::span<const std::uint8_t> phase() const noexcept { return phase_; }
  [[nodiscard]] std::span<const std::int32_t> grain() const noexcept { return grain_; }

  /// Phases and grains of all nodes, in lattice order.
  struct Whole
  {
    std::vector<std::uint8_t> phase;
    std::vector<std::int32_t> grain; ///< empty when the model does not ask for them
  };
  /// Collective: on every rank.
  [[nodiscard]] Whole whole() const;

  /// Of the whole image, by phase id.
  [[nodiscard]] const std::vector<std::int64_t>& nodes() const noexcept { return nodes_; }

  /// Collective. Own nodes of a field as an array of the piece: component c of the array is component `from[c]` of the
  /// field, or 0 where that is negative. Nodes in voids get `inVoids`: what solvers keep there has no meaning.
  [[nodiscard]] vtkSmartPointer<vtkDoubleArray> toPiece(const peridynamics::NodeField<double>& field,
    std::span<const int> from, const char* name, double inVoids = 0) const;

  /// Collective. The first components of an array of the piece, on the slab's own nodes.
  /// @throws InputError for values that are not finite at solid nodes
  void toSlab(vtkDataArray* array, const std::string& name, peridynamics::NodeField<double>& field) const;

private:
  [[nodiscard]] bool isVoid(std::size_t node) const;

  const Team& team_;
  WholeImage whole_;
  PhaseIds phases_;
  peridynamics::BondModel model_;
  Block slab_;
  std::vector<std::uint8_t> phase_;
  std::vector<std::int32_t> grain_;
  std::vector<std::int64_t> nodes_;
};

/// Stress with six components in VTK's order: xx, yy, zz, xy, yz, xz. In plane strain zz is ν (xx + yy).
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT vtkSmartPointer<vtkDoubleArray> stressArray(
  const BondScene& scene, const peridynamics::NodeField<double>& stress, const char* creator);

/// What an output says of its model, the same after every solve: pairs with their materials, continuum, horizon,
/// Poisson's ratio, phases with their shares, `bond_model`. @returns the settings, for the provenance
VTKLAMELLASOLVERSVTK_EXPORT nlohmann::json describeModel(
  vtkImageData* output, const BondScene& scene, const BondSettings& settings);

/// Thickness of phases: `thickness_phases`, `thickness_median`, `thickness_thin_share`.
VTKLAMELLASOLVERSVTK_EXPORT void describeThickness(
  vtkImageData* output, const BondScene& scene, std::span<const peridynamics::PhaseThickness> thickness);

/// The field text that carries the model from the solver to filters on its result.
constexpr const char* bondModelName = "bond_model";

} // namespace lamella
