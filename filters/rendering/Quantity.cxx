#include "Quantity.h"

#include "core/Error.h"
#include "lattice/AxisNames.h"

#include "Arrays.h"
#include "ShownUnit.h"

#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkFieldData.h"
#include "vtkPointData.h"
#include "vtkSnapshot.h"
#include "vtkStringArray.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace lamella::rendering
{
namespace
{

constexpr std::size_t MostPhases = 32;

/// Values in component `component`, or the magnitude; NaN where the field is not defined.
std::vector<float> ReadValues(vtkDataArray* array, int component)
{
  const vtkIdType count = array->GetNumberOfTuples();
  const int components = array->GetNumberOfComponents();
  std::vector<float> values(static_cast<std::size_t>(count));
  for (vtkIdType i = 0; i < count; ++i)
  {
    double value = 0;
    if (component >= 0 || components == 1)
    {
      value = array->GetComponent(i, std::max(component, 0));
    }
    else
    {
      for (int c = 0; c < components; ++c)
      {
        const double part = array->GetComponent(i, c);
        value += part * part;
      }
      value = std::sqrt(value);
    }
    values[static_cast<std::size_t>(i)] =
      std::isfinite(value) ? static_cast<float>(value) : std::numeric_limits<float>::quiet_NaN();
  }
  return values;
}

double MeanFlux(vtkDataArray* array)
{
  std::array<double, 3> mean{};
  const int components = std::min(3, array->GetNumberOfComponents());
  const vtkIdType count = array->GetNumberOfTuples();
  double magnitude = 0;
  for (vtkIdType i = 0; i < count; ++i)
  {
    double square = 0;
    for (int c = 0; c < components; ++c)
    {
      const double part = array->GetComponent(i, c);
      if (std::isfinite(part))
      {
        mean.at(static_cast<std::size_t>(c)) += part / static_cast<double>(count);
        square += part * part;
      }
    }
    magnitude += std::sqrt(square) / static_cast<double>(count);
  }
  const double size = std::hypot(mean[0], mean[1], mean[2]);
  return size > 1e-6 * magnitude ? size : 0;
}

std::string Capitalised(std::string name)
{
  std::replace(name.begin(), name.end(), '_', ' ');
  if (!name.empty())
    name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])));
  return name;
}

/// Ids as they stand in the array; −1: none.
std::vector<std::int64_t> RawIds(Quantity& quantity)
{
  vtkDataArray* array = quantity.array;
  if (array->GetNumberOfComponents() != 1)
  {
    throw InputError("'" + std::string(array->GetName()) + "' has " + std::to_string(array->GetNumberOfComponents()) +
        " components; phases and grains have one",
      "draw it with the preset scalar or flux");
  }
  const auto count = static_cast<std::size_t>(array->GetNumberOfTuples());
  std::vector<std::int64_t> raw(count);
  bool anyDefined = false;
  for (std::size_t i = 0; i < count; ++i)
  {
    const double value = array->GetComponent(static_cast<vtkIdType>(i), 0);
    const bool platen = value == -1 && quantity.preset == vtkSnapshot::GRAIN; // what vtkMatrixBridges writes there
    if (!std::isfinite(value) || platen)
    {
      raw[i] = -1;
      quantity.hasUndefined = true;
      continue;
    }
    if (value != std::floor(value) || value < 0 || value > 2147483647.0)
    {
      std::ostringstream text; // as 1e+300, not in 300 digits
      text << "'" << array->GetName() << "' has the value " << value;
      throw InputError(
        text.str() + ", which is no id of a phase or grain (0, 1, 2 ...)", "draw it with the preset scalar");
    }
    raw[i] = static_cast<std::int64_t>(value);
    anyDefined = true;
  }
  if (!anyDefined)
    throw InputError("'" + std::string(array->GetName()) + "' has no finite value", "nothing can be drawn of it");
  return raw;
}

