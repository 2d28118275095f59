#pragma once

#include "vtkSmartPointer.h"

class vtkPolyData;

/// Packings of grains: points with the array `radius`, and contacts with the array `normal_force`.
namespace lamella::rendering
{

/// Whether all that the data hold are points that have a `radius`.
[[nodiscard]] bool AreGrains(vtkPolyData* data);

/// A disk or, where z differs from 0 or the box has a depth, a sphere for every grain; arrays at points go along.
[[nodiscard]] vtkSmartPointer<vtkPolyData> GrainShapes(vtkPolyData* grains);

/// Contacts as bars (in 3D rods) as wide as their `normal_force`, the widest a little less than the smallest grain's
/// radius; where there are no forces, all of one width.
[[nodiscard]] vtkSmartPointer<vtkPolyData> ForceShapes(vtkPolyData* contacts, vtkPolyData* grains);

/// The largest `normal_force`, which the widest bar stands for; 0 where there are none.
[[nodiscard]] double LargestForce(vtkPolyData* contacts);

/// The edges of the box that the field data tell; null where they tell none.
[[nodiscard]] vtkSmartPointer<vtkPolyData> BoxEdges(vtkPolyData* grains);

} // namespace lamella::rendering
