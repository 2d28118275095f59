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

/// Grains (2) four times as stiff as the matrix (1) between two platens; all bonds break at the same elongation, as in
/// the second paper. Two nodes high for each one across.
/// @param saturation 1 and above: all gaps are filled
/// @param platen layers of nodes in each
/// @param wallBridges matrix between platens and grains too, which else only touch
inline Sample cemented(std::int64_t nodes, double saturation, std::int64_t grains, std::uint64_t seed,
  double platen = 4, bool wallBridges = false)
{
  packing::PackingOptions o;
  o.count = grains;
  o.aspect = 2;
  o.seed = seed;
  const packing::Packing p = packing::pack(o);
  packing::BridgeOptions b;
  b.walls = wallBridges;
  if (saturation < 1)
    b.saturation = saturation;
  else
    b.filled = true;
  packing::RasterOptions r;
  r.nodesAcross = nodes;
  r.platen = platen * p.size[0] / static_cast<double>(nodes);
  packing::CementedSample c = packing::cement(p, b, r);
  Sample s{ c.image.lattice, std::move(c.image.phase), std::move(c.grain), {} };
  const peridynamics::BondMaterial soft{ .youngsModulus = 1e9, .criticalStretch = 1e-3 };
  const peridynamics::BondMaterial stiff{ .youngsModulus = 4e9, .criticalStretch = 1e-3 };
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

/// Walls of softwood (1) between two platens, a square.
inline Sample wood(std::int64_t nodes, std::uint64_t seed, double spacing)
{
  generators::SoftwoodOptions o;
  o.size = { nodes, nodes, 1 };
  o.spacing = spacing;
  o.seed = seed;
  const PhaseImage image = generators::softwood(o);
  Sample s{ image.lattice, {}, {}, {} };
  for (const std::uint8_t p : image.phase)
    s.phase.push_back(image.phases.name(p) == "wall" ? 1 : 0);
  addPlatens(s.phase, s.lattice);
  s.model.pairs[{ 1, 1 }].material = { .youngsModulus = 1e9, .criticalStretch = 1e-3 };
  return s;
}

} // namespace lamella::breakable
