#pragma once

#include "OnRanks.h"
#include "VtkTesting.h"
#include "vtkMicrographContours.h"

#include "generators/Generators.h"
#include "outlines/ContourExtraction.h"

#include <limits>

/// What the tests of outlines and of lattices made from them share.
namespace lamella::vtktest
{

inline constexpr double notANumber = std::numeric_limits<double>::quiet_NaN();

/// Softwood at a resolution at which its walls, of about 6 nodes, are well told.
inline PhaseImage tissue()
{
  generators::SoftwoodOptions options;
  options.size = { 240, 200, 1 };
  options.spacing = 0.5e-6;
  options.seed = 3;
  return generators::softwood(options);
}

inline micrograph::ContourSet expectedContours(const micrograph::ExtractOptions& options = {})
{
  return micrograph::extractContours(tissue(), 0, {}, options).contours;
}

inline vtkNew<vtkMicrographContours> contoursOf(vtkImageData* image)
{
  vtkNew<vtkMicrographContours> filter;
  filter->SetInputData(image);
  return filter;
}

/// On any number of ranks.
class Micrograph : public vtktest::OnRanks
{
};

} // namespace lamella::vtktest
