#include "Columns.h"
#include "CrackColumns.h"

#include "vtkLatticeConversion.h"

#include "cracks/SurfaceSmoothing.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkPolyDataNormals.h"
#include "vtkTable.h"
#include "vtkTypeInt64Array.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

namespace lamella
{
namespace
{

using cracks::CrackFace;
using cracks::CrackSurface;
using Point = std::array<double, 3>;

vtkSmartPointer<vtkPoints> smoothed(const CrackSurface& surface)
{
  const auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetDataTypeToDouble();
  for (const Point& p : cracks::smoothSurface(surface))
    points->InsertNextPoint(p.data());
  return points;
}

Point pointAt(vtkPoints* points, std::int64_t id)
{
  Point p{};
  points->GetPoint(id, p.data());
  return p;
}

double areaOf(const Point& a, const Point& b, const Point& c)
{
  Point u{};
  Point v{};
  Point n{};
  for (std::size_t k = 0; k < 3; ++k)
  {
    u[k] = b[k] - a[k];
    v[k] = c[k] - a[k];
  }
  vtkMath::Cross(u.data(), v.data(), n.data());
  return 0.5 * vtkMath::Norm(n.data());
}

struct Triangle
{
  std::array<vtkIdType, 3> corners{};
  std::size_t face = 0;
  double area = 0; ///< [spacings²]
};

/// Two a face, along its shorter diagonal.
std::vector<Triangle> trianglesOf(const CrackSurface& surface, vtkPoints* points)
{
  std::vector<Triangle> triangles;
  triangles.reserve(2 * surface.faces.size());
  for (std::size_t f = 0; f < surface.faces.size(); ++f)
  {
    const auto& corners = surface.faces[f].corners;
    std::array<Point, 4> p;
    for (std::size_t k = 0; k < 4; ++k)
      p[k] = pointAt(points, corners[k]);
    const bool other = vtkMath::Distance2BetweenPoints(p[1].data(), p[3].data()) <
      vtkMath::Distance2BetweenPoints(p[0].data(), p[2].data());
    const std::size_t from = other ? 1 : 0;
    for (const std::size_t second : { from + 1, from + 2 })
    {
      const std::size_t third = (second + 1) % 4;
      triangles.push_back(
        { { corners[from], corners[second % 4], corners[third] }, f, areaOf(p[from], p[second % 4], p[third]) });
    }
  }
  return triangles;
}

/// What a crack's triangles come to.
struct CrackSum
{
  double area = 0;      ///< [spacings²]
  Point normal{};       ///< axial mean: of the largest part of the mean of n ⊗ n
  double alignment = 0; ///< that part: 1 of a plane, 1/3 where all directions are alike
  std::array<std::int64_t, 2> events{};
  std::array<double, 2> when{};
  std::array<Point, 2> extent{}; ///< [m]
  std::map<std::tuple<std::uint8_t, std::uint8_t, bool>, double> pairs;
  std::array<std::array<double, 3>, 3> tensor{};
};

void finish(CrackSum& crack)
{
  double rows[3][3];
  double* a[3] = { rows[0], rows[1], rows[2] };
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      rows[i][j] = crack.area > 0 ? crack.tensor[i][j] / crack.area : 0;
  double vectors[3][3];
  double* v[3] = { vectors[0], vectors[1], vectors[2] };
  double values[3];
  vtkMath::Jacobi(a, values, v); // the largest first
  crack.alignment = values[0];
  std::size_t most = 0;
  for (std::size_t k = 0; k < 3; ++k)
  {
    crack.normal[k] = vectors[k][0];
    if (std::abs(crack.normal[k]) > std::abs(crack.normal[most]) + 1e-9)
      most = k;
  }
  if (crack.normal[most] < 0)
    for (double& n : crack.normal)
      n = -n;
}

std::vector<CrackSum> sumsOf(
  const CrackSurface& surface, const std::vector<Triangle>& triangles, vtkPolyData* output, vtkDataArray* normals)
{
  std::vector<CrackSum> sums(surface.cracks);
  std::vector<bool> begun(surface.cracks);
  for (std::size_t t = 0; t < triangles.size(); ++t)
  {
    const CrackFace& face = surface.faces[triangles[t].face];
    CrackSum& crack = sums[face.crack];
    if (!begun[face.crack])
    {
      begun[face.crack] = true;
      crack.events = { face.event, face.event };
      crack.when = { face.when, face.when };
      crack.extent[0].fill(1e300);
      crack.extent[1].fill(-1e300);
    }
    crack.area += triangles[t].area;
    crack.events = { std::min(crack.events[0], face.event), std::max(crack.events[1], face.event) };
    crack.when = { std::min(crack.when[0], face.when), std::max(crack.when[1], face.when) };
    crack.pairs[{ face.phases[0], face.phases[1], face.betweenGrains }] += triangles[t].area;
    Point n{};
    normals->GetTuple(static_cast<vtkIdType>(t), n.data());
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        crack.tensor[i][j] += triangles[t].area * n[i] * n[j];
    for (const vtkIdType id : triangles[t].corners)
    {
      const Point p = pointAt(output->GetPoints(), id);
      for (std::size_t k = 0; k < 3; ++k)
      {
        crack.extent[0][k] = std::min(crack.extent[0][k], p[k]);
        crack.extent[1][k] = std::max(crack.extent[1][k], p[k]);
      }
    }
  }
  for (CrackSum& crack : sums)
    finish(crack);
  return sums;
}

void fillCrackTable(vtkTable* table, const std::vector<CrackSum>& sums, const CrackScale& scale,
  const std::vector<cracks::PairShare>& pairs)
{
  const double square = scale.input.lattice.spacing * scale.input.lattice.spacing;
  const Columns columns{ table->GetRowData(), sums, crackCreator };
  columns.counts(
    "crack", "number of the crack; 1 has most faces of voxels", [](std::size_t i) { return i + 1; });
  columns.numbers("area", "m^2", "of its surface, one side", [&](const CrackSum& c) { return square * c.area; });
  for (std::size_t k = 0; k < 3; ++k)
    columns.numbers(std::string("normal_") + "xyz"[k], "1", "axial mean of its normals, weighted by area",
      [k](const CrackSum& c) { return c.normal[k]; });
  columns.numbers(
    "alignment", "1", "mean of the square of the normals' part along that: 1 of a plane", &CrackSum::alignment);
  columns.counts(
    "first_event", "of its bonds", [](const CrackSum& c) { return c.events[0]; });
  columns.counts("last_event", "of its bonds", [](const CrackSum& c) { return c.events[1]; });
  if (scale.input.when != "event")
    for (const std::size_t last : { 0, 1 })
      columns.numbers((last == 0 ? "first_" : "last_") + scale.input.when, unitOf(scale.input.when), "of its bonds",
        [last](const CrackSum& c) { return c.when[last]; });
  for (std::size_t k = 0; k < 3; ++k)
    for (const std::size_t high : { 0, 1 })
      columns.numbers(std::string(1, "xyz"[k]) + (high != 0 ? "_max" : "_min"), "m", "extent",
        [k, high](const CrackSum& c) { return c.extent[high][k]; });
  if (scale.phases.empty())
    return;
  for (const cracks::PairShare& p : pairs)
    columns.numbers("share_" + scale.pair(p), "1", "share of the area between nodes of these phases",
      [&](const CrackSum& c)
      {
        const auto found = c.pairs.find({ p.phases[0], p.phases[1], p.betweenGrains });
        return found == c.pairs.end() || !(c.area > 0) ? 0 : found->second / c.area;
      });
}

void fillAreaGrowth(
  vtkTable* table, const CrackSurface& surface, const std::vector<Triangle>& triangles, const CrackScale& scale)
{
  struct Row
  {
    std::int64_t event = 0;
    double when = 0;
    double area = 0;
    double main = 0;
  };
  std::map<std::int64_t, Row> byEvent;
  for (const Triangle& t : triangles)
  {
    const CrackFace& face = surface.faces[t.face];
    Row& row = byEvent[face.event];
    row.event = face.event;
    row.when = face.when;
    row.area += t.area;
    row.main += face.crack == 0 ? t.area : 0;
  }
  std::vector<Row> rows;
  for (const auto& [event, row] : byEvent)
  {
    rows.push_back(row);
    if (rows.size() > 1)
    {
      rows.back().area += rows[rows.size() - 2].area;
      rows.back().main += rows[rows.size() - 2].main;
    }
  }
  const double square = scale.input.lattice.spacing * scale.input.lattice.spacing;
  const Columns columns{ table->GetRowData(), rows, crackCreator };
  columns.counts("event", "at which a surface grew", &Row::event);
  if (scale.input.when != "event")
    columns.numbers(scale.input.when, unitOf(scale.input.when), "of the event", &Row::when);
  columns.numbers(
    "area", "m^2", "of all surfaces after it", [&](const Row& r) { return square * r.area; });
  columns.numbers("main_area", "m^2", "of crack 1 after it", [&](const Row& r) { return square * r.main; });
}

} // namespace

CrackAreas fillCrackSurfaces(
  vtkPolyData* output, vtkTable* table, vtkTable* growth, const CrackSurface& surface, const CrackScale& scale)
{
  const Lattice& lattice = scale.input.lattice;
  const vtkSmartPointer<vtkPoints> inNodes = smoothed(surface);
  const std::vector<Triangle> triangles = trianglesOf(surface, inNodes);
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (vtkIdType i = 0; i < inNodes->GetNumberOfPoints(); ++i)
  {
    Point p = pointAt(inNodes, i);
    for (std::size_t k = 0; k < 3; ++k)
      p[k] = lattice.origin[k] + lattice.spacing * p[k];
    points->InsertNextPoint(p.data());
  }
  vtkNew<vtkPolyData> mesh;
  mesh->SetPoints(points);
  vtkNew<vtkCellArray> cells;
  for (const Triangle& t : triangles)
    cells->InsertNextCell(3, t.corners.data());
  mesh->SetPolys(cells);
  vtkNew<vtkPolyDataNormals> normals; // neighbours turned alike
  normals->SetInputData(mesh);
  normals->ComputePointNormalsOff();
  normals->ComputeCellNormalsOn();
  normals->SplittingOff();
  normals->ConsistencyOn();
  normals->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
  normals->Update();
  output->ShallowCopy(normals->GetOutput());
  vtkDataArray* const direction = output->GetCellData()->GetNormals();

  CrackAreas areas;
  std::map<std::tuple<std::uint8_t, std::uint8_t, bool>, double> pairs;
  for (const Triangle& t : triangles)
  {
    const CrackFace& face = surface.faces[t.face];
    pairs[{ face.phases[0], face.phases[1], face.betweenGrains }] += t.area;
    areas.all += t.area;
    areas.main += face.crack == 0 ? t.area : 0;
  }
  for (const auto& [key, area] : pairs)
  {
    cracks::PairShare share;
    share.phases = { std::get<0>(key), std::get<1>(key) };
    share.betweenGrains = std::get<2>(key);
    share.length = area;
    areas.pairs.push_back(share);
  }
  if (triangles.empty())
  {
    output->Initialize();
    fillCrackTable(table, {}, scale, {});
    fillAreaGrowth(growth, surface, triangles, scale);
    return areas;
  }
  direction->SetName("normal");
  describe(direction, "1", "of the triangle; of one crack those of neighbours point alike", crackCreator);
  const std::vector<CrackSum> sums = sumsOf(surface, triangles, output, direction);
  const double square = lattice.spacing * lattice.spacing;
  const auto face = [&](const Triangle& t) -> const CrackFace& { return surface.faces[t.face]; };
  const Columns columns{ output->GetCellData(), triangles, crackCreator };
  columns.counts(
    "crack", "number of the crack; 1 has most faces of voxels", [&](const Triangle& t) { return face(t).crack + 1; });
  columns.numbers(
    "area", "m^2", "of the triangle", [&](const Triangle& t) { return square * t.area; });
  columns.template add<vtkTypeInt64Array>(
    "event", "1", "at which half of the bonds there were broken", [&](const Triangle& t) { return face(t).event; });
  if (scale.input.when != "event")
    columns.numbers(scale.input.when, unitOf(scale.input.when), "at which half of the bonds there were broken",
      [&](const Triangle& t) { return face(t).when; });
  if (!scale.phases.empty())
  {
    const auto both = vtkSmartPointer<vtkUnsignedCharArray>::New();
    both->SetName("phases");
    both->SetNumberOfComponents(2);
    for (const Triangle& t : triangles)
      both->InsertNextTuple2(face(t).phases[0], face(t).phases[1]);
    describe(both, "1", "of the two nodes that the crack parts, the lesser first", crackCreator);
    output->GetCellData()->AddArray(both);
    columns.template add<vtkUnsignedCharArray>("between_grains", "1", "1: these lie in two different grains",
      [&](const Triangle& t) { return face(t).betweenGrains ? 1 : 0; });
  }
  fillCrackTable(table, sums, scale, areas.pairs);
  fillAreaGrowth(growth, surface, triangles, scale);
  return areas;
}

} // namespace lamella
