#include "SampleRun.h"

#include "GridFile.h"

#include "vtkLatticeConversion.h"

#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkPointData.h>

#include <array>
#include <cstdint>

namespace lamella::cli
{

void tellDoubts(Session& session, const Sample& sample)
{
  for (const std::string& warning : sample.warnings)
  {
    session.warn(warning);
  }
}

NodeArray sampleArray(const PictureOptions& picture, const Sample& sample, const char* name)
{
  if (!isVtkImage(picture.file))
  {
    return {};
  }
  const auto data = readGrid(picture.file);
  auto* const image = vtkImageData::SafeDownCast(data);
  vtkDataArray* const array = image != nullptr ? image->GetPointData()->GetArray(name) : nullptr;
  if (array == nullptr)
  {
    return {};
  }
  const Lattice whole = latticeOf(image);
  if (whole.size != sample.fileSize) // phases were taken from cells
  {
    return {};
  }
  const Lattice& lattice = sample.image.lattice;
  const std::array<std::int64_t, 3> start =
    sample.window ? firstNode(whole, *sample.window) : std::array<std::int64_t, 3>{ 0, 0, 0 };
  NodeArray nodes;
  nodes.components = array->GetNumberOfComponents();
  nodes.values.reserve(static_cast<std::size_t>(lattice.count()) * static_cast<std::size_t>(nodes.components));
  for (std::int64_t z = 0; z < lattice.size[2]; ++z)
  {
    for (std::int64_t y = 0; y < lattice.size[1]; ++y)
    {
      for (std::int64_t x = 0; x < lattice.size[0]; ++x)
      {
        for (int c = 0; c < nodes.components; ++c)
        {
          nodes.values.push_back(array->GetComponent(whole.index(x + start[0], y + start[1], z + start[2]), c));
        }
      }
    }
  }
  return nodes;
}

} // namespace lamella::cli