/// Places in the sorted list of ids stand for them: ids may be large and sparse. No grain (0) keeps the first place.
void SetGrains(
  Quantity& quantity, std::vector<std::int64_t> present, std::vector<std::int64_t>& raw, const std::array<int, 3>& size)
{
  if (present.front() != 0)
    present.insert(present.begin(), 0);
  std::transform(raw.begin(), raw.end(), raw.begin(),
    [&](std::int64_t id)
    { return id < 0 ? -1 : std::lower_bound(present.begin(), present.end(), id) - present.begin(); });
  quantity.idColors = size[0] > 0
    ? GrainColors(raw, size[0], size[1], size[2])
    : GrainColors(raw, static_cast<int>(std::min<std::size_t>(raw.size(), 2147483647)), 1, 1);
  quantity.idNames.resize(quantity.idColors.size());
  quantity.idIsVoid.assign(quantity.idColors.size(), false);
  quantity.idIsVoid[0] = true;
}

/// @param table may be null
std::vector<std::string> NamesOfPhases(vtkStringArray* table, std::int64_t largest)
{
  const auto places = static_cast<std::size_t>(
    std::max<std::int64_t>(largest + 1, table ? static_cast<std::int64_t>(table->GetNumberOfValues()) : 0));
  std::vector<std::string> names(places);
  for (std::size_t id = 0; id < places; ++id)
  {
    const bool named = table && static_cast<vtkIdType>(id) < table->GetNumberOfValues();
    names[id] = named ? std::string(table->GetValue(static_cast<vtkIdType>(id))) : "phase " + std::to_string(id);
  }
  return names;
}

void GiveColors(Quantity& quantity, const std::vector<std::string>& names, const SnapshotOptions& options)
{
  for (const auto& [name, rgb] : options.phaseColors)
  {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end())
    {
      std::string list;
      for (const std::string& known : names)
        list += (list.empty() ? "" : ", ") + known;
      throw InputError(
        "a colour is given for the phase '" + name + "', which the data do not have", "they have: " + list);
    }
    const auto channel = [](double c) { return static_cast<std::uint8_t>(std::lround(255 * std::clamp(c, 0.0, 1.0))); };
    quantity.idColors[static_cast<std::size_t>(found - names.begin())] = { channel(rgb[0]), channel(rgb[1]),
      channel(rgb[2]), 255 };
  }
}

void SetPhases(
  Quantity& quantity, vtkDataSet* data, const std::vector<std::int64_t>& present, const SnapshotOptions& options)
{
  if (present.size() > MostPhases)
  {
    throw InputError("'" + std::string(quantity.array->GetName()) + "' has " + std::to_string(present.size()) +
        " different values; as phases at most " + std::to_string(MostPhases) + " can be told apart",
      "draw it with the preset grain or scalar");
  }
  auto* table = vtkStringArray::SafeDownCast(data->GetFieldData()->GetAbstractArray("phase_names"));
  const std::vector<std::string> names = NamesOfPhases(table, present.back());
  quantity.idColors = PhaseColors(names);
  quantity.idIsVoid.resize(names.size());
  std::transform(
    names.begin(), names.end(), quantity.idIsVoid.begin(), [](const auto& name) { return IsVoidName(name); });
  if (std::none_of(quantity.idIsVoid.begin(), quantity.idIsVoid.end(), [](bool v) { return v; }) && present.size() > 1)
  {
    quantity.idIsVoid[0] = !table; // without names the first is the void, as the data model has it
    if (!table)
      quantity.idColors[0] = PhaseColors(std::vector<std::string>{ "void" })[0];
  }
  GiveColors(quantity, names, options);
  quantity.idNames.resize(names.size());
  for (const std::int64_t id : present)
    quantity.idNames[static_cast<std::size_t>(id)] = names[static_cast<std::size_t>(id)];
}

void ReadIds(Quantity& quantity, vtkDataSet* data, const std::array<int, 3>& size, const SnapshotOptions& options)
{
  std::vector<std::int64_t> raw = RawIds(quantity);
  std::vector<std::int64_t> present(raw);
  std::sort(present.begin(), present.end());
  present.erase(std::unique(present.begin(), present.end()), present.end());
  if (!present.empty() && present.front() < 0)
    present.erase(present.begin());
  if (quantity.preset == vtkSnapshot::GRAIN)
    SetGrains(quantity, std::move(present), raw, size);
  else
    SetPhases(quantity, data, present, options);
  quantity.ids.resize(raw.size());
  std::transform(
    raw.begin(), raw.end(), quantity.ids.begin(), [](std::int64_t id) { return static_cast<std::int32_t>(id); });
}

