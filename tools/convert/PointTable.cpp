#include "convert/PointTable.h"

#include "convert/Notes.h"
#include "convert/RawFile.h"
#include "convert/Types.h"
#include "files/CsvField.h"
#include "session/Text.h"

#include "NewArray.h"
#include "TextTable.h"
#include "core/Error.h"
#include "core/Lower.h"
#include "lattice/AxisNames.h"
#include "vtkLatticeConversion.h"

#include <vtkCellData.h>
#include <vtkFieldData.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkUnstructuredGrid.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace lamella::cli
{

namespace
{

/// The array and the component that a column holds: "stress:3" → stress, 3.
struct Column
{
  std::string array;
  int component = 0;
  std::size_t number = 0; ///< of the column
};

Column columnOf(const std::string& name, std::size_t number)
{
  const std::size_t colon = name.rfind(':');
  const auto component = colon == std::string::npos ? std::nullopt : toInteger(name.substr(colon + 1));
  if (component && *component >= 0 && *component < 1000)
    return { name.substr(0, colon), static_cast<int>(*component), number };
  return { name, 0, number };
}

/// Columns of the coordinates; the third may be missing.
using Places = std::array<std::optional<std::size_t>, 3>;

bool isPlace(const Column& column, const std::string& name, Places& places)
{
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    if (lower(name) == axisNames[axis] || (column.array == "Points" && column.component == static_cast<int>(axis)))
    {
      places[axis] = places[axis].value_or(column.number);
      return true;
    }
  }
  return name == "Points_Magnitude" || name == "Point ID"; // ParaView adds them
}

/// The columns of each array, in the order of the table.
std::vector<std::pair<std::string, std::vector<Column>>> arraysIn(const TextTable& table, Places& places)
{
  std::vector<std::pair<std::string, std::vector<Column>>> arrays;
  for (std::size_t i = 0; i < table.names().size(); ++i)
  {
    const std::string& name = table.names()[i];
    const Column column = columnOf(name, i);
    if (isPlace(column, name, places))
      continue;
    const auto found = std::ranges::find(arrays, column.array, &std::pair<std::string, std::vector<Column>>::first);
    if (found == arrays.end())
      arrays.push_back({ column.array, { column } });
    else
      found->second.push_back(column);
  }
  return arrays;
}

vtkSmartPointer<vtkDataArray> readArray(
  const TextTable& table, const std::string& name, const std::vector<Column>& columns, const TableNotes& notes)
{
  const auto noted = std::ranges::find(notes.arrays, name, &TableNotes::Array::name);
  vtkSmartPointer<vtkDataArray> array;
  array.TakeReference(vtkDataArray::CreateDataArray(noted != notes.arrays.end() ? noted->type : VTK_DOUBLE));
  array->SetName(name.c_str());
  array->SetNumberOfComponents(static_cast<int>(columns.size()));
  array->SetNumberOfTuples(static_cast<vtkIdType>(table.rows()));
  for (const Column& column : columns)
  {
    const auto component = static_cast<int>(&column - columns.data());
    for (std::size_t row = 0; row < table.rows(); ++row)
      array->SetComponent(static_cast<vtkIdType>(row), component, table.number(row, column.number));
  }
  if (noted != notes.arrays.end() && !(noted->unit + noted->description + noted->creator).empty())
    describe(array, noted->unit, noted->description, noted->creator);
  return array;
}

} // namespace

