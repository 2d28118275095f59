#include "lbm/lean/LeanSystem.h"

#include "core/Error.h"
#include "core/Memory.h"
#include "lbm/BoxField.h"
#include "lbm/Connectivity.h"
#include "lbm/lean/LeanField.h"
#include "lbm/lean/Pieces.h"
#include "lbm/multigrid/Multigrid.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace lamella::lbm
{
namespace
{

// Falls of the energy below this part of it may be round-off of the field.
constexpr double mayBeRoundOff = 1e-5;
constexpr double leastTarget = 1e-13;
constexpr const char* singlePrecision = "single precision is too little here: ";
// What is left of a series that is nearly geometric is known from its last terms; it is taken times `safety`.
constexpr double safety = 4;
// For each residual in double; more are wasted on what single precision keeps of it.
constexpr int cyclesAResidual = 2;
// For the first estimate.
constexpr double first = 3;
// No cycle leaves less than this part of the energy's excess.
constexpr double quickest = 0.002;
// Nor less than this one where a fall may have been hidden by what single precision leaves.
constexpr double hidden = 0.1;
// Falls below this are compared with it.
constexpr double mayHide = 1e-3;
// Relaxation ends where changes fall below the last place, several of these from the solution: by how much that raises
// the energy over what rounding the solution does, over the root of a contrast that is more than mild. Found on spheres
// of contrasts up to 1e7: 3.05 at most, with the kernels for any processor.
constexpr double amplified = 4;
constexpr double mild = 100;
// Cycles that leave more than `slowest` of the energy's excess are given up after that many of them.
constexpr int patience = 3;

// Coarse levels of blocks.
class BlockCorrection
{
public:
  BlockCorrection(LeanField& field, int threads)
    : multigrid_(firstLevel(field, threads), threads, Coarsening::Blocks)
  {
  }
  void correct(LeanField& field)
  {
    Level& coarse = multigrid_.finest();
    field.restrictTo(coarse);
    multigrid_.apply(coarse.f, coarse.u);
    field.addFrom(coarse);
  }
  [[nodiscard]] std::size_t bytes() const { return multigrid_.bytes(); }
  [[nodiscard]] static int sweeps() { return 3; } ///< before and after
  [[nodiscard]] static double slowest() { return 0.5; }
  static constexpr Method method = Method::LeanMultigrid;
  /// Rates rise smoothly, but late where phases differ much.
  [[nodiscard]] static double leastRate(double contrast) { return contrast > mild ? 0.4 : 0; }
  static constexpr const char* tooMuch = "thin walls that insulate are too much for blocks of nodes: ";

private:
  static Level firstLevel(LeanField& field, int threads)
  {
    return std::move(*coarsenBlocks(
      field.level(), [&field](int d, std::int64_t y, std::int64_t z, float* out) { field.linkRow(d, y, z, out); },
      threads));
  }
  Multigrid multigrid_;
};

// Of pieces of blocks.
class PieceCorrection : public PieceMultigrid
{
public:
  using PieceMultigrid::PieceMultigrid;
  static constexpr Method method = Method::PieceMultigrid;
  /// A quick cycle may be followed by a slow one, more so where phases differ much.
  [[nodiscard]] static double leastRate(double contrast) { return contrast > mild ? 0.5 : 0.25; }
  static constexpr const char* tooMuch = "";
};

// The picture without conducting nodes that no flux reaches: a constant is free on such an island, and its round-off
// would be noise in the energy.
struct Masked
{
  Percolation percolation;
  std::vector<std::uint8_t> phase;
  std::int64_t carrying = 0; ///< nodes of this rank that flux reaches

  Masked(const Problem& problem, std::uint8_t blocking)
    : percolation(findPercolation(
        problem.lattice, problem.parts, haloOf(problem), problem.comm, problem.links(), problem.axis, problem.phase))
  {
    if (!percolation.exists)
      throw NoPathError(fmt::format("no conducting path leads across the box along {}", "xyz"[problem.axis]),
        "give the phase that should conduct a conductivity above 0, or choose another window or direction");
    phase.assign(problem.phase.begin(), problem.phase.end());
    forEachNode(problem,
      [&](std::size_t i, std::int64_t row, std::int64_t x)
      {
        if (percolation.carrying.contains(row, x))
          ++carrying;
        else
          phase[i] = blocking;
      },
      { 0, problem.parts.block().size[2] });
  }
  [[nodiscard]] std::size_t bytes() const
  {
    return phase.size() + percolation.carrying.bytes() + percolation.reachesLow.bytes() +
      percolation.reachesHigh.bytes();
  }

  static Halo haloOf(const Problem& problem)
  {
    return { problem.lattice.dimension, problem.parts.block().size, problem.parts, problem.comm, problem.periodic() };
  }
  // f(place in the layers, row with ghosts, x)
  template <class F>
  static void forEachNode(const Problem& problem, F&& f, Layers layers)
  {
    const auto& size = problem.parts.block().size;
    const Halo halo = haloOf(problem);
    std::size_t i = 0;
    for (std::int64_t z = layers.first; z < layers.last; ++z)
      for (std::int64_t y = 0; y < size[1]; ++y)
        for (std::int64_t x = 0; x < size[0]; ++x)
          f(i++, halo.row(y, z), x);
  }
};

template <class Correction>
class LeanSystem final : public Backend
{
public:
  explicit LeanSystem(const Problem& problem, std::unique_ptr<Masked> masked = {})
    : problem_(problem)
    , masked_(std::move(masked))
    , field_(problemOf(problem, masked_.get()))
    , correction_(field_, problem.options.threads)
  {
  }

  SteadyResult solve() override
  {
    SteadyResult result;
    result.method = Correction::method;
    result.nodes = problem_.lattice.count();
    result.stored = masked_ ? problem_.comm.sum(masked_->carrying) : result.nodes;
    result.skipped = result.nodes - result.stored;
    result.bytes = static_cast<std::uint64_t>(problem_.comm.sum(static_cast<std::int64_t>(
      correction_.bytes() + field_.bytes() + problem_.phase.size() + (masked_ ? masked_->bytes() : 0))));

    const SteadyOptions& options = problem_.options;
    const bool periodic = options.sides == Sides::Periodic;
    double target = std::min(options.tolerance, options.fieldTolerance * options.fieldTolerance);
    if (periodic) // the rest of a periodic cell's column errs like the field
      target = std::min(target, options.tolerance * options.tolerance);
    target = std::max(target, leastTarget);

    FieldSums sums;
    PlaneSums planes;
    const auto energyNow = [&]
    {
      sums = field_.sums(planes);
      return PlaneBalance(planes, sums.energy, periodic).energy;
    };
    const double differing = contrast();
    const double amplification = differing > mild ? amplified * std::sqrt(differing) : safety;
    double energy = energyNow();
    profileEnergy_ = sums.energy;
    double fall = std::numeric_limits<double>::quiet_NaN(); // of the energy in a cycle, relative
    double rate = fall;                                     // of the falls
    int slow = 0;
    for (;;)
    {
      if (result.iterations >= options.maxIterations)
        fail(result, "");
      field_.relax(correction_.sweeps(), true);
      correction_.correct(field_);
      field_.relax(correction_.sweeps(), false);
      ++result.iterations;

      const double now = energyNow();
      if (!std::isfinite(now) || !(now > 0))
        fail(result, "");
      const double fallBefore = std::exchange(fall, (std::exchange(energy, now) - now) / now);
      const double rateBefore = std::exchange(rate, fall / fallBefore);
      const bool lost = isLost(sums);
      if (std::abs(fall) <= mayBeRoundOff && !lost)
        if (const double noise = field_.roundOff() / sums.energy; std::abs(fall) <= safety * noise)
        {
          result.solverError = amplification * noise;
          if (wantsDouble(result, target))
            return refined(result, target);
          break;
        }
      // A cycle does not raise the energy but by round-off, which tells nothing of what is left.
      const bool rises = fall < 0 || lost;
      slow = rate > correction_.slowest() || rate < 0 || rises ? slow + 1 : 0;
      if (slow == patience)
      {
        const bool rounded =
          !lost && std::abs(fall) <= std::max(mayBeRoundOff, 10 * amplification * field_.roundOff() / sums.energy);
        result.solverError = rounded ? safety * std::abs(fall) : 1.0;
        if (rounded && Correction::method == Method::PieceMultigrid)
          return refined(result, target);
        fail(result, rounded ? singlePrecision : Correction::tooMuch);
      }
      // The rate rises to that of the slowest part of the error, by less and less. The first one tells little: the
      // linear profile is not what a cycle leaves.
      if (std::isnan(rate) || (std::isnan(rateBefore) && !options.rough))
        continue;
      const double rising = std::isnan(rateBefore) ? 0.0 : rate - rateBefore;
      const double next = std::max({ Correction::leastRate(differing), rate, rate + rising });
      double left = rate > 0 && next < 1 && !rises ? safety * fall * next / (1 - next) : 1.0;
      if (result.solverError > 0) // one fall may be small by chance
      {
        const double rest = std::abs(fall) <= mayHide ? amplification * field_.roundOff() / sums.energy : 0.0;
        left = std::max(left, std::min(1.0, result.solverError) * (fall < safety * rest ? hidden : quickest));
      }
      else // of two rates nobody knows whether they rise
        left *= first;
      result.solverError = left;
      reportProgress(options, problem_.comm, progressOf(result.solverError, target), "solving");
      if (result.solverError > target || slow > 0)
        continue;
      const double rest = amplification * field_.roundOff() / sums.energy; // comes on top
      if (result.solverError + rest > target && rest < target)
        continue;
      result.solverError += rest;
      if (wantsDouble(result, target))
        return refined(result, target);
      break;
    }
    if (!(energy <= sums.energy * (1 + PlaneBalance::loosest))) // the planes' fluxes are round-off
      return refined(result, target);
    balance_.emplace(planes, sums.energy, periodic);
    setEffective(result, balance_->of(sums, planes), problem_.lattice, problem_.axis, field_.links().scale());
    return result;
  }

  void value(std::span<double> out, Layers layers) const override
  {
    if (!mean_)
      mean_ = exact_ ? exact_->mean() : balancedField().mean();
    exact_ ? exact_->value(out, layers, *mean_) : field_.value(out, layers, *mean_);
    if (!masked_)
      return;
    const bool periodic = problem_.options.sides == Sides::Periodic;
    const Percolation& p = masked_->percolation;
    Masked::forEachNode(
      problem_,
      [&](std::size_t i, std::int64_t row, std::int64_t x)
      {
        if (p.carrying.contains(row, x))
          return;
        const bool low = !periodic && p.reachesLow.contains(row, x);
        const bool high = !periodic && p.reachesHigh.contains(row, x);
        out[i] = low ? 1.0 : high ? 0.0 : std::numeric_limits<double>::quiet_NaN();
      },
      layers);
  }
  void flux(std::span<double> out, Layers layers) const override
  {
    exact_ ? exact_->flux(out, layers) : balancedField().flux(out, layers);
  }
  [[nodiscard]] bool hasPlanes() const override
  {
    if (exact_ || masked_)
      return false;
    (void)balancedField(); // before threads ask for planes
    return true;
  }
  void plane(std::int64_t z, double* out) const override { field_.plane(z, out); }
  [[nodiscard]] FieldEnergies energies() const override
  {
    return { exact_ ? exact_->linkEnergies() : balancedField().linkEnergies(), {}, {} };
  }

private:
  // Cycles that diverge leave a field worse than the linear profile that they began with. Balanced, it is that of the
  // planes alone, whose energy no cycle changes: as if all were solved.
  [[nodiscard]] bool isLost(const FieldSums& sums) const
  {
    return !(sums.energy <= profileEnergy_ * (1 + mayBeRoundOff));
  }
  [[nodiscard]] bool memoryForDouble() const
  {
    const double more = static_cast<double>(problem_.parts.block().count()) * 14;
    return !problem_.comm.any(more > static_cast<double>(availableMemory()));
  }
  // Where memory is too short for that, a field as exact as single precision holds it has to do, if its value is exact
  // enough.
  [[nodiscard]] bool wantsDouble(const SteadyResult& result, double target) const
  {
    if (result.solverError <= target)
      return false;
    const SteadyOptions& options = problem_.options;
    return options.sides == Sides::Periodic || result.solverError > options.tolerance || memoryForDouble();
  }

  // What single precision leaves is taken off in double: cycles for the residual of a field that is, until the energy
  // falls no more.
  SteadyResult refined(SteadyResult result, double target)
  {
    if (!memoryForDouble())
      fail(result, singlePrecision);
    const Problem problem = problemOf(problem_, masked_.get());
    exact_ = std::make_unique<BoxField>(problem);
    exact_->setLinearProfile();
    const auto forRows = [&](auto&& f)
    {
      for (std::int64_t z = 0; z < field_.size()[2]; ++z)
        for (std::int64_t y = 0; y < field_.size()[1]; ++y)
          f(y, z);
    };
    const double unit = 1.0 / static_cast<double>(problem.lattice.size[static_cast<std::size_t>(problem.axis)]);
    forRows([&](std::int64_t y, std::int64_t z) { field_.addRow(y, z, unit, exact_->rowValues(y, z)); });
    const bool periodic = problem.options.sides == Sides::Periodic;
    FieldSums sums;
    PlaneSums planes;
    const auto evaluate = [&]
    {
      field_.startCorrection();
      planes = PlaneSums(exact_->planeCount());
      sums = exact_->evaluate(
        [&](std::int64_t y, std::int64_t z, const double* r) { field_.setResidual(y, z, r); }, &planes);
      return PlaneBalance(planes, sums.energy, periodic).energy;
    };
    double energy = evaluate();
    double fall = 0;
    std::array<double, 3> rates{ 1, 1, 1 };
    const double differing = contrast();
    int slow = 0;
    result.bytes += static_cast<std::uint64_t>(problem_.comm.sum(
      static_cast<std::int64_t>(exact_->bytes() + 4 * static_cast<std::size_t>(problem_.parts.block().count()))));
    for (;;)
    {
      if (result.iterations >= problem.options.maxIterations)
        fail(result, "");
      for (int cycle = 0; cycle < cyclesAResidual; ++cycle)
      {
        field_.relax(correction_.sweeps(), true);
        correction_.correct(field_);
        field_.relax(correction_.sweeps(), false);
        ++result.iterations;
      }
      forRows([&](std::int64_t y, std::int64_t z) { field_.addRow(y, z, 1.0, exact_->rowValues(y, z)); });
      const double now = evaluate();
      if (!std::isfinite(now) || !(now > 0))
        fail(result, "");
      const double before = std::exchange(fall, (std::exchange(energy, now) - now) / now);
      rates = { rates[1], rates[2], before > 0 ? std::abs(fall) / before : 1.0 };
      const double rate = std::max(std::ranges::max(rates), Correction::leastRate(differing));
      // where nothing falls any more it is double precision that ends it
      const bool lost = isLost(sums);
      result.solverError = lost        ? 1.0
        : std::abs(fall) < leastTarget ? leastTarget
        : rate < 1                     ? safety * std::abs(fall) * rate / (1 - rate)
                                       : 1.0;
      reportProgress(problem.options, problem.comm, progressOf(result.solverError, target), "solving");
      if (result.solverError <= target)
        break;
      slow = rates[2] > correction_.slowest() || lost ? slow + 1 : 0;
      if (slow == 2 * patience)
        fail(result, Correction::tooMuch);
    }
    const double unbalanced = sums.energy;
    exact_->apply(PlaneBalance(planes, unbalanced, periodic));
    (void)evaluate();
    PlaneBalance::requireGain(unbalanced, sums.energy);
    setEffective(result, sums, problem.lattice, problem.axis, field_.links().scale());
    return result;
  }

  static Problem problemOf(Problem problem, const Masked* masked)
  {
    if (masked != nullptr)
      problem.phase = masked->phase;
    return problem;
  }

  // Of the links that conduct.
  [[nodiscard]] double contrast() const
  {
    double least = std::numeric_limits<double>::infinity();
    double most = 0;
    for (std::size_t table = 0; table < field_.links().tables(); ++table)
      for (const std::uint8_t a : field_.ids())
        for (const std::uint8_t b : field_.ids())
          if (const double link = field_.links().mean(a, b, static_cast<int>(table)); link > 0)
          {
            least = std::min(least, link);
            most = std::max(most, link);
          }
    return most > 0 ? most / least : 1.0;
  }

  [[nodiscard]] LeanField& balancedField() const
  {
    if (balance_)
      field_.apply(*balance_);
    balance_.reset();
    return field_;
  }

  [[noreturn]] void fail(const SteadyResult& result, const char* why) const
  {
    throw DivergenceError(
      fmt::format("{}the value still errs by {:.1e} after {} {} iterations (asked for {:.1e})", why, result.solverError,
        result.iterations, name(Correction::method), problem_.options.tolerance),
      why == singlePrecision ? "take multigrid or algebraic-multigrid, or a larger tolerance"
                             : "leave the method at auto, or take multigrid or algebraic-multigrid");
  }

  Problem problem_;
  std::unique_ptr<Masked> masked_; ///< where some phase does not conduct
  mutable LeanField field_;
  mutable std::optional<PlaneBalance> balance_; ///< not yet applied to the field
  mutable std::optional<double> mean_;          ///< of the field, once it was asked for
  Correction correction_;
  std::unique_ptr<BoxField> exact_; ///< in double, where single precision was too little
  double profileEnergy_ = 0;        ///< of the linear profile
};

} // namespace

namespace
{

// Single precision holds no more beside each other; of three phases over ten decades some values erred unnoticed.
constexpr double mostContrast = 1e8;

// Straight links, and sizes that blocks of nodes fill.
bool blocksFit(const Problem& problem)
{
  if (problem.contrast() > mostContrast || problem.table != nullptr ||
    (problem.options.stencil != Stencil::D2Q5 && problem.options.stencil != Stencil::D3Q7))
    return false;
  if (problem.comm.parallel() && problem.parts.levels() == 0)
    return false;
  const auto periodic = problem.periodic();
  for (std::size_t a = 0; a < 3; ++a)
    if (periodic[a] && problem.lattice.size[a] % 2 != 0)
      return false;
  return true;
}

// Blocks of 2 × 2 × 2 nodes want links that are alike along all axes: beyond a ratio of spacings of 2 they correct too
// much along the weak one.
bool nearlyCubes(const Lattice& lattice)
{
  double least = std::numeric_limits<double>::infinity();
  double most = 0;
  for (std::size_t a = 0; a < 3; ++a)
    if (lattice.size[a] > 1)
    {
      least = std::min(least, lattice.aspect[a]);
      most = std::max(most, lattice.aspect[a]);
    }
  return most <= 2.1 * least;
}

} // namespace

bool leanFits(const Problem& problem)
{
  return blocksFit(problem) && nearlyCubes(problem.lattice);
}

std::uint64_t leanBytes(const Lattice& lattice)
{
  const auto floats = [&](const std::array<std::int64_t, 3>& n)
  {
    // in doubles: a refinement typed wrongly can have more nodes than 64 bits count
    const double rows = static_cast<double>(n[1] + 2) * static_cast<double>(lattice.dimension == 3 ? n[2] + 2 : 1);
    return rows * static_cast<double>(Grid(2, n[0], 1, 1).stride);
  };
  std::array<std::int64_t, 3> n = lattice.size;
  double total = floats(n);
  while (canHalve(n, { false, false, false }))
  {
    for (auto& size : n)
      size = (size + 1) / 2;
    total += floats(n) * (lattice.dimension + 2); // links, correction, right-hand side
  }
  return static_cast<std::uint64_t>(std::min(total, 1e18)) * sizeof(float);
}

std::unique_ptr<Backend> makeLeanSystem(const Problem& problem)
{
  return std::make_unique<LeanSystem<BlockCorrection>>(problem);
}

bool piecesFit(const Problem& problem)
{
  return blocksFit(problem);
}

std::unique_ptr<Backend> makePieceSystem(const Problem& problem)
{
  // the least id that does not conduct, of all ranks
  const double none = static_cast<double>(problem.diffusivity.size());
  double blocking = none;
  for (const std::uint8_t id : problem.phase)
    if (!(problem.diffusivity[id] > 0))
      blocking = std::min(blocking, static_cast<double>(id));
  blocking = -problem.comm.max(-blocking);
  return std::make_unique<LeanSystem<PieceCorrection>>(
    problem, blocking == none ? nullptr : std::make_unique<Masked>(problem, static_cast<std::uint8_t>(blocking)));
}

} // namespace lamella::lbm
