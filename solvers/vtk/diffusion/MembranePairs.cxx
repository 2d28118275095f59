#include "MembranePairs.h"

#include "core/Error.h"
#include "peridynamics/PairTable.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace lamella
{

std::vector<NamedMembrane> namedMembranes(const PhaseIds& phases, const std::map<std::string, double>& resistances,
  const std::map<std::string, double>& permeances)
{
  std::vector<NamedMembrane> membranes;
  const auto add = [&](const std::string& text, double value, bool permeance)
  {
    const auto pair = peridynamics::findPair(text, phases.known);
    if (!pair)
      throw ParameterError("a membrane between '" + text + "', which are not two phases of this sample",
        fmt::format("write two of them with a - between; its phases are {}", fmt::join(phases.known, ", ")));
    if (pair->first == pair->second)
      throw ParameterError("a membrane between '" + phases.known[pair->first] + "' and itself, '" + text + "'",
        "name two different phases with a - between");
    const std::string name = peridynamics::pairText(*pair, phases.known);
    if (!std::isfinite(value) || value < 0 || (permeance && value == 0))
      throw ParameterError(
        fmt::format("the {} of the membrane {} is {:g}", permeance ? "permeance" : "resistance", name, value),
        permeance ? "give a finite number above 0; a very small one lets nothing through"
                  : "give a finite number of at least 0; a very large one lets nothing through");
    const lbm::Membrane membrane{ pair->first, pair->second, permeance ? 1 / value : value };
    if (std::ranges::any_of(membranes, [&](const NamedMembrane& other) { return other.name == name; }))
      throw ParameterError(
        "the membrane " + name + " is given twice", "give every pair one resistance, or one permeance");
    membranes.push_back({ name, membrane, std::max(pair->first, pair->second) < phases.names.size() });
  };
  for (const auto& [text, value] : resistances)
    add(text, value, false);
  for (const auto& [text, value] : permeances)
    add(text, value, true);
  return membranes;
}

} // namespace lamella
