// Samples that break, and what they are compared by.
#pragma once

#include "../BreakableSamples.h"
#include "BondSamples.h"

#include "peridynamics/fracture/Fracture.h"

#include <gtest/gtest.h>

#include <set>

namespace lamella::test
{

struct Breakable
{
  Sample sample;
  BondModel model;
};

inline Breakable of(breakable::Sample s)
{
  return { { s.lattice, std::move(s.phase), std::move(s.grain) }, std::move(s.model) };
}

inline Breakable cementedGrains(std::int64_t nodes, double saturation, std::uint64_t seed = 1)
{
  return of(breakable::cemented({ .nodes = nodes, .saturation = saturation, .seed = seed }));
}

inline Breakable walls(std::int64_t nodes, std::uint64_t seed = 1)
{
  return of(breakable::wood(nodes, seed, 1e-6));
}

inline Breakable strip(std::int64_t nx, std::int64_t ny, double horizon = 3)
{
  return { block(nx, ny), modelOf(Continuum::PlaneStress, horizon) };
}

inline FractureRecord fracture(
  const Breakable& s, const FractureOptions& options, const Loading& loading = {}, const Communicator& comm = alone())
{
  BondLattice bonds = latticeOf(s.model, s.sample, comm);
  QuasiStaticFracture f(bonds, loading, options);
  f.run();
  return f.record();
}

inline FractureOptions by(FractureMethod method, double stop = 0.05)
{
  FractureOptions o;
  o.method = method;
  o.stopShare = stop;
  return o;
}

/// The bonds that cross a plane between the two middle layers of an axis (or the one `above` layers above that) where
/// `inside` says so, by the other coordinates in order; of whole lattices on one rank.
template <class Inside>
std::vector<KnownBond> crossing(const BondLattice& bonds, std::size_t normal, Inside&& inside, double above = 0)
{
  const NodeLayout& l = bonds.layout();
  const double plane = 0.5 * static_cast<double>(l.size[normal]) - 0.5 + above;
  std::vector<KnownBond> found;
  for (std::int64_t z = 0; z < l.size[2]; ++z)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
      bonds.forEachBond(y, z,
        [&](std::int64_t i, std::int64_t, int o, int kind)
        {
          const auto n = l.node(i);
          const auto& step = bonds.stencil().half()[static_cast<std::size_t>(o)].step;
          const double share = step[normal] == 0 ? -1 : (plane - static_cast<double>(n[normal])) / step[normal];
          if (share <= 0 || share >= 1)
            return;
          std::array<double, 2> at{};
          for (std::size_t a = 0, k = 0; a < 3; ++a)
            if (a != normal)
              at[k++] = static_cast<double>(n[a]) + share * step[a];
          if (inside(at[0], at[1]))
            found.push_back({ bonds.bond(i, o), kind });
        });
  return found;
}

inline std::vector<Bond> bondsOf(const std::vector<KnownBond>& known)
{
  std::vector<Bond> bonds;
  for (const KnownBond& b : known)
    bonds.push_back(b.bond);
  return bonds;
}

/// Cuts them.
template <class Inside>
void cut(BondLattice& bonds, std::size_t normal, Inside&& inside)
{
  bonds.breakBonds(bondsOf(crossing(bonds, normal, inside)));
}

/// Share of the bonds of a that b broke too.
inline double inCommon(const FractureRecord& a, const FractureRecord& b)
{
  std::set<Bond> other;
  for (const BrokenBond& x : b.broken)
    other.insert(x.bond);
  double both = 0;
  for (const BrokenBond& x : a.broken)
    both += other.contains(x.bond) ? 1 : 0;
  return both / static_cast<double>(a.broken.size());
}

inline void expectSame(const FractureRecord& a, const FractureRecord& b, double tolerance)
{
  EXPECT_EQ(a.end, b.end);
  ASSERT_EQ(a.broken.size(), b.broken.size());
  for (std::size_t i = 0; i < a.broken.size(); ++i)
  {
    ASSERT_EQ(a.broken[i].bond, b.broken[i].bond) << i;
    EXPECT_EQ(a.broken[i].event, b.broken[i].event);
    EXPECT_NEAR(a.broken[i].strain, b.broken[i].strain, tolerance * a.broken[i].strain);
    EXPECT_NEAR(a.broken[i].criticalStrain, b.broken[i].criticalStrain, tolerance * a.broken[i].strain);
    EXPECT_NEAR(a.broken[i].stress, b.broken[i].stress, tolerance * a.peak.stress);
  }
}

} // namespace lamella::test
