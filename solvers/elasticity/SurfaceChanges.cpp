#include "elasticity/SurfaceChanges.h"

#include "elasticity/ElasticSystem.h"
#include "elasticity/PairKernels.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace lamella::elasticity
{
namespace
{

// Normals at nodes: along an axis differences, across it means, of four voxels each.
constexpr std::array<int, 4> differences{ -1, -1, 1, 1 };
constexpr std::array<int, 4> means{ 1, 3, 3, 1 };

/// Phases around the nodes of a box.
template <int D>
class NodePhases
{
public:
  static constexpr int corners = 1 << D;
  using Place = std::array<std::int64_t, D>;
  using Normal = Eigen::Matrix<double, D, 1>;
  /// How the nodes of an element move where a phase grows into another.
  struct Motion
  {
    std::uint8_t first = 0, second = 0;
    Eigen::Matrix<double, D, D> gradient = Eigen::Matrix<double, D, D>::Zero(); ///< ∂_a V_b at [b][a]
  };

  explicit NodePhases(const ElasticProblem<D>& problem)
    : phase_(problem.phase)
  {
    std::int64_t stride = 1;
    for (std::size_t a = 0; a < D; ++a)
    {
      edge_[a] = problem.aspect[a] == 0 ? 1.0 : problem.aspect[a];
      const std::int64_t count = problem.elements[a];
      const auto voxel = [&](std::int64_t i)
      {
        if (problem.periodic[a])
          return ((i % count) + count) % count;
        return std::clamp<std::int64_t>(i < 0 ? -1 - i : i >= count ? 2 * count - 1 - i : i, 0, count - 1); // mirrored
      };
      for (std::int64_t node = 0; node <= count; ++node)
        for (std::int64_t by = -2; by < 2; ++by)
          around_[a].push_back(stride * voxel(node + by));
      stride *= count;
    }
  }

  /// Whether all voxels that share a node with one are of its phase.
  [[nodiscard]] bool alone(const Place& p) const
  {
    const std::uint8_t own = phaseOf(p);
    for (int corner = 0; corner < corners; ++corner)
      for (int which = 0; which < corners; ++which)
      {
        std::int64_t index = 0;
        for (std::size_t a = 0; a < D; ++a)
          index += around_[a][static_cast<std::size_t>(4 * (p[a] + (corner >> a & 1)) + 1 + (which >> a & 1))];
        if (phase_[static_cast<std::size_t>(index)] != own)
          return false;
      }
    return true;
  }

  /// How the element of a voxel moves, by the pairs of phases that meet at its nodes.
  void motions(const Place& p, std::vector<Motion>& found) const
  {
    found.clear();
    for (int corner = 0; corner < corners; ++corner)
    {
      Place node = p;
      for (std::size_t a = 0; a < D; ++a)
        node[a] += corner >> a & 1;
      std::array<std::uint8_t, corners> beside{};
      std::size_t phases = 0;
      for (int which = 0; which < corners; ++which)
      {
        std::int64_t index = 0;
        for (std::size_t a = 0; a < D; ++a)
          index += around_[a][static_cast<std::size_t>(4 * node[a] + 1 + (which >> a & 1))];
        const std::uint8_t id = phase_[static_cast<std::size_t>(index)];
        std::size_t place = 0; // ids in order, each once
        while (place < phases && beside[place] < id)
          ++place;
        if (place < phases && beside[place] == id)
          continue;
        for (std::size_t k = phases++; k > place; --k)
          beside[k] = beside[k - 1];
        beside[place] = id;
      }
      if (phases < 2)
        continue;
      for (std::size_t i = 0; i < phases; ++i)
        for (std::size_t j = i + 1; j < phases; ++j)
        {
          const Normal v = normal(node, beside[i], beside[j]);
          auto to =
            std::ranges::find_if(found, [&](const Motion& m) { return m.first == beside[i] && m.second == beside[j]; });
          if (to == found.end())
            to = found.insert(found.end(), { beside[i], beside[j] });
          for (int a = 0; a < D; ++a)
            to->gradient.col(a) +=
              ((corner >> a & 1) != 0 ? 1 : -1) * cornerFactor<D> / edge_[static_cast<std::size_t>(a)] * v;
        }
    }
  }

private:
  [[nodiscard]] std::uint8_t phaseOf(const Place& p) const
  {
    std::int64_t index = 0;
    for (std::size_t a = 0; a < D; ++a)
      index += around_[a][static_cast<std::size_t>(4 * p[a] + 2)];
    return phase_[static_cast<std::size_t>(index)];
  }
  /// Of a node, from one phase to another; zeros where they lie on both sides alike.
  [[nodiscard]] Normal normal(const Place& node, std::uint8_t from, std::uint8_t to) const
  {
    constexpr int all = D == 3 ? 64 : 16;
    std::array<int, D> slope{};
    for (int which = 0; which < all; ++which)
    {
      const std::array<std::size_t, 3> by{ static_cast<std::size_t>(which & 3),
        static_cast<std::size_t>(which >> 2 & 3), static_cast<std::size_t>(which >> 4) };
      std::int64_t index = 0;
      for (std::size_t a = 0; a < D; ++a)
        index += around_[a][static_cast<std::size_t>(4 * node[a]) + by[a]];
      const std::uint8_t id = phase_[static_cast<std::size_t>(index)];
      if (id != from && id != to)
        continue;
      for (std::size_t a = 0; a < D; ++a)
      {
        int weight = differences[by[a]];
        for (std::size_t b = 0; b < D; ++b)
          weight *= b == a ? 1 : means[by[b]];
        slope[a] += id == to ? weight : -weight;
      }
    }
    Normal m;
    for (std::size_t a = 0; a < D; ++a)
      m(static_cast<Eigen::Index>(a)) = slope[a] / edge_[a];
    const double length = m.norm();
    return length > 0 ? Normal(m / length) : Normal(Normal::Zero());
  }

  std::span<const std::uint8_t> phase_;
  std::array<double, D> edge_{};
  std::array<std::vector<std::int64_t>, D> around_; ///< by axis and node, the four voxels along it, times their stride
};

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
  using Nodes = NodePhases<D>;
  const ElasticGrid<D>& g = op_->grid();
  const Nodes nodes(problem_);
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
