#include "Drawing.h"

#include "core/Error.h"

#include "Arrays.h"
#include "Quantity.h"
#include "Surface.h"
#include "View.h"
#include "Voxels.h"
#include "vtkActor.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkRenderer.h"
#include "vtkSnapshot.h"

#include <algorithm>

namespace lamella::rendering
{
namespace
{

VoxelBlock Block(vtkImageData* image)
{
  VoxelBlock block;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    const int a = static_cast<int>(axis);
    block.size.at(axis) = image->GetDimensions()[a];
    block.spacing.at(axis) = image->GetSpacing()[a];
    block.corner.at(axis) = image->GetOrigin()[a] + (image->GetExtent()[2 * a] - 0.5) * image->GetSpacing()[a];
  }
  return block;
}

std::array<double, 6> Bounds(const VoxelBlock& block)
{
  std::array<double, 6> bounds{};
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    bounds.at(2 * axis) = block.corner.at(axis);
    bounds.at(2 * axis + 1) = block.corner.at(axis) + block.size.at(axis) * block.spacing.at(axis);
  }
  return bounds;
}

/// Everything but the octant nearest to the viewer.
void CutOctant(VoxelBlock& block, const Point3& towards)
{
  const auto isNear = [&](int place, std::size_t axis)
  { return towards.at(axis) > 0 ? 2 * place >= block.size.at(axis) : 2 * place + 1 < block.size.at(axis); };
  for (int k = 0; k < block.size[2]; ++k)
  {
    for (int j = 0; j < block.size[1]; ++j)
    {
      for (int i = 0; i < block.size[0]; ++i)
        if (isNear(i, 0) && isNear(j, 1) && isNear(k, 2))
          block.solid[block.Index(i, j, k)] = false;
    }
  }
}

/// The edges of the box and, where an octant is cut out, those of the cut; a little before the faces that meet there.
vtkSmartPointer<vtkActor> Edges(const VoxelBlock& block, const Point3& towards, bool isCut, Color ink)
{
  const std::array<double, 6> bounds = Bounds(block);
  // Along each axis: the far side, the plane of the cut, the near side.
  std::array<std::array<double, 3>, 3> planes{};
  double lift = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    const int n = block.size.at(axis);
    const bool isPositive = towards.at(axis) > 0;
    const int cut = isPositive ? (n + 1) / 2 : n / 2;
    planes.at(axis) = { bounds.at(2 * axis + (isPositive ? 0 : 1)),
      block.corner.at(axis) + cut * block.spacing.at(axis), bounds.at(2 * axis + (isPositive ? 1 : 0)) };
    lift = std::max(lift, block.spacing.at(axis));
  }
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> lines;
  const auto add = [&](std::size_t axis, std::size_t from, std::size_t to, std::size_t u, std::size_t v)
  {
    std::array<vtkIdType, 2> ids{};
    const std::array<std::size_t, 2> ends{ from, to };
    for (std::size_t k = 0; k < 2; ++k)
    {
      Point3 point{};
      point.at(axis) = planes.at(axis).at(ends.at(k));
      point.at((axis + 1) % 3) = planes.at((axis + 1) % 3).at(u);
      point.at((axis + 2) % 3) = planes.at((axis + 2) % 3).at(v);
      for (std::size_t c = 0; c < 3; ++c)
        point.at(c) += lift * towards.at(c);
      ids.at(k) = points->InsertNextPoint(point.data());
    }
    lines->InsertNextCell(2, ids.data());
  };
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    for (const std::size_t u : { 0, 2 })
      for (const std::size_t v : { 0, 2 })
        add(axis, 0, isCut && u == 2 && v == 2 ? 1 : 2, u, v);
    if (isCut)
    {
      add(axis, 1, 2, 1, 1);
      add(axis, 1, 2, 1, 2);
      add(axis, 1, 2, 2, 1);
    }
  }
  vtkNew<vtkPolyData> edges;
  edges->SetPoints(points);
  edges->SetLines(lines);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(edges);
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  actor->GetProperty()->LightingOff();
  actor->GetProperty()->SetColor(ink.r / 255.0, ink.g / 255.0, ink.b / 255.0);
  return actor;
}

/// Those whose value is in the range.
void KeepRange(VoxelBlock& block, const Quantity& field, const SnapshotOptions& options)
{
  if (!options.range)
    throw InputError("only voxels in the range are asked for, and no range", "give a range, as 0.3 to 1");
  std::transform(field.values.begin(), field.values.end(), block.solid.begin(),
    [&](float value) { return value >= field.low && value <= field.high; });
}

constexpr Color InsideColor{ 0x7b, 0x1e, 0x2b, 255 };

/// Lines, surfaces and points in a volume, and what colours them: the event, if they have one.
struct Inside
{
  vtkSmartPointer<vtkPolyData> geometry; ///< none where nothing has happened yet
  std::optional<Quantity> field;
  std::optional<ColorBar> bar;
};

/// The event of a cell, or of its first point.
double EventOf(vtkPolyData* geometry, vtkDataArray* events, bool onCells, vtkIdType cell)
{
  vtkIdType count = 0;
  const vtkIdType* points = nullptr;
  if (!onCells)
    geometry->GetCellPoints(cell, count, points);
  return onCells ? events->GetComponent(cell, 0) : count > 0 ? events->GetComponent(points[0], 0) : 0;
}

