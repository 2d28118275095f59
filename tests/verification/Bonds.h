// Samples for the peridynamic sums, and the same sums by a plain double loop over pairs of nodes.
#pragma once

#include "core/Communicator.h"
#include "peridynamics/BondForces.h"

#include <cmath>
#include <cstdint>
#include <map>
#include <random>
#include <set>
#include <vector>

#include <mpi.h>

namespace lamella::test
{

using namespace lamella::peridynamics;

/// All ranks, or the one there is.
inline const Communicator& everyone()
{
  static const Communicator comm = []
  {
    int initialized = 0;
    MPI_Initialized(&initialized);
    return Communicator(initialized ? MPI_COMM_WORLD : MPI_COMM_SELF);
  }();
  return comm;
}

inline const Communicator& alone()
{
  static const Communicator comm(MPI_COMM_SELF);
  return comm;
}

struct Sample
{
  Lattice lattice;
  std::vector<std::uint8_t> phase;
  std::vector<std::int32_t> grain;
};

/// @param phases beside void; share of voids
inline Sample randomSample(const Lattice& lattice, int phases, double voids, int grains, unsigned seed)
{
  std::mt19937 random(seed);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
  Sample s{ lattice, {}, {} };
  for (std::int64_t i = 0; i < lattice.count(); ++i)
  {
    s.phase.push_back(uniform() < voids ? 0 : static_cast<std::uint8_t>(1 + static_cast<int>(uniform() * phases)));
    s.grain.push_back(static_cast<std::int32_t>(uniform() * (grains + 1)));
  }
  if (grains == 0)
    s.grain.clear();
  return s;
}

/// The part of a sample that a rank holds.
inline BondLattice latticeOf(const BondModel& model, const Sample& s, const Communicator& comm)
{
  const Block b = slab(s.lattice, Stencil(s.lattice.dimension, model.horizon), comm);
  const std::size_t layer =
    static_cast<std::size_t>(s.lattice.dimension == 3 ? s.lattice.size[0] * s.lattice.size[1] : s.lattice.size[0]);
  const std::size_t first = layer * static_cast<std::size_t>(b.start[s.lattice.dimension == 3 ? 2 : 1]);
  const std::size_t count = static_cast<std::size_t>(b.count());
  return BondLattice(model, s.lattice, std::span(s.phase).subspan(first, count),
    s.grain.empty() ? std::span<const std::int32_t>() : std::span<const std::int32_t>(s.grain).subspan(first, count),
    comm);
}

/// A vector at every node of the whole lattice.
using Field = std::vector<std::array<double, 3>>;

inline Field randomField(const Sample& s, double size, unsigned seed)
{
  std::mt19937 random(seed);
  Field u(s.phase.size());
  for (auto& v : u)
    for (int c = 0; c < s.lattice.dimension; ++c)
      v[static_cast<std::size_t>(c)] = size * (static_cast<double>(random()) / 2147483648.0 - 1);
  return u;
}

template <class Real>
NodeField<Real> scatter(const BondLattice& bonds, const Sample& s, const Field& u)
{
  const NodeLayout& l = bonds.layout();
  NodeField<Real> field(l);
  for (int c = 0; c < l.dimension; ++c)
    for (std::int64_t z = 0; z < l.size[2]; ++z)
      for (std::int64_t y = 0; y < l.size[1]; ++y)
        for (std::int64_t x = 0; x < l.size[0]; ++x)
          field.at(c, x, y, z) = static_cast<Real>(u[static_cast<std::size_t>(
            s.lattice.index(x + l.start[0], y + l.start[1], z + l.start[2]))][static_cast<std::size_t>(c)]);
  bonds.exchange(field);
  return field;
}

/// One directed bond.
struct PlainBond
{
  std::size_t i;
  std::size_t j;
  std::array<double, 3> xi;
  double k; ///< stiffness, corrected
  double s0;
};

/// All directed bonds by a double loop: each node, each vector of whole steps within the horizon.
inline std::vector<PlainBond> plainBonds(const BondModel& model, const Sample& s)
{
  const Lattice& l = s.lattice;
  const int d = l.dimension;
  const Stencil stencil = bondStencil(model);
  std::map<std::array<int, 3>, double> weights;
  for (const Offset& o : stencil.half())
    weights[o.step] = weights[{ -o.step[0], -o.step[1], -o.step[2] }] = o.weight;
  const int r = static_cast<int>(model.horizon);
  const std::set<int> voids(model.voids.begin(), model.voids.end());
  std::vector<PlainBond> list;
  std::vector<std::array<double, 3>> held(s.phase.size()); // energies under unit strain along each axis
  const auto wrap = [&](std::int64_t p, std::size_t a) -> std::int64_t
  {
    if (p >= 0 && p < l.size[a])
      return p;
    return model.periodic[a] ? (p + l.size[a]) % l.size[a] : -1;
  };
  // does a bond cross a notch? in 2D only; segments intersect when each has its ends on both sides of the other
  const auto notched = [&](std::array<double, 3> p, const std::array<double, 3>& xi)
  {
    const auto side = [](double ax, double ay, double bx, double by) { return ax * by - ay * bx; };
    for (const Notch& n : model.notches)
      for (int px = model.periodic[0] ? -1 : 0; px <= (model.periodic[0] ? 1 : 0); ++px)
        for (int py = model.periodic[1] ? -1 : 0; py <= (model.periodic[1] ? 1 : 0); ++py)
        {
          const double ax = p[0] - n.corner[0] - px * l.length(0);
          const double ay = p[1] - n.corner[1] - py * l.length(1);
          const double p1 = side(n.along[0], n.along[1], ax, ay);
          const double p2 = side(n.along[0], n.along[1], ax + xi[0], ay + xi[1]);
          const double q1 = side(xi[0], xi[1], -ax, -ay);
          const double q2 = side(xi[0], xi[1], n.along[0] - ax, n.along[1] - ay);
          if (p1 * p2 < 0 && q1 * q2 < 0)
            return true;
        }
    return false;
  };
  for (std::int64_t z = 0; z < l.size[2]; ++z)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
      for (std::int64_t x = 0; x < l.size[0]; ++x)
        for (int dz = d == 3 ? -r : 0; dz <= (d == 3 ? r : 0); ++dz)
          for (int dy = -r; dy <= r; ++dy)
            for (int dx = -r; dx <= r; ++dx)
            {
              const int square = dx * dx + dy * dy + dz * dz;
              if (square == 0 || square > model.horizon * model.horizon * (1 + 1e-9))
                continue;
              const std::array<std::int64_t, 3> q{ wrap(x + dx, 0), wrap(y + dy, 1), wrap(z + dz, 2) };
              if (q[0] < 0 || q[1] < 0 || q[2] < 0)
                continue;
              const auto i = static_cast<std::size_t>(l.index(x, y, z));
              const auto j = static_cast<std::size_t>(l.index(q[0], q[1], q[2]));
              if (voids.contains(s.phase[i]) || voids.contains(s.phase[j]))
                continue;
              const std::array<double, 3> xi{ dx * l.spacing, dy * l.spacing, dz * l.spacing };
              for (std::size_t a = 0; a < 3; ++a)
                held[i][a] += weights.at({ dx, dy, dz }) * std::pow(xi[a] / l.spacing, 4) / std::pow(square, 1.5);
              const std::array<double, 3> p{ l.origin[0] + static_cast<double>(x) * l.spacing,
                l.origin[1] + static_cast<double>(y) * l.spacing, l.origin[2] + static_cast<double>(z) * l.spacing };
              if (d == 2 && notched(p, xi))
                continue;
              const PhasePair& pair =
                model.pairs.at({ std::min(s.phase[i], s.phase[j]), std::max(s.phase[i], s.phase[j]) });
              const bool apart = model.pairByGrain && pair.betweenGrains && !s.grain.empty() && s.grain[i] != 0 &&
                s.grain[j] != 0 && s.grain[i] != s.grain[j];
              const BondConstants c = bondConstants(apart ? *pair.betweenGrains : pair.material, stencil, l.spacing,
                model.continuum, model.micromodulus, "");
              list.push_back({ i, j, xi, weights.at({ dx, dy, dz }) * c.micromodulus * std::pow(l.spacing, 2 * d),
                c.criticalStretch });
            }
  if (model.surfaceCorrection)
  {
    std::array<double, 3> bulk{};
    for (const Offset& o : stencil.half())
      for (std::size_t a = 0; a < 3; ++a)
        bulk[a] += 2 * o.weight * std::pow(o.step[a], 4) / std::pow(o.length, 3);
    for (PlainBond& b : list)
    {
      double sum = 0;
      double length = 0;
      for (std::size_t a = 0; a < static_cast<std::size_t>(d); ++a)
        for (const std::size_t end : { b.i, b.j })
        {
          const double share = std::max(0.25, held[end][a] / bulk[a]);
          sum += 0.5 * b.xi[a] * b.xi[a] * share * share;
          length += 0.5 * b.xi[a] * b.xi[a];
        }
      b.k /= std::sqrt(sum / length);
    }
  }
  return list;
}

/// State of a bond: its vector, length, elongation and force on its first node.
struct PlainState
{
  PlainState(const PlainBond& b, const Field& u, bool nonlinear)
    : zeta(b.xi)
  {
    double square = 0;
    double along = 0;
    for (std::size_t c = 0; c < 3; ++c)
    {
      const double eta = u[b.j][c] - u[b.i][c];
      if (nonlinear)
        zeta[c] += eta;
      square += b.xi[c] * b.xi[c];
      along += b.xi[c] * eta;
    }
    length = std::sqrt(square);
    norm = std::sqrt(zeta[0] * zeta[0] + zeta[1] * zeta[1] + zeta[2] * zeta[2]);
    stretch = nonlinear ? (norm - length) / length : along / square;
    for (std::size_t c = 0; c < 3; ++c)
      force[c] = b.k * stretch * zeta[c] / norm;
  }
  std::array<double, 3> zeta;
  std::array<double, 3> force{};
  double length;
  double norm;
  double stretch;
};

inline Field plainForce(const std::vector<PlainBond>& bonds, const Field& u, bool nonlinear)
{
  Field f(u.size());
  for (const PlainBond& b : bonds)
  {
    const PlainState state(b, u, nonlinear);
    for (std::size_t c = 0; c < 3; ++c)
      f[b.i][c] += state.force[c];
  }
  return f;
}

/// Largest difference between a field of this rank and one of the whole lattice, over the largest value of the latter.
template <class Real, class Whole>
double difference(const NodeField<Real>& field, const Sample& s, const std::vector<Whole>& whole)
{
  const NodeLayout& l = field.layout();
  double size = 0;
  for (const Whole& w : whole)
    for (const double v : w)
      size = std::max(size, std::abs(v));
  double worst = 0;
  for (int c = 0; c < field.components(); ++c)
    for (std::int64_t z = 0; z < l.size[2]; ++z)
      for (std::int64_t y = 0; y < l.size[1]; ++y)
        for (std::int64_t x = 0; x < l.size[0]; ++x)
        {
          const double expected = whole[static_cast<std::size_t>(
            s.lattice.index(x + l.start[0], y + l.start[1], z + l.start[2]))][static_cast<std::size_t>(c)];
          const double error = std::abs(static_cast<double>(field.at(c, x, y, z)) - expected);
          worst = error <= worst ? worst : error; // a NaN counts
        }
  return worst / size;
}

} // namespace lamella::test
