#pragma once

#include "VtkTesting.h"

#include "vtkLatticeConversion.h"

#include "vtkImageData.h"
#include "vtkSmartPointer.h"

#include <string>
#include <vector>

/// What the tests of stiffnesses, by bonds and by elements, are done on.
namespace lamella::vtktest
{

/// Layers along the diagonal of two phases, wall and lamella, with a hole.
inline vtkSmartPointer<vtkImageData> layersWithAHole(int nz = 1)
{
  const auto phaseAt = [](int x, int y, int z) {
    return (x - 9) * (x - 9) + (y - 14) * (y - 14) + (z - 4) * (z - 4) < 30 ? 0 : (x + y) % 8 < 4 ? 1 : 2;
  };
  const auto image = picture(nz > 1 ? 16 : 24, nz > 1 ? 20 : 32, nz, phaseAt, 1e-5);
  setFieldTexts(image, "phase_names", std::vector<std::string>{ "void", "wall", "lamella" });
  return image;
}

} // namespace lamella::vtktest
