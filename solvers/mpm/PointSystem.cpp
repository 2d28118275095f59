#include "mpm/PointSystem.h"

#include "mpm/ShapeFunctions.h"
#include "mpm/SmallStrain.h"

#include <algorithm>
#include <map>
#include <numeric>

namespace lamella::mpm
{
namespace
{

// dτ/dε at F = I, of small strains in Voigt's order: differences of fourth order, which leave about 1e-12.
template <int Dim>
std::array<double, (Dim == 3 ? 21 : 6)> smallStiffness(
  const PointLaw<Dim>& law, std::size_t phase, const Vector<Dim>& axis)
{
  constexpr int n = Dim == 3 ? 6 : 3;
  constexpr double h = 1e-3;
  const std::array<double, MaterialPoints<Dim>::mostHistory> untouched{}; // what a point remembers at the start
  std::array<std::array<double, n>, n> c{};
  for (int a = 0; a < n; ++a)
    for (const auto& [step, weight] : { std::array{ h, 8.0 }, { -h, -8.0 }, { 2 * h, -1.0 }, { -2 * h, 1.0 } })
    {
      auto F = Matrix<Dim>::identity();
      const auto [i, j] = voigt<Dim>[static_cast<std::size_t>(a)];
      F(i, j) += i == j ? step : step / 2;
      if (i != j)
        F(j, i) += step / 2;
      const Matrix<Dim> tau = law.kirchhoff(phase, F, axis, untouched.data());
      for (int b = 0; b < n; ++b)
      {
        const auto [k, l] = voigt<Dim>[static_cast<std::size_t>(b)];
        c[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)] += weight * tau(k, l) / (12 * h);
      }
    }
  std::array<double, (Dim == 3 ? 21 : 6)> upper{};
  std::size_t k = 0;
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = a; b < n; ++b)
      upper[k++] = 0.5 * (c[a][b] + c[b][a]);
  return upper;
}

} // namespace

template <int Dim>
PointSystem<Dim>::PointSystem(const MaterialPoints<Dim>& points, const PointLaw<Dim>& law,
  const BackgroundGrid<Dim>& grid, const std::array<BoxSides, Dim>& sides)
  : grid_(grid)
{
  for (int s = 0; s < splines; ++s)
    jumps_[static_cast<std::size_t>(s)] =
      s % 3 * grid_.stride(0) + s / 3 % 3 * grid_.stride(1) + (Dim == 3 ? s / 9 * grid_.stride(Dim - 1) : 0);
  readPoints(points, law);
  findImages(sides);
}

template <int Dim>
void PointSystem<Dim>::readPoints(const MaterialPoints<Dim>& points, const PointLaw<Dim>& law)
{
  const std::size_t count = points.count();
  std::vector<std::int64_t> base(count);
  std::vector<std::array<double, Dim>> fraction(count);
  for (std::size_t p = 0; p < count; ++p)
  {
    const Vector<Dim> x = points.vector(MaterialPoints<Dim>::positions, p);
    std::array<int, Dim> node;
    for (int a = 0; a < Dim; ++a)
    {
      const GridAxis& axis = grid_.axis(a);
      const double at = axis.coordinate(x[a]);
      // on the very end of the grid rather than one node beyond it
      node[static_cast<std::size_t>(a)] = std::clamp(QuadraticSpline::at(at, 1).base, -1, axis.cells - 1);
      fraction[p][static_cast<std::size_t>(a)] = at - node[static_cast<std::size_t>(a)];
    }
    base[p] = grid_.index(node);
  }
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return base[a] < base[b]; });

  constexpr std::size_t entries = Dim == 3 ? 21 : 6;
  base_.resize(count);
  fraction_.resize(count);
  kind_.resize(count);
  // Points of one phase, axis and volume share their numbers, as long as there are few of these.
  constexpr std::size_t most = 4096;
  std::map<std::array<double, Dim + 2>, std::uint32_t> known;
  std::vector<std::uint32_t> example; // by kind
  for (std::size_t k = 0; k < count; ++k)
  {
    const std::size_t p = order[k];
    base_[k] = base[p];
    fraction_[k] = fraction[p];
    const Vector<Dim> axis = points.vector(MaterialPoints<Dim>::axes, p);
    std::array<double, Dim + 2> key{ static_cast<double>(points.phase()[p]),
      points.column(MaterialPoints<Dim>::volumes)[p] };
    for (int a = 0; a < Dim; ++a)
      key[static_cast<std::size_t>(a) + 2] = axis[a];
    const auto fresh = static_cast<std::uint32_t>(example.size());
    const auto found = known.size() < most ? known.try_emplace(key, fresh).first : known.find(key);
    kind_[k] = found == known.end() ? fresh : found->second;
    if (kind_[k] == fresh)
      example.push_back(order[k]);
  }
  stiffness_.resize(example.size() * entries);
