#include "CollapseInput.h"

#include "vtkLatticeConversion.h"

#include "core/Error.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataArrayRange.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <cmath>
#include <limits>
#include <string>

namespace lamella
{
namespace
{

/// @throws InputError
vtkDataArray* arrayOf(vtkPolyData* points, const std::string& name)
{
  vtkDataArray* const array = points->GetPointData()->GetArray(name.c_str());
  if (array == nullptr)
  {
    throw InputError(points->GetCellData()->HasArray(name.c_str()) ? "array '" + name + "' is cell data, not point data"
                                                                   : "the material points have no array '" + name + "'",
      "give the points as lamella writes them, with 'id' and 'deformation_gradient'");
  }
  return array;
}

std::vector<double> numbers(vtkDataArray* array)
{
  const auto values = vtk::DataArrayValueRange(array);
  return { values.begin(), values.end() };
}

} // namespace

CollapseInput collapseInput(vtkPolyData* points, int dimension, double time)
{
  if (points->GetNumberOfPoints() == 0)
    throw InputError("a state has no material points", "check that the source before it worked");
  vtkDataArray* const ids = arrayOf(points, "id");
  vtkDataArray* const gradients = arrayOf(points, "deformation_gradient");
  if (ids->GetNumberOfComponents() != 1)
  {
    throw InputError(
      std::string("array '") + ids->GetName() + "' has " + std::to_string(ids->GetNumberOfComponents()) + " components",
      "give one number a point");
  }
  const int components = gradients->GetNumberOfComponents();
  if (components != 9 && (components != 4 || dimension == 3))
  {
    throw InputError(
      std::string("array '") + gradients->GetName() + "' has " + std::to_string(components) + " components",
      dimension == 3 ? "a deformation gradient of a volume has 9" : "a deformation gradient of a picture has 9 or 4");
  }
  CollapseInput input;
  const std::vector<double> told = fieldNumbers(points, "strain");
  input.strain = told.empty() ? time : told.front();
  if (!std::isfinite(input.strain))
    throw InputError("a state tells neither its strain nor its time", "give its points the field data 'strain'");
  input.id.reserve(static_cast<std::size_t>(points->GetNumberOfPoints()));
  for (const double value : numbers(ids))
  {
    if (!(value >= 0 && value < std::numeric_limits<std::uint32_t>::max()) || value != std::floor(value))
    {
      throw InputError(std::string("array '") + ids->GetName() + "' holds " + std::to_string(value) +
          ", which is no number of a point",
        "give whole numbers from 0 on, in the order in which the points were made");
    }
    input.id.push_back(static_cast<std::uint32_t>(value));
  }
  input.position = numbers(points->GetPoints()->GetData());
  input.gradient = numbers(gradients);
  return input;
}

} // namespace lamella
