#include "outlines/ContourExtraction.h"

#include "core/Error.h"
#include "outlines/ContourBorder.h"
#include "outlines/ContourEdit.h"
#include "outlines/ContourMeasures.h"
#include "outlines/ContourSmoothing.h"
#include "outlines/ContourTracing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lamella::micrograph
{
namespace
{

void check(const PhaseImage& image, std::uint8_t lumen, std::span<const float> level, const ExtractOptions& options)
{
  const Lattice& lattice = image.lattice;
  if (lattice.dimension != 2)
    throw ParameterError("contours of a volume were asked for", "give one slice of it");
  if (lattice.count() <= 0 || static_cast<std::int64_t>(image.phase.size()) != lattice.count() ||
    !(lattice.spacing > 0) || !std::isfinite(lattice.spacing))
  {
    throw ParameterError(fmt::format("{} phases on {} × {} nodes of spacing {:g} m", image.phase.size(),
                           lattice.size[0], lattice.size[1], lattice.spacing),
      "give one phase a node and a positive spacing");
  }
  if (lumen >= image.phases.size())
  {
    throw ParameterError(fmt::format("there is no phase {} to be the lumen", lumen),
      fmt::format("the picture has {} phases", image.phases.size()));
  }
  if (!level.empty())
  {
    if (static_cast<std::int64_t>(level.size()) != lattice.count())
    {
      throw ParameterError(
        fmt::format("the level has {} values for {} nodes", level.size(), lattice.count()), "give one a node");
    }
    if (!std::all_of(level.begin(), level.end(), [](float v) { return std::isfinite(v); }))
      throw ParameterError("the level has values that are no finite numbers", "give finite ones, above 0 in lumens");
  }
  if (!(options.wavelength >= 4 && options.wavelength <= 200))
  {
    throw ParameterError(
      fmt::format("the smoothing wavelength is {:g} pixels", options.wavelength), "give one from 4 to 200");
  }
  if (!(options.tolerance >= 0 && options.tolerance <= 10))
  {
    throw ParameterError(
      fmt::format("the tolerance for leaving out points is {:g} pixels", options.tolerance), "give one from 0 to 10");
  }
}

[[nodiscard]] Contour contourOf(const Trace& trace, double spacing)
{
  Contour c;
  c.closed = trace.closed;
  c.points.reserve(trace.crossings.size());
  for (const Crossing& k : trace.crossings)
    c.points.push_back({ k.px() * spacing, k.py() * spacing });
  return c;
}

} // namespace

std::vector<std::string> ExtractReport::lines() const
{
  std::vector<std::string> text;
  text.push_back(fmt::format("{} lumens, {} of them cut by the border", lumens, openLumens));
  if (islands > 0)
  {
    text.push_back(fmt::format("{} pieces of wall inside lumens taken out{}", islands,
      nestedLumens > 0 ? fmt::format(", with {} lumens in them", nestedLumens) : std::string{}));
  }
  if (small > 0)
    text.push_back(fmt::format("{} lumens below the smallest area became wall", small));
  if (ragged > 0)
    text.push_back(fmt::format("{} lumens below the least solidity became wall", ragged));
  text.push_back(fmt::format("{} points, of {} crossings", points, crossings));
  text.push_back(fmt::format("wall fraction {:.4f}", wallFraction));
  return text;
}

Extraction extractContours(
  const PhaseImage& image, std::uint8_t lumen, std::span<const float> level, const ExtractOptions& options)
{
  check(image, lumen, level, options);
  const double spacing = image.lattice.spacing;
  std::vector<std::uint8_t> mask(image.phase.size());
  std::transform(image.phase.begin(), image.phase.end(), mask.begin(),
    [&](std::uint8_t p) { return static_cast<std::uint8_t>(p == lumen); });
  const std::string& name = image.phases.name(lumen);
  if (std::find(mask.begin(), mask.end(), 1) == mask.end())
  {
    throw InputError(fmt::format("the picture has no lumen: no node of phase '{}'", name),
      "choose another phase for the lumens, or segment the picture with another threshold");
  }
  if (std::find(mask.begin(), mask.end(), 0) == mask.end())
  {
    throw InputError(fmt::format("the picture has no wall: every node is of phase '{}'", name),
      "choose another phase for the lumens, or segment the picture with another threshold");
  }
  SmoothingScale scale;
  scale.wavelength = options.wavelength;
  Traces traces = traceOutlines(image.lattice, mask, level, scale.margin);
  if (traces.borderIsLumen)
  {
    throw InputError(fmt::format("one lumen of phase '{}' runs along the whole border and holds all walls", name),
      "cut the picture to the tissue, or exchange lumen and wall");
  }

  Extraction result;
  ExtractReport& report = result.report;
  report.islands = traces.islands;
  report.islandArea = traces.islandArea * spacing * spacing;
  report.nestedLumens = traces.nestedLumens;
  ContourSet set{ { image.lattice.length(0), image.lattice.length(1) }, {} };
  set.contours.reserve(traces.chains.size());
  for (Trace& trace : traces.chains)
  {
    const bool halfWay = level.empty();
    double target = signedArea(trace, halfWay) + trace.corners;
    thinOut(trace);
    if (!halfWay)
      target = signedArea(trace) + capArea(trace);
    else if (options.smooth)
      smooth(trace, scale);
    const double missing = std::abs(restoreArea(trace, target, scale.margin));
    report.areaMissing = std::max(report.areaMissing, halfWay ? missing : 0.0);
    report.crossings += static_cast<std::int64_t>(trace.crossings.size());
    set.contours.push_back(contourOf(trace, spacing));
    trace = {};
  }
  numberLumens(set);
  if (options.smallestArea != 0 || options.leastSolidity != 0)
  {
    FilterReport seen;
    set = filterLumens(set, { options.smallestArea, options.leastSolidity }, &seen);
    report.small = seen.small;
    report.ragged = seen.ragged;
  }
  set = simplify(set, options.tolerance * spacing);
  for (const Outline& outline : outlines(set))
  {
    ++report.lumens;
    report.openLumens += outline.open ? 1 : 0;
  }
  for (const Contour& c : set.contours)
    report.points += static_cast<std::int64_t>(c.points.size());
  report.wallFraction = wallFraction(set);
  if (report.lumens == 0)
  {
    throw InputError(fmt::format("no lumen is left: {} are below the smallest area, {} below the least solidity",
                       report.small, report.ragged),
      "lower the smallest area (smallestArea) or the least solidity (leastSolidity)");
  }
  const double wall = report.wallFraction * set.size[0] * set.size[1];
  if (report.islandArea > 0.02 * (wall + report.islandArea))
  {
    result.warnings.push_back(fmt::format("{} pieces of wall inside lumens were taken out, {:.1f} % of all wall{}",
      report.islands, 100 * report.islandArea / (wall + report.islandArea),
      report.nestedLumens > 0 ? fmt::format(", and {} lumens inside them", report.nestedLumens) : std::string{}));
  }
  result.contours = std::move(set);
  return result;
}

} // namespace lamella::micrograph
