#pragma once

#include "packing/Bridges.h"
#include "packing/Packing.h"

#include "vtkLamellaSolversVTKModule.h" // for the export macro

#include "vtkSmartPointer.h"

#include <cstddef>
#include <string>

class vtkImageData;
class vtkPolyData;

/// Between packings of grains, cemented samples and VTK's data objects.
///
/// Particles are points, one vertex each, with the point arrays `radius` [m], `diameter` [m], `grain` (from 1),
/// `contacts` (number of a grain's contacts), `rattler`, `net_force` and `normal_force` (sums over a grain's contacts);
/// field data `box`, `periodic` and the packing's statistics.
/// Contacts are lines from centre to centre (or to the point on a wall), each with two points of its own, with the cell
/// arrays `force`, `normal_force`, `overlap`, `first`, `second`, `wall`. docs/data-model.md says what each means.
namespace lamella
{

/// @param numbers  its statistics()
/// @param creator  class that made it, for the arrays' descriptions
/// @param contacts also filled unless null
VTKLAMELLASOLVERSVTK_EXPORT void setPacking(const packing::Packing& packing, const packing::PackingStatistics& numbers,
  const std::string& creator, vtkPolyData* particles, vtkPolyData* contacts);

/// What the grains and contacts of setPacking() take, about [bytes].
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT std::size_t packingBytes(const packing::Packing& packing);

/// The grains of poly data: points with the array `radius` (or `diameter`). With the field data `box` the grains are
/// taken as they are, without contacts; without it the packing is checked as packing::packingOf() does, and its box is
/// that of the grains. Grains whose z are all 0 are disks.
/// @throws InputError: no such array, no grains, a radius that is not positive, what packingOf() refuses
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT packing::Packing packingFrom(vtkPolyData* particles);

/// Cements a packing (packing::cement()): an image with the point arrays `phase` and `grain`, the field data
/// `phase_names`, `pixel_size_source` and the sample's numbers; no provenance.
/// @throws as packing::cement(); ParameterError when `filled` and `saturation` contradict each other
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT vtkSmartPointer<vtkImageData> cementedImage(const packing::Packing& packing,
  const packing::BridgeOptions& bridges, const packing::RasterOptions& raster, const std::string& creator);

} // namespace lamella
