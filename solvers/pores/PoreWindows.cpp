#include "pores/PoreWindows.h"

#include "lattice/SubWindows.h"

#include <algorithm>
#include <array>

namespace lamella::pores
{
namespace
{

constexpr std::array<const char*, 3> names{ "porosity", "pore_density", "pore_mean" };

std::array<double, names.size()> valuesOf(
  const Lattice& lattice, std::span<const std::uint8_t> phase, std::uint8_t wanted, const LabelOptions& options)
{
  const Communicator alone;
  const PoreLabelling labelling(lattice, alone, phase, wanted, options);
  const PoreSummary& sum = labelling.summary();
  double box = 1;
  for (int a = 0; a < lattice.dimension; ++a)
    box *= lattice.length(a);
  return { static_cast<double>(sum.phaseNodes) / static_cast<double>(lattice.count()),
    static_cast<double>(sum.count) / box, sum.mean() };
}

} // namespace

std::vector<statistics::WindowError> poreWindows(
  const Lattice& lattice, std::span<const std::uint8_t> phase, std::uint8_t wanted, const LabelOptions& options)
{
  LabelOptions own = options;
  own.progress = {};
  const auto image = valuesOf(lattice, phase, wanted, own);
  if (!(image[1] > 0))
    return {};
  const bool repeats = std::ranges::any_of(own.periodic, [](bool p) { return p; });
  own.periodic = { false, false, false };
  own.sortBySize = false;
  std::vector<statistics::WindowProperty> properties(names.size());
  for (const int parts : windowParts)
  {
    const SubWindows cuts = subWindows(lattice, parts);
    if (cuts.windows.size() < 2)
      continue;
    for (statistics::WindowProperty& property : properties)
      property.tilings.push_back({ cuts.counts, {} });
    for (const SubWindow& window : cuts.windows)
    {
      const auto values = valuesOf(latticeOf(lattice, window), cut(lattice, phase, window), wanted, own);
      for (std::size_t i = 0; i < values.size(); ++i)
        properties[i].tilings.back().values.push_back(values[i]);
    }
  }
  if (properties.front().tilings.empty())
    return {};
  for (std::size_t i = 0; i < names.size(); ++i)
  {
    properties[i].name = names[i];
    properties[i].value = image[i];
  }
  properties.back().biasDoubt = 0.5; // means are over a number that is biased itself
  // What sides cut is in proportion to them, but for corners: all of the bias is taken off.
  return statistics::windowErrors(properties, { .biasTaken = 1, .biasDoubt = 0.25, .sameSides = !repeats });
}

} // namespace lamella::pores
