#pragma once

#include "lattice/Phases.h"
#include "outlines/ContourExtraction.h"

#include <optional>
#include <string>
#include <vector>

#include "vtkLamellaSolversVTKModule.h" // for the export macro

class vtkDataObject;
class vtkImageData;

/// Helper of the classes of outlines and the program; not installed.
namespace lamella
{

struct PhaseIds;

/// How outlines are found in a picture. Outlines carry it, as the field data `extraction`, so that they can be found in
/// coarser pictures, too.
struct OutlineRecipe
{
  enum Basis
  {
    Phases,
    Level,
    Shares
  };
  Basis basis = Phases;
  std::string array;  ///< of the phases or numbers, at points
  std::string lumen;  ///< name of the phase
  double level = 0.5; ///< between lumens and walls
  bool below = false; ///< lumens are where numbers are below it
  double pixel = 0;   ///< of the picture [m]
  double doubt = 0;   ///< how far outlines of a scan may lie from where walls begin [pixels]; 0: it is none
  micrograph::ExtractOptions options;
};

VTKLAMELLASOLVERSVTK_EXPORT void setRecipe(vtkDataObject* outlines, const OutlineRecipe& recipe);
/// Of outlines that are from no picture: nothing. @throws InputError for one that cannot be read
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT std::optional<OutlineRecipe> recipeOf(vtkDataObject* outlines);

/// A picture of numbers as extractContours() takes it.
struct ContourField
{
  PhaseImage image;         ///< phases "lumen" and "wall"
  std::vector<float> level; ///< #nodes, above 0 in lumens
  std::string array;        ///< its name
};

/// @param array its name, `lumen_share` if empty: at points, one component, finite; unsigned whole numbers of 8 or 16
///   bits count as parts of the largest one
/// @param shares values are lumen's (or, `below`, the wall's) shares of the pixels, from 0 to 1; else lumens are where
///   they are above (below) the level
/// @throws InputError, ParameterError
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT ContourField contourField(
  vtkImageData* image, const std::string& array, bool shares, double level, bool below);

/// The same of phases: lumens are the phase with this id.
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT ContourField contourField(
  const Lattice& lattice, const PhaseIds& phases, std::size_t lumen);

/// The same as a recipe says. @throws InputError, ParameterError
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT ContourField contourField(vtkImageData* image, const OutlineRecipe& recipe);

/// Where a picture says what of the walls is the middle lamella.
struct LamellaLabels
{
  PhaseImage image;
  std::uint8_t lamella = 0;
};
/// @param picture in which outlines were found as the recipe says; null: none was given
/// @param wanted name of the phase; empty: that which is called middle lamella, or lamella
/// @throws ParameterError, InputError
[[nodiscard]] LamellaLabels lamellaLabels(
  vtkImageData* picture, const std::optional<OutlineRecipe>& recipe, const std::string& wanted);

/// The spacing that is asked for [m]; where that is 0 the picture's pixel, of outlines from none a quarter of the
/// walls.
/// @param median thickness of the walls [m]
/// @throws ParameterError where there is nothing to choose it by
[[nodiscard]] double spacingOf(double asked, const std::optional<OutlineRecipe>& recipe, double median);

/// A point array of phases by its name. @throws InputError where it is not there
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT PhaseIds phasesCalled(vtkImageData* image, const std::string& array);

} // namespace lamella
