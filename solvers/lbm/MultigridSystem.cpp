#include "lbm/MultigridSystem.h"

#include "core/Error.h"
#include "lbm/BoxField.h"
#include "lbm/LanczosSpectrum.h"
#include "lbm/multigrid/Multigrid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#ifdef __SSE2__
#include <xmmintrin.h>
#endif

namespace lamella::lbm
{
namespace
{

// The largest coarsest level that is still cheap to factorise, when periodic sides stop the halving early.
constexpr std::int64_t directLimit2 = 50000;
constexpr std::int64_t directLimit3 = 16000;

// When the error falls by less than this factor in two iterations running, V-cycles give way to W-cycles.
constexpr double slowRate = 0.35;

// The estimate of the error knows the spectrum as far as the iteration has. So it is taken times `safety`, and a
// tolerance looser than `loosest` ends no iteration before the spectrum has shown. (Measured:
// benchmarks/Diffusion.cpp.)
constexpr double safety = 4;
constexpr double loosest = 1e-8;
constexpr double tightest = 1e-20; // round-off of the residual is near

// Where answers are rough: by how much the first iterations' estimate was too low at worst, on tissues, grains and
// balls at contrasts of 10 to 1000, is a thirtieth of the contrast.
constexpr double seenAtOnce = 30;

// Both faces carry the effective flux but for round-off, which grows with the contrast: 4e-2 of it at 1e15. Up to here
// it is told as the solver's error; beyond nothing is told.
constexpr double loosestBalance = 1e-3;
constexpr const char* beyondDouble = "a contrast near 1e16 is beyond double precision: give the phases that conduct "
                                     "least 0, or those that conduct best less";

// Weak links between well conducting regions may be a mode that V-cycles hardly see, with an eigenvalue of a hundred
// over the contrast, and few iterations know nothing of it. Beyond this contrast r·z has to fall by as much more.
constexpr double mildContrast = 1e8;

// The residual is replaced when r·z has fallen by this factor.
constexpr double replaceAfter = 1e-6;

// Numbers too small for single precision become zero at once instead of slowing every operation down, while in scope.
class FlushDenormals
{
public:
#ifdef __SSE2__
  FlushDenormals()
    : saved_(_mm_getcsr())
  {
    _mm_setcsr(saved_ | 0x8040U); // flush to zero, denormals are zero
  }
  ~FlushDenormals()
  {
    _mm_setcsr(saved_);
  }

private:
  unsigned saved_;
#else
  FlushDenormals() {}
  ~FlushDenormals() {}

private:
#endif
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;
};

class MultigridSystem final : public Backend
{
public:
  explicit MultigridSystem(const Problem& problem)
    : problem_(problem)
    , field_(problem)
    , multigrid_(finestLevel(), problem.options.threads)
    , r_(multigrid_.finest().grid.floats(), 0.0F)
    , p_(r_.size(), 0.0F)
    , z_(r_.size(), 0.0F)
  {
  }

  SteadyResult solve() override
  {
    SteadyResult result;
    result.method = Method::Multigrid;
    result.nodes = problem_.lattice.count();
    result.stored = result.nodes;
    result.bytes = static_cast<std::uint64_t>(problem_.comm.sum(static_cast<std::int64_t>(multigrid_.bytes() +
      field_.bytes() + problem_.phase.size() + (r_.size() + p_.size() + z_.size()) * sizeof(float))));

    const double tolerance = problem_.options.tolerance;
    const double fieldTolerance = problem_.options.fieldTolerance;
    // Wanted square of the field's error. The rest of a periodic cell's column errs like the field.
    const double roughly = std::max(1e-5, tolerance * std::min(1.0, seenAtOnce / problem_.contrast()));
    double target =
      std::min({ tolerance, fieldTolerance * fieldTolerance, problem_.options.rough ? roughly : loosest });
    if (problem_.options.sides == Sides::Periodic)
      target = std::min(target, std::max(tolerance * tolerance, tightest));
    field_.setLinearProfile();
    const FlushDenormals flush;
    FieldSums sums = evaluate();
    const double firstNorm = std::sqrt(sums.residual2);
    // A residual that is nothing but the round-off of link fluxes of about 1 / n: the linear profile was the answer.
    const double roundOff = 1e-14 * std::sqrt(static_cast<double>(problem_.lattice.count())) /
      static_cast<double>(problem_.lattice.size[static_cast<std::size_t>(problem_.axis)]);
    if (!(firstNorm <= roundOff))
    {
      residualNorm_ = firstNorm;
      forEachRow([&](std::int64_t, std::int64_t, std::int64_t row, const Grid& g)
        { scaleRow(row, g, static_cast<float>(1.0 / firstNorm)); });
      iterate(result, sums, target, roundOff);
    }
    setEffective(result, sums, problem_.lattice, problem_.axis, field_.links().scale());
    result.residual = firstNorm > 0 ? std::sqrt(sums.residual2) / firstNorm : 0.0;
    // With contrasts near 1e16 round-off is all of the small fluxes, and the residual does not show it: the faces do.
    if (!(result.balance <= std::max(tolerance, loosestBalance)))
      throw DivergenceError(fmt::format("the flux through the faces differs from the effective one by {:.1e} of it "
                                        "after {} iterations",
                              result.balance, result.iterations),
        PlaneBalance::beyondDouble);
    if (result.balance > tolerance || !(result.solverError >= 0))
      result.solverError = result.balance;
    return result;
  }

