#pragma once

#include "lattice/Phases.h"
#include "lbm/SteadyDiffusion.h"

#include "vtkLamellaSolversVTKModule.h" // for the export macro

#include "vtkSmartPointer.h"

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

class vtkDataArray;
class vtkDataObject;
class vtkDoubleArray;
class vtkImageData;
class vtkUnsignedCharArray;

/// Between the numerics' plain structs and VTK's data objects.
///
/// A lattice is an image with *point* data: nodes are pixel centres, so dimensions are the numbers of pixels, the
/// origin lies half a spacing from the picture's corner, and an image of one layer along z is two-dimensional. Memory
/// order is the same on both sides, so nothing is reordered and, where it says so, nothing is copied.
///
/// Names of arrays: points carry `phase` (unsigned char, the position in `phase_names`), `temperature` or
/// `concentration`, and `flux`. Field data carries what the whole image knows: `phase_names` (strings), `provenance`
/// (one JSON string), `pixel_size_source`, and the results of a solve.
namespace lamella
{

/// What an image knows of its phases, without a copy. `image` must live as long as the view.
struct PhaseView
{
  Lattice lattice;
  std::span<const std::uint8_t> phase; ///< lattice.count() ids
  PhaseTable phases;
};

/// An image that takes over the vector of phases: no copy.
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT vtkSmartPointer<vtkImageData> toImageData(PhaseImage image);

/// The phases of a whole image (one piece), in place. Without `phase_names` the names are "0", "1", ...
/// @throws InputError when the array is missing, holds cells, has several components or is not unsigned char; when
///   the image is empty or its spacing differs between axes, where these must be `Cubes`
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT PhaseView viewPhases(
  vtkImageData* image, const char* array = "phase", Voxels voxels = Voxels::Cubes);

/// The same as a copy that lives on its own.
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT PhaseImage toPhaseImage(
  vtkImageData* image, const char* array = "phase", Voxels voxels = Voxels::Cubes);

/// The lattice of an image of this whole extent; its origin is the position of the extent's first node.
/// @throws InputError when the extent is empty, and where the spacing differs between axes that have more than one
/// node and voxels must be cubes
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT Lattice latticeOf(
  const int wholeExtent[6], const double origin[3], const double spacing[3], Voxels voxels = Voxels::Cubes);
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT Lattice latticeOf(vtkImageData* image, Voxels voxels = Voxels::Cubes);

/// @throws InputError for an image whose axes are not those of space: what is computed goes along x, y and z
VTKLAMELLASOLVERSVTK_EXPORT void requireUpright(const double direction[9]);
VTKLAMELLASOLVERSVTK_EXPORT void requireUpright(vtkImageData* image);

/// A piece's extent as a block counted from the first node of the whole extent; all zero when the piece is empty.
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT lbm::Block blockOf(const int extent[6], const int wholeExtent[6]) noexcept;

/// Dimensions, spacing, origin of an empty image.
VTKLAMELLASOLVERSVTK_EXPORT void setGeometry(vtkImageData* image, const Lattice& lattice);

/// Hands a vector to VTK: no copy; the memory is freed when the last array that shares it goes.
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT vtkSmartPointer<vtkUnsignedCharArray> adopt(
  std::vector<std::uint8_t> values, const char* name);

/// Unit (such as "W/m^2"; "1" for a ratio), description and creator, kept in the array's information, hence in files.
VTKLAMELLASOLVERSVTK_EXPORT void describe(
  vtkDataArray* array, const std::string& unit, const std::string& description, const std::string& creator);
/// What describe() wrote as {unit, description, creator}; empty strings where there is nothing.
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT std::array<std::string, 3> description(vtkDataArray* array);

/// Field number of a run's state: its place among all that were asked for, from 0, those before a checkpoint too.
inline constexpr const char* stateNumber = "state_number";

/// Field data. Setting replaces what has that name; reading gives nothing (or an empty list) where it is missing.
VTKLAMELLASOLVERSVTK_EXPORT void setFieldText(vtkDataObject* data, const char* name, const std::string& text);
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT std::optional<std::string> fieldText(vtkDataObject* data, const char* name);
VTKLAMELLASOLVERSVTK_EXPORT void setFieldTexts(
  vtkDataObject* data, const char* name, std::span<const std::string> texts);
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT std::vector<std::string> fieldTexts(vtkDataObject* data, const char* name);
/// One tuple a number (not one tuple of many components: ParaView would take the norm of a tensor's numbers, and
/// complain of those that are NaN).
VTKLAMELLASOLVERSVTK_EXPORT vtkDoubleArray* setFieldNumbers(
  vtkDataObject* data, const char* name, std::span<const double> values);
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT std::vector<double> fieldNumbers(vtkDataObject* data, const char* name);

/// `phase_names`. Reading gives an empty table where there are none.
VTKLAMELLASOLVERSVTK_EXPORT void setPhaseNames(vtkDataObject* data, const PhaseTable& phases);
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT PhaseTable phaseNames(vtkDataObject* data);

/// `provenance`: one JSON object (io/Provenance.h).
VTKLAMELLASOLVERSVTK_EXPORT void setProvenance(vtkDataObject* data, const std::string& json);
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT std::string provenance(vtkDataObject* data);

} // namespace lamella
