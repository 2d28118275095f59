#include "ContourData.h"

#include "Columns.h"
#include "FieldNumbers.h"

#include "core/Error.h"
#include "outlines/ContourCheck.h"
#include "outlines/ContourMeasures.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkIdList.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPolyData.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

namespace lamella
{
namespace
{

constexpr const char* makeOutlines = "give the outlines of vtkMicrographContours or vtkMicrographPolygonReader";

/// Twice the area inside, positive if counter-clockwise; from the first point, so that far from the origin no digits
/// are lost.
double turned(const std::vector<micrograph::Point>& points)
{
  double sum = 0;
  for (std::size_t i = 2; i < points.size(); ++i)
  {
    const double ax = points[i - 1][0] - points[0][0];
    const double ay = points[i - 1][1] - points[0][1];
    sum += ax * (points[i][1] - points[0][1]) - ay * (points[i][0] - points[0][0]);
  }
  return sum;
}

/// Lumen by lumen, since outlines of cells may touch and cross each other.
std::map<std::int32_t, micrograph::LumenMeasures> measure(const micrograph::ContourSet& contours)
{
  std::map<std::int32_t, micrograph::ContourSet> lumens;
  for (const micrograph::Contour& contour : contours.contours)
  {
    lumens.try_emplace(contour.lumen, micrograph::ContourSet{ contours.size, {} })
      .first->second.contours.push_back(contour);
  }
  std::map<std::int32_t, micrograph::LumenMeasures> measures;
  for (const auto& [number, lumen] : lumens)
  {
    const std::vector<micrograph::LumenMeasures> found = micrograph::measureLumens(lumen);
    if (found.size() != 1)
    {
      throw InputError(
        "the chains of lumen " + std::to_string(number) + " outline " + std::to_string(found.size()) + " lumens",
        "give each lumen a number of its own");
    }
    measures.emplace(number, found.front());
  }
  return measures;
}

/// Lumens' numbers of the cells, or null where there are none.
vtkDataArray* lumenNumbers(vtkPolyData* outlines)
{
  vtkDataArray* const numbers = outlines->GetCellData()->GetArray("lumen");
  if (numbers == nullptr)
    return nullptr;
  if (numbers->GetNumberOfComponents() != 1 || numbers->GetNumberOfTuples() < outlines->GetNumberOfCells())
  {
    throw InputError("the cell array 'lumen' has " + std::to_string(numbers->GetNumberOfComponents()) +
        " components and " + std::to_string(numbers->GetNumberOfTuples()) + " values for " +
        std::to_string(outlines->GetNumberOfCells()) + " chains",
      "give one number a chain, or leave the array out");
  }
  for (vtkIdType i = 0; i < outlines->GetNumberOfCells(); ++i)
  {
    const double value = numbers->GetTuple1(i);
    if (!(value >= 1 && value <= std::numeric_limits<std::int32_t>::max() && value == std::floor(value)))
    {
      throw InputError("the lumen of chain " + std::to_string(i + 1) + " is " + std::to_string(value),
        "lumens are numbered from 1, in whole numbers");
    }
  }
  return numbers;
}

/// Two numbers of field data, or none; @throws InputError for another count
std::vector<double> sizeOf(vtkPolyData* outlines)
{
  std::vector<double> size = fieldNumbers(outlines, "size");
  if (!size.empty() && size.size() != 2)
  {
    throw InputError("the field data 'size' has " + std::to_string(size.size()) + " numbers",
      "it is the picture's width and height in metres");
  }
  return size;
}

} // namespace

vtkSmartPointer<vtkPolyData> toPolyData(
  const micrograph::ContourSet& contours, const std::string& creator, const std::array<double, 3>& corner)
{
  using micrograph::Contour;
  const std::map<std::int32_t, micrograph::LumenMeasures> measures = measure(contours);

  std::size_t count = 0;
  for (const Contour& contour : contours.contours)
    count += contour.points.size();
  const auto points = newPoints(count);
  vtkNew<vtkCellArray> lines;
  vtkIdType next = 0;
  for (const Contour& contour : contours.contours)
  {
    const vtkIdType first = next;
    lines->InsertNextCell(static_cast<int>(contour.points.size() + (contour.closed ? 1 : 0)));
    for (const micrograph::Point& p : contour.points)
    {
      points->SetPoint(next, corner[0] + p[0], corner[1] + p[1], corner[2]);
      lines->InsertCellPoint(next++);
    }
    if (contour.closed)
      lines->InsertCellPoint(first);
  }
  auto outlines = vtkSmartPointer<vtkPolyData>::New();
  outlines->SetPoints(points);
  outlines->SetLines(lines);
  const Columns columns{ outlines->GetCellData(), contours.contours, creator };
  columns.add<vtkIntArray>("lumen", "1", "number of the lumen, from 1; chains of one lumen share it", &Contour::lumen);
  outlines->GetCellData()->SetActiveScalars("lumen");
  columns.add<vtkUnsignedCharArray>("closed", "1", "1: closed; 0: ends on the picture's border", &Contour::closed);
  const auto measured = [&](const char* name, const char* unit, const char* text, double micrograph::LumenMeasures::*of)
  { columns.numbers(name, unit, text, [&](const Contour& c) { return measures.at(c.lumen).*of; }); };
  measured("area", "m^2", "of the whole lumen", &micrograph::LumenMeasures::area);
  measured(
    "solidity", "1", "area of the whole lumen over that of its convex hull", &micrograph::LumenMeasures::solidity);
  measured("equivalent_diameter", "m", "of the circle as large as the whole lumen",
    &micrograph::LumenMeasures::equivalentDiameter);
  double wall = 1;
  for (const auto& [lumen, m] : measures)
    wall -= m.area / (contours.size[0] * contours.size[1]);
  setFieldNumbers(outlines, "size", contours.size, "m", "width and height of the picture", creator);
  setFieldNumbers(outlines, "corner", corner, "m", "where the picture's lower left corner lies", creator);
  setFieldNumber(outlines, "wall_fraction", wall, "1", "share of the picture that no outline encloses", creator);
  return outlines;
}

std::array<double, 3> cornerOf(vtkPolyData* outlines)
{
  std::array<double, 3> corner{};
  const std::vector<double> given = fieldNumbers(outlines, "corner");
  if (given.size() == 3)
  {
    std::copy(given.begin(), given.end(), corner.begin());
  }
  else if (sizeOf(outlines).empty() && outlines->GetNumberOfPoints() > 0)
  {
    std::array<double, 6> bounds{};
    outlines->GetBounds(bounds.data());
    corner = { bounds[0], bounds[2], bounds[4] };
  }
  return corner;
}

micrograph::ContourSet contoursFrom(vtkPolyData* outlines)
{
  if (outlines->GetNumberOfLines() + outlines->GetNumberOfPolys() == 0)
    throw InputError("there are no outlines: the poly data has no lines", makeOutlines);
  if (outlines->GetNumberOfVerts() + outlines->GetNumberOfStrips() > 0)
  {
    throw InputError("the poly data has " + std::to_string(outlines->GetNumberOfVerts()) + " vertices and " +
        std::to_string(outlines->GetNumberOfStrips()) + " strips beside its lines",
      makeOutlines);
  }
  vtkDataArray* const numbers = lumenNumbers(outlines);
  const std::array<double, 3> corner = cornerOf(outlines);
  const std::vector<double> size = sizeOf(outlines);

  micrograph::ContourSet set;
  if (size.empty())
  {
    std::array<double, 6> bounds{};
    outlines->GetBounds(bounds.data());
    set.size = { bounds[1] - bounds[0], bounds[3] - bounds[2] };
  }
  else
  {
    set.size = { size[0], size[1] };
  }
  if (!(std::isfinite(set.size[0]) && std::isfinite(set.size[1]) && set.size[0] > 0 && set.size[1] > 0))
  {
    throw InputError("the picture is " + std::to_string(set.size[0]) + " by " + std::to_string(set.size[1]) + " m",
      "its width and height have to be positive");
  }

  vtkNew<vtkIdList> ids;
  for (vtkIdType cell = 0; cell < outlines->GetNumberOfCells(); ++cell)
  {
    outlines->GetCellPoints(cell, ids);
    micrograph::Contour contour;
    contour.closed = cell >= outlines->GetNumberOfLines(); // cells of poly data: lines, then polygons
    contour.lumen = static_cast<std::int32_t>(numbers != nullptr ? numbers->GetTuple1(cell) : cell + 1.0);
    for (vtkIdType i = 0; i < ids->GetNumberOfIds(); ++i)
    {
      std::array<double, 3> p{};
      outlines->GetPoint(ids->GetId(i), p.data());
      if (std::abs(p[2] - corner[2]) > 1e-6 * std::max(set.size[0], set.size[1]))
      {
        throw InputError("point " + std::to_string(ids->GetId(i)) + " lies at z = " + std::to_string(p[2]) +
            " m, others at " + std::to_string(corner[2]) + " m",
          "outlines lie in one plane across z");
      }
      contour.points.push_back({ p[0] - corner[0], p[1] - corner[1] });
    }
    if (contour.points.size() > 1 && contour.points.front() == contour.points.back())
    {
      contour.closed = true;
      contour.points.pop_back();
    }
    if (contour.closed && turned(contour.points) < 0)
      std::reverse(contour.points.begin(), contour.points.end());
    set.contours.push_back(std::move(contour));
  }
  micrograph::requireValid(set, "the poly data");
  return set;
}

} // namespace lamella
