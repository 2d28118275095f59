#include "StiffnessDirections.h"

#include "FieldNumbers.h"
#include "NewArray.h"

#include "elasticity/DirectionalConstants.h"

#include "vtkCellArray.h"
#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSphereSource.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace lamella
{
namespace
{

namespace el = elasticity;

constexpr int meridians = 97;
constexpr int parallels = 65;
constexpr int lineSteps = 360;
constexpr const char* creator = "vtkVoxelStiffness";

/// A sphere, or a circle, of radius 1.
vtkSmartPointer<vtkPolyData> unitShape(int dimension)
{
  auto shape = vtkSmartPointer<vtkPolyData>::New();
  if (dimension == 3)
  {
    vtkNew<vtkSphereSource> sphere;
    sphere->SetThetaResolution(meridians - 1);
    sphere->SetPhiResolution(parallels);
    sphere->SetRadius(1);
    sphere->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
    sphere->Update();
    shape->CopyStructure(sphere->GetOutput());
    return shape;
  }
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> line;
  line->InsertNextCell(lineSteps + 1);
  for (int i = 0; i <= lineSteps; ++i)
  {
    const double angle = 2 * std::numbers::pi * i / lineSteps;
    line->InsertCellPoint(points->InsertNextPoint(std::cos(angle), std::sin(angle), 0));
  }
  shape->SetPoints(points);
  shape->SetLines(line);
  return shape;
}

} // namespace

void fillDirections(vtkPolyData* data, std::span<const double> stiffness, int dimension, double zero)
{
  const vtkSmartPointer<vtkPolyData> shape = unitShape(dimension);
  const vtkIdType count = shape->GetNumberOfPoints();
  const auto numbers = [&](const std::string& name, const char* unit, const std::string& words, int components = 1)
  {
    auto array = newArray<vtkDoubleArray>(name.c_str(), components, static_cast<std::size_t>(count));
    describe(array, unit, words, creator);
    return array;
  };
  const auto modulus = numbers("youngs_modulus", "Pa", "Young's modulus under stress along this direction");
  const auto direction = numbers("direction", "1", "unit vector", 3);
  std::vector<vtkSmartPointer<vtkDoubleArray>> shear;
  std::vector<vtkSmartPointer<vtkDoubleArray>> poisson;
  const std::string sheared = "shear modulus between this direction and ";
  const std::string drawn = "contraction across over stretch along, under stress along this direction; ";
  if (dimension == 3)
    for (const std::string which : { "least", "most" })
    {
      shear.push_back(numbers("shear_modulus_" + which, "Pa", sheared + "those across it, the " + which));
      poisson.push_back(numbers("poissons_ratio_" + which, "1", drawn + "of all directions across the " + which));
    }
  else
  {
    shear.push_back(numbers("shear_modulus", "Pa", sheared + "the one across it"));
    poisson.push_back(numbers("poissons_ratio", "1", drawn + "in the plane"));
  }
  const el::DirectionalConstants constants(stiffness, dimension, zero);
  double most = 0;
  for (vtkIdType i = 0; i < count; ++i)
  {
    std::array<double, 3> way{};
    shape->GetPoint(i, way.data());
    const el::ConstantsAlong here = constants(way);
    most = std::max(most, here.young);
    modulus->SetValue(i, here.young);
    direction->SetTypedTuple(i, way.data());
    for (std::size_t k = 0; k < shear.size(); ++k)
    {
      shear[k]->SetValue(i, here.shear[k]);
      poisson[k]->SetValue(i, here.poisson[k]);
    }
  }
  vtkPoints* const points = shape->GetPoints();
  for (vtkIdType i = 0; i < count && most > 0; ++i)
  {
    std::array<double, 3> way{};
    direction->GetTypedTuple(i, way.data());
    const double radius = modulus->GetValue(i) / most;
    points->SetPoint(i, radius * way[0], radius * way[1], radius * way[2]);
  }
  data->ShallowCopy(shape);
  data->GetPointData()->SetScalars(modulus);
  data->GetPointData()->AddArray(direction);
  for (std::size_t k = 0; k < shear.size(); ++k)
  {
    data->GetPointData()->AddArray(shear[k]);
    data->GetPointData()->AddArray(poisson[k]);
  }
}

void setExtremes(vtkImageData* output, std::span<const double> stiffness, int dimension, double zero)
{
  const el::ConstantExtremes found = el::DirectionalConstants(stiffness, dimension, zero).extremes();
  std::vector<double> values;
  std::vector<double> along;
  std::vector<double> across;
  for (const auto* const two : { &found.young, &found.shear, &found.poisson })
    for (const el::DirectedValue& one : *two)
    {
      values.push_back(one.value);
      along.insert(along.end(), one.along.begin(), one.along.end());
      across.insert(across.end(), one.across.begin(), one.across.end());
    }
  setFieldNumbers(output, "extremes", values);
  setFieldNumbers(output, "extreme_directions", along);
  setFieldNumbers(output, "extreme_across", across);
}

} // namespace lamella
