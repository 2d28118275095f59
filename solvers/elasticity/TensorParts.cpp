#include "elasticity/TensorParts.h"

#include "elasticity/ElasticKernels.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lamella::elasticity
{
namespace
{

constexpr double finest = 1e-7; // of angles between axes

// Kelvin's form, shears times √2: products and norms are those of the tensor.
Eigen::MatrixXd kelvin(std::span<const double> stiffness, int d)
{
  const int n = voigtSize(d);
  Eigen::MatrixXd c(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      c(i, j) = 0.5 * (i < d ? 1 : std::numbers::sqrt2) * (j < d ? 1 : std::numbers::sqrt2) *
        (stiffness[static_cast<std::size_t>(i * n + j)] + stiffness[static_cast<std::size_t>(j * n + i)]);
  return c;
}

// Of the axes q, one a column.
Eigen::MatrixXd inAxes(const Eigen::MatrixXd& c, const Eigen::MatrixXd& q)
{
  const auto d = static_cast<int>(q.rows());
  const int n = voigtSize(d);
  Eigen::MatrixXd turn(n, n); // of Kelvin's vectors into these axes
  for (int i = 0; i < d; ++i)
    for (int j = i; j < d; ++j)
      for (int k = 0; k < d; ++k)
        for (int l = k; l < d; ++l)
        {
          const double even = q(k, i) * q(l, j) + q(l, i) * q(k, j);
          turn(voigt(d, i, j), voigt(d, k, l)) =
            even / ((i == j ? std::numbers::sqrt2 : 1) * (k == l ? std::numbers::sqrt2 : 1));
        }
  return turn * c * turn.transpose();
}

Eigen::MatrixXd orthotropicPart(const Eigen::MatrixXd& c, int d)
{
  Eigen::MatrixXd part = Eigen::MatrixXd::Zero(c.rows(), c.cols());
  part.topLeftCorner(d, d) = c.topLeftCorner(d, d);
  part.diagonal() = c.diagonal();
  return part;
}

} // namespace

IsotropicPart nearestIsotropic(std::span<const double> stiffness, int d)
{
  const Eigen::MatrixXd c = kelvin(stiffness, d);
  const int n = voigtSize(d);
  const double spread = c.topLeftCorner(d, d).sum(); // C_iijj
  IsotropicPart part;
  part.bulk = spread / (d * d);
  part.shear = (c.trace() - spread / d) / (2 * (n - 1));
  const double lambda = part.bulk - 2 * part.shear / d;
  Eigen::MatrixXd same = 2 * part.shear * Eigen::MatrixXd::Identity(n, n);
  same.topLeftCorner(d, d).array() += lambda;
  part.rest = c.norm() > 0 ? (c - same).norm() / c.norm() : 0.0;
  const double k = part.bulk;
  const double g = part.shear;
  part.poisson = d == 3 ? (3 * k - 2 * g) / (2 * (3 * k + g)) : (k - g) / (k + g);
  part.young = 2 * g * (1 + part.poisson);
  return part;
}

OrthotropicPart nearestOrthotropic(std::span<const double> stiffness, int d)
{
  const Eigen::MatrixXd c = kelvin(stiffness, d);
  const auto rest = [&](const Eigen::MatrixXd& q)
  {
    const Eigen::MatrixXd turned = inAxes(c, q);
    return (turned - orthotropicPart(turned, d)).norm();
  };
  Eigen::MatrixXd dilatation(d, d);
  Eigen::MatrixXd other(d, d);
  for (int i = 0; i < d; ++i)
    for (int j = 0; j < d; ++j)
    {
      const auto component = [&](int a, int b, int k, int l)
      {
        return c(voigt(d, a, b), voigt(d, k, l)) /
          ((a == b ? 1 : std::numbers::sqrt2) * (k == l ? 1 : std::numbers::sqrt2));
      };
      dilatation(i, j) = other(i, j) = 0;
      for (int k = 0; k < d; ++k)
      {
        dilatation(i, j) += component(i, j, k, k);
        other(i, j) += component(i, k, j, k);
      }
    }
  Eigen::MatrixXd best = Eigen::MatrixXd::Identity(d, d);
  double least = rest(best);
  for (const Eigen::MatrixXd* const by : { &dilatation, &other })
  {
    const Eigen::MatrixXd q = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(*by).eigenvectors();
    if (const double left = rest(q); left < (1 - 1e-9) * least)
    {
      best = q;
      least = left;
    }
  }
  for (double step = 0.5; step > finest;) // turns about each axis, as far as they help
  {
    bool better = false;
    for (int a = 0; a < d; ++a)
      for (int b = a + 1; b < d; ++b)
        for (const double angle : { step, -step })
        {
          Eigen::MatrixXd q = best;
          q.col(a) = std::cos(angle) * best.col(a) + std::sin(angle) * best.col(b);
          q.col(b) = -std::sin(angle) * best.col(a) + std::cos(angle) * best.col(b);
          if (const double left = rest(q); left < (1 - 1e-12) * least)
          {
            best = q;
            least = left;
            better = true;
          }
        }
    if (!better)
      step /= 2;
  }
  // each axis named after the one of the box that it is nearest to, and pointing the same way
  Eigen::MatrixXd named(d, d);
  std::vector<int> free(static_cast<std::size_t>(d));
  for (int a = 0; a < d; ++a)
    free[static_cast<std::size_t>(a)] = a;
  for (int a = 0; a < d; ++a)
  {
    const auto nearest =
      std::ranges::max_element(free, [&](int x, int y) { return std::abs(best(a, x)) < std::abs(best(a, y)); });
    named.col(a) = (best(a, *nearest) < 0 ? -1 : 1) * best.col(*nearest);
    free.erase(nearest);
  }
  if (named.determinant() < 0)
    named.col(d - 1) *= -1;
  OrthotropicPart part;
  const Eigen::MatrixXd turned = inAxes(c, named);
  const Eigen::MatrixXd own = orthotropicPart(turned, d);
  part.rest = c.norm() > 0 ? (turned - own).norm() / c.norm() : 0.0;
  for (int i = 0; i < own.rows(); ++i)
    for (int j = 0; j < own.cols(); ++j)
      part.stiffness.push_back(own(i, j) / ((i < d ? 1 : std::numbers::sqrt2) * (j < d ? 1 : std::numbers::sqrt2)));
  for (int a = 0; a < 3; ++a)
    for (int i = 0; i < 3; ++i)
      part.axes[static_cast<std::size_t>(a)][static_cast<std::size_t>(i)] =
        a < d && i < d ? named(i, a) : (a == i ? 1.0 : 0.0);
  return part;
}

IsotropicBounds hashinShtrikman(
  std::span<const double> fractions, std::span<const double> bulk, std::span<const double> shear, int dimension)
{
  IsotropicBounds bounds;
  std::array<double, 2> k{ std::numeric_limits<double>::infinity(), 0 };
  std::array<double, 2> g = k;
  for (std::size_t i = 0; i < fractions.size(); ++i)
    if (fractions[i] > 0)
    {
      k = { std::min(k[0], bulk[i]), std::max(k[1], bulk[i]) };
      g = { std::min(g[0], shear[i]), std::max(g[1], shear[i]) };
    }
  const auto mixed = [&](std::span<const double> values, double reference)
  {
    double sum = 0;
    for (std::size_t i = 0; i < fractions.size(); ++i)
      if (fractions[i] > 0)
      {
        if (!(values[i] + reference > 0))
          return 0.0;
        sum += fractions[i] / (values[i] + reference);
      }
    return 1 / sum - reference;
  };
  for (std::size_t side = 0; side < 2; ++side)
  {
    const double ks = k[side];
    const double gs = g[side];
    const double forShear = !(gs > 0) ? 0
      : dimension == 3                ? gs * (9 * ks + 8 * gs) / (6 * (ks + 2 * gs))
                                      : gs * ks / (ks + 2 * gs);
    bounds.bulk[side] = mixed(bulk, dimension == 3 ? 4.0 / 3 * gs : gs);
    bounds.shear[side] = mixed(shear, forShear);
  }
  return bounds;
}

} // namespace lamella::elasticity
