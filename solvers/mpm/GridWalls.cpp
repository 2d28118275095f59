#include "mpm/GridWalls.h"

#include "mpm/SharedRows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace lamella::mpm
{
namespace
{

constexpr std::int64_t nodesWorthThreads = 20000;

double& at(std::span<double> nodes, std::int64_t node, int value)
{
  return nodes[static_cast<std::size_t>(node * nodeValues + value)];
}

/// Node number along the axis, −1 first, to a distance in memory.
template <int Dim>
std::int64_t step(const BackgroundGrid<Dim>& grid, int axis, int node)
{
  return (node + 1) * grid.stride(axis);
}

template <int Dim>
using AllSums = std::array<std::array<WallSums, 2>, Dim>;

bool odd(const Wall& wall, int axis, int c)
{
  return c == axis || wall.sticks;
}

/// Adds what the nodes of one line have to the sums of a wall, or of a period.
/// @param shifted velocity of the wall that the masters' momentum has already been changed for
template <int Dim>
void addLine(const BackgroundGrid<Dim>& grid, const MirrorPairs& pairs, std::span<double> nodes, int axis, int side,
  std::int64_t line, WallSums& sums, double shifted = 0)
{
  const GridAxis& g = grid.axis(axis);
  if (g.end(side) == Edge::Wall)
  {
    const std::int64_t i = line + step(grid, axis, side == 0 ? 0 : g.cells);
    sums.mass += at(nodes, i, 0);
    sums.momentum += at(nodes, i, 1 + axis);
  }
  for (int q = 0; q < pairs.count; ++q)
  {
    const MirrorPair& p = pairs.pair[static_cast<std::size_t>(q)];
    const std::int64_t ghost = line + step(grid, axis, p.ghost);
    const std::int64_t master = line + step(grid, axis, p.master);
    const double mass = at(nodes, ghost, 0);
    const double share = at(nodes, master, 0) > leastMass ? mass / at(nodes, master, 0) : 0;
    const double momentum = at(nodes, master, 1 + axis) + p.sign * p.jump * shifted * mass;
    sums.mass += p.jump * p.jump * mass * (1 - share);
    sums.momentum += p.jump * (at(nodes, ghost, 1 + axis) - p.sign * share * momentum);
  }
}

/// Of all ends of all axes, on this rank and for one body.
template <int Dim>
void addWallSums(const BackgroundGrid<Dim>& grid, const Walls<Dim>& walls, std::span<double> nodes, AllSums<Dim>& sums)
{
  for (int axis = 0; axis < Dim; ++axis)
    for (int side = 0; side < 2; ++side)
    {
      const MirrorPairs pairs = mirrorPairs(grid, walls, axis, side, axis);
      if (pairs.count == 0)
        continue;
      WallSums& sum = sums[static_cast<std::size_t>(axis)][static_cast<std::size_t>(side)];
      forEachLine(
        grid, axis, Lines::Own, [&](std::int64_t line) { addLine(grid, pairs, nodes, axis, side, line, sum); });
    }
}

/// Forces of the walls, and velocities of the straight ones.
template <int Dim>
void findWalls(Walls<Dim>& walls, const AllSums<Dim>& sums, double kick)
{
  for (int axis = 0; axis < Dim; ++axis)
    for (int side = 0; side < 2; ++side)
    {
      Wall& wall = walls(axis, side);
      const WallSums& s = sums[static_cast<std::size_t>(axis)][static_cast<std::size_t>(side)];
      if (wall.straight)
        wall.velocity = s.mass > leastMass ? s.momentum / s.mass : 0;
      wall.force = (s.momentum - s.mass * wall.velocity) / kick;
    }
}

/// Momentum of the masters for the walls' velocities, or back.
/// @param sign 1, or −1
template <int Dim>
void shiftMasters(const BackgroundGrid<Dim>& grid, const Walls<Dim>& walls, std::span<double> nodes, double sign)
{
  for (int axis = 0; axis < Dim; ++axis)
    for (int side = 0; side < 2; ++side)
    {
      const double velocity = sign * walls(axis, side).velocity;
      const MirrorPairs pairs = mirrorPairs(grid, walls, axis, side, axis);
      if (pairs.count > 0)
        forEachLine(grid, axis, Lines::Real,
          [&](std::int64_t line)
          {
            for (int q = 0; q < pairs.count; ++q)
            {
              const MirrorPair& p = pairs.pair[static_cast<std::size_t>(q)];
              at(nodes, line + step(grid, axis, p.master), 1 + axis) -=
                p.sign * p.jump * velocity * at(nodes, line + step(grid, axis, p.ghost), 0);
            }
          });
    }
}

/// Friction of a body on a wall, its normal velocities being found.
template <int Dim>
void rub(const BackgroundGrid<Dim>& grid, const Walls<Dim>& walls, std::span<double> nodes, int axis, int side)
{
  const Wall& wall = walls(axis, side);
  const MirrorPairs pairs = mirrorPairs(grid, walls, axis, side, axis);
  const int near = side == 0 ? 0 : grid.axis(axis).cells;
  forEachLine(grid, axis, Lines::Real,
    [&](std::int64_t line)
    {
      WallSums sums;
      addLine(grid, pairs, nodes, axis, side, line, sums, wall.velocity);
      const double pressed = (side == 0 ? -1 : 1) * (sums.momentum - sums.mass * wall.velocity);
      const std::int64_t i = line + step(grid, axis, near);
      const std::int64_t j = line + step(grid, axis, pairs.pair[0].master);
      if (!(pressed > 0 && at(nodes, i, 0) > walls.least))
        return;
      const bool inner = at(nodes, j, 0) > walls.least;
      // of the spline on the wall: ¾ of its node's, an eighth of each of those beside it, which are alike
      const std::array<double, 2> weight{ inner ? 0.75 : 1, inner ? 0.25 : 0 };
      const std::array<double, 2> inverse{ 1 / at(nodes, i, 0), inner ? 1 / at(nodes, j, 0) : 0 };
      const double mobility = weight[0] * weight[0] * inverse[0] + weight[1] * weight[1] * inverse[1];
      Vector<Dim> slip{};
      double square = 0;
      for (int c = 0; c < Dim; ++c)
        if (c != axis)
        {
          slip[c] = weight[0] * inverse[0] * at(nodes, i, 1 + c) + weight[1] * inverse[1] * at(nodes, j, 1 + c);
          square += slip[c] * slip[c];
        }
      if (!(square > 0))
        return;
      const double impulse = std::min(1 / mobility, wall.friction * pressed / std::sqrt(square)); // over the slip
      for (int c = 0; c < Dim; ++c)
      {
        at(nodes, i, 1 + c) -= weight[0] * impulse * slip[c];
        at(nodes, j, 1 + c) -= weight[1] * impulse * slip[c];
      }
    });
}

/// Velocities of the nodes on walls: along those that stick first, so that no wall is left.
template <int Dim>
void holdWalls(const BackgroundGrid<Dim>& grid, const Walls<Dim>& walls, std::span<double> nodes)
{
  for (const bool normal : { false, true })
    for (int axis = 0; axis < Dim; ++axis)
      for (int side = 0; side < 2; ++side)
      {
        const Wall& wall = walls(axis, side);
        if (grid.axis(axis).end(side) != Edge::Wall || (!normal && !wall.sticks))
          continue;
        forEachLine(grid, axis, Lines::Real,
          [&](std::int64_t line)
          {
            const std::int64_t i = line + step(grid, axis, side == 0 ? 0 : grid.axis(axis).cells);
            for (int c = 0; c < Dim; ++c)
              if ((c == axis) == normal)
                at(nodes, i, 1 + c) = normal ? wall.velocity : 0;
          });
      }
}

template <int Dim>
bool rubs(const Walls<Dim>& walls)
{
  return std::any_of(
    walls.wall.begin(), walls.wall.end(),
    [](const std::array<Wall, 2>& ends) { return ends[0].friction > 0 || ends[1].friction > 0; });
}

} // namespace

template <int Dim>
MirrorPairs mirrorPairs(const BackgroundGrid<Dim>& grid, const Walls<Dim>& walls, int axis, int side, int c)
{
  const GridAxis& g = grid.axis(axis);
  const int n = g.cells;
  switch (g.end(side))
  {
    case Edge::Open:
      return {};
    case Edge::Wall:
    {
      const bool isOdd = odd(walls(axis, side), axis, c);
      return { 1,
        { MirrorPair{ side == 0 ? -1 : n + 1, side == 0 ? 1 : n - 1, isOdd ? -1.0 : 1.0, c == axis ? 2.0 : 0.0 } } };
    }
    case Edge::Periodic:
    {
      if (side == 0 || g.isCut(1)) // where ranks share it SharedRows joins the ends
        return {};
      const double jump = c == axis ? 1 : 0;
      return { 3, { MirrorPair{ -1, n - 1, 1, -jump }, MirrorPair{ n, 0, 1, jump }, MirrorPair{ n + 1, 1, 1, jump } } };
    }
  }
  return {};
}

template <int Dim>
void fold(const BackgroundGrid<Dim>& grid, const Walls<Dim>& walls, std::span<double> nodes)
{
  for (int axis = 0; axis < Dim; ++axis)
    for (int side = 0; side < 2; ++side)
      for (int c = -1; c < Dim; ++c) // mass first
      {
        const MirrorPairs pairs = mirrorPairs(grid, walls, axis, side, c);
        forEachLine(grid, axis, Lines::All,
          [&](std::int64_t line)
          {
            for (int q = 0; q < pairs.count; ++q)
            {
              const MirrorPair& p = pairs.pair[static_cast<std::size_t>(q)];
              at(nodes, line + step(grid, axis, p.master), 1 + c) +=
                (c < 0 ? 1 : p.sign) * at(nodes, line + step(grid, axis, p.ghost), 1 + c);
            }
          });
      }
}

template <int Dim>
void mirror(const BackgroundGrid<Dim>& grid, const Walls<Dim>& walls, std::span<double> nodes)
{
  for (int axis = 0; axis < Dim; ++axis)
    for (int side = 0; side < 2; ++side)
      for (int c = 0; c < Dim; ++c)
      {
        const MirrorPairs pairs = mirrorPairs(grid, walls, axis, side, c);
        const double velocity = walls(axis, side).velocity;
        forEachLine(grid, axis, Lines::All,
          [&](std::int64_t line)
          {
            for (int q = 0; q < pairs.count; ++q)
            {
              const MirrorPair& p = pairs.pair[static_cast<std::size_t>(q)];
              at(nodes, line + step(grid, axis, p.ghost), 1 + c) =
                p.sign * at(nodes, line + step(grid, axis, p.master), 1 + c) + p.jump * velocity;
            }
          });
      }
}

template <int Dim>
void constrain(const BackgroundGrid<Dim>& grid, Walls<Dim>& walls, std::span<double> all, double kick, bool find,
  SharedRows<Dim>* rows, const MaterialPoints<Dim>* points)
{
  const auto pitch = static_cast<std::size_t>(grid.count()) * nodeValues;
  const auto forEachBody = [&](auto&& f) // f(its nodes, number)
  {
    for (std::size_t body = 0; body * pitch < all.size(); ++body)
      f(all.subspan(body * pitch, pitch), body);
  };
  AllSums<Dim> seam{};
  forEachBody(
    [&](std::span<double> nodes, std::size_t body)
    {
      fold(grid, walls, nodes);
      if (!rows)
        return;
      WallSums& sum = seam[static_cast<std::size_t>(rows->axis())][1];
      const WallSums added = rows->add(grid, nodes, body);
      sum.mass += added.mass;
      sum.momentum += added.momentum;
    });
  AllSums<Dim> sums{};
  const auto findAll = [&](bool again)
  {
    AllSums<Dim> now = seam;
    forEachBody([&](std::span<double> nodes, std::size_t) { addWallSums<Dim>(grid, walls, nodes, now); });
    if (rows)
      rows->sum(now);
    // a node where the ends of a period meet shares its impulses by mass, so that none of them is the period's
    for (int axis = 0; axis < Dim && again; ++axis)
      if (grid.axis(axis).end(1) == Edge::Periodic)
        now[static_cast<std::size_t>(axis)] = sums[static_cast<std::size_t>(axis)];
    sums = now;
    findWalls<Dim>(walls, sums, kick);
  };
  const auto shift = [&](double sign)
  {
    forEachBody(
      [&](std::span<double> nodes, std::size_t body)
      {
        shiftMasters(grid, walls, nodes, sign);
        if (rows)
          rows->shift(grid, nodes, sign * walls(rows->axis(), 1).velocity, body);
      });
  };
  if (find)
    findAll(false);
  const bool meets = walls.bodies.count > 1 && points != nullptr;
  if (find && (meets || rubs(walls)))
  {
    shift(1);
    if (meets)
      meet(grid, walls.bodies, *points, all, walls.least, rows);
    for (int axis = 0; axis < Dim; ++axis)
      for (int side = 0; side < 2; ++side)
        if (grid.axis(axis).end(side) == Edge::Wall && walls(axis, side).friction > 0)
          forEachBody([&](std::span<double> nodes, std::size_t) { rub(grid, walls, nodes, axis, side); });
    shift(-1);
    findAll(true);
  }
  shift(1);

  const auto count = static_cast<std::int64_t>(all.size() / nodeValues);
#pragma omp parallel for schedule(static) if (count > nodesWorthThreads)
  for (std::int64_t i = 0; i < count; ++i)
  {
    double* v = all.data() + i * nodeValues;
    const double inverse = v[0] > walls.least ? 1 / v[0] : 0;
    for (int c = 0; c < Dim; ++c)
      v[1 + c] *= inverse;
  }
  forEachBody(
    [&](std::span<double> nodes, std::size_t)
    {
      holdWalls(grid, walls, nodes);
      mirror(grid, walls, nodes);
    });
}

#define LAMELLA_INSTANTIATE(Dim)                                                                                       \
  template MirrorPairs mirrorPairs(const BackgroundGrid<Dim>&, const Walls<Dim>&, int, int, int);                      \
  template void fold(const BackgroundGrid<Dim>&, const Walls<Dim>&, std::span<double>);                                \
  template void mirror(const BackgroundGrid<Dim>&, const Walls<Dim>&, std::span<double>);                              \
  template void constrain(const BackgroundGrid<Dim>&, Walls<Dim>&, std::span<double>, double, bool, SharedRows<Dim>*,  \
    const MaterialPoints<Dim>*);
LAMELLA_INSTANTIATE(2)
LAMELLA_INSTANTIATE(3)
#undef LAMELLA_INSTANTIATE

} // namespace lamella::mpm
