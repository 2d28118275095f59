#pragma once

#include "VoxelMaterials.h"

#include "statistics/ErrorParts.h"

#include "vtkLamellaSolversVTKModule.h" // for the export macro

#include <cstddef>
#include <span>
#include <string>
#include <vector>

class vtkDataObject;

/// How a box's stiffness changes with what its phases are told by, and what their uncertainty leaves of it, as field
/// data. Not installed.
namespace lamella
{

/// `material_numbers`, `material_values`, `material_uncertainty`; by these in turn `stiffness_sensitivity`,
/// `constants_sensitivity`, of a load alone `load_energy_sensitivity` [J/m³].
void setSensitivity(
  vtkDataObject* data, const elasticity::VoxelStiffness& found, std::span<const MaterialNumber> numbers);

/// `surface_doubt`, `surface_pairs`, `stiffness_surface_sensitivity`, `constants_surface_sensitivity`,
/// `constants_segmentation_error`.
/// @param names of phases by id
void setSurfaces(
  vtkDataObject* data, const elasticity::VoxelStiffness& found, std::span<const std::string> names, double doubt);

/// `constants_input_error`.
void setInputErrors(
  vtkDataObject* data, const elasticity::VoxelStiffness& found, std::span<const MaterialNumber> numbers);

/// `constants_total_error`, each in its constant's unit. After all else.
void setTotalErrors(vtkDataObject* data, const elasticity::VoxelStiffness& found);

/// What the field data tell of a constant's error: "lattice and picture", "window", "segmentation", "constants"
/// (of the phases).
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT std::vector<statistics::ErrorPart> constantErrorParts(
  vtkDataObject* data, std::size_t constant);

} // namespace lamella
