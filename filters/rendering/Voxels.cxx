#include "Voxels.h"

#include "vtkCellArray.h"
#include "vtkFloatArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkTypeInt64Array.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>

namespace lamella::rendering
{
namespace
{

/// Number of solid voxels in any box, in constant time.
class SolidCount
{
public:
  explicit SolidCount(const VoxelBlock& block)
    : Size{ block.size[0] + 1, block.size[1] + 1, block.size[2] + 1 }
    , Sums(static_cast<std::size_t>(Size[0]) * static_cast<std::size_t>(Size[1]) * static_cast<std::size_t>(Size[2]), 0)
  {
    for (int k = 1; k < this->Size[2]; ++k)
    {
      for (int j = 1; j < this->Size[1]; ++j)
      {
        std::uint32_t row = 0;
        for (int i = 1; i < this->Size[0]; ++i)
        {
          row += block.solid[block.Index(i - 1, j - 1, k - 1)] ? 1 : 0;
          this->Sums[this->Index(i, j, k)] = row + this->Sums[this->Index(i, j - 1, k)] +
            this->Sums[this->Index(i, j, k - 1)] - this->Sums[this->Index(i, j - 1, k - 1)];
        }
      }
    }
  }

  /// Share of solid in a box of corners, of which what lies outside the block counts as empty.
  [[nodiscard]] double Share(const std::array<int, 3>& low, const std::array<int, 3>& high) const
  {
    std::array<int, 3> a{};
    std::array<int, 3> b{};
    double volume = 1;
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      a.at(axis) = std::clamp(low.at(axis), 0, this->Size.at(axis) - 1);
      b.at(axis) = std::clamp(high.at(axis), 0, this->Size.at(axis) - 1);
      volume *= std::max(1, high.at(axis) - low.at(axis));
    }
    // unsigned sums wrap round and back
    const std::uint32_t count = this->At(b[0], b[1], b[2]) - this->At(a[0], b[1], b[2]) - this->At(b[0], a[1], b[2]) -
      this->At(b[0], b[1], a[2]) + this->At(a[0], a[1], b[2]) + this->At(a[0], b[1], a[2]) +
      this->At(b[0], a[1], a[2]) - this->At(a[0], a[1], a[2]);
    return count / volume;
  }

private:
  [[nodiscard]] std::size_t Index(int i, int j, int k) const
  {
    return (static_cast<std::size_t>(k) * static_cast<std::size_t>(this->Size[1]) + static_cast<std::size_t>(j)) *
      static_cast<std::size_t>(this->Size[0]) +
      static_cast<std::size_t>(i);
  }
  [[nodiscard]] std::uint32_t At(int i, int j, int k) const { return this->Sums[this->Index(i, j, k)]; }

