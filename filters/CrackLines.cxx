#include "Columns.h"
#include "CrackColumns.h"

#include "vtkLatticeConversion.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkTypeInt64Array.h"
#include "vtkUnsignedCharArray.h"

#include <cmath>
#include <map>

namespace lamella
{
namespace
{

using cracks::CrackPath;
using cracks::CrackPaths;
using cracks::CrackPoint;

template <typename Array>
vtkSmartPointer<Array> arrayOf(const std::string& name, int components, const char* unit, const char* description)
{
  const auto array = vtkSmartPointer<Array>::New();
  array->SetName(name.c_str());
  array->SetNumberOfComponents(components);
  describe(array, unit, description, crackCreator);
  return array;
}

/// Points of all paths; ends that coincide are one.
class PointWriter
{
public:
  explicit PointWriter(const CrackScale& scale)
    : scale_(scale)
  {
    points_->SetDataTypeToDouble();
  }

  void add(const CrackPath& path, vtkCellArray* lines)
  {
    std::vector<vtkIdType> ids;
    double along = 0;
    for (std::size_t i = 0; i < path.points.size(); ++i)
    {
      const CrackPoint& p = path.points[i];
      if (i > 0)
      {
        const cracks::Place& before = path.points[i - 1].place;
        along += std::hypot(p.place[0] - before[0], p.place[1] - before[1]);
      }
      const bool end = i == 0 || i + 1 == path.points.size();
      if (const auto known = ends_.find(p.place); end && known != ends_.end())
      {
        ids.push_back(known->second);
        continue;
      }
      ids.push_back(points_->InsertNextPoint(placed(scale_, p).data()));
      if (end)
        ends_[p.place] = ids.back();
      event_->InsertNextValue(p.event);
      when_->InsertNextValue(p.when);
      phases_->InsertNextTuple2(p.phases[0], p.phases[1]);
      between_->InsertNextValue(p.betweenGrains ? 1 : 0);
      along_->InsertNextValue(scale_.metres(along));
      opening_->InsertNextValue(p.opening);
      sliding_->InsertNextValue(p.sliding);
    }
    lines->InsertNextCell(static_cast<vtkIdType>(ids.size()), ids.data());
  }

  void write(vtkPolyData* output) const
  {
    output->SetPoints(points_);
    vtkPointData* const data = output->GetPointData();
    data->AddArray(event_);
    if (scale_.input.when != "event")
      data->AddArray(when_);
    if (!scale_.phases.empty())
    {
      data->AddArray(phases_);
      data->AddArray(between_);
    }
    data->AddArray(along_);
    if (scale_.opening)
    {
      data->AddArray(opening_);
      data->AddArray(sliding_);
    }
  }

private:
  const CrackScale& scale_;
  std::map<cracks::Place, vtkIdType> ends_;
  vtkNew<vtkPoints> points_;
  vtkSmartPointer<vtkTypeInt64Array> event_ =
    arrayOf<vtkTypeInt64Array>("event", 1, "1", "at which half of the bonds there were broken");
  vtkSmartPointer<vtkDoubleArray> when_ = arrayOf<vtkDoubleArray>(
    scale_.input.when, 1, unitOf(scale_.input.when), "at which half of the bonds there were broken");
  vtkSmartPointer<vtkUnsignedCharArray> phases_ =
    arrayOf<vtkUnsignedCharArray>("phases", 2, "1", "of the two nodes that the crack parts, the lesser first");
  vtkSmartPointer<vtkUnsignedCharArray> between_ =
    arrayOf<vtkUnsignedCharArray>("between_grains", 1, "1", "1: these lie in two different grains");
  vtkSmartPointer<vtkDoubleArray> along_ = arrayOf<vtkDoubleArray>("arc_length", 1, "m", "from the path's first point");
  vtkSmartPointer<vtkDoubleArray> opening_ =
    arrayOf<vtkDoubleArray>("opening", 1, "m", "how far the two nodes went apart, across the path");
  vtkSmartPointer<vtkDoubleArray> sliding_ = arrayOf<vtkDoubleArray>("sliding", 1, "m", "the same along the path");
};

} // namespace

void fillCrackPaths(vtkPolyData* output, const CrackPaths& paths, const CrackScale& scale)
{
  PointWriter writer(scale);
  vtkNew<vtkCellArray> lines;
  for (const CrackPath& path : paths.paths)
    writer.add(path, lines);
  writer.write(output);
  output->SetLines(lines);
  const Columns columns{ output->GetCellData(), paths.paths, crackCreator };
  columns.add<vtkIntArray>("path", "1", "number of the path; 1 is the longest", [](std::size_t i) { return i + 1; });
  for (const PathColumn& column : pathColumns(paths, scale))
    if (column.whole)
      columns.add<vtkTypeInt64Array>(column.name, column.unit, column.description, column.value);
    else
      columns.numbers(column.name, column.unit, column.description, column.value);
}

} // namespace lamella
