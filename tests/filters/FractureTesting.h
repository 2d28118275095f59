#pragma once

#include "OnRanks.h"
#include "VtkTesting.h"

#include "vtkBondFracture.h"

#include "vtkOutputWindow.h"
#include "vtkPolyData.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

/// A sample that breaks along a weak band, for the tests of vtkBondFracture.
namespace lamella::vtktest
{

class BondFracture : public OnRanks
{
protected:
  static void SetUpTestSuite()
  {
    OnRanks::SetUpTestSuite();
    vtkOutputWindow::GetInstance()->SetDisplayModeToNever(); // warnings of thin phases
  }
};

inline constexpr double bandSpacing = 1e-5;

/// Wall with a hole and a softer, weaker band across.
inline int bandRule(int x, int y, int z)
{
  const int middle = 14 + x / 8;
  return (x - 15) * (x - 15) + (y - 20) * (y - 20) + (z - 4) * (z - 4) < 14 ? 0 : std::abs(y - middle) < 3 ? 2 : 1;
}

inline vtkSmartPointer<vtkImageData> band(int nx = 24, int ny = 36, int nz = 1)
{
  const auto image = picture(nx, ny, nz, bandRule, bandSpacing);
  setFieldTexts(image, "phase_names", std::vector<std::string>{ "void", "wall", "lamella" });
  return image;
}

inline void configure(vtkBondAlgorithm* filter)
{
  filter->SetYoungsModulus("wall", 4e9);
  filter->SetYoungsModulus("lamella", 1e9);
  filter->SetCriticalStretch("wall", 1e-2);
  filter->SetCriticalStretch("lamella", 2e-3);
  filter->SetLike("lamella-wall", "lamella");
}

inline double number(vtkDataObject* data, const char* name, std::size_t i = 0)
{
  const std::vector<double> values = fieldNumbers(data, name);
  EXPECT_GT(values.size(), i) << name;
  return values.size() > i ? values[i] : std::nan("");
}

} // namespace lamella::vtktest
