// Walls around material points that move, and the grid laid between them.
#include "core/Error.h"
#include "mpm/FusedStep.h"
#include "mpm/PointDynamics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace lamella::mpm
{
namespace
{

constexpr int rim = 4; // cells beyond the points where an axis is open

} // namespace

template <int Dim>
std::array<double, 2> PointDynamics<Dim>::extent(int a) const
{
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const double value : points_.column(a))
  {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  return { -options_.comm.max(-low), options_.comm.max(high) };
}

template <int Dim>
GridAxis PointDynamics<Dim>::layAxis(int a, bool keep) const
{
  const auto& side = options_.sides[static_cast<std::size_t>(a)];
  const double h = options_.spacing;
  GridAxis g = grid_.axis(a);
  g.edge = { side[0].edge, side[1].edge };
  double lower = side[0].position;
  double upper = side[1].position;
  if (side[0].edge != Edge::Open && side[1].edge != Edge::Open)
  {
    const double wanted = (upper - lower) / h;
    // walls that come and go across half a cell do not change the number of cells each time
    if (grid_.count() == 0 || std::fabs(wanted - g.cells) > 0.75)
      g.cells = static_cast<int>(std::lround(wanted));
    if (g.cells < 3)
      throw DivergenceError(fmt::format("at step {} the walls along axis {} are {} m apart, three cells are {} m",
                              step_, a, upper - lower, 3 * h),
        "stop before, or take a finer grid");
    g.lower = lower;
    g.spacing = (upper - lower) / g.cells;
    return g;
  }
  if (keep) // it moves with its wall
  {
    if (side[0].edge != Edge::Open)
      g.lower = lower;
    else if (side[1].edge != Edge::Open)
      g.lower = upper - g.cells * h;
    return g;
  }
  const auto [low, high] = extent(a);
  const double room = rim * h;
  if (side[0].edge != Edge::Open)
    upper = high + room;
  else if (side[1].edge != Edge::Open)
    lower = low - room;
  else
  {
    lower = std::floor((low - room) / h) * h; // nodes at multiples of the spacing
    upper = high + room;
  }
  const double cells = std::ceil((upper - lower) / h);
  if (!(cells < std::max(1e4, static_cast<double>(points_.count()))))
    throw DivergenceError(
      fmt::format("at step {} the points are spread from {} to {} m along axis {}", step_, low, high, a),
      "take a smaller step, or hold them with walls");
  g.cells = static_cast<int>(cells);
  g.spacing = h;
  g.lower = side[0].edge == Edge::Open && side[1].edge != Edge::Open ? upper - g.cells * h : lower;
  return g;
}

template <int Dim>
void PointDynamics<Dim>::layGrid(bool keep)
{
  std::array<GridAxis, Dim> axes;
  for (int a = 0; a < Dim; ++a)
    axes[static_cast<std::size_t>(a)] = layAxis(a, keep);
  grid_.set(axes);
}

template <int Dim>
void PointDynamics<Dim>::moveWalls(double dt)
{
  for (int a = 0; a < Dim; ++a)
    for (int s = 0; s < 2; ++s)
    {
      Side& side = options_.sides[static_cast<std::size_t>(a)][static_cast<std::size_t>(s)];
      if (side.edge != Edge::Open)
        side.position += walls_(a, s).velocity * dt;
    }
}

template <int Dim>
void PointDynamics<Dim>::wrap()
{
  if (fused_)
  {
    std::vector<std::size_t> wrapped;
    for (std::size_t p = 0; p < points_.count(); ++p)
    {
      bool beyond = false;
      for (int a = 0; a < Dim; ++a)
      {
        const auto& side = options_.sides[static_cast<std::size_t>(a)];
        const double x = points_.column(a)[p];
        beyond = beyond || (side[0].edge == Edge::Periodic && (x < side[0].position || x >= side[1].position));
      }
      if (beyond)
        wrapped.push_back(p);
    }
    fused_->setAside(wrapped);
  }
  for (int a = 0; a < Dim; ++a)
  {
    const auto& side = options_.sides[static_cast<std::size_t>(a)];
    if (side[0].edge != Edge::Periodic)
      continue;
    const double period = side[1].position - side[0].position;
    const double rate = walls_(a, 1).velocity;
    auto x = points_.column(a);
    auto v = points_.column(MaterialPoints<Dim>::velocities + a);
    for (std::size_t p = 0; p < points_.count(); ++p)
    {
      const double sign = x[p] < side[0].position ? 1 : x[p] >= side[1].position ? -1 : 0;
      x[p] += sign * period;
      v[p] += sign * rate;
      startMoment_ += sign * period * options_.gravity[a] * points_.column(MaterialPoints<Dim>::masses)[p]; // no work
    }
  }
}

template std::array<double, 2> PointDynamics<2>::extent(int) const;
template std::array<double, 2> PointDynamics<3>::extent(int) const;
template GridAxis PointDynamics<2>::layAxis(int, bool) const;
template GridAxis PointDynamics<3>::layAxis(int, bool) const;
template void PointDynamics<2>::layGrid(bool);
template void PointDynamics<3>::layGrid(bool);
template void PointDynamics<2>::moveWalls(double);
template void PointDynamics<3>::moveWalls(double);
template void PointDynamics<2>::wrap();
template void PointDynamics<3>::wrap();

} // namespace lamella::mpm
