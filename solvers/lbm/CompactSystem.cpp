#include "lbm/CompactSystem.h"

#include "core/Error.h"
#include "lbm/Connectivity.h"

#include <HYPRE.h>
#include <HYPRE_IJ_mv.h>
#include <HYPRE_krylov.h>
#include <HYPRE_parcsr_ls.h>

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

namespace lamella::lbm
{
namespace
{

using Position = std::array<std::int64_t, 3>;

// hypre needs MPI even on one rank; a program that did not start it gets a singleton that ends with the program.
void ensureMpi()
{
  int initialized = 0;
  MPI_Initialized(&initialized);
  if (!initialized)
  {
    MPI_Init(nullptr, nullptr);
    std::atexit(
      []
      {
        int finalized = 0;
        MPI_Finalized(&finalized);
        if (!finalized)
          MPI_Finalize();
      });
  }
}

// Conjugate gradients with BoomerAMG on an assembled matrix.
class AlgebraicMultigridSolver
{
public:
  AlgebraicMultigridSolver(MPI_Comm comm, HYPRE_BigInt firstRow, HYPRE_BigInt rows, int entriesPerRow, bool threeD)
    : rowIds_(static_cast<std::size_t>(rows))
  {
    HYPRE_Init();
    std::iota(rowIds_.begin(), rowIds_.end(), firstRow);
    const HYPRE_BigInt last = firstRow + rows - 1;
    HYPRE_IJMatrixCreate(comm, firstRow, last, firstRow, last, &matrix_);
    HYPRE_IJMatrixSetObjectType(matrix_, HYPRE_PARCSR);
    std::vector<HYPRE_Int> sizes(static_cast<std::size_t>(rows), entriesPerRow);
    HYPRE_IJMatrixSetRowSizes(matrix_, sizes.data());
    HYPRE_IJMatrixInitialize(matrix_);
    for (HYPRE_IJVector* v : { &right_, &left_ })
    {
      HYPRE_IJVectorCreate(comm, firstRow, last, v);
      HYPRE_IJVectorSetObjectType(*v, HYPRE_PARCSR);
      HYPRE_IJVectorInitialize(*v);
      HYPRE_IJVectorAssemble(*v);
    }

    HYPRE_BoomerAMGCreate(&amg_);
    HYPRE_BoomerAMGSetPrintLevel(amg_, 0);
    HYPRE_BoomerAMGSetCoarsenType(amg_, 10); // HMIS
    HYPRE_BoomerAMGSetInterpType(amg_, 6);   // extended+i
    HYPRE_BoomerAMGSetPMaxElmts(amg_, 4);
    HYPRE_BoomerAMGSetRelaxType(amg_, 8); // l1-scaled hybrid symmetric Gauss-Seidel
    HYPRE_BoomerAMGSetStrongThreshold(amg_, threeD ? 0.5 : 0.25);
    HYPRE_BoomerAMGSetTol(amg_, 0.0);
    HYPRE_BoomerAMGSetMaxIter(amg_, 1);

    HYPRE_ParCSRPCGCreate(comm, &pcg_);
    HYPRE_PCGSetTwoNorm(pcg_, 1);
    HYPRE_PCGSetPrintLevel(pcg_, 0);
    HYPRE_PCGSetLogging(pcg_, 0);
    HYPRE_PCGSetPrecond(pcg_, reinterpret_cast<HYPRE_PtrToSolverFcn>(HYPRE_BoomerAMGSolve),
      reinterpret_cast<HYPRE_PtrToSolverFcn>(HYPRE_BoomerAMGSetup), amg_);
  }
  ~AlgebraicMultigridSolver()
  {
    HYPRE_ParCSRPCGDestroy(pcg_);
    HYPRE_BoomerAMGDestroy(amg_);
    HYPRE_IJVectorDestroy(left_);
    HYPRE_IJVectorDestroy(right_);
    HYPRE_IJMatrixDestroy(matrix_);
    HYPRE_ClearAllErrors();
  }
  AlgebraicMultigridSolver(const AlgebraicMultigridSolver&) = delete;
  AlgebraicMultigridSolver& operator=(const AlgebraicMultigridSolver&) = delete;

