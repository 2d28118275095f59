#include "elasticity/SurfaceChanges.h"

#include "elasticity/ElasticSystem.h"
#include "elasticity/PairKernels.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace lamella::elasticity
{
namespace
{

template <int D>
using Tensor = Eigen::Matrix<double, voigtSize(D), voigtSize(D)>;
template <int D>
using Direction = Eigen::Matrix<double, D, 1>;

/// Of a normal m: Tᵀ γ is the strain of γ ⊗ m in Voigt's order, T σ the traction on the surface.
template <int D>
Eigen::Matrix<double, D, voigtSize(D)> tractionOf(const Direction<D>& m)
{
  Eigen::Matrix<double, D, voigtSize(D)> t = Eigen::Matrix<double, D, voigtSize(D)>::Zero();
  for (int a = 0; a < D; ++a)
    for (int b = 0; b < D; ++b)
      t(a, voigt(D, a, b)) += m(b);
  return t;
}

/// A strain without its part across the surface, γ ⊗ m with γ = 2 ε m − m (m · ε m).
template <int D>
Tensor<D> alongSurface(const Direction<D>& m, const Eigen::Matrix<double, D, voigtSize(D)>& t)
{
  Eigen::Matrix<double, D, voigtSize(D)> em = t; // ε m
  em.rightCols(voigtSize(D) - D) *= 0.5;         // shears are angles
  const Eigen::Matrix<double, D, voigtSize(D)> gamma = 2 * em - m * (m.transpose() * em);
  return Tensor<D>::Identity() - t.transpose() * gamma;
}

/// What a phase does beside a surface whose strain along it and whose traction are given.
template <int D>
struct Side
{
  Tensor<D> c = Tensor<D>::Zero();
  bool isVoid = true, rigid = false;
  Eigen::Matrix<double, D, D> yield = Eigen::Matrix<double, D, D>::Zero(); ///< γ of a traction
  Eigen::Matrix<double, D, voigtSize(D)> pull =
    Eigen::Matrix<double, D, voigtSize(D)>::Zero(); ///< −γ of a strain along
  Tensor<D> along = Tensor<D>::Zero();              ///< stiffness along the surface, without traction

  void meet(const Eigen::Matrix<double, D, voigtSize(D)>& t)
  {
    if (isVoid || rigid)
      return;
    yield = (t * c * t.transpose()).inverse();
    pull = yield * t * c;
    along = c - c * t.transpose() * pull;
  }
};

/// The form Q of ε_i : Q : ε_j, of the strains beside the surface in `own`, that one side of a surface has in what is
/// gained where `own` grows into `other`. @param first  of two that are as stiff, the one that tells of the strain
/// along it
template <int D>
Tensor<D> gainOf(Side<D> own, Side<D> other, const Direction<D>& m, bool first)
{
  Tensor<D> gain = Tensor<D>::Zero();
  if (own.isVoid || own.rigid)
    return gain;
  const auto t = tractionOf<D>(m);
  own.meet(t);
  other.meet(t);
  const bool stiffer = !other.rigid && (own.c.trace() > other.c.trace() || (own.c.trace() == other.c.trace() && first));
  if (stiffer)
    gain = own.along - other.along;
  if (other.isVoid)
    return gain; // no traction
  const Eigen::Matrix<double, D, voigtSize(D)> traction = t * own.c;
  if (!stiffer)
    gain = traction.transpose() * (other.yield - own.yield) * traction;
  if (other.rigid)
    return gain; // no strain along it
  const Tensor<D> across =
    0.5 * traction.transpose() * (own.pull - other.pull) * alongSurface<D>(m, t); // the other side has the other half
  return gain + across + across.transpose();
}

/// Phases around voxels, with what sides do.
template <int D>
class Surroundings
{
public:
  explicit Surroundings(const ElasticProblem<D>& problem)
    : problem_(problem)
  {
    for (std::size_t a = 0; a < D; ++a)
      edge_[a] = problem.aspect[a] == 0 ? 1.0 : problem.aspect[a];
  }

  using Place = std::array<std::int64_t, D>;
  [[nodiscard]] std::size_t at(const Place& p) const
  {
    std::size_t index = 0;
    for (int a = D - 1; a >= 0; --a)
      index = index * static_cast<std::size_t>(problem_.elements[static_cast<std::size_t>(a)]) +
        static_cast<std::size_t>(p[static_cast<std::size_t>(a)]);
    return index;
  }
  /// Whether there is a voxel beside another one; then `p` is that.
  bool step(Place& p, std::size_t axis, std::int64_t by) const
  {
    const std::int64_t count = problem_.elements[axis];
    const std::int64_t to = p[axis] + by;
    if (to >= 0 && to < count)
      p[axis] = to;
    else if (problem_.periodic[axis])
      p[axis] = (to + count) % count;
    else
      return false;
    return true;
  }
  /// Of the normal out of a voxel's phase, by 3 × 3 (× 3) voxels; beyond a side its mirror image. Zeros: on both sides
  /// alike.
  [[nodiscard]] std::array<int, D> slope(const Place& p) const
  {
    const std::uint8_t own = problem_.phase[at(p)];
    std::array<int, D> slope{};
    constexpr int all = D == 3 ? 27 : 9;
    for (int which = 0; which < all; ++which)
    {
      const std::array<int, 3> by{ which % 3 - 1, which / 3 % 3 - 1, which / 9 - 1 };
      Place other = p;
      int weight = 1;
      for (std::size_t a = 0; a < D; ++a)
      {
        step(other, a, by[a]);
        weight *= 2 - std::abs(by[a]);
      }
      if (problem_.phase[at(other)] == own)
        for (std::size_t a = 0; a < D; ++a)
          slope[a] -= weight * by[a];
    }
    return slope;
  }
  [[nodiscard]] const std::array<double, D>& edge() const noexcept { return edge_; }

private:
  const ElasticProblem<D>& problem_;
  std::array<double, D> edge_{};
};

/// Mean strain of an element of a row.
template <int D, class Real>
Eigen::Matrix<double, voigtSize(D), 1> strainOf(const ElasticRow<D, Real>& row, std::int64_t i)
{
  constexpr int around = 1 << (D - 1);
  const auto of = [&](int c, int r, int right) { return static_cast<double>(row.u[c][r][i + right]); };
  Eigen::Matrix<double, voigtSize(D), 1> e;
  for (int k = 0; k < voigtSize(D); ++k)
    e(k) = row.strain[k];
  for (int c = 0; c < D; ++c)
    for (int a = 0; a < D; ++a)
    {
      double sum = 0;
      for (int r = 0; r < around; ++r)
        for (int right = 0; right < 2; ++right)
        {
          const bool high = a == 0 ? right != 0 : (D == 3 && a == 1 ? r & 1 : D == 3 ? r >> 1 : r) != 0;
          sum += (high ? 1 : -1) * of(c, r, right);
        }
      const double stretch = a == 0 ? static_cast<double>(row.stretchX[i]) : row.stretch[a];
      e(voigt(D, c, a)) += stretch * sum;
    }
  return cornerFactor<D> * e;
}

} // namespace

template <int D>
std::vector<SurfaceChange> ElasticSystem<D>::surfaces(std::span<const Field> fields) const
{
  const ElasticGrid<D>& g = op_->grid();
  const Surroundings<D> around(problem_);
  const std::int64_t nx = problem_.elements[0];
  const auto pairs = static_cast<std::size_t>(pairsOf(static_cast<int>(fields.size())));

  // which phases meet
  std::vector<std::int32_t> slots(256 * 256, -1);
  std::vector<SurfaceChange> found;
  std::int64_t stride = 1;
  for (std::size_t a = 0; a < D; ++a)
  {
    const std::int64_t count = problem_.elements[a];
    for (std::int64_t i = 0; i < static_cast<std::int64_t>(problem_.phase.size()); ++i)
    {
      const std::int64_t p = i / stride % count;
      if (p + 1 == count && !problem_.periodic[a])
        continue;
      const std::uint8_t own = problem_.phase[static_cast<std::size_t>(i)];
      const std::uint8_t other =
        problem_.phase[static_cast<std::size_t>(i + (p + 1 == count ? 1 - count : 1) * stride)];
      if (own == other)
        continue;
      const std::size_t pair = std::size_t{ 256 } * std::min(own, other) + std::max(own, other);
      if (slots[pair] < 0)
      {
        slots[pair] = static_cast<std::int32_t>(found.size());
        found.push_back({ std::min(own, other), std::max(own, other), 0, {} });
      }
    }
    stride *= count;
  }
  if (found.empty())
    return found;

  std::vector<Side<D>> sides(256);
  for (std::size_t id = 0; id < problem_.laws.size(); ++id)
  {
    const ElasticLaw<D>& law = problem_.laws[id];
    sides[id].rigid = rigid_[id];
    sides[id].isVoid = law.isVoid() && !law.turns();
    for (int i = 0; i < voigtSize(D); ++i)
      for (int j = 0; j < voigtSize(D); ++j)
        sides[id].c(i, j) = law.stiffness[static_cast<std::size_t>(triangle(voigtSize(D), i, j))];
  }
  const auto turns = [&](std::uint8_t id) { return id < problem_.laws.size() && problem_.laws[id].turns(); };
  const auto sideOf = [&](std::size_t voxel)
  {
    const std::uint8_t id = problem_.phase[voxel];
    Side<D> side = sides[id];
    if (turns(id))
    {
      const auto c = problem_.laws[id].turnedTo(problem_.axis[voxel]);
      for (int i = 0; i < voigtSize(D); ++i)
        for (int j = 0; j < voigtSize(D); ++j)
          side.c(i, j) = c[static_cast<std::size_t>(triangle(voigtSize(D), i, j))];
    }
    return side;
  };

  const std::size_t each = pairs + 1; // the last: area
  const std::size_t count = each * found.size();
  std::vector<double> byPlane(count * static_cast<std::size_t>(g.elementPlanes()), 0.0);
  std::vector<std::unordered_map<std::uint64_t, Tensor<D>>> known(static_cast<std::size_t>(op_->threads()));
  const auto run = [&]<class Real>(std::vector<Real> Field::*values)
  {
    std::vector<StrainField<Real>> all;
    for (const Field& field : fields)
      all.push_back({ (field.*values).data(), field.strain });
    op_->template forRows<Real>(all,
      [&](int thread, std::int64_t row, std::int64_t plane, std::span<const ElasticRow<D, Real>> rows)
      {
        typename Surroundings<D>::Place p{};
        p[D - 1] = plane;
        if constexpr (D == 3)
          p[1] = row;
        double* const sums = byPlane.data() + count * static_cast<std::size_t>(plane);
        for (std::int64_t i = 0; i < nx; ++i)
        {
          p[0] = i;
          const std::size_t voxel = around.at(p);
          const std::uint8_t own = problem_.phase[voxel];
          std::array<std::size_t, 2 * D> others{};
          std::array<std::size_t, 2 * D> axes{};
          std::size_t faces = 0;
          for (std::size_t a = 0; a < D; ++a)
            for (const int by : { -1, 1 })
            {
              auto q = p;
              if (around.step(q, a, by) && problem_.phase[around.at(q)] != own)
              {
                others[faces] = around.at(q);
                axes[faces++] = a;
              }
            }
          if (faces == 0)
            continue;
          const std::array<int, D> slope = around.slope(p);
          Direction<D> normal;
          for (std::size_t a = 0; a < D; ++a)
            normal(static_cast<Eigen::Index>(a)) = slope[a] / around.edge()[a];
          const bool flat = normal.squaredNorm() > 0;
          if (flat)
            normal.normalize();
          Eigen::Matrix<double, voigtSize(D), Eigen::Dynamic, 0, voigtSize(D), voigtSize(D)> strain(
            voigtSize(D), static_cast<Eigen::Index>(fields.size()));
          for (std::size_t f = 0; f < fields.size(); ++f)
            strain.col(static_cast<Eigen::Index>(f)) = strainOf<D, Real>(rows[f], i);
          for (std::size_t f = 0; f < faces; ++f)
          {
            const std::uint8_t other = problem_.phase[others[f]];
            const std::size_t pair = std::size_t{ 256 } * std::min(own, other) + std::max(own, other);
            double* const out = sums + each * static_cast<std::size_t>(slots[pair]);
            const Direction<D> m = flat ? normal : Direction<D>(Direction<D>::Unit(static_cast<Eigen::Index>(axes[f])));
            const double part = std::abs(m(static_cast<Eigen::Index>(axes[f]))) / around.edge()[axes[f]];
            out[pairs] += part / 2; // both sides count
            Tensor<D> made;
            const Tensor<D>* gain = &made;
            if (turns(own) || turns(other))
              made = gainOf<D>(sideOf(voxel), sideOf(others[f]), m, own < other);
            else
            {
              std::uint64_t key = own | std::uint64_t{ other } << 8 | std::uint64_t{ flat ? 0 : axes[f] + 1 } << 16;
              for (std::size_t a = 0; a < D; ++a)
                key |= static_cast<std::uint64_t>(slope[a] + 64) << (24 + 8 * a);
              const auto [at, isNew] = known[static_cast<std::size_t>(thread)].try_emplace(key);
              if (isNew)
                at->second = gainOf<D>(sides[own], sides[other], m, own < other);
              gain = &at->second;
            }
            const double weight = own < other ? part : -part; // by the lower id's growth
            const auto product = (strain.transpose() * *gain * strain).eval();
            for (int l = 0; l < static_cast<int>(fields.size()); ++l)
              for (int k = l; k < static_cast<int>(fields.size()); ++k)
                out[triangle(static_cast<int>(fields.size()), l, k)] += weight * product(l, k);
          }
        }
      });
  };
  if (options_.fields)
    run(&Field::exact);
  else
    run(&Field::single);
  const std::vector<double> sums = totals(byPlane, count);
  const auto voxels = static_cast<double>(problem_.phase.size());
  for (std::size_t s = 0; s < found.size(); ++s)
  {
    const auto at = sums.begin() + static_cast<std::ptrdiff_t>(each * s);
    found[s].area = *(at + static_cast<std::ptrdiff_t>(pairs)) / voxels;
    found[s].shift.assign(at, at + static_cast<std::ptrdiff_t>(pairs));
    for (double& shift : found[s].shift)
      shift /= voxels;
  }
  std::ranges::sort(found, {}, [](const SurfaceChange& s) { return 256 * s.first + s.second; });
  return found;
}

template std::vector<SurfaceChange> ElasticSystem<2>::surfaces(std::span<const Field>) const;
template std::vector<SurfaceChange> ElasticSystem<3>::surfaces(std::span<const Field>) const;

} // namespace lamella::elasticity
