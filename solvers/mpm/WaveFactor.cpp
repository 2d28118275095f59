#include "mpm/WaveFactor.h"

#include "mpm/ShapeFunctions.h"
#include "mpm/SmallStrain.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>

namespace lamella::mpm
{
namespace
{

/// A number between −1 and 1 that looks like chance, the same for the same node.
double scrambled(std::uint64_t i)
{
  i = (i + 0x9E3779B97F4A7C15ULL) * 0xBF58476D1CE4E5B9ULL;
  i = (i ^ (i >> 27U)) * 0x94D049BB133111EBULL;
  return static_cast<double>(static_cast<std::int64_t>(i)) / 9.3e18;
}

template <int Dim>
struct Reach
{
  static constexpr int splines = Dim == 3 ? 27 : 9;
  std::int64_t first;
  double value[splines];
  double gradient[Dim][splines]; // times the smallest spacing
};

template <int Dim>
Vector<Dim> someAxis()
{
  Vector<Dim> axis{};
  axis[0] = 1;
  return axis;
}

template <int Dim>
constexpr std::array<double, MaterialPoints<Dim>::mostHistory> nothingYet{}; // what a point remembers at the start

/// The eigenvalues of C, of a phase at rest [Pa].
template <int Dim>
auto resistances(const PointLaw<Dim>& law, std::size_t phase)
{
  constexpr int strains = Dim == 3 ? 6 : 3;
  constexpr double small = 1e-6;             // laws have finite third derivatives: exact to a millionth or so
  Eigen::Matrix<double, strains, strains> C; // by orthonormal strains: shear ones times √2
  for (int v = 0; v < strains; ++v)
  {
    const auto [i, j] = voigt<Dim>[static_cast<std::size_t>(v)];
    std::array<Matrix<Dim>, 2> tau;
    for (const int side : { 0, 1 })
    {
      Matrix<Dim> F = Matrix<Dim>::identity();
      const double e = (side == 0 ? -small : small) / (i == j ? 1 : std::sqrt(2.0));
      F(i, j) += e;
      if (i != j)
        F(j, i) += e;
      tau[static_cast<std::size_t>(side)] = law.kirchhoff(phase, F, someAxis<Dim>(), nothingYet<Dim>.data());
    }
    for (int w = 0; w < strains; ++w)
    {
      const auto [k, l] = voigt<Dim>[static_cast<std::size_t>(w)];
      C(w, v) = (tau[1](k, l) - tau[0](k, l)) / (2 * small) * (k == l ? 1 : std::sqrt(2.0));
    }
  }
  const Eigen::Matrix<double, strains, strains> symmetric = (C + C.transpose()) / 2;
  using Solver = Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, strains, strains>>;
  return Solver(symmetric, Eigen::EigenvaluesOnly).eigenvalues().eval();
}

/// Points on the nodes of a grid.
template <int Dim>
class Spread
{
public:
  using Points = MaterialPoints<Dim>;
  Spread(const Points& points, const BackgroundGrid<Dim>& grid, const Bodies& bodies)
    : points_(points)
    , grid_(grid)
    , bodies_(bodies)
    , mass_(points.column(Points::masses))
    , h_(grid.smallestSpacing())
  {
    for (int n = 0; n < Reach<Dim>::splines; ++n)
      jump_[static_cast<std::size_t>(n)] =
        n % 3 * grid.stride(0) + n / 3 % 3 * grid.stride(1) + (Dim == 3 ? n / 9 * grid.stride(Dim - 1) : 0);
    sortIntoSlabs();
  }

  /// Σ m N
  void addMass(std::vector<double>& nodes) const
  {
    forEachSlab(
      [&](std::size_t, std::span<const std::uint32_t> points)
      {
        Reach<Dim> r;
        for (const std::uint32_t p : points)
          if (reach(p, r))
            for (int n = 0; n < Reach<Dim>::splines; ++n)
              nodes[static_cast<std::size_t>(r.first + jump_[static_cast<std::size_t>(n)])] += mass_[p] * r.value[n];
      });
  }

