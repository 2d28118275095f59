#include "mpm/PastVelocity.h"

#include "mpm/GridWalls.h"

#include <array>
#include <cmath>

namespace lamella::mpm
{
namespace
{

constexpr int valuesAnAxis = 5; // lower end, spacing, cells; rate and offset of what was added

} // namespace

template <int Dim>
void PastVelocity<Dim>::set(const BackgroundGrid<Dim>& grid, double dt)
{
  known_ = true;
  grid_ = grid;
  move_ = dt;
  rate_ = {};
  offset_ = {};
}

template <int Dim>
void PastVelocity<Dim>::change(double keep, int axis, double rate, double still, std::span<double> nodes)
{
  // splines reproduce what is linear: its C is its gradient
  const GridAxis& g = grid_.axis(axis);
  const auto count = static_cast<std::int64_t>(nodes.size()) / nodeValues;
  for (std::int64_t i = 0; i < count; ++i)
  {
    double* const v = &nodes[static_cast<std::size_t>(i * nodeValues) + 1];
    for (int a = 0; a < Dim; ++a)
      v[a] *= keep;
    const std::int64_t node = i % grid_.count() / grid_.stride(axis) % grid_.nodes(axis) - 1;
    v[axis] += rate * (g.lower + g.spacing * static_cast<double>(node) - still);
  }
  for (int a = 0; a < Dim; ++a)
  {
    rate_[a] *= keep;
    offset_[a] *= keep;
  }
  rate_[axis] += rate;
  offset_[axis] -= rate * still;
  move_ = keep == 0 ? 0 : move_ / keep; // with nothing kept C is the same everywhere
}

template <int Dim>
Matrix<Dim> PastVelocity<Dim>::affine(const Vector<Dim>& x, const Vector<Dim>& v, const double* nodes) const
{
  std::array<std::array<double, 3>, Dim> weight;
  std::array<std::array<double, 3>, Dim> moment; // 4 w (x_i − x) / h²
  std::int64_t first = 0;
  for (int a = 0; a < Dim; ++a)
  {
    const auto axis = static_cast<std::size_t>(a);
    const double at = grid_.axis(a).coordinate(x[a] - move_ * (v[a] - rate_[a] * x[a] - offset_[a]));
    const double base = std::floor(at - 0.5);
    if (!(base >= -1 && base < grid_.axis(a).cells))
      return {};
    const double f = at - base;
    weight[axis] = { 0.5 * (1.5 - f) * (1.5 - f), 0.75 - (f - 1) * (f - 1), 0.5 * (f - 0.5) * (f - 0.5) };
    for (std::size_t i = 0; i < 3; ++i)
      moment[axis][i] = 4 * weight[axis][i] * (static_cast<double>(i) - f) / grid_.axis(a).spacing;
    first += (static_cast<std::int64_t>(base) + 1) * grid_.stride(a);
  }
  // along x first, whose nodes lie next to each other: sums of v weighted, and of v by the moment along x
  Matrix<Dim> c{};
  for (std::size_t z = 0; z < (Dim == 3 ? 3 : 1); ++z)
    for (std::size_t y = 0; y < 3; ++y)
    {
      std::int64_t at = first + static_cast<std::int64_t>(y) * grid_.stride(1);
      if constexpr (Dim == 3)
        at += static_cast<std::int64_t>(z) * grid_.stride(2);
      const double* const u = nodes + at * nodeValues + 1;
      const double wz = Dim == 3 ? weight[Dim - 1][z] : 1;
      for (int a = 0; a < Dim; ++a)
      {
        const double u0 = u[a];
        const double u1 = u[a + nodeValues];
        const double u2 = u[a + 2 * nodeValues];
        const double value = weight[0][0] * u0 + weight[0][1] * u1 + weight[0][2] * u2;
        c(a, 0) += weight[1][y] * wz * (moment[0][0] * u0 + moment[0][1] * u1 + moment[0][2] * u2);
        c(a, 1) += moment[1][y] * wz * value;
        if constexpr (Dim == 3)
          c(a, 2) += weight[1][y] * moment[2][z] * value;
      }
    }
  return c;
}

template <int Dim>
std::vector<double> PastVelocity<Dim>::numbers() const
{
  std::vector<double> all;
  for (int a = 0; a < Dim; ++a)
  {
    const GridAxis& g = grid_.axis(a);
    all.insert(all.end(), { g.lower, g.spacing, static_cast<double>(g.cells), rate_[a], offset_[a] });
  }
  all.push_back(move_);
  return all;
}

template <int Dim>
bool PastVelocity<Dim>::take(std::span<const double> numbers, std::int64_t nodes)
{
  if (numbers.size() != valuesAnAxis * Dim + 1)
    return false;
  std::array<GridAxis, Dim> axes;
  double all = 1;
  for (std::size_t a = 0; a < Dim; ++a)
  {
    const std::span<const double> mine = numbers.subspan(valuesAnAxis * a, valuesAnAxis);
    if (!(mine[1] > 0 && mine[2] >= 1 && mine[2] <= 1e9))
      return false;
    axes[a].lower = mine[0];
    axes[a].spacing = mine[1];
    axes[a].cells = static_cast<int>(mine[2]);
    all *= axes[a].cells + 3.0;
    rate_[static_cast<int>(a)] = mine[3];
    offset_[static_cast<int>(a)] = mine[4];
  }
  if (all != static_cast<double>(nodes))
    return false;
  grid_.set(axes);
  move_ = numbers.back();
  known_ = true;
  return true;
}

template class PastVelocity<2>;
template class PastVelocity<3>;

} // namespace lamella::mpm