  void setRow(HYPRE_BigInt row, std::vector<HYPRE_BigInt>& columns, const std::vector<double>& values)
  {
    HYPRE_Int n = static_cast<HYPRE_Int>(columns.size());
    HYPRE_IJMatrixSetValues(matrix_, 1, &n, &row, columns.data(), values.data());
    entries_ += columns.size();
  }
  void assemble()
  {
    HYPRE_IJMatrixAssemble(matrix_);
    HYPRE_IJMatrixGetObject(matrix_, reinterpret_cast<void**>(&parMatrix_));
    HYPRE_IJVectorGetObject(right_, reinterpret_cast<void**>(&parRight_));
    HYPRE_IJVectorGetObject(left_, reinterpret_cast<void**>(&parLeft_));
    HYPRE_ParCSRPCGSetup(pcg_, parMatrix_, parRight_, parLeft_);
  }

  // Solves A correction = residual to a relative 2-norm; returns the iterations.
  int solve(const std::vector<double>& residual, std::vector<double>& correction, double tolerance, int maxIterations)
  {
    const HYPRE_Int n = static_cast<HYPRE_Int>(rowIds_.size());
    HYPRE_IJVectorSetValues(right_, n, rowIds_.data(), residual.data());
    HYPRE_ParVectorSetConstantValues(parLeft_, 0.0);
    HYPRE_PCGSetTol(pcg_, tolerance);
    HYPRE_PCGSetMaxIter(pcg_, maxIterations);
    HYPRE_ParCSRPCGSolve(pcg_, parMatrix_, parRight_, parLeft_);
    HYPRE_ClearAllErrors(); // reaching maxIterations is judged by the caller, on the true residual
    HYPRE_IJVectorGetValues(left_, n, rowIds_.data(), correction.data());
    HYPRE_Int iterations = 0;
    HYPRE_PCGGetNumIterations(pcg_, &iterations);
    return iterations;
  }

  // hypre keeps to itself what it allocates: 12 bytes an entry of the matrix, 2.6 times over for the operators and
  // 0.8 for the interpolation of all levels (measured on tissue and sandstone), and about ten vectors.
  [[nodiscard]] std::uint64_t bytes() const { return entries_ * 12 * 34 / 10 + rowIds_.size() * 10 * 8; }

private:
  std::vector<HYPRE_BigInt> rowIds_;
  std::uint64_t entries_ = 0;
  HYPRE_IJMatrix matrix_ = nullptr;
  HYPRE_IJVector right_ = nullptr;
  HYPRE_IJVector left_ = nullptr;
  HYPRE_ParCSRMatrix parMatrix_ = nullptr;
  HYPRE_ParVector parRight_ = nullptr;
  HYPRE_ParVector parLeft_ = nullptr;
  HYPRE_Solver amg_ = nullptr;
  HYPRE_Solver pcg_ = nullptr;
};

class CompactSystem final : public Backend
{
public:
  explicit CompactSystem(const Problem& problem)
    : problem_(problem)
    , block_(problem.parts.block())
    , links_(problem.links())
    , halo_(problem.lattice.dimension, block_.size, problem.parts, problem.comm, problem.periodic())
    , percolation_(
        findPercolation(problem.lattice, problem.parts, halo_, problem.comm, links_, problem.axis, problem.phase))
  {
    if (!percolation_.exists)
      throw NoPathError(fmt::format("no conducting path leads across the box along {}", "xyz"[problem.axis]),
        "give the phase that should conduct a conductivity above 0, or choose another window or direction");
    ensureMpi();
    numberNodes();
    loadPhases();
    assemble();
  }