#pragma omp parallel for schedule(static)
  for (std::size_t k = 0; k < example.size(); ++k)
  {
    const std::size_t p = example[k];
    const auto c = smallStiffness<Dim>(law, points.phase()[p], points.vector(MaterialPoints<Dim>::axes, p));
    for (std::size_t e = 0; e < entries; ++e)
      stiffness_[k * entries + e] = points.column(MaterialPoints<Dim>::volumes)[p] * c[e];
  }
  const std::int64_t layer = grid_.stride(Dim - 1);
  for (std::int64_t r = 0; r <= grid_.nodes(Dim - 1); ++r)
    rows_.push_back(static_cast<std::size_t>(std::lower_bound(base_.begin(), base_.end(), r * layer) - base_.begin()));
}

template <int Dim>
void PointSystem<Dim>::findImages(const std::array<BoxSides, Dim>& sides)
{
  const auto count = static_cast<std::size_t>(grid_.count());
  for (int a = 0; a < Dim; ++a)
    periods_[static_cast<std::size_t>(a)] =
      sides[static_cast<std::size_t>(a)] == BoxSides::Periodic ? grid_.axis(a).cells : 0;
  master_.resize(count);
  sign_.assign(count * Dim, 1);
  for (std::size_t k = 0; k < count; ++k)
  {
    std::int64_t master = 0;
    for (int a = 0; a < Dim; ++a)
    {
      const int cells = grid_.axis(a).cells;
      const int own = coordinates(static_cast<std::int64_t>(k))[static_cast<std::size_t>(a)];
      const BoxSides side = sides[static_cast<std::size_t>(a)];
      int at = own;
      if (side == BoxSides::Periodic)
        at = (own + cells) % cells;
      else if (side != BoxSides::Open)
        at = own < 0 ? -own : own > cells ? 2 * cells - own : own;
      master += (at + 1) * grid_.stride(a);
      if (side == BoxSides::Walls || side == BoxSides::StickyWalls)
        for (int c = 0; c < Dim; ++c)
          if (c == a || side == BoxSides::StickyWalls)
            sign_[k * Dim + static_cast<std::size_t>(c)] = static_cast<std::int8_t>(own == 0 || own == cells ? 0
                : at == own ? sign_[k * Dim + static_cast<std::size_t>(c)]
                            : -sign_[k * Dim + static_cast<std::size_t>(c)]);
    }
    master_[k] = static_cast<std::int32_t>(master);
    const auto* sign = &sign_[k * Dim];
    if (master != static_cast<std::int64_t>(k) || std::find(sign, sign + Dim, 0) != sign + Dim)
      images_.push_back(static_cast<std::int32_t>(k));
  }
  place_.assign(count, -1);
  for (std::size_t p = 0; p < base_.size(); ++p)
    if (p == 0 || base_[p] != base_[p - 1])
      for (const std::int64_t jump : jumps_)
        place_[static_cast<std::size_t>(master_[static_cast<std::size_t>(base_[p] + jump)])] = 0;
  for (std::size_t k = 0; k < count; ++k)
    if (place_[k] == 0)
    {
      place_[k] = static_cast<std::int32_t>(nodes_.size());
      nodes_.push_back(static_cast<std::int32_t>(k));
    }
}

template <int Dim>
std::array<int, Dim> PointSystem<Dim>::coordinates(std::int64_t node) const
{
  std::array<int, Dim> at;
  for (int a = 0; a < Dim; ++a)
    at[static_cast<std::size_t>(a)] = static_cast<int>(node / grid_.stride(a) % grid_.nodes(a)) - 1;
  return at;
}

template <int Dim>
auto PointSystem<Dim>::stress(std::size_t p, const Strain& strain) const -> Strain
{
  const double* c = &stiffness_[kind_[p] * std::size_t{ Dim == 3 ? 21 : 6 }];
  Strain t{};
  for (std::size_t a = 0; a < strains; ++a)
  {
    t[a] += *c++ * strain[a];
    for (std::size_t b = a + 1; b < strains; ++b, ++c)
    {
      t[a] += *c * strain[b];
      t[b] += *c * strain[a];
    }
  }
  return t;
}

// Splines along each axis at a point, gradients over the spacing.
template <int Dim>
auto PointSystem<Dim>::profiles(std::size_t p) const -> std::array<AxisShape<3>, Dim>
{
  std::array<AxisShape<3>, Dim> s;
  for (std::size_t a = 0; a < Dim; ++a)
  {
    s[a] = QuadraticSpline::at(fraction_[p][a], 1); // its base is 0 wherever the point is
    for (double& v : s[a].gradient)
      v /= grid_.axis(static_cast<int>(a)).spacing;
  }
  return s;
}

// visit(first node of a row along x, factors of its splines): the first goes with the gradients along x, the others,
// derivatives along y (and z), with the values.
template <int Dim>
template <class Visit>
void PointSystem<Dim>::forEachRow(std::size_t p, const std::array<AxisShape<3>, Dim>& s, const Visit& visit) const
{
  for (std::size_t k = 0; k < (Dim == 3 ? 3 : 1); ++k)
    for (std::size_t j = 0; j < 3; ++j)
    {
      const std::int64_t first = base_[p] + jumps_[9 * k + 3 * j];
      if constexpr (Dim == 2)
        visit(first, std::array{ s[1].value[j], s[1].gradient[j] });
      else
        visit(first,
          std::array{
            s[1].value[j] * s[2].value[k], s[1].gradient[j] * s[2].value[k], s[1].value[j] * s[2].gradient[k] });
    }
}

