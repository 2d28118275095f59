#include "peridynamics/fracture/DynamicsStudy.h"

#include "core/Clock.h"
#include "core/Error.h"
#include "peridynamics/BondForces.h"
#include "peridynamics/fracture/DampedPull.h"
#include "peridynamics/fracture/DynamicsChecks.h"
#include "peridynamics/fracture/MotionGauge.h"
#include "peridynamics/fracture/MotionHistory.h"
#include "peridynamics/fracture/WantedStates.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace lamella::peridynamics
{
namespace
{

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr double never = std::numeric_limits<double>::infinity();
// in checkpoints
constexpr const char* sharedName = "states that shared a file";
constexpr const char* lookedName = "broken where states were looked for";

/// A run under way.
class MotionRun
{
public:
  MotionRun(const BondModel& model, const Lattice& lattice, std::span<const std::uint8_t> phase,
    const DynamicsStudyOptions& options, BondLattice& bonds, DynamicsResult& result)
    : o_(options)
    , bonds_(bonds)
    , r_(result)
    , continuum_(model.continuum)
    , damage_(bonds)
  {
    if (o_.pull)
      pull_.emplace(bonds, o_.pull->loading, ifTold([this](double) { return told(0); }));
    place(lattice);
    DynamicsOptions m = o_.motion;
    const NodeField<double> densities = densitiesOf(bonds, phase, o_.densities, m.density);
    r_.density = meanDensity(bonds, densities);
    if (std::any_of(o_.densities.begin(), o_.densities.end(), [](double d) { return d != 0; }))
      m.densities = densities;
    if (pull_)
      setRate();
    if (o_.regulation.relaxation > 0)
    {
      r_.referenceEnergy = referenceEnergy(o_.regulation, model, lattice);
      m.rate.emplace(o_.regulation.relaxation, r_.referenceEnergy, o_.regulation.start);
    }
    m.progress = ifTold([this](const DynamicsProgress& p) { return told(p); });
    m.checkpoint.warn = [this, warn = o_.motion.checkpoint.warn](const std::string& why)
    {
      unwritten_.push_back(why);
      if (warn)
        warn(why);
    };
    m.keepWith = [this](io::Checkpoint& c)
    {
      history_.put(c);
      c.numbers[sharedName] = static_cast<double>(shared_);
      c.numbers[lookedName] = static_cast<double>(looked_);
    };
    m.takeBack = [this](const io::Checkpoint& c)
    {
      history_.take(c);
      if (!c.numbers.contains(lookedName))
        return; // of a version that did not count them
      shared_ = c.count(sharedName);
      looked_ = c.count(lookedName);
    };
    const bool goesOn = !m.continueFrom.empty();
    start(std::move(m), goesOn);
    r_.step = motion_->step();
    r_.stable = motion_->stable();
    requireAnEnd();
    r_.viscosity = motion_->viscosity();
    r_.continuedAt = motion_->steps();
  }

  /// To the end.
  void go()
  {
    const std::int64_t last = stepOf(o_.ends.time);
    const bool timed = o_.ends.time != never && !pull_;
    // a point costs passes over all bonds that are slower than a step; a wave passes five nodes or so between two
    constexpr std::int64_t least = 20;
    const std::int64_t every = o_.every > 0 ? o_.every : timed ? std::max(least, last / 500) : 10;
    std::vector<std::int64_t> steps;
    for (const double time : o_.atTimes)
      steps.push_back(stepOf(time));
    Wanted<std::int64_t> times(steps, last);
    Wanted<std::int64_t> numbers(o_.atBroken, o_.ends.broken);
    if (r_.continuedAt > 0)
    {
      // since the last look bonds may have broken whose state is still to come
      if (looked_ < 0)
        looked_ = std::max(static_cast<std::int64_t>(motion_->broken().size()) - 1, std::int64_t{ 0 });
      const std::int64_t passed = times.skipBelow(r_.continuedAt) + numbers.skipBelow(looked_ + 1);
      r_.statesBefore = std::max(passed - shared_, std::int64_t{ 0 });
    }
    bool ended = false;
    if (history_.points().empty() ||
      (history_.points().back().step < motion_->steps() && motion_->steps() % every == 0))
      ended = look(last);
    for (;;)
    {
      // a run that goes on may stand between two points: no states are looked for there
      const bool atTime = times.some() && motion_->steps() >= times.next();
      if (ended || atTime || motion_->steps() % every == 0)
      {
        const auto broken = static_cast<std::int64_t>(motion_->broken().size());
        looked_ = broken;
        const bool atNumber = numbers.some() && broken >= numbers.next();
        const std::int64_t served = times.passed(motion_->steps()) + numbers.passed(broken);
        if (!ended && (atTime || atNumber))
        {
          keep(false);
          shared_ += served - 1;
        }
      }
      if (ended)
        break;
      const std::int64_t row = (motion_->steps() / every + 1) * every;
      const std::int64_t next = std::min({ row, last, times.next() });
      const double begin = lamella::seconds();
      if (!motion_->advance(next - motion_->steps()))
        throw Cancelled();
      if (next == row || next == last)
        ended = look(last);
      r_.motionSeconds += lamella::seconds() - begin;
    }
    keep(true);
    r_.history = history_.points();
    r_.peak = *std::max_element(r_.history.begin(), r_.history.end(),
      [](const MotionPoint& a, const MotionPoint& b) { return a.stress < b.stress; });
    r_.broken = motion_->broken();
    r_.checkpoints = motion_->checkpoints();
    r_.checkpointAt = motion_->checkpointAt();
    if (!unwritten_.empty())
      r_.warnings.push_back(
        fmt::format("{} of the checkpoints could not be written: {}", unwritten_.size(), unwritten_.front()));
    for (const std::int64_t step : times.left())
      if (step > motion_->steps())
        r_.missedTimes.push_back(static_cast<double>(step) * r_.step);
    for (const std::int64_t number : numbers.left())
      if (number > static_cast<std::int64_t>(motion_->broken().size()))
        r_.missedNumbers.push_back(number);
  }

private:
  /// A function only where the caller wants to be told.
  template <class F>
  [[nodiscard]] std::conditional_t<std::is_invocable_v<F, double>, std::function<bool(double)>,
    std::function<bool(const DynamicsProgress&)>>
  ifTold(F&& f) const
  {
    if (!o_.progress)
      return {};
    return std::forward<F>(f);
  }

  [[nodiscard]] std::int64_t stepOf(double time) const
  {
    // Beyond what any run takes; doubles hold it.
    constexpr double most = 9e15;
    return static_cast<std::int64_t>(std::clamp(std::round(time / motion_->step()), time > 0 ? 1.0 : 0.0, most));
  }

  /// Where strain and stress are taken.
  void place(const Lattice& lattice)
  {
    const int given = pull_ ? pull_->axis() : o_.axis;
    r_.axis = given < 0 ? lattice.dimension - 1 : given;
    if (r_.axis >= lattice.dimension)
      throw ParameterError(
        fmt::format("there is no axis {} in {} dimensions", r_.axis, lattice.dimension), "use x, y or, in 3D, z");
    const auto a = static_cast<std::size_t>(r_.axis);
    if (pull_)
    {
      r_.lowPlaten = pull_->sample().lowLayers;
      r_.highPlaten = pull_->sample().highLayers;
      r_.loosePieces = pull_->sample().loosePieces;
      r_.looseNodes = pull_->sample().looseNodes;
    }
    else
    {
      const std::int64_t layers = std::min<std::int64_t>(bonds_.stencil().layers(), (lattice.size[a] + 1) / 2);
      r_.lowPlaten = { 0, layers };
      r_.highPlaten = { lattice.size[a] - layers, lattice.size[a] };
    }
    r_.length = static_cast<double>(r_.highPlaten[0] - r_.lowPlaten[1] + 1) * lattice.spacing;
    r_.area = 1;
    for (int b = 0; b < lattice.dimension; ++b)
      r_.area *= b == r_.axis ? 1 : lattice.length(b);
    gauge_ = std::make_unique<MotionGauge>(
      bonds_, r_.axis, pull_ ? pull_->along() : r_.axis, r_.lowPlaten, r_.highPlaten, pull_ ? &pull_->unit() : nullptr);
    r_.modulus = r_.firstBreak = r_.strainRate = r_.travelTime = unknown;
  }

  void setRate()
  {
    r_.modulus = pull_->modulus();
    r_.firstBreak = pull_->firstBreak();
    r_.travelTime = travelTime(r_.length, r_.modulus, r_.density);
    r_.strainRate = o_.pull->strainRate;
    if (r_.strainRate > 0)
      return;
    r_.strainRate = r_.firstBreak / (o_.pull->transits * r_.travelTime);
    if (!(r_.strainRate > 0) || !std::isfinite(r_.strainRate))
      throw ParameterError("no strain rate, and nothing can break by which to choose one",
        "give the strain rate [1/s], or say at which elongation bonds break");
  }

  void start(DynamicsOptions m, bool goesOn)
  {
    if (pull_)
    {
      motion_ = std::make_unique<BondDynamics>(bonds_, pull_->sample().fixed, std::move(m));
      const double strain = std::isfinite(r_.firstBreak) ? o_.pull->startShare * r_.firstBreak : 0;
      if (!goesOn)
        motion_->setState(pull_->displacement(strain), pull_->velocity(r_.strainRate));
      return;
    }
    ImposedMotion imposed = imposeMotion(bonds_, o_.moved);
    NodeField<double> load;
    if (!o_.tractions.empty())
      load = tractionLoad(bonds_, o_.tractions);
    NodeField<double> velocity(bonds_.layout());
    if (o_.startVelocity)
      o_.startVelocity(velocity);
    for (int c = 0; c < bonds_.dimension(); ++c)
      for (std::int64_t i = 0; i < bonds_.layout().count(); ++i)
      {
        double& v = velocity.component(c)[i];
        const bool held = ((imposed.fixed[i] >> c) & 1U) != 0;
        v = !bonds_.solid(i) ? 0
          : held             ? imposed.velocity.component(c)[i]
                             : v + o_.velocity[static_cast<std::size_t>(c)];
      }
    motion_ = std::make_unique<BondDynamics>(bonds_, std::move(imposed.fixed), std::move(m));
    if (goesOn)
      return;
    motion_->setState(NodeField<double>(bonds_.layout()), velocity);
    if (!o_.tractions.empty())
      motion_->setLoad(std::move(load));
  }

  /// Refuses a motion so slow, or so long, that nobody would see its end. @throws ParameterError
  void requireAnEnd() const
  {
    constexpr double most = 1e12; // steps: of the smallest sample, days
    const double start = std::isfinite(r_.firstBreak) ? (1 - o_.pull->startShare) * r_.firstBreak : 0;
    if (pull_ && start / r_.strainRate / motion_->step() > most)
      throw ParameterError(fmt::format("at a strain rate of {:.3g} 1/s it takes {:.2g} steps until the first break",
                             r_.strainRate, start / r_.strainRate / motion_->step()),
        fmt::format(
          "give a larger one: 30 travel times until then make it {:.2g} 1/s", r_.firstBreak / (30 * r_.travelTime)));
    if (!pull_ && o_.ends.time != never && o_.ends.time / motion_->step() > most)
      throw ParameterError(fmt::format("until {:.3g} s it takes {:.2g} steps of {:.3g} s", o_.ends.time,
                             o_.ends.time / motion_->step(), motion_->step()),
        "give the time at which the motion has done what you want to see, as 1e-4");
  }

  /// A point of the history. @return whether the run has come to an end there
  bool look(std::int64_t last)
  {
    MotionPoint p;
    p.step = motion_->steps();
    p.time = motion_->time();
    p.strain = gauge_->strain(motion_->displacement());
    p.stress = stress();
    p.rate = motion_->rate();
    p.energies = motion_->energies();
    p.broken = static_cast<std::int64_t>(motion_->broken().size());
    history_.add(p);
    if (pull_ && p.broken > 0 && p.stress < o_.ends.stopShare * history_.peak())
      r_.end = MotionEnd::StressFell;
    else if (p.broken >= o_.ends.broken)
      r_.end = MotionEnd::MaxBroken;
    else if (std::abs(p.strain) >= std::min(o_.ends.strain, pull_ ? 1 : never))
      r_.end = MotionEnd::MaxStrain;
    else if (p.step >= last)
      r_.end = MotionEnd::Time;
    else
      return false;
    return true;
  }

  [[nodiscard]] double stress()
  {
    if (pull_)
      return pull_->stress(motion_->force());
    if (bonds_.periodic() == std::array{ false, false, false })
      return meanStress(
        bonds_, motion_->force(), motion_->displacement(), true, continuum_)[static_cast<std::size_t>(r_.axis)];
    if (!stress_)
      stress_.emplace(bonds_.layout(), bonds_.dimension() == 2 ? 3 : 6);
    nodalStress(bonds_, motion_->displacement(), *stress_, true);
    return meanStress(bonds_, *stress_, continuum_)[static_cast<std::size_t>(r_.axis)];
  }

  void keep(bool last)
  {
    if (!o_.keep)
      return;
    const double begin = lamella::seconds();
    MotionState s;
    s.time = motion_->time();
    s.strain = gauge_->strain(motion_->displacement());
    s.stress = stress();
    s.last = last;
    s.number = r_.statesBefore + kept_++;
    s.axis = r_.axis;
    s.lowPlaten = r_.lowPlaten;
    s.highPlaten = r_.highPlaten;
    s.broken = static_cast<std::int64_t>(motion_->broken().size());
    for (; counted_ < motion_->broken().size(); ++counted_)
      damage_.add(motion_->broken()[counted_].bond);
    s.bonds = damage_.counts();
    s.damage = damage_.damage();
    s.displacement = motion_->displacement();
    measure(s, bonds_, o_.stress, o_.energyDensity, true);
    if (!o_.displacement)
      s.displacement.reset();
    if (o_.velocities)
      s.velocity = motion_->velocity();
    o_.keep(std::move(s));
    r_.stateSeconds += lamella::seconds() - begin;
  }

  [[nodiscard]] bool told(double) const { return o_.progress({}, 0); }
  [[nodiscard]] bool told(const DynamicsProgress& p) const
  {
    double share = std::max(p.time / o_.ends.time, static_cast<double>(p.broken) / static_cast<double>(o_.ends.broken));
    if (!history_.points().empty())
    {
      const double strain = std::abs(history_.points().back().strain);
      share = std::max(share, strain / o_.ends.strain);
      // A pull mostly ends at some two to three times the strain of the first break.
      if (pull_ && std::isfinite(r_.firstBreak))
        share = std::max(share, std::min(0.9, strain / (3 * r_.firstBreak)));
    }
    return o_.progress(p, std::min(share, 1.0));
  }

  const DynamicsStudyOptions& o_;
  BondLattice& bonds_;
  DynamicsResult& r_;
  Continuum continuum_;
  NodeDamage damage_;
  std::int64_t kept_ = 0;    ///< states
  std::int64_t shared_ = 0;  ///< states asked for that are one with another
  std::int64_t looked_ = -1; ///< broken bonds where states were looked for last; -1: it is not known
  std::size_t counted_ = 0;  ///< broken bonds that damage_ knows
  MotionHistory history_;
  std::optional<SlowPull> pull_;
  std::unique_ptr<MotionGauge> gauge_;
  std::unique_ptr<BondDynamics> motion_;
  std::optional<NodeField<double>> stress_;
  std::vector<std::string> unwritten_; ///< what stood in the way of checkpoints; on rank 0
};

} // namespace

DynamicsResult studyDynamics(const BondModel& model, const Lattice& lattice, std::span<const std::uint8_t> phase,
  std::span<const std::int32_t> grain, const DynamicsStudyOptions& options, const Communicator& comm)
{
  check(options);
  const ThreadScope threads(options.threads);
  requireMemory(
    "motion", lattice, dynamicsBytes(model, lattice, !grain.empty(), options, comm.size()), options.memory, comm);
  DynamicsResult r;
  double begin = lamella::seconds();
  BondLattice bonds(model, lattice, phase, grain, comm);
  static_cast<SampleCounts&>(r) = countSample(bonds, model, phase);
  r.bondSeconds = lamella::seconds() - begin;
  begin = lamella::seconds();
  MotionRun run(model, lattice, phase, options, bonds, r);
  r.startSeconds = lamella::seconds() - begin;
  run.go();
  std::vector<BrokenBond> broken;
  for (const DynamicBreak& b : r.broken)
    broken.push_back({ .bond = b.bond });
  r.ends = endsOf(bonds, broken, phase, grain);
  r.bytes = comm.sum(bonds.bytes() + 8 * bonds.layout().count() * 3 * bonds.dimension());
  addWarnings(model, r);
  return r;
}

} // namespace lamella::peridynamics
