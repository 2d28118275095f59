#include "convert/Xdmf.h"

#include "convert/Types.h"
#include "files/Collection.h"

#include "core/Error.h"

#include <vtkDataArray.h>
#include <vtkMatrix3x3.h>
#include <vtkPointData.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

namespace lamella::cli
{

namespace
{

/// VTK's readers Xdmf2 and Xdmf3 know some words each: these are known to both. Of u64 there is none, but i64 reads it
/// up to 2^63.
std::string numbersOf(vtkDataArray* array)
{
  const std::string type = typeName(array->GetDataType()); // u8, i16, f32 …
  const int bytes = array->GetDataTypeSize();
  return fmt::format("NumberType=\"{}{}\" Precision=\"{}\"", type[0] == 'u' && bytes < 8 ? "U" : "",
    type[0] == 'f' ? "Float"
      : bytes == 1 ? "Char"
      : bytes == 2 ? "Short"
                   : "Int",
    bytes);
}

const char* kindOf(int components)
{
  switch (components)
  {
    case 1:
      return "Scalar";
    case 3:
      return "Vector";
    case 9:
      return "Tensor";
    default: // 6, too: the order of XDMF's Tensor6 is not VTK's
      return "Matrix";
  }
}

std::string item(const std::array<double, 3>& zyx)
{
  return fmt::format(
    R"(<DataItem Dimensions="3" NumberType="Float" Precision="8" Format="XML">{}</DataItem>)", fmt::join(zyx, " "));
}

} // namespace

std::string xdmfGrid(Volume& volume, const std::string& file, std::optional<double> time)
{
  vtkImageData* const sample = volume.sample();
  if (!sample->GetDirectionMatrix()->IsIdentity())
    throw InputError("the axes of the image are not those of space, and XDMF has no place for that",
      "write .vti or .hdf, which keep them");
  const auto& e = volume.extent();
  std::array<double, 3> origin{};
  sample->TransformIndexToPhysicalPoint(e[0], e[2], e[4], origin.data());
  std::ranges::reverse(origin);
  std::array<double, 3> spacing{};
  std::reverse_copy(sample->GetSpacing(), sample->GetSpacing() + 3, spacing.begin());
  const std::array<int, 3> size{ e[5] - e[4] + 1, e[3] - e[2] + 1, e[1] - e[0] + 1 };
  // As vtkVTKHDFWriter has it: the axis of one point is the last one.
  std::vector<int> stored(size.begin(), size.end());
  std::ranges::stable_partition(stored, [](int count) { return count > 1; });

  std::string text = R"(<Grid Name="image" GridType="Uniform">)";
  if (time)
    text += fmt::format("\n  <Time Value=\"{}\"/>", *time);
  text += fmt::format("\n  <Topology TopologyType=\"3DCoRectMesh\" Dimensions=\"{}\"/>\n"
                      "  <Geometry GeometryType=\"ORIGIN_DXDYDZ\">\n    {}\n    {}\n  </Geometry>\n",
    fmt::join(size, " "), item(origin), item(spacing));
  for (int i = 0; i < sample->GetPointData()->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* const array = sample->GetPointData()->GetArray(i);
    const int components = array->GetNumberOfComponents();
    const std::string name = xmlText(array->GetName());
    text += fmt::format("  <Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"Node\">\n    <DataItem "
                        "Dimensions=\"{}{}\" {} Format=\"HDF\">{}:/VTKHDF/PointData/{}</DataItem>\n  </Attribute>\n",
      name, kindOf(components), fmt::join(stored, " "), components > 1 ? fmt::format(" {}", components) : "",
      numbersOf(array), xmlText(file), name);
  }
  return text + "</Grid>\n";
}

std::string xdmfText(const std::vector<std::string>& grids)
{
  const bool several = grids.size() > 1;
  return fmt::format("<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n<Domain>\n{}{}{}</Domain>\n</Xdmf>\n",
    several ? "<Grid Name=\"steps\" GridType=\"Collection\" CollectionType=\"Temporal\">\n" : "", fmt::join(grids, ""),
    several ? "</Grid>\n" : "");
}

} // namespace lamella::cli
