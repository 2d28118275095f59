#include "GenerateTissue.h"

#include "Text.h"

#include "lattice/Error.h"

#include <fmt/format.h>

#include <array>

namespace lamella::cli
{
namespace
{

/// The generators' own defaults, as one would type them.
const generators::SoftwoodOptions tissue;
const generators::HardwoodOptions hardTissue;

std::string micrometres(double metres)
{
  return fmt::format("{:g}um", metres * 1e6);
}

/// --ring: positions of the left and of the right edge.
std::array<double, 2> ringPositions(const std::string& text)
{
  const auto ring = split(text, ',');
  const auto start = toNumber(ring[0]);
  const auto end = ring.size() == 2 ? toNumber(ring[1]) : start;
  if (ring.size() > 2 || !start || !end || !(*start >= 0 && *start <= 1 && *end >= 0 && *end <= 1))
  {
    throw ParameterError("--ring '" + text + "' is not a pair of positions from 0 to 1",
      "write --ring 0,1 for a whole ring from earlywood to latewood, --ring 0,0 for earlywood alone");
  }
  return { *start, *end };
}

/// "EARLY,LATE", or one for both, each as `parse` has it.
template <class Parse>
std::array<double, 2> earlyAndLate(const std::string& option, const std::string& text, Parse&& parse)
{
  const auto parts = split(text, ',');
  if (parts.size() > 2)
  {
    throw ParameterError(fmt::format("{} '{}' has {} values", option, text, parts.size()),
      "give one for the start of the ring and one for its end, with a comma between, or one for both");
  }
  return { parse(option, parts.front()), parse(option, parts.back()) };
}

/// An option whose default is what stands in `value`.
template <class Value>
void add(CLI::App& command, const char* name, Value& value, const char* type, const char* text)
{
  command.add_option(name, value, text)->type_name(type)->capture_default_str();
}

void addFraction(CLI::App& command, TissueChoice& choice)
{
  add(command, "--solid-fraction", choice.fraction, "SHARE", "Share of the wall, 0.02 to 0.95");
}

/// @param ends what the positions 0 and 1 are
void addRing(CLI::App& command, TissueChoice& choice, const std::string& ends)
{
  const std::string text = "Position in the growth ring at the left and right edge: " + ends;
  add(command, "--ring", choice.ring, "START,END", text.c_str());
}

void addRays(CLI::App& command, TissueChoice& choice)
{
  add(command, "--ray-every", choice.rayEvery, "METRES", "Mean distance between rays; 0: none");
}

/// @param whose diameters scatter
void addChance(CLI::App& command, TissueChoice& choice, const std::string& whose)
{
  const std::string text = "Relative standard deviation of the " + whose;
  add(command, "--scatter", choice.scatter, "SHARE", text.c_str());
  add(command, "--seed", choice.seed, "NUMBER", "The same seed gives the same tissue");
}

} // namespace

double fractionBetween(const std::string& option, const std::string& text, double low, double high)
{
  const double value = share(option, text);
  if (!(value >= low && value <= high))
  {
    throw ParameterError(
      fmt::format("{} '{}' is outside {:g} to {:g}", option, text, low, high), "write it as 0.4 or 40%");
  }
  return value;
}

void addSoftwoodOptions(CLI::App& command, TissueChoice& choice)
{
  choice.fraction = fmt::format("{:.2f}", tissue.solidFraction);
  choice.ring = fmt::format("{:g},{:g}", tissue.ringPosition0, tissue.ringPosition1);
  choice.tangential = micrometres(tissue.tangentialDiameter);
  choice.radialEarly = micrometres(tissue.radialDiameterEarly);
  choice.radialLate = micrometres(tissue.radialDiameterLate);
  choice.rayEvery = micrometres(tissue.rayEvery);
  choice.length = micrometres(tissue.tracheidLength);
  choice.scatter = tissue.scatter;
  choice.seed = tissue.seed;
  addFraction(command, choice);
  addRing(command, choice, "0 earlywood, 1 latewood");
  add(command, "--tangential-diameter", choice.tangential, "METRES", "Mean diameter of a tracheid along y");
  add(command, "--radial-early", choice.radialEarly, "METRES", "Its mean diameter along x in earlywood");
  add(command, "--radial-late", choice.radialLate, "METRES", "The same in latewood");
  addRays(command, choice);
  add(command, "--tracheid-length", choice.length, "METRES", "In 3D: mean length of a tracheid along z");
  addChance(command, choice, "diameters");
}

void addHardwoodOptions(CLI::App& command, TissueChoice& choice)
{
  choice.fraction = fmt::format("{:.2f}", hardTissue.solidFraction);
  choice.fibre = micrometres(hardTissue.fibreDiameter);
  choice.vesselDiameter =
    fmt::format("{},{}", micrometres(hardTissue.vesselDiameterEarly), micrometres(hardTissue.vesselDiameterLate));
  choice.vesselShare = fmt::format("{:g},{:g}", hardTissue.vesselShareEarly, hardTissue.vesselShareLate);
  choice.earlyEnd = hardTissue.earlyEnd;
  choice.multiples = hardTissue.multiples;
  choice.ring = fmt::format("{:g},{:g}", hardTissue.ringPosition0, hardTissue.ringPosition1);
  choice.rayEvery = micrometres(hardTissue.rayEvery);
  choice.scatter = hardTissue.scatter;
  choice.seed = hardTissue.seed;
  addFraction(command, choice);
  add(
    command, "--fibre-diameter", choice.fibre, "METRES", "Mean diameter of a fibre, between the middles of its walls");
  add(command, "--vessel-diameter", choice.vesselDiameter, "EARLY,LATE",
    "Mean of a vessel along y, at the ring's start and end");
  add(command, "--vessel-share", choice.vesselShare, "EARLY,LATE",
    "Share of the picture in vessels, at the ring's start and end");
  add(command, "--early-end", choice.earlyEnd, "POSITION",
    "Position in the ring where late vessels begin; ring-porous: 0.25");
  add(
    command, "--multiples", choice.multiples, "SHARE", "Share of the vessels' groups that are radial files of 2 to 4");
  addRing(command, choice, "0 its start, 1 its end");
  addRays(command, choice);
  addChance(command, choice, "fibres' diameters");
}

generators::SoftwoodOptions softwoodOptions(const TissueChoice& choice)
{
  generators::SoftwoodOptions softwood;
  softwood.solidFraction = fractionBetween("--solid-fraction", choice.fraction, 0.02, 0.95);
  const auto ring = ringPositions(choice.ring);
  softwood.ringPosition0 = ring[0];
  softwood.ringPosition1 = ring[1];
  softwood.tangentialDiameter = lengthInMetres("--tangential-diameter", choice.tangential);
  softwood.radialDiameterEarly = lengthInMetres("--radial-early", choice.radialEarly);
  softwood.radialDiameterLate = lengthInMetres("--radial-late", choice.radialLate);
  softwood.rayEvery = toNumber(choice.rayEvery) == 0.0 ? 0 : lengthInMetres("--ray-every", choice.rayEvery);
  softwood.tracheidLength = lengthInMetres("--tracheid-length", choice.length);
  softwood.scatter = choice.scatter;
  softwood.seed = choice.seed;
  return softwood;
}

generators::HardwoodOptions hardwoodOptions(const TissueChoice& choice)
{
  generators::HardwoodOptions hardwood;
  hardwood.solidFraction = fractionBetween("--solid-fraction", choice.fraction, 0.02, 0.95);
  hardwood.fibreDiameter = lengthInMetres("--fibre-diameter", choice.fibre);
  const auto diameter = earlyAndLate("--vessel-diameter", choice.vesselDiameter, lengthInMetres);
  hardwood.vesselDiameterEarly = diameter[0];
  hardwood.vesselDiameterLate = diameter[1];
  const auto shares = earlyAndLate("--vessel-share", choice.vesselShare,
    [](const std::string& option, const std::string& text) { return fractionBetween(option, text, 0, 0.5); });
  hardwood.vesselShareEarly = shares[0];
  hardwood.vesselShareLate = shares[1];
  hardwood.earlyEnd = choice.earlyEnd;
  hardwood.multiples = choice.multiples;
  const auto ring = ringPositions(choice.ring);
  hardwood.ringPosition0 = ring[0];
  hardwood.ringPosition1 = ring[1];
  hardwood.rayEvery = toNumber(choice.rayEvery) == 0.0 ? 0 : lengthInMetres("--ray-every", choice.rayEvery);
  hardwood.scatter = choice.scatter;
  hardwood.seed = choice.seed;
  return hardwood;
}

} // namespace lamella::cli
