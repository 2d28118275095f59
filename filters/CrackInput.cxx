#include "CrackInput.h"

#include "vtkLatticeConversion.h"

#include "core/Error.h"
#include "cracks/CrackPaths.h"
#include "peridynamics/RimExchange.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <sstream>

namespace lamella
{
namespace
{

using cracks::CutBond;

/// Numbers that a gathered bond is made of.
constexpr int stride = 10;

std::string joined(const std::vector<double>& numbers)
{
  std::ostringstream text;
  text.precision(std::numeric_limits<double>::max_digits10);
  for (const double value : numbers)
    text << value << " ";
  return text.str();
}

/// Collective. Field data of whichever piece has it.
std::vector<double> sharedNumbers(vtkPolyData* piece, const char* name, const Team& team)
{
  const std::vector<double> mine = fieldNumbers(piece, name);
  std::istringstream text(team.share(joined(mine), !mine.empty()));
  std::vector<double> numbers;
  for (double value = 0; text >> value;)
    numbers.push_back(value);
  return numbers;
}

std::vector<std::string> sharedTexts(vtkPolyData* piece, const char* name, const Team& team)
{
  std::string lines;
  for (const std::string& text : fieldTexts(piece, name))
    lines += text + "\n";
  std::istringstream all(team.share(lines, !lines.empty()));
  std::vector<std::string> texts;
  for (std::string line; std::getline(all, line);)
    texts.push_back(line);
  return texts;
}

/// The lattice that the bonds are of. @throws InputError
Lattice latticeFrom(
  const std::vector<double>& size, const std::vector<double>& origin, const std::vector<double>& spacing)
{
  const char* const hint = "give the broken bonds as lamella fracture writes them";
  for (const auto& [name, list] :
    { std::pair{ "lattice_size", &size }, { "lattice_origin", &origin }, { "spacing", &spacing } })
  {
    if (list->size() != 3 || !std::all_of(list->begin(), list->end(), [](double v) { return std::isfinite(v); }))
    {
      throw InputError(
        std::string("the broken bonds do not tell their lattice: their field data has no three numbers '") + name + "'",
        hint);
    }
  }
  std::array<int, 6> extent{};
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    if (!(size[axis] >= 1 && size[axis] <= std::numeric_limits<int>::max()) || size[axis] != std::floor(size[axis]))
      throw InputError("the lattice of the broken bonds has " + joined(size) + "nodes", hint);
    extent[2 * axis + 1] = static_cast<int>(size[axis]) - 1;
  }
  return latticeOf(extent.data(), origin.data(), spacing.data());
}

/// A point array of so many components, finite; null where it is not there and may be missing. @throws InputError
vtkDataArray* arrayOf(vtkPolyData* piece, const char* name, int components, bool needed)
{
  vtkDataArray* const array = piece->GetPointData()->GetArray(name);
  if (array == nullptr)
  {
    if (needed && piece->GetCellData()->HasArray(name))
    {
      throw InputError(
        std::string("array '") + name + "' is cell data, not point data", "broken bonds are points with a vertex each");
    }
    if (needed)
    {
      throw InputError(std::string("the points have no array '") + name + "'",
        "give the broken bonds that lamella fracture writes (.vtp)");
    }
    return nullptr;
  }
  if (array->GetNumberOfComponents() != components)
  {
    throw InputError(std::string("array '") + name + "' has " + std::to_string(array->GetNumberOfComponents()) +
        " components, not " + std::to_string(components),
      "give the broken bonds that lamella fracture writes (.vtp)");
  }
  for (vtkIdType i = 0; i < array->GetNumberOfTuples(); ++i)
  {
    for (int c = 0; c < components; ++c)
    {
      if (!std::isfinite(array->GetComponent(i, c)))
      {
        throw InputError(
          std::string("array '") + name + "' is not finite at point " + std::to_string(i), "leave such bonds out");
      }
    }
  }
  return array;
}

/// Arrays of a piece.
struct Arrays
{
  vtkDataArray* bond = nullptr;
  vtkDataArray* event = nullptr;
  vtkDataArray* when = nullptr;
  vtkDataArray* phases = nullptr;
  vtkDataArray* between = nullptr;