  void value(std::span<double> out, Layers layers) const override
  {
    if (!mean_)
      mean_ = field_.mean();
    field_.value(out, layers, *mean_);
  }
  void flux(std::span<double> out, Layers layers) const override { field_.flux(out, layers); }
  [[nodiscard]] FieldEnergies energies() const override { return { field_.linkEnergies(), {}, {} }; }

private:
  [[nodiscard]] Level finestLevel() const;
  void setLinks(Level& level) const;
  void setWalls(Level& level) const;

  // Conjugate gradients in single precision. Now and then the residual is computed anew from the field, in double
  // precision, and takes the place of the recurrence's (van der Vorst & Ye, SIAM J. Sci. Comput. 22 (2000) 835); the
  // search direction stays, so nothing that was learnt about the spectrum is lost.
  // target: wanted square of the field's error; roundOff: of a residual
  void iterate(SteadyResult& result, FieldSums& sums, double target, double roundOff)
  {
    LanczosSpectrum spectrum;
    const double strict = target * std::min(1.0, mildContrast / problem_.contrast());
    double rz = 0;         // r·z of the last iteration
    double reference = -1; // r·z when the residual was last replaced
    int stagnant = 0;
    int slow = 0;
    bool replaced = true;
    bool restart = true;
    for (;;)
    {
      multigrid_.apply(r_, z_);
      const double rzNew = problem_.comm.sum(dot(r_, z_));
      if (!std::isfinite(rzNew))
        throw DivergenceError(fmt::format("the residual is not finite after {} iterations", result.iterations),
          "please report this with the picture and the conductivities");
      // r·A⁻¹r is the square of the error's energy norm; z = M r, so it lies below r·z over the least eigenvalue of MA
      const double error =
        safety * std::max(rzNew, 0.0) * residualNorm_ * residualNorm_ / (spectrum.smallest() * sums.energy);
      result.solverError = error;
      const bool exhausted = !(rzNew > 0);
      // Of a residual that is fresh: the answer, or more than single precision can precondition. To try again from the
      // same field would go on for ever.
      const bool nothingLeft = exhausted && replaced;
      if (nothingLeft && std::sqrt(sums.residual2) > roundOff)
        fail(result, 1, std::sqrt(target));
      bool converged = nothingLeft || (!exhausted && error <= strict && !spectrum.empty());
      if (replaced)
      {
        stagnant = reference >= 0 && rzNew > 0.25 * reference ? stagnant + 1 : 0;
        if (stagnant == 3 && !exhausted && error <= target && !spectrum.empty()) // as far as double precision goes
          converged = true;
        if (stagnant == 3 && !converged)
          fail(result, std::sqrt(error), std::sqrt(target));
        reference = rzNew;
      }
      if (converged || exhausted || (!replaced && rzNew <= replaceAfter * reference))
      {
        PlaneSums planes(converged ? field_.planeCount() : 0);
        const bool fresh = replaced;
        double drift = 0;
        sums = evaluate(converged ? &planes : nullptr, &drift);
        reportProgress(problem_.options, problem_.comm, progressOf(error, target), "solving");
        if (converged && (fresh || (drift < 0.1 && spectrum.smallest() > 0.3)))
        {
          balancePlanes(planes, sums);
          return;
        }
        restart = restart || exhausted;
        replaced = true;
        continue;
      }
      if (result.iterations >= problem_.options.maxIterations)
        fail(result, std::sqrt(error), std::sqrt(target));
      // weakly conducting walls between well conducting cells are too much for a V-cycle
      slow = !restart && rzNew > slowRate * slowRate * rz ? slow + 1 : 0;
      if (slow == 2 && multigrid_.visits() == 1)
      {
        multigrid_.setVisits(2);
        restart = true;
        slow = 0;
        replaced = false;
        continue;
      }
      const double beta = restart ? 0.0 : rzNew / rz;
      if (restart)
        spectrum.restart();
      restart = replaced = false;
      rz = rzNew;
      const double alpha = step(rz, static_cast<float>(beta));
      if (!(alpha > 0))
      {
        // nothing left to gain in this direction: round-off, which the true residual will show
        sums = evaluate();
        restart = replaced = true;
        if (++stagnant > 3)
          fail(result, std::sqrt(error), std::sqrt(target));
        continue;
      }
      spectrum.add(alpha, beta);
      ++result.iterations;
      reportProgress(
        problem_.options, problem_.comm, 0.02 + 0.2 * (1 - std::exp(-result.iterations / 10.0)), "solving");
    }
  }