  /// K field. @return field · K field of this rank
  double addForces(const std::vector<double>& field, double shear, double lame, std::vector<double>& forces) const
  {
    std::vector<double> energies(slabs_.size());
    forEachSlab([&](std::size_t slab, std::span<const std::uint32_t> points)
      { energies[slab] = addForces(points, field, shear, lame, forces); });
    return std::accumulate(energies.begin(), energies.end(), 0.0);
  }

private:
  static constexpr int layers = 4; // of a slab: of every other one none reaches the next

  /// The same for some of the points.
  double addForces(std::span<const std::uint32_t> points, const std::vector<double>& field, double shear, double lame,
    std::vector<double>& forces) const
  {
    Reach<Dim> r;
    double energy = 0;
    for (const std::uint32_t p : points)
    {
      if (!reach(p, r))
        continue;
      Matrix<Dim> slope{};
      for (int n = 0; n < Reach<Dim>::splines; ++n)
      {
        const double* u = field.data() + (r.first + jump_[static_cast<std::size_t>(n)]) * Dim;
        for (int a = 0; a < Dim; ++a)
          for (int b = 0; b < Dim; ++b)
            slope(a, b) += u[a] * r.gradient[b][n];
      }
      double dilation = 0;
      for (int a = 0; a < Dim; ++a)
        dilation += slope(a, a);
      Matrix<Dim> stress;
      for (int a = 0; a < Dim; ++a)
        for (int b = 0; b < Dim; ++b)
        {
          stress(a, b) = mass_[p] * (shear * (slope(a, b) + slope(b, a)) + (a == b ? lame * dilation : 0));
          energy += stress(a, b) * slope(a, b);
        }
      for (int n = 0; n < Reach<Dim>::splines; ++n)
      {
        double* f = forces.data() + (r.first + jump_[static_cast<std::size_t>(n)]) * Dim;
        for (int a = 0; a < Dim; ++a)
          for (int b = 0; b < Dim; ++b)
            f[a] += stress(a, b) * r.gradient[b][n];
      }
    }
    return energy;
  }

  /// Points by layers of cells along the last axis, in the order that they are in.
  void sortIntoSlabs()
  {
    const GridAxis& g = grid_.axis(Dim - 1);
    const auto slabs = static_cast<std::size_t>(g.cells / layers + 1);
    const auto x = points_.column(Dim - 1);
    std::vector<std::uint32_t> slabOf(points_.count());
#pragma omp parallel for schedule(static) if (slabOf.size() > 2000)
    for (std::size_t p = 0; p < slabOf.size(); ++p)
    {
      const double base = std::floor(g.coordinate(x[p]) - 0.5) + 1; // of those outside the nearest: nothing is done
      slabOf[p] = static_cast<std::uint32_t>(base > 0 ? std::min(base, static_cast<double>(g.cells)) : 0) / layers;
    }
    slabs_.assign(slabs + 1, 0);
    for (const std::uint32_t slab : slabOf)
      ++slabs_[slab + 1U];
    std::partial_sum(slabs_.begin(), slabs_.end(), slabs_.begin());
    order_.resize(slabOf.size());
    std::vector<std::size_t> next = slabs_;
    for (std::size_t p = 0; p < slabOf.size(); ++p)
      order_[next[slabOf[p]]++] = static_cast<std::uint32_t>(p);
  }

  /// f(number, its points) of every slab, no two side by side at a time.
  template <class F>
  void forEachSlab(F&& f) const
  {
    const std::size_t count = slabs_.size() - 1;
    for (std::size_t colour = 0; colour < 2; ++colour)
#pragma omp parallel for schedule(dynamic, 1) if (order_.size() > 2000)
      for (std::size_t s = colour; s < count; s += 2)
        f(s, std::span(order_).subspan(slabs_[s], slabs_[s + 1] - slabs_[s]));
  }

