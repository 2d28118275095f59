// Samples for the equilibrium of bond lattices.
#pragma once

#include "Bonds.h"

#include "peridynamics/Equilibrium.h"
#include "peridynamics/Loading.h"

#include <algorithm>

namespace lamella::test
{

inline constexpr double spacing = 1e-3;
inline constexpr double young = 2e9;

inline BondModel modelOf(Continuum continuum, double horizon)
{
  BondModel m;
  m.continuum = continuum;
  m.horizon = horizon;
  m.pairs[{ 1, 1 }] = { BondMaterial{ .youngsModulus = young, .criticalStretch = 0.01 } };
  return m;
}

/// All of phase 1.
inline Sample block(std::int64_t nx, std::int64_t ny, std::int64_t nz = 1)
{
  Sample s{ makeLattice(nx, ny, nz, nz > 1 ? 3 : 2, spacing), {}, {} };
  s.phase.assign(static_cast<std::size_t>(s.lattice.count()), 1);
  return s;
}

/// Stiff disks (2) in a soft matrix (1) with round holes (0), all placed by a fixed rule; in 3D balls.
inline Sample aggregate(std::int64_t nx, std::int64_t ny, std::int64_t nz = 1, double holes = 0.25)
{
  const int d = nz > 1 ? 3 : 2;
  Sample s = block(nx, ny, nz);
  std::mt19937 random(3);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
  const double largest = static_cast<double>(nx) / 9;
  for (int k = 0; k < 60; ++k)
  {
    const double at[3] = { uniform() * static_cast<double>(nx), uniform() * static_cast<double>(ny),
      uniform() * static_cast<double>(nz) };
    const double radius = largest * (0.4 + 0.6 * uniform());
    const std::uint8_t phase = uniform() < holes ? 0 : 2;
    for (std::int64_t z = 0; z < nz; ++z)
      for (std::int64_t y = 0; y < ny; ++y)
        for (std::int64_t x = 0; x < nx; ++x)
        {
          const double a = static_cast<double>(x) - at[0];
          const double b = static_cast<double>(y) - at[1];
          const double c = d == 3 ? static_cast<double>(z) - at[2] : 0;
          if (a * a + b * b + c * c < radius * radius)
            s.phase[static_cast<std::size_t>(s.lattice.index(x, y, z))] = phase;
        }
  }
  // platens of the stiff phase
  const std::int64_t layers = d == 3 ? nz : ny;
  const std::int64_t size = s.lattice.count() / layers;
  for (std::int64_t i = 0; i < s.lattice.count(); ++i)
    if (i / size < 4 || i / size >= layers - 4)
      s.phase[static_cast<std::size_t>(i)] = 2;
  return s;
}

inline BondModel aggregateModel(int dimension, double contrast = 4)
{
  BondModel m = modelOf(dimension == 3 ? Continuum::Space : Continuum::PlaneStress, dimension == 3 ? 2 : 3.015);
  m.pairs[{ 1, 2 }] = m.pairs[{ 1, 1 }];
  m.pairs[{ 2, 2 }] = { BondMaterial{ .youngsModulus = contrast * young, .criticalStretch = 0.01 } };
  return m;
}

struct Solution
{
  NodeField<double> u;
  Reactions reaction;
  EquilibriumResult result;
};

inline Solution solve(const BondLattice& bonds, const Loading& loading, EquilibriumOptions options)
{
  LoadedSample s = applyLoading(bonds, loading);
  Equilibrium equilibrium(bonds, s.fixed, std::move(options));
  Solution r{ s.displacement, {}, {} };
  r.result = equilibrium.solve(r.u, s.load ? &*s.load : nullptr);
  r.reaction = reactions(bonds, s, r.u, loading.axis, false);
  return r;
}

inline EquilibriumOptions with(EquilibriumSolver solver, double tolerance)
{
  EquilibriumOptions o;
  o.solver = solver;
  o.tolerance = tolerance;
  return o;
}

/// Largest difference of the stresses of two solutions over the largest stress. Displacements may differ where hinges
/// or smooth platens leave something free; stresses may not.
inline double difference(const Solution& a, const Solution& b, const BondLattice& bonds)
{
  const NodeLayout& l = bonds.layout();
  const int n = l.dimension == 3 ? 6 : 3;
  NodeField<double> stressA(l, n);
  NodeField<double> stressB(l, n);
  nodalStress(bonds, a.u, stressA, false);
  nodalStress(bonds, b.u, stressB, false);
  double most = 0;
  double size = 0;
  for (int c = 0; c < n; ++c)
    for (std::int64_t z = 0; z < l.size[2]; ++z)
      for (std::int64_t y = 0; y < l.size[1]; ++y)
        for (std::int64_t i = l.index(0, y, z); i < l.index(l.size[0], y, z); ++i)
        {
          most = std::max(most, std::abs(stressA.component(c)[i] - stressB.component(c)[i]));
          size = std::max(size, std::abs(stressB.component(c)[i]));
        }
  return most / size;
}

} // namespace lamella::test