  SteadyResult solve() override
  {
    SteadyResult result;
    result.method = Method::AlgebraicMultigrid;
    result.nodes = problem_.lattice.count();
    result.stored = problem_.comm.sum(owned_);
    result.skipped = result.nodes - result.stored;
    result.bytes = static_cast<std::uint64_t>(
      problem_.comm.sum(static_cast<std::int64_t>(solver_->bytes() + set().bytes() + percolation_.reachesLow.bytes() +
        percolation_.reachesHigh.bytes() + u_.size() * 9 + static_cast<std::size_t>(owned_) * 16)));

    setLinearProfile();
    std::vector<double> residual(static_cast<std::size_t>(owned_));
    std::vector<double> correction(residual.size());
    double firstResidual = 0;
    for (int cycle = 0;; ++cycle)
    {
      exchange(u_);
      const FieldSums sums = evaluate(residual);
      setEffective(result, sums, problem_.lattice, problem_.axis, links_.scale());
      if (cycle == 0)
        firstResidual = sums.residual2;
      result.residual = firstResidual > 0 ? std::sqrt(sums.residual2 / firstResidual) : 0.0;
      reportProgress(
        problem_.options, problem_.comm, progressOf(result.balance, problem_.options.tolerance), "solving");
      result.solverError = result.balance;
      if (!std::isfinite(result.balance))
        throw DivergenceError(fmt::format("the flux is not finite after {} iterations", result.iterations),
          "please report this with the picture and the conductivities");
      if (sums.residual2 == 0 || (cycle > 0 && result.balance <= problem_.options.tolerance))
        break;
      if (result.iterations >= problem_.options.maxIterations || cycle == 12)
        throw DivergenceError(
          fmt::format("the face fluxes still differ by {:.1e} after {} iterations (asked for {:.1e})", result.balance,
            result.iterations, problem_.options.tolerance),
          "choose a larger tolerance; a contrast near 1e16 is beyond double precision");
      result.iterations +=
        solver_->solve(residual, correction, 1e-4, problem_.options.maxIterations - result.iterations);
      addToOwned(correction);
    }
    return result;
  }

  void value(std::span<double> out, Layers layers) const override
  {
    const bool periodic = problem_.options.sides == Sides::Periodic;
    const double n = static_cast<double>(problem_.lattice.size[problem_.axis]);
    if (periodic && !mean_)
    {
      double sum = 0;
      forEachOwned([&](const Position&, std::int64_t, std::uint32_t id, std::int64_t) { sum += u_[id]; });
      mean_ = problem_.comm.sum(sum) / static_cast<double>(problem_.comm.sum(owned_));
    }
    const double mean = mean_.value_or(0);
    std::size_t i = 0;
    for (std::int64_t z = layers.first; z < layers.last; ++z)
      for (std::int64_t y = 0; y < block_.size[1]; ++y)
        for (std::int64_t x = 0; x < block_.size[0]; ++x, ++i)
        {
          const std::int64_t row = halo_.row(y, z);
          const Position p{ x, y + block_.start[1], z + block_.start[2] };
          if (set().contains(row, x))
            out[i] = periodic ? u_[set().id(row, x)] - mean + 1.0 - (static_cast<double>(p[problem_.axis]) + 0.5) / n
                              : u_[set().id(row, x)];
          else if (!periodic && percolation_.reachesLow.contains(row, x))
            out[i] = 1.0;
          else if (!periodic && percolation_.reachesHigh.contains(row, x))
            out[i] = 0.0;
          else
            out[i] = std::numeric_limits<double>::quiet_NaN();
        }
  }

  [[nodiscard]] FieldEnergies energies() const override { return energiesOf(problem_, *this); }

  void flux(std::span<double> out, Layers layers) const override
  {
    std::fill(out.begin(), out.end(), 0.0);
    const std::array<double, 3> unit = fluxUnits(links_, problem_.lattice);
    forEachOwned(
      [&](const Position& p, std::int64_t row, std::uint32_t id, std::int64_t)
      {
        std::array<double, 3> q{ 0, 0, 0 };
        nodeLinks(p, row, id,
          [&](double conductance, double difference, const Direction& d, std::int64_t)
          {
            for (int a = 0; a < 3; ++a)
              q[a] += 0.5 * conductance * difference * d[a];
          });
        const std::size_t i = static_cast<std::size_t>(
          p[0] + block_.size[0] * (p[1] - block_.start[1] + block_.size[1] * (p[2] - block_.start[2] - layers.first)));
        for (std::size_t a = 0; a < 3; ++a)
          out[3 * i + a] = q[a] * unit[a];
      },
      layers);
  }

private:
  [[nodiscard]] const NodeSet& set() const { return percolation_.carrying; }

  // f(global position, padded row, id, owned index)
  template <class F>
  void forEachOwned(F&& f) const
  {
    forEachOwned(f, { 0, block_.size[2] });
  }
  // The same of some layers, counted from the first of them.
  template <class F>
  void forEachOwned(F&& f, Layers layers) const
  {
    std::int64_t owned = 0;
    for (std::int64_t z = layers.first; z < layers.last; ++z)
      for (std::int64_t y = 0; y < block_.size[1]; ++y)
      {
        const std::int64_t row = halo_.row(y, z);
        std::uint32_t id = set().rowBegin(row);
        set().forEach(row,
          [&](std::int64_t x) {
            f(Position{ x, y + block_.start[1], z + block_.start[2] }, row, id++, owned++);
          });
      }
  }