template <int Dim>
auto PointSystem<Dim>::strainAt(std::size_t p, const std::array<AxisShape<3>, Dim>& s, const Field& w) const -> Strain
{
  std::array<std::array<double, Dim>, Dim> gradient{};
  forEachRow(p, s,
    [&](std::int64_t first, const std::array<double, Dim>& factor)
    {
      const double* u = &w[static_cast<std::size_t>(first) * Dim];
      for (std::size_t c = 0; c < Dim; ++c)
      {
        const double value = s[0].value[0] * u[c] + s[0].value[1] * u[c + Dim] + s[0].value[2] * u[c + 2 * Dim];
        gradient[c][0] +=
          factor[0] * (s[0].gradient[0] * u[c] + s[0].gradient[1] * u[c + Dim] + s[0].gradient[2] * u[c + 2 * Dim]);
        for (std::size_t a = 1; a < Dim; ++a)
          gradient[c][a] += factor[a] * value;
      }
    });
  return strainOf<Dim>(gradient);
}

template <int Dim>
void PointSystem<Dim>::scatter(
  std::size_t p, const std::array<AxisShape<3>, Dim>& s, const Strain& stress, Field& f) const
{
  forEachRow(
    p, s,
    [&](std::int64_t first, const std::array<double, Dim>& factor)
    {
      std::array<double, Dim> across = factor;
      across[0] = 0;
      const auto withValues = forceOf<Dim>(stress, across);
      std::array<double, Dim> along{};
      along[0] = factor[0];
      const auto withGradients = forceOf<Dim>(stress, along);
      double* to = &f[static_cast<std::size_t>(first) * Dim];
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t c = 0; c < Dim; ++c)
          to[i * Dim + c] += s[0].value[i] * withValues[c] + s[0].gradient[i] * withGradients[c];
    });
}

// Layers of cells two by two: those of one parity share no node, so that the order of every sum is the same whatever
// the number of threads.
template <int Dim>
template <class Visit>
void PointSystem<Dim>::forEachPoint(const Visit& visit) const
{
  const auto layers = static_cast<std::int64_t>(rows_.size()) - 1;
  for (std::int64_t parity = 0; parity < 2; ++parity)
  {
#pragma omp parallel for schedule(dynamic, 1)
    for (std::int64_t r = 2 * parity; r < layers; r += 4)
    {
      const std::size_t end = rows_[static_cast<std::size_t>(std::min(r + 2, layers))];
      for (std::size_t p = rows_[static_cast<std::size_t>(r)]; p < end; ++p)
        visit(p);
    }
  }
}

template <int Dim>
void PointSystem<Dim>::fold(Field& f) const
{
  for (const std::int32_t i : images_)
  {
    const auto from = static_cast<std::size_t>(i) * Dim;
    const auto to = static_cast<std::size_t>(master_[static_cast<std::size_t>(i)]) * Dim;
    for (std::size_t c = 0; c < Dim; ++c)
    {
      const double v = f[from + c];
      f[from + c] = 0;
      if (from != to)
        f[to + c] += sign_[from + c] * v;
      else if (sign_[from + c] != 0)
        f[from + c] = v;
    }
  }
}

template <int Dim>
void PointSystem<Dim>::apply(Field& w, Field& f) const
{
  for (const std::int32_t i : images_)
  {
    const auto to = static_cast<std::size_t>(i) * Dim;
    const auto from = static_cast<std::size_t>(master_[static_cast<std::size_t>(i)]) * Dim;
    for (std::size_t c = 0; c < Dim; ++c)
      w[to + c] = sign_[to + c] * w[from + c];
  }
  std::fill(f.begin(), f.end(), 0.0);
  forEachPoint(
    [&](std::size_t p)
    {
      const auto shape = profiles(p);
      scatter(p, shape, stress(p, strainAt(p, shape, w)), f);
    });
  fold(f);
}

template <int Dim>
auto PointSystem<Dim>::load(const Strain& strain) const -> Field
{
  Field f(values(), 0.0);
  forEachPoint(
    [&](std::size_t p)
    {
      Strain t = stress(p, strain);
      for (double& v : t)
        v = -v;
      scatter(p, profiles(p), t, f);
    });
  fold(f);
  return f;
}

template <int Dim>
double PointSystem<Dim>::uniform(const Strain& first, const Strain& second) const
{
  double sum = 0;
  for (std::size_t p = 0; p < base_.size(); ++p)
  {
    const Strain t = stress(p, second);
    for (std::size_t a = 0; a < strains; ++a)
      sum += first[a] * t[a];
  }
  return sum;
}

template class PointSystem<2>;
template class PointSystem<3>;

} // namespace lamella::mpm