  /// What a point reaches; false where it lies outside the grid.
  bool reach(std::size_t p, Reach<Dim>& r) const
  {
    std::array<AxisShape<3>, Dim> s;
    r.first = static_cast<std::int64_t>(bodies_.of(points_.phase()[p])) * grid_.count();
    for (int a = 0; a < Dim; ++a)
    {
      const auto i = static_cast<std::size_t>(a);
      s[i] = QuadraticSpline::at(grid_.axis(a).coordinate(points_.column(a)[p]), 0);
      if (s[i].base < -1 || s[i].base > grid_.axis(a).cells - 1)
        return false;
      r.first += (s[i].base + 1) * grid_.stride(a);
    }
    for (int n = 0; n < Reach<Dim>::splines; ++n)
    {
      const int k[3] = { n % 3, n / 3 % 3, n / 9 };
      r.value[n] = 1;
      for (int a = 0; a < Dim; ++a)
        r.value[n] *= s[static_cast<std::size_t>(a)].value[k[a]];
      for (int a = 0; a < Dim; ++a)
      {
        double g = h_ / grid_.axis(a).spacing;
        for (int b = 0; b < Dim; ++b)
          g *= a == b ? s[static_cast<std::size_t>(b)].gradient[k[b]] : s[static_cast<std::size_t>(b)].value[k[b]];
        r.gradient[a][n] = g;
      }
    }
    return true;
  }

  const Points& points_;
  const BackgroundGrid<Dim>& grid_;
  const Bodies& bodies_;
  std::span<const double> mass_;
  double h_;
  std::array<std::int64_t, Reach<Dim>::splines> jump_{};
  std::vector<std::size_t> slabs_;   ///< where each begins in order_, and its end
  std::vector<std::uint32_t> order_; ///< points
};

} // namespace

template <int Dim>
double bulkRatio(const PointLaw<Dim>& law)
{
  double ratio = 1;
  for (std::size_t phase = 0; phase < law.phases(); ++phase)
    ratio = std::max(ratio,
      resistances(law, phase).maxCoeff() /
        law.stiffness(phase, Matrix<Dim>::identity(), someAxis<Dim>(), nothingYet<Dim>.data()));
  return std::min(ratio, static_cast<double>(Dim));
}

template <int Dim>
double leastResistance(const PointLaw<Dim>& law, std::size_t phase)
{
  return resistances(law, phase).minCoeff();
}

template <int Dim>
WaveFactor<Dim>::WaveFactor(double bulk)
  : lame_((bulk - 1) / (Dim - 1))
  , shear_((Dim - bulk) / (2 * (Dim - 1)))
{
}

template <int Dim>
std::optional<double> WaveFactor<Dim>::measure(const MaterialPoints<Dim>& points, const BackgroundGrid<Dim>& grid,
  const Bodies& bodies, int passes, const Communicator& comm, const std::function<bool()>& stop)
{
  const auto nodes = static_cast<std::size_t>(bodies.count * grid.count());
  const Spread<Dim> spread(points, grid, bodies);
  std::vector<double> scale(nodes); // 1/√M
  spread.addMass(scale);
  comm.sum(scale);
  for (double& m : scale)
    m = m > 1e-300 ? 1 / std::sqrt(m) : 0;
  std::vector<double> field = field_;
  if (field.size() != nodes * Dim)
  {
    field.resize(nodes * Dim);
    for (std::size_t i = 0; i < field.size(); ++i)
      field[i] = scrambled(i);
  }

  double factor = 0;
  std::vector<double> next(nodes * Dim);
  for (int pass = 0; pass < passes; ++pass)
  {
    if (stop())
      return std::nullopt;
    double norm = 0;
    for (std::size_t i = 0; i < field.size(); ++i)
      norm += scale[i / Dim] > 0 ? field[i] * field[i] : 0;
    if (!(norm > 0))
      break;
    norm = 1 / std::sqrt(norm);
    for (std::size_t i = 0; i < field.size(); ++i)
      field[i] *= norm * scale[i / Dim];
    std::fill(next.begin(), next.end(), 0);
    const double energy = spread.addForces(field, shear_, lame_, next);
    comm.sum(next);
    factor = std::max(factor, comm.sum(energy)); // Rayleigh's quotient
    for (std::size_t i = 0; i < field.size(); ++i)
      field[i] = next[i] * scale[i / Dim];
  }
  field_ = std::move(field);
  return factor;
}

template double bulkRatio(const PointLaw<2>&);
template double bulkRatio(const PointLaw<3>&);
template double leastResistance(const PointLaw<2>&, std::size_t);
template double leastResistance(const PointLaw<3>&, std::size_t);
template class WaveFactor<2>;
template class WaveFactor<3>;

} // namespace lamella::mpm
