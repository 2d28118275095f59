#include "StressInput.h"

#include "PhaseIds.h"
#include "vtkLatticeConversion.h"

#include "core/Error.h"
#include "lattice/PhaseNames.h"
#include "statistics/StressDistribution.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkPointData.h"
#include "vtkRectilinearGrid.h"
#include "vtkSMPTools.h"
#include "vtkStructuredGrid.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lamella
{
namespace
{

using statistics::noGroup;

std::string nameOf(vtkInformation* choice)
{
  return choice != nullptr && choice->Has(vtkDataObject::FIELD_NAME()) ? choice->Get(vtkDataObject::FIELD_NAME()) : "";
}

int associationOf(vtkInformation* choice)
{
  return choice != nullptr && choice->Has(vtkDataObject::FIELD_ASSOCIATION())
    ? choice->Get(vtkDataObject::FIELD_ASSOCIATION())
    : vtkDataObject::FIELD_ASSOCIATION_POINTS;
}

vtkDataSetAttributes* attributes(vtkDataSet* piece, bool cells)
{
  return cells ? static_cast<vtkDataSetAttributes*>(piece->GetCellData()) : piece->GetPointData();
}

std::string arraysOf(vtkDataSet* piece)
{
  std::string list;
  for (const bool cells : { false, true })
  {
    vtkDataSetAttributes* const data = attributes(piece, cells);
    for (int i = 0; i < data->GetNumberOfArrays(); ++i)
    {
      const char* const name = data->GetArrayName(i);
      list += (list.empty() ? "" : ", ") + std::string(name != nullptr ? name : "?") + (cells ? " (cells)" : "");
    }
  }
  return list;
}

/// The chosen array, and whether it is of cells. @throws InputError
std::pair<vtkDataArray*, bool> find(vtkDataSet* piece, vtkInformation* choice)
{
  const std::string name = nameOf(choice);
  if (name.empty())
    throw InputError("no array of stresses is chosen", "choose one with SetInputArrayToProcess");
  const int association = associationOf(choice);
  vtkDataArray* const atPoints = attributes(piece, false)->GetArray(name.c_str());
  vtkDataArray* const atCells = attributes(piece, true)->GetArray(name.c_str());
  const bool either = association == vtkDataObject::FIELD_ASSOCIATION_POINTS_THEN_CELLS;
  const bool cells = association == vtkDataObject::FIELD_ASSOCIATION_CELLS || (either && atPoints == nullptr);
  vtkDataArray* const found = cells ? atCells : atPoints;
  if (found == nullptr)
  {
    const char* const kind = cells ? "cell" : "point";
    if (atPoints != nullptr || atCells != nullptr)
    {
      throw InputError("array '" + name + "' is " + (cells ? "point" : "cell") + " data, not " + kind + " data",
        std::string("choose it as an array of ") + (cells ? "points" : "cells"));
    }
    const std::string there = arraysOf(piece);
    throw InputError("the data has no array '" + name + "'",
      there.empty() ? "it has no arrays at all: compute stresses first" : "choose the stresses; there are: " + there);
  }
  return { found, cells };
}

/// Which points of a piece of a structured grid lie in a piece of a lower rank, too. Collective.
void dropShared(vtkDataSet* piece, std::vector<std::uint8_t>& group, const Team& team)
{
  const int* extent = nullptr;
  if (auto* const image = vtkImageData::SafeDownCast(piece))
    extent = image->GetExtent();
  else if (auto* const rectilinear = vtkRectilinearGrid::SafeDownCast(piece))
    extent = rectilinear->GetExtent();
  else if (auto* const structured = vtkStructuredGrid::SafeDownCast(piece))
    extent = structured->GetExtent();
  std::array<int, 6> mine{ 0, -1, 0, -1, 0, -1 };
  if (extent != nullptr && piece->GetNumberOfPoints() > 0)
    std::copy_n(extent, 6, mine.begin());
  std::vector<std::array<int, 6>> all(static_cast<std::size_t>(team.size()), mine);
  MPI_Allgather(mine.data(), 6, MPI_INT, all.data(), 6, MPI_INT, team.comm());
  for (int rank = 0; rank < team.rank(); ++rank)
  {
    const std::array<int, 6>& other = all[static_cast<std::size_t>(rank)];
    std::array<int, 6> both{};
    for (std::size_t axis = 0; axis < 6; axis += 2)
    {
      both[axis] = std::max(mine[axis], other[axis]);
      both[axis + 1] = std::min(mine[axis + 1], other[axis + 1]);
    }
    for (int z = both[4]; z <= both[5]; ++z)
    {
      for (int y = both[2]; y <= both[3]; ++y)
      {
        for (int x = both[0]; x <= both[1]; ++x)
        {
          const auto row = static_cast<std::size_t>(mine[3] - mine[2] + 1) * static_cast<std::size_t>(z - mine[4]) +
            static_cast<std::size_t>(y - mine[2]);
          group[row * static_cast<std::size_t>(mine[1] - mine[0] + 1) + static_cast<std::size_t>(x - mine[0])] =
            noGroup;
        }
      }
    }
  }
}

/// Leaves out the points of an image in the layers that vtkBondEquilibrium's platens hold.
void dropPlatens(vtkImageData* image, const WholeImage& whole, std::vector<std::uint8_t>& group)
{
  const std::vector<double> layers = fieldNumbers(image, "platen_layers");
  const std::string axisName = fieldText(image, "load_axis").value_or("");
  if (layers.size() != 4 || axisName.size() != 1 || axisName[0] < 'x' || axisName[0] > 'z')
    return;
  const auto axis = static_cast<std::size_t>(axisName[0] - 'x');
  const int* const extent = image->GetExtent();
  std::size_t node = 0;
  std::array<int, 3> at{};
  for (at[2] = extent[4]; at[2] <= extent[5]; ++at[2])
  {
    for (at[1] = extent[2]; at[1] <= extent[3]; ++at[1])
    {
      for (at[0] = extent[0]; at[0] <= extent[1]; ++at[0], ++node)
      {
        const int layer = at[axis] - whole.extent[2 * axis];
        if ((layer >= layers[0] && layer <= layers[1]) || (layer >= layers[2] && layer <= layers[3]))
          group[node] = noGroup;
      }
    }
  }
}

/// Leaves out what another rank counts and what is blanked.
void dropGhosts(vtkDataSet* piece, bool cells, bool structured, std::vector<std::uint8_t>& group)
{
  auto* const ghosts =
    vtkUnsignedCharArray::SafeDownCast(attributes(piece, cells)->GetArray(vtkDataSetAttributes::GhostArrayName()));
  if (ghosts == nullptr)
    return;
  // Points of structured pieces are shared out by their extents, whether they are marked or not.
  const unsigned char marks = cells
    ? vtkDataSetAttributes::DUPLICATECELL | vtkDataSetAttributes::HIDDENCELL
    : (structured ? 0 : vtkDataSetAttributes::DUPLICATEPOINT) | vtkDataSetAttributes::HIDDENPOINT;
  for (std::size_t i = 0; i < group.size(); ++i)
    if ((ghosts->GetValue(static_cast<vtkIdType>(i)) & marks) != 0)
      group[i] = noGroup;
}

std::string listed(const std::vector<std::string>& names)
{
  std::string list;
  for (const std::string& name : names)
    list += (list.empty() ? "" : ", ") + name;
  return list;
}

/// By id of a phase, its place among those that are counted, or noGroup.
/// @throws ParameterError for a phase that the data does not know
std::vector<std::uint8_t> choosePhases(
  const PhaseIds& phases, std::span<const std::string> wanted, std::vector<std::string>& names)
{
  std::vector<bool> counted(phases.names.size(), false);
  if (wanted.empty()) // all that a solver takes for solid
  {
    std::transform(phases.names.begin(), phases.names.end(), counted.begin(),
      [](const std::string& name) { return !isVoidName(name); });
    if (std::find(counted.begin(), counted.end(), true) == counted.end())
      counted.assign(counted.size(), true);
  }
  for (const std::string& name : wanted)
  {
    std::size_t found = phaseMeant(phases.names, name).value_or(phases.names.size());
    for (std::size_t id = 0; found == phases.names.size() && id < phases.names.size(); ++id)
      found = std::to_string(phases.values[id]) == name ? id : found;
    if (found == phases.names.size())
    {
      throw ParameterError(
        "'" + name + "' is no phase of this data", "choose some of its phases: " + listed(phases.names));
    }
    counted[found] = true;
  }
  std::vector<std::uint8_t> place(phases.names.size(), noGroup);
  for (std::size_t id = 0; id < place.size(); ++id)
  {
    if (counted[id])
    {
      if (names.size() == noGroup)
        throw ParameterError("there are more than 255 phases to count", "choose some of them");
      place[id] = static_cast<std::uint8_t>(names.size());
      names.push_back(phases.names[id]);
    }
  }
  return place;
}

/// The number of each tensor that counts, on all threads.
void measureAll(vtkDataArray* array, statistics::StressMeasure what, StressInput& input)
{
  const int components = array->GetNumberOfComponents();
  vtkSMPTools::For(0, array->GetNumberOfTuples(),
    [&](vtkIdType begin, vtkIdType end)
    {
      std::array<double, 9> t{};
      for (vtkIdType i = begin; i < end; ++i)
      {
        const auto place = static_cast<std::size_t>(i);
        if (input.group[place] == noGroup)
          continue;
        array->GetTuple(i, t.data());
        if (components == 1)
        {
          input.values[place] = t[0];
          continue;
        }
        const statistics::SymmetricTensor tensor = components == 6
          ? statistics::SymmetricTensor{ t[0], t[1], t[2], t[3], t[4], t[5] }
          : statistics::SymmetricTensor{ t[0], t[4], t[8], (t[1] + t[3]) / 2, (t[5] + t[7]) / 2, (t[2] + t[6]) / 2 };
        const bool finite =
          std::all_of(tensor.begin(), tensor.end(), [](double component) { return std::isfinite(component); });
        input.values[place] = finite ? statistics::measure(tensor, what) : std::numeric_limits<double>::quiet_NaN();
      }
    });
}

} // namespace

StressInput stressInput(vtkDataSet* piece, vtkInformation* stress, vtkInformation* phase,
  std::span<const std::string> wanted, bool leaveOutPlatens, statistics::StressMeasure measure, const Team& team)
{
  StressInput input;
  const bool empty = piece->GetNumberOfPoints() == 0;
  if (!team.any(!empty))
    throw InputError("the data has no points", "check that the source before it worked");
  vtkDataArray* array = nullptr;
  bool cells = false;
  std::array<std::int64_t, 1> phases{ 0 }; // whether there are any
  team.agree(
    [&]
    {
      if (empty)
        return;
      std::tie(array, cells) = find(piece, stress);
      input.array = array->GetName();
      input.components = array->GetNumberOfComponents();
      if (input.components != 1 && input.components != 6 && input.components != 9)
        throw InputError("array '" + input.array + "' has " + std::to_string(input.components) + " components",
          "a stress has 6 (xx, yy, zz, xy, yz, xz), 9, or 1 that was computed from them");
      const std::string name = nameOf(phase);
      const bool there = !name.empty() && attributes(piece, cells)->GetArray(name.c_str()) != nullptr;
      phases[0] = there ? 1 : 0;
      if (!there && ((!name.empty() && name != "phase") || !wanted.empty()))
        throw InputError(
          "there are no phases: the data has no " + std::string(cells ? "cell" : "point") + " array '" + name + "'",
          "choose the array of phases; there are: " + arraysOf(piece));
    });
  team.maximum(phases);
  input.array = team.share(input.array, !empty);
  input.hasPhases = phases[0] != 0;
  const std::size_t count = empty ? 0 : static_cast<std::size_t>(array->GetNumberOfTuples());
  input.group.assign(count, 0);
  input.values.assign(count, 0.0);
  if (input.hasPhases)
  {
    const PhaseIds ids = phaseIds(
      piece,
      [&]
      {
        const std::string name = nameOf(phase);
        vtkDataArray* const found = attributes(piece, cells)->GetArray(name.c_str());
        if (found == nullptr)
          throw InputError("a piece of the data has no array '" + name + "'", "give every piece the same arrays");
        return found;
      },
      team);
    const std::vector<std::uint8_t> place = choosePhases(ids, wanted, input.phases);
    std::transform(ids.ids.begin(), ids.ids.end(), input.group.begin(), [&](std::uint8_t id) { return place[id]; });
  }
  else
  {
    input.phases = { "" };
  }
  auto* const image = vtkImageData::SafeDownCast(piece);
  const bool platens =
    leaveOutPlatens && image != nullptr && !empty && !cells && !fieldNumbers(image, "platen_layers").empty();
  if (team.any(platens))
  {
    const WholeImage whole = wholeImage(image, team);
    if (platens)
      dropPlatens(image, whole, input.group);
  }
  const bool structured =
    piece->IsA("vtkImageData") || piece->IsA("vtkRectilinearGrid") || piece->IsA("vtkStructuredGrid");
  std::array<std::int64_t, 1> atPoints{ !empty && !cells && structured ? 1 : 0 };
  team.maximum(atPoints);
  if (team.size() > 1 && atPoints[0] != 0)
    dropShared(piece, input.group, team);
  dropGhosts(piece, cells, structured && team.size() > 1, input.group);
  if (!empty)
    measureAll(array, measure, input);
  return input;
}

} // namespace lamella
