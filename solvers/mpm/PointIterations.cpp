#include "mpm/PointIterations.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace lamella::mpm
{
namespace
{

// What hangs together by a point or two moves at next to no energy, in ways that no rigid bodies of multigrid resemble:
// its forces stay long after the energy, which is the stiffness, has stopped to change. A body with thin walls takes
// 10 to 150 iterations to 1e-6.
constexpr std::int64_t patience = 300; // iterations before that is asked
constexpr std::int64_t window = 100;   // the last ones, whose energies are looked at
constexpr double still = 1e-5;         // of what the box has left
constexpr double leastLeft = 1e-9;     // over the energy of even strain: less is nothing

/// Products of the vectors of two fields, one by one; the same for any number of threads.
template <int Many>
std::array<double, Many> products(const std::vector<double>& a, const std::vector<double>& b)
{
  constexpr std::int64_t part = 4096;
  const auto count = static_cast<std::int64_t>(a.size()) / Many;
  const std::int64_t parts = (count + part - 1) / part;
  std::vector<std::array<double, Many>> sums(static_cast<std::size_t>(parts));
#pragma omp parallel for schedule(static)
  for (std::int64_t p = 0; p < parts; ++p)
  {
    std::array<double, Many> sum{};
    for (std::int64_t i = p * part; i < std::min(count, (p + 1) * part); ++i)
      for (std::size_t k = 0; k < Many; ++k)
      {
        const std::size_t at = static_cast<std::size_t>(i) * Many + k;
        sum[k] += a[at] * b[at];
      }
    sums[static_cast<std::size_t>(p)] = sum;
  }
  std::array<double, Many> all{};
  for (const auto& sum : sums)
    for (std::size_t k = 0; k < Many; ++k)
      all[k] += sum[k];
  return all;
}

/// y = a x + b y, vector by vector.
template <int Many>
void combine(const std::array<double, Many>& a, const std::vector<double>& x, const std::array<double, Many>& b,
  std::vector<double>& y)
{
  const auto count = static_cast<std::int64_t>(x.size()) / Many;
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < Many; ++k)
    {
      const std::size_t at = static_cast<std::size_t>(i) * Many + k;
      y[at] = a[k] * x[at] + b[k] * y[at];
    }
}

} // namespace

template <int Dim>
PointIterations<Dim>::PointIterations(const PointSystem<Dim>& system, const std::function<void()>& told)
  : system_(system)
  , matrix_(system.rows(told))
{
  const std::size_t n = system.nodes().size();
  scale_.assign(n * Dim, 0.0);
  for (std::size_t i = 0; i < n; ++i)
    for (auto e = static_cast<std::size_t>(matrix_.begin[i]); e < static_cast<std::size_t>(matrix_.begin[i + 1]); ++e)
      if (static_cast<std::size_t>(matrix_.column[e]) == i)
        for (std::size_t c = 0; c < Dim; ++c)
        {
          const double v = matrix_.value[e](static_cast<Eigen::Index>(c), static_cast<Eigen::Index>(c));
          scale_[i * Dim + c] = v > 0 ? 1 / std::sqrt(v) : 0;
        }
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < n; ++i)
    for (auto e = static_cast<std::size_t>(matrix_.begin[i]); e < static_cast<std::size_t>(matrix_.begin[i + 1]); ++e)
      for (std::size_t c = 0; c < Dim; ++c)
        for (std::size_t d = 0; d < Dim; ++d)
          matrix_.value[e](static_cast<Eigen::Index>(c), static_cast<Eigen::Index>(d)) *=
            scale_[i * Dim + c] * scale_[static_cast<std::size_t>(matrix_.column[e]) * Dim + d];
  told();
  NodePlaces<Dim> places;
  for (const std::int32_t node : system.nodes())
  {
    const auto at = system.coordinates(node);
    std::array<double, Dim> place;
    std::copy(at.begin(), at.end(), place.begin());
    places.at.push_back(place);
  }
  for (std::size_t a = 0; a < Dim; ++a)
    places.period[a] = system.periods()[a];
  multigrid_.emplace(matrix_, scale_, std::move(places), told);
}

