#include "Arrays.h"

#include "core/Error.h"

#include "Palette.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkFieldData.h"
#include "vtkPointData.h"
#include "vtkSnapshot.h"
#include "vtkStringArray.h"

#include <algorithm>

namespace lamella::rendering
{
namespace
{

std::string ListArrays(vtkDataSetAttributes* attributes)
{
  std::string list;
  for (int i = 0; i < attributes->GetNumberOfArrays(); ++i)
  {
    const char* name = attributes->GetArrayName(i);
    list += (list.empty() ? "" : ", ") + std::string(name ? name : "(without a name)");
  }
  return list.empty() ? "none" : list;
}

bool HasArray(vtkDataSet* data, const std::string& name)
{
  return data->GetPointData()->HasArray(name.c_str()) || data->GetCellData()->HasArray(name.c_str());
}

} // namespace

std::string FindDirection(vtkDataSet* data, const std::string& name)
{
  for (const char* ending : { "", "_x", "_y", "_z" })
    if (HasArray(data, name + ending))
      return name + ending;
  return {};
}

std::string DirectionOf(const std::string& name)
{
  const bool has = name.size() > 2 && name[name.size() - 2] == '_' && name.back() >= 'x' && name.back() <= 'z';
  return has ? name.substr(name.size() - 2) : "";
}

std::string DefaultArray(vtkDataSet* data, int preset)
{
  if (preset != vtkSnapshot::AUTO && preset != vtkSnapshot::SCALAR)
  {
    const std::string name = preset == vtkSnapshot::PORES ? "pore_size" : vtkSnapshot::GetPresetName(preset);
    const std::string found = FindDirection(data, name);
    return found.empty() ? name : found;
  }
  for (const char* name :
    { "stress", "flux", "temperature", "concentration", "displacement", "pore_size", "phase", "grain", "event" })
  {
    const std::string found = FindDirection(data, name);
    if (!found.empty())
      return found;
  }
  std::string first;
  for (vtkDataSetAttributes* attributes : { static_cast<vtkDataSetAttributes*>(data->GetPointData()),
         static_cast<vtkDataSetAttributes*>(data->GetCellData()) })
  {
    for (int i = 0; i < attributes->GetNumberOfArrays(); ++i)
    {
      vtkDataArray* const array = attributes->GetArray(i);
      if (!array || !array->GetName())
        continue;
      if (array->GetNumberOfComponents() == 1)
        return array->GetName();
      first = first.empty() ? array->GetName() : first;
    }
  }
  if (!first.empty())
    return first;
  throw InputError("the data have no array to draw", "compute a field first, or draw the file it was read from");
}

int PresetOfName(const std::string& name)
{
  const std::string base = name.substr(0, name.size() - DirectionOf(name).size());
  for (const int preset : { vtkSnapshot::PHASE, vtkSnapshot::TEMPERATURE, vtkSnapshot::CONCENTRATION, vtkSnapshot::FLUX,
         vtkSnapshot::GRAIN, vtkSnapshot::STRESS })
    if (base == vtkSnapshot::GetPresetName(preset))
      return preset;
  return name == "flux_magnitude" ? vtkSnapshot::FLUX
    : name == "pore_size"         ? vtkSnapshot::PORES
    : name == "pore"              ? vtkSnapshot::GRAIN
                                  : vtkSnapshot::SCALAR;
}

vtkDataArray* GetArray(vtkDataSet* data, const std::string& name, bool allowCells, bool& onCells)
{
  vtkDataArray* array = data->GetPointData()->GetArray(name.c_str());
  vtkDataArray* cells = data->GetCellData()->GetArray(name.c_str());
  onCells = !array && cells && allowCells;
  if (array || onCells)
    return array ? array : cells;
  if (cells)
  {
    throw InputError("'" + name + "' is an array of cells; a lattice is drawn of its points",
      "turn it into point data (vtkCellDataToPointData, or ParaView's filter of that name)");
  }
  throw InputError("there is no array '" + name + "' in the data; point data: " + ListArrays(data->GetPointData()) +
      (allowCells ? "; cell data: " + ListArrays(data->GetCellData()) : ""),
    "name one of these, or compute the field first");
}

vtkDataArray* FindFlow(vtkDataSet* data, const Quantity& quantity, const SnapshotOptions& options)
{
  const bool own = !quantity.IsCategorical() && quantity.array->GetNumberOfComponents() >= 2 &&
    quantity.array->GetNumberOfComponents() <= 3 && !quantity.onCells;
  if (options.overlayArrayName.empty() && own)
    return quantity.array;
  // By itself, the flux of the direction that is drawn.
  std::string name = options.overlayArrayName;
  if (name.empty())
  {
    name = "flux" + DirectionOf(quantity.array->GetName());
    name = HasArray(data, name) ? name : FindDirection(data, "flux");
  }
  vtkDataArray* array = data->GetPointData()->GetArray(name.c_str());
  const bool isVector = array && array->GetNumberOfComponents() >= 2 && array->GetNumberOfComponents() <= 3;
  if (!options.overlayArrayName.empty() && !isVector)
  {
    throw InputError(
      "lines or arrows are to follow '" + name + "', which is " + (array ? "no vector" : "not among the point data"),
      "point data: " + ListArrays(data->GetPointData()));
  }
  return isVector ? array : nullptr;
}

std::vector<bool> FindSolid(vtkDataSet* data)
{
  vtkDataArray* phase = data->GetPointData()->GetArray("phase");
  if (!phase || phase->GetNumberOfComponents() != 1)
    return {};
  std::vector<bool> isVoid;
  if (auto* table = vtkStringArray::SafeDownCast(data->GetFieldData()->GetAbstractArray("phase_names")))
    for (vtkIdType i = 0; i < table->GetNumberOfValues(); ++i)
      isVoid.push_back(IsVoidName(table->GetValue(i)));
  if (std::find(isVoid.begin(), isVoid.end(), true) == isVoid.end())
    isVoid.assign(1, true);
  std::vector<bool> solid(static_cast<std::size_t>(phase->GetNumberOfTuples()));
  std::size_t count = 0;
  for (std::size_t i = 0; i < solid.size(); ++i)
  {
    const double id = phase->GetComponent(static_cast<vtkIdType>(i), 0);
    solid[i] = !(id >= 0 && id < static_cast<double>(isVoid.size()) && isVoid[static_cast<std::size_t>(id)]);
    count += solid[i] ? 1 : 0;
  }
  return count == 0 || count == solid.size() ? std::vector<bool>{} : solid;
}

std::optional<Scale> FindScale(vtkDataSet* data, double spacing)
{
  const auto text = [&](const char* name) -> std::string
  {
    auto* array = vtkStringArray::SafeDownCast(data->GetFieldData()->GetAbstractArray(name));
    return array && array->GetNumberOfValues() > 0 ? array->GetValue(0) : std::string();
  };
  if (text("length_unit") == "1")
    return std::nullopt;
  // A pixel of a metre is one whose size nobody gave.
  const std::string source = text("pixel_size_source");
  const bool unknown = source.empty() ? spacing == 1 : source == "none";
  return unknown ? Scale{ spacing > 0 ? 1 / spacing : 1, false } : Scale{ 1, true };
}

} // namespace lamella::rendering