Step openTable(const std::string& path, std::span<const std::string> arrays)
{
  const TextTable table(path, "begin with a line of names: x,y,z and those of the arrays");
  Places places;
  const auto columns = arraysIn(table, places);
  if (!places[0] || !places[1])
    table.lacks("x and y");
  auto points = vtkSmartPointer<vtkPolyData>::New();
  const TableNotes notes = tableNotes(notesBeside(path), points);
  vtkSmartPointer<vtkDataSet> grid = points;
  if (notes.image != nullptr)
  {
    if (notes.image->GetNumberOfPoints() != static_cast<vtkIdType>(table.rows()))
    {
      throw InputError(fmt::format("'{}' has {} rows, and its notes speak of an image of {} nodes", path, table.rows(),
                         notes.image->GetNumberOfPoints()),
        "a part is missing; without '" + path + ".json' the rows are read as points");
    }
    notes.image->GetFieldData()->ShallowCopy(points->GetFieldData());
    grid = notes.image;
  }
  else
  {
    vtkNew<vtkPoints> at;
    at->SetDataType(notes.points == VTK_FLOAT ? VTK_FLOAT : VTK_DOUBLE);
    at->SetNumberOfPoints(static_cast<vtkIdType>(table.rows()));
    for (std::size_t row = 0; row < table.rows(); ++row)
    {
      at->SetPoint(static_cast<vtkIdType>(row), table.number(row, *places[0]), table.number(row, *places[1]),
        places[2] ? table.number(row, *places[2]) : 0.0);
    }
    const vtkNew<vtkFieldData> fields;
    fields->ShallowCopy(points->GetFieldData());
    setVertices(points, at);
    points->GetFieldData()->ShallowCopy(fields);
  }
  for (const auto& [name, parts] : columns)
    if (arrays.empty() || std::ranges::find(arrays, name) != arrays.end())
      grid->GetPointData()->AddArray(readArray(table, name, parts, notes));
  return notes.image != nullptr ? Step{ .volume = wholeVolume(notes.image) } : Step{ .points = points };
}

vtkSmartPointer<vtkImageData> gridOf(vtkPointSet* points)
{
  const vtkIdType count = points->GetNumberOfPoints();
  std::array<double, 3> origin{};
  std::array<double, 3> spacing{ 1, 1, 1 };
  std::array<vtkIdType, 3> size{ 1, 1, 1 };
  const auto refuse = [](const std::string& what)
  {
    return InputError("the points are no nodes of an image: " + what,
      "write them as points (.vtp, .vtu, .hdf), or give every node of a grid of even spacing");
  };
  for (std::size_t axis = 0; axis < 3 && count > 0; ++axis)
  {
    std::vector<double> at;
    at.reserve(static_cast<std::size_t>(count));
    for (vtkIdType i = 0; i < count; ++i)
      at.push_back(points->GetPoint(i)[axis]);
    std::ranges::sort(at);
    const double length = at.back() - at.front();
    // The same place in two rows may differ by what rounding left.
    const double least = std::max(1e-9 * length, 1e-300);
    vtkIdType places = 1;
    for (std::size_t i = 1; i < at.size(); ++i)
      places += at[i] - at[i - 1] > least ? 1 : 0;
    size[axis] = places;
    origin[axis] = at.front();
    if (!std::isfinite(length))
      throw refuse("a coordinate is not finite");
    if (places > 1)
      spacing[axis] = length / static_cast<double>(places - 1);
  }
  if (size[2] == 1)
    spacing[2] = spacing[0];
  if (static_cast<double>(size[0]) * static_cast<double>(size[1]) * static_cast<double>(size[2]) !=
    static_cast<double>(count))
    throw refuse(fmt::format("{} points have {} × {} × {} places", count, size[0], size[1], size[2]));
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(static_cast<int>(size[0]), static_cast<int>(size[1]), static_cast<int>(size[2]));
  image->SetOrigin(origin.data());
  image->SetSpacing(spacing.data());
  std::vector<vtkIdType> order(static_cast<std::size_t>(count), -1); // node → point
  for (vtkIdType i = 0; i < count; ++i)
  {
    std::array<vtkIdType, 3> node{};
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      const double place = (points->GetPoint(i)[axis] - origin[axis]) / spacing[axis];
      node[axis] = std::llround(place);
      if (std::abs(place - static_cast<double>(node[axis])) > 1e-3)
        throw refuse(fmt::format("point {} lies between nodes along {}", i, "xyz"[axis]));
    }
    vtkIdType& there = order[static_cast<std::size_t>(node[0] + size[0] * (node[1] + size[1] * node[2]))];
    if (there >= 0)
      throw refuse(fmt::format("points {} and {} lie at the same node", there, i));
    there = i;
  }
  vtkPointData* const to = image->GetPointData();
  to->CopyAllOn();
  to->CopyAllocate(points->GetPointData(), count);
  for (vtkIdType node = 0; node < count; ++node)
    to->CopyData(points->GetPointData(), order[static_cast<std::size_t>(node)], node);
  image->GetFieldData()->ShallowCopy(points->GetFieldData());
  return image;
}