  void balancePlanes(const PlaneSums& planes, FieldSums& sums)
  {
    const double before = sums.energy;
    const PlaneBalance balance(planes, before, problem_.options.sides == Sides::Periodic);
    field_.apply(balance);
    sums = problem_.options.rough ? balance.of(sums, planes) : evaluate();
    PlaneBalance::requireGain(before, sums.energy);
  }

  // The residual, in units of its first norm, takes the place of what is in r_. `drift`: how far that was off.
  FieldSums evaluate(PlaneSums* planes = nullptr, double* drift = nullptr)
  {
    const Grid& g = multigrid_.finest().grid;
    const double scale = 1.0 / residualNorm_;
    std::array<double, 2> apart{ 0, 0 };
    const FieldSums sums = field_.evaluate(
      [&](std::int64_t y, std::int64_t z, const double* residual)
      {
        float* even = r_.data() + g.row(y, z);
        const auto set = [&](std::int64_t i, double value)
        {
          const float now = static_cast<float>(scale * value);
          const float off = now - even[i];
          apart[0] += static_cast<double>(off * off);
          apart[1] += static_cast<double>(now * now);
          even[i] = now;
        };
        for (std::int64_t i = 0; i < g.odd; ++i)
        {
          set(i, residual[2 * i]);
          set(g.half + i, residual[2 * i + 1]);
        }
        if (g.even > g.odd)
          set(g.odd, residual[2 * g.odd]);
      },
      planes);
    if (drift != nullptr)
    {
      problem_.comm.sum(apart);
      *drift = apart[1] > 0 ? std::sqrt(apart[0] / apart[1]) : 0;
    }
    return sums;
  }

  // p = z + β p, then one step along p; returns its length, 0 when p carries no energy (round-off).
  double step(double rz, float beta)
  {
    const double pq = problem_.comm.sum(multigrid_.advance(z_, beta, p_, z_));
    if (!(pq > 0))
      return 0;
    const float alpha = static_cast<float>(rz / pq); // the same for field and residual, or they would drift apart
    const double length = static_cast<double>(alpha) * residualNorm_;
    forEachRow(
      [&](std::int64_t y, std::int64_t z, std::int64_t row, const Grid& g)
      {
        kernels().axpy(g.even, -alpha, z_.data() + row, r_.data() + row);
        kernels().axpy(g.odd, -alpha, z_.data() + row + g.half, r_.data() + row + g.half);
        double* u = field_.rowValues(y, z);
        const float* even = p_.data() + row;
        const float* odd = even + g.half;
        for (std::int64_t i = 0; i < g.odd; ++i)
        {
          u[2 * i] += length * static_cast<double>(even[i]);
          u[2 * i + 1] += length * static_cast<double>(odd[i]);
        }
        if (g.even > g.odd)
          u[2 * g.odd] += length * static_cast<double>(even[g.odd]);
      });
    return alpha;
  }

