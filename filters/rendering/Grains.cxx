#include "Grains.h"

#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkGlyph3D.h"
#include "vtkNew.h"
#include "vtkOutlineSource.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkRegularPolygonSource.h"
#include "vtkSphereSource.h"
#include "vtkTubeFilter.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lamella::rendering
{
namespace
{

bool AreDisks(vtkPolyData* grains)
{
  std::array<double, 6> bounds{};
  grains->GetBounds(bounds.data());
  vtkDataArray* const box = grains->GetFieldData()->GetArray("box");
  const bool deep = box && box->GetNumberOfValues() == 3 && box->GetVariantValue(2).ToDouble() > 0;
  return !deep && bounds[4] == 0 && bounds[5] == 0;
}

} // namespace

bool AreGrains(vtkPolyData* data)
{
  vtkDataArray* const radius = data->GetPointData()->GetArray("radius");
  return radius && radius->GetNumberOfComponents() == 1 && data->GetNumberOfLines() == 0 &&
    data->GetNumberOfPolys() == 0 && data->GetNumberOfStrips() == 0;
}

vtkSmartPointer<vtkPolyData> GrainShapes(vtkPolyData* grains)
{
  vtkNew<vtkGlyph3D> glyphs;
  vtkNew<vtkRegularPolygonSource> disk;
  vtkNew<vtkSphereSource> sphere;
  if (AreDisks(grains))
  {
    disk->SetNumberOfSides(96);
    disk->SetRadius(1);
    glyphs->SetSourceConnection(disk->GetOutputPort());
  }
  else
  {
    sphere->SetRadius(1);
    sphere->SetThetaResolution(48);
    sphere->SetPhiResolution(32);
    glyphs->SetSourceConnection(sphere->GetOutputPort());
  }
  glyphs->SetInputData(grains);
  glyphs->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "radius");
  glyphs->SetScaleModeToScaleByScalar();
  glyphs->SetColorModeToColorByScale();
  glyphs->ScalingOn();
  glyphs->OrientOff();
  glyphs->ClampingOff();
  glyphs->Update();
  vtkSmartPointer<vtkPolyData> shapes = glyphs->GetOutput();
  shapes->GetFieldData()->ShallowCopy(grains->GetFieldData());
  return shapes;
}

double LargestForce(vtkPolyData* contacts)
{
  vtkDataArray* const force = contacts->GetPointData()->GetArray("normal_force");
  double largest = 0;
  for (vtkIdType i = 0; force && i < force->GetNumberOfTuples(); ++i)
  {
    const double value = std::abs(force->GetComponent(i, 0));
    largest = std::isfinite(value) ? std::max(largest, value) : largest;
  }
  return largest;
}

vtkSmartPointer<vtkPolyData> ForceShapes(vtkPolyData* contacts, vtkPolyData* grains)
{
  std::array<double, 2> radii{ 0, 0 };
  grains->GetPointData()->GetArray("radius")->GetRange(radii.data());
  vtkDataArray* const force = contacts->GetPointData()->GetArray("normal_force");
  const double largest = LargestForce(contacts);
  vtkNew<vtkDoubleArray> width;
  width->SetName("width");
  width->SetNumberOfTuples(contacts->GetNumberOfPoints());
  for (vtkIdType i = 0; i < width->GetNumberOfTuples(); ++i)
  {
    const double value = largest > 0 ? std::abs(force->GetComponent(i, 0)) / largest : 0.15;
    width->SetValue(i, 0.45 * radii[0] * (std::isfinite(value) ? value : 0.0));
  }
  vtkNew<vtkPolyData> lines;
  lines->CopyStructure(contacts);
  lines->GetPointData()->SetScalars(width);
  vtkNew<vtkTubeFilter> tubes;
  tubes->SetInputData(lines);
  tubes->SetRadius(1);
  tubes->SetVaryRadiusToVaryRadiusByAbsoluteScalar();
  tubes->SetNumberOfSides(12);
  tubes->CappingOn();
  tubes->Update();
  vtkSmartPointer<vtkPolyData> shapes = tubes->GetOutput();
  shapes->GetPointData()->SetScalars(nullptr);
  return shapes;
}

vtkSmartPointer<vtkPolyData> BoxEdges(vtkPolyData* grains)
{
  vtkDataArray* const box = grains->GetFieldData()->GetArray("box");
  if (!box || box->GetNumberOfValues() != 3)
    return nullptr;
  vtkNew<vtkOutlineSource> outline;
  outline->SetBounds(0, box->GetVariantValue(0).ToDouble(), 0, box->GetVariantValue(1).ToDouble(), 0,
    box->GetVariantValue(2).ToDouble());
  outline->Update();
  return outline->GetOutput();
}

} // namespace lamella::rendering