  // f(conductance, value here less value there, direction, global row of the other node or -1 for a wall)
  template <class F>
  void nodeLinks(const Position& p, std::int64_t row, std::uint32_t id, F&& f) const
  {
    const bool periodic = problem_.options.sides == Sides::Periodic;
    const int axis = problem_.axis;
    const double jump = periodic ? 1.0 / static_cast<double>(problem_.lattice.size[axis]) : 0.0;
    const std::int64_t nx = block_.size[0];
    for (const Direction& d : links_.all())
    {
      const double weight = links_.weight(d, p);
      if (weight == 0.0)
        continue;
      std::int64_t x = p[0] + d.x;
      if (x < 0)
        x += nx;
      else if (x >= nx)
        x -= nx;
      const std::int64_t otherRow = row + d.y + d.z * (block_.size[1] + 2);
      if (!set().contains(otherRow, x) || !links_.open(d, p[0], p[1]))
        continue;
      const std::uint32_t other = set().id(otherRow, x);
      const double* given = links_.given(d, p[1]);
      f(given != nullptr ? given[p[0]] : weight * links_.mean(phase_[id], phase_[other], d.axis()),
        u_[id] - u_[other] + jump * d[axis], d,
        globalBegin_[static_cast<std::size_t>(otherRow)] + other - set().rowBegin(otherRow));
    }
    if (!periodic)
    {
      Direction d;
      (axis == 0 ? d.x : axis == 1 ? d.y : d.z) = 1;
      if (p[axis] == 0)
      {
        Direction low{ -d.x, -d.y, -d.z };
        f(links_.wall(phase_[id], p, axis, false), u_[id] - 1.0, low, -1);
      }
      if (p[axis] == problem_.lattice.size[axis] - 1)
        f(links_.wall(phase_[id], p, axis, true), u_[id], d, -1);
    }
  }

  void numberNodes()
  {
    owned_ = 0;
    globalBegin_.assign(static_cast<std::size_t>(halo_.rows()), 0);
    for (std::int64_t z = 0; z < block_.size[2]; ++z)
      for (std::int64_t y = 0; y < block_.size[1]; ++y)
      {
        const std::int64_t row = halo_.row(y, z);
        globalBegin_[static_cast<std::size_t>(row)] = owned_;
        owned_ += set().rowBegin(row + 1) - set().rowBegin(row);
      }
    const std::int64_t total = problem_.comm.sum(owned_);
    if (total > std::numeric_limits<HYPRE_BigInt>::max())
      throw ParameterError(fmt::format("{} conducting nodes are more than algebraic multigrid can number", total),
        "use a smaller window or refinement, or give every phase a conductivity above 0 and take method multigrid");
    firstRow_ = problem_.comm.sumBefore(owned_);
    for (auto& begin : globalBegin_)
      begin += firstRow_;
    halo_.exchange(globalBegin_.data(), sizeof(std::int64_t));
  }

  void loadPhases()
  {
    phase_.resize(set().size());
    u_.assign(set().size(), 0.0);
    forEachOwned(
      [&](const Position& p, std::int64_t, std::uint32_t id, std::int64_t)
      {
        phase_[id] = problem_.phase[static_cast<std::size_t>(
          p[0] + block_.size[0] * (p[1] - block_.start[1] + block_.size[1] * (p[2] - block_.start[2])))];
      });
    exchange(phase_);
  }

  template <class T>
  void exchange(std::vector<T>& values) const
  {
    halo_.exchange(
      [&](std::int64_t row)
      {
        const std::size_t begin = set().rowBegin(row);
        const std::size_t end = row + 1 < halo_.rows() ? set().rowBegin(row + 1) : set().size();
        return Halo::Segment{ reinterpret_cast<std::byte*>(values.data() + begin), (end - begin) * sizeof(T) };
      });
  }

