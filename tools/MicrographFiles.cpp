#include "MicrographFiles.h"

#include "GridFile.h"
#include "SampleFile.h"
#include "Text.h"

#include "ContourData.h"
#include "lattice/Error.h"
#include "micrograph/PolygonFile.h"
#include "vtkLatticeConversion.h"

#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkIntArray.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>

#include <algorithm>
#include <filesystem>

namespace lamella::cli
{

namespace
{

constexpr const char* creator = "lamella micrograph";

std::string endingOf(const std::string& path)
{
  const std::filesystem::path name(path);
  const std::string last = name.extension().string();
  return last == ".gz" ? name.stem().extension().string() + last : last;
}

} // namespace

Outputs::Outputs(const MicrographCommandOptions& o)
{
  if (!o.output.empty())
  {
    checkSampleEnding(o.output, 2);
  }
  if (!o.contours.empty())
  {
    const std::vector<std::string> known{ ".vtp", ".json", ".json.gz" };
    if (std::find(known.begin(), known.end(), endingOf(o.contours)) == known.end())
    {
      throw ParameterError("--contours '" + o.contours + "' has no ending that can be written",
        suggestion(endingOf(o.contours), known, "end it in .vtp, .json or .json.gz"));
    }
  }
  if (!o.overlay.empty() && endingOf(o.overlay) != ".png")
  {
    throw ParameterError("--overlay '" + o.overlay + "' has no ending that can be written", "end it in .png");
  }
  std::vector<std::string> names;
  for (const std::string& name : { o.output, o.contours, o.overlay })
  {
    if (!name.empty() && std::find(names.begin(), names.end(), name) != names.end())
    {
      throw ParameterError("'" + name + "' is to be written twice", "give every output a name of its own");
    }
    names.push_back(name);
  }
  const auto open = [&](std::optional<OutputFile>& file, const std::string& name)
  {
    if (!name.empty())
    {
      file.emplace(name, o.common.overwrite);
    }
  };
  open(lattice, o.output);
  if (lattice && lattice->path().extension() == ".raw")
  {
    beside.emplace(recordBeside(lattice->path()), o.common.overwrite);
  }
  open(contours, o.contours);
  open(overlay, o.overlay);
}

void Outputs::commit()
{
  for (auto* const file : { &lattice, &beside, &contours, &overlay })
  {
    if (*file)
    {
      (*file)->commit();
    }
  }
}

void writeLattice(const OnLattice& made, const Micrograph& source, Outputs& outputs, const io::Provenance& record)
{
  if (outputs.lattice->path().extension() != ".vti")
  {
    writeLabels(made.phases, *outputs.lattice, outputs.beside ? &*outputs.beside : nullptr, record);
    return;
  }
  const auto image = toImageData(made.phases);
  const auto count = static_cast<vtkIdType>(made.phases.phase.size());
  const auto grain = vtkSmartPointer<vtkIntArray>::New();
  grain->SetName("grain");
  grain->SetNumberOfTuples(count);
  std::copy(made.directions.grain.begin(), made.directions.grain.end(), grain->GetPointer(0));
  describe(grain, "1", "cell: number of the nearest lumen, from 1", creator);
  const auto share = vtkSmartPointer<vtkFloatArray>::New();
  share->SetName("lumen_share");
  share->SetNumberOfTuples(count);
  std::copy(made.lattice.lumenShare.begin(), made.lattice.lumenShare.end(), share->GetPointer(0));
  describe(share, "1", "share of the node's pixel that is lumen", creator);
  const auto axis = vtkSmartPointer<vtkFloatArray>::New();
  axis->SetName("axis");
  axis->SetNumberOfComponents(3);
  axis->SetNumberOfTuples(count);
  for (vtkIdType i = 0; i < count; ++i)
  {
    const auto& a = made.directions.axis[static_cast<std::size_t>(i)];
    const std::array<float, 3> v{ a[0], a[1], 0 };
    axis->SetTypedTuple(i, v.data());
  }
  describe(axis, "1", "unit vector along the wall, its sign means nothing; 0 in lumens", creator);
  vtkPointData* const data = image->GetPointData();
  data->AddArray(grain);
  data->AddArray(axis);
  data->AddArray(share);
  setFieldText(
    image, "pixel_size_source", source.kind == MicrographKind::Polygons ? "polygons" : source.pixelSizeSource);
  setProvenance(image, io::toJson(record));
  writeGrid(image, *outputs.lattice);
}

void writeContours(const micrograph::ContourSet& contours, const OutputFile& file, const io::Provenance& record)
{
  if (file.path().extension() == ".vtp")
  {
    const auto data = toPolyData(contours, creator);
    setProvenance(data, io::toJson(record));
    writeGrid(data, file);
    return;
  }
  try
  {
    micrograph::writePolygons(contours, file.temporary());
  }
  catch (const Error& error)
  {
    file.rethrow(error);
    throw;
  }
}

} // namespace lamella::cli
