#pragma once

#include "mpm/PointCompression.h"

#include <cstdint>
#include <vector>

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
  bool plasticStrain = false;
};

/// The points that a rank gives out: those of some numbers, wherever they are while they move.
template <int Dim>
struct PointShare
{
  std::vector<std::int64_t> firsts;     ///< first number of each rank, and one behind the last number
  std::int64_t first = 0;               ///< of this rank
  std::vector<mpm::Vector<Dim>> places; ///< at the start, from that one on
};

/// @param points at the start, some on each rank
/// @param firsts PointScene::shares(). Collective.
template <int Dim>
[[nodiscard]] PointShare<Dim> shareAtStart(
  const mpm::MaterialPoints<Dim>& points, const std::vector<std::int64_t>& firsts, const Communicator& comm);

/// A vertex a point of this rank's share, in the order of their numbers; arrays as vtkPointCompression says. Its time
/// is the strain. Collective.
/// @param depth z of the points of a picture [m]
template <int Dim>
void setPointState(vtkPolyData* output, const mpm::PointCompression<Dim>& run, const mpm::PointLaw<Dim>& law,
  const PointShare<Dim>& share, const PointArrays& arrays, double depth, const char* creator);

/// The table, a column a number of CompressionRow.
void setCompressionCurve(vtkTable* output, const std::vector<mpm::CompressionRow>& rows, const char* creator);

/// Stress at a strain, between the rows next to it [Pa].
[[nodiscard]] double stressAt(const std::vector<mpm::CompressionRow>& rows, double strain);

extern template PointShare<2> shareAtStart<2>(
  const mpm::MaterialPoints<2>&, const std::vector<std::int64_t>&, const Communicator&);
extern template PointShare<3> shareAtStart<3>(
  const mpm::MaterialPoints<3>&, const std::vector<std::int64_t>&, const Communicator&);
extern template void setPointState<2>(vtkPolyData*, const mpm::PointCompression<2>&, const mpm::PointLaw<2>&,
  const PointShare<2>&, const PointArrays&, double, const char*);
extern template void setPointState<3>(vtkPolyData*, const mpm::PointCompression<3>&, const mpm::PointLaw<3>&,
  const PointShare<3>&, const PointArrays&, double, const char*);

} // namespace lamella