  std::array<int, 3> Size;
  std::vector<std::uint32_t> Sums;
};

/// Empty voxels that a ray towards the viewer can leave: those at the near sides of the block, and those with such a
/// one next to them on a near side. Every voxel that is seen is among them, so that faces behind all others can go.
std::vector<bool> Reachable(const VoxelBlock& block, const std::array<double, 3>& towards)
{
  std::vector<bool> reachable(block.solid.size(), false);
  const std::array<int, 3>& n = block.size;
  std::array<int, 3> step{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    step.at(axis) = towards.at(axis) > 1e-9 ? 1 : towards.at(axis) < -1e-9 ? -1 : 0;
  const auto order = [&](int k, std::size_t axis) { return step.at(axis) > 0 ? n.at(axis) - 1 - k : k; };
  for (int c = 0; c < n[2]; ++c)
  {
    for (int b = 0; b < n[1]; ++b)
    {
      for (int a = 0; a < n[0]; ++a)
      {
        const std::array<int, 3> voxel{ order(a, 0), order(b, 1), order(c, 2) };
        const std::size_t index = block.Index(voxel[0], voxel[1], voxel[2]);
        if (block.solid[index])
          continue;
        for (std::size_t axis = 0; axis < 3 && !reachable[index]; ++axis)
        {
          std::array<int, 3> next = voxel;
          next.at(axis) += step.at(axis);
          const bool outside = next.at(axis) < 0 || next.at(axis) >= n.at(axis);
          reachable[index] = step.at(axis) != 0 && (outside || reachable[block.Index(next[0], next[1], next[2])]);
        }
      }
    }
  }
  return reachable;
}

class Builder
{
public:
  Builder(const VoxelBlock& block, const VoxelLight& light, const std::function<Color(std::size_t)>& colorOf,
    std::vector<bool> open)
    : Block(block)
    , Light(light)
    , ColorOf(colorOf)
    , Open(std::move(open))
  {
    if (light.hollows > 0)
      this->Counts = std::make_unique<SolidCount>(block);
  }

  /// All faces across `axis` that look to `sign`.
  void AddFaces(std::size_t axis, int sign)
  {
    const std::array<int, 3>& n = this->Block.size;
    for (int k = 0; k < n[2]; ++k)
    {
      for (int j = 0; j < n[1]; ++j)
      {
        for (int i = 0; i < n[0]; ++i)
        {
          std::array<int, 3> next{ i, j, k };
          next.at(axis) += sign;
          const bool outside = next.at(axis) < 0 || next.at(axis) >= n.at(axis);
          if (this->Block.solid[this->Block.Index(i, j, k)] &&
            (outside || this->Open[this->Block.Index(next[0], next[1], next[2])]))
            this->AddFace({ i, j, k }, axis, sign);
        }
      }
    }
  }

  vtkSmartPointer<vtkPolyData> Finish()
  {
    const vtkIdType corners = this->Colors->GetNumberOfTuples();
    vtkNew<vtkTypeInt64Array> offsets;
    vtkNew<vtkTypeInt64Array> connectivity;
    offsets->SetNumberOfValues(corners / 4 + 1);
    connectivity->SetNumberOfValues(corners);
    for (vtkIdType i = 0; i <= corners / 4; ++i)
      offsets->SetValue(i, 4 * i);
    for (vtkIdType i = 0; i < corners; ++i)
      connectivity->SetValue(i, i);
    vtkNew<vtkCellArray> faces;
    faces->SetData(offsets, connectivity);
    vtkNew<vtkPoints> points;
    points->SetData(this->Coordinates);
    auto result = vtkSmartPointer<vtkPolyData>::New();
    result->SetPoints(points);
    result->SetPolys(faces);
    result->GetPointData()->SetScalars(this->Colors);
    return result;
  }

private:
  void AddFace(const std::array<int, 3>& voxel, std::size_t axis, int sign)
  {
    const std::size_t u = (axis + 1) % 3;
    const std::size_t v = (axis + 2) % 3;
    const Color color = this->ColorOf(this->Block.Index(voxel[0], voxel[1], voxel[2]));
    static constexpr std::array<std::array<int, 2>, 4> places{ { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } } };
    for (const auto& [du, dv] : places)
    {
      std::array<int, 3> corner = voxel;
      corner.at(axis) += sign > 0 ? 1 : 0;
      corner.at(u) += du;
      corner.at(v) += dv;
      std::array<float, 3> position{};
      for (std::size_t c = 0; c < 3; ++c)
        position.at(c) = static_cast<float>(this->Block.corner.at(c) + corner.at(c) * this->Block.spacing.at(c));
      this->Coordinates->InsertNextTypedTuple(position.data());
      const double light = this->Light.faces.at(axis) * this->Openness(corner, axis, sign);
      const auto lit = [light](std::uint8_t c)
      { return static_cast<unsigned char>(std::lround(std::min(255.0, light * c))); };
      const std::array<unsigned char, 3> rgb{ lit(color.r), lit(color.g), lit(color.b) };
      this->Colors->InsertNextTypedTuple(rgb.data());
    }
  }

  /// 1 on an open plain, less the more solid stands in front of the corner, near and a little farther.
  [[nodiscard]] double Openness(const std::array<int, 3>& corner, std::size_t axis, int sign) const
  {
    if (!this->Counts)
      return 1;
    double openness = 1;
    for (const auto& [reach, weight] : { std::pair{ 2, 0.45 }, std::pair{ 6, 0.35 }, std::pair{ 14, 0.3 } })
    {
      std::array<int, 3> low{ corner[0] - reach, corner[1] - reach, corner[2] - reach };
      std::array<int, 3> high{ corner[0] + reach, corner[1] + reach, corner[2] + reach };
      (sign > 0 ? low : high).at(axis) = corner.at(axis);
      openness *= 1 - this->Light.hollows * weight * this->Counts->Share(low, high);
    }
    return openness;
  }

  const VoxelBlock& Block;
  const VoxelLight& Light;
  const std::function<Color(std::size_t)>& ColorOf;
  std::vector<bool> Open; ///< voxels through which a face may be seen
  std::unique_ptr<SolidCount> Counts;
  vtkSmartPointer<vtkFloatArray> Coordinates = []
  {
    auto array = vtkSmartPointer<vtkFloatArray>::New();
    array->SetNumberOfComponents(3);
    return array;
  }();
  vtkSmartPointer<vtkUnsignedCharArray> Colors = []
  {
    auto array = vtkSmartPointer<vtkUnsignedCharArray>::New();
    array->SetNumberOfComponents(3);
    return array;
  }();
};

} // namespace

vtkSmartPointer<vtkPolyData> VoxelFaces(const VoxelBlock& block, const std::array<double, 3>& towards, bool translucent,
  const VoxelLight& light, const std::function<Color(std::size_t)>& colorOf)
{
  std::vector<bool> open;
  if (translucent)
  {
    open = block.solid;
    open.flip();
  }
  else
  {
    open = Reachable(block, towards);
  }
  Builder builder(block, light, colorOf, std::move(open));
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (std::abs(towards.at(axis)) > 1e-9)
      builder.AddFaces(axis, towards.at(axis) > 0 ? 1 : -1);
  return builder.Finish();
}

} // namespace lamella::rendering
