#include "mpm/GridWalls.h"

#include "mpm/SharedRows.h"

#include <array>
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

bool odd(const Wall& wall, int axis, int c)
{
  return c == axis || wall.sticks;
}

template <int Dim>
WallSums wallSums(const BackgroundGrid<Dim>& grid, const Walls<Dim>& walls, std::span<double> nodes, int axis, int side)
{
  WallSums sums;
  const GridAxis& g = grid.axis(axis);
  const MirrorPairs pairs = mirrorPairs(grid, walls, axis, side, axis);
  const bool wall = g.end(side) == Edge::Wall;
  forEachLine(grid, axis, Lines::Own,
    [&](std::int64_t line)
    {
      if (wall)
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
        const double share = at(nodes, master, 0) > leastMass ? at(nodes, ghost, 0) / at(nodes, master, 0) : 0;
        sums.mass += p.jump * p.jump * at(nodes, ghost, 0) * (1 - share);
        sums.momentum += p.jump * (at(nodes, ghost, 1 + axis) - p.sign * share * at(nodes, master, 1 + axis));
      }
    });
  return sums;
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
void constrain(const BackgroundGrid<Dim>& grid, Walls<Dim>& walls, std::span<double> nodes, double kick, bool find,
  SharedRows<Dim>* rows)
{
  fold(grid, walls, nodes);
  std::array<std::array<WallSums, 2>, Dim> sums{};
  if (rows)
    sums[static_cast<std::size_t>(rows->axis())][1] = rows->add(grid, nodes);
  if (find)
  {
    for (int axis = 0; axis < Dim; ++axis)
      for (int side = 0; side < 2; ++side)
        if (mirrorPairs(grid, walls, axis, side, axis).count > 0)
          sums[static_cast<std::size_t>(axis)][static_cast<std::size_t>(side)] =
            wallSums(grid, walls, nodes, axis, side);
    if (rows)
      rows->sum(sums);
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
  for (int axis = 0; axis < Dim; ++axis)
    for (int side = 0; side < 2; ++side)
    {
      // momentum of the masters for this velocity
      const double velocity = walls(axis, side).velocity;
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
  if (rows)
    rows->shift(grid, nodes, walls(rows->axis(), 1).velocity);

  const std::int64_t count = grid.count();
#pragma omp parallel for schedule(static) if (count > nodesWorthThreads)
  for (std::int64_t i = 0; i < count; ++i)
  {
    double* v = nodes.data() + i * nodeValues;
    const double inverse = v[0] > walls.least ? 1 / v[0] : 0;
    for (int c = 0; c < Dim; ++c)
      v[1 + c] *= inverse;
  }

  // nodes on walls: along those that stick first, so that no wall is left
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
  mirror(grid, walls, nodes);
}

#define LAMELLA_INSTANTIATE(Dim)                                                                                       \
  template MirrorPairs mirrorPairs(const BackgroundGrid<Dim>&, const Walls<Dim>&, int, int, int);                      \
  template void fold(const BackgroundGrid<Dim>&, const Walls<Dim>&, std::span<double>);                                \
  template void mirror(const BackgroundGrid<Dim>&, const Walls<Dim>&, std::span<double>);                              \
  template void constrain(const BackgroundGrid<Dim>&, Walls<Dim>&, std::span<double>, double, bool, SharedRows<Dim>*);
LAMELLA_INSTANTIATE(2)
LAMELLA_INSTANTIATE(3)
#undef LAMELLA_INSTANTIATE

} // namespace lamella::mpm
