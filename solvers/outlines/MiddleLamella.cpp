#include "outlines/MiddleLamella.h"

#include "core/Error.h"
#include "outlines/LamellaGrowth.h"
#include "outlines/LamellaNetwork.h"
#include "outlines/LamellaPhases.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lamella::micrograph
{
namespace
{

/// Compound middle lamella of spruce, early- and latewood alike, as traced at half a micrometre a pixel [m].
constexpr double kCompound = 0.5e-6;

void warn(const LamellaOptions& options, std::int64_t lost, MiddleLamella& result)
{
  const double wanted = std::max(options.horizon, 1.0);
  if (result.across.low < wanted || result.joined > 0)
  {
    result.warnings.push_back(
      fmt::format("the middle lamella is {:.2g} nodes thick (5 % of it {:.2g} or less){}: take a "
                  "spacing of {:.2g} m, or a thicker lamella",
        result.across.mean, result.across.low,
        options.horizon > 0 ? fmt::format(", thinner than the horizon of {:g}", options.horizon) : "",
        result.thickness / (wanted + 1)));
  }
  if (lost > 0)
  {
    result.warnings.push_back(
      fmt::format("{} links lead from one lumen straight into another: walls there are thinner than a node", lost));
  }
  if (result.cellsTouched < result.cells)
  {
    result.warnings.push_back(fmt::format("{} of {} cells are not touched by the middle lamella's network ({} parts, "
                                          "{:.1f} % of it in the largest){}",
      result.cells - result.cellsTouched, result.cells, result.networks, 100 * result.largestNetwork,
      lost > 0 ? ": take a smaller spacing" : ""));
  }
}

/// Where the middle is nearer than half the thickness.
void constantLamella(
  const ContourLattice& lattice, const WallDirections& directions, double thickness, std::span<std::uint8_t> phase)
{
  for (std::size_t node = 0; node < phase.size(); ++node)
    if (lattice.image.phase[node] != 0 && directions.middle[node] < thickness / 2)
      phase[node] = kLamella;
}

} // namespace

double usualLamella(double median)
{
  return std::min(kCompound, median / 8);
}

MiddleLamella middleLamella(
  const ContourLattice& lattice, const WallDirections& directions, const LamellaOptions& options)
{
  const double thickness = options.thickness.value_or(usualLamella(lattice.thickness.median));
  const double radius = options.radius.value_or(lattice.thickness.median / 4);
  if (!(lattice.thickness.median > 0))
    throw InputError("a picture with fewer than two lumens has no middle lamella", "take a larger part of the picture");
  if (!(thickness > 0) || !std::isfinite(thickness))
  {
    throw ParameterError(
      fmt::format("a middle lamella {} m thick", thickness), "give a thickness in metres, such as 5e-7");
  }
  if (!(radius >= 0) || !std::isfinite(radius))
  {
    throw ParameterError(
      fmt::format("cells with corners of radius {} m", radius), "give a radius in metres, or 0 for sharp corners");
  }
  if (!(options.horizon >= 0) || !std::isfinite(options.horizon))
  {
    throw ParameterError(fmt::format("a horizon of {} nodes", options.horizon),
      "give the nodes wanted across the lamella, such as 3, or 0");
  }
  MiddleLamella result;
  result.thickness = thickness;
  result.radius = options.method == LamellaMethod::Growth ? radius : 0;
  std::vector<std::uint8_t> phase(lattice.image.phase.size());
  std::transform(lattice.image.phase.begin(), lattice.image.phase.end(), phase.begin(),
    [](std::uint8_t wall) { return wall != 0 ? kSecondary : kVoid; });
  if (options.method == LamellaMethod::Growth)
    growLamella(lattice, directions, thickness, radius, phase);
  else
    constantLamella(lattice, directions, thickness, phase);
  result.joined = joinLamella(lattice, directions, phase);
  result.image = { lattice.image.lattice, std::move(phase), PhaseTable({ "lumen", "wall", "middle lamella" }) };
  const std::vector<double> shares = result.image.fractions();
  result.wallShare = shares[kLamella] / std::max(shares[kLamella] + shares[kSecondary], 1e-300);
  result.across = nodesAcross(lattice, directions, result.image.phase);
  countNetworks(lattice, directions, result);
  warn(options, lostWalls(lattice, directions), result);
  return result;
}

} // namespace lamella::micrograph
