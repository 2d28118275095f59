#include "vtkLatticeConversion.h"

#include "core/Error.h"
#include "core/Plausible.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationStringKey.h"
#include "vtkMatrix3x3.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkStringArray.h"
#include "vtkUnsignedCharArray.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <unordered_map>

namespace lamella
{
namespace
{

/// Memory of adopted vectors. VTK frees a buffer by its address alone, and arrays may share a buffer, so the owner is
/// looked up by address when the last of them lets go.
class AdoptedMemory
{
public:
  static void* keep(std::vector<std::uint8_t> values)
  {
    void* const address = values.data();
    const std::lock_guard<std::mutex> lock(mutex());
    owners().emplace(address, std::move(values));
    return address;
  }
  static void release(void* address)
  {
    const std::lock_guard<std::mutex> lock(mutex());
    owners().erase(address);
  }

private:
  // Never destroyed: arrays may outlive every static object of this library.
  static std::mutex& mutex()
  {
    static auto* const instance = new std::mutex;
    return *instance;
  }
  static std::unordered_map<void*, std::vector<std::uint8_t>>& owners()
  {
    static auto* const instance = new std::unordered_map<void*, std::vector<std::uint8_t>>;
    return *instance;
  }
};

/// Text of an array beside its unit: "DESCRIPTION [CREATOR]". A key of VTK's own, since a file with a key of ours makes
/// every program that lacks our library complain as it reads it.
vtkInformationStringKey* textKey()
{
  return vtkDataObject::FIELD_NAME();
}

} // namespace

vtkSmartPointer<vtkUnsignedCharArray> adopt(std::vector<std::uint8_t> values, const char* name)
{
  auto array = vtkSmartPointer<vtkUnsignedCharArray>::New();
  array->SetName(name);
  if (!values.empty())
  {
    const auto count = static_cast<vtkIdType>(values.size());
    array->SetVoidArray(
      AdoptedMemory::keep(std::move(values)), count, 0, vtkAbstractArray::VTK_DATA_ARRAY_USER_DEFINED);
    array->SetArrayFreeFunction(&AdoptedMemory::release);
  }
  return array;
}

vtkSmartPointer<vtkImageData> toImageData(PhaseImage image)
{
  auto result = vtkSmartPointer<vtkImageData>::New();
  setGeometry(result, image.lattice);
  const auto array = adopt(std::move(image.phase), "phase");
  describe(array, "1", "phase of the node: position in phase_names", "lamella");
  result->GetPointData()->SetScalars(array);
  setPhaseNames(result, image.phases);
  return result;
}

PhaseView viewPhases(vtkImageData* image, const char* name, Voxels voxels)
{
  PhaseView view;
  requireUpright(image);
  view.lattice = latticeOf(image, voxels);
  vtkDataArray* const array = image->GetPointData()->GetArray(name);
  if (array == nullptr)
  {
    if (image->GetCellData()->HasArray(name))
    {
      throw InputError("array '" + std::string(name) + "' is cell data; phases are read at points",
        "open the file with the picture reader (or 'lamella'), which makes a node of every cell");
    }
    throw InputError("the image has no point array '" + std::string(name) + "'",
      "make the image with a reader or generator of Lamella, or name the array that holds the phases");
  }
  auto* const phases = vtkUnsignedCharArray::SafeDownCast(array);
  if (phases == nullptr || phases->GetNumberOfComponents() != 1)
  {
    throw InputError("array '" + std::string(name) + "' is " + array->GetDataTypeAsString() + " with " +
        std::to_string(array->GetNumberOfComponents()) + " component(s); phases are one unsigned char a node",
      "choose the array of phases, or convert it to unsigned char");
  }
  view.phase = { phases->GetPointer(0), static_cast<std::size_t>(phases->GetNumberOfValues()) };
  view.phases = phaseNames(image);
  const std::uint8_t largest =
    view.phase.empty() ? std::uint8_t{ 0 } : *std::max_element(view.phase.begin(), view.phase.end());
  for (std::size_t id = view.phases.size(); id <= largest; ++id)
    view.phases.add(std::to_string(id));
  return view;
}

PhaseImage toPhaseImage(vtkImageData* image, const char* array, Voxels voxels)
{
  const PhaseView view = viewPhases(image, array, voxels);
  return PhaseImage{ view.lattice, { view.phase.begin(), view.phase.end() }, view.phases };
}

Lattice latticeOf(const int whole[6], const double origin[3], const double spacing[3], Voxels voxels)
{
  Lattice lattice;
  int first = -1;
  for (int axis = 0; axis < 3; ++axis)
  {
    lattice.size[axis] = static_cast<std::int64_t>(whole[2 * axis + 1]) - whole[2 * axis] + 1;
    lattice.origin[axis] = origin[axis] + whole[2 * axis] * spacing[axis];
    if (lattice.size[axis] > 1 && first < 0)
      first = axis;
  }
  if (lattice.size[0] < 1 || lattice.size[1] < 1 || lattice.size[2] < 1)
    throw InputError("the image has no nodes", "check that the source before it worked");
  lattice.dimension = lattice.size[2] > 1 ? 3 : 2;
  lattice.spacing = spacing[std::max(first, 0)];
  for (int axis = 0; axis < lattice.dimension; ++axis)
  {
    const bool differs =
      lattice.size[axis] > 1 && std::abs(spacing[axis] - lattice.spacing) > 1e-6 * std::abs(lattice.spacing);
    if (differs && spacing[axis] > 0)
      lattice.aspect[axis] = spacing[axis] / lattice.spacing;
    if (!(lattice.spacing > 0) ||
      (differs && (voxels == Voxels::Cubes || !(spacing[axis] > 0) || !plausible(spacing[axis]))))
    {
      throw InputError("the image's spacing is " + std::to_string(spacing[0]) + ", " + std::to_string(spacing[1]) +
          ", " + std::to_string(spacing[2]) + "; " +
          (voxels == Voxels::Cubes ? "a lattice has the same positive spacing along every axis"
                                   : "spacings are positive, and between 1e-30 and 1e30"),
        voxels == Voxels::Cubes ? "resample the image to square pixels first; steady diffusion takes it as it is"
                                : "give the image the distances of its nodes in metres");
    }
  }
  if (!plausible(lattice.spacing))
  {
    throw InputError(fmt::format("the image's spacing is {} m, which is not between 1e-30 and 1e30", lattice.spacing),
      "give the distance of two nodes in metres, such as 0.5e-6");
  }
  return lattice;
}

void requireUpright(const double direction[9])
{
  constexpr std::array<double, 9> upright{ 1, 0, 0, 0, 1, 0, 0, 0, 1 };
  if (!std::equal(upright.begin(), upright.end(), direction))
  {
    throw InputError("the image is turned in space, and what is computed goes along x, y and z",
      "give it the direction matrix 1 0 0 0 1 0 0 0 1; what is computed is then along its own axes");
  }
}

void requireUpright(vtkImageData* image)
{
  requireUpright(image->GetDirectionMatrix()->GetData());
}

Lattice latticeOf(vtkImageData* image, Voxels voxels)
{
  return latticeOf(image->GetExtent(), image->GetOrigin(), image->GetSpacing(), voxels);
}

lbm::Block blockOf(const int extent[6], const int whole[6]) noexcept
{
  lbm::Block block;
  for (int axis = 0; axis < 3; ++axis)
  {
    if (extent[2 * axis + 1] < extent[2 * axis])
      return {};
    block.start[axis] = static_cast<std::int64_t>(extent[2 * axis]) - whole[2 * axis];
    block.size[axis] = static_cast<std::int64_t>(extent[2 * axis + 1]) - extent[2 * axis] + 1;
  }
  return block;
}

void setGeometry(vtkImageData* image, const Lattice& lattice)
{
  image->SetDimensions(
    static_cast<int>(lattice.size[0]), static_cast<int>(lattice.size[1]), static_cast<int>(lattice.size[2]));
  image->SetSpacing(lattice.spacingAlong(0), lattice.spacingAlong(1), lattice.spacingAlong(2));
  image->SetOrigin(lattice.origin.data());
}

void describe(vtkDataArray* array, const std::string& unit, const std::string& text, const std::string& creator)
{
  vtkInformation* const information = array->GetInformation();
  information->Set(vtkDataArray::UNITS_LABEL(), unit);
  information->Set(textKey(), text + " [" + creator + "]");
}

std::array<std::string, 3> description(vtkDataArray* array)
{
  vtkInformation* const information = array->GetInformation();
  const auto read = [&](vtkInformationStringKey* key)
  { return std::string(information->Has(key) != 0 ? information->Get(key) : ""); };
  const std::string text = read(textKey());
  const std::size_t open = text.rfind(" [");
  if (open == std::string::npos || text.back() != ']')
    return { read(vtkDataArray::UNITS_LABEL()), text, "" };
  return { read(vtkDataArray::UNITS_LABEL()), text.substr(0, open), text.substr(open + 2, text.size() - open - 3) };
}

void setFieldTexts(vtkDataObject* data, const char* name, std::span<const std::string> texts)
{
  vtkNew<vtkStringArray> array;
  array->SetName(name);
  for (const std::string& text : texts)
    array->InsertNextValue(text);
  data->GetFieldData()->AddArray(array); // replaces an array of this name
}

void setFieldText(vtkDataObject* data, const char* name, const std::string& text)
{
  setFieldTexts(data, name, std::span(&text, 1));
}

std::vector<std::string> fieldTexts(vtkDataObject* data, const char* name)
{
  std::vector<std::string> texts;
  if (auto* const array = vtkStringArray::SafeDownCast(data->GetFieldData()->GetAbstractArray(name)))
    for (vtkIdType i = 0; i < array->GetNumberOfValues(); ++i)
      texts.push_back(array->GetValue(i));
  return texts;
}

std::optional<std::string> fieldText(vtkDataObject* data, const char* name)
{
  auto texts = fieldTexts(data, name);
  return texts.empty() ? std::nullopt : std::optional(std::move(texts.front()));
}

vtkDoubleArray* setFieldNumbers(vtkDataObject* data, const char* name, std::span<const double> values)
{
  vtkNew<vtkDoubleArray> array;
  array->SetName(name);
  array->SetNumberOfTuples(static_cast<vtkIdType>(values.size()));
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  data->GetFieldData()->AddArray(array);
  return array;
}

std::vector<double> fieldNumbers(vtkDataObject* data, const char* name)
{
  std::vector<double> values;
  if (vtkDataArray* const array = data->GetFieldData()->GetArray(name))
    for (vtkIdType i = 0; i < array->GetNumberOfValues(); ++i)
      values.push_back(array->GetVariantValue(i).ToDouble());
  return values;
}

void setPhaseNames(vtkDataObject* data, const PhaseTable& phases)
{
  setFieldTexts(data, "phase_names", phases.names());
}

PhaseTable phaseNames(vtkDataObject* data)
{
  return PhaseTable(fieldTexts(data, "phase_names"));
}

void setProvenance(vtkDataObject* data, const std::string& json)
{
  setFieldText(data, "provenance", json);
}

std::string provenance(vtkDataObject* data)
{
  return fieldText(data, "provenance").value_or("");
}

} // namespace lamella
