#include "lbm/MultigridSystem.h"

#include "lattice/Error.h"
#include "lbm/BoxField.h"
#include "lbm/multigrid/Multigrid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace lamella::lbm
{
namespace
{

// The largest coarsest level that is still cheap to factorise, when periodic sides stop the halving early.
constexpr std::int64_t directLimit2 = 50000;
constexpr std::int64_t directLimit3 = 16000;

// Below this reduction of the error an iteration a V-cycle is left for a W-cycle: weakly conducting walls that part
// well conducting cells need the coarse levels twice.
constexpr double slowRate = 0.18;

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

    field_.setLinearProfile();
    double firstResidual = 0;
    double previousBalance = 0;
    int stagnant = 0;
    for (int cycle = 0;; ++cycle)
    {
      const FieldSums sums = evaluate();
      setEffective(result, sums, problem_.lattice, problem_.axis, field_.links().scale());
      if (cycle == 0)
        firstResidual = sums.residual2;
      result.residual = firstResidual > 0 ? std::sqrt(sums.residual2 / firstResidual) : 0.0;
      reportProgress(
        problem_.options, problem_.comm, progressOf(result.balance, problem_.options.tolerance), "solving");
      if (!std::isfinite(result.balance))
        throw DivergenceError(fmt::format("the flux is not finite after {} iterations", result.iterations),
          "please report this with the picture and the conductivities");
      if (sums.residual2 == 0 || (cycle > 0 && result.balance <= problem_.options.tolerance))
        break;
      stagnant = cycle > 1 && result.balance > 0.3 * previousBalance ? stagnant + 1 : 0;
      if (result.iterations >= problem_.options.maxIterations || stagnant == 3)
        throw DivergenceError(
          fmt::format("the face fluxes still differ by {:.1e} after {} multigrid iterations (asked for {:.1e})",
            result.balance, result.iterations, problem_.options.tolerance),
          "loosen --tolerance, or use --method algebraic-multigrid for a contrast as large as this");
      previousBalance = result.balance;
      // single precision carries about five digits; the last cycle goes no further than it must
      const double wanted =
        cycle == 0 ? 1e-5 : std::clamp(0.1 * problem_.options.tolerance / result.balance, 1e-5, 0.1);
      result.iterations +=
        improve(std::sqrt(sums.residual2), wanted, problem_.options.maxIterations - result.iterations);
    }
    return result;
  }

  void value(std::span<double> out) const override { field_.value(out); }
  void flux(std::span<double> out) const override { field_.flux(out); }

private:
  [[nodiscard]] Level finestLevel();

  // Residual into r_, parts by parity.
  FieldSums evaluate()
  {
    const Grid& g = multigrid_.finest().grid;
    return field_.evaluate(
      [&](std::int64_t y, std::int64_t z, const double* residual)
      {
        float* even = r_.data() + g.row(y, z);
        float* odd = even + g.half;
        for (std::int64_t i = 0; i < g.odd; ++i)
        {
          even[i] = static_cast<float>(residual[2 * i]);
          odd[i] = static_cast<float>(residual[2 * i + 1]);
        }
        if (g.even > g.odd)
          even[g.odd] = static_cast<float>(residual[2 * g.odd]);
      });
  }

  // Conjugate gradients on A e = r_ until the error in the norm of the preconditioner has fallen by `reduction`; adds e
  // to the field. Returns the iterations.
  int improve(double residualNorm, double reduction, int maxIterations)
  {
    // unit scale, so that single precision never under- or overflows
    const float scale = static_cast<float>(1.0 / residualNorm);
    forEachRow([&](std::int64_t, std::int64_t, std::int64_t row, const Grid& g) { scaleRow(row, g, scale); });
    double rz = 0;
    double first = -1;
    double atSwitch = 0;
    int sinceStart = 0;
    for (int iteration = 0;; ++iteration)
    {
      multigrid_.apply(r_, z_);
      const double rzNew = problem_.comm.sum(dot(r_, z_));
      if (!(rzNew > 0) || !std::isfinite(rzNew))
        return iteration;
      if (first < 0)
        first = atSwitch = rzNew;
      if (rzNew <= reduction * reduction * first || iteration >= maxIterations)
        return iteration;

      // too slow for a V-cycle?
      bool restart = sinceStart == 0;
      if (multigrid_.visits() == 1 && sinceStart == 4)
      {
        const double rate = std::pow(rzNew / atSwitch, 0.5 / sinceStart);
        if (rate > slowRate)
        {
          multigrid_.setVisits(2);
          sinceStart = 0;
          continue;
        }
      }
      const float beta = restart ? 0.0F : static_cast<float>(rzNew / rz);
      rz = rzNew;
      forEachRow(
        [&](std::int64_t, std::int64_t, std::int64_t row, const Grid& g)
        {
          kernels().xpby(g.even, z_.data() + row, beta, p_.data() + row);
          kernels().xpby(g.odd, z_.data() + row + g.half, beta, p_.data() + row + g.half);
        });
      const double pq = problem_.comm.sum(multigrid_.multiply(p_, z_));
      if (!(pq > 0))
        return iteration;
      const double alpha = rz / pq;
      forEachRow(
        [&](std::int64_t y, std::int64_t z, std::int64_t row, const Grid& g)
        {
          kernels().axpy(g.even, static_cast<float>(-alpha), z_.data() + row, r_.data() + row);
          kernels().axpy(g.odd, static_cast<float>(-alpha), z_.data() + row + g.half, r_.data() + row + g.half);
          double* u = field_.rowValues(y, z);
          const float* even = p_.data() + row;
          const float* odd = even + g.half;
          const double step = alpha * residualNorm;
          for (std::int64_t i = 0; i < g.odd; ++i)
          {
            u[2 * i] += step * static_cast<double>(even[i]);
            u[2 * i + 1] += step * static_cast<double>(odd[i]);
          }
          if (g.even > g.odd)
            u[2 * g.odd] += step * static_cast<double>(even[g.odd]);
        });
      ++sinceStart;
      reportProgress(problem_.options, problem_.comm,
        0.05 + 0.9 * std::clamp(std::log(rzNew / first) / std::log(1e-16), 0.0, 1.0), "solving");
    }
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
  Multigrid multigrid_;
  FloatArray r_; // residual of the correction
  FloatArray p_; // search direction
  FloatArray z_; // preconditioned residual, then A p
};

Level MultigridSystem::finestLevel()
{
  const Links& links = field_.links();
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
  const Grid& g = level.grid;
  level.allocateLinks(level.straight ? dimension : dimension == 3 ? 13 : 4);
  const int(*directions)[3] = dimension == 3 ? directions3 : directions2;
  const int axis = problem_.axis;
  const bool periodic = problem_.options.sides == Sides::Periodic;

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
        const std::uint8_t* here = field_.rowPhase(y, z);
        const std::uint8_t* there = field_.rowPhase(y + direction.y, z + direction.z);
        const auto set = [&](std::int64_t x, double weight)
        {
          std::int64_t other = x + direction.x;
          other = other < 0 ? other + g.nx : other >= g.nx ? other - g.nx : other;
          row[g.node(x)] = static_cast<float>(weight * links.mean(here[x], there[other]));
        };
        if (first != 0.0)
          set(0, first);
        for (std::int64_t x = 1; x < g.nx - 1; ++x)
          row[g.node(x)] = static_cast<float>(inner * links.mean(here[x], there[x + direction.x]));
        if (last != 0.0)
          set(g.nx - 1, last);
      }
  }

  // walls: links to the ghosts of value zero beyond the faces
  const auto wall = [&](std::uint8_t phase) { return static_cast<float>(links.wall(phase)); };
  if (!periodic && axis == 0)
    for (std::int64_t z = 0; z < g.nz; ++z)
      for (std::int64_t y = 0; y < g.ny; ++y)
      {
        float* row = level.links[0].data() + g.row(y, z);
        row[g.node(-1)] = wall(field_.rowPhase(y, z)[0]);
        row[g.node(g.nx - 1)] = wall(field_.rowPhase(y, z)[g.nx - 1]);
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
          row[g.node(x)] = wall(field_.rowPhase(y, z)[x]);
      }
    }
  }

  if (!level.straight)
  {
    level.inverse.assign(g.floats(), 0.0F);
    for (std::int64_t z = 0; z < g.nz; ++z)
      for (std::int64_t y = 0; y < g.ny; ++y)
        for (const int part : { 0, 1 })
        {
          const float* link[2 * maxForward];
          for (int d = 0; d < level.directions(); ++d)
          {
            const float* array = level.links[static_cast<std::size_t>(d)].data();
            link[2 * d] = array + g.row(y - directions[d][1], z - directions[d][2]) + g.shift(part, -directions[d][0]);
            link[2 * d + 1] = array + g.row(y, z) + g.shift(part, 0);
          }
          kernels().inverseSum(
            2 * level.directions(), g.count(part), level.inverse.data() + g.row(y, z) + g.shift(part, 0), link);
        }
  }
  return level;
}

} // namespace

bool multigridFits(const Lattice& lattice, Sides sides)
{
  const bool p = sides == Sides::Periodic;
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
