#pragma once

#include "core/Communicator.h"
#include "mpm/MaterialPoints.h"
#include "mpm/NeoHookean.h"
#include "mpm/PointDynamics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace lamella::mpm::samples
{

template <int Dim>
using Place = Vector<Dim>;

/// Points at rest in those cells of a lattice whose centre is inside, from the origin on.
/// @param cells of the lattice along each axis; perNode points along each direction of one
template <int Dim>
MaterialPoints<Dim> filled(
  const std::array<int, Dim>& cells, double spacing, int perNode, double density,
  const std::function<bool(const Place<Dim>&)>& inside = [](const Place<Dim>&) { return true; }, int history = 0)
{
  const Lattice lattice = makeLattice(cells[0], cells[1], Dim == 3 ? cells[Dim - 1] : 1, Dim, spacing);
  std::vector<std::uint8_t> phase(static_cast<std::size_t>(lattice.count()));
  for (std::size_t i = 0; i < phase.size(); ++i)
  {
    Place<Dim> x;
    auto rest = static_cast<std::int64_t>(i);
    for (int a = 0; a < Dim; ++a)
    {
      x[a] = spacing * (static_cast<double>(rest % lattice.size[static_cast<std::size_t>(a)]) + 0.5);
      rest /= lattice.size[static_cast<std::size_t>(a)];
    }
    phase[i] = inside(x) ? 1 : 0;
  }
  PointOptions options;
  options.perNode = perNode;
  options.density = { density };
  options.history = history;
  return pointsFromLattice<Dim>(lattice, phase, {}, options);
}

template <int Dim>
std::shared_ptr<const PointLaw<Dim>> neoHookean(double young, double poisson)
{
  return makeLaw<Dim, NeoHookean>(
    { { young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson)) } });
}

/// Velocity and its gradient of every point from its position.
template <int Dim>
void setVelocities(MaterialPoints<Dim>& points, const std::function<Vector<Dim>(const Place<Dim>&)>& velocity)
{
  using Points = MaterialPoints<Dim>;
  constexpr double d = 1e-6; // of central differences: exact to 1e-10 for smooth fields of size 1
  for (std::size_t p = 0; p < points.count(); ++p)
  {
    const Place<Dim> x = points.vector(Points::positions, p);
    points.setVector(Points::velocities, p, velocity(x));
    Matrix<Dim> c;
    for (int b = 0; b < Dim; ++b)
    {
      Place<Dim> low = x;
      Place<Dim> high = x;
      low[b] -= d;
      high[b] += d;
      for (int a = 0; a < Dim; ++a)
        c(a, b) = (velocity(high)[a] - velocity(low)[a]) / (2 * d);
    }
    points.setAffine(p, c);
  }
}

/// A wall at a place.
inline Side wallAt(double position, double velocity = 0)
{
  return Side{ Edge::Wall, position, velocity, false, false };
}
inline Side straightAt(double position)
{
  return Side{ Edge::Wall, position, 0, true, false };
}
inline Side periodicAt(double position)
{
  return Side{ Edge::Periodic, position, 0, false, false };
}

/// Those points whose number leaves this rank's as the rest by how many ranks there are.
template <int Dim>
MaterialPoints<Dim> shareOf(const MaterialPoints<Dim>& points, const Communicator& comm)
{
  std::vector<std::size_t> mine;
  for (std::size_t p = 0; p < points.count(); ++p)
    if (points.id()[p] % static_cast<unsigned>(comm.size()) == static_cast<unsigned>(comm.rank()))
      mine.push_back(p);
  MaterialPoints<Dim> share(mine.size(), points.history());
  if (points.storesAffines())
    share.storeAffines();
  for (std::size_t p = 0; p < mine.size(); ++p)
  {
    for (int c = 0; c < points.columns(); ++c)
      share.column(c)[p] = points.column(c)[mine[p]];
    share.phase()[p] = points.phase()[mine[p]];
    share.id()[p] = points.id()[mine[p]];
  }
  return share;
}

/// Largest difference of a column over its largest value, or 0.01, over all columns, of points with the same numbers; a
/// point may be on the other side of a period. Affine velocities are compared where b stores them.
template <int Dim>
double difference(const PointDynamics<Dim>& a, const MaterialPoints<Dim>& b)
{
  constexpr int velocities = MaterialPoints<Dim>::velocities;
  MaterialPoints<Dim> mine = a.points();
  for (std::size_t p = 0; p < mine.count(); ++p)
    mine.setAffine(p, a.affine(p));
  std::vector<std::size_t> place(b.count());
  for (std::size_t p = 0; p < place.size(); ++p)
    place[b.id()[p]] = p;
  double worst = 0;
  for (int c = 0; c < b.columns(); ++c)
  {
    const int axis = c < velocities ? c : c - velocities;
    const bool turns = c < velocities + Dim && a.grid().axis(axis).end(0) == Edge::Periodic;
    double largest = 0.01; // what vanishes is round-off: nothing moves along z
    double off = 0;
    for (std::size_t p = 0; p < place.size(); ++p)
    {
      const std::size_t other = place[mine.id()[p]];
      double d = mine.column(c)[p] - b.column(c)[other];
      if (turns) // then it has the velocity of the other end too
      {
        const double length = a.grid().axis(axis).length();
        const double count = std::round((mine.column(axis)[p] - b.column(axis)[other]) / length);
        d -= count * (c < velocities ? length : a.wall(axis, 1).velocity);
      }
      largest = std::max(largest, std::fabs(mine.column(c)[p]));
      off = std::isfinite(d) ? std::max(off, std::fabs(d)) : std::numeric_limits<double>::infinity();
    }
    worst = std::max(worst, off / largest);
  }
  return worst;
}

/// Exponent of the fall of errors with spacings that halve, between the last two.
inline double order(const std::vector<double>& errors)
{
  return std::log2(errors[errors.size() - 2] / errors.back());
}

} // namespace lamella::mpm::samples
