#include "elasticity/WindowStiffness.h"

#include "core/Error.h"
#include "lattice/SubWindows.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace lamella::elasticity
{
namespace
{

/// The diagonal, and where there are any the constants.
std::vector<double> valuesOf(const VoxelStiffness& found, std::size_t components)
{
  std::vector<double> values;
  for (std::size_t i = 0; i < components; ++i)
    values.push_back(found.stiffness[i * (components + 1)]);
  for (const double v : constantValues(found.constants))
    values.push_back(v);
  return values;
}

/// The axis that slabs are in series along: that of a stretch.
std::optional<std::size_t> seriesAxis(const std::string& name)
{
  if (name.size() == 2 && name[0] == name[1])
    return static_cast<std::size_t>(name[0] - 'x');
  if (name.size() == 3 && name.starts_with("E_"))
    return static_cast<std::size_t>(name[2] - 'x');
  return std::nullopt;
}

} // namespace

std::vector<statistics::WindowError> stiffnessWindows(const Lattice& lattice, std::span<const std::uint8_t> phase,
  const std::vector<VoxelMaterial>& materials, std::span<const std::array<float, 3>> axis,
  const VoxelStiffnessOptions& options, const VoxelStiffness& box)
{
  const auto components = static_cast<std::size_t>(lattice.dimension == 3 ? 6 : 3);
  std::vector<std::string> names = voigtNames(lattice.dimension);
  for (const std::string& name : constantNames(lattice.dimension))
    names.push_back(name);
  VoxelStiffnessOptions own = options;
  own.sides = StiffnessSides::Straight;
  own.load.reset();
  own.fields = {};
  own.numbers = 0;
  own.surfaces = false;
  own.estimateError = false;
  own.windowError = false;
  own.nodesPerPixel = 1;
  own.tolerance = std::max(options.tolerance, 2 * windowTolerance);

  const std::vector<double> whole = valuesOf(box, components);
  std::vector<statistics::WindowProperty> all(whole.size());
  double done = 1.0 / (1 + windowParts.size());
  for (const int parts : windowParts)
  {
    const SubWindows cuts = subWindows(lattice, parts);
    if (cuts.windows.size() < 2)
      continue;
    for (statistics::WindowProperty& property : all)
      property.tilings.push_back({ cuts.counts, {} });
    const double each = 1.0 / (1 + windowParts.size()) / static_cast<double>(cuts.windows.size());
    for (const SubWindow& window : cuts.windows)
    {
      own.progress = [&](double share) { return !options.progress || options.progress(done + each * share); };
      const std::vector<std::uint8_t> ids = cut(lattice, phase, window);
      std::vector<std::array<float, 3>> axes;
      if (!axis.empty())
        axes = cut(lattice, axis, window);
      std::vector<double> values(whole.size(), 0.0);
      try
      {
        values = valuesOf(studyVoxelStiffness(latticeOf(lattice, window), ids, materials, axes, own), components);
      }
      catch (const NoPathError&) // nothing carries
      {
        for (std::size_t i = components; i < values.size(); ++i)
          if (names[i].starts_with("nu"))
            values[i] = std::numeric_limits<double>::quiet_NaN();
      }
      for (std::size_t i = 0; i < values.size(); ++i)
        all[i].tilings.back().values.push_back(values[i]);
      done += each;
    }
  }
  std::vector<statistics::WindowProperty> known;
  for (std::size_t i = 0; i < all.size(); ++i)
  {
    all[i].name = names[i];
    all[i].value = whole[i];
    all[i].seriesAxis = seriesAxis(names[i]);
    if (between(options.sides) && !names[i].starts_with("E_"))
      continue; // platens tell moduli alone
    const bool finite = std::isfinite(whole[i]) && !all[i].tilings.empty() &&
      std::ranges::all_of(all[i].tilings,
        [](const statistics::WindowTiling& t)
        { return std::ranges::all_of(t.values, [](double v) { return std::isfinite(v); }); });
    if (finite)
      known.push_back(std::move(all[i]));
  }
  return statistics::windowErrors(known, { .sameSides = options.sides == StiffnessSides::Straight });
}

} // namespace lamella::elasticity