Inside FindInside(vtkPolyData* given, const SnapshotOptions& options)
{
  Inside inside{ given, {}, {} };
  vtkDataArray* const onCells = given->GetCellData()->GetArray("event");
  vtkDataArray* const events = onCells ? onCells : given->GetPointData()->GetArray("event");
  if (!events)
  {
    if (options.untilEvent > 0)
      throw InputError("what is to be drawn until an event has no array event",
        "give the cracks of crack-path or the broken bonds of fracture");
    return inside;
  }
  SnapshotOptions byEvent = options;
  byEvent.arrayName = "event";
  byEvent.preset = vtkSnapshot::SCALAR;
  if (!byEvent.range && options.untilEvent > 0) // one for all of a film
    byEvent.range = { 0, events->GetRange(0)[1] };
  if (options.untilEvent > 0)
  {
    inside.geometry = vtkSmartPointer<vtkPolyData>::New();
    inside.geometry->DeepCopy(given);
    inside.geometry->BuildCells();
    for (vtkIdType cell = 0; cell < given->GetNumberOfCells(); ++cell)
      if (EventOf(inside.geometry, events, onCells != nullptr, cell) > options.untilEvent)
        inside.geometry->DeleteCell(cell);
    inside.geometry->RemoveDeletedCells();
  }
  inside.bar = Describe(FindQuantity(given, { 0, 0, 0 }, byEvent), options).bar;
  if (inside.geometry->GetNumberOfCells() > 0)
    inside.field = FindQuantity(inside.geometry, { 0, 0, 0 }, byEvent);
  else
    inside.geometry = nullptr;
  return inside;
}

} // namespace

Drawing DrawVolume(vtkImageData* image, const SnapshotOptions& options)
{
  VoxelBlock block = Block(image);
  Quantity field = FindQuantity(image, block.size, options);
  if (options.onlyRange)
    field.hasUndefined = false; // is not drawn
  if (options.onlyRange && field.IsCategorical())
    throw InputError("only voxels in a range are asked for, of phases or grains, which have none",
      "draw an array of numbers, or leave the range out");
  if (options.untilEvent > 0 && !(field.IsCategorical() && options.overlayLines))
    throw InputError("an event to draw until is given, and nothing inside phases that is drawn by event",
      "give cracks or broken bonds as lines, and draw phases");
  const View view(Bounds(block), options.azimuth, options.elevation);

  VoxelLight light;
  if (field.IsCategorical())
  {
    // Solids stand in the light, from above and a little from the right.
    block.solid.resize(field.ids.size());
    std::transform(field.ids.begin(), field.ids.end(), block.solid.begin(),
      [&](std::int32_t id) { return id >= 0 && !field.idIsVoid[static_cast<std::size_t>(id)]; });
    light = { { 0.88, 0.76, 1.0 }, 1.0 };
  }
  else
  {
    // Colours are numbers here: shading is only a hint at the faces' directions.
    block.solid.assign(field.values.size(), true);
    if (options.onlyRange)
      KeepRange(block, field, options);
    else
      CutOctant(block, view.Towards());
    light = { { 0.95, 0.88, 1.0 }, 0.0 };
  }
  // nothing in the range is a picture, too: a film begins so
  const bool empty = std::find(block.solid.begin(), block.solid.end(), true) == block.solid.end();
  if (empty && field.IsCategorical())
    throw InputError("the volume has nothing but voids", "there is no solid phase to draw");

  Furniture furniture = Describe(field, options);
  if (field.IsCategorical())
    std::erase_if(furniture.legend, [&](const LegendEntry& entry) { return IsVoidName(entry.text); });
  Inside inside;
  if (field.IsCategorical() && options.overlayLines)
    inside = FindInside(options.overlayLines, options);
  if (inside.bar)
    furniture.bar = inside.bar;
  const Layout layout = ArrangeOrThrow(furniture, view.Width(), view.Height(), false, options);
  const Color background = BackgroundColor(options);
  const Color ink = InkOn(background);
  Drawing drawing{ Canvas(layout.width, layout.height, background), layout.data, field.LegendRange() };

  vtkNew<vtkPolyDataMapper> mapper;
  const bool translucent = field.IsCategorical() && options.opacity < 1;
  mapper->SetInputData(
    VoxelFaces(block, view.Towards(), translucent, light, [&](std::size_t index) { return field.ColorOf(index); }));
  mapper->SetColorModeToDirectScalars();
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->LightingOff();
  vtkNew<vtkRenderer> renderer;
  renderer->AddActor(actor);
  if (inside.geometry)
    renderer->AddActor(GeometryActor(
      inside.geometry, inside.field, false, InsideColor, std::max(1.5, 0.11 * layout.font), layout.scale));
  const auto edges = Edges(block, view.Towards(), !field.IsCategorical() && !options.onlyRange, ink);
  edges->GetProperty()->SetLineWidth(static_cast<float>(2 * layout.Rule())); // drawn at twice the size
  renderer->AddActor(edges);
  if (translucent)
  {
    actor->GetProperty()->SetOpacity(options.opacity);
    renderer->UseDepthPeelingOn();
    renderer->SetMaximumNumberOfPeels(12);
    renderer->SetOcclusionRatio(0.01);
  }
  view.Aim(renderer);
  std::vector<std::uint8_t> pixels;
  std::string whyNot;
  if (!Draw(renderer, layout.data.width, layout.data.height, LargeTiles, true, pixels, whyNot))
    throw InputError(whyNot, "volumes need OpenGL");
  drawing.canvas.Blend(layout.data, pixels);
  if (const auto scale = FindScale(image, block.spacing[0]); scale && options.showScaleBar)
    view.DrawScaleBar(drawing.canvas, layout, *scale, ink);
  DrawFurniture(drawing.canvas, furniture, layout, ink, false);
  return drawing;
}

} // namespace lamella::rendering
