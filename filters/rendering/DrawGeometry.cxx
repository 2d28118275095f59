#include "Drawing.h"

#include "core/Error.h"

#include "Arrays.h"
#include "Grains.h"
#include "Quantity.h"
#include "ShownUnit.h"
#include "Surface.h"
#include "View.h"
#include "vtkActor.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkRenderer.h"
#include "vtkSnapshot.h"
#include "vtkTubeFilter.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace lamella::rendering
{
namespace
{

constexpr Color PlainColor{ 0x44, 0x77, 0xaa, 255 }; // geometry without any array
constexpr Color GrainColor{ 0xdc, 0xc0, 0x92, 255 }; // grains behind forces: that of the phase
constexpr Color EdgeColor{ 0x8a, 0x76, 0x55, 255 };
constexpr Color ForceColor{ 0x7b, 0x1e, 0x2b, 255 };

/// What the widest bar stands for, to two digits.
LegendEntry DescribeForces(vtkPolyData* contacts)
{
  const double largest = LargestForce(contacts);
  const double step = std::pow(10.0, std::floor(std::log10(largest)) - 1);
  int exponent = 0;
  std::string text = "widest bar: " + TickLabels({ step * std::round(largest / step) }, exponent).front();
  text += exponent == 0 ? "" : " · 10" + RaisedText(exponent);
  const std::string unit = shownUnit(contacts->GetPointData()->GetArray("normal_force"));
  return { text + (unit.empty() ? "" : " " + unit), ForceColor, LegendEntry::Kind::Line, GrainColor };
}

/// Adds geometry in one colour.
vtkActor* AddPlain(vtkRenderer* renderer, vtkPolyData* geometry, Color color, double width)
{
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(geometry);
  mapper->ScalarVisibilityOff();
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(color.r / 255.0, color.g / 255.0, color.b / 255.0);
  actor->GetProperty()->SetLineWidth(static_cast<float>(width));
  renderer->AddActor(actor); // which keeps it
  return actor;
}

/// Lines and surfaces without their arrays but the normals, and with the colours to draw them in.
vtkSmartPointer<vtkPolyData> Colored(vtkPolyData* geometry, const std::optional<Quantity>& field)
{
  auto colored = vtkSmartPointer<vtkPolyData>::New();
  colored->CopyStructure(geometry);
  colored->GetPointData()->SetNormals(geometry->GetPointData()->GetNormals());
  colored->GetCellData()->SetNormals(geometry->GetCellData()->GetNormals());
  if (field)
  {
    vtkNew<vtkUnsignedCharArray> colors;
    colors->SetNumberOfComponents(3);
    colors->SetNumberOfTuples(static_cast<vtkIdType>(field->Count()));
    for (std::size_t i = 0; i < field->Count(); ++i)
    {
      const Color color = field->ColorOf(i);
      colors->SetTuple3(static_cast<vtkIdType>(i), color.r, color.g, color.b);
    }
    colors->SetName("color");
    if (field->onCells)
      colored->GetCellData()->SetScalars(colors);
    else
      colored->GetPointData()->SetScalars(colors);
  }
  return colored;
}

/// With room for the thickness of lines, and so that a straight line has an area.
std::array<double, 6> RoomyBounds(vtkPolyData* geometry, double& size, bool& isFlat)
{
  std::array<double, 6> bounds{};
  geometry->GetBounds(bounds.data());
  size = std::max({ bounds[1] - bounds[0], bounds[3] - bounds[2], bounds[5] - bounds[4] });
  if (!(size > 0) || !std::isfinite(size))
    throw InputError("the geometry has no extent", "all its points are one, or not finite");
  isFlat = bounds[5] - bounds[4] < 1e-9 * size;
  for (std::size_t axis = 0; axis < (isFlat ? 2U : 3U); ++axis)
  {
    const double least = std::max(0.02 * size, 0.1 * size - (bounds.at(2 * axis + 1) - bounds.at(2 * axis)));
    bounds.at(2 * axis) -= 0.5 * least;
    bounds.at(2 * axis + 1) += 0.5 * least;
  }
  return bounds;
}

} // namespace

vtkSmartPointer<vtkActor> GeometryActor(vtkPolyData* geometry, const std::optional<Quantity>& field, bool isFlat,
  const Color& color, double linePixels, double scale)
{
  const auto colored = Colored(geometry, field);
  vtkNew<vtkPolyDataMapper> mapper;
  const bool onlyLines =
    colored->GetNumberOfPolys() == 0 && colored->GetNumberOfStrips() == 0 && colored->GetNumberOfLines() > 0;
  if (onlyLines && !isFlat)
  {
    vtkNew<vtkTubeFilter> tubes;
    tubes->SetInputData(colored);
    tubes->SetRadius(0.5 * linePixels / scale);
    tubes->SetNumberOfSides(10);
    tubes->CappingOn();
    tubes->Update();
    mapper->SetInputData(tubes->GetOutput());
  }
  else
  {
    mapper->SetInputData(colored);
  }
  mapper->SetColorModeToDirectScalars();
  const auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  vtkProperty* property = actor->GetProperty();
  property->SetColor(color.r / 255.0, color.g / 255.0, color.b / 255.0);
  property->SetLineWidth(static_cast<float>(2 * linePixels)); // drawn at twice the size
  property->SetPointSize(static_cast<float>(4 * linePixels));
  property->SetRenderPointsAsSpheres(!isFlat);
  property->SetAmbient(0.35);
  property->SetDiffuse(0.65);
  property->SetLighting(!isFlat);
  return actor;
}

Drawing DrawGeometry(vtkPolyData* given, const SnapshotOptions& options)
{
  const bool grains = AreGrains(given);
  const vtkSmartPointer<vtkPolyData> geometry = grains ? GrainShapes(given) : vtkSmartPointer<vtkPolyData>(given);
  const bool forces = grains && options.overlayLines && options.overlayLines->GetNumberOfLines() > 0;
  const bool plain = forces && options.arrayName.empty() && options.preset == vtkSnapshot::AUTO;
  std::optional<Quantity> field;
  const bool hasArrays =
    geometry->GetPointData()->GetNumberOfArrays() > 0 || geometry->GetCellData()->GetNumberOfArrays() > 0;
  if (plain)
  {
    // forces are what the picture shows
  }
  else if (hasArrays || !options.arrayName.empty() || options.preset != vtkSnapshot::AUTO)
  {
    field = FindQuantity(geometry, { 0, 0, 0 }, options);
  }

  double size = 0;
  bool isFlat = false;
  const std::array<double, 6> bounds = RoomyBounds(geometry, size, isFlat);
  const View view(bounds, isFlat ? -90 : options.azimuth, isFlat ? 90 : options.elevation);

  Furniture furniture = field ? Describe(*field, options) : Furniture{ options.title, {}, {}, {} };
  if (forces && options.showLegend && LargestForce(options.overlayLines) > 0)
    furniture.legend.push_back(DescribeForces(options.overlayLines));
  const std::optional<Scale> scale = FindScale(geometry, 0);
  if (options.showScaleBar && isFlat)
    furniture.scale = scale;
  const Layout layout = ArrangeOrThrow(furniture, view.Width(), view.Height(), false, options);
  const Color background = BackgroundColor(options);
  const Color ink = InkOn(background);
  Drawing drawing{ Canvas(layout.width, layout.height, background), layout.data, {} };
  if (field)
    drawing.range = { field->low, field->high };

  const double linePixels = std::max(1.5, 0.11 * layout.font);
  const auto actor = GeometryActor(geometry, field, isFlat, plain ? GrainColor : PlainColor, linePixels, layout.scale);
  vtkNew<vtkRenderer> renderer;
  renderer->AddActor(actor);
  if (forces)
  {
    vtkProperty* const bars =
      AddPlain(renderer, ForceShapes(options.overlayLines, given), ForceColor, 1)->GetProperty();
    bars->SetLighting(!isFlat);
    actor->SetVisibility(isFlat ? 1 : 0); // spheres would hide the forces
  }
  if (grains && isFlat)
  {
    vtkNew<vtkPolyData> circles; // tell disks of one colour apart
    circles->SetPoints(geometry->GetPoints());
    circles->SetLines(geometry->GetLines());
    vtkActor* const edges = AddPlain(renderer, circles, EdgeColor, linePixels);
    edges->GetProperty()->SetLighting(false);
    edges->SetPosition(0, 0, 1e-5 * size); // in front of the disks
  }
  if (const auto box = grains ? BoxEdges(given) : nullptr)
    AddPlain(renderer, box, ink, linePixels)->GetProperty()->SetLighting(false);
  view.Aim(renderer);
  std::vector<std::uint8_t> pixels;
  std::string whyNot;
  if (!Draw(renderer, layout.data.width, layout.data.height, LargeTiles, true, pixels, whyNot))
    throw InputError(whyNot, "lines and surfaces need OpenGL");
  drawing.canvas.Blend(layout.data, pixels);
  if (options.showScaleBar && scale && !isFlat)
    view.DrawScaleBar(drawing.canvas, layout, *scale, ink);
  DrawFurniture(drawing.canvas, furniture, layout, ink, false);
  return drawing;
}

} // namespace lamella::rendering
