#include "lbm/stepping/LatticeBoltzmann.h"

#include "lattice/Clock.h"
#include "lattice/Error.h"
#include "lattice/Memory.h"
#include "lattice/Together.h"
#include "lbm/Connectivity.h"
#include "lbm/stepping/Accuracy.h"
#include "lbm/stepping/Impl.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lamella::lbm
{
namespace
{

constexpr double usual = 0.5; // relaxation where nothing is asked for
// Overshoot of a value before it is called divergence: the telegraph-like waves of a large time step double it at most.
constexpr double overshoot = 1e3;
constexpr std::int64_t reportEvery = 64; // steps

void require(bool fine, const std::string& message, const char* hint)
{
  if (!fine)
    throw ParameterError(message, hint);
}

int dimensionOf(Stencil stencil)
{
  return stencil == Stencil::D2Q5 || stencil == Stencil::D2Q9 ? 2 : 3;
}

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

LatticeBoltzmann::Impl::Impl(const Lattice& box, MPI_Comm handle, SteppingOptions given)
  : lattice(box)
  , comm(handle)
  , parts(box, comm)
  , options(std::move(given))
  , velocities(options.stencil)
  , two(options.collision != Collision::BGK)
{
}

void LatticeBoltzmann::Impl::check(const Block& block, std::span<const std::uint8_t> phase) const
{
  require(dimensionOf(options.stencil) == lattice.dimension,
    fmt::format("lattice {} does not fit a {}-dimensional picture", name(options.stencil), lattice.dimension),
    lattice.dimension == 2 ? "use d2q5 or d2q9" : "use d3q7 or d3q19");
  require(options.axis >= 0 && options.axis < lattice.dimension,
    fmt::format("there is no axis {} in {} dimensions", options.axis, lattice.dimension),
    lattice.dimension == 2 ? "choose 0 (x) or 1 (y)" : "choose 0 (x), 1 (y) or 2 (z)");
  require(parts.block().size == block.size && parts.block().start == block.start,
    "this rank's block is not the one of decompose()",
    "hand over the part of the lattice that decompose(lattice, comm) names");
  require(phase.size() == static_cast<std::size_t>(block.count()),
    fmt::format("{} phase ids were given for a block of {} nodes", phase.size(), block.count()),
    "hand over one id a node of this rank's block");
  require(std::isfinite(lattice.spacing) && lattice.spacing > 0,
    fmt::format("a spacing of {} m is not above 0", lattice.spacing), "give the distance of two nodes in metres");
  require(options.threads >= 1, fmt::format("{} threads are too few", options.threads), "allow at least 1");
  for (std::size_t i = 0; i < diffusivity.size(); ++i)
    require(std::isfinite(diffusivity[i]) && diffusivity[i] >= 0,
      fmt::format("diffusivity {} of phase {} is not a finite number of at least 0", diffusivity[i], i),
      "give a positive value in m²/s, or 0 for a phase that does not conduct");
  for (const std::uint8_t id : phase)
    require(id < diffusivity.size(), fmt::format("phase {} has no diffusivity", id), "give one value for each phase");
  for (int a = 0; a < lattice.dimension; ++a)
  {
    if (options.sides[a] == Boundary::Fixed)
      for (const double u : options.faceValues[a])
        require(std::isfinite(u), fmt::format("the value {} on a face is not finite", u), "give finite numbers");
    require(two || options.sides[a] == Boundary::Periodic || lattice.size[a] > 1,
      fmt::format("bgk has its faces on the outer nodes, and there is one node along {}", "xyz"[a]),
      "use two relaxation times (trt), whose faces are half a spacing outside, or at least 2 nodes");
  }
  require(std::isfinite(options.drop) && (options.drop == 0 || options.sides[options.axis] == Boundary::Periodic),
    fmt::format("the value cannot fall by {} over the box", options.drop),
    "a finite drop goes with periodic sides along the axis; values on faces with fixed ones");
  require(!options.steady || options.sides[options.axis] == Boundary::Fixed ||
      (options.sides[options.axis] == Boundary::Periodic && options.drop != 0),
    "no flux is driven through the box, so there is none to come to rest",
    "fix values on the faces of the axis, or give a drop between periodic sides");
  require(options.relaxation == 0 || options.timeStep == 0, "both a relaxation and a time step were given",
    "one follows from the other: leave one of them at 0");
  require(std::isfinite(options.relaxation) && options.relaxation >= 0,
    fmt::format("a relaxation time τ of {} is not above ½", options.relaxation + 0.5),
    "the diffusivity is (τ − ½) δx²/(3 δt): choose τ > ½");
  require(std::isfinite(options.timeStep) && options.timeStep >= 0,
    fmt::format("a time step of {} s is not above 0", options.timeStep), "give a time in seconds, or none");
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
  }
  io::checkPlace(m.options.checkpoint, m.comm);
}

LatticeBoltzmann::~LatticeBoltzmann() = default;
LatticeBoltzmann::LatticeBoltzmann(LatticeBoltzmann&&) noexcept = default;
LatticeBoltzmann& LatticeBoltzmann::operator=(LatticeBoltzmann&&) noexcept = default;

NodeSet LatticeBoltzmann::Impl::participants(const Halo& halo, std::span<const std::uint8_t> phase) const
{
  const Block& block = parts.block();
  const bool onlyAxis = std::none_of(options.sides.begin(), options.sides.begin() + lattice.dimension,
    [&](const Boundary& b) { return b == Boundary::Fixed && &b != &options.sides[options.axis]; });
  if (options.steady && onlyAxis) // faces across another axis hold what leads to them, too
  {
    const Links links(lattice, options.stencil, options.sides, diffusivity);
    Percolation found = findPercolation(lattice, parts, halo, comm, links, options.axis, phase);
    if (!found.exists)
      throw NoPathError(fmt::format("no conducting path leads across the box along {}", "xyz"[options.axis]),
        "give the phase that should conduct a diffusivity above 0, or choose another window or direction");
    found.carrying.number();
    return std::move(found.carrying);
  }
  NodeSet set(block.size[0], halo);
  for (std::int64_t z = 0; z < block.size[2]; ++z)
    for (std::int64_t y = 0; y < block.size[1]; ++y)
      for (std::int64_t x = 0; x < block.size[0]; ++x)
        if (diffusivity[phase[x + block.size[0] * (y + block.size[1] * z)]] > 0)
          set.insert(halo.row(y, z), x);
  set.exchange(halo);
  set.number();
  return set;
}

SlotSides LatticeBoltzmann::Impl::slotSides() const
{
  SlotSides s;
  s.boundary = options.sides;
  s.value = options.faceValues;
  s.onNodes = !two;
  s.drop[options.axis] = options.drop;
  return s;
}

void LatticeBoltzmann::Impl::build(std::span<const std::uint8_t> phase)
{
  const Block& block = parts.block();
  std::array<std::int64_t, 256> counts{};
  for (const std::uint8_t id : phase)
    ++counts[id];
  std::int64_t conducting = 0;
  std::int64_t sum = 0; // of a number from phase and place, whichever rank holds the node
  for (std::size_t id = 0; id < diffusivity.size() && id < counts.size(); ++id)
    if (diffusivity[id] > 0 && counts[id] > 0)
    {
      conducting += counts[id];
      largest = std::max(largest, diffusivity[id]);
    }
  largest = comm.max(largest);
  conducting = comm.sum(conducting);
  if (conducting == 0)
    throw NoPathError("no node of the picture conducts", "give at least one phase that occurs a diffusivity above 0");
  const double needed = static_cast<double>(conducting) * (8.0 * velocities.count() + 1) / comm.size() +
    static_cast<double>(block.count()) / 4;
  const auto available = static_cast<double>(availableMemory());
  if (comm.any(needed > available))
    throw MemoryError(fmt::format("stepping on {} nodes needs about {} on each rank, and {} are available", conducting,
                        bytesText(needed), bytesText(available)),
      "use a smaller window or refinement, a lattice of fewer populations, or more machines with mpirun");
  for (std::int64_t z = 0, i = 0; z < block.size[2]; ++z)
    for (std::int64_t y = 0; y < block.size[1]; ++y)
      for (std::int64_t x = 0; x < block.size[0]; ++x, ++i)
      {
        const auto at = static_cast<std::uint64_t>(lattice.index(x, y + block.start[1], z + block.start[2]));
        sum += static_cast<std::int64_t>(((at + 1) * (phase[i] + 1) * 0x9E3779B97F4A7C15ULL) >> 34);
      }
  phaseSum = fmt::format("{:x}", comm.sum(sum));
  chooseTime(phase);

  const std::array<bool, 3> periodic{ options.sides[0] == Boundary::Periodic, options.sides[1] == Boundary::Periodic,
    options.sides[2] == Boundary::Periodic && lattice.dimension == 3 };
  const Halo halo(lattice.dimension, block.size, parts, comm, periodic);
  map = std::make_unique<SlotMap>(lattice, parts, halo, comm, velocities, slotSides(), participants(halo, phase));
  std::vector<std::uint8_t> stored(static_cast<std::size_t>(map->stride()), 0);
  for (std::size_t r = 0; r < map->rows().size(); ++r)
    map->forEach(r, [&](std::int32_t node, std::int64_t index) { stored[node] = phase[index]; });
  std::vector<double> rate(256, 0.0);
  for (std::size_t id = 0; id < diffusivity.size() && id < rate.size(); ++id)
    if (diffusivity[id] > 0)
      rate[id] = two ? 1 / (0.25 / relaxationOf(diffusivity[id]) + 0.5) : 1 / (relaxationOf(diffusivity[id]) + 0.5);
  const StepLoops& loops = stepKernels().loops[two ? 1 : 0][static_cast<int>(options.stencil)];
  sweep = std::make_unique<Sweep>(*map, comm, loops, std::move(stored), std::move(rate), block.size,
    periodic[1] && parts.parts()[1] == 1, options.threads);
  planes = map->planes(options.axis);
}

void LatticeBoltzmann::Impl::chooseTime(std::span<const std::uint8_t> phase)
{
  const double perTime = 3 * largest / (lattice.spacing * lattice.spacing);
  if (options.timeStep > 0)
    relaxation = options.timeStep * perTime;
  else if (options.relaxation > 0)
    relaxation = options.relaxation;
  else
    relaxation = options.steady && two ? restRelaxation(phase) : usual;
  dt = relaxation / perTime;
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
}

void LatticeBoltzmann::start(double value)
{
  require(std::isfinite(value), fmt::format("the initial value {} is not finite", value), "give a finite number");
  impl_->fill([&](std::int64_t, const std::array<std::int64_t, 3>&) { return value; });
  impl_->allowUpTo(std::fabs(value));
}

void LatticeBoltzmann::start(std::span<const double> value)
{
  Impl& m = *impl_;
  double most = 0;
  together(m.comm,
    [&]
    {
      require(value.size() == static_cast<std::size_t>(m.parts.block().count()),
        fmt::format("{} initial values were given for a block of {} nodes", value.size(), m.parts.block().count()),
        "hand over one number a node of this rank's block");
      m.fill(
        [&](std::int64_t index, const std::array<std::int64_t, 3>&)
        {
          require(std::isfinite(value[index]), fmt::format("the initial value {} of node {} is not finite",
                    value[index], index), "give finite numbers where the picture conducts");
          most = std::max(most, std::fabs(value[index]));
          return value[index];
        });
    });
  m.allowUpTo(m.comm.max(most));
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
    if (!(squares <= mostSquares))
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
    const std::int64_t piece =
      std::max<std::int64_t>(reportEvery, std::int64_t{ 2 } * m.sweep->pairsAtOnce());
    m.advance(std::min(piece, to - m.steps));
    m.report(1 - static_cast<double>(to - m.steps) / static_cast<double>(steps), "stepping");
    if (!m.options.checkpoint.path.empty() && m.options.checkpoint.every > 0 &&
      m.steps - m.savedAt >= m.options.checkpoint.every)
      save();
  }
}

