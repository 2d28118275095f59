#include "RefinedImage.h"

#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"

namespace lamella
{

void refineGeometry(
  std::array<int, 6>& extent, std::array<double, 3>& spacing, std::array<double, 3>& origin, int dimension, int n)
{
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(dimension); ++axis)
  {
    extent[2 * axis] *= n;
    extent[2 * axis + 1] = (extent[2 * axis + 1] + 1) * n - 1;
    origin[axis] -= spacing[axis] * (n - 1) / (2 * n); // points are the middles of pixels
  }
  for (double& step : spacing)
    step /= n;
}

vtkSmartPointer<vtkImageData> refinedImage(vtkImageData* image, int dimension, int n)
{
  std::array<int, 6> extent{};
  std::array<double, 3> spacing{};
  std::array<double, 3> origin{};
  image->GetExtent(extent.data());
  image->GetSpacing(spacing.data());
  image->GetOrigin(origin.data());
  const std::array<int, 6> coarse = extent;
  auto refined = vtkSmartPointer<vtkImageData>::New();
  refineGeometry(extent, spacing, origin, dimension, n);
  const bool empty = image->GetNumberOfPoints() == 0;
  refined->SetExtent(empty ? const_cast<int*>(coarse.data()) : extent.data());
  refined->SetSpacing(spacing.data());
  refined->SetOrigin(origin.data());
  refined->SetDirectionMatrix(image->GetDirectionMatrix());
  refined->GetFieldData()->ShallowCopy(image->GetFieldData());
  if (empty)
    return refined;
  const std::array<vtkIdType, 3> size{ extent[1] - extent[0] + 1, extent[3] - extent[2] + 1,
    extent[5] - extent[4] + 1 };
  const std::array<vtkIdType, 2> from{ coarse[1] - coarse[0] + 1, coarse[3] - coarse[2] + 1 };
  const int layers = dimension == 3 ? n : 1;
  vtkNew<vtkIdList> row; // the points that those of one row come from, layer by layer and row by row
  row->SetNumberOfIds(size[0]);
  vtkNew<vtkIdList> to;
  to->SetNumberOfIds(size[0]);
  vtkPointData* const points = refined->GetPointData();
  points->CopyAllOn();
  points->CopyAllocate(image->GetPointData(), refined->GetNumberOfPoints());
  for (vtkIdType z = 0, point = 0; z < size[2]; ++z)
  {
    for (vtkIdType y = 0; y < size[1]; ++y)
    {
      const vtkIdType first = from[0] * (y / n + from[1] * (z / layers));
      for (vtkIdType x = 0; x < size[0]; ++x, ++point)
      {
        row->SetId(x, first + x / n);
        to->SetId(x, point);
      }
      points->CopyData(image->GetPointData(), row, to);
    }
  }
  return refined;
}

} // namespace lamella
