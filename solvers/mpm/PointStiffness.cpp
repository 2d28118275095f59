#include "mpm/PointStiffness.h"

#include "core/Clock.h"
#include "core/Error.h"
#include "core/Memory.h"
#include "mpm/PointIterations.h"
#include "mpm/PointSystem.h"
#include "mpm/SmallStrain.h"

#include <Eigen/Dense>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace lamella::mpm
{
namespace
{

/// Of so few nodes in a plane factors are found as fast as multigrid is set up.
constexpr std::size_t fewNodes = 30000;

/// Solves K w = f by conjugate gradients, preconditioned by sparse factors or by the nodes' own blocks.
///
/// Nodes on which hardly any material acts have a tiny row of K, and some displacements, of loose pieces or of splines
/// that reach a single point, cost nothing at all. Neither matters: every value is scaled by the root of its diagonal,
/// and what costs nothing is not loaded either, so that conjugate gradients never meet it. The factors are those of the
/// scaled K + shift, which only have to be near those of K.
template <int Dim>
class Solver
{
public:
  using Field = typename PointSystem<Dim>::Field;
  using Block = Eigen::Matrix<double, Dim, Dim>;

  Solver(const PointSystem<Dim>& system, bool factors)
    : system_(system)
  {
    const std::vector<double> d = system.diagonal();
    const std::size_t n = system.nodes().size();
    scale_.resize(n * Dim);
    for (std::size_t k = 0; k < n; ++k)
      for (std::size_t c = 0; c < Dim; ++c)
      {
        const double v = d[(k * Dim + c) * Dim + c];
        scale_[k * Dim + c] = v > 0 ? 1 / std::sqrt(v) : 0;
      }
    if (factors)
      factorise();
    else
      invertBlocks(d);
  }

  /// @param w 0; changed to the answer
  /// @param energy of the box's strain with w = 0, that is by how much f can change it at most
  /// @param residual |K w − f|, every value over the root of its diagonal, over the root of the energy
  /// @returns iterations
  std::int64_t solve(const Field& f, Field& w, double energy, double tolerance, std::int64_t most, double& residual,
    const std::function<void(double)>& progress) const
  {
    Field r = f;
    Field q(f.size());
    Field p(f.size(), 0.0);
    Field z(f.size(), 0.0);
    const double load = std::sqrt(energy);
    residual = norm(f) / load; // of a body that strains evenly it is round-off
    if (residual <= tolerance)
      return 0;
    double before = 0;
    for (std::int64_t i = 1; i <= most; ++i)
    {
      precondition(r, z);
      const double rz = dot(r, z);
      const double beta = before > 0 ? rz / before : 0;
      before = rz;
      axpy(z, beta, p); // p = z + β p
      system_.apply(p, q);
      const double pq = dot(p, q);
      if (!(pq > 0))
        break;
      const double alpha = rz / pq;
      for (const std::int32_t node : system_.nodes())
        for (std::size_t v = static_cast<std::size_t>(node) * Dim; v < (static_cast<std::size_t>(node) + 1) * Dim; ++v)
        {
          w[v] += alpha * p[v];
          r[v] -= alpha * q[v];
        }
      residual = norm(r) / load;
      if (residual <= tolerance)
        return i;
      progress(std::log(residual) / std::log(tolerance));
    }
    throw DivergenceError(
      fmt::format("conjugate gradients stopped at a residual of {:.3g}, above {:.3g}", residual, tolerance),
      "more iterations, a larger tolerance, or Cholesky");
  }

private:
  void factorise()
  {
    const packing::BlockMatrix<Dim> m = system_.assemble(scale_);
    factors_.analyse(m.diagonal.size(), m.links);
    // far below the softest deformation that is loaded, far above round-off
    for (double shift = 1e-11; !factors_.factorise(m, shift); shift *= 100)
      if (shift > 1e-5)
        throw DivergenceError("the stiffness matrix has no Cholesky factors", "use conjugate gradients");
    factored_ = true;
  }

  void invertBlocks(const std::vector<double>& d)
  {
    inverse_.resize(system_.nodes().size());
    for (std::size_t k = 0; k < inverse_.size(); ++k)
    {
      Block b;
      for (int c = 0; c < Dim; ++c)
        for (int e = 0; e < Dim; ++e)
        {
          const auto row = k * Dim + static_cast<std::size_t>(c);
          b(c, e) =
            d[row * Dim + static_cast<std::size_t>(e)] * scale_[row] * scale_[k * Dim + static_cast<std::size_t>(e)];
        }
      // scaled, so that 1e-8 is little: what a block does not resist it leaves to the other nodes' blocks
      b.diagonal().array() += 1e-8;
      for (int c = 0; c < Dim; ++c)
        if (scale_[k * Dim + static_cast<std::size_t>(c)] == 0)
          b(c, c) = 1;
      inverse_[k] = b.inverse();
    }
  }

  void precondition(const Field& r, Field& z) const
  {
    const auto& nodes = system_.nodes();
    if (factored_)
    {
      Eigen::VectorXd right(static_cast<Eigen::Index>(nodes.size() * Dim));
      for (std::size_t k = 0; k < nodes.size(); ++k)
        for (std::size_t c = 0; c < Dim; ++c)
          right[static_cast<Eigen::Index>(k * Dim + c)] =
            scale_[k * Dim + c] * r[static_cast<std::size_t>(nodes[k]) * Dim + c];
      const Eigen::VectorXd x = factors_.solve(right, 0);
      for (std::size_t k = 0; k < nodes.size(); ++k)
        for (std::size_t c = 0; c < Dim; ++c)
          z[static_cast<std::size_t>(nodes[k]) * Dim + c] =
            scale_[k * Dim + c] * x[static_cast<Eigen::Index>(k * Dim + c)];
      return;
    }
#pragma omp parallel for schedule(static)
    for (std::size_t k = 0; k < nodes.size(); ++k)
    {
      const std::size_t at = static_cast<std::size_t>(nodes[k]) * Dim;
      Eigen::Matrix<double, Dim, 1> v;
      for (std::size_t c = 0; c < Dim; ++c)
        v[static_cast<Eigen::Index>(c)] = scale_[k * Dim + c] * r[at + c];
      v = inverse_[k] * v;
      for (std::size_t c = 0; c < Dim; ++c)
        z[at + c] = scale_[k * Dim + c] * v[static_cast<Eigen::Index>(c)];
    }
  }

  [[nodiscard]] double dot(const Field& a, const Field& b) const
  {
    double sum = 0;
    for (const std::int32_t node : system_.nodes())
      for (std::size_t v = static_cast<std::size_t>(node) * Dim; v < (static_cast<std::size_t>(node) + 1) * Dim; ++v)
        sum += a[v] * b[v];
    return sum;
  }
  void axpy(const Field& z, double beta, Field& p) const
  {
    for (const std::int32_t node : system_.nodes())
      for (std::size_t v = static_cast<std::size_t>(node) * Dim; v < (static_cast<std::size_t>(node) + 1) * Dim; ++v)
        p[v] = z[v] + beta * p[v];
  }
  [[nodiscard]] double norm(const Field& r) const
  {
    double sum = 0;
    for (std::size_t k = 0; k < system_.nodes().size(); ++k)
      for (std::size_t c = 0; c < Dim; ++c)
      {
        const double v = scale_[k * Dim + c] * r[static_cast<std::size_t>(system_.nodes()[k]) * Dim + c];
        sum += v * v;
      }
    return std::sqrt(sum);
  }

  const PointSystem<Dim>& system_;
  std::vector<double> scale_; // Dim a node; 0 where a wall holds it
  bool factored_ = false;
  packing::BlockCholesky<Dim> factors_;
  std::vector<Block> inverse_;
};

template <int Dim>
BackgroundGrid<Dim> gridOf(const PointStiffnessOptions<Dim>& o)
{
  if (!(std::isfinite(o.spacing) && o.spacing > 0))
    throw ParameterError(fmt::format("a grid spacing of {} m", o.spacing), "it is positive and finite");
  std::array<GridAxis, Dim> axes;
  for (std::size_t a = 0; a < Dim; ++a)
  {
    const double length = o.upper[a] - o.lower[a];
    if (!(std::isfinite(length) && length > 0))
      throw ParameterError(fmt::format("a box from {} to {} m along {}", o.lower[a], o.upper[a], "xyz"[a]),
        "its upper end lies above its lower one");
    const double cells = std::round(length / o.spacing);
    if (!(cells >= 5 && cells < 1e6))
      throw ParameterError(fmt::format("{:.0f} cells along {}", cells, "xyz"[a]),
        "at least 5 and less than a million: choose another spacing");
    axes[a].lower = o.lower[a];
    axes[a].cells = static_cast<int>(cells);
    axes[a].spacing = length / cells;
  }
  return BackgroundGrid<Dim>(axes);
}

template <int Dim>
void checkPoints(const MaterialPoints<Dim>& points, std::size_t phases, const PointStiffnessOptions<Dim>& o)
{
  if (points.count() == 0)
    throw InputError("no material points", "look at which phase is the empty one");
  for (std::size_t p = 0; p < points.count(); ++p)
  {
    if (phases > 1 && points.phase()[p] >= phases)
      throw ParameterError(fmt::format("no law for phase {}", points.phase()[p]), "give each phase its constants");
    const double volume = points.column(MaterialPoints<Dim>::volumes)[p];
    if (!(std::isfinite(volume) && volume > 0))
      throw InputError(fmt::format("point {} has a volume of {}", points.id()[p], volume), "volumes are positive");
    const Vector<Dim> x = points.vector(MaterialPoints<Dim>::positions, p);
    for (int a = 0; a < Dim; ++a)
      if (!(x[a] >= o.lower[static_cast<std::size_t>(a)] && x[a] <= o.upper[static_cast<std::size_t>(a)]))
        throw InputError(fmt::format("point {} lies at {} = {:.6g} m, outside the box", points.id()[p], "xyz"[a], x[a]),
          "make the box hold all points");
  }
}

/// Strains that the sides allow, and that something can resist.
template <int Dim>
std::vector<int> allowedStrains(const std::array<BoxSides, Dim>& sides)
{
  std::vector<int> strains;
  for (std::size_t v = 0; v < voigt<Dim>.size(); ++v)
  {
    const BoxSides a = sides[static_cast<std::size_t>(voigt<Dim>[v][0])];
    const BoxSides b = sides[static_cast<std::size_t>(voigt<Dim>[v][1])];
    const auto slides = [](BoxSides s) { return s == BoxSides::Walls; };
    const auto holds = [](BoxSides s) { return s == BoxSides::StickyWalls; };
    const bool allowed = v < Dim
      ? a != BoxSides::Open
      : !slides(a) && !slides(b) && (holds(a) || holds(b) || (a == BoxSides::Periodic && b == BoxSides::Periodic));
    if (allowed)
      strains.push_back(static_cast<int>(v));
  }
  return strains;
}

} // namespace

// Measured, see docs/solvers/point-stiffness.md. In space a row has up to 125 blocks of 76 bytes, in a plane 25 of 36;
// the levels above take half as much again, in a plane as much again and more. Time is that of setting up, and of 10 to
// 300 iterations, 8 to 60 in a plane.
PointStiffnessPlan planPointStiffness(int dimension, std::int64_t nodes, std::size_t cases, bool factors)
{
  const auto n = static_cast<double>(nodes);
  const auto many = static_cast<double>(cases);
  PointStiffnessPlan plan;
  plan.nodes = nodes;
  if (factors)
  {
    const double depth = std::log2(std::max(n, 2.0));
    plan.bytes = 620 * n * depth;
    plan.seconds = { 1.5e-5 * n, 5e-5 * n };
  }
  else if (dimension == 3)
  {
    plan.bytes = n * (14300 + 120 * many);
    plan.seconds = { n * (7e-5 + 10 * 1.8e-6 * many), n * (7e-5 + 300 * 1.8e-6 * many) };
  }
  else
  {
    plan.bytes = n * (2300 + 80 * many);
    plan.seconds = { n * (6e-6 + 8 * 3e-7 * many), n * (6e-6 + 60 * 3e-7 * many) };
  }
  return plan;
}

template <int Dim>
UniaxialStiffness<Dim> PointStiffness<Dim>::along(int axis, bool fixed) const
{
  const auto n = static_cast<Eigen::Index>(strains.size());
  const auto place = [&](int strain)
  { return static_cast<Eigen::Index>(std::find(strains.begin(), strains.end(), strain) - strains.begin()); };
  if (axis < 0 || axis >= Dim || place(axis) == n)
    throw ParameterError(fmt::format("no strain along axis {}", axis), "give that axis walls, or make it periodic");
  const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> c(
    stiffness.data(), n, n);
  Eigen::VectorXd e = Eigen::VectorXd::Zero(n);
  const Eigen::Index own = place(axis);
  if (fixed)
    e[own] = 1;
  else
  {
    // stress along the axis alone; a strain that costs nothing is left out
    const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> inverse(c);
    e = inverse.solve(Eigen::VectorXd::Unit(n, own));
    e /= e[own];
  }
  UniaxialStiffness<Dim> u;
  const Eigen::VectorXd t = c * e;
  u.modulus = t[own];
  for (int a = 0; a < Dim; ++a)
    if (place(a) < n)
    {
      u.strain[static_cast<std::size_t>(a)] = e[place(a)];
      u.stress[static_cast<std::size_t>(a)] = t[place(a)];
    }
  return u;
}

namespace
{

template <int Dim>
void checkPlan(const PointStiffnessOptions<Dim>& options, const PointStiffnessPlan& plan)
{
  const double free = options.memory > 0 ? options.memory : static_cast<double>(availableMemory());
  if (plan.bytes > free)
    throw MemoryError(fmt::format("the stiffness of {} nodes takes about {} of memory, and {} are free", plan.nodes,
                        bytesText(plan.bytes), bytesText(free)),
      "take a smaller sample, or larger cells of the grid");
  if (options.planned)
    options.planned(plan);
}

template <int Dim>
double volumeOf(const BackgroundGrid<Dim>& grid)
{
  double volume = 1;
  for (int a = 0; a < Dim; ++a)
    volume *= grid.axis(a).length();
  return volume;
}

/// With w the solution of K w = f up to an error, the energy of the box errs by the square of that.
template <int Dim>
void setStiffness(const PointSystem<Dim>& system, const std::vector<typename PointSystem<Dim>::Strain>& strain,
  const std::vector<typename PointSystem<Dim>::Field>& f, const std::vector<typename PointSystem<Dim>::Field>& w,
  const std::vector<typename PointSystem<Dim>::Field>& kw, double volume, PointStiffness<Dim>& r)
{
  const std::size_t n = r.strains.size();
  // images are 0 in f and K w, so that sums over all values are sums over nodes
  const auto dot = [](const auto& a, const auto& b)
  {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
      sum += a[i] * b[i];
    return sum;
  };
  r.stiffness.resize(n * n);
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t l = k; l < n; ++l)
    {
      const double uniform = system.uniform(strain[k], strain[l]);
      const double energy = uniform - dot(w[k], f[l]) - dot(w[l], f[k]) + dot(w[k], kw[l]);
      r.stiffness[k * n + l] = r.stiffness[l * n + k] = energy / volume;
      const bool normal = k == l && r.strains[k] < Dim;
      if (normal && !(energy > 1e-9 * uniform))
        throw NoPathError(
          fmt::format("nothing carries a load along {} from one end of the box to the other", "xyz"[r.strains[k]]),
          "look at the phases, and at whether the material touches both ends");
    }
}

} // namespace

