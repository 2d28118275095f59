#include "elasticity/DirectionalConstants.h"

#include "elasticity/ElasticConstants.h"
#include "elasticity/ElasticKernels.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace lamella::elasticity
{
namespace
{

using Vector = Eigen::Vector3d;
using AcrossForm = Eigen::Matrix2d; // of directions across; in the plane its first entry alone

struct Search
{
  static constexpr int gridInSpace = 1500; // of half the sphere: 4° apart
  static constexpr int gridInPlane = 90;   // of half the circle
  static constexpr std::size_t starts = 6; // from which an extreme is looked for
  static constexpr double apart = 0.3;     // of them [rad]
  static constexpr double first = 0.05;    // turn of a direction [rad]
  static constexpr double finest = 1e-7;
  static constexpr int moves = 20; // by turns of one size: along a crest, which may be sharp, there is no end of them
  static constexpr double told = 1e-6; // what a direction must be better by than one with a name
  static constexpr double rounding = 1e-13;
};

// Kelvin's vector of the symmetric part of a b.
template <class Kelvin>
Kelvin dyad(const Vector& a, const Vector& b, int d)
{
  Kelvin v(voigtSize(d));
  for (int i = 0; i < d; ++i)
    for (int j = i; j < d; ++j)
      v(voigt(d, i, j)) = i == j ? a(i) * b(i) : (a(i) * b(j) + a(j) * b(i)) / std::numbers::sqrt2;
  return v;
}

Vector pointing(Vector v)
{
  for (int i = 0; i < 3; ++i)
    if (std::abs(v(i)) > 1e-9)
    {
      v *= v(i) < 0 ? -1 : 1;
      break;
    }
  for (int i = 0; i < 3; ++i)
    v(i) = std::abs(v(i)) < 1e-12 ? 0.0 : v(i); // no −0
  return v;
}

std::array<double, 3> arrayOf(const Vector& v)
{
  return { v(0), v(1), v(2) };
}

// Of half of all directions.
std::vector<Vector> gridOf(int d)
{
  std::vector<Vector> grid;
  const int count = d == 3 ? Search::gridInSpace : Search::gridInPlane;
  for (int i = 0; i < count; ++i)
  {
    if (d == 2)
    {
      const double angle = std::numbers::pi * (i + 0.5) / count;
      grid.emplace_back(std::cos(angle), std::sin(angle), 0);
      continue;
    }
    const double z = (i + 0.5) / count;
    const double angle = 2 * std::numbers::pi * i / std::numbers::phi; // a spiral, evenly spread
    grid.emplace_back(std::sqrt(1 - z * z) * std::cos(angle), std::sqrt(1 - z * z) * std::sin(angle), z);
  }
  return grid;
}

// The box's axes and diagonals.
std::vector<Vector> namedOf(int d)
{
  std::vector<Vector> named;
  for (int length = 1; length <= d; ++length)
    for (int z = 1; z >= (d == 3 ? -1 : 1); --z)
      for (int y = 1; y >= -1; --y)
        for (int x = 1; x >= -1; --x)
        {
          const Vector v(x, y, d == 3 ? z : 0);
          if (v.cwiseAbs().sum() == length && pointing(v) == v)
            named.push_back(v.normalized());
        }
  std::ranges::sort(named, // axes first, x before y
    [](const Vector& a, const Vector& b)
    {
      for (const double difference : { a.cwiseAbs().maxCoeff() - b.cwiseAbs().maxCoeff(), a(0) - b(0), a(1) - b(1) })
        if (std::abs(difference) > 1e-9)
          return difference > 0;
      return a(2) - b(2) > 1e-9;
    });
  return named;
}

} // namespace

// What a direction has, with the directions across it of the least and the most.
struct DirectionalConstants::Along
{
  using Kelvin = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1>;

  Vector along;
  ConstantsAlong values;
  std::array<Vector, 2> acrossShear, acrossPoisson;
};

DirectionalConstants::DirectionalConstants(std::span<const double> stiffness, int dimension, double zero)
  : dimension_(dimension)
{
  const int n = voigtSize(dimension);
  Eigen::MatrixXd c(n, n);
  const auto weight = [&](int i) { return i < dimension ? 1 : std::numbers::sqrt2; };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      c(i, j) = 0.5 * weight(i) * weight(j) *
        (stiffness[static_cast<std::size_t>(i * n + j)] + stiffness[static_cast<std::size_t>(j * n + i)]);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(c);
  const Eigen::VectorXd& values = modes.eigenvalues();
  const Eigen::MatrixXd& v = modes.eigenvectors();
  const double least = zero * std::max(values.maxCoeff(), 0.0);
  Eigen::MatrixXd compliance = Eigen::MatrixXd::Zero(n, n);
  Eigen::MatrixXd lost = compliance;
  for (Eigen::Index k = 0; k < n; ++k)
  {
    const bool resists = values(k) > least;
    resists_ = resists_ && resists;
    (resists ? compliance : lost) += v.col(k) * v.col(k).transpose() * (resists ? 1 / values(k) : 1.0);
  }
  compliance_.assign(compliance.data(), compliance.data() + compliance.size());
  lost_.assign(lost.data(), lost.data() + lost.size());
}

DirectionalConstants::Along DirectionalConstants::at(const std::array<double, 3>& direction) const
{
  using Kelvin = Along::Kelvin;
  const int d = dimension_;
  const int n = voigtSize(d);
  const Eigen::Map<const Eigen::MatrixXd> compliance(compliance_.data(), n, n);
  const Eigen::Map<const Eigen::MatrixXd> lost(lost_.data(), n, n);
  Along a;
  a.along = Vector(direction[0], direction[1], d == 3 ? direction[2] : 0).normalized();
  std::array<Vector, 2> frame{ Vector(-a.along(1), a.along(0), 0), Vector::Zero() };
  if (d == 3)
  {
    frame[0] = a.along.unitOrthogonal();
    frame[1] = a.along.cross(frame[0]);
  }
  const std::size_t sides = d == 3 ? 2 : 1;

  const auto stress = dyad<Kelvin>(a.along, a.along, d);
  const Kelvin strain = compliance * stress;
  const double yields = stress.dot(strain);
  a.values.young = stress.dot(lost * stress) < unresisted && yields > 0 ? 1 / yields : 0.0;

  AcrossForm contraction = AcrossForm::Zero();
  AcrossForm slides = AcrossForm::Zero();
  AcrossForm loses = AcrossForm::Zero();
  for (std::size_t i = 0; i < sides; ++i)
    for (std::size_t j = 0; j < sides; ++j)
    {
      const auto r = static_cast<Eigen::Index>(i);
      const auto s = static_cast<Eigen::Index>(j);
      contraction(r, s) = -strain.dot(dyad<Kelvin>(frame[i], frame[j], d)) * a.values.young;
      const auto one = dyad<Kelvin>(a.along, frame[i], d); // of a unit shear half the stress
      const auto other = dyad<Kelvin>(a.along, frame[j], d);
      slides(r, s) = 4 * one.dot(compliance * other);
      loses(r, s) = 2 * one.dot(lost * other);
    }
  const auto vectorOf = [&](const Eigen::Vector2d& v) -> Vector { return v(0) * frame[0] + v(1) * frame[1]; };
  const auto inverse = [](double yield) { return yield > 0 ? 1 / yield : 0.0; };
  if (d == 2)
  {
    a.values.shear.fill(loses(0, 0) < unresisted ? inverse(slides(0, 0)) : 0.0);
    a.values.poisson.fill(resists_ ? contraction(0, 0) : std::numeric_limits<double>::quiet_NaN());
    a.acrossShear.fill(frame[0]);
    a.acrossPoisson.fill(frame[0]);
    return a;
  }
  const Eigen::SelfAdjointEigenSolver<AcrossForm> ratios(contraction);
  for (std::size_t k = 0; k < 2; ++k)
  {
    const auto column = static_cast<Eigen::Index>(k);
    a.values.poisson[k] = resists_ ? ratios.eigenvalues()(column) : std::numeric_limits<double>::quiet_NaN();
    a.acrossPoisson[k] = vectorOf(ratios.eigenvectors().col(column));
  }
  const Eigen::SelfAdjointEigenSolver<AcrossForm> losses(loses);
  const Eigen::SelfAdjointEigenSolver<AcrossForm> yielding(slides);
  const bool all = losses.eigenvalues()(1) < unresisted;
  const auto& way = all ? yielding.eigenvectors() : losses.eigenvectors();
  a.acrossShear = { vectorOf(way.col(1)), vectorOf(way.col(0)) };
  if (all)
    a.values.shear = { inverse(yielding.eigenvalues()(1)), inverse(yielding.eigenvalues()(0)) };
  else // the least is none; the most is that of the one direction that something resists
    a.values.shear = { 0.0, losses.eigenvalues()(0) < unresisted ? inverse(way.col(0).dot(slides * way.col(0))) : 0.0 };
  return a;
}

double DirectionalConstants::young(const std::array<double, 3>& direction) const
{
  return at(direction).values.young;
}

ConstantsAlong DirectionalConstants::operator()(const std::array<double, 3>& direction) const
{
  return at(direction).values;
}

ConstantExtremes DirectionalConstants::extremes() const
{
  const int d = dimension_;
  const auto here = [&](const Vector& v) { return at(arrayOf(v)); };
  std::vector<Along> named;
  for (const Vector& v : namedOf(d))
    named.push_back(here(v));
  std::vector<Along> grid;
  for (const Vector& v : gridOf(d))
    grid.push_back(here(v));

  const auto search = [&](std::size_t most, const auto& valueOf, const auto& acrossOf)
  {
    const auto height = [&](const Along& a) { return (most != 0 ? 1 : -1) * valueOf(a); };
    DirectedValue found;
    if (std::isnan(height(named.front())))
    {
      const double none = std::numeric_limits<double>::quiet_NaN();
      return DirectedValue{ none, { none, none, none }, { none, none, none } };
    }
    std::vector<std::size_t> order(grid.size());
    std::iota(order.begin(), order.end(), std::size_t{ 0 });
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return height(grid[a]) > height(grid[b]); });
    std::vector<Along> best;
    for (const std::size_t i : order)
    {
      const bool near = std::ranges::any_of(
        best, [&](const Along& a) { return std::abs(a.along.dot(grid[i].along)) > std::cos(Search::apart); });
      if (!near)
        best.push_back(grid[i]);
      if (best.size() == Search::starts)
        break;
    }
    double scale = std::abs(height(named.front()));
    for (Along& a : best)
    {
      int moves = 0;
      for (double step = Search::first; step > Search::finest;)
      {
        const Vector one = d == 3 ? a.along.unitOrthogonal() : Vector(-a.along(1), a.along(0), 0);
        const Vector other = d == 3 ? Vector(a.along.cross(one)) : Vector(Vector::Zero());
        const double before = height(a);
        scale = std::max(scale, std::abs(before));
        Along next = a;
        for (int i = -1; i <= 1; ++i)
          for (int j = d == 3 ? -1 : 0; j <= (d == 3 ? 1 : 0); ++j)
            if (i != 0 || j != 0)
              if (Along tried = here((a.along + step * (i * one + j * other)).normalized());
                  height(tried) > height(next))
                next = tried;
        const bool better = height(next) - before > Search::rounding * scale;
        if (better)
          a = next;
        if (better && ++moves < Search::moves)
          continue;
        step /= 2;
        moves = 0;
      }
    }
    const Along* chosen = &named.front();
    for (const std::vector<Along>* const list : { &named, &best })
      for (const Along& a : *list)
        if (height(a) - height(*chosen) > Search::told * scale)
          chosen = &a;
    found.value = valueOf(*chosen);
    found.along = arrayOf(pointing(chosen->along));
    found.across = acrossOf(*chosen);
    return found;
  };

  ConstantExtremes result;
  for (std::size_t most = 0; most < 2; ++most)
  {
    result.young[most] = search(
      most, [](const Along& a) { return a.values.young; }, [](const Along&) { return std::array<double, 3>{}; });
    result.shear[most] = search(
      most, [&](const Along& a) { return a.values.shear[most]; },
      [&](const Along& a) { return arrayOf(pointing(a.acrossShear[most])); });
    result.poisson[most] = search(
      most, [&](const Along& a) { return a.values.poisson[most]; },
      [&](const Along& a) { return arrayOf(pointing(a.acrossPoisson[most])); });
  }
  return result;
}

} // namespace lamella::elasticity
