#include "elasticity/SurfaceChanges.h"

#include "elasticity/ElasticSystem.h"
#include "elasticity/PairKernels.h"
#include "lattice/SurfaceMotions.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace lamella::elasticity
{
namespace
{

/// Mean gradient of the displacements of an element of a row, ∂_a u_c at [c][a], the mean strain's included.
template <int D, class Real>
Eigen::Matrix<double, D, D> gradientOf(const ElasticRow<D, Real>& row, std::int64_t i)
{
  constexpr int around = 1 << (D - 1);
  Eigen::Matrix<double, D, D> gradient;
  for (int c = 0; c < D; ++c)
    for (int a = 0; a < D; ++a)
    {
      double sum = 0;
      for (int r = 0; r < around; ++r)
        for (int right = 0; right < 2; ++right)
        {
          const bool high = a == 0 ? right != 0 : (D == 3 && a == 1 ? r & 1 : D == 3 ? r >> 1 : r) != 0;
          sum += (high ? 1 : -1) * static_cast<double>(row.u[c][r][i + right]);
        }
      const double stretch = a == 0 ? static_cast<double>(row.stretchX[i]) : row.stretch[a];
      gradient(c, a) = cornerFactor<D> * (stretch * sum + (a == c ? 1 : 0.5) * row.strain[voigt(D, a, c)]);
    }
  return gradient;
}

template <int D>
Eigen::Matrix<double, voigtSize(D), 1> strainOf(const Eigen::Matrix<double, D, D>& gradient)
{
  Eigen::Matrix<double, voigtSize(D), 1> strain;
  for (int a = 0; a < D; ++a)
    for (int b = a; b < D; ++b)
      strain(voigt(D, a, b)) = a == b ? gradient(a, a) : gradient(a, b) + gradient(b, a);
  return strain;
}

} // namespace

template <int D>
std::vector<SurfaceChange> ElasticSystem<D>::surfaces(std::span<const Field> fields) const
{
  constexpr int n = voigtSize(D);
  using Matrix = Eigen::Matrix<double, n, n>;
  using Strains = Eigen::Matrix<double, n, Eigen::Dynamic, 0, n, n>;
  using Nodes = SurfaceMotions<D>;
  const ElasticGrid<D>& g = op_->grid();
  const Nodes nodes(problem_.phase, problem_.elements, problem_.aspect, problem_.periodic);
  const std::int64_t nx = problem_.elements[0];
  const int count = static_cast<int>(fields.size());
  const auto pairs = static_cast<std::size_t>(pairsOf(count));

  std::vector<Matrix> stiffness(256, Matrix::Zero());
  const auto filled = [](const std::array<double, stiffnessSize(D)>& values)
  {
    Matrix c;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        c(i, j) = values[static_cast<std::size_t>(triangle(n, i, j))];
    return c;
  };
  std::array<bool, 256> turns{};
  std::array<bool, 256> bears{};
  for (std::size_t id = 0; id < problem_.laws.size(); ++id)
  {
    turns[id] = problem_.laws[id].turns();
    stiffness[id] = filled(problem_.laws[id].stiffness);
    bears[id] = turns[id] || !(stiffness[id].array() == 0).all();
  }

  struct Sums
  {
    std::uint8_t first = 0, second = 0;
    std::vector<double> values; ///< the last: area
  };
  std::vector<std::vector<Sums>> byPlane(static_cast<std::size_t>(g.elementPlanes()));
  std::vector<std::vector<typename Nodes::Motion>> motions(static_cast<std::size_t>(op_->threads()));
  const auto run = [&]<class Real>(std::vector<Real> Field::*values)
  {
    std::vector<StrainField<Real>> all;
    for (const Field& field : fields)
      all.push_back({ (field.*values).data(), field.strain });
    op_->template forRows<Real>(all,
      [&](int thread, std::int64_t row, std::int64_t plane, std::span<const ElasticRow<D, Real>> rows)
      {
        typename Nodes::Place p{};
        p[D - 1] = plane;
        if constexpr (D == 3)
          p[1] = row;
        const std::int64_t first = nx * (row + g.elementRows() * plane);
        std::vector<Sums>& sums = byPlane[static_cast<std::size_t>(plane)];
        std::vector<typename Nodes::Motion>& own = motions[static_cast<std::size_t>(thread)];
        for (std::int64_t i = 0; i < nx; ++i)
        {
          p[0] = i;
          if (nodes.alone(p))
            continue;
          nodes.motions(p, own);
          const auto voxel = static_cast<std::size_t>(first + i);
          const std::uint8_t id = problem_.phase[voxel];
          std::array<Eigen::Matrix<double, D, D>, n> gradients;
          Strains strain(n, count);
          Strains stress(n, count);
          if (bears[id])
          {
            for (int f = 0; f < count; ++f)
            {
              gradients[static_cast<std::size_t>(f)] = gradientOf<D, Real>(rows[static_cast<std::size_t>(f)], i);
              strain.col(f) = strainOf<D>(gradients[static_cast<std::size_t>(f)]);
            }
            if (turns[id])
              stress = filled(problem_.laws[id].turnedTo(problem_.axis[voxel])) * strain;
            else
              stress = stiffness[id] * strain;
          }
          for (const typename Nodes::Motion& motion : own)
          {
            auto to = std::ranges::find_if(
              sums, [&](const Sums& s) { return s.first == motion.first && s.second == motion.second; });
            if (to == sums.end())
              to = sums.insert(sums.end(), { motion.first, motion.second, std::vector<double>(pairs + 1, 0.0) });
            const double swells = motion.gradient.trace();
            if (id == motion.first)
              to->values[pairs] += swells;
            if (!bears[id])
              continue;
            Strains moved(n, count);
            for (int f = 0; f < count; ++f)
              moved.col(f) = strainOf<D>(gradients[static_cast<std::size_t>(f)] * motion.gradient);
            const Strains half = 0.5 * swells * strain - moved;
            for (int l = 0; l < count; ++l)
              for (int k = l; k < count; ++k)
                to->values[static_cast<std::size_t>(triangle(count, l, k))] +=
                  stress.col(l).dot(half.col(k)) + stress.col(k).dot(half.col(l));
          }
        }
      });
  };
  if (options_.fields)
    run(&Field::exact);
  else
    run(&Field::single);

  // every rank's pairs, then their sums by plane
  std::vector<double> met(256 * 256, 0.0);
  for (const auto& plane : byPlane)
    for (const Sums& s : plane)
      met[256 * std::size_t{ s.first } + s.second] = 1;
  problem_.ranks.sum(met);
  std::vector<SurfaceChange> found;
  for (std::size_t pair = 0; pair < met.size(); ++pair)
    if (met[pair] > 0)
      found.push_back({ static_cast<std::uint8_t>(pair / 256), static_cast<std::uint8_t>(pair % 256), 0, {} });
  for (SurfaceChange& surface : found)
  {
    std::vector<double> all((pairs + 1) * byPlane.size(), 0.0);
    for (std::size_t plane = 0; plane < byPlane.size(); ++plane)
      for (const Sums& s : byPlane[plane])
        if (s.first == surface.first && s.second == surface.second)
          std::ranges::copy(s.values, all.begin() + static_cast<std::ptrdiff_t>((pairs + 1) * plane));
    std::vector<double> sums = totals(all, pairs + 1);
    for (double& sum : sums)
      sum /= static_cast<double>(problem_.phase.size());
    surface.area = sums.back();
    sums.pop_back();
    surface.shift = std::move(sums);
  }
  return found;
}

template std::vector<SurfaceChange> ElasticSystem<2>::surfaces(std::span<const Field>) const;
template std::vector<SurfaceChange> ElasticSystem<3>::surfaces(std::span<const Field>) const;

} // namespace lamella::elasticity