bool onlyPoints(vtkPointSet* points)
{
  const vtkIdType cells = points->GetNumberOfCells();
  if (points->GetCellData()->GetNumberOfArrays() > 0 || (cells != 0 && cells != points->GetNumberOfPoints()))
    return false;
  for (vtkIdType cell = 0; cell < cells; ++cell)
  {
    vtkIdType count = 0;
    const vtkIdType* ids = nullptr;
    if (auto* const poly = vtkPolyData::SafeDownCast(points))
    {
      if (poly->GetNumberOfVerts() != cells)
        return false;
      poly->GetVerts()->GetCellAtId(cell, count, ids);
    }
    else if (auto* const grid = vtkUnstructuredGrid::SafeDownCast(points))
    {
      if (grid->GetCellType(cell) != VTK_VERTEX)
        return false;
      grid->GetCells()->GetCellAtId(cell, count, ids);
    }
    if (count != 1 || ids[0] != cell)
      return false;
  }
  return true;
}

namespace
{

/// Lines of a table.
class Rows
{
public:
  Rows(vtkDataSet* grid, const OutputFile& file)
    : stream_(file)
  {
    std::string names = "x,y,z";
    vtkPointData* const data = grid->GetPointData();
    for (int i = 0; i < data->GetNumberOfArrays(); ++i)
    {
      vtkDataArray* const array = data->GetArray(i);
      if (array == nullptr)
      {
        throw InputError(fmt::format("the array '{}' holds texts", data->GetAbstractArray(i)->GetName()),
          "name the arrays to write with --array");
      }
      for (int component = 0; component < array->GetNumberOfComponents(); ++component)
      {
        const std::string name = array->GetName() == nullptr ? "" : array->GetName();
        const bool several = array->GetNumberOfComponents() != 1;
        names += fmt::format(",{}", csvField(several ? fmt::format("{}:{}", name, component) : name));
      }
    }
    stream_.write(names + "\n");
  }

  void write(vtkDataSet* grid)
  {
    vtkPointData* const data = grid->GetPointData();
    auto out = std::back_inserter(text_);
    for (vtkIdType i = 0; i < grid->GetNumberOfPoints(); ++i)
    {
      const double* const at = grid->GetPoint(i);
      fmt::format_to(out, "{},{},{}", at[0], at[1], at[2]);
      for (int k = 0; k < data->GetNumberOfArrays(); ++k)
      {
        vtkDataArray* const array = data->GetArray(k);
        for (int component = 0; component < array->GetNumberOfComponents(); ++component)
        {
          text_ += ',';
          this->number(array, i, component);
        }
      }
      text_ += '\n';
      if (text_.size() > std::size_t{ 1 } << 20)
      {
        stream_.write(text_);
        text_.clear();
      }
    }
  }

  void finish()
  {
    stream_.write(text_);
    stream_.finish();
  }

private:
  void number(vtkDataArray* array, vtkIdType tuple, int component)
  {
    const double value = array->GetComponent(tuple, component);
    auto out = std::back_inserter(text_);
    if (array->GetDataType() == VTK_DOUBLE)
    {
      fmt::format_to(out, "{}", value);
    }
    else if (array->GetDataType() == VTK_FLOAT)
    {
      fmt::format_to(out, "{:.9g}", value); // enough for every float, also by way of a double
    }
    else if (std::abs(value) > 9007199254740992.0)
    {
      throw InputError(
        fmt::format("'{}' holds {:.0f}, and a table keeps whole numbers up to 2^53", array->GetName(), value),
        "write it as .vti, .vtp, .vtu or .hdf");
    }
    else
    {
      fmt::format_to(out, "{}", static_cast<std::int64_t>(value));
    }
  }

  ByteStream stream_;
  std::string text_;
};

} // namespace

void writeTable(Session& session, Volume& volume, const OutputFile& file)
{
  Rows rows(volume.sample(), file);
  const auto& extent = volume.extent();
  const int thick = volume.slab();
  for (int first = extent[4]; first <= extent[5]; first += thick)
  {
    const int last = std::min(extent[5], first + thick - 1);
    rows.write(volume.read(first, last));
    session.progress(static_cast<double>(last - extent[4] + 1) / volume.layers(), "converting");
    Session::checkInterrupt();
  }
  session.endProgress();
  rows.finish();
}

void writeTable(Session& session, vtkPointSet* points, const OutputFile& file)
{
  session.progress(0, "writing");
  Rows rows(points, file);
  rows.write(points);
  rows.finish();
}

} // namespace lamella::cli