/// Where a potential is NaN nothing conducts, and a flux of 0 there is no flux at all.
void HideNonConducting(Quantity& quantity, vtkDataSet* data)
{
  for (const char* name : { "temperature", "concentration" })
  {
    vtkDataArray* potential = data->GetPointData()->GetArray(FindDirection(data, name).c_str());
    if (!quantity.onCells && potential && potential->GetNumberOfComponents() == 1)
    {
      for (std::size_t i = 0; i < quantity.values.size(); ++i)
        if (!std::isfinite(potential->GetComponent(static_cast<vtkIdType>(i), 0)))
          quantity.values[i] = std::numeric_limits<float>::quiet_NaN();
    }
  }
}

/// Fields of bonds that are 0 in voids because nothing is there.
bool IsOfSolid(const Quantity& quantity)
{
  const std::string name = quantity.array->GetName();
  return quantity.preset == vtkSnapshot::STRESS ||
    (quantity.preset == vtkSnapshot::SCALAR &&
      (name == "displacement" || name == "velocity" || name == "damage" || name == "broken" ||
        name == "strain_energy"));
}

void HideVoids(Quantity& quantity, vtkDataSet* data)
{
  const std::vector<bool> solid = quantity.onCells ? std::vector<bool>{} : FindSolid(data);
  for (std::size_t i = 0; i < solid.size(); ++i)
    quantity.values[i] = solid[i] ? quantity.values[i] : std::numeric_limits<float>::quiet_NaN();
}

/// The component of a stress along the load that the field data tell, by VTK's order xx, yy, zz, xy, yz, xz; without
/// one along the last axis.
int ComponentAlongLoad(vtkDataSet* data, vtkDataArray* array, bool flat)
{
  const auto text = [data](const char* name)
  {
    auto* const field = vtkStringArray::SafeDownCast(data->GetFieldData()->GetAbstractArray(name));
    return field && field->GetNumberOfValues() > 0 ? std::string(field->GetValue(0)) : std::string();
  };
  if (array->GetNumberOfComponents() != 6)
    return -1;
  const std::string named = text("load_axis");
  const int axis = named.size() == 1 && named[0] >= 'x' && named[0] <= 'z' ? named[0] - 'x' : flat ? 1 : 2;
  if (text("load") != "shear")
    return axis;
  return flat ? 3 : 3 + axis; // x moves along y, y along z, z along x
}

/// What a stress is shown relative to: that on the platen, or else the mean of the component where there is any.
double MeanStress(vtkDataSet* data, const std::vector<float>& values)
{
  auto* const known = vtkDataArray::SafeDownCast(data->GetFieldData()->GetAbstractArray("effective_stress"));
  if (known && known->GetNumberOfValues() > 0 && std::isfinite(known->GetComponent(0, 0)))
    return known->GetComponent(0, 0);
  double sum = 0;
  for (const float value : values)
    sum += std::isfinite(value) ? value : 0;
  return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

double Quantile(std::vector<float> values, double share)
{
  const auto place = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + place, values.end());
  return values[static_cast<std::size_t>(place)];
}

/// Sizes as powers of ten; what is not positive has none. `low` and `high` are set to the ends.
void TakeLogarithms(Quantity& quantity)
{
  quantity.logarithmic = true;
  quantity.low = std::numeric_limits<double>::max();
  quantity.high = 0;
  for (float& value : quantity.values)
  {
    if (value > 0)
    {
      quantity.low = std::min<double>(quantity.low, value);
      quantity.high = std::max<double>(quantity.high, value);
    }
    value = value > 0 ? std::log10(value) : std::numeric_limits<float>::quiet_NaN();
  }
}

