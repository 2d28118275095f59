#include "convert/Surface.h"

#include "convert/Types.h"
#include "files/GridFile.h"
#include "session/Text.h"

#include "CellConversion.h"
#include "core/Error.h"
#include "core/Lower.h"
#include "core/Memory.h"
#include "vtkLatticeConversion.h"

#include <vtkCellData.h>
#include <vtkDiscreteFlyingEdges3D.h>
#include <vtkImageTransform.h>
#include <vtkMatrix4x4.h>
#include <vtkPLYWriter.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkReverseSense.h>
#include <vtkSTLWriter.h>
#include <vtkTriangleFilter.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkWindowedSincPolyDataFilter.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string_view>

namespace lamella::cli
{

namespace
{

/// The values that stand for phases. @throws ParameterError
std::vector<double> valuesOf(vtkImageData* sample, const std::vector<std::string>& phases)
{
  vtkDataArray* const array = onlyArray(sample);
  const PhaseTable table = phaseNames(sample);
  const bool named = table.size() > 0 && std::string(array->GetName()) == "phase";
  if (isReal(array->GetDataType()) || array->GetNumberOfComponents() != 1)
    throw InputError(fmt::format("'{}' holds no phases: they are whole numbers", array->GetName()),
      "choose another array with --array NAME");
  std::vector<double> values;
  for (const std::string& phase : phases)
  {
    const auto id = table.find(phase);
    const auto number = toInteger(phase);
    if (named && !id)
      throw ParameterError(fmt::format("--phase '{}': there is none of that name", phase),
        suggestion(phase, table.names(), "there are " + quotedList(table.names(), "and")));
    if (!named && !number)
      throw ParameterError(fmt::format("--phase '{}': the phases of this file have no names", phase),
        fmt::format("give the value of '{}' that stands for it, as --phase 1", array->GetName()));
    values.push_back(static_cast<double>(named ? *id : *number));
  }
  return values;
}

/// 1 in the phases and 0 outside, with a layer of 0 all around. Places are those of the indices.
vtkSmartPointer<vtkImageData> maskOf(Session& session, Volume& volume, const std::vector<double>& wanted)
{
  const auto& e = volume.extent();
  const std::array<int, 3> size{ e[1] - e[0] + 3, e[3] - e[2] + 3, e[5] - e[4] + 3 };
  const double bytes = static_cast<double>(size[0]) * size[1] * size[2];
  if (const auto free = static_cast<double>(availableMemory()); bytes > free)
    throw MemoryError(fmt::format("a surface takes more than {}, and {} are free", bytesText(bytes), bytesText(free)),
      "cut a part out of the volume first");
  auto mask = vtkSmartPointer<vtkImageData>::New();
  mask->SetDimensions(size.data());
  mask->SetOrigin(e[0] - 1, e[2] - 1, e[4] - 1);
  mask->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  vtkUnsignedCharArray::SafeDownCast(mask->GetPointData()->GetScalars())->FillValue(0);
  bool any = false;
  forSlabs(session, volume,
    [&](vtkDataArray* values, int first, int last)
    {
      vtkIdType node = 0;
      for (int z = first; z <= last; ++z)
      {
        for (int y = e[2]; y <= e[3]; ++y)
        {
          auto* to = static_cast<unsigned char*>(mask->GetScalarPointer(1, y - e[2] + 1, z - e[4] + 1));
          for (int x = e[0]; x <= e[1]; ++x)
            any |= (*to++ = std::ranges::count(wanted, values->GetComponent(node++, 0)) > 0 ? 1 : 0) == 1;
        }
      }
    });
  if (!any)
    throw InputError("no voxel is of these phases", "see what is in the file: lamella info FILE");
  return mask;
}

} // namespace

vtkSmartPointer<vtkPolyData> surfaceOf(
  Session& session, Volume& volume, const std::vector<std::string>& phases, int smoothing)
{
  const auto& e = volume.extent();
  if (e[0] == e[1] || e[2] == e[3] || e[4] == e[5])
    throw InputError("a surface goes round phases of a volume, and this is a picture",
      "give a stack or a volume; outlines in a picture: lamella micrograph FILE --contours FILE.vtp");
  vtkImageData* const sample = volume.sample();
  vtkNew<vtkDiscreteFlyingEdges3D> edges;
  edges->SetInputData(maskOf(session, volume, valuesOf(sample, phases)));
  edges->SetValue(0, 1);
  edges->ComputeScalarsOff();
  edges->ComputeNormalsOff();
  vtkNew<vtkWindowedSincPolyDataFilter> smoother;
  smoother->SetInputConnection(edges->GetOutputPort());
  smoother->SetNumberOfIterations(smoothing);
  vtkNew<vtkReverseSense> reverse; // axes that are a left hand turn triangles round
  vtkAlgorithm* last = edges;
  if (smoothing > 0)
    last = smoother;
  vtkMatrix4x4* const place = sample->GetIndexToPhysicalMatrix();
  if (place->Determinant() < 0)
  {
    reverse->SetInputConnection(last->GetOutputPort());
    last = reverse;
  }
  session.progress(0, "making the surface");
  last->Update();
  session.endProgress();
  Session::checkInterrupt();
  vtkSmartPointer<vtkPolyData> surface = vtkPolyData::SafeDownCast(last->GetOutputDataObject(0));
  surface->GetPointData()->Initialize();
  vtkImageTransform::TransformPoints(place, surface->GetPoints()->GetData());
  surface->GetPoints()->Modified();
  if (const std::string record = provenance(sample); !record.empty())
    setProvenance(surface, record);
  return surface;
}

bool onlySurface(vtkPointSet* points)
{
  const auto arrays = points->GetPointData()->GetNumberOfArrays() + points->GetCellData()->GetNumberOfArrays();
  for (vtkIdType cell = 0; cell < points->GetNumberOfCells(); ++cell)
    if (const int type = points->GetCellType(cell); type != VTK_TRIANGLE && type != VTK_QUAD && type != VTK_POLYGON)
      return false;
  return arrays == 0;
}

void writeSurface(vtkPointSet* points, const OutputFile& file)
{
  vtkSmartPointer<vtkPolyData> surface = vtkPolyData::SafeDownCast(points);
  if (auto* const grid = vtkUnstructuredGrid::SafeDownCast(points))
    surface = toPolyData(grid);
  vtkNew<vtkTriangleFilter> triangles;
  triangles->SetInputData(surface);
  triangles->PassVertsOff();
  triangles->PassLinesOff();
  triangles->Update();
  vtkPolyData* const plain = triangles->GetOutput();
  plain->GetPointData()->Initialize(); // normals and textures, which PLY would have
  plain->GetCellData()->Initialize();
  const auto count = static_cast<std::uintmax_t>(plain->GetNumberOfPolys());
  if (count == 0)
    throw InputError("there is no surface to write", "of an image, --phase NAME makes one");
  const char* const comment = "lengths in metres"; // not "solid": so STL in words begins
  (void)VtkMessages::takeErrors();
  const auto write = [&](auto* writer)
  {
    writer->SetInputData(plain);
    writer->SetFileTypeToBinary();
    writer->SetFileName(file.temporary().c_str());
    writer->Write();
  };
  std::uintmax_t bytes = 84 + 50 * count;
  if (endingOf(file.path()) == ".ply")
  {
    vtkNew<vtkPLYWriter> writer;
    writer->AddComment(comment);
    write(writer.Get());
    std::string head(1024, '\0');
    std::ifstream(file.temporary(), std::ios::binary).read(head.data(), static_cast<std::streamsize>(head.size()));
    const std::string_view end = "end_header\n";
    bytes = head.find(end) + end.size() + 12 * static_cast<std::uintmax_t>(plain->GetNumberOfPoints()) + 13 * count;
  }
  else
  {
    vtkNew<vtkSTLWriter> writer;
    writer->SetHeader(comment);
    write(writer.Get());
  }
  std::error_code ignored;
  if (std::filesystem::file_size(file.temporary(), ignored) != bytes) // neither tells of a full disk at all times
    file.failed();
}

} // namespace lamella::cli
