// Small samples that break, for tests and benchmarks: cemented grains, walls of wood.
#pragma once

#include "generators/Generators.h"
#include "packing/Bridges.h"
#include "packing/Packing.h"
#include "peridynamics/BondModel.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace lamella::breakable
{

struct Sample
{
  Lattice lattice;
  std::vector<std::uint8_t> phase; ///< 0 void
  std::vector<std::int32_t> grain; ///< empty where grains do not matter
  peridynamics::BondModel model;
};

/// Grains (2) in a matrix (1) between two platens of matrix.
struct Cemented
{
  std::int64_t nodes = 64; ///< across
  double saturation = 0.5; ///< 1 and above: all gaps are filled
  std::int64_t grains = 24;
  std::uint64_t seed = 1;
  double platen = 4;        ///< layers of nodes in each
  bool wallBridges = false; ///< matrix between platens and grains too, which else only touch
  int dimension = 2;
  double contrast = 4; ///< of Young's moduli, grains over matrix
};

/// All bonds break at the same elongation, as in the second paper. In the plane two nodes high for each one across.
inline Sample cemented(const Cemented& options)
{
  packing::PackingOptions o;
  o.dimension = options.dimension;
  o.count = options.grains;
  o.aspect = options.dimension == 3 ? 1 : 2;
  o.seed = options.seed;
  const packing::Packing p = packing::pack(o);
  packing::BridgeOptions b;
  b.walls = options.wallBridges;
  if (options.saturation < 1)
    b.saturation = options.saturation;
  else
    b.filled = true;
  packing::RasterOptions r;
  r.nodesAcross = options.nodes;
  r.platen = options.platen * p.size[0] / static_cast<double>(options.nodes);
  packing::CementedSample c = packing::cement(p, b, r);
  Sample s{ c.image.lattice, std::move(c.image.phase), std::move(c.grain), {} };
  const peridynamics::BondMaterial soft{ .youngsModulus = 1e9, .criticalStretch = 1e-3 };
  const peridynamics::BondMaterial stiff{ .youngsModulus = options.contrast * 1e9, .criticalStretch = 1e-3 };
  s.model.continuum = options.dimension == 3 ? peridynamics::Continuum::Space : peridynamics::Continuum::PlaneStress;
  s.model.pairs[{ 1, 1 }].material = soft;
  s.model.pairs[{ 1, 2 }].material = soft;
  s.model.pairs[{ 2, 2 }].material = stiff;
  s.model.pairs[{ 2, 2 }].betweenGrains = soft;
  s.model.pairByGrain = true;
  return s;
}

/// Phase 1 in the four lowest and the four highest rows of a picture.
inline void addPlatens(std::vector<std::uint8_t>& phase, const Lattice& lattice)
{
  const std::int64_t ny = lattice.size[1];
  for (std::int64_t y = 0; y < ny; ++y)
    if (y < 4 || y >= ny - 4)
      std::fill_n(phase.begin() + y * lattice.size[0], lattice.size[0], std::uint8_t{ 1 });
}

/// Walls of softwood (1), without platens.
inline Sample softwood(std::int64_t nx, std::int64_t ny, std::uint64_t seed, double spacing)
{
  generators::SoftwoodOptions o;
  o.size = { nx, ny, 1 };
  o.spacing = spacing;
  o.seed = seed;
  const PhaseImage image = generators::softwood(o);
  Sample s{ image.lattice, {}, {}, {} };
  for (const std::uint8_t p : image.phase)
    s.phase.push_back(image.phases.name(p) == "wall" ? 1 : 0);
  s.model.pairs[{ 1, 1 }].material = { .youngsModulus = 1e9, .criticalStretch = 1e-3 };
  return s;
}

/// A square of it between two platens.
inline Sample wood(std::int64_t nodes, std::uint64_t seed, double spacing)
{
  Sample s = softwood(nodes, nodes, seed, spacing);
  addPlatens(s.phase, s.lattice);
  return s;
}

} // namespace lamella::breakable