void FindRange(Quantity& quantity, const SnapshotOptions& options)
{
  std::vector<float> finite;
  finite.reserve(quantity.values.size());
  std::copy_if(quantity.values.begin(), quantity.values.end(), std::back_inserter(finite),
    [](float value) { return std::isfinite(value); });
  quantity.hasUndefined = finite.size() < quantity.values.size();
  if (finite.empty())
  {
    throw InputError("'" + std::string(quantity.array->GetName()) + "' has no finite value",
      "nothing conducts, or the field was not computed");
  }
  const auto [least, most] = std::minmax_element(finite.begin(), finite.end());
  // a float's logarithm would not lead back to the last digit of a size
  const double smallest = quantity.logarithmic ? std::log10(quantity.low) : *least;
  const double largest = quantity.logarithmic ? std::log10(quantity.high) : *most;
  quantity.low = smallest;
  quantity.high = largest;
  if (options.range)
  {
    quantity.low = (*options.range)[0];
    quantity.high = (*options.range)[1];
    if (quantity.logarithmic)
    {
      if (!(quantity.low > 0))
      {
        throw InputError(
          "the range begins at " + std::to_string(quantity.low) + ", which has no place on a logarithmic scale",
          "begin above 0, such as at 1, or draw with the preset scalar");
      }
      quantity.low = std::log10(quantity.low);
      quantity.high = std::log10(quantity.high);
    }
  }
  else if (quantity.logarithmic)
  {
    // Ends that all but touch a power of ten take it.
    quantity.low = smallest - std::floor(smallest) < 0.35 ? std::floor(smallest) : smallest;
    quantity.high = std::ceil(largest) - largest < 0.15 ? std::ceil(largest) : largest;
  }
  else if ((quantity.preset == vtkSnapshot::FLUX && options.component < 0) ||
    (quantity.preset == vtkSnapshot::STRESS && Quantile(finite, 0.995) > 0))
  {
    const double most995 = Quantile(finite, 0.995);
    quantity.low = 0;
    quantity.high = most995 > 0 ? most995 : largest;
    if (quantity.high > 0)
    {
      const auto ticks = NiceTicks(0, quantity.high);
      const double step = 0.5 * (ticks.size() > 1 ? ticks[1] - ticks[0] : quantity.high);
      quantity.high = std::ceil(quantity.high / step - 1e-6) * step;
    }
  }
  else if ((quantity.preset == vtkSnapshot::TEMPERATURE || quantity.preset == vtkSnapshot::CONCENTRATION) &&
    smallest >= -1e-6 && largest <= 1 + 1e-6)
  {
    quantity.low = 0;
    quantity.high = 1;
  }
  else if (smallest < 0 && largest > 0 && std::min(-smallest, largest) > 0.15 * std::max(-smallest, largest))
  {
    // both sides of zero: zero is the middle of the map
    const double end = std::max(-smallest, largest);
    const auto ticks = NiceTicks(-end, end);
    const double step = ticks.size() > 1 ? ticks[1] - ticks[0] : end;
    const double round = std::ceil(end / step) * step;
    quantity.high = round - end < 0.03 * end ? round : end;
    quantity.low = -quantity.high;
  }
  else if (largest > smallest)
  {
    // Ends that all but touch a round number take it.
    const auto ticks = NiceTicks(smallest, largest);
    const double step = ticks.size() > 1 ? ticks[1] - ticks[0] : largest - smallest;
    const double low = std::floor(smallest / step) * step;
    const double high = std::ceil(largest / step) * step;
    const double near = 0.03 * (largest - smallest);
    quantity.low = smallest - low < near ? low : smallest;
    quantity.high = high - largest < near ? high : largest;
  }
  if (!(quantity.high > quantity.low))
  {
    const double around = quantity.low == 0 ? 1 : 0.5 * std::abs(quantity.low);
    quantity.high = quantity.low + around;
    quantity.low -= quantity.low == 0 ? 0 : around;
  }
  const double slack = 1e-6 * (quantity.high - quantity.low);
  quantity.below = smallest < quantity.low - slack;
  quantity.above = largest > quantity.high + slack;
}