  explicit Arrays(vtkPolyData* piece)
    : bond(arrayOf(piece, "bond", 3, true))
    , event(arrayOf(piece, "event", 1, false))
    , phases(arrayOf(piece, "phases", 2, false))
    , between(arrayOf(piece, "between_grains", 1, false))
  {
    for (const char* const name : { "time", "strain" })
      when = when == nullptr ? arrayOf(piece, name, 1, false) : when;
    event = event == nullptr ? arrayOf(piece, "step", 1, false) : event;
  }
};

/// The bonds of a piece as numbers. @throws InputError for one that joins no two nodes of the lattice
std::vector<std::int64_t> packed(vtkPolyData* piece, const Arrays& arrays, const Lattice& lattice)
{
  std::vector<std::int64_t> numbers;
  numbers.reserve(static_cast<std::size_t>(stride * piece->GetNumberOfPoints()));
  for (vtkIdType i = 0; i < piece->GetNumberOfPoints(); ++i)
  {
    double middle[3];
    double bond[3];
    piece->GetPoint(i, middle);
    arrays.bond->GetTuple(i, bond);
    std::array<double, 6> place{};
    bool sound = false;
    for (std::size_t a = 0; a < 3; ++a)
    {
      place[a] = (middle[a] - bond[a] / 2 - lattice.origin[a]) / lattice.spacing;
      place[3 + a] = bond[a] / lattice.spacing;
      sound = sound || std::round(place[3 + a]) != 0;
    }
    for (const double value : place)
    {
      constexpr double slack = 0.05; // single precision far from the origin
      sound = sound && std::abs(value - std::round(value)) < slack && std::abs(value) < 1e9;
    }
    if (!sound)
    {
      throw InputError("the broken bond at point " + std::to_string(i) + " joins no two nodes of the lattice",
        "give points at the middles of bonds, with the array 'bond' from one node to the other [m]");
    }
    for (const double value : place)
      numbers.push_back(std::llround(value));
    const auto event = arrays.event != nullptr ? std::llround(arrays.event->GetTuple1(i)) : 0;
    numbers.push_back(event);
    numbers.push_back(
      std::bit_cast<std::int64_t>(arrays.when != nullptr ? arrays.when->GetTuple1(i) : static_cast<double>(event)));
    const auto phase = [&](int c)
    { return arrays.phases != nullptr ? std::llround(arrays.phases->GetComponent(i, c)) & 255 : 0; };
    numbers.push_back(256 * std::max(phase(0), phase(1)) + std::min(phase(0), phase(1)));
    numbers.push_back(arrays.between != nullptr && arrays.between->GetTuple1(i) != 0 ? 1 : 0);
  }
  return numbers;
}

CutBond unpacked(const std::int64_t* n)
{
  CutBond b;
  for (std::size_t a = 0; a < 3; ++a)
  {
    b.node[a] = n[a];
    b.step[a] = static_cast<int>(n[3 + a]);
  }
  b.event = n[6];
  b.when = std::bit_cast<double>(n[7]);
  b.phases = { static_cast<std::uint8_t>(n[8] % 256), static_cast<std::uint8_t>(n[8] / 256) };
  b.betweenGrains = n[9] != 0;
  return b;
}

} // namespace

CrackInput crackInput(vtkPolyData* piece, double horizon, const Team& team)
{
  CrackInput input;
  const std::vector<double> size = sharedNumbers(piece, "lattice_size", team);
  const std::vector<double> origin = sharedNumbers(piece, "lattice_origin", team);
  const std::vector<double> spacing = sharedNumbers(piece, "spacing", team);
  const std::vector<double> given = sharedNumbers(piece, "horizon", team);
  input.phases = sharedTexts(piece, "phase_names", team);
  std::vector<std::int64_t> mine;
  std::string when;
  bool phases = false;
  team.agree(
    [&]
    {
      input.lattice = latticeFrom(size, origin, spacing);
      input.horizon = horizon > 0 ? horizon : given.empty() ? 0 : given[0];
      if (!(input.horizon > 0))
        throw InputError("the broken bonds do not tell their horizon", "give it in spacings");
      if (piece->GetNumberOfPoints() > 0)
      {
        const Arrays arrays(piece);
        mine = packed(piece, arrays, input.lattice);
        when = arrays.when != nullptr ? arrays.when->GetName() : "event";
        phases = arrays.phases != nullptr;
      }
    });
  input.when = team.share(when, !when.empty());
  if (!team.any(phases))
    input.phases.clear();
  const std::vector<std::int64_t> all = peridynamics::gather(Communicator(team.comm()), mine, stride);
  for (std::size_t i = 0; i < all.size(); i += stride)
    input.bonds.push_back(unpacked(all.data() + i));
  input.bonds = cracks::canonical(std::move(input.bonds));
  if (team.any(phases))
  {
    std::size_t most = 0;
    for (const CutBond& b : input.bonds)
      most = std::max<std::size_t>(most, b.phases[1]);
    while (input.phases.size() <= most)
      input.phases.push_back(std::to_string(input.phases.size()));
  }
  return input;
}

} // namespace lamella
