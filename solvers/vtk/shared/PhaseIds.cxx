#include "PhaseIds.h"

#include "vtkLatticeConversion.h"

#include "core/Error.h"
#include "core/Plausible.h"
#include "core/Suggestion.h"
#include "lattice/PhaseNames.h"
#include "pores/PoreLabelling.h"

#include "vtkArrayDispatch.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataArrayRange.h"
#include "vtkDataSet.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkPointData.h"
#include "vtkUnsignedCharArray.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>
#include <sstream>

namespace lamella
{
namespace
{

constexpr std::size_t most = 256;

std::string numberText(double value)
{
  std::ostringstream text;
  text << value;
  return text.str();
}

vtkDataArray* chosenArray(vtkImageData* piece, vtkInformation* choice)
{
  vtkPointData* const points = piece->GetPointData();
  const bool named = choice != nullptr && choice->Has(vtkDataObject::FIELD_NAME());
  if (!named || *choice->Get(vtkDataObject::FIELD_NAME()) == '\0') // an empty choice in a panel
  {
    if (vtkDataArray* const phases = points->GetArray("phase"))
      return phases;
    if (vtkDataArray* const scalars = points->GetScalars())
      return scalars;
    throw InputError("no array of phases is chosen", "choose one with SetInputArrayToProcess");
  }
  const std::string name = choice->Get(vtkDataObject::FIELD_NAME());
  const bool cells = choice->Has(vtkDataObject::FIELD_ASSOCIATION()) &&
    choice->Get(vtkDataObject::FIELD_ASSOCIATION()) == vtkDataObject::FIELD_ASSOCIATION_CELLS;
  vtkDataArray* const array = cells ? nullptr : points->GetArray(name.c_str());
  if (array == nullptr)
  {
    if (piece->GetCellData()->HasArray(name.c_str()))
    {
      throw InputError("array '" + name + "' is cell data; the solver's nodes are the image's points",
        "open the file with Lamella's picture reader, which makes a node of every cell");
    }
    std::string there;
    for (int i = 0; i < points->GetNumberOfArrays(); ++i)
      there += (i > 0 ? ", " : "") + std::string(points->GetArrayName(i) != nullptr ? points->GetArrayName(i) : "?");
    throw InputError("the image has no point array '" + name + "'",
      there.empty() ? "make the image with Lamella's picture reader or microstructure source"
                    : "choose the array of phases; there are: " + there);
  }
  return array;
}

/// Distinct values of an array, and the ids that a sorted table gives them.
struct WholeNumbers
{
  std::set<std::int64_t> distinct;
  bool levels = false; ///< may be made of them
  bool needed = false; ///< have to

  template <typename Array>
  void operator()(Array* array)
  {
    bool first = true;
    double last = 0;
    for (const auto value : vtk::DataArrayValueRange<1>(array))
    {
      const auto number = static_cast<double>(value);
      if (!first && number == last)
        continue;
      if (levels && std::isnan(number))
        throw InputError(
          "array '" + std::string(array->GetName()) + "' holds values that are no numbers", "give every node a grey");
      if (levels && (needed || !(std::abs(number) < 9e15) || number != std::floor(number)))
      {
        needed = true;
        continue; // more may be no numbers
      }
      if (!(std::abs(number) < 9e15) || number != std::floor(number))
      {
        throw InputError(
          "array '" + std::string(array->GetName()) + "' holds " + numberText(number) + "; phases are whole numbers",
          "choose the array of phases, or round this one with the Calculator");
      }
      first = false;
      last = number;
      distinct.insert(static_cast<std::int64_t>(number));
      if (distinct.size() > most)
      {
        needed = true;
        if (!levels)
          return;
      }
    }
  }
};

struct Renumber
{
  const std::vector<std::int64_t>& values;
  std::vector<std::uint8_t>& ids;

  template <typename Array>
  void operator()(Array* array)
  {
    std::size_t node = 0;
    for (const auto value : vtk::DataArrayValueRange<1>(array))
    {
      const auto place = std::lower_bound(values.begin(), values.end(), static_cast<std::int64_t>(value));
      ids[node++] = static_cast<std::uint8_t>(place - values.begin());
    }
  }
};

struct ToLevels
{
  const GreyBins& levels;
  std::vector<std::uint8_t>& ids;

