#include "elasticity/ElasticSystem.h"

#include "core/Error.h"
#include "elasticity/ElasticSweep.h"
#include "elasticity/Materials.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <type_traits>

namespace lamella::elasticity
{
namespace
{

constexpr double mostFall = 1e-4;      // of the residual between two that are made anew
constexpr double leastProgress = 0.25; // of its square, or no more is tried
// What the energy has fallen in the last steps is what it still had to fall before them, at least (Strakoš & Tichý,
// Electron. Trans. Numer. Anal. 13 (2002) 56).
constexpr int delay = 4;
// Of phases that differ by more than this, modes may be left that hardly fall and that nothing tells: errors count for
// so many times more, at most `mostDoubt` times.
constexpr double usualContrast = 100;
constexpr double mostDoubt = 1e4;
constexpr double slowest = 0.95;     // fall over so many steps, relative
constexpr int directions = 24;       // of an axis, among which an element's largest eigenvalue is looked for
constexpr std::size_t manyLaws = 20; // of which so many are looked at
constexpr double stiffPieces = 30;   // contrast from which on pieces of the stiff phases move as bodies
constexpr double standIn = 100;      // a rigid phase is so much stiffer than all others, to multigrid
// What is left of the energy of the mean strain below which rounding does not let it be known.
constexpr double leastSingle = 1e-6;
constexpr double leastExact = 1e-12;
// Ratios of λ to μ beyond this take more smoothing.
constexpr double nearlyIncompressible = 12; // Poisson's ratio 0.46
constexpr double stepsOfRatio = 0.75;
constexpr int mostSteps = 16;
constexpr double wrong = 1e-3;   // of the energy of the mean strain
constexpr double nothing = 1e-3; // of the tolerance, in one step

} // namespace

template <int D>
std::array<double, stiffnessSize(D)> ElasticLaw<D>::turnedTo(const std::array<float, 3>& axis) const
{
  std::array<double, stiffnessSize(D)> c{};
  std::array<double*, stiffnessSize(D)> out{};
  for (std::size_t k = 0; k < c.size(); ++k)
    out[k] = &c[k];
  std::array<const double*, axialSize> table{};
  for (std::size_t k = 0; k < table.size(); ++k)
    table[k] = &axial[k];
  const std::uint8_t id = 0;
  if constexpr (D == 2)
    elasticKernels().turnPlaneDouble(1, &id, table.data(), axis.data(), out.data());
  else
    elasticKernels().turnSpaceDouble(1, &id, table.data(), axis.data(), out.data());
  return c;
}

template <int D>
ElasticLaw<D> ElasticLaw<D>::inverse() const
{
  constexpr int n = voigtSize(D);
  const auto c = turnedTo({ 1, 0, 0 });
  Eigen::Matrix<double, n, n> matrix;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      matrix(i, j) = c[static_cast<std::size_t>(triangle(n, i, j))];
  Eigen::Matrix<double, n, n> s = matrix.inverse();
  s.bottomRows(n - D) *= 0.5;
  s.rightCols(n - D) *= 0.5;
  std::vector<double> values;
  for (int i = 0; i < n; ++i)
    for (int j = i; j < n; ++j)
      values.push_back(s(i, j));
  ElasticLaw law;
  law.axial = axialParts(D, values);
  return law;
}

template <int D>
ElasticLaw<D> ElasticLaw<D>::ofLame(double lambda, double mu)
{
  constexpr int n = voigtSize(D);
  ElasticLaw law;
  for (int i = 0; i < n; ++i)
    for (int j = i; j < n; ++j)
      law.stiffness[static_cast<std::size_t>(triangle(n, i, j))] =
        (i < D && j < D ? lambda : 0.0) + (i == j ? (i < D ? 2 * mu : mu) : 0.0);
  return law;
}

template <int D>
bool ElasticLaw<D>::isotropic(double& lambda, double& mu) const
{
  constexpr int n = voigtSize(D);
  lambda = stiffness[triangle(n, 0, 1)];
  mu = stiffness[triangle(n, n - 1, n - 1)];
  const ElasticLaw same = ofLame(lambda, mu);
  const double largest = *std::ranges::max_element(stiffness);
  for (std::size_t k = 0; k < stiffness.size(); ++k)
    if (std::abs(stiffness[k] - same.stiffness[k]) > 1e-12 * largest)
      return false;
  return true;
}

template <int D>
typename ElasticSystem<D>::template Tables<double> ElasticSystem<D>::tablesOf(
  const std::vector<ElasticLaw<D>>& laws) const
{
  const double factor = cornerFactor<D> * cornerFactor<D> / scale_;
  Tables<double> tables;
  for (auto& table : tables.stiffness)
    table.assign(256, 0.0);
  for (auto& table : tables.axial)
    table.assign(turns_ ? 256 : 0, 0.0);
  for (std::size_t id = 0; id < laws.size(); ++id)
  {
    const ElasticLaw<D>& law = laws[id];
    double lambda = 0;
    double mu = 0;
    const bool plain = law.isotropic(lambda, mu);
    if (isotropic_)
    {
      tables.stiffness[0][id] = factor * lambda;
      tables.stiffness[1][id] = factor * mu;
    }
    else
      for (std::size_t k = 0; k < law.stiffness.size(); ++k)
        tables.stiffness[k][id] = factor * law.stiffness[k];
    for (std::size_t k = 0; k < axialSize && turns_; ++k)
      if (law.turns() || (plain && k < 2))
        tables.axial[k][id] = factor * (law.turns() ? law.axial[k] : k == 0 ? lambda : mu);
  }
  return tables;
}

template <int D>
void ElasticSystem<D>::setLaws()
{
  scale_ = 0;
  isotropic_ = true;
  full_.assign(256, false);
  rigid_.assign(256, false);
  double lambda = 0;
  double mu = 0;
  for (ElasticLaw<D>& law : problem_.laws)
  {
    if (law.turns()) // with its axis along x
      law.stiffness = law.turnedTo({ 1, 0, 0 });
    if (law.rigid)
      law.stiffness.fill(0);
    scale_ = std::max(scale_, *std::ranges::max_element(law.stiffness));
    turns_ = turns_ || law.turns();
    isotropic_ = isotropic_ && !law.turns() && law.isotropic(lambda, mu);
  }
  for (std::size_t id = 0; id < problem_.laws.size(); ++id)
  {
    const ElasticLaw<D>& law = problem_.laws[id];
    full_[id] = turns_ && !law.turns() && !law.isotropic(lambda, mu);
    rigid_[id] = law.rigid;
  }
  exact64_ = tablesOf(problem_.laws);
  single_.take(exact64_);
  if (std::ranges::any_of(rigid_, [](bool r) { return r; }))
  {
    std::vector<ElasticLaw<D>> laws = problem_.laws;
    for (ElasticLaw<D>& law : laws)
      if (law.rigid)
        law = ElasticLaw<D>::ofLame(0.5 * standIn * scale_, 0.5 * standIn * scale_);
    standIn_.take(tablesOf(laws));
  }
  if (turns_)
    requireAxes();
}

template <int D>
void ElasticSystem<D>::requireAxes() const
{
  std::int64_t lost = 0;
  for (std::size_t i = 0; i < problem_.phase.size(); ++i)
    if (problem_.laws[problem_.phase[i]].turns())
    {
      double length = 0;
      for (std::size_t a = 0; a < D && i < problem_.axis.size(); ++a)
        length += static_cast<double>(problem_.axis[i][a]) * problem_.axis[i][a];
      lost += length > 0 && std::isfinite(length) ? 0 : 1;
    }
  if (lost > 0)
    throw ParameterError(fmt::format("{} voxels of phases with an axis have none to go by", lost),
      "give these voxels an axis, or the phase one stiffness in all directions");
}

template <int D>
typename ElasticSystem<D>::ElementMatrix ElasticSystem<D>::elementMatrix(
  const std::array<double, stiffnessSize(D)>& values, const std::array<double, D>& widths) const
{
  constexpr int corners = 1 << D;
  constexpr int rows = corners / 2;
  constexpr int n = D * corners;
  constexpr std::int64_t length = 2 + spareValues;
  const double shortest = *std::ranges::min_element(widths);
  std::vector<double> u(D * rows * length);
  std::vector<double> q(D * rows * length);
  std::vector<float> stretch(length, 0.0F);
  std::array<std::vector<double>, stiffnessSize(D)> moduli;
  ElasticRow<D, double> row{};
  row.count = 1;
  row.isotropic = isotropic_;
  row.stretchX = stretch.data();
  stretch[0] = static_cast<float>(shortest / widths[0]);
  for (std::size_t a = 1; a < D; ++a)
    row.stretch[a] = shortest / widths[a];
  double* out[D][rows];
  for (int c = 0; c < D; ++c)
    for (int r = 0; r < rows; ++r)
    {
      row.u[c][r] = u.data() + (c * rows + r) * length;
      out[c][r] = q.data() + (c * rows + r) * length;
    }
  for (std::size_t k = 0; k < moduli.size(); ++k)
  {
    moduli[k].assign(length, 0.0);
    moduli[k][0] = values[k];
    row.moduli[k] = moduli[k].data();
  }
  ElementMatrix matrix;
  const auto place = [&](int m)
  { return static_cast<std::size_t>((m / corners * rows + m % corners / 2) * length + m % 2); };
  for (int m = 0; m < n; ++m)
  {
    std::ranges::fill(u, 0.0);
    std::ranges::fill(q, 0.0);
    u[place(m)] = 1;
    if constexpr (D == 2)
      elasticKernels().planeDouble(row, out);
    else
      elasticKernels().spaceDouble(row, out);
    for (int l = 0; l < n; ++l)
      matrix(l, m) = q[place(l)];
  }
  return matrix;
}

template <int D>
double ElasticSystem<D>::largestEigenvalue(std::array<double, D> widths) const
{
  // Coarse elements have means of the phases' stiffness, and what is to be bounded is largest for one of them, or where
  // λ is 2 μ: between these a matrix over its trace is quasi-convex.
  std::vector<std::array<double, stiffnessSize(D)>> stiffness;
  for (std::size_t id = 0; id < problem_.laws.size(); ++id)
    if (!problem_.laws[id].isVoid() && !rigid_[id])
      for (std::size_t k = 0; k < exact64_.stiffness.size(); ++k)
        (k == 0 ? stiffness.emplace_back() : stiffness.back())[k] = exact64_.stiffness[k][id];
  // whichever way an axis points; of many laws, which are mixtures then, some
  const double factor = cornerFactor<D> * cornerFactor<D> / scale_;
  const std::size_t every = 1 + problem_.laws.size() / manyLaws;
  for (std::size_t id = 0; id < problem_.laws.size(); ++id)
    for (int direction = 0; direction < directions && problem_.laws[id].turns() && id % every == 0; ++direction)
    {
      const ElasticLaw<D>& law = problem_.laws[id];
      const double angle = std::numbers::pi * direction / directions;
      const double height = D == 3 ? (2 * direction + 1.0) / directions - 1 : 0;
      const double flat = std::sqrt(1 - height * height);
      const double around = D == 3 ? 2.399963 * direction : angle; // by the golden angle
      const auto c = law.turnedTo({ static_cast<float>(flat * std::cos(around)),
        static_cast<float>(flat * std::sin(around)), static_cast<float>(height) });
      for (std::size_t k = 0; k < c.size(); ++k)
        (k == 0 ? stiffness.emplace_back() : stiffness.back())[k] = factor * c[k];
    }
  if (isotropic_ && !stiffness.empty())
  {
    stiffness.push_back({ 2, 1 });
    stiffness.push_back({ 0, 1 });
  }
  double largest = 0;
  for (const auto& values : stiffness)
  {
    const ElementMatrix matrix = elementMatrix(values, widths);
    const double diagonal = matrix.trace() / static_cast<double>(matrix.rows());
    const Eigen::SelfAdjointEigenSolver<ElementMatrix> modes(matrix, Eigen::EigenvaluesOnly);
    largest = std::max(largest, modes.eigenvalues()(matrix.rows() - 1) / diagonal);
  }
  return largest;
}

template <int D>
ElasticMultigridOptions ElasticSystem<D>::smoothing() const
{
  ElasticMultigridOptions o = options_.multigrid;
  double most = 0; // λ over μ
  for (std::size_t id = 0; id < problem_.laws.size() && isotropic_; ++id)
    if (exact64_.stiffness[1][id] > 0)
      most = std::max(most, exact64_.stiffness[0][id] / exact64_.stiffness[1][id]);
  if (!(most > nearlyIncompressible))
    return o;
  // motions without change of volume are stiff by μ, and a simple step is as long as λ lets it be
  const int steps = std::min(mostSteps, static_cast<int>(std::lround(std::sqrt(stepsOfRatio * most))));
  o.smoothing = std::max(o.smoothing, steps);
  o.coarseSmoothing = std::max(o.coarseSmoothing, steps);
  o.smoothedPart = std::max(o.smoothedPart, 0.45 * steps * steps);
  o.hillBulk = true;
  return o;
}

template <int D>
void ElasticSystem<D>::findPieces()
{
  std::array<bool, 256> present{};
  for (const std::uint8_t id : problem_.phase)
    present[id] = true;
  double most = 0;
  double least = std::numeric_limits<double>::infinity();
  const auto stiffnessOf = [&](std::size_t id) { return *std::ranges::max_element(problem_.laws[id].stiffness); };
  for (std::size_t id = 0; id < problem_.laws.size(); ++id)
    if (present[id] && !problem_.laws[id].isVoid() && !rigid_[id])
    {
      most = std::max(most, stiffnessOf(id));
      least = std::min(least, stiffnessOf(id));
    }
  if (most > 0)
    doubt_ = std::clamp(most / (usualContrast * least), 1.0, mostDoubt);
  if (!(most > stiffPieces * least))
    return;
  std::vector<bool> stiff(256, false);
  for (std::size_t id = 0; id < problem_.laws.size(); ++id)
    stiff[id] = stiffnessOf(id) * stiffnessOf(id) > most * least;
  std::array<double, D> edges{};
  for (std::size_t a = 0; a < D; ++a)
    edges[a] = problem_.aspect[a] == 0 ? 1 : problem_.aspect[a];
  pieces_ = std::make_unique<StiffPieces<D>>(op_->grid(), problem_.phase, stiff,
    [&](std::uint8_t id)
    {
      std::array<double, stiffnessSize(D)> values{};
      for (std::size_t k = 0; k < values.size(); ++k)
        values[k] = exact64_.stiffness[k][id];
      return elementMatrix(values, edges);
    });
  if (pieces_->pieces() < 2)
    pieces_.reset();
}

template <int D>
template <class Real>
ModuliRows<Real> ElasticSystem<D>::rowsOf(const Tables<Real>& tables) const
{
  const std::int64_t nx = problem_.elements[0];
  const std::int64_t ny = D == 3 ? problem_.elements[1] : 1;
  const int kinds = isotropic_ ? 2 : stiffnessSize(D);
  return [this, &tables, nx, ny, kinds](std::int64_t row, std::int64_t plane, Real* const* buffer, const Real** rows)
  {
    const std::int64_t first = nx * (row + ny * plane);
    const std::uint8_t* const id = problem_.phase.data() + first;
    const ElasticKernels& kernels = elasticKernels();
    constexpr bool isSingle = std::is_same_v<Real, float>;
    std::copy_n(buffer, kinds, rows);
    if constexpr (isSingle)
      if (isotropic_)
      {
        kernels.lookUp(nx, id, tables.stiffness[0].data(), tables.stiffness[1].data(), buffer[0], buffer[1]);
        return;
      }
    // of laws that turn; then of tensors that do not
    if (turns_)
    {
      const float* const axis = problem_.axis[static_cast<std::size_t>(first)].data();
      std::array<const Real*, axialSize> moduli{};
      for (std::size_t k = 0; k < moduli.size(); ++k)
        moduli[k] = tables.axial[k].data();
      if constexpr (isSingle)
        (D == 2 ? kernels.turnPlane : kernels.turnSpace)(nx, id, moduli.data(), axis, buffer);
      else
        (D == 2 ? kernels.turnPlaneDouble : kernels.turnSpaceDouble)(nx, id, moduli.data(), axis, buffer);
    }
    for (std::int64_t i = 0; i < nx; ++i)
      if (!turns_ || full_[id[i]])
        for (int k = 0; k < kinds; ++k)
          buffer[k][i] = tables.stiffness[static_cast<std::size_t>(k)][id[i]];
  };
}

template <int D>
ModuliRows<float> ElasticSystem<D>::keptRows(const ElasticGrid<D>& grid, const ModuliRows<float>& made)
{
  constexpr int kinds = stiffnessSize(D);
  kept_ = std::make_unique<StoredModuli<D>>(grid, kinds);
  ModuliBuffer<D, float> buffer(grid.elements[0]);
  for (std::int64_t k = grid.first(); k < grid.lastElements(); ++k)
  {
    made(0, k, buffer.buffer.data(), buffer.rows.data());
    for (int m = 0; m < kinds; ++m)
      std::copy_n(buffer.rows[static_cast<std::size_t>(m)], grid.elements[0], kept_->row(m, 0, k));
  }
  kept_->takeBelow(grid.parts);
  return kept_->rows();
}

template <int D>
ElasticSystem<D>::ElasticSystem(const ElasticProblem<D>& problem, const ElasticOptions& options)
  : problem_(problem)
  , options_(options)
{
  setLaws();
  ElasticGrid<D> grid;
  grid.elements = problem.elements;
  grid.periodic = problem.periodic;
  grid.held = problem.held;
  const auto isCube = [](double a) { return a == 0 || a == 1; };
  if (!std::ranges::all_of(problem.aspect, isCube))
    for (std::size_t a = 0; a < D; ++a)
      grid.width[a].assign(
        static_cast<std::size_t>(grid.elements[a]), static_cast<float>(problem.aspect[a] == 0 ? 1 : problem.aspect[a]));
  grid.share(problem.ranks);
  ModuliRows<float> single = rowsOf<float>(single_);
  if constexpr (D == 2)
    if (!isotropic_) // in the plane there is room for them
      single = keptRows(grid, single);
  op_ = std::make_unique<ElasticOperator<D>>(grid, isotropic_, single, rowsOf<double>(exact64_), problem.threads);
  const bool constrained = !standIn_.stiffness[0].empty();
  if (constrained)
  {
    bodies_ = std::make_unique<RigidPieces<D>>(grid, problem_.phase, rigid_);
    stiffOp_ =
      std::make_unique<ElasticOperator<D>>(grid, isotropic_, rowsOf<float>(standIn_), nullptr, problem.threads);
  }
  multigrid_ = std::make_unique<ElasticMultigrid<D>>(
    constrained ? *stiffOp_ : *op_,
    [this, known = std::map<std::array<double, D>, double>{}](std::array<double, D> widths) mutable
    {
      const auto [found, isNew] = known.try_emplace(widths, 0.0);
      if (isNew)
        found->second = largestEigenvalue(widths);
      return found->second;
    },
    smoothing());
  findPieces();
  const std::size_t n = grid.values();
  if (options_.fields)
    exact_.assign(n, 0.0);
  else
    x_.assign(n, 0.0F);
  r_.assign(n, 0.0F);
  p_.assign(n, 0.0F);
  z_.assign(n, 0.0F);
}

template <int D>
ElasticSystem<D>::~ElasticSystem() = default;

template <int D>
std::size_t ElasticSystem<D>::bytes() const noexcept
{
  return sizeof(float) * (x_.size() + r_.size() + p_.size() + z_.size() + 2 * exact_.size()) + problem_.phase.size() +
    sizeof(float) * (kept_ ? kept_->size() : 0) + sizeof(problem_.axis[0]) * problem_.axis.size() + op_->bytes() +
    (stiffOp_ ? stiffOp_->bytes() : 0) + multigrid_->bytes() + (pieces_ ? pieces_->bytes() : 0) +
    (bodies_ ? bodies_->bytes() : 0);
}

template <int D>
std::array<double, voigtSize(D) * voigtSize(D)> voigtBound(const ElasticProblem<D>& problem)
{
  constexpr int n = voigtSize(D);
  std::array<double, stiffnessSize(D)> mean{};
  std::array<double, 256> counts{};
  const double each = 1.0 / static_cast<double>(problem.phase.size());
  for (std::size_t i = 0; i < problem.phase.size(); ++i)
  {
    const ElasticLaw<D>& law = problem.laws[problem.phase[i]];
    if (!law.turns())
      ++counts[problem.phase[i]];
    else
    {
      const auto c = law.turnedTo(problem.axis[i]);
      for (std::size_t k = 0; k < c.size(); ++k)
        mean[k] += each * c[k];
    }
  }
  for (std::size_t id = 0; id < problem.laws.size(); ++id)
    for (std::size_t k = 0; k < mean.size(); ++k)
      mean[k] += counts[id] * each * problem.laws[id].stiffness[k];
  std::array<double, n * n> bound{};
  for (std::size_t id = 0; id < problem.laws.size(); ++id)
    if (problem.laws[id].rigid && counts[id] > 0)
    {
      bound.fill(std::numeric_limits<double>::infinity());
      return bound;
    }
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      bound[static_cast<std::size_t>(i * n + j)] = mean[static_cast<std::size_t>(triangle(n, i, j))];
  return bound;
}

template <int D>
std::function<void(std::int64_t, std::int64_t, double* const*)> ElasticSystem<D>::eigenstress(
  std::span<const FreeStrain<D>> strains, std::span<const float> times) const
{
  constexpr int n = voigtSize(D);
  using Vector = Eigen::Matrix<double, n, 1>;
  using Matrix = Eigen::Matrix<double, n, n>;
  const auto matrix = [](const std::array<double, stiffnessSize(D)>& values)
  {
    Matrix c;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        c(i, j) = values[static_cast<std::size_t>(triangle(n, i, j))];
    return c;
  };
  std::vector<FreeStrain<D>> free(strains.begin(), strains.end());
  free.resize(256);
  std::vector<Vector> stress(256, Vector::Zero());
  for (std::size_t id = 0; id < problem_.laws.size(); ++id)
    stress[id] = -1 / scale_ * (matrix(problem_.laws[id].stiffness) * Eigen::Map<const Vector>(free[id].strain.data()));
  const std::int64_t nx = op_->grid().elements[0];
  const std::int64_t ny = op_->grid().elementRows();
  return [this, stress, free, matrix, times, nx, ny](std::int64_t row, std::int64_t plane, double* const* out)
  {
    const std::int64_t first = nx * (row + ny * plane);
    for (std::int64_t i = 0; i < nx; ++i)
    {
      const auto at = static_cast<std::size_t>(first + i);
      const std::uint8_t id = problem_.phase[at];
      const ElasticLaw<D>& law = problem_.laws[id];
      Vector s = stress[id];
      if (law.turns())
      {
        Eigen::Matrix<double, D, 1> axis;
        for (std::size_t a = 0; a < D; ++a)
          axis(static_cast<Eigen::Index>(a)) = static_cast<double>(problem_.axis[at][a]);
        axis.normalize();
        Vector strain;
        for (int a = 0; a < D; ++a)
          for (int b = a; b < D; ++b)
          {
            const double part = (free[id].along - free[id].across) * axis(a) * axis(b);
            strain(voigt(D, a, b)) = a == b ? free[id].across + part : 2 * part;
          }
        s = -1 / scale_ * (matrix(law.turnedTo(problem_.axis[at])) * strain);
      }
      const double factor = times.empty() ? 1.0 : static_cast<double>(times[at]);
      for (int k = 0; k < n; ++k)
        out[k][i] = factor * s(k);
    }
  };
}

template <int D>
std::function<void(std::int64_t, std::int64_t, double* const*)> ElasticSystem<D>::traction(
  const std::array<double, voigtSize(D)>& stress) const
{
  const std::int64_t nx = op_->grid().elements[0];
  return [stress, nx, scale = scale_](std::int64_t, std::int64_t, double* const* out)
  {
    for (std::size_t k = 0; k < stress.size(); ++k)
      std::fill_n(out[k], nx, -stress[k] / scale);
  };
}

template <int D>
void ElasticSystem<D>::forFields(const ElasticLoad<D>& load, const FieldRow& f) const
{
  constexpr int n = voigtSize(D);
  const ElasticGrid<D>& g = op_->grid();
  const std::int64_t nx = g.elements[0];
  op_->template forStresses<double>(exact_.data(), &load,
    [&](std::int64_t j, std::int64_t k, const ElasticRow<D, double>& elements, const double* const* stress,
      const double* const* strain, double)
    {
      std::vector<double> store(static_cast<std::size_t>((D + n) * nx), 0.0);
      std::array<double*, D> displacement{};
      std::array<double*, n> pascal{};
      for (int c = 0; c < D; ++c)
      {
        displacement[static_cast<std::size_t>(c)] = store.data() + c * nx;
        for (const double* const u : elements.u[c])
          for (std::int64_t i = 0; i < nx; ++i)
            displacement[static_cast<std::size_t>(c)][i] += cornerFactor<D> / 2 * (u[i] + u[i + 1]);
      }
      for (int v = 0; v < n; ++v)
      {
        pascal[static_cast<std::size_t>(v)] = store.data() + (D + v) * nx;
        for (std::int64_t i = 0; i < nx; ++i)
          pascal[static_cast<std::size_t>(v)][i] = scale_ * stress[v][i];
      }
      f(j, k, displacement.data(), strain, pascal.data());
    });
}

template <int D>
typename ElasticSystem<D>::Field ElasticSystem<D>::field(const ElasticLoad<D>& load) const
{
  return { x_, exact_, load.strain };
}

template <int D>
std::vector<double> ElasticSystem<D>::changes(std::span<const Field> fields, std::size_t numbers) const
{
  const ElasticGrid<D>& g = op_->grid();
  const std::int64_t nx = g.elements[0];
  const std::int64_t ny = g.elementRows();
  const auto pairs = static_cast<std::size_t>(pairsOf(static_cast<int>(fields.size())));
  const auto parts = static_cast<std::size_t>(pairParts(turns_));
  PairPhases phases;
  phases.phase = [this, nx, ny](std::int64_t row, std::int64_t plane)
  { return problem_.phase.data() + nx * (row + ny * plane); };
  if (turns_)
    phases.axis = [this, nx, ny](std::int64_t row, std::int64_t plane)
    { return problem_.axis[static_cast<std::size_t>(nx * (row + ny * plane))].data(); };
  phases.slot.fill(-1);
  struct Factor
  {
    std::size_t slot, number;
    std::array<double, axialSize> parts{};
  };
  std::vector<Factor> factors;
  for (std::size_t id = 0; id < problem_.laws.size(); ++id)
  {
    const ElasticLaw<D>& law = problem_.laws[id];
    if (law.changes.empty() || rigid_[id])
      continue;
    phases.slot[id] = static_cast<std::int16_t>(phases.slots);
    for (const ModulusChange& change : law.changes)
    {
      Factor factor{ phases.slots, change.number, change.moduli };
      if (!turns_) // λ counts as no more than 2 μ in the strains that vary
      {
        double lambda = 0;
        double mu = 0;
        const bool most = law.isotropic(lambda, mu) && isotropic_ && lambda >= 2 * mu;
        factor.parts = { change.moduli[0], most ? 2 * change.moduli[1] : change.moduli[0], change.moduli[1], 0, 0 };
      }
      factors.push_back(factor);
    }
    ++phases.slots;
  }
  if (phases.slots == 0)
    return std::vector<double>(numbers * pairs, 0.0);
  const std::size_t each = numbers * pairs;
  std::vector<double> byPlane(each * static_cast<std::size_t>(g.elementPlanes()), 0.0);
  const auto take = [&](std::int64_t plane, const double* sums)
  {
    double* const out = byPlane.data() + each * static_cast<std::size_t>(plane);
    for (const Factor& factor : factors)
      for (std::size_t part = 0; part < parts; ++part)
        for (std::size_t pair = 0; pair < pairs; ++pair)
          out[factor.number * pairs + pair] += factor.parts[part] * sums[(factor.slot * parts + part) * pairs + pair];
  };
  const auto run = [&]<class Real>(std::vector<Real> Field::*values)
  {
    std::vector<StrainField<Real>> all;
    for (const Field& field : fields)
      all.push_back({ (field.*values).data(), field.strain });
    op_->template forPairs<Real>(all, phases, take);
  };
  if (options_.fields)
    run(&Field::exact);
  else
    run(&Field::single);
  std::vector<double> sums = totals(byPlane, each);
  for (double& sum : sums)
    sum /= static_cast<double>(nx * ny * g.elementPlanes());
  return sums;
}

template <int D>
void ElasticSystem<D>::correctPieces()
{
  // z += Q (r − A z)
  const ElasticGrid<D>& g = op_->grid();
  typename PieceMotions<D>::Sums sums(pieces_->motions());
  op_->template sweep<float>(z_.data(), nullptr, false,
    [&](int, std::int64_t k, std::int64_t j, float* const* rows)
    {
      for (int c = 0; c < D; ++c)
      {
        const float* const r = r_.data() + c * g.componentStride() + g.at(j, k);
        for (std::int64_t i = 0; i < g.rowLength(); ++i)
          rows[c][i] = r[i] - rows[c][i];
      }
      sums.add(j, k, rows);
    });
  pieces_->add(sums.total(), op_->threads(), z_.data());
}

template <int D>
double ElasticSystem<D>::startEnergy(const ElasticLoad<D>& load) const
{
  constexpr std::size_t m = voigtSize(D);
  const ElasticGrid<D>& g = op_->grid();
  const auto voxels = static_cast<double>(g.elements[0] * g.elementRows() * g.elementPlanes());
  if (!bodies_ && !pieces_)
  {
    double whole = 0;
    const auto bound = voigtBound(problem_);
    for (std::size_t a = 0; a < m; ++a)
      for (std::size_t b = 0; b < m; ++b)
        whole += voxels / scale_ * bound[a * m + b] * load.strain[a] * load.strain[b];
    return whole;
  }
  std::vector<double> parts(static_cast<std::size_t>(g.elementPlanes()), 0.0);
  const auto take = [&](std::int64_t, std::int64_t k, const ElasticRow<D, double>&, const double* const*,
                      const double* const*, double energy) { parts[static_cast<std::size_t>(k)] += energy; };
  if (options_.fields)
    op_->template forStresses<double>(exact_.data(), &load, take);
  else
    op_->template forStresses<float>(x_.data(), &load, take);
  return totals(parts, 1)[0];
}

template <int D>
std::vector<double> ElasticSystem<D>::totals(std::vector<double>& byPlane, std::size_t count) const
{
  op_->grid().parts.gather(byPlane, static_cast<std::int64_t>(byPlane.size() / count));
  std::vector<double> sums(count, 0.0);
  for (std::size_t i = 0; i < byPlane.size(); ++i)
    sums[i % count] += byPlane[i];
  return sums;
}

namespace
{

// What the energy may have had to fall before the last few steps, at most about: what it fell in them, and more where
// it falls slowly, by how the steps before them fell.
double leftOf(const std::array<double, 2 * delay>& falls, int iterations)
{
  double last = 0;
  double before = 0;
  for (int k = 1; k <= std::min(iterations, 2 * delay); ++k)
    (k <= delay ? last : before) += falls[static_cast<std::size_t>((iterations - k) % (2 * delay))];
  const double ratio = before > 0 ? std::min(last / before, slowest) : 0.0;
  return last / (1 - ratio);
}

template <int D>
[[noreturn]] void fail(const ElasticResult<D>& result, int most)
{
  if (result.iterations >= most)
    throw DivergenceError(fmt::format("the stiffness still errs by {:.1e} after {} iterations of elements",
                            result.solverError, result.iterations),
      "allow more iterations, or a larger tolerance");
  throw DivergenceError(fmt::format("displacements are not finite after {} iterations of elements", result.iterations),
    "please report this with the picture and the materials");
}

} // namespace

template <int D>
ElasticResult<D> ElasticSystem<D>::solve(const ElasticLoad<D>& load)
{
  const ElasticGrid<D>& g = op_->grid();
  const ElasticKernels& kernels = elasticKernels();
  const std::int64_t own = g.nodes(0);
  const std::int64_t component = g.componentStride();
  const auto planes = static_cast<std::size_t>(g.planes());
  const int threads = op_->threads();
  std::vector<double> parts(planes);
  const auto total = [&] { return totals(parts, 1)[0]; };

  // r = −(A x + what the load gives); in double where single precision would lose what is left of a rigid piece's
  // forces
  std::vector<double> wide(bodies_ && options_.fields ? g.values() : 0);
  const auto residual = [&]
  {
    std::ranges::fill(parts, 0.0);
    const auto set = [&](int, std::int64_t k, std::int64_t j, auto* const* sums)
    {
      for (int c = 0; c < D; ++c)
      {
        float* const out = r_.data() + c * component + g.at(j, k);
        for (std::int64_t i = 0; i < g.rowLength(); ++i)
          out[i] = static_cast<float>(-sums[c][i]);
        for (std::int64_t i = 0; i < g.rowLength() && !wide.empty(); ++i)
          wide[static_cast<std::size_t>(c * component + g.at(j, k) + i)] = -static_cast<double>(sums[c][i]);
        parts[static_cast<std::size_t>(k)] += kernels.dot(own, out, out);
      }
    };
    if (options_.fields)
      op_->template sweep<double>(exact_.data(), &load, false, set);
    else
      op_->template sweep<float>(x_.data(), &load, false, set);
  };
  std::ranges::fill(x_, 0.0F);
  std::ranges::fill(exact_, 0.0);
  std::ranges::fill(p_, 0.0F);
  if (bodies_)
    options_.fields ? bodies_->start(load.strain, threads, exact_.data())
                    : bodies_->start(load.strain, threads, x_.data());
  const auto forPlanes = [&](auto&& f)
  {
#pragma omp parallel for num_threads(threads) if (threads > 1) schedule(static)
    for (std::int64_t k = g.first(); k < g.last(); ++k)
    {
      double sum = 0;
      for (int c = 0; c < D; ++c)
        for (std::int64_t j = 0; j < g.rows(); ++j)
          sum += f(c * component + g.at(j, k));
      parts[static_cast<std::size_t>(k)] = sum;
    }
    return total();
  };
  const auto freshResidual = [&]
  {
    residual();
    if (!bodies_)
      return total();
    if (wide.empty())
      bodies_->project(r_.data(), threads);
    else
    {
      bodies_->project(wide.data(), threads);
      std::ranges::transform(wide, r_.begin(), [](double v) { return static_cast<float>(v); });
    }
    return forPlanes([&](std::int64_t at) { return kernels.dot(own, r_.data() + at, r_.data() + at); });
  };
  ElasticResult<D> result;
  double rr = freshResidual();
  if (pieces_) // from where no force is left on them
  {
    options_.fields ? pieces_->add(pieces_->forces(r_.data()), threads, exact_.data())
                    : pieces_->add(pieces_->forces(r_.data()), threads, x_.data());
    rr = freshResidual();
  }
  const double first = rr;
  // what rounding leaves of the load's forces
  double given = 0;
  if (load.initial)
  {
    InitialBuffer<D, float> initial(g.elements[0], true);
    std::vector<double> byPlane(static_cast<std::size_t>(g.elementPlanes()), 0.0);
    for (std::int64_t k = g.first(); k < g.lastElements(); ++k)
      for (std::int64_t j = 0; j < g.elementRows(); ++j)
      {
        load.initial(j, k, initial.from.data());
        byPlane[static_cast<std::size_t>(k)] +=
          std::inner_product(initial.given.begin(), initial.given.end(), initial.given.begin(), 0.0);
      }
    given = totals(byPlane, 1)[0] / static_cast<double>(g.ownNodes());
  }
  const double floor = (options_.fields ? 1e-28 : 1e-14) * static_cast<double>(g.ownNodes()) * cornerFactor<D> *
    cornerFactor<D> * (given + std::inner_product(load.strain.begin(), load.strain.end(), load.strain.begin(), 0.0));
  // energies in units of the kernels, summed over voxels
  const auto voxels = static_cast<double>(g.elements[0] * g.elementRows() * g.elementPlanes());
  const double whole = load.initial ? 0.0 : startEnergy(load);
  std::array<double, 2 * delay> falls{};
  double fallen = 0;
  bool converged = !(rr > floor);
  // r·z, and the means of z's components that are free to shift; r·z is that without them.
  std::vector<double> layers(3 * D * planes);
  const auto preconditioned = [&](std::array<double, D>& shift)
  {
#pragma omp parallel for num_threads(threads) if (threads > 1) schedule(static)
    for (std::int64_t k = g.first(); k < g.last(); ++k)
    {
      double* const sums = layers.data() + 3 * D * k;
      std::fill_n(sums, 3 * D, 0.0);
      for (int c = 0; c < D; ++c)
        for (std::int64_t j = 0; j < g.rows(); ++j)
          kernels.dotAndSums(
            own, r_.data() + c * component + g.at(j, k), z_.data() + c * component + g.at(j, k), sums + 3 * c);
    }
    const std::vector<double> all = totals(layers, 3 * D);
    double rz = 0;
    for (std::size_t c = 0; c < D; ++c)
    {
      const double* const sums = all.data() + 3 * c;
      const bool holds = std::ranges::any_of(g.held, [c](const auto& held) { return held[c]; });
      shift[c] = holds ? 0.0 : sums[2] / static_cast<double>(g.ownNodes());
      rz += sums[0] - sums[1] * shift[c];
    }
    return rz;
  };
  // x and r take a step; copies at the ends of rows move as the first nodes, and count once
  const auto step = [&](double alpha)
  {
    return forPlanes(
      [&](std::int64_t at)
      {
        const std::int64_t end = at + g.elements[0];
        double sum = 0;
        if (options_.fields)
          sum = kernels.stepDouble(own, alpha, p_.data() + at, z_.data() + at, exact_.data() + at, r_.data() + at);
        else
          sum = kernels.step(own, alpha, p_.data() + at, z_.data() + at, x_.data() + at, r_.data() + at);
        if (g.periodic[0])
        {
          r_[static_cast<std::size_t>(end)] = r_[static_cast<std::size_t>(at)];
          if (options_.fields)
            exact_[static_cast<std::size_t>(end)] = exact_[static_cast<std::size_t>(at)];
          else
            x_[static_cast<std::size_t>(end)] = x_[static_cast<std::size_t>(at)];
        }
        return sum;
      });
  };

  for (bool fresh = true; !converged;)
  {
    // with displacements in double the residual is made anew before single precision has lost it
    const double start = rr;
    const double until = options_.fields ? std::max(floor, mostFall * mostFall * start) : floor;
    double rzBefore = 1;
    fresh = true;
    while (rr > until && !converged)
    {
      if (result.iterations >= options_.maxIterations)
        fail(result, options_.maxIterations);
      multigrid_->cycle(r_.data(), z_.data());
      if (pieces_)
        correctPieces();
      if (bodies_)
        bodies_->project(z_.data(), threads);
      // Translations that nothing holds are taken off: once the residual is near rounding they would grow.
      std::array<double, D> shift{};
      const double rz = preconditioned(shift);
      if (!(rz > 0))
        break;
      const auto beta = static_cast<float>(fresh ? 0.0 : rz / rzBefore);
      fresh = false;
      rzBefore = rz;
#pragma omp parallel for num_threads(threads) if (threads > 1) schedule(static)
      for (std::int64_t k = g.first(); k < g.last(); ++k)
        for (int c = 0; c < D; ++c)
          for (std::int64_t j = 0; j < g.rows(); ++j)
            kernels.direct(g.rowLength(), beta, static_cast<float>(shift[static_cast<std::size_t>(c)]),
              z_.data() + c * component + g.at(j, k), p_.data() + c * component + g.at(j, k));
      std::ranges::fill(parts, 0.0);
      op_->template sweep<float>(p_.data(), nullptr, false,
        [&](int, std::int64_t k, std::int64_t j, float* const* sums)
        {
          for (int c = 0; c < D; ++c)
          {
            const std::int64_t at = c * component + g.at(j, k);
            std::copy_n(sums[c], g.rowLength(), z_.data() + at);
            parts[static_cast<std::size_t>(k)] += kernels.dot(own, sums[c], p_.data() + at);
          }
        });
      const double pq = total();
      if (!(pq > 0))
        break;
      const double alpha = rz / pq;
      if (bodies_)
        bodies_->project(z_.data(), threads);
      rr = step(alpha);
      if (!std::isfinite(rr))
        fail(result, options_.maxIterations);
      falls[static_cast<std::size_t>(result.iterations % (2 * delay))] = alpha * rz;
      fallen += alpha * rz;
      ++result.iterations;
      const double unit =
        load.initial ? fallen : std::max(whole - fallen, (options_.fields ? leastExact : leastSingle) * whole);
      result.solverError = std::min(1.0, doubt_ * leftOf(falls, result.iterations) / unit);
      const bool enough = result.iterations > delay && result.solverError <= options_.tolerance;
      // layers are exact after a step or two; and below rounding there is nothing to be had
      if (!enough && (doubt_ * alpha * rz <= nothing * options_.tolerance * unit || !(rr > floor)))
        result.solverError = std::min(1.0, alpha * rz / unit);
      converged = enough || doubt_ * alpha * rz <= nothing * options_.tolerance * unit;
      const bool stop = options_.progress && !options_.progress(result.iterations, result.solverError);
      if (problem_.ranks.any(stop))
        throw Cancelled();
    }
    if (!options_.fields || converged)
      break;
    rr = freshResidual();
    converged = rr <= floor || !(rr < leastProgress * start); // as far as it goes
    if (rr <= floor && first > 0)                             // in fewer steps than tell what is left
      result.solverError = std::min(result.solverError, std::sqrt(rr / first));
  }
  result.residual = first > 0 ? std::sqrt(rr / first) : 0.0;

  constexpr std::size_t n = voigtSize(D);
  constexpr std::size_t sums = 2 * n + 1;
  std::vector<double> means(sums * static_cast<std::size_t>(g.elementPlanes()), 0.0);
  const auto sum = [&](std::int64_t, std::int64_t k, const ElasticRow<D, double>&, const double* const* stress,
                     const double* const* strain, double energy)
  {
    double* const part = means.data() + static_cast<std::int64_t>(sums) * k;
    for (std::size_t v = 0; v < n; ++v)
    {
      part[v] += std::accumulate(stress[v], stress[v] + g.elements[0], 0.0);
      part[n + v] += std::accumulate(strain[v], strain[v] + g.elements[0], 0.0);
    }
    part[2 * n] += energy;
  };
  if (options_.fields)
    op_->template forStresses<double>(exact_.data(), &load, sum);
  else
    op_->template forStresses<float>(x_.data(), &load, sum);
  const std::vector<double> all = totals(means, sums);
  for (std::size_t v = 0; v < n; ++v)
  {
    result.stress[v] = scale_ * all[v] / voxels;
    result.strain[v] = all[n + v] / voxels;
  }
  result.energy = scale_ * all[2 * n] / voxels;
  // what is found cannot be stiffer than the mean strain, nor less than nothing
  const double most = scale_ * whole / voxels;
  if (!load.initial && !(std::abs(result.energy - 0.5 * most) <= (0.5 + wrong) * most))
    fail(result, result.iterations);
  if (bodies_) // their stress is what holds them
  {
    residual();
    const auto held = wide.empty() ? bodies_->stress(r_.data()) : bodies_->stress(wide.data());
    for (std::size_t v = 0; v < n; ++v)
      result.stress[v] -= scale_ / voxels * held[v]; // r is what holds them, reversed
  }
  return result;
}

template std::array<double, 9> voigtBound(const ElasticProblem<2>&);
template std::array<double, 36> voigtBound(const ElasticProblem<3>&);
template struct ElasticLaw<2>;
template struct ElasticLaw<3>;
template class ElasticSystem<2>;
template class ElasticSystem<3>;

} // namespace lamella::elasticity