  void assemble()
  {
    solver_ = std::make_unique<AlgebraicMultigridSolver>(problem_.comm.handle(), static_cast<HYPRE_BigInt>(firstRow_),
      static_cast<HYPRE_BigInt>(owned_), static_cast<int>(links_.all().size()) + 1, problem_.lattice.dimension == 3);
    std::vector<HYPRE_BigInt> columns;
    std::vector<double> values;
    std::size_t nextPin = 0;
    // pins are in the order of positions on the whole box; on a part they are looked up
    const auto isPin = [&](const Position& p)
    {
      for (; nextPin < percolation_.pins.size(); ++nextPin)
      {
        const Position& pin = percolation_.pins[nextPin];
        const auto order = [&](const Position& q)
        { return q[0] + problem_.lattice.size[0] * (q[1] + problem_.lattice.size[1] * q[2]); };
        if (order(pin) == order(p))
          return true;
        if (order(pin) > order(p))
          return false;
      }
      return false;
    };
    forEachOwned(
      [&](const Position& p, std::int64_t row, std::uint32_t id, std::int64_t owned)
      {
        const HYPRE_BigInt self = static_cast<HYPRE_BigInt>(firstRow_ + owned);
        columns.assign(1, self);
        values.assign(1, 0.0);
        nodeLinks(p, row, id,
          [&](double conductance, double, const Direction&, std::int64_t other)
          {
            if (other == self)
              return; // a link round a periodic side one node long
            values[0] += conductance;
            if (other < 0)
              return;
            const auto column = static_cast<HYPRE_BigInt>(other);
            for (std::size_t i = 1; i < columns.size(); ++i)
              if (columns[i] == column)
              {
                values[i] -= conductance;
                return;
              }
            columns.push_back(column);
            values.push_back(-conductance);
          });
        if (isPin(p))
          values[0] += links_.diffusivity(phase_[id]);
        solver_->setRow(self, columns, values);
      });
    solver_->assemble();
  }

  void setLinearProfile()
  {
    if (problem_.options.sides == Sides::Periodic)
    {
      std::fill(u_.begin(), u_.end(), 0.0);
      return;
    }
    const double n = static_cast<double>(problem_.lattice.size[problem_.axis]);
    forEachOwned([&](const Position& p, std::int64_t, std::uint32_t id, std::int64_t)
      { u_[id] = 1.0 - (static_cast<double>(p[problem_.axis]) + 0.5) / n; });
  }

  void addToOwned(const std::vector<double>& correction)
  {
    forEachOwned([&](const Position&, std::int64_t, std::uint32_t id, std::int64_t owned)
      { u_[id] += correction[static_cast<std::size_t>(owned)]; });
  }

  // Residual of every owned node and the sums over all ranks.
  FieldSums evaluate(std::vector<double>& residual) const
  {
    FieldSums s;
    const int axis = problem_.axis;
    const std::int64_t n = problem_.lattice.size[axis];
    const bool periodic = problem_.options.sides == Sides::Periodic;
    forEachOwned(
      [&](const Position& p, std::int64_t row, std::uint32_t id, std::int64_t owned)
      {
        double r = 0;
        nodeLinks(p, row, id,
          [&](double conductance, double difference, const Direction& d, std::int64_t other)
          {
            const double q = conductance * difference;
            r -= q;
            const bool wall = other < 0;
            s.energy += (wall ? 1.0 : 0.5) * q * difference;
            for (int a = 0; a < 3; ++a)
              s.flux[a] += 0.5 * q * d[a];
            if (wall && d[axis] < 0)
              s.inlet -= q;
            else if (wall)
              s.outlet += q;
            else if (periodic && d[axis] > 0)
            {
              if (p[axis] == n - 1)
                s.inlet += q;
              if (p[axis] == std::max<std::int64_t>(n / 2 - 1, 0))
                s.outlet += q;
            }
          });
        residual[static_cast<std::size_t>(owned)] = r;
        s.residual2 += r * r;
      });
    std::array<double, 7> all{ s.energy, s.inlet, s.outlet, s.flux[0], s.flux[1], s.flux[2], s.residual2 };
    problem_.comm.sum(all);
    return { all[0], all[1], all[2], { all[3], all[4], all[5] }, all[6] };
  }

  Problem problem_;
  Block block_;
  Links links_;
  Halo halo_;
  Percolation percolation_;
  std::int64_t owned_ = 0;
  std::int64_t firstRow_ = 0;
  std::vector<std::int64_t> globalBegin_; // a padded row: global number of its first member
  std::vector<std::uint8_t> phase_;
  std::vector<double> u_;
  mutable std::optional<double> mean_; ///< of the field, once it was asked for
  std::unique_ptr<AlgebraicMultigridSolver> solver_;
};

} // namespace

std::unique_ptr<Backend> makeCompactSystem(const Problem& problem)
{
  return std::make_unique<CompactSystem>(problem);
}

} // namespace lamella::lbm
