#include "peridynamics/multigrid/CoarsestLevel.h"

#include "core/Error.h"

#include <algorithm>
#include <vector>

namespace lamella::peridynamics
{
namespace
{

constexpr std::int64_t denseLimit = 600; // unknowns; a pseudo-inverse of so many takes a tenth of a second
// unknowns whose factors take about a tenth of a gigabyte
constexpr std::int64_t factorLimit2 = 40000;
constexpr std::int64_t factorLimit3 = 6000;
constexpr double singular = 1e-6; // of the largest eigenvalue: the matrix is in single precision

} // namespace

bool CoarsestLevel::possible(const NodeLayout& layout) noexcept
{
  return layout.owned() * layout.dimension <= (layout.dimension == 3 ? factorLimit3 : factorLimit2);
}

CoarsestLevel::CoarsestLevel(const Level& level)
{
  const NodeLayout& l = level.layout;
  const int d = l.dimension;
  constexpr int entry3[3][3] = { { 0, 3, 5 }, { 3, 1, 4 }, { 5, 4, 2 } };
  constexpr int entry2[2][2] = { { 0, 2 }, { 2, 1 } };
  const auto entryOf = [&](int a, int b) { return d == 3 ? entry3[a][b] : entry2[a][b]; };
  const std::int64_t n = l.owned() * d;
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](std::int64_t row, std::int64_t column, double value)
  {
    if (value != 0)
      entries.emplace_back(static_cast<int>(row), static_cast<int>(column), value);
  };
  const auto number = [&](std::int64_t x, std::int64_t y, std::int64_t z)
  { return d * (x + l.size[0] * (y + l.size[1] * z)); };
  const auto wrap = [&](std::int64_t& x, std::size_t axis)
  {
    if (level.periodic[axis])
      x = ((x % l.size[axis]) + l.size[axis]) % l.size[axis];
    return x >= 0 && x < l.size[axis];
  };
  for (std::int64_t z = 0; z < l.size[2]; ++z)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
      for (std::int64_t x = 0; x < l.size[0]; ++x)
      {
        const std::int64_t i = l.index(x, y, z);
        const std::int64_t row = number(x, y, z);
        for (int p = 0; p < d; ++p)
          for (int q = 0; q < d; ++q)
            add(row + p, row + q, static_cast<double>(level.diagonal.component(entryOf(p, q))[i]));
        for (std::size_t h = 0; h < level.half.size(); ++h)
        {
          std::array<std::int64_t, 3> to{ x + level.half[h][0], y + level.half[h][1], z + level.half[h][2] };
          if (!wrap(to[0], 0) || !wrap(to[1], 1) || !wrap(to[2], 2))
            continue;
          const std::int64_t column = number(to[0], to[1], to[2]);
          for (int p = 0; p < d; ++p)
            for (int q = 0; q < d; ++q)
            {
              const double v =
                static_cast<double>(level.value(static_cast<int>(h) * level.entries() + entryOf(p, q), i));
              add(row + p, column + q, v);
              add(column + q, row + p, v);
            }
        }
      }
  Eigen::SparseMatrix<double> a(n, n);
  a.setFromTriplets(entries.begin(), entries.end());
  if (n > denseLimit)
  {
    // what is not held gets springs a millionth as stiff as a node
    Eigen::VectorXd springs = a.diagonal();
    const double least = singular * springs.maxCoeff();
    for (std::int64_t i = 0; i < n; ++i)
      a.coeffRef(i, i) += std::max(singular * springs[i], springs[i] > 0 ? 0 : least);
    factors_ = std::make_unique<Factors>(a);
    if (factors_->info() != Eigen::Success)
      throw DivergenceError("the coarsest lattice of the multigrid hierarchy cannot be factorised",
        "give the periodic cell numbers of nodes that can be halved more often");
    return;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen{ Eigen::MatrixXd(a) };
  const Eigen::VectorXd& values = eigen.eigenvalues();
  const double least = singular * std::max(values[n - 1], 0.0);
  Eigen::VectorXd inverse(n);
  for (std::int64_t i = 0; i < n; ++i)
    inverse[i] = values[i] > least ? 1 / values[i] : 0;
  inverse_ = (eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose()).cast<float>();
}

// Sherman and Morrison: (A − k v vᵀ)⁻¹ = A⁻¹ + k/(1 − k vᵀA⁻¹v) A⁻¹v vᵀA⁻¹.
bool CoarsestLevel::subtract(const std::vector<std::pair<std::int64_t, double>>& v, double k)
{
  constexpr double least = 1e-4; // of the stiffness along v: below, what is left has too few digits
  if (factors_)
    return false;
  if (exact_.size() == 0)
    exact_ = inverse_.cast<double>();
  Eigen::VectorXd w = Eigen::VectorXd::Zero(exact_.rows());
  for (const auto& [i, weight] : v)
    w += weight * exact_.col(i);
  double along = 0;
  for (const auto& [i, weight] : v)
    along += weight * w[i];
  const double left = 1 - k * along;
  if (!(left > least))
    return false;
  exact_.noalias() += (k / left) * w * w.transpose();
  inverse_ = exact_.cast<float>();
  return true;
}

void CoarsestLevel::solve(Level& level) const
{
  const NodeLayout& l = level.layout;
  const int d = l.dimension;
  Eigen::VectorXf v(l.owned() * d);
  const auto each = [&](const auto& f)
  {
    std::int64_t n = 0;
    for (std::int64_t z = 0; z < l.size[2]; ++z)
      for (std::int64_t y = 0; y < l.size[1]; ++y)
        for (std::int64_t x = 0; x < l.size[0]; ++x)
          for (int c = 0; c < d; ++c)
            f(c, l.index(x, y, z), n++);
  };
  each([&](int c, std::int64_t i, std::int64_t n) { v[n] = level.r.component(c)[i]; });
  const Eigen::VectorXf x =
    factors_ ? Eigen::VectorXf(factors_->solve(v.cast<double>()).cast<float>()) : Eigen::VectorXf(inverse_ * v);
  each([&](int c, std::int64_t i, std::int64_t n) { level.x.component(c)[i] = x[n]; });
}

} // namespace lamella::peridynamics
