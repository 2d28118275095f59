// Pictures of packings: grains at their radius, forces as wide as they are.

#include "Pixels.h"
#include "Samples.h"

#include "vtkOffScreenWindows.h"
#include "vtkSnapshot.h"

#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

using pixels::Rgb;

namespace
{

constexpr Rgb GrainColor{ 0xdc, 0xc0, 0x92 };
constexpr Rgb ForceColor{ 0x7b, 0x1e, 0x2b };

vtkSmartPointer<vtkDoubleArray> numbers(const char* name, std::initializer_list<double> values)
{
  auto array = vtkSmartPointer<vtkDoubleArray>::New();
  array->SetName(name);
  for (const double value : values)
    array->InsertNextValue(value);
  return array;
}

/// Two grains of radius 1 mm side by side in a box that just holds them.
vtkSmartPointer<vtkPolyData> pair(double depth = 0)
{
  vtkNew<vtkPoints> points;
  points->InsertNextPoint(1e-3, 1e-3, 0.5 * depth);
  points->InsertNextPoint(3e-3, 1e-3, 0.5 * depth);
  auto grains = vtkSmartPointer<vtkPolyData>::New();
  grains->SetPoints(points);
  grains->GetPointData()->AddArray(numbers("radius", { 1e-3, 1e-3 }));
  grains->GetFieldData()->AddArray(numbers("box", { 4e-3, 2e-3, depth }));
  return grains;
}

/// A wall's force on the first grain from the left, twice as large as the second's from above.
vtkSmartPointer<vtkPolyData> forces()
{
  vtkNew<vtkPoints> points;
  points->InsertNextPoint(1e-3, 1e-3, 0);
  points->InsertNextPoint(0, 1e-3, 0);
  points->InsertNextPoint(3e-3, 1e-3, 0);
  points->InsertNextPoint(3e-3, 2e-3, 0);
  vtkNew<vtkCellArray> lines;
  lines->InsertNextCell({ 0, 1 });
  lines->InsertNextCell({ 2, 3 });
  auto contacts = vtkSmartPointer<vtkPolyData>::New();
  contacts->SetPoints(points);
  contacts->SetLines(lines);
  contacts->GetPointData()->AddArray(numbers("normal_force", { 2, 2, 1, 1 }));
  return contacts;
}

class SnapshotGrains : public testing::Test
{
protected:
  void SetUp() override
  {
    if (vtkOffScreenWindows::GetBackend() == std::string("none"))
      GTEST_SKIP() << vtkOffScreenWindows::GetMessage();
    this->Snapshot->SetShowLegend(false);
    this->Snapshot->SetShowScaleBar(false);
  }
  vtkImageData* draw(vtkDataObject* data)
  {
    this->Snapshot->SetInputData(data);
    vtkImageData* picture = this->Snapshot->Draw();
    EXPECT_NE(picture, nullptr) << this->Snapshot->GetErrorMessage();
    return picture;
  }
  /// Pixels a metre, from the frame that the data are drawn in: 2 % larger than the box on each axis (2D).
  [[nodiscard]] double scale() const { return this->Snapshot->GetDataRectangle()[2] / (4e-3 * 1.02); }
  vtkNew<vtkSnapshot> Snapshot;
};

} // namespace

TEST_F(SnapshotGrains, DisksHaveTheirRadius)
{
  this->Snapshot->SetOverlayLines(forces()); // plain disks
  vtkImageData* const picture = this->draw(pair());
  ASSERT_NE(picture, nullptr);
  const double grain = pixels::shareOf(picture, pixels::whole(picture), GrainColor) +
    pixels::shareOf(picture, pixels::whole(picture), ForceColor);
  const int* const size = picture->GetDimensions();
  const double area = grain * size[0] * size[1] / (this->scale() * this->scale());
  // Outlines and smoothed edges are of other colours: a few per cent of disks some hundred pixels wide.
  EXPECT_NEAR(area, 2 * std::numbers::pi * 1e-6, 0.06 * 2 * std::numbers::pi * 1e-6);
}

TEST_F(SnapshotGrains, ForcesAreAsWideAsTheyAreLarge)
{
  this->Snapshot->SetOverlayLines(forces());
  vtkImageData* const picture = this->draw(pair());
  ASSERT_NE(picture, nullptr);
  const int* const r = this->Snapshot->GetDataRectangle();
  // Across the left bar half way to the wall, and across the upper one.
  const auto width = [&](double x, double y, bool upright)
  {
    int count = 0;
    for (int i = -150; i <= 150; ++i)
    {
      const int px = r[0] + static_cast<int>(std::lround(r[2] / 2.0 + (x - 2e-3) * this->scale())) + (upright ? 0 : i);
      const int py = r[1] + static_cast<int>(std::lround(r[3] / 2.0 + (y - 1e-3) * this->scale())) + (upright ? i : 0);
      count += pixels::at(picture, px, py) == ForceColor ? 1 : 0;
    }
    return count;
  };
  const int strong = width(0.6e-3, 1e-3, true);
  const int weak = width(3e-3, 1.4e-3, false);
  EXPECT_GT(weak, 20);
  EXPECT_NEAR(strong, 2 * weak, 0.05 * strong); // bars have twelve sides, and are seen from any
}

TEST_F(SnapshotGrains, LegendTellsTheLargestForce)
{
  this->Snapshot->SetOverlayLines(forces());
  this->Snapshot->SetShowLegend(true);
  vtkImageData* const picture = this->draw(pair());
  ASSERT_NE(picture, nullptr);
  const int* const size = picture->GetDimensions();
  const int below = this->Snapshot->GetDataRectangle()[1]; // the legend's bar lies there
  ASSERT_GT(below, 0);
  EXPECT_GT(pixels::shareOf(picture, { 0, 0, size[0], below }, ForceColor), 0);
}

TEST_F(SnapshotGrains, SpheresAreRoundAndStandAsideForForces)
{
  vtkImageData* picture = this->draw(pair(2e-3));
  ASSERT_NE(picture, nullptr);
  const double shapes = 1 - pixels::shareOf(picture, pixels::whole(picture), Rgb{ 255, 255, 255 });
  this->Snapshot->SetOverlayLines(forces());
  picture = this->draw(pair(2e-3));
  ASSERT_NE(picture, nullptr);
  EXPECT_GT(shapes, 0.2);
  EXPECT_LT(1 - pixels::shareOf(picture, pixels::whole(picture), Rgb{ 255, 255, 255 }), 0.5 * shapes);
}