void ChooseMap(Quantity& quantity, const SnapshotOptions& options)
{
  std::string name = options.colorMap;
  if (name.empty())
  {
    const bool bothSides = quantity.low < 0 && std::abs(quantity.low + quantity.high) < 1e-9 * quantity.high;
    name = bothSides                                ? "coolwarm"
      : quantity.preset == vtkSnapshot::TEMPERATURE ? "inferno"
      : quantity.preset == vtkSnapshot::FLUX        ? "inferno"
      : quantity.preset == vtkSnapshot::STRESS      ? "blue-red"
                                                    : "viridis";
  }
  quantity.map = ColorMap::Find(name);
  if (!quantity.map)
  {
    std::string list;
    for (const std::string_view known : ColorMap::Names())
      list += (list.empty() ? "" : ", ") + std::string(known);
    throw InputError("there is no colour map '" + name + "'", "choose one of " + list);
  }
}

void NameQuantity(Quantity& quantity, double mean, const SnapshotOptions& options)
{
  vtkDataArray* array = quantity.array;
  const std::string name = array->GetName();
  quantity.title =
    Capitalised(quantity.preset == vtkSnapshot::SCALAR ? name : name.substr(0, name.size() - DirectionOf(name).size()));
  quantity.unit = shownUnit(array);
  if (quantity.preset == vtkSnapshot::FLUX && mean > 0)
  {
    quantity.title = "Flux / mean flux";
    quantity.unit.clear();
  }
  else if (quantity.preset == vtkSnapshot::STRESS && array->GetNumberOfComponents() == 6)
  {
    static const char* const components[] = { "xx", "yy", "zz", "xy", "yz", "xz" };
    quantity.title = std::string("Stress ") + components[std::clamp(options.component, 0, 5)];
    if (mean != 0)
    {
      quantity.title += " / mean stress";
      quantity.unit.clear();
    }
    quantity.title = options.legendTitle.empty() ? quantity.title : options.legendTitle;
    quantity.unit = options.unit.empty() ? quantity.unit : options.unit;
    return;
  }
  else if ((quantity.preset == vtkSnapshot::TEMPERATURE || quantity.preset == vtkSnapshot::CONCENTRATION) &&
    quantity.unit.empty() && quantity.low == 0 && quantity.high == 1)
  {
    quantity.title = std::string("Scaled ") + vtkSnapshot::GetPresetName(quantity.preset);
  }
  if (array->GetNumberOfComponents() > 1 && options.component >= 0)
  {
    const char* given = array->GetComponentName(options.component);
    quantity.title += ", " +
      (given ? std::string(given)
          : array->GetNumberOfComponents() == 3
          ? std::string(axisNames.at(static_cast<std::size_t>(options.component))) + " component"
          : "component " + std::to_string(options.component));
  }
  else if (array->GetNumberOfComponents() > 1 && quantity.preset != vtkSnapshot::FLUX)
  {
    quantity.title += ", magnitude";
  }
  quantity.title = options.legendTitle.empty() ? quantity.title : options.legendTitle;
  quantity.unit = options.unit.empty() ? quantity.unit : options.unit;
}

} // namespace

std::array<double, 2> Quantity::LegendRange() const
{
  return this->logarithmic ? std::array{ std::pow(10.0, this->low), std::pow(10.0, this->high) }
                           : std::array{ this->low, this->high };
}

Color Quantity::ColorOf(std::size_t index) const
{
  if (this->IsCategorical())
  {
    const std::int32_t id = this->ids[index];
    return id < 0 ? Undefined : this->idColors[static_cast<std::size_t>(id)];
  }
  const float value = this->values[index];
  if (!std::isfinite(value))
    return Undefined;
  constexpr int steps = 2048;
  if (this->Table.empty())
    for (int i = 0; i <= steps; ++i)
      this->Table.push_back(this->map->At(static_cast<double>(i) / steps));
  const double t = std::clamp((value - this->low) / (this->high - this->low), 0.0, 1.0);
  return this->Table[static_cast<std::size_t>(std::lround(t * steps))];
}