  [[noreturn]] void fail(const SteadyResult& result, double error, double wanted) const
  {
    throw DivergenceError(fmt::format("the field still errs by {:.1e} after {} multigrid iterations (asked for {:.1e})",
                            error, result.iterations, wanted),
      "choose a larger tolerance, or method algebraic-multigrid for a contrast as large as this");
  }

  void scaleRow(std::int64_t row, const Grid& g, float scale)
  {
    for (const std::int64_t begin : { row, row + g.half })
      for (std::int64_t i = 0; i < (begin == row ? g.even : g.odd); ++i)
        r_[static_cast<std::size_t>(begin + i)] *= scale;
  }

  double dot(const FloatArray& a, const FloatArray& b) const
  {
    const Grid& g = multigrid_.finest().grid;
    std::vector<double> sums(static_cast<std::size_t>(g.ny * g.nz));
    forEachRow(
      [&](std::int64_t y, std::int64_t z, std::int64_t row, const Grid&)
      {
        sums[static_cast<std::size_t>(y + g.ny * z)] = kernels().dot(g.even, a.data() + row, b.data() + row) +
          kernels().dot(g.odd, a.data() + row + g.half, b.data() + row + g.half);
      });
    double total = 0;
    for (const double s : sums)
      total += s;
    return total;
  }

  // f(y, z, begin of the split row, grid), rows over the threads.
  template <class F>
  void forEachRow(F&& f) const
  {
    const Grid& g = multigrid_.finest().grid;
    const int threads = std::max(1, problem_.options.threads);
#pragma omp parallel for num_threads(threads) if (threads > 1) schedule(static)
    for (std::int64_t i = 0; i < g.ny * g.nz; ++i)
      f(i % g.ny, i / g.ny, g.row(i % g.ny, i / g.ny), g);
  }

