// Small samples that break: cemented grains, the same with all gaps filled, wood.
#pragma once

#include "BondSamples.h"

#include "generators/Generators.h"
#include "packing/Bridges.h"
#include "packing/Packing.h"
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

/// Grains four times as stiff as the matrix; all bonds break at the same elongation, as in the second paper.
inline Breakable cementedGrains(std::int64_t nodes, double saturation, std::uint64_t seed = 1)
{
  packing::PackingOptions o;
  o.count = 24;
  o.aspect = 2;
  o.seed = seed;
  const packing::Packing p = packing::pack(o);
  packing::BridgeOptions b;
  if (saturation < 1)
    b.saturation = saturation;
  else
    b.filled = true;
  packing::RasterOptions r;
  r.nodesAcross = nodes;
  r.platen = 4 * p.size[0] / static_cast<double>(nodes);
  packing::CementedSample c = packing::cement(p, b, r);
  Breakable s{ { c.image.lattice, std::move(c.image.phase), std::move(c.grain) }, {} };
  const BondMaterial soft{ .youngsModulus = 1e9, .criticalStretch = 1e-3 };
  const BondMaterial stiff{ .youngsModulus = 4e9, .criticalStretch = 1e-3 };
  s.model.pairs[{ 1, 1 }].material = soft;
  s.model.pairs[{ 1, 2 }].material = soft;
  s.model.pairs[{ 2, 2 }].material = stiff;
  s.model.pairs[{ 2, 2 }].betweenGrains = soft;
  s.model.pairByGrain = true;
  return s;
}

/// Walls of softwood between two solid platens.
inline Breakable walls(std::int64_t nodes, std::uint64_t seed = 1)
{
  generators::SoftwoodOptions o;
  o.size = { nodes, nodes, 1 };
  o.spacing = 1e-6;
  o.seed = seed;
  const PhaseImage image = generators::softwood(o);
  Breakable s{ { image.lattice, {}, {} }, {} };
  for (std::int64_t y = 0; y < nodes; ++y)
    for (std::int64_t x = 0; x < nodes; ++x)
      s.sample.phase.push_back(
        y < 4 || y >= nodes - 4 || image.phases.name(image.phase[static_cast<std::size_t>(x + nodes * y)]) == "wall"
          ? 1
          : 0);
  s.model.pairs[{ 1, 1 }].material = { .youngsModulus = 1e9, .criticalStretch = 1e-3 };
  return s;
}

inline Breakable strip(std::int64_t nx, std::int64_t ny, double horizon = 3)
{
  Breakable s{ { makeLattice(nx, ny, 1, 2, spacing), {}, {} }, modelOf(Continuum::PlaneStress, horizon) };
  s.sample.phase.assign(static_cast<std::size_t>(nx * ny), 1);
  return s;
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
