#include "GridChecks.h"

#include "GridParser.h"

#include "core/Error.h"
#include "core/Plausible.h"

#include "vtkCallbackCommand.h"
#include "vtkCell.h"
#include "vtkCellArray.h"
#include "vtkCellType.h"
#include "vtkDataArray.h"
#include "vtkErrorCode.h"
#include "vtkExecutive.h"
#include "vtkGenericCell.h"
#include "vtkNew.h"
#include "vtkPointSet.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"
#include "vtkXMLReader.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>

namespace lamella
{
namespace
{

[[noreturn]] void damaged(const std::string& path, const std::string& what)
{
  throw InputError("'" + path + "' is damaged: " + what, "make or copy it again");
}

/// The reader says nothing by itself meanwhile: what is wrong is said in our words. It must not become modified by
/// that, or it would parse its file anew.
class Silence
{
public:
  explicit Silence(vtkXMLReader* reader)
    : reader_(reader)
  {
    note_->SetClientData(&failed_);
    note_->SetCallback([](vtkObject*, unsigned long event, void* flag, void*)
      { *static_cast<bool*>(flag) = *static_cast<bool*>(flag) || event == vtkCommand::ErrorEvent; });
    for (vtkObject* const object : objects())
    {
      object->AddObserver(vtkCommand::ErrorEvent, note_);
      object->AddObserver(vtkCommand::WarningEvent, note_);
    }
  }
  ~Silence()
  {
    for (vtkObject* const object : objects())
      object->RemoveObserver(note_);
  }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;
  [[nodiscard]] bool failed() const { return failed_; }

private:
  [[nodiscard]] std::array<vtkObject*, 2> objects() const { return { reader_, reader_->GetExecutive() }; }

  vtkXMLReader* reader_;
  vtkNew<vtkCallbackCommand> note_;
  bool failed_ = false;
};

void requireSound(vtkCellArray* cells, vtkIdType points, const std::string& path)
{
  if (cells == nullptr || cells->GetNumberOfCells() == 0)
    return;
  if (!cells->IsValid())
    damaged(path, "its cells begin and end where there are none");
  std::array<double, 2> range{ 0, 0 };
  if (cells->GetNumberOfConnectivityIds() > 0)
  {
    cells->GetConnectivityArray()->GetRange(range.data());
    if (range[0] < 0 || range[1] >= static_cast<double>(points))
    {
      damaged(path,
        fmt::format(
          "a cell has point {:.0f}, and there are {} points, from 0", range[0] < 0 ? range[0] : range[1], points));
    }
  }
}

/// As many points in a cell as its type has; those of polygons and the like are not fixed.
void requireSoundTypes(vtkUnstructuredGrid* data, const std::string& path)
{
  std::map<int, vtkIdType> pointsOf;
  for (vtkIdType cell = 0; cell < data->GetNumberOfCells(); ++cell)
  {
    const int type = data->GetCellType(cell);
    const auto [known, isNew] = pointsOf.try_emplace(type, 0);
    if (isNew)
    {
      vtkNew<vtkGenericCell> shape;
      vtkCell* const made = vtkGenericCell::InstantiateCell(type);
      if (made == nullptr || type == VTK_POLYHEDRON || type > VTK_POLYHEDRON || type == VTK_CONVEX_POINT_SET)
      {
        if (made != nullptr)
          made->Delete();
        damaged(path, fmt::format("a cell is of type {}, which is not read", type));
      }
      known->second = made->GetNumberOfPoints();
      made->Delete();
    }
    const vtkIdType here = data->GetCellSize(cell);
    if (known->second > 0 && here != known->second)
      damaged(path, fmt::format("a cell of type {} has {} points instead of {}", type, here, known->second));
  }
}

} // namespace

void requireSound(vtkPointSet* data, const std::string& path)
{
  vtkDataArray* const places = data->GetPoints() != nullptr ? data->GetPoints()->GetData() : nullptr;
  const vtkIdType points = data->GetNumberOfPoints();
  for (vtkIdType point = 0; point < points; ++point)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      const double place = places->GetComponent(point, axis);
      if (!(std::abs(place) <= mostPlausible)) // metres, as of images
        damaged(path, fmt::format("its point {} is at {}", point, place));
    }
  }
  if (auto* const poly = vtkPolyData::SafeDownCast(data))
    for (vtkCellArray* const cells : { poly->GetVerts(), poly->GetLines(), poly->GetPolys(), poly->GetStrips() })
      requireSound(cells, points, path);
  if (auto* const grid = vtkUnstructuredGrid::SafeDownCast(data))
  {
    requireSound(grid->GetCells(), points, path);
    requireSoundTypes(grid, path);
  }
}

void requireReadable(vtkXMLReader* reader, const std::string& path)
{
  const Silence silence(reader);
  reader->UpdateInformation();
  auto* const parser = GridParser::SafeDownCast(reader->GetXMLParser());
  if (parser != nullptr && parser->Fault)
    std::rethrow_exception(parser->Fault);
  if (silence.failed() || parser == nullptr || reader->GetErrorCode() != vtkErrorCode::NoError)
    damaged(path, "VTK cannot read what it says of itself");
}

void update(vtkXMLReader* reader, const std::string& path, const std::optional<std::array<int, 6>>& extent)
{
  const Silence silence(reader);
  if (extent)
  {
    std::array<int, 6> part = *extent;
    static_cast<vtkAlgorithm*>(reader)->UpdateExtent(part.data()); // an image reader has a member of this name
  }
  else
  {
    reader->Update();
  }
  const auto* const parser = GridParser::SafeDownCast(reader->GetXMLParser());
  if (silence.failed() || parser == nullptr || parser->Failed || reader->GetErrorCode() != vtkErrorCode::NoError)
    damaged(path, "its data cannot be unpacked, or are not whole");
  if (auto* const set = vtkPointSet::SafeDownCast(reader->GetOutputDataObject(0)))
    requireSound(set, path);
}

} // namespace lamella
