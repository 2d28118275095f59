#pragma once

#include "lbm/Bounds.h"
#include "lbm/DiffusionStudy.h"
#include "lbm/DirectedDiffusivity.h"
#include "lbm/StudyChecks.h"
#include "statistics/ErrorParts.h"

#include "vtkLamellaSolversVTKModule.h" // for the export macro

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

class vtkImageData;

/// What a solve of steady diffusion found, for those who tell it: the output's field data, a report. Not installed.
namespace lamella
{

/// A membrane, and what there is of it.
struct FoundMembrane
{
  std::string name;                   ///< of both phases, as lumen-wall
  double resistance = 0;              ///< metres over the unit of conductivities
  double area = 0;                    ///< of the surface over the volume [1/m]; 0: there is none
  std::optional<std::size_t> place{}; ///< among derivatives
};

struct VTKLAMELLASOLVERSVTK_EXPORT SteadyFindings
{
  std::vector<lbm::DiffusionAnswer> answers; ///< by direction that was solved
  std::vector<double> conductivity;          ///< by phase id; where it differs across the wall, that along it
  std::vector<double> across;                ///< by phase id; empty: the same in every direction
  /// By phase id, xx, yy, zz, xy, yz, xz, of tensors of voxels the mean; NaN: the phase has none. Empty: no phase has.
  /// `conductivity` is then the largest principal value.
  std::vector<lbm::SymmetricTensor<double>> tensors;
  std::vector<double> uncertainty;       ///< of these, half of an interval; empty: none is told
  std::vector<double> acrossUncertainty; ///< likewise
  std::vector<double> fractions;         ///< by phase id
  std::vector<std::string> phases;       ///< names by id; of shares low and high, whatever the image's phases
  bool shares = false;                   ///< of two phases, told by greys
  std::optional<double> rounding;        ///< of conductivities interpolated between greys
  std::vector<FoundMembrane> membranes;  ///< by pair of phases
  double membraneSeries = 0; ///< of them, what a straight line meets, over its length; of the axis that meets most
  std::string phaseArray;
  int dimension = 2;
  lbm::Stencil stencil = lbm::Stencil::D2Q5;
  lbm::Bounds bounds;
  double targetError = 0; ///< 0: none
  /// How far surfaces may lie from where the picture has them [pixels]; NaN: their error was not asked for.
  double surfaceDoubt = std::numeric_limits<double>::quiet_NaN();
  bool windows = false; ///< the window error was asked for
  lbm::Shortfall shortfall;
  std::string direction; ///< as it is written: x, y, z, all
  std::string sides;
  std::string quantity;
  double tolerance = 0;

  /// The tensor by rows, 9 numbers, NaN in columns that were not solved.
  [[nodiscard]] std::array<double, 9> tensor() const;
  /// Has this phase a tensor?
  [[nodiscard]] bool general(std::size_t id) const { return !tensors.empty() && std::isfinite(tensors[id][0]); }
  /// Relative, the largest of the directions; NaN where it is not known.
  [[nodiscard]] double error(double ErrorEstimate::*kind = &ErrorEstimate::relative) const;
  /// How far the picture speaks for its material, relative, the largest of the directions; NaN where it is not known.
  [[nodiscard]] double windowError() const;
  /// Whether outlines can be drawn through the pixels: a picture of two phases, each of which conducts the same in
  /// every direction.
  [[nodiscard]] bool outlinesServe() const;
  /// The only phase that conducts, where there is one and it conducts the same in every direction.
  [[nodiscard]] std::optional<std::size_t> conductingPhase() const;
  /// Effective over that phase's conductivity, the inverse of the formation factor; NaN where several phases conduct.
  [[nodiscard]] double relative(const lbm::DiffusionAnswer& answer) const;
  /// Mean conductivity, the parallel bound, over the effective one. Of one conducting phase its fraction over
  /// relative().
  [[nodiscard]] double tortuosityFactor(const lbm::DiffusionAnswer& answer) const;
  /// What the uncertainty of one conductivity leaves of the value, relative. @param across the one across the wall
  [[nodiscard]] double inputError(const lbm::DiffusionAnswer& answer, std::size_t id, bool across) const;
  /// ∂K/∂R of a membrane; NaN where it was not asked for, 0 where there is none of it.
  [[nodiscard]] static double membraneSensitivity(const lbm::DiffusionAnswer& answer, const FoundMembrane& membrane);
  /// All of them, which are independent: the root of the sum of squares; NaN where none is told.
  [[nodiscard]] double inputError(const lbm::DiffusionAnswer& answer) const;
  /// What the surfaces' doubt leaves of the value, relative; the levels that part one phase from another each are
  /// independent of each other. NaN where it was not asked for.
  [[nodiscard]] double segmentationError(const lbm::DiffusionAnswer& answer) const;
  /// What is known of the value's error, by name: "lattice and picture", "window", "segmentation", "conductivities".
  [[nodiscard]] std::vector<statistics::ErrorPart> errorParts(const lbm::DiffusionAnswer& answer) const;
  [[nodiscard]] double totalError(const lbm::DiffusionAnswer& answer) const; ///< of these
  /// Whether more than the error of lattice and picture was asked for.
  [[nodiscard]] bool tellsParts() const noexcept;
  /// Those of one direction alone.
  [[nodiscard]] SteadyFindings along(int axis) const;
};

/// Writes them into the field data of an image, and one step of provenance.
VTKLAMELLASOLVERSVTK_EXPORT void describe(vtkImageData* output, const SteadyFindings& found);

} // namespace lamella
