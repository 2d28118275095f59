#include "WallConductivity.h"

#include "BoxExchange.h"

#include "core/Error.h"

#include <fmt/format.h>

#include "vtkDataArray.h"

#include <algorithm>
#include <cmath>

namespace lamella
{

PhaseImage gatherPhases(const Lattice& lattice, const lbm::Block& held, const PhaseIds& phases, const Team& team)
{
  PhaseImage image{ lattice, std::vector<std::uint8_t>(static_cast<std::size_t>(lattice.count())),
    PhaseTable(phases.names) };
  const lbm::Block everything{ { 0, 0, 0 }, lattice.size };
  BoxExchange(lattice, held, everything, { false, false, false }, team.comm(), team.size())
    .run<std::uint8_t>(phases.ids, image.phase);
  return image;
}

std::vector<std::array<float, 3>> gatherAxes(
  const Lattice& lattice, const lbm::Block& held, vtkDataArray* array, const Team& team)
{
  using Axis = std::array<float, 3>;
  std::vector<Axis> own(static_cast<std::size_t>(held.count()));
  for (std::size_t i = 0; i < (array != nullptr ? own.size() : 0); ++i)
  {
    const auto node = static_cast<vtkIdType>(i);
    for (int k = 0; k < std::min(3, array->GetNumberOfComponents()); ++k)
      own[i][static_cast<std::size_t>(k)] = static_cast<float>(array->GetComponent(node, k));
  }
  std::vector<Axis> all(static_cast<std::size_t>(lattice.count()));
  const lbm::Block everything{ { 0, 0, 0 }, lattice.size };
  BoxExchange(lattice, held, everything, { false, false, false }, team.comm(), team.size()).run<Axis>(own, all);
  return all;
}

std::vector<double> acrossById(const PhaseIds& phases, const std::map<std::string, double>& along,
  const std::map<std::string, double>& across, std::span<const std::int64_t> nodes)
{
  std::map<std::string, double> table = along;
  for (const auto& [phase, value] : across)
  {
    const auto entry = table.find(phase);
    if (entry == table.end())
    {
      throw ParameterError("phase '" + phase + "' has a conductivity across the wall and none along it",
        "give both by the same name, or by the same number");
    }
    entry->second = value;
  }
  const std::vector<double> first = conductivityById(phases, along, nodes);
  std::vector<double> second = conductivityById(phases, table, nodes);
  for (std::size_t id = 0; id < first.size(); ++id)
    if (nodes[id] > 0 && first[id] != second[id])
      return second;
  return {};
}

std::vector<double> uncertaintyById(const PhaseIds& phases, const std::map<std::string, double>& conductivity,
  const std::map<std::string, double>* across, const std::map<std::string, double>& given,
  std::span<const std::int64_t> nodes)
{
  if (given.empty())
    return {};
  std::vector<double> result(phases.names.size(), 0.0);
  for (const auto& [phase, value] : given)
  {
    if (!(across ? *across : conductivity).contains(phase))
      throw ParameterError("phase '" + phase + "' has an uncertainty and no conductivity that it is of",
        "give both by the same name, or by the same number");
    if (!std::isfinite(value) || value < 0)
      throw ParameterError(
        fmt::format("the uncertainty of the conductivity of phase '{}' is {}", phase, value), "give 0 or more");
    std::map<std::string, double> one;
    for (const auto& [name, k] : conductivity)
      one[name] = name == phase ? value : 0;
    const std::vector<double> byId = conductivityById(phases, one, nodes, "uncertainty");
    for (std::size_t id = 0; id < result.size(); ++id)
      result[id] += byId[id];
  }
  return result;
}

} // namespace lamella