template <int Dim>
PointStiffness<Dim> pointStiffness(
  const MaterialPoints<Dim>& points, const PointLaw<Dim>& law, const PointStiffnessOptions<Dim>& options)
{
  using System = PointSystem<Dim>;
  const double start = lamella::seconds();
  const BackgroundGrid<Dim> grid = gridOf(options);
  checkPoints(points, law.phases(), options);
  if (!(options.tolerance > 0 && options.tolerance < 1))
    throw ParameterError(fmt::format("a tolerance of {}", options.tolerance), "between 0 and 1, as 1e-6");
  PointStiffness<Dim> r;
  r.strains = allowedStrains<Dim>(options.sides);
  if (r.strains.empty())
    throw ParameterError("no side of the box can be moved", "give an axis walls, or make it periodic");
  const auto say = [&](double share)
  {
    if (options.progress && options.progress(std::clamp(share, 0.0, 1.0)))
      throw Cancelled();
  };
  say(0);
  const System system(points, law, grid, options.sides);
  const bool few = Dim == 2 && system.nodes().size() < fewNodes;
  const bool multigrid =
    options.solver == StiffnessSolver::Multigrid || (options.solver == StiffnessSolver::Automatic && !few);
  const bool factors =
    options.solver == StiffnessSolver::Cholesky || (options.solver == StiffnessSolver::Automatic && few);
  if (factors || multigrid)
  {
    checkPlan(
      options, planPointStiffness(Dim, static_cast<std::int64_t>(system.nodes().size()), r.strains.size(), factors));
  }
  std::optional<Solver<Dim>> solver;
  std::optional<PointIterations<Dim>> iterations;
  if (multigrid)
    iterations.emplace(system, [&] { say(0); });
  else
    solver.emplace(system, factors);
  r.points = points.count();
  r.nodes = static_cast<std::int64_t>(system.nodes().size());
  for (std::size_t a = 0; a < Dim; ++a)
    r.spacing[a] = grid.axis(static_cast<int>(a)).spacing;
  r.setupSeconds = lamella::seconds() - start;

  const std::size_t n = r.strains.size();
  std::vector<typename System::Strain> strain(n);
  std::vector<typename System::Field> f;
  std::vector<typename System::Field> w;
  std::vector<typename System::Field> kw;
  const double begin = factors || multigrid ? 0.5 : 0.0; // share of the whole that was taken by the factors
  std::vector<double> energies;
  for (std::size_t k = 0; k < n; ++k)
  {
    strain[k][static_cast<std::size_t>(r.strains[k])] = 1;
    f.push_back(system.load(strain[k]));
    w.emplace_back(system.values(), 0.0);
    kw.emplace_back(system.values(), 0.0);
    energies.push_back(system.uniform(strain[k], strain[k]));
  }
  if (multigrid)
  {
    const auto outcome = iterations->solve(f, w, energies, options.tolerance, options.maximumIterations,
      [&](double share) { say(begin + (1 - begin) * share); });
    r.iterations = outcome.iterations;
    r.residual = outcome.residual;
    r.lost = outcome.lost;
  }
  for (std::size_t k = 0; k < n; ++k)
  {
    if (!multigrid)
    {
      double residual = 0;
      r.iterations.push_back(
        solver->solve(f[k], w[k], energies[k], options.tolerance, options.maximumIterations, residual,
          [&](double share) { say(begin + (1 - begin) * (static_cast<double>(k) + share) / static_cast<double>(n)); }));
      r.residual = std::max(r.residual, residual);
    }
    system.apply(w[k], kw[k]);
  }
  setStiffness(system, strain, f, w, kw, volumeOf(grid), r);
  r.solveSeconds = lamella::seconds() - start - r.setupSeconds;
  say(1);
  return r;
}

template struct PointStiffness<2>;
template struct PointStiffness<3>;
template PointStiffness<2> pointStiffness<2>(
  const MaterialPoints<2>&, const PointLaw<2>&, const PointStiffnessOptions<2>&);
template PointStiffness<3> pointStiffness<3>(
  const MaterialPoints<3>&, const PointLaw<3>&, const PointStiffnessOptions<3>&);

} // namespace lamella::mpm
