#include "peridynamics/fracture/DynamicsChecks.h"

#include "core/Error.h"
#include "core/Plausible.h"
#include "peridynamics/PairTable.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lamella::peridynamics
{
namespace
{

constexpr double noLimit = std::numeric_limits<double>::infinity();
/// An energy balance that is off by more than this share wants a smaller step.
constexpr double unbalanced = 0.02;

void between(const char* what, double value, double least, double most, const char* hint)
{
  if (!(value >= least && value <= most))
    throw ParameterError(fmt::format("{} is {}", what, value), hint);
}

} // namespace

void check(const DynamicsStudyOptions& o)
{
  const auto finite = [](const char* what, double value, const char* hint)
  { between(what, value, 0, std::numeric_limits<double>::max(), hint); };
  const auto density = [](double d)
  {
    if (!(d > 0 && plausible(d)))
      throw ParameterError(fmt::format("a density of {:g} kg/m³", d), "give one above 0, between 1e-30 and 1e30");
  };
  density(o.motion.density);
  for (const double d : o.densities)
    if (d != 0)
      density(d);
  if (o.pull)
  {
    finite("the strain rate", o.pull->strainRate, "give a number above 0 [1/s], or 0 for one that suits the sample");
    if (!(o.pull->transits > 0) || !std::isfinite(o.pull->transits))
      throw ParameterError(fmt::format("a pull of {} travel times", o.pull->transits), "give a number above 0");
    between("the share of the first break's strain to start at", o.pull->startShare, 0, 1, "give 0 to 1");
    if (!o.moved.empty() || !o.tractions.empty() || o.velocity != std::array<double, 3>{} || o.startVelocity)
      throw ParameterError("a pull by platens, and speeds or tractions of sides besides",
        "a pull moves the whole sample: leave the others out, or leave the platens out");
  }
  else if (o.moved.empty() && o.tractions.empty() && o.velocity == std::array<double, 3>{} && !o.startVelocity)
    throw ParameterError("nothing moves the sample",
      "give speeds or tractions of sides, or a velocity to begin with, or pull it by platens");
  for (const double v : o.velocity)
    if (!std::isfinite(v))
      throw ParameterError(fmt::format("a velocity of {} m/s to begin with", v), "give a number");
  finite(
    "the relaxation time of the loading rate", o.regulation.relaxation, "give a number above 0 [s], or 0 for none");
  finite("the reference energy of the loading rate", o.regulation.referenceEnergy, "give a number above 0");
  finite("the reference crack of the loading rate", o.regulation.referenceCrack, "give a length above 0 [m]");
  between("the share of the imposed speeds at first", o.regulation.start, 0, 1, "give 0 to 1");
  if (o.regulation.relaxation == 0 &&
    (o.regulation.start != 1 || o.regulation.referenceEnergy != 0 || o.regulation.referenceCrack != 0))
    throw ParameterError("a loading rate that gives way to what breaks, without its relaxation time",
      "give the relaxation time [s], or leave out its start, its reference energy and its reference crack");
  const MotionEnds& e = o.ends;
  for (const auto& [what, value] : { std::pair{ "the time of the end", e.time }, { "the largest strain", e.strain } })
    if (!(value > 0))
      throw ParameterError(fmt::format("{} is {}", what, value), "give a number above 0, or none");
  if (!(e.stopShare >= 0 && e.stopShare < 1))
    throw ParameterError(
      fmt::format("the share of the peak at which to stop, {}, is not in [0, 1)", e.stopShare), "0.05 is usual");
  if (e.broken < 1)
    throw ParameterError(fmt::format("the largest number of broken bonds is {}", e.broken), "give 1 or more, or none");
  if (!o.pull && e.time == noLimit && e.strain == noLimit && e.broken == std::numeric_limits<std::int64_t>::max())
    throw ParameterError("the motion has no end", "give the time of the end; or a strain, or a number of broken bonds");
  if (o.every < 0)
    throw ParameterError(fmt::format("a point of the history every {} steps", o.every), "give 1 or more");
  for (const double time : o.atTimes)
    if (!(time >= 0 && std::isfinite(time)))
      throw ParameterError(fmt::format("a state is asked for at the time {} s", time), "give 0 or more");
  for (const std::int64_t broken : o.atBroken)
    if (broken < 1)
      throw ParameterError(fmt::format("a state is asked for at {} broken bonds", broken), "give a number above 0");
}

double referenceEnergy(const RegulationOptions& o, const BondModel& model, const Lattice& lattice)
{
  if (o.referenceEnergy > 0)
    return o.referenceEnergy;
  double least = noLimit;
  for (const PairData& pair : describePairs(model, lattice.spacing))
    least = std::min(least, pair.fractureEnergy);
  if (!std::isfinite(least))
    throw ParameterError("a loading rate that gives way to what breaks, and nothing can break",
      "leave the relaxation time out, or say at which elongation bonds break");
  double side = noLimit;
  for (int a = 0; a < lattice.dimension; ++a)
    side = std::min(side, lattice.length(a));
  const double crack = o.referenceCrack > 0 ? o.referenceCrack : 0.01 * side;
  return least * std::pow(crack, lattice.dimension - 1);
}

void addWarnings(const BondModel& model, DynamicsResult& r)
{
  std::vector<std::string> warnings = modelWarnings(model, r.thickness);
  if (r.loosePieces > 0)
    warnings.push_back(looseWarning(r.loosePieces, r.looseNodes, r.solidNodes));
  if (const double defect = r.history.back().energies.defect(); std::abs(defect) > unbalanced)
    warnings.push_back(
      fmt::format("the energies do not add up: {:.2g} of the largest is missing or too much; take a smaller step than "
                  "{:.3g} of the stable one",
        defect, r.step / r.stable));
  if (const std::size_t missed = r.missedTimes.size() + r.missedNumbers.size(); missed > 0)
    warnings.push_back(
      fmt::format("{} of the states asked for lie beyond the end of the run: {}", missed, describe(r.end)));
  if (r.statesBefore > 0)
    warnings.push_back(fmt::format(
      "{} of the states asked for lie before the checkpoint, which stands after {} steps: they are not made",
      r.statesBefore, r.continuedAt));
  r.warnings.insert(r.warnings.begin(), warnings.begin(), warnings.end());
}

std::string describe(MotionEnd end)
{
  switch (end)
  {
    case MotionEnd::StressFell:
      return "the stress fell to the share of the peak at which to stop";
    case MotionEnd::MaxStrain:
      return "the largest strain was reached";
    case MotionEnd::MaxBroken:
      return "the largest number of broken bonds was reached";
    case MotionEnd::Time:
      break;
  }
  return "the time of the end was reached";
}

double dynamicsBytes(
  const BondModel& model, const Lattice& lattice, bool grains, const DynamicsStudyOptions& options, int ranks)
{
  const Stencil stencil(lattice.dimension, model.horizon);
  const auto nodes = static_cast<double>(
    NodeLayout::largestPart(lattice.dimension, stencil.layers(), lattice.size, ranks, model.periodic[0]).count());
  const double d = lattice.dimension;
  const bool file = !options.motion.checkpoint.path.empty() || !options.motion.continueFrom.empty();
  // displacement, velocity, force, load, imposed velocity; stress; masses; counts of bonds, damage
  const double fields = 8 * (5 * d + (d == 3 ? 6 : 3) + 2 + 2) + 4;
  // gathered, as HDF5 has them, as a file: of the whole lattice, on one rank
  const double checkpoint = file ? 3 * 8 * 5 * d * static_cast<double>(lattice.count()) : 0;
  // displacements at a strain of one and with them what is fixed, and what it took to find them
  const double bonds = options.pull ? elasticBytes(model, lattice, grains, {}, ranks) + nodes * 8 * 3 * d
                                    : BondLattice::bytesNeeded(model, lattice, ranks, grains);
  return bonds + nodes * fields + checkpoint;
}

} // namespace lamella::peridynamics