Quantity FindQuantity(vtkDataSet* data, const std::array<int, 3>& size, const SnapshotOptions& given)
{
  SnapshotOptions options = given;
  Quantity quantity;
  const std::string name = options.arrayName.empty() ? DefaultArray(data, options.preset) : options.arrayName;
  quantity.array = GetArray(data, name, size[0] == 0, quantity.onCells);
  quantity.preset = options.preset == vtkSnapshot::AUTO ? PresetOfName(name) : options.preset;
  if (options.preset == vtkSnapshot::AUTO && quantity.preset == vtkSnapshot::STRESS &&
    quantity.array->GetNumberOfComponents() != 6)
    quantity.preset = vtkSnapshot::SCALAR; // one component, already chosen
  if (options.component >= quantity.array->GetNumberOfComponents())
  {
    throw InputError("component " + std::to_string(options.component) + " of '" + name + "' is asked for; it has " +
        std::to_string(quantity.array->GetNumberOfComponents()),
      "count from 0, or −1 for the magnitude");
  }
  if (quantity.array->GetNumberOfTuples() == 0)
    throw InputError("'" + name + "' is empty", "nothing can be drawn of it");
  if (quantity.preset == vtkSnapshot::PHASE || quantity.preset == vtkSnapshot::GRAIN)
  {
    ReadIds(quantity, data, size, options);
    return quantity;
  }
  if (quantity.preset == vtkSnapshot::STRESS && options.component < 0)
    options.component = ComponentAlongLoad(data, quantity.array, size[2] == 1);
  quantity.values = ReadValues(quantity.array, options.component);
  double mean = 0;
  if (quantity.preset == vtkSnapshot::STRESS)
  {
    mean = options.relativeFlux ? MeanStress(data, quantity.values) : 0;
    for (float& value : quantity.values)
      value = mean != 0 ? static_cast<float>(value / mean) : value;
  }
  if (IsOfSolid(quantity))
    HideVoids(quantity, data);
  if (quantity.preset == vtkSnapshot::FLUX)
  {
    HideNonConducting(quantity, data);
    mean = options.relativeFlux && quantity.array->GetNumberOfComponents() > 1 ? MeanFlux(quantity.array) : 0;
    if (mean > 0)
      for (float& value : quantity.values)
        value = static_cast<float>(value / mean);
  }
  if (quantity.preset == vtkSnapshot::PORES)
    TakeLogarithms(quantity);
  FindRange(quantity, options);
  ChooseMap(quantity, options);
  NameQuantity(quantity, mean, options);
  return quantity;
}

Furniture Describe(const Quantity& quantity, const SnapshotOptions& options)
{
  Furniture furniture;
  furniture.title = options.title;
  if (!options.showLegend)
    return furniture;
  if (quantity.IsCategorical())
  {
    for (std::size_t id = 0; id < quantity.idNames.size(); ++id)
      if (!quantity.idNames[id].empty())
        furniture.legend.push_back({ quantity.idNames[id], quantity.idColors[id] });
    if (quantity.preset == vtkSnapshot::GRAIN)
    {
      const std::size_t grains = quantity.idColors.size() - 1;
      furniture.legend.push_back(
        { std::to_string(grains) + (grains == 1 ? " grain" : " grains"), quantity.idColors.back() });
    }
    if (quantity.hasUndefined)
      furniture.legend.push_back({ "not defined", Undefined });
    return furniture;
  }
  furniture.bar = ColorBar{ quantity.map, quantity.low, quantity.high, quantity.logarithmic, quantity.below,
    quantity.above, quantity.title, quantity.unit };
  if (quantity.hasUndefined)
  {
    const bool transport = quantity.preset == vtkSnapshot::TEMPERATURE ||
      quantity.preset == vtkSnapshot::CONCENTRATION || quantity.preset == vtkSnapshot::FLUX;
    furniture.legend.push_back({ transport       ? "does not conduct"
        : quantity.preset == vtkSnapshot::PORES  ? "no pore"
        : quantity.preset == vtkSnapshot::STRESS ? "void"
                                                 : "not defined",
      Undefined });
  }
  return furniture;
}

} // namespace lamella::rendering