  template <typename Array>
  void operator()(Array* array)
  {
    std::size_t node = 0;
    for (const auto value : vtk::DataArrayValueRange<1>(array))
      ids[node++] = levels.of(static_cast<double>(value));
  }
};

template <typename Worker>
void dispatch(vtkDataArray* array, Worker& worker)
{
  if (!vtkArrayDispatch::Dispatch::Execute(array, worker))
    worker(array);
}

/// The sorted values of all ranks.
std::vector<std::int64_t> shared(const std::set<std::int64_t>& mine, const Team& team)
{
  constexpr std::int64_t none = std::numeric_limits<std::int64_t>::max();
  std::vector<std::int64_t> sent(most + 1, none);
  std::copy(mine.begin(), mine.end(), sent.begin());
  std::vector<std::int64_t> all(sent.size() * static_cast<std::size_t>(team.size()), none);
  if (team.size() > 1)
  {
    const int length = static_cast<int>(sent.size());
    MPI_Allgather(sent.data(), length, MPI_INT64_T, all.data(), length, MPI_INT64_T, team.comm());
  }
  else
  {
    all = sent;
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  if (all.back() == none)
    all.pop_back();
  return all;
}

std::vector<std::string> sharedNames(vtkDataSet* piece, const Team& team)
{
  const std::vector<std::string> mine = fieldTexts(piece, "phase_names");
  std::string text;
  for (const std::string& name : mine)
    text += name + '\0';
  std::vector<std::string> names;
  std::istringstream all(team.share(text, !mine.empty()));
  for (std::string name; std::getline(all, name, '\0');)
    names.push_back(name);
  return names;
}

} // namespace

PhaseIds phaseIds(vtkImageData* piece, vtkInformation* choice, const Team& team, const std::optional<GreyBins>& levels)
{
  return phaseIds(
    piece, [&] { return chosenArray(piece, choice); }, team, levels);
}

PhaseIds phaseIds(vtkDataSet* piece, const std::function<vtkDataArray*()>& find, const Team& team,
  const std::optional<GreyBins>& levels)
{
  PhaseIds result;
  const bool empty = piece->GetNumberOfPoints() == 0;
  vtkDataArray* array = nullptr;
  WholeNumbers numbers;
  numbers.levels = levels.has_value();
  std::array<std::int64_t, 2> seen{ 0, -1 }; // not unsigned char; largest value of unsigned char
  team.agree(
    [&]
    {
      if (empty)
        return;
      array = find();
      result.array = array->GetName() != nullptr ? array->GetName() : "";
      if (array->GetNumberOfComponents() != 1)
        throw InputError("array '" + result.array + "' has " + std::to_string(array->GetNumberOfComponents()) +
            " components; phases are one whole number a node",
          "choose the array of phases");
      if (auto* const bytes = vtkUnsignedCharArray::SafeDownCast(array))
      {
        result.ids = { bytes->GetPointer(0), static_cast<std::size_t>(bytes->GetNumberOfValues()) };
        seen[1] =
          result.ids.empty() ? -1 : static_cast<std::int64_t>(*std::max_element(result.ids.begin(), result.ids.end()));
      }
      else
      {
        seen[0] = 1;
        dispatch(array, numbers);
      }
    });
  team.maximum(seen);
  result.array = team.share(result.array, !empty);
  const std::vector<std::string> named = sharedNames(piece, team);
  if (seen[0] == 0)
  {
    const std::int64_t count = std::max(seen[1] + 1, static_cast<std::int64_t>(std::min(named.size(), most)));
    for (std::int64_t value = 0; value < count; ++value)
      result.values.push_back(value);
  }
  else
  {
    if (!empty && !result.ids.empty()) // unsigned char here, another type on another rank
      dispatch(array, numbers);
    std::array<std::int64_t, 1> needed{ numbers.needed ? 1 : 0 };
    team.maximum(needed);
    if (needed[0] == 0)
      result.values = shared(numbers.distinct, team);
    const bool toLevels = levels && (needed[0] != 0 || result.values.size() > most);
    team.agree(
      [&]
      {
        if (toLevels)
        {
          result.values.clear();
          for (std::size_t level = 0; level < levels->count(); ++level)
          {
            result.values.push_back(static_cast<std::int64_t>(level));
            result.names.push_back(levels->name(level));
          }
          result.own.resize(empty ? 0 : static_cast<std::size_t>(array->GetNumberOfTuples()));
          ToLevels worker{ *levels, result.own };
          if (!empty)
            dispatch(array, worker);
          result.ids = result.own;
          return;
        }
        if (needed[0] != 0 || result.values.size() > most)
          throw InputError("array '" + result.array + "' holds more than 256 different values",
            "choose the array of phases; labels of grains or pores are not phases");
        result.own.resize(empty ? 0 : static_cast<std::size_t>(array->GetNumberOfTuples()));
        if (!empty)
        {
          Renumber renumber{ result.values, result.own };
          dispatch(array, renumber);
        }
        result.ids = result.own;
      });
  }
  for (const std::int64_t value : result.names.empty() ? result.values : std::vector<std::int64_t>())
  {
    const bool known = value >= 0 && static_cast<std::size_t>(value) < named.size();
    result.names.push_back(known ? named[static_cast<std::size_t>(value)] : std::to_string(value));
  }
  result.known = result.names;
  std::copy_if(named.begin(), named.end(), std::back_inserter(result.known),
    [&](const std::string& name)
    { return std::find(result.names.begin(), result.names.end(), name) == result.names.end(); });
  return result;
}

std::uint8_t findVoid(const PhaseIds& phases, const std::string& wanted, const std::string& what)
{
  const std::vector<std::string>& names = phases.names;
  std::string there;
  for (const std::string& name : names)
    there += (there.empty() ? "" : ", ") + name;
  if (wanted.empty())
  {
    if (const auto found = pores::voidPhase(names))
      return static_cast<std::uint8_t>(*found);
    throw ParameterError(
      "no phase is called void, pore, lumen or air", "say which phase the " + what + " are; there are: " + there);
  }
  std::size_t found = phaseMeant(names, wanted).value_or(names.size());
  for (std::size_t id = 0; found == names.size() && id < names.size(); ++id)
    found = std::to_string(phases.values[id]) == wanted ? id : found;
  if (found == names.size())
    throw ParameterError("'" + wanted + "' is no phase of this image",
      suggestion(wanted, names, "its phases are " + quotedList(names, "and")));
  return static_cast<std::uint8_t>(found);
}

void requirePhase(const PhaseIds& phases, const std::string& name, const std::string& message)
{
  if (!phaseMeant(phases.known, name))
    throw ParameterError(message, suggestion(name, phases.known, "its phases are " + quotedList(phases.known, "and")));
}

void requireVoids(const PhaseIds& phases, const std::vector<std::string>& voids)
{
  for (const std::string& name : voids)
    requirePhase(phases, name, "'" + name + "' is to be void, but is no phase of this image");
}

std::optional<double> numberOf(const PhaseIds& phases, const std::map<std::string, double>& table, std::size_t id)
{
  const std::string value = std::to_string(phases.values[id]);
  auto entry = entryOf(table, phases.names, id);
  if (entry == table.end() && std::find(phases.names.begin(), phases.names.end(), value) == phases.names.end())
    entry = table.find(value);
  return entry != table.end() ? std::optional(entry->second) : std::nullopt;
}

std::vector<double> conductivityById(const PhaseIds& phases, const std::map<std::string, double>& table,
  std::span<const std::int64_t> nodes, const std::string& quantity)
{
  std::vector<double> result(phases.values.size(), 0.0);
  std::string all;
  for (std::size_t id = 0; id < result.size(); ++id)
    if (nodes[id] > 0)
      all += (all.empty() ? "" : ", ") + phases.names[id];
  for (std::size_t id = 0; id < result.size(); ++id)
  {
    const std::string& name = phases.names[id];
    if (const std::optional<double> given = numberOf(phases, table, id))
    {
      if (!std::isfinite(*given) || *given < 0)
      {
        throw ParameterError("the " + quantity + " of phase '" + name + "' is " + numberText(*given) +
            "; it must be finite and not negative",
          "give 0 for a phase that does not conduct");
      }
      if (*given != 0 && !plausible(*given))
      {
        throw ParameterError(
          fmt::format("the {} of phase '{}' is {:g}, which is not between 1e-30 and 1e30", quantity, name, *given),
          "no material has it; give 0 for a phase that does not conduct");
      }
      result[id] = *given;
    }
    else if (nodes[id] > 0)
    {
      throw ParameterError("phase '" + name + "' has no " + quantity + " (" + std::to_string(nodes[id]) + " nodes)",
        "give one to each phase of the image: " + all);
    }
  }
  return result;
}

} // namespace lamella
