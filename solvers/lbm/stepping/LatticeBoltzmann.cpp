#include "lbm/stepping/LatticeBoltzmann.h"

#include "core/Clock.h"
#include "core/Error.h"
#include "core/Together.h"
#include "lbm/stepping/Accuracy.h"
#include "lbm/stepping/Impl.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace lamella::lbm
{
namespace
{

// Overshoot of a value before it is called divergence: the telegraph-like waves of a large time step double it at most.
constexpr double overshoot = 1e3;
constexpr std::int64_t reportEvery = 64; // steps
constexpr double known = 0.3;            // error of the flux below which the time step is chosen by it

// What a quantity that settles still has to change, from how much it changed between looks: the largest changes of the
// last few looks and of those before tell how fast they fade, though the quantity may swing.
class Trend
{
public:
  /// @param change since the last look  @return the estimate; as large as the quantity may be while too little is known
  double toCome(double change)
  {
    changes_[count_++ % changes_.size()] = change;
    if (count_ < changes_.size())
      return std::numeric_limits<double>::infinity();
    double late = 0;
    double early = 0;
    for (std::size_t k = 0; k < half; ++k)
    {
      late = std::max(late, changes_[(count_ - 1 - k) % changes_.size()]);
      early = std::max(early, changes_[(count_ - 1 - half - k) % changes_.size()]);
    }
    const double share = early > 0 ? std::min(std::pow(late / early, 1.0 / half), slowest) : 0.0;
    return late * std::max(1.0, share / (1 - share));
  }

private:
  static constexpr std::size_t half = 4;
  static constexpr double slowest = 1 - 1e-4; // round-off does not fade
  std::array<double, 2 * half> changes_{};
  std::size_t count_ = 0;
};

} // namespace

const char* name(Collision collision) noexcept
{
  switch (collision)
  {
    case Collision::Auto:
      return "auto";
    case Collision::BGK:
      return "bgk";
    case Collision::TRT:
      return "trt";
  }
  return "";
}

LatticeBoltzmann::LatticeBoltzmann(const Lattice& lattice, const Block& block, std::span<const std::uint8_t> phase,
  std::span<const double> diffusivity, SteppingOptions options, MPI_Comm comm)
  : impl_(std::make_unique<Impl>(lattice, comm, std::move(options)))
{
  Impl& m = *impl_;
  m.diffusivity.assign(diffusivity.begin(), diffusivity.end());
  together(m.comm, [&] { m.check(block, phase); });
  m.build(phase);
  if (!m.options.steady)
    start(0.0);
  else
  {
    const int axis = m.options.axis;
    const bool faces = m.options.sides[axis] == Boundary::Fixed;
    const double low = faces ? m.options.faceValues[axis][0] : 0.0;
    const double fall = faces ? low - m.options.faceValues[axis][1] : m.options.drop;
    const double shift = m.two || !faces ? 0.5 : 0.0;
    m.fill([&](std::int64_t, const std::array<std::int64_t, 3>& p)
      { return low - fall * (static_cast<double>(p[axis]) + shift) / m.length(axis); });
    m.allowUpTo(std::max(std::fabs(low), std::fabs(fall)));
    m.initial = "an even fall";
  }
  io::checkPlace(m.options.checkpoint, m.comm);
}

LatticeBoltzmann::~LatticeBoltzmann() = default;
LatticeBoltzmann::LatticeBoltzmann(LatticeBoltzmann&&) noexcept = default;
LatticeBoltzmann& LatticeBoltzmann::operator=(LatticeBoltzmann&&) noexcept = default;

void LatticeBoltzmann::Impl::relaxAt(double other)
{
  // Σ c f = flux δt (Λ + ½)/Λ with δt ~ Λ: only the odd half of each pair of populations changes
  const double before = relaxation;
  double* f = sweep->data();
  for (std::size_t r = 0; r < map->rows().size(); ++r)
    map->forEach(r,
      [&](std::int32_t node, std::int64_t)
      {
        const double share = diffusivity[sweep->phase()[node]] / largest;
        const double factor = (other * share + 0.5) / (before * share + 0.5);
        for (int q = velocities.rest; q < velocities.count(); q += 2)
        {
          double& a = f[q * map->stride() + node];
          double& b = f[(q + 1) * map->stride() + node];
          const double even = 0.5 * (a + b);
          const double odd = 0.5 * (a - b) * factor;
          a = even + odd;
          b = even - odd;
        }
      });
  dt *= other / before;
  relaxation = other;
  sweep->relaxAt(rates());
}

void LatticeBoltzmann::Impl::allowUpTo(double magnitude)
{
  for (int a = 0; a < lattice.dimension; ++a)
    if (options.sides[a] == Boundary::Fixed)
      for (const double u : options.faceValues[a])
        magnitude = std::max(magnitude, std::fabs(u));
  magnitude = overshoot * std::max(magnitude, std::fabs(options.drop));
  mostSquares = magnitude * magnitude * static_cast<double>(lattice.count());
  steps = 0;
  savedAt = 0;
  records.clear();
}

void LatticeBoltzmann::start(double value)
{
  require(std::isfinite(value), fmt::format("the initial value {} is not finite", value), "give a finite number");
  impl_->fill([&](std::int64_t, const std::array<std::int64_t, 3>&) { return value; });
  impl_->allowUpTo(std::fabs(value));
  impl_->initial = fmt::format("{}", value);
}

void LatticeBoltzmann::start(std::span<const double> value)
{
  Impl& m = *impl_;
  double most = 0;
  std::int64_t sum = 0; // tells fields apart, whichever rank holds the node
  together(m.comm,
    [&]
    {
      require(value.size() == static_cast<std::size_t>(m.parts.block().count()),
        fmt::format("{} initial values were given for a block of {} nodes", value.size(), m.parts.block().count()),
        "hand over one number a node of this rank's block");
      m.fill(
        [&](std::int64_t index, const std::array<std::int64_t, 3>& p)
        {
          if (!std::isfinite(value[index]))
            throw ParameterError(fmt::format("the initial value {} of node {} is not finite", value[index], index),
              "give finite numbers where the picture conducts");
          most = std::max(most, std::fabs(value[index]));
          sum += mark(m.lattice.index(p[0], p[1], p[2]), std::bit_cast<std::uint64_t>(value[index]));
          return value[index];
        });
    });
  m.allowUpTo(m.comm.max(most));
  m.initial = fmt::format("a field ({:x})", m.comm.sum(sum));
}

void LatticeBoltzmann::Impl::report(double fraction, const char* what) const
{
  if (options.progress && comm.any(!options.progress(std::clamp(fraction, 0.0, 1.0), what)))
    throw Cancelled();
}

void LatticeBoltzmann::Impl::advance(std::int64_t count)
{
  const auto start = Clock::now();
  for (std::int64_t left = count / 2; left > 0;)
  {
    const int pairs = static_cast<int>(std::min<std::int64_t>(left, sweep->pairsAtOnce()));
    const double squares = comm.sum(sweep->advance(pairs));
    left -= pairs;
    steps += 2 * pairs;
    stepped += 2 * pairs;
    if (!std::isfinite(squares) || squares > mostSquares)
      throw DivergenceError(
        fmt::format("the values {} at step {} (time {:.4g} s): their root mean square is {:.3g}",
          std::isfinite(squares) ? "grow without bound" : "are no longer finite", steps,
          static_cast<double>(steps) * dt, std::sqrt(squares / static_cast<double>(lattice.count()))),
        "use two relaxation times (trt) or a smaller time step");
  }
  seconds += secondsSince(start);
}

void LatticeBoltzmann::advance(std::int64_t steps)
{
  Impl& m = *impl_;
  require(steps >= 0 && steps % 2 == 0, fmt::format("{} steps cannot be taken", steps),
    "steps come in pairs: give an even number");
  const std::int64_t to = m.steps + steps;
  while (m.steps < to)
  {
    const std::int64_t piece = std::max<std::int64_t>(reportEvery, std::int64_t{ 2 } * m.sweep->pairsAtOnce());
    m.advance(std::min(piece, to - m.steps));
    try
    {
      m.report(1 - static_cast<double>(to - m.steps) / static_cast<double>(steps), "stepping");
    }
    catch (const Cancelled&)
    {
      saveAfter(1);
      throw;
    }
    saveEvery();
  }
}

void LatticeBoltzmann::saveAfter(std::int64_t steps)
{
  Impl& m = *impl_;
  if (!m.options.checkpoint.path.empty() && steps > 0 && m.steps - m.savedAt >= steps)
    save();
}

void LatticeBoltzmann::saveEvery()
{
  const io::CheckpointOptions& o = impl_->options.checkpoint;
  if (!o.path.empty() && impl_->pace.due(o, impl_->comm))
    saveAfter(o.every);
}

void LatticeBoltzmann::run(std::span<const std::int64_t> steps, const Sink& sink)
{
  Impl& m = *impl_;
  std::int64_t before = m.steps;
  for (const std::int64_t s : steps)
  {
    require(s >= before && s % 2 == 0, fmt::format("step {} cannot be reached from step {}", s, before),
      "give even numbers that do not fall, none before the present one");
    before = s;
  }
  for (const std::int64_t to : steps)
  {
    advance(to - m.steps);
    if (!m.records.empty() && m.records.back().steps == to) // a checkpoint that was written here
      m.records.pop_back();
    m.records.push_back({ to, time(), m.resolvedFlux(), mean() });
    sink(*this);
  }
  if (!(impl_->options.checkpoint.seconds > 0))
    saveAfter(1);
}

std::int64_t LatticeBoltzmann::stepsAt(double time) const
{
  constexpr double most = 1e15; // steps: no run takes as many, and no number of them is lost
  require(std::isfinite(time) && time >= 0 && time / impl_->dt < most,
    fmt::format("a time of {} s cannot be reached in steps of {} s", time, impl_->dt), "give a time in seconds");
  return 2 * std::llround(time / (2 * impl_->dt));
}

void LatticeBoltzmann::run(std::span<const double> times, const Sink& sink)
{
  double before = time() - impl_->dt;
  std::vector<std::int64_t> steps;
  for (const double t : times)
  {
    require(t >= before, fmt::format("a time of {} s cannot be reached from {} s", t, before),
      "give rising times in seconds, none before the present one");
    before = t;
    steps.push_back(std::max(stepsAt(t), impl_->steps));
  }
  run(steps, sink);
}

std::span<const SteppingRecord> LatticeBoltzmann::records() const noexcept
{
  return impl_->records;
}

double LatticeBoltzmann::Impl::length(int axis) const
{
  const bool onNodes = !two && options.sides[axis] != Boundary::Periodic;
  return static_cast<double>(lattice.size[axis] - (onNodes ? 1 : 0));
}

double LatticeBoltzmann::Impl::across() const
{
  double area = 1;
  for (int a = 0; a < lattice.dimension; ++a)
    area *= a == options.axis ? 1.0 : length(a);
  return area;
}

std::array<double, 2> LatticeBoltzmann::Impl::crossing() const
{
  std::array<double, 2> sums{};
  const double* f = sweep->data();
  for (std::size_t k = 0; k < 2; ++k)
  {
    sums[k] = planes[k].constant;
    for (const auto& [slot, weight] : planes[k].terms)
      sums[k] += weight * f[slot];
  }
  comm.sum(sums);
  for (double& s : sums)
    s /= across();
  return sums;
}

std::array<double, 2> LatticeBoltzmann::faceFlux() const
{
  if (impl_->steps == 0)
    return {};
  auto flux = impl_->crossing();
  for (double& f : flux)
    f *= impl_->lattice.spacing / impl_->dt;
  return flux;
}

// Beside a face whose value differs from the one within the flux is √(D/(π t)) times the difference. Of that stepping
// has 10 % too much once √(D t) is a node's distance, 3 % at twice that; before, any number, also of the wrong sign.
std::array<double, 2> LatticeBoltzmann::Impl::resolvedFlux() const
{
  std::array<double, 2> flux{};
  if (steps == 0)
    return flux;
  flux = crossing();
  const double time = static_cast<double>(steps) * dt;
  for (std::size_t k = 0; k < 2; ++k)
  {
    const bool deep = std::sqrt(atFaces[k] * time) >= (1 - 1e-9) * lattice.spacing;
    const bool fixed = options.sides[options.axis] == Boundary::Fixed;
    flux[k] *= lattice.spacing / dt;
    if (fixed && !deep && flux[k] != 0)
      flux[k] = std::numeric_limits<double>::quiet_NaN();
  }
  return flux;
}

RestResult LatticeBoltzmann::rest(const RestOptions& options)
{
  Impl& m = *impl_;
  require(options.tolerance > 0 && options.tolerance < 1,
    fmt::format("tolerance {} is not between 0 and 1", options.tolerance),
    "ask for the relative error of the face fluxes, for instance 1e-8");
  const int axis = m.options.axis;
  const bool faces = m.options.sides[axis] == Boundary::Fixed;
  const double fall = faces ? m.options.faceValues[axis][0] - m.options.faceValues[axis][1] : m.options.drop;
  require(fall != 0, "no flux is driven through the box, so there is none to come to rest",
    "fix different values on the two faces, or give a drop between periodic sides");
  const bool alone = m.onlyAxisFixed();
  const double perStep = m.length(axis) * m.lattice.spacing * m.lattice.spacing / fall;
  // Between two looks the slowest mode fades by a good third at the best scale; see restRelaxation().
  const std::int64_t window = 2 * std::max<std::int64_t>(10, m.lattice.size[axis] / 8);
  RestResult result;
  std::array<double, 2> before = m.crossing();
  std::array<Trend, 2> trends;
  const std::int64_t from = m.steps;
  int adaptations = 0;
  for (bool calm = false; !calm;)
  {
    if (m.steps - from >= options.maxSteps)
      throw StepLimitError(
        fmt::format("after {} steps the flux through the faces still changes by {:.1e} and differs by {:.1e} between "
                    "them (asked for {:.1e})",
          m.steps - from, result.change, result.balance, options.tolerance),
        "allow more steps, loosen the tolerance, or leave the time step to trt");
    m.advance(window);
    const std::array<double, 2> now = m.crossing();
    result.change = 0;
    for (std::size_t k = 0; k < 2; ++k)
      result.change =
        std::max(result.change, trends[k].toCome(std::fabs(now[k] - before[k])) / std::max(std::fabs(now[k]), 1e-300));
    before = now;
    result.inletFlux = now[0] * perStep / m.dt;
    result.outletFlux = now[1] * perStep / m.dt;
    result.effective = 0.5 * (result.inletFlux + result.outletFlux);
    result.balance = std::fabs(result.inletFlux - result.outletFlux) / std::fabs(result.effective);
    double worse = std::max(result.change, result.balance);
    // Faces that say the same, and slowly, are not enough: a symmetric picture's always do.
    if (worse <= options.tolerance && alone)
    {
      result.balance = std::max(result.balance, m.unrest(0.5 * (now[0] + now[1]), fall));
      worse = std::max(worse, result.balance);
    }
    calm = worse <= options.tolerance;
    if (m.adapts && adaptations < 4 && worse < known && result.effective > 0)
    {
      const double better = m.restRelaxation(result.effective);
      if (std::fabs(std::log(better / m.relaxation)) > 0.15)
      {
        m.relaxAt(better);
        before = m.crossing();
        trends = {};
        ++adaptations;
      }
    }
    m.report(std::clamp(std::log(std::min(worse, 1.0)) / std::log(options.tolerance), 0.0, 1.0), "coming to rest");
    saveEvery();
  }
  result.steps = m.steps - from;
  return result;
}

std::int64_t LatticeBoltzmann::steps() const noexcept
{
  return impl_->steps;
}
double LatticeBoltzmann::time() const noexcept
{
  return static_cast<double>(impl_->steps) * impl_->dt;
}
double LatticeBoltzmann::timeStep() const noexcept
{
  return impl_->dt;
}
double LatticeBoltzmann::relaxation() const noexcept
{
  return impl_->relaxation;
}

std::int64_t LatticeBoltzmann::checkpoints() const noexcept
{
  return impl_->checkpoints;
}
std::int64_t LatticeBoltzmann::lastCheckpoint() const noexcept
{
  return impl_->lastCheckpoint;
}

std::string LatticeBoltzmann::warning() const
{
  return impl_->two ? std::string() : singleRateWarning(impl_->relaxation, impl_->chords);
}

namespace
{

/// Means of a uniform bar that empties through both faces are off by 0.8/n² at most; n: 2 to 20 nodes.
std::string fewNodesWarning(std::int64_t nodes, Boundary ends)
{
  constexpr std::int64_t enough = 8;
  if (ends != Boundary::Fixed || nodes >= enough)
    return "";
  return fmt::format("the sample is {} node{} long in the direction: means on the way may be off by {:.1g} of the "
                     "difference of the values. Split its pixels, or take a longer one",
    nodes, nodes == 1 ? "" : "s", std::min(0.3, 0.8 / static_cast<double>(nodes * nodes)));
}

} // namespace

std::string LatticeBoltzmann::shortRunWarning(std::int64_t steps) const
{
  const Impl& m = *impl_;
  double least = 1; // over the largest
  for (const Chord& c : m.chords)
    if (c.diffusivity > 0)
      least = std::min(least, c.diffusivity);
  const double time = static_cast<double>(steps) * m.dt;
  const double depth = std::sqrt(least * m.largest * time);
  if (depth >= m.lattice.spacing)
    return fewNodesWarning(m.lattice.size[m.options.axis], m.options.sides[m.options.axis]);
  return fmt::format(
    "in {:.3g} s the value goes {:.2g} of a node's distance deep where the diffusivity is {:.3g} m²/s, "
    "which the lattice does not resolve: means and fluxes that depend on it are off, and through a face that has "
    "nothing better the flux is not told; a longer run, a finer lattice, or 0 there",
    time, depth / m.lattice.spacing, least * m.largest);
}

SteppingStatistics LatticeBoltzmann::statistics() const
{
  const Impl& m = *impl_;
  SteppingStatistics s;
  s.nodes = m.lattice.count();
  s.stored = m.comm.sum(m.map->stored());
  s.skipped = s.nodes - s.stored;
  s.steps = m.stepped;
  s.updates = s.stored * m.stepped;
  s.seconds = m.seconds;
  s.bytes = static_cast<std::uint64_t>(m.comm.sum(static_cast<std::int64_t>(m.sweep->bytes() + m.map->bytes())));
  s.bytesPerUpdate = 8.0 * m.velocities.count() + 0.5;
  return s;
}

} // namespace lamella::lbm
