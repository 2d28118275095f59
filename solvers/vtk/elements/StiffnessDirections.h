#pragma once

#include <span>

class vtkImageData;
class vtkPolyData;

/// Engineers' constants of a stiffness by direction, as a shape and as field data. Not installed.
namespace lamella
{

/// A closed surface, of a picture a closed line, as far from the origin as Young's modulus over the largest. Point
/// arrays `direction`, `youngs_modulus`, and of all directions across each the least and the most:
/// `shear_modulus_least` …; in the plane, which has one, `shear_modulus` and `poissons_ratio`.
/// @param stiffness by rows, Voigt's order [Pa]
/// @param zero      as elasticity::DirectionalConstants has it
void fillDirections(vtkPolyData* data, std::span<const double> stiffness, int dimension, double zero);

/// `extremes` [Pa; 1]: Young's modulus, shear modulus, Poisson's ratio, of each the least and the most of all
/// directions; `extreme_directions` and `extreme_across`: three numbers of each.
void setExtremes(vtkImageData* output, std::span<const double> stiffness, int dimension, double zero);

} // namespace lamella
