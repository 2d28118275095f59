#include "peridynamics/fracture/EventEngine.h"

#include "core/Clock.h"
#include "core/Error.h"
#include "peridynamics/ValueShare.h"

#include <algorithm>
#include <optional>
#include <stdexcept>

namespace lamella::peridynamics
{
namespace
{

constexpr int mostIterations = 200; // of an exact correction: some ten are usual
constexpr double nearby = 0.8;      // of the largest s/s₀: what a handful of events does not make the next to break
constexpr int mostLittles = 8;      // corrections that change little, one after the other: then all are looked at

// Wide windows, in the plane: what windows around single breaks leave lies beside their rims, and a window twice as
// wide takes it in. So whole lattices are corrected more seldom by
constexpr int wides = 5;
constexpr int wideRadius = 24; // in the plane 12 and 6 around a break
constexpr int wideCoarse = 12;
constexpr int wideCycles = 3;
constexpr double wideReduction = 0.3; // of what a break's correction leaves
constexpr double closer = 0.1;        // margin of rivals thereafter, over that before

int orUsual(int radius, int dimension, int inPlane, int inSpace)
{
  return radius > 0 ? radius : dimension == 3 ? inSpace : inPlane;
}

const Communicator& teamOf(const BondLattice& bonds, const BondLattice* parts)
{
  return parts != nullptr ? parts->communicator() : bonds.communicator();
}

} // namespace

EventEngine::EventEngine(BondLattice& bonds, BondLattice* parts, const LoadedSample& sample, const PlatenForce& platens,
  const EventOptions& options, double tolerance, const std::function<bool(double)>& progress)
  : bonds_(bonds)
  , parts_(parts)
  , platens_(platens)
  , options_(options)
  , tolerance_(tolerance)
  , state_(bonds, sample.fixed, sample.displacement, tolerance, progress, teamOf(bonds, parts))
  , tiles_(bonds, teamOf(bonds, parts))
  , pieces_(bonds, sample, platens)
  , radius_(orUsual(options.radius, bonds.dimension(), 12, 6))
  , coarseRadius_(orUsual(options.coarseRadius, bonds.dimension(), 6, 4))
  , wide_(bonds.dimension() == 2)
  , reached_(tolerance)
{
  refine();
  afterGlobal(0, seconds());
  rise_ = options.beforeRise(bonds.dimension(), carried(sample));
  if (force_ > 0)
    workOverForce_ = 2 * elasticEnergy(bonds, state_.base(), false) / force_;
}

// As Equilibrium does it.
void EventEngine::refine()
{
  NodeField<double> force(bonds_.layout());
  const double wanted = shareLeft(bonds_, tolerance_);
  for (const double tighter : { 1e-1, 1e-2, 1e-3 })
  {
    linearForce(bonds_, state_.base(), force);
    if (platens_.imbalance(bonds_, force) <= wanted)
      return;
    try
    {
      state_.solve(tighter * tolerance_);
    }
    catch (const DivergenceError&) // nothing carries, or round-off
    {
      state_.renew();
      return;
    }
  }
}

double EventEngine::carried(const LoadedSample& sample) const
{
  if (sample.pores)
    return 1;
  NodeField<double> force(bonds_.layout());
  linearForce(bonds_, sample.displacement, force);
  return force_ / platens_.of(bonds_, force);
}

EventEngine::EventEngine(BondLattice& bonds, BondLattice* parts, const LoadedSample& sample, const PlatenForce& platens,
  const EventOptions& options, double tolerance, const EngineState& resumed)
  : bonds_(bonds)
  , parts_(parts)
  , platens_(platens)
  , options_(options)
  , tolerance_(tolerance)
  , state_(bonds, sample.fixed, { resumed.displacement, resumed.numbers.at("load force") }, teamOf(bonds, parts))
  , tiles_(bonds, teamOf(bonds, parts))
  , pieces_(bonds, sample, platens)
  , radius_(orUsual(options.radius, bonds.dimension(), 12, 6))
  , coarseRadius_(orUsual(options.coarseRadius, bonds.dimension(), 6, 4))
  , wide_(bonds.dimension() == 2)
  , workOverForce_(resumed.numbers.at("work over force"))
  , reached_(resumed.numbers.at("residual"))
  , rise_(resumed.numbers.at("residual before a rise"))
{
  statistics_ = resumed.statistics;
  searchesBefore_ = statistics_.searches;
  measure();
}

EngineState EventEngine::state() const
{
  return { state_.base(),
    { { "load force", state_.reference() }, { "work over force", workOverForce_ }, { "residual", reached_ },
      { "residual before a rise", rise_ } },
    statistics_ };
}

// Corrected before: what is left of the old levels is their residual, and that is measured anew.
void EventEngine::renew()
{
  settle(Nearness::Avalanche);
  const double start = seconds();
  state_.renew();
  statistics_.globalSeconds += seconds() - start;
  measure();
}

void EventEngine::measure()
{
  force_ = platens_.of(bonds_, state_.force());
  sinceGlobal_ = sinceWide_ = 0;
  const double start = seconds();
  const bool little = state_.little() && ++littles_ < mostLittles;
  littles_ = little ? littles_ : 0;
  tiles_.refreshAll(state_, state_.looked() || little ? nearby : 0);
  statistics_.searchSeconds += seconds() - start;
  statistics_.bytes = state_.bytes() + tiles_.bytes() + pieces_.bytes();
}

void EventEngine::afterGlobal(int iterations, double start)
{
  ++statistics_.equilibria;
  statistics_.globalIterations += iterations;
  statistics_.globalSeconds += seconds() - start;
  measure();
}

bool EventEngine::correct(double tolerance)
{
  if ((sinceGlobal_ == 0 && reached_ <= tolerance) || state_.expectedResidual() <= tolerance)
    return false;
  const double start = seconds();
  afterGlobal(state_.correctGlobally({ tolerance, mostIterations }).iterations, start);
  reached_ = tolerance;
  return true;
}

void EventEngine::correctAround()
{
  const double start = seconds();
  const EventHierarchy::Local local = state_.correct(broken_, std::max(wideRadius, radius_),
    std::max(wideCoarse, coarseRadius_), wideReduction * wideReduction * target_, wideCycles);
  statistics_.localCycles += local.cycles;
  statistics_.nodesVisited += local.visited;
  const double relaxed = seconds();
  statistics_.localSeconds += relaxed - start;
  tiles_.refresh(state_, local.window, nearby);
  statistics_.searchSeconds += seconds() - relaxed;
  sinceWide_ = 0;
}

double EventEngine::toleranceOf(Nearness nearness) const noexcept
{
  switch (nearness)
  {
    case Nearness::Softening:
      return std::max(options_.softeningTolerance, rise_);
    case Nearness::Exact:
      return rise_;
    case Nearness::Avalanche:
      break;
  }
  return options_.globalTolerance;
}

void EventEngine::turn()
{
  throw std::logic_error("events know of a load that only rises"); // QuasiStaticFracture has refused it
}

bool EventEngine::settle(Nearness nearness)
{
  if (sinceGlobal_ == 0)
    return nearness != Nearness::Avalanche && correct(toleranceOf(nearness));
  if (wide_ && sinceWide_ > 0 && nearness != Nearness::Avalanche)
    correctAround(); // saves more of an iteration on the whole lattice than it takes
  // in space every other break leaves so little that the look itself would be the work; in the plane looks are cheap,
  // and without them cracks took other ways
  if (bonds_.dimension() == 3 && nearness != Nearness::Avalanche && state_.expectedResidual() <= toleranceOf(nearness))
    return false;
  const double start = seconds();
  std::optional<EventHierarchy::Goal> further; // where there is nothing new to look at
  if (nearness != Nearness::Avalanche)
    further = { toleranceOf(nearness), mostIterations };
  const EventHierarchy::Reached reached =
    state_.correctGlobally({ options_.globalTolerance, options_.globalIterations }, further);
  afterGlobal(reached.iterations, start);
  reached_ = reached.tolerance;
  return true;
}

std::int64_t EventEngine::indexOf(const Bond& bond) const
{
  return bonds_.layout().index(bond.node[0], bond.node[1], bond.node[2]);
}

Box EventEngine::boxOf(const Bond& bond) const
{
  const auto& step = bonds_.stencil().half()[static_cast<std::size_t>(bond.offset)].step;
  Box box;
  for (std::size_t a = 0; a < 3; ++a)
  {
    box.low[a] = std::min(bond.node[a], bond.node[a] + step[a]);
    box.high[a] = std::max(bond.node[a], bond.node[a] + step[a]) + 1;
  }
  return box;
}

NodeField<double> EventEngine::displacement()
{
  const double start = seconds();
  afterGlobal(state_.solve(tolerance_), start);
  reached_ = tolerance_;
  return state_.base();
}

StretchMaximum EventEngine::mostCritical()
{
  const double start = seconds();
  StretchMaximum most = tiles_.greatest(state_);
  statistics_.searchSeconds += seconds() - start;
  // which of two it is makes the path: the errors of local corrections, which add up, are not to say
  const double every = options_.globalEvery;
  if (!wide_)
  {
    if (rivals(most, std::min(1.0, (sinceGlobal_ + 1) / every)) && correct(options_.rivalTolerance))
      most = tiles_.greatest(state_);
    return most;
  }
  if (state_.expectedResidual() <= options_.rivalTolerance)
    return most;
  if (sinceWide_ > 0 && rivals(most, std::min(1.0, (sinceWide_ + 1) / every)))
  {
    correctAround();
    most = tiles_.greatest(state_);
  }
  if (rivals(most, closer * std::min(1.0, (sinceGlobal_ + 1) / (wides * every))) && correct(options_.rivalTolerance))
    most = tiles_.greatest(state_);
  return most;
}

/// @param margin of the option's
bool EventEngine::rivals(const StretchMaximum& most, double margin) const
{
  margin *= options_.rivals;
  return margin > 0 && most.bond && tiles_.second() >= (1 - margin) * most.ratio;
}

std::vector<Bond> EventEngine::critical(double)
{
  const StretchMaximum most = mostCritical();
  return most.bond ? std::vector<Bond>{ *most.bond } : std::vector<Bond>{};
}

void EventEngine::breakBonds(std::span<const Bond> bonds)
{
  for (const Bond& b : bonds)
    breakBond(b);
}

void EventEngine::breakBond(const Bond& bond)
{
  double start = seconds();
  const std::int64_t i = indexOf(bond);
  const double before = state_.elongation(i, bond.offset);
  const double spring = takeOut(i, bond.offset);
  const double broken = seconds();
  statistics_.localSeconds += broken - start;
  takeOut(pieces_.after(i, bond.offset));
  statistics_.searches = searchesBefore_ + pieces_.searches();
  start = seconds();
  statistics_.searchSeconds += start - broken;

  const double dipole = state_.dipole(i, bond.offset, spring * before);
  target_ = options_.reduction * options_.reduction * dipole;
  const EventHierarchy::Local local = state_.correct(boxOf(bond), radius_, coarseRadius_, target_, options_.maxCycles);
  statistics_.localCycles += local.cycles;
  statistics_.nodesVisited += local.visited;
  // exact for an equilibrium before and after
  const double lost = spring * before * state_.elongation(i, bond.offset);
  if (workOverForce_ > 0)
    force_ = std::max(0.0, force_ - lost / workOverForce_);
  const double relaxed = seconds();
  statistics_.localSeconds += relaxed - start;
  tiles_.refresh(state_, local.window);
  statistics_.searchSeconds += seconds() - relaxed;
  broken_ = sinceWide_ == 0 ? boxOf(bond) : united(broken_, boxOf(bond));
  ++sinceGlobal_;
  ++sinceWide_;
  if (sinceGlobal_ >= (wide_ ? wides : 1) * options_.globalEvery)
    settle(Nearness::Avalanche);
  else if (wide_ && sinceWide_ >= options_.globalEvery)
    correctAround();
}

double EventEngine::takeOut(std::int64_t index, int offset)
{
  if (parts_ != nullptr)
    parts_->breakKnown(bonds_.bond(index, offset));
  return state_.breakBond(index, offset);
}

void EventEngine::takeOut(const std::vector<std::int64_t>& nodes)
{
  if (nodes.empty())
    return;
  ++statistics_.loosePieces;
  statistics_.looseNodes += static_cast<std::int64_t>(nodes.size());
  for (const std::int64_t i : nodes)
    for (int o = 0; o < static_cast<int>(bonds_.stencil().half().size()); ++o)
      if (bonds_.kind(i, o) != 0)
      {
        takeOut(i, o);
        ++statistics_.looseBonds;
      }
}

} // namespace lamella::peridynamics