template <int Dim>
auto PointIterations<Dim>::solve(const std::vector<Field>& f, std::vector<Field>& w,
  const std::vector<double>& energies, double tolerance, std::int64_t most,
  const std::function<void(double)>& progress) const -> Outcome
{
  switch (f.size())
  {
    case 1:
      return solveTogether<1>(f, w, energies, tolerance, most, progress);
    case 2:
      return solveTogether<2>(f, w, energies, tolerance, most, progress);
    case 3:
      return solveTogether<3>(f, w, energies, tolerance, most, progress);
    default:
      return solveTogether<6>(f, w, energies, tolerance, most, progress);
  }
}

template <int Dim>
template <int Many>
auto PointIterations<Dim>::solveTogether(const std::vector<Field>& f, std::vector<Field>& w,
  const std::vector<double>& energies, double tolerance, std::int64_t most,
  const std::function<void(double)>& progress) const -> Outcome
{
  using Numbers = std::array<double, Many>;
  const std::size_t n = system_.nodes().size();
  std::vector<double> r(n * Dim * Many, 0.0);
  const auto each = [&](const auto& visit)
  {
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t c = 0; c < Dim; ++c)
        for (std::size_t k = 0; k < f.size(); ++k)
          visit(
            static_cast<std::size_t>(system_.nodes()[i]) * Dim + c, k, (i * Dim + c) * Many + k, scale_[i * Dim + c]);
  };
  each([&](std::size_t from, std::size_t k, std::size_t to, double scale) { r[to] = scale * f[k][from]; });
  std::vector<double> x(r.size(), 0.0);
  std::vector<double> p(r.size(), 0.0);
  std::vector<double> q(r.size());
  std::vector<double> z(r.size());
  Outcome outcome;
  outcome.iterations.assign(f.size(), 0);
  Numbers before{};
  Numbers left{}; // energy of the box, over that of even strain
  left.fill(1);
  std::vector<Numbers> lefts; // after every iteration
  Numbers one;
  one.fill(1);
  for (std::int64_t i = 0;; ++i)
  {
    const Numbers squares = products<Many>(r, r);
    std::array<bool, Many> done;
    done.fill(true);
    outcome.residual = 0;
    for (std::size_t k = 0; k < f.size(); ++k)
    {
      const double residual = std::sqrt(squares[k] / energies[k]); // of a body that strains evenly it is round-off
      done[k] = residual <= tolerance;
      outcome.iterations[k] += done[k] ? 0 : 1;
      outcome.residual = std::max(outcome.residual, residual);
    }
    if (std::all_of(done.begin(), done.end(), [](bool d) { return d; }))
      break;
    if (i >= patience)
    {
      double lost = 0;
      for (std::size_t k = 0; k < f.size(); ++k)
        lost =
          std::max(lost, done[k] ? 0 : (lefts[lefts.size() - 1 - window][k] - left[k]) / std::max(left[k], leastLeft));
      if (lost < still)
      {
        outcome.lost = lost;
        break;
      }
    }
    if (i > 0)
      progress(std::log(outcome.residual) / std::log(tolerance));
    multigrid_->template apply<Many>(r.data(), z.data());
    const Numbers rz = products<Many>(r, z);
    Numbers beta{};
    for (std::size_t k = 0; k < Many; ++k)
      beta[k] = before[k] > 0 && !done[k] ? rz[k] / before[k] : 0;
    before = rz;
    combine<Many>(one, z, beta, p);
    matrix_.template multiply<Many>(p.data(), q.data());
    const Numbers pq = products<Many>(p, q);
    Numbers alpha{};
    bool stuck = i == most;
    for (std::size_t k = 0; k < Many; ++k)
    {
      stuck = stuck || (!done[k] && !(pq[k] > 0));
      alpha[k] = done[k] ? 0 : rz[k] / pq[k];
    }
    if (stuck)
      throw DivergenceError(
        fmt::format("conjugate gradients stopped at a residual of {:.3g}, above {:.3g}", outcome.residual, tolerance),
        "more iterations, or a larger tolerance");
    for (std::size_t k = 0; k < f.size(); ++k)
      left[k] -= alpha[k] * rz[k] / energies[k];
    lefts.push_back(left);
    combine<Many>(alpha, p, one, x);
    for (double& a : alpha)
      a = -a;
    combine<Many>(alpha, q, one, r);
  }
  each([&](std::size_t to, std::size_t k, std::size_t from, double scale) { w[k][to] = scale * x[from]; });
  return outcome;
}

template class PointIterations<2>;
template class PointIterations<3>;

} // namespace lamella::mpm