  Problem problem_;
  BoxField field_;
  mutable std::optional<double> mean_; ///< of the field, once it was asked for
  Multigrid multigrid_;
  double residualNorm_ = 1; // of the first residual: r, p and z are in units of it
  FloatArray r_;            // residual
  FloatArray p_;            // search direction
  FloatArray z_;            // preconditioned residual, then A p
};

Level MultigridSystem::finestLevel() const
{
  const Block& block = problem_.parts.block();
  const int dimension = problem_.lattice.dimension;
  Level level;
  level.grid = Grid(dimension, block.size[0], block.size[1], block.size[2]);
  level.periodic = problem_.periodic();
  level.straight = problem_.options.stencil == Stencil::D2Q5 || problem_.options.stencil == Stencil::D3Q7;
  level.start = block.start;
  level.size = problem_.lattice.size;
  level.comm = std::make_unique<Communicator>(problem_.comm);
  level.parts = std::make_unique<Decomposition>(problem_.parts);
  level.halo = field_.halo();
  level.allocateLinks(level.straight ? dimension : dimension == 3 ? 13 : 4);
  setLinks(level);
  setWalls(level);
  if (!level.straight)
    computeInverse(level);
  return level;
}

// Of the nodes, those beyond the faces left out.
void MultigridSystem::setLinks(Level& level) const
{
  const Links& links = field_.links();
  const Block& block = problem_.parts.block();
  const Grid& g = level.grid;
  const int(*directions)[3] = g.dimension == 3 ? directions3 : directions2;
  for (int d = 0; d < level.directions(); ++d)
  {
    const Direction direction{ directions[d][0], directions[d][1], directions[d][2] };
    if (direction.axes() > 2)
      continue; // the eight corners of the cube carry no link on D3Q19
    FloatArray& array = level.links[static_cast<std::size_t>(d)];
    for (std::int64_t z = 0; z < g.nz; ++z)
      for (std::int64_t y = 0; y < g.ny; ++y)
      {
        const std::array<std::int64_t, 3> p{ 0, y + block.start[1], z + block.start[2] };
        const auto weightAt = [&](std::int64_t x) { return links.weight(direction, { x, p[1], p[2] }); };
        float* row = array.data() + g.row(y, z);
        const double inner = g.nx > 2 ? weightAt(1) : 0.0;
        const double first = weightAt(0);
        const double last = weightAt(g.nx - 1);
        if (inner == 0.0 && first == 0.0 && last == 0.0)
          continue;
        const double* given = links.given(direction, p[1]);
        const std::uint8_t* here = field_.rowPhase(y, z);
        const std::uint8_t* there = field_.rowPhase(y + direction.y, z + direction.z);
        const auto set = [&](std::int64_t x, double weight)
        {
          std::int64_t other = x + direction.x;
          other = other < 0 ? other + g.nx : other >= g.nx ? other - g.nx : other;
          row[g.node(x)] = static_cast<float>(
            given != nullptr ? given[x] : weight * links.mean(here[x], there[other], direction.axis()));
        };
        if (first != 0.0)
          set(0, first);
        if (given != nullptr)
          for (std::int64_t x = 1; x < g.nx - 1; ++x)
            row[g.node(x)] = static_cast<float>(given[x]);
        else
          for (std::int64_t x = 1; x < g.nx - 1; ++x)
            row[g.node(x)] = static_cast<float>(inner * links.mean(here[x], there[x + direction.x], direction.axis()));
        if (last != 0.0)
          set(g.nx - 1, last);
      }
  }
}

// Links to the ghosts of value zero beyond the faces, and what neighbours have of the others: a link is stored at its
// lower end, so a wall along x comes before these are exchanged, others after it.
void MultigridSystem::setWalls(Level& level) const
{
  const Links& links = field_.links();
  const Block& block = problem_.parts.block();
  const Grid& g = level.grid;
  const int axis = problem_.axis;
  const bool periodic = problem_.options.sides == Sides::Periodic;
  const auto wall = [&](std::int64_t x, std::int64_t y, std::int64_t z, bool high)
  {
    return static_cast<float>(
      links.wall(field_.rowPhase(y, z)[x], { x, y + block.start[1], z + block.start[2] }, axis, high));
  };
  if (!periodic && axis == 0)
    for (std::int64_t z = 0; z < g.nz; ++z)
      for (std::int64_t y = 0; y < g.ny; ++y)
      {
        float* row = level.links[0].data() + g.row(y, z);
        row[g.node(-1)] = wall(0, y, z, false);
        row[g.node(g.nx - 1)] = wall(g.nx - 1, y, z, true);
      }
  for (FloatArray& array : level.links)
    level.exchange(array);
  if (!periodic && axis > 0)
  {
    FloatArray& array = level.links[static_cast<std::size_t>(axis)];
    const auto a = static_cast<std::size_t>(axis);
    const std::array<std::int64_t, 3> size{ g.nx, g.ny, g.nz };
    for (const bool high : { false, true })
    {
      const bool atFace = high ? block.start[a] + size[a] == problem_.lattice.size[a] : block.start[a] == 0;
      if (!atFace)
        continue;
      const std::int64_t across = axis == 1 ? g.nz : g.ny;
      for (std::int64_t i = 0; i < across; ++i)
      {
        const std::int64_t y = axis == 1 ? (high ? g.ny - 1 : 0) : i;
        const std::int64_t z = axis == 1 ? i : (high ? g.nz - 1 : 0);
        // the link is stored at its lower end
        float* row = array.data() + (high ? g.row(y, z) : axis == 1 ? g.row(-1, z) : g.row(y, -1));
        for (std::int64_t x = 0; x < g.nx; ++x)
          row[g.node(x)] = wall(x, y, z, high);
      }
    }
  }
}

} // namespace

bool multigridFits(const Lattice& lattice, Sides sides)
{
  const bool p = sides != Sides::Insulated; // of mixed ones all but one axis, whichever is solved for
  const std::array<bool, 3> periodic{ p, p, p && lattice.dimension == 3 };
  std::array<std::int64_t, 3> size = lattice.size;
  while (canHalve(size, periodic))
    for (auto& n : size)
      n = (n + 1) / 2;
  return size[0] * size[1] * size[2] <= (lattice.dimension == 3 ? directLimit3 : directLimit2);
}

std::unique_ptr<Backend> makeMultigridSystem(const Problem& problem)
{
  return std::make_unique<MultigridSystem>(problem);
}

} // namespace lamella::lbm