void LatticeBoltzmann::run(std::span<const double> times, const Sink& sink)
{
  Impl& m = *impl_;
  double before = time() - m.dt;
  for (const double t : times)
  {
    require(std::isfinite(t) && t >= before, fmt::format("a time of {} s cannot be reached from {} s", t, before),
      "give rising times in seconds, none before the present one");
    before = t;
  }
  for (const double t : times)
  {
    const std::int64_t to = 2 * std::llround(t / (2 * m.dt));
    advance(std::max<std::int64_t>(to - m.steps, 0));
    sink(*this);
  }
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
  auto flux = impl_->crossing();
  for (double& f : flux)
    f *= impl_->lattice.spacing / impl_->dt;
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
  const double toConductivity = m.length(axis) * m.lattice.spacing * m.lattice.spacing / (m.dt * fall);
  // Between two looks the slowest mode fades by a good third at the best scale; see restRelaxation().
  const std::int64_t window = 2 * std::max<std::int64_t>(10, m.lattice.size[axis] / 8);
  RestResult result;
  std::array<double, 2> before = m.crossing();
  std::array<double, 2> changeBefore{ 1, 1 };
  const std::int64_t from = m.steps;
  for (int calm = 0; calm < 2;)
  {
    if (m.steps - from >= options.maxSteps)
      throw DivergenceError(
        fmt::format("after {} steps the flux through the faces still changes by {:.1e} and differs by {:.1e} between "
                    "them (asked for {:.1e})",
          m.steps - from, result.change, result.balance, options.tolerance),
        "allow more steps, loosen the tolerance, or leave the time step to trt");
    m.advance(window);
    const std::array<double, 2> now = m.crossing();
    result.change = 0;
    for (std::size_t k = 0; k < 2; ++k)
    {
      const double change = std::fabs(now[k] - before[k]);
      // what is still to come, if each window brings the same share of the one before
      const double ratio = std::min(change / std::max(changeBefore[k], 1e-300), 1 - 1e-4);
      result.change =
        std::max(result.change, change * std::max(1.0, ratio / (1 - ratio)) / std::max(std::fabs(now[k]), 1e-300));
      changeBefore[k] = change;
    }
    before = now;
    result.inletFlux = now[0] * toConductivity;
    result.outletFlux = now[1] * toConductivity;
    result.effective = 0.5 * (result.inletFlux + result.outletFlux);
    result.balance = std::fabs(result.inletFlux - result.outletFlux) / std::fabs(result.effective);
    const double worse = std::max(result.change, result.balance);
    calm = worse <= options.tolerance ? calm + 1 : 0;
    m.report(std::clamp(std::log(std::min(worse, 1.0)) / std::log(options.tolerance), 0.0, 1.0), "coming to rest");
    if (!m.options.checkpoint.path.empty() && m.options.checkpoint.every > 0 &&
      m.steps - m.savedAt >= m.options.checkpoint.every)
      save();
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

std::string LatticeBoltzmann::warning() const
{
  return impl_->two ? std::string() : singleRateWarning(impl_->relaxation + 0.5);
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
