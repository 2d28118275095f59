#include "ContourField.h"

#include "vtkLatticeConversion.h"

#include "lattice/Error.h"
#include "micrograph/ShareLevel.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataArrayRange.h"
#include "vtkImageData.h"
#include "vtkPointData.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace lamella
{
namespace
{

constexpr const char* kDefault = "lumen_share";
constexpr double kRoundOff = 1e-6;

vtkDataArray* arrayOf(vtkImageData* image, const std::string& name)
{
  vtkDataArray* const array = image->GetPointData()->GetArray(name.c_str());
  if (array == nullptr)
  {
    throw InputError("there is no point array '" + name + "' of numbers",
      image->GetCellData()->GetArray(name.c_str()) != nullptr ? "it lies at the cells: move it to the points"
                                                              : "choose another array for the level or the shares");
  }
  if (array->GetNumberOfComponents() != 1)
  {
    throw InputError("the array '" + name + "' has " + std::to_string(array->GetNumberOfComponents()) + " components",
      "take one of them");
  }
  return array;
}

std::string textOf(double value)
{
  std::ostringstream text;
  text << value;
  return text.str();
}

} // namespace

ContourField contourField(vtkImageData* image, const std::string& name, bool shares, double level, bool below)
{
  if (!std::isfinite(level))
  {
    throw ParameterError("the level is " + textOf(level), "give a number between the lumens' values and the walls'");
  }
  ContourField field;
  field.array = name.empty() ? kDefault : name;
  vtkDataArray* const array = arrayOf(image, field.array);
  const int type = array->GetDataType();
  const double full = type == VTK_UNSIGNED_CHAR ? 255 : type == VTK_UNSIGNED_SHORT ? 65535 : 1;

  const auto values = vtk::DataArrayValueRange<1>(array);
  field.level.reserve(static_cast<std::size_t>(values.size()));
  for (const auto each : values)
  {
    const double value = static_cast<double>(each) / full;
    if (!std::isfinite(value))
    {
      throw InputError("the array '" + field.array + "' has values that are no finite numbers", "give every node one");
    }
    if (shares && !(value >= -kRoundOff && value <= 1 + kRoundOff))
    {
      throw InputError("the array '" + field.array + "' has the value " + textOf(value) + ", and shares go from 0 to 1",
        "scale it, or take outlines at a level");
    }
    const double above = shares ? value : value - level;
    field.level.push_back(static_cast<float>(!below ? above : shares ? 1 - above : -above));
  }
  const Lattice lattice = latticeOf(image);
  if (shares)
  {
    field.level = micrograph::levelOfShares(lattice, field.level);
  }
  field.image = { lattice, {}, PhaseTable({ "lumen", "wall" }) };
  field.image.phase.resize(field.level.size());
  std::transform(field.level.begin(), field.level.end(), field.image.phase.begin(),
    [](float value) { return static_cast<std::uint8_t>(value > 0 ? 0 : 1); });
  return field;
}

} // namespace lamella
