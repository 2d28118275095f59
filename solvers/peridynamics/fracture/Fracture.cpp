#include "peridynamics/fracture/Fracture.h"

#include "core/Clock.h"
#include "core/Error.h"
#include "peridynamics/fracture/AccurateEngine.h"
#include "peridynamics/fracture/EventEngine.h"
#include "peridynamics/fracture/PlatenForce.h"
#include "peridynamics/kernels/RowKernels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

namespace lamella::peridynamics
{
namespace
{

constexpr double equal = 1e-9; // loads nearer than this to each other are the same: elongations have fewer digits

/// Of the largest s/s₀ of the unbroken sample: less than that is what equilibria leave where nothing pulls.
constexpr double noise = 1e-3;

/// Of a tolerance. An equilibrium starts from the one before, and does nothing about a break that disturbs less.
constexpr double loosest = 1e-3;

/// PlatenForce::imbalance() of the first equilibrium. At 1e-6 sound samples had 4e-4 at most, hinges 5e-2 and more; at
/// any tolerance samples with less than this had their strength to 0.5 %. docs/solvers/fracture.md
constexpr double balanced = 5e-3;

// Tolerance over the share carried: strengths were off by five times as much, and where it was more by all of it.
constexpr double mostLeft = 0.1;

/// Of the largest stress so far: estimates of a stress before a correction err by less.
constexpr double softening = 0.95;

void checkTurningPoints(const Loading& loading, const FractureOptions& o)
{
  if (o.turningPoints.empty())
    return;
  if (o.method == FractureMethod::Events)
    throw ParameterError("a load that turns round with local corrections", "use the accurate method");
  if (loading.load == LoadCase::Pressure)
    throw ParameterError("a pressure in pores that turns round", "load by platens");
  if (o.strainStep != 0)
    throw ParameterError(
      fmt::format("a load that turns round is raised in steps of {:g}", o.strainStep), "leave the steps out");
  if (std::isfinite(o.maxStrain))
    throw ParameterError(fmt::format("turning points and a largest strain of {:g}", o.maxStrain),
      "leave the latter out: the last turning point is the end");
  double before = 0;
  for (const double strain : o.turningPoints)
  {
    if (!(std::abs(strain) <= 1))
      throw ParameterError(
        fmt::format("the load cannot turn round at a strain of {:g}", strain), "give numbers between -1 and 1");
    if (strain == before)
      throw ParameterError(fmt::format("the load turns round at a strain of {:g}, where it is already", strain),
        "give turning points that differ from the one before, the first from 0");
    before = strain;
  }
}

void check(const BondLattice& bonds, const Loading& loading, const FractureOptions& o)
{
  if (loading.load == LoadCase::Traction)
    throw ParameterError("fracture under a traction: after the peak no equilibrium can hold it",
      "load by a strain; the record's critical strains and stresses follow every snap-back");
  if (loading.load == LoadCase::Pressure && o.method == FractureMethod::Events)
    throw ParameterError("fracture under a pressure with local corrections", "use the accurate method");
  if (o.contact && o.method == FractureMethod::Events)
    throw ParameterError("contact of cracks with local corrections", "use the accurate method");
  if (o.contact && loading.load == LoadCase::Pressure)
    throw ParameterError("contact of cracks under a pressure in pores", "load by platens, or leave contact out");
  checkTurningPoints(loading, o);
  if (!(loading.strain != 0) || !std::isfinite(loading.strain))
    throw ParameterError(fmt::format("the strain {} gives the load no direction", loading.strain),
      "give any strain but 0, such as 1e-3: it is scaled to the breaks");
  if (!(o.stopShare >= 0 && o.stopShare < 1))
    throw ParameterError(fmt::format("the share of the peak at which to stop, {}, is not in [0, 1)", o.stopShare),
      "0.05 is usual; hinges never part in small strain, so 0 may never be reached");
  if (!(o.maxStrain > 0))
    throw ParameterError(fmt::format("the largest strain, {}, is not positive", o.maxStrain), "leave it out for none");
  constexpr double leastStep = 1e-9; // of smaller ones round-off decides how many there are
  if (o.strainStep != 0 && !(o.strainStep >= leastStep && o.strainStep <= 1))
    throw ParameterError(fmt::format("the strain cannot be raised in steps of {:g}", o.strainStep),
      fmt::format("give a strain well below that at the peak, between {:g} and 1, or 0 to raise it to the next break",
        leastStep));
  if (o.renewEvery < 0 || (o.renewEvery == 0 && !o.checkpoint.path.empty()))
    throw ParameterError(fmt::format("{} events between two renewals{}", o.renewEvery,
                           o.renewEvery == 0 ? ", at which alone checkpoints are written" : ""),
      "500 is usual");
  if (o.maxBroken < 1)
    throw ParameterError(fmt::format("at most {} bonds are to break", o.maxBroken), "leave it out for no limit");
  if (!(o.tolerance > 0 && o.tolerance <= loosest))
    throw ParameterError(fmt::format("a tolerance of {:g} for fracture is not above 0 and at most {:g}: looser ones do "
                                     "not follow single breaks",
                           o.tolerance, loosest),
      "1e-6 is usual");
  if (o.method != FractureMethod::Events)
    return;
  if (o.breaking == Breaking::Batched)
    throw ParameterError("batches of bonds cannot be broken with local corrections", "use the accurate method");
  // ranks come to the same to the last bit, or go apart
  const double lanes = static_cast<double>(std::hash<std::string>()(bonds.rowKernels().name) % 1000000);
  if (bonds.communicator().max(lanes) != -bonds.communicator().max(-lanes))
    throw ParameterError("fracture with local corrections on processors with different instruction sets",
      "use the accurate method, or machines of one kind");
  if (bonds.periodic() != std::array<bool, 3>{})
    throw ParameterError("fracture with local corrections of a periodic sample", "use the accurate method");
  const EventOptions& e = o.events;
  const std::int64_t widest =
    std::max({ bonds.layout().global[0], bonds.layout().global[1], bonds.layout().global[2] });
  const auto orUsual = [](int radius, int low) { return std::int64_t{ radius == 0 ? low : radius }; };
  const int layers = bonds.stencil().layers();
  for (const auto& [name, value, low, high] :
    { std::tuple{ "radius", orUsual(e.radius, layers), std::int64_t{ layers }, 2 * widest + 8 },
      { "coarse radius", orUsual(e.coarseRadius, 2), std::int64_t{ 2 }, 2 * widest + 8 },
      { "number of cycles", std::int64_t{ e.maxCycles }, std::int64_t{ 1 }, std::int64_t{ 1000 } },
      { "number of events between global corrections", std::int64_t{ e.globalEvery }, std::int64_t{ 1 },
        std::int64_t{ 1000000 } },
      { "number of global iterations", std::int64_t{ e.globalIterations }, std::int64_t{ 1 },
        std::int64_t{ 100000 } } })
    if (value < low || value > high)
      throw ParameterError(
        fmt::format("the {} of the local corrections, {}, is not in {} … {}", name, value, low, high),
        "the defaults serve most samples");
  if (!(e.rivals >= 0 && e.rivals < 1))
    throw ParameterError(
      fmt::format("the margin within which two bonds are rivals, {}, is not in [0, 1)", e.rivals), "5e-3 is usual");
  for (const auto& [name, value] :
    { std::pair{ "reduction", e.reduction }, std::pair{ "global tolerance", e.globalTolerance },
      std::pair{ "tolerance before a rise", e.riseTolerance == 0 ? e.beforeRise(2, 1) : e.riseTolerance },
      std::pair{ "tolerance before a rise below the peak", e.softeningTolerance },
      std::pair{ "tolerance among rivals", e.rivalTolerance } })
    if (!(value > 0 && value < 1))
      throw ParameterError(fmt::format("the {} of the local corrections, {}, is not between 0 and 1", name, value),
        "the defaults serve most samples");
}

/// Of the whole lattice what lies on this rank's part; rim included.
NodeField<double> partOf(const NodeField<double>& whole, const NodeLayout& part)
{
  NodeField<double> field(part);
  const NodeLayout& l = whole.layout();
  for (int c = 0; c < field.components(); ++c)
    for (std::int64_t z = -part.ghostZ(); z < part.size[2] + part.ghostZ(); ++z)
      for (std::int64_t y = -part.ghost; y < part.size[1] + part.ghost; ++y)
      {
        const std::int64_t atY = y + part.start[1];
        const std::int64_t atZ = z + part.start[2];
        if (atY >= 0 && atY < l.size[1] && atZ >= 0 && atZ < l.size[2])
          std::copy_n(whole.component(c) + l.index(0, atY, atZ), l.size[0], field.component(c) + part.index(0, y, z));
      }
  return field;
}

/// @param displacement at the first equilibrium
/// Sets FractureRecord::imbalance and carried.
void requireBalance(const BondLattice& bonds, const LoadedSample& sample, const PlatenForce& platens,
  const NodeField<double>& displacement, double tolerance, FractureRecord& record)
{
  NodeField<double> force(bonds.layout());
  linearForce(bonds, displacement, force);
  record.imbalance = platens.imbalance(bonds, force);
  const double carried = platens.of(bonds, force);
  linearForce(bonds, sample.displacement, force);
  record.carried = carried / platens.of(bonds, force);
  std::string why;
  if (record.imbalance > balanced)
    why =
      fmt::format("forces through its sections are off by {:.2g} times that on the platens (at most {:g}), which is "
                  "{:.1e} of the one under even strain",
        record.imbalance, balanced, record.carried);
  else if (const double least = tolerance / mostLeft; record.carried < least)
    why = fmt::format("{:.1e} of the force under even strain (at least {:.1e})", record.carried, least);
  else
    return;
  throw InputError(
    fmt::format("the sample carries too little for a strength at a tolerance of {:g}: {}", tolerance, why),
    "where only hinges reach through, a longer horizon or thicker necks; else a tighter tolerance, with method "
    "accurate");
}

/// The same of a sample under pressure: the residual's work over the load's.
void requireBalance(const BondLattice& bonds, const LoadedSample& sample, const NodeField<double>& displacement,
  double tolerance, FractureRecord& record)
{
  NodeField<double> force(bonds.layout());
  linearForce(bonds, displacement, force);
  for (int c = 0; c < force.components(); ++c)
    for (std::int64_t i = 0; i < force.layout().count(); ++i)
      force.component(c)[i] += sample.load->component(c)[i];
  record.imbalance = workOfResidual(bonds, sample, displacement, force);
  record.carried = 1;
  if (record.imbalance > balanced)
    throw InputError(
      fmt::format("the pressure is hardly borne at a tolerance of {:g}: what is out of balance does {:.2g} "
                  "of its work (at most {:g})",
        tolerance, record.imbalance, balanced),
      "where walls hang together by hinges only, a longer horizon or thicker walls; else a tighter tolerance");
}

} // namespace

std::string describe(FractureEnd end)
{
  switch (end)
  {
    case FractureEnd::Running:
      return "not finished";
    case FractureEnd::StressFell:
      return "the stress fell to the share of the peak at which to stop";
    case FractureEnd::Severed:
      return "no piece reaches from platen to platen any more";
    case FractureEnd::PoresOpen:
      return "the walls of pores have parted: nothing bears a pressure any more";
    case FractureEnd::NothingBreaks:
      return "no bond that can break is stretched";
    case FractureEnd::LastTurn:
      return "the last turning point of the load was reached";
    case FractureEnd::MaxStrain:
      return "the largest strain was reached";
    case FractureEnd::MaxBroken:
      return "the largest number of broken bonds was reached";
    case FractureEnd::Interrupted:
      return "interrupted";
  }
  return {};
}

QuasiStaticFracture::QuasiStaticFracture(
  BondLattice& bonds, const Loading& loading, FractureOptions options, std::span<const std::uint8_t> phase)
  : bonds_(bonds)
  , options_(std::move(options))
{
  check(bonds, loading, options_);
  const double start = seconds();
  reference_ = std::abs(loading.strain);
  if (options_.contact) // what cracks cut off is held by contact
    bonds.restoreBonds(bonds.communicator().rank() == 0 ? options_.cracks : std::vector<KnownBond>());
  sample_ = applyLoading(bonds, loading, phase);
  if (options_.contact)
    openCracks();
  const PlatenForce platens(bonds, loading, sample_);
  area_ = sample_.pores ? 1 : platens.area();
  const NodeLayout& l = bonds.layout();
  const bool tiny = l.global[0] * l.global[1] * l.global[2] <= MultigridOptions{}.coarsest; // no coarser level
  const bool accurate = options_.method == FractureMethod::Accurate || tiny;
  if (!accurate && bonds.communicator().parallel())
    whole_ = std::make_unique<Whole>(bonds, loading);
  if (!options_.checkpoint.path.empty() || !options_.continueFrom.empty())
    scene_ = sceneOf(bonds) + sceneOf(loading, options_) + sceneOf(bonds, sample_);
  checkPlace(options_.checkpoint, bonds.communicator());
  if (!options_.continueFrom.empty())
  {
    const EngineState resumed = restore(platens);
    PlatenForce turned = platens;
    if (direction_ < 0)
    {
      turned.turn();
      for (int c = 0; c < l.dimension; ++c)
        for (std::int64_t i = 0; i < l.count(); ++i)
          sample_.displacement.component(c)[i] = -sample_.displacement.component(c)[i];
    }
    makeEngine(accurate, turned, &resumed);
    return;
  }
  makeEngine(accurate, platens, nullptr);
  if (!engine_->holds())
    throw NoPathError("cracks part the sample, and the load pulls its pieces asunder",
      "load it in compression, or with shorter notches");
  if (sample_.pores)
    requireBalance(bonds_, sample_, engine_->state().displacement, options_.tolerance, record_);
  else
    // events do not follow a tighter one
    requireBalance(lattice(), loaded(), platens, engine_->state().displacement,
      accurate ? options_.tolerance : std::max(options_.tolerance, FractureOptions{}.tolerance), record_);
  record_.modulus = stress(1) / reference_;
  record_.statistics = engine_->statistics();
  record_.statistics.totalSeconds = seconds() - start;
}

QuasiStaticFracture::~QuasiStaticFracture() = default;

void QuasiStaticFracture::openCracks()
{
  contact_.emplace(bonds_).watch(options_.cracks);
  std::vector<Bond> cracks;
  for (const KnownBond& b : options_.cracks)
    cracks.push_back(b.bond);
  bonds_.breakBonds(bonds_.communicator().rank() == 0 ? cracks : std::vector<Bond>());
}

QuasiStaticFracture::Whole::Whole(const BondLattice& parts, const Loading& loading)
  : alone(MPI_COMM_SELF)
  , bonds(parts.whole(alone))
  , sample(applyLoading(bonds, loading))
{
}

void QuasiStaticFracture::makeEngine(bool accurate, const PlatenForce& platens, const EngineState* resumed)
{
  const double tolerance = options_.tolerance;
  std::function<bool(double)> progress;
  if (options_.progress)
    progress = [this](double share) { return options_.progress({ .equilibrium = share }); };
  if (accurate)
  {
    CrackContact* const contact = contact_ ? &*contact_ : nullptr;
    if (resumed != nullptr)
      engine_ = std::make_unique<AccurateEngine>(bonds_, sample_, platens, contact, reference_, tolerance, *resumed);
    else
      engine_ =
        std::make_unique<AccurateEngine>(bonds_, sample_, platens, contact, reference_, tolerance, std::move(progress));
    return;
  }
  BondLattice* const parts = whole_ ? &bonds_ : nullptr;
  if (whole_ && progress) // where one asks to stop all do
    progress = [this, mine = std::move(progress)](double share) { return bonds_.communicator().any(mine(share)); };
  const EventOptions& events = options_.events;
  if (resumed != nullptr)
    engine_ = std::make_unique<EventEngine>(lattice(), parts, loaded(), platens, events, tolerance, *resumed);
  else
    engine_ = std::make_unique<EventEngine>(lattice(), parts, loaded(), platens, events, tolerance, progress);
}

void QuasiStaticFracture::setLimits(double maxStrain, std::int64_t maxBroken)
{
  options_.maxStrain = maxStrain;
  options_.maxBroken = maxBroken;
}

double QuasiStaticFracture::strain() const noexcept
{
  return direction_ * load_ * reference_ + 0.0; // not -0
}

double QuasiStaticFracture::stress(double load) const
{
  return engine_->holds() ? direction_ * load * engine_->force() / area_ + 0.0 : 0;
}

NodeField<double> QuasiStaticFracture::displacement()
{
  NodeField<double> u = whole_ ? partOf(engine_->displacement(), bonds_.layout()) : engine_->displacement();
  for (int c = 0; c < u.components(); ++c)
    for (std::int64_t i = 0; i < u.layout().count(); ++i)
      u.component(c)[i] *= load_;
  return u;
}

double QuasiStaticFracture::nextLoad(double critical) const
{
  if (options_.strainStep <= 0)
    return critical;
  const double steps = std::ceil((1 - equal) * critical * reference_ / options_.strainStep);
  return std::max(critical, steps * options_.strainStep / reference_);
}

Nearness QuasiStaticFracture::nearness(double ratio) const
{
  const bool peak = !(ratio > 0) || stress(nextLoad(1 / ratio)) >= softening * record_.peak.stress;
  return peak ? Nearness::Exact : Nearness::Softening;
}

// The elastic ramp in one step: to where a bond is critical.
void QuasiStaticFracture::raise(double load)
{
  const auto broken = static_cast<std::int64_t>(record_.broken.size());
  if (!record_.curve.empty()) // what the avalanche left; run() may have stopped before all of it was at rest
  {
    if (record_.curve.back().broken == broken)
      record_.curve.pop_back();
    record_.curve.push_back({ strain(), stress(load_), broken });
  }
  load_ = load;
  ++record_.statistics.raises;
  const CurvePoint now{ strain(), stress(load_), broken };
  record_.curve.push_back(now);
  if (broken == 0)
    record_.first = now;
  if (now.stress > record_.peak.stress)
    record_.peak = now;
}

void QuasiStaticFracture::breakCritical(const StretchMaximum& most)
{
  std::vector<Bond> bonds;
  if (options_.breaking == Breaking::Batched)
    bonds = engine_->critical((1 - equal) / load_);
  else
    bonds.push_back(*most.bond);
  const std::int64_t event = ++record_.statistics.events;
  for (const Bond& b : bonds)
    record_.broken.push_back(
      { b, event, strain(), direction_ * std::min(1 / most.ratio, load_) * reference_, stress(load_) });
  engine_->breakBonds(bonds);
  if (options_.renewEvery == 0 || event % options_.renewEvery != 0 || !engine_->holds())
    return;
  engine_->renew();
  if (!options_.checkpoint.path.empty() && event - savedAt_ >= options_.checkpoint.every &&
    pace_.due(options_.checkpoint, bonds_.communicator()))
    save();
}

bool QuasiStaticFracture::fell(double stress) const
{
  return options_.stopShare > 0 && record_.peak.stress > 0 && stress <= options_.stopShare * record_.peak.stress;
}

bool QuasiStaticFracture::report()
{
  const double now = stress(load_);
  if (const std::size_t turns = options_.turningPoints.size(); turns > 0)
    share_ = static_cast<double>(turns_) / static_cast<double>(turns);
  else if (record_.peak.stress > 0)
    share_ = std::max(share_, std::clamp((1 - now / record_.peak.stress) / (1 - options_.stopShare), 0.0, 1.0));
  return options_.progress &&
    bonds_.communicator().any(options_.progress(
      { share_, static_cast<std::int64_t>(record_.broken.size()), strain(), now, record_.peak.stress, writtenAt_ }));
}

// Running: an event took place, or the state was made better.
FractureEnd QuasiStaticFracture::step()
{
  if (!engine_->holds())
    return sample_.pores ? FractureEnd::PoresOpen : FractureEnd::Severed;
  if (static_cast<std::int64_t>(record_.broken.size()) >= options_.maxBroken)
    return FractureEnd::MaxBroken;
  const StretchMaximum most = engine_->mostCritical();
  const bool critical = most.ratio > 0 && load_ * most.ratio >= 1 - equal;
  const bool fallen = fell(stress(load_));
  if (!critical || fallen)
  {
    if (engine_->settle(fallen ? Nearness::Avalanche : nearness(most.ratio)))
      return FractureEnd::Running; // look again
    if (fallen)
      return FractureEnd::StressFell;
    if (!(most.ratio > noise * firstRatio_))
      return FractureEnd::NothingBreaks;
    const double load = nextLoad(1 / most.ratio);
    if (reference_ * load > options_.maxStrain)
      return FractureEnd::MaxStrain;
    if (record_.broken.empty())
      firstRatio_ = most.ratio;
    raise(load);
    if (fell(record_.curve.back().stress))
      return FractureEnd::StressFell;
  }
  breakCritical(most);
  return report() ? FractureEnd::Interrupted : FractureEnd::Running;
}

FractureEnd QuasiStaticFracture::run()
{
  started_ = seconds();
  FractureEnd end = FractureEnd::Running;
  while (end == FractureEnd::Running)
    end = options_.turningPoints.empty() ? step() : stepOnBranch();
  if (end != FractureEnd::Interrupted && !record_.curve.empty() &&
    record_.curve.back().broken != static_cast<std::int64_t>(record_.broken.size()))
    record_.curve.push_back({ strain(), stress(load_), static_cast<std::int64_t>(record_.broken.size()) });
  record_.end = end;
  record_.statistics = statistics();
  return end;
}

FractureStatistics QuasiStaticFracture::statistics() const
{
  const FractureStatistics& mine = record_.statistics;
  FractureStatistics all = engine_->statistics();
  all.bytes += whole_ ? whole_->bonds.bytes() : 0;
  all.events = mine.events;
  all.raises = mine.raises;
  all.checkpoints = mine.checkpoints;
  all.checkpointSeconds = mine.checkpointSeconds;
  all.totalSeconds = mine.totalSeconds + seconds() - started_;
  return all;
}

} // namespace lamella::peridynamics
