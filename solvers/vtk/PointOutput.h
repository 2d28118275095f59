#pragma once

#include "mpm/PointCompression.h"

#include <vector>

class vtkDataObject;
class vtkPolyData;
class vtkTable;

/// What a compression gives out. Not installed.
namespace lamella
{

/// Which arrays the points carry besides `id` and `phase`.
struct PointArrays
{
  bool displacement = true;
  bool velocity = false;
  bool stress = false;
  bool deformationGradient = false;
  bool energyDensity = false;
};

/// A vertex a point, in the order of their numbers; arrays as vtkPointCompression says. Its time is the strain.
/// @param start positions at the start, by number
/// @param depth z of the points of a picture [m]
template <int Dim>
void setPointState(vtkPolyData* output, const mpm::PointCompression<Dim>& run, const mpm::PointLaw<Dim>& law,
  const std::vector<mpm::Vector<Dim>>& start, const PointArrays& arrays, double depth, const char* creator);

/// The table, a column a number of CompressionRow.
void setCompressionCurve(vtkTable* output, const std::vector<mpm::CompressionRow>& rows, const char* creator);

/// Stress at a strain, between the rows next to it [Pa].
[[nodiscard]] double stressAt(const std::vector<mpm::CompressionRow>& rows, double strain);

extern template void setPointState<2>(vtkPolyData*, const mpm::PointCompression<2>&, const mpm::PointLaw<2>&,
  const std::vector<mpm::Vector<2>>&, const PointArrays&, double, const char*);
extern template void setPointState<3>(vtkPolyData*, const mpm::PointCompression<3>&, const mpm::PointLaw<3>&,
  const std::vector<mpm::Vector<3>>&, const PointArrays&, double, const char*);

} // namespace lamella
