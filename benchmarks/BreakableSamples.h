#pragma once

#include "Keys.h"

#include "generators/Generators.h"
#include "generators/TissueTruth.h"
#include "micrograph/MiddleLamella.h"
#include "packing/Bridges.h"
#include "packing/Packing.h"
#include "peridynamics/BondModel.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace lamella::benchmark
{

/// A sample that breaks.
struct Sample
{
  Lattice lattice;
  std::vector<std::uint8_t> phase; ///< 0 void, 1, 2
  std::vector<std::int32_t> grain;
  peridynamics::BondModel model;
};

/// Grains four times as stiff as the matrix between two platens; all bonds break at the same elongation.
inline Sample cemented(std::int64_t nodes, double saturation, std::int64_t grains, std::uint64_t seed)
{
  packing::PackingOptions o;
  o.count = grains;
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

/// Walls of softwood between two platens.
inline Sample wood(std::int64_t nodes, std::uint64_t seed)
{
  generators::SoftwoodOptions o;
  o.size = { nodes, nodes, 1 };
  o.spacing = 0.5e-6;
  o.seed = seed;
  const PhaseImage image = generators::softwood(o);
  Sample s{ image.lattice, {}, {}, {} };
  for (const std::uint8_t p : image.phase)
  {
    const std::string& name = image.phases.name(p);
    s.phase.push_back(name == "lumen" || name == "void" ? 0 : 1);
  }
  const std::int64_t ny = s.lattice.size[1];
  for (std::int64_t y = 0; y < ny; ++y)
    if (y < 4 || y >= ny - 4)
      std::fill_n(s.phase.begin() + y * s.lattice.size[0], s.lattice.size[0], std::uint8_t{ 1 });
  s.model.pairs[{ 1, 1 }].material = { .youngsModulus = 1e9, .criticalStretch = 1e-3 };
  return s;
}

/// The same with a middle lamella of the thickness of the horizon, four times less tough at the same modulus.
inline Sample woodWithLamella(std::int64_t nodes, std::uint64_t seed)
{
  generators::SoftwoodOptions o;
  o.size = { nodes, nodes, 1 };
  o.spacing = 0.5e-6;
  o.seed = seed;
  const generators::TissueTruth truth = generators::softwoodTruth(o);
  const micrograph::ContourLattice outlines = micrograph::contourLattice(truth.lumens, { .spacing = o.spacing });
  micrograph::LamellaOptions lamella;
  lamella.thickness = 3 * o.spacing;
  const micrograph::MiddleLamella found =
    micrograph::middleLamella(outlines, micrograph::wallDirections(truth.lumens, outlines), lamella);
  Sample s{ found.image.lattice, found.image.phase, {}, {} };
  const std::int64_t ny = s.lattice.size[1];
  for (std::int64_t y = 0; y < ny; ++y)
    if (y < 4 || y >= ny - 4)
      std::fill_n(s.phase.begin() + y * s.lattice.size[0], s.lattice.size[0], std::uint8_t{ 1 });
  const peridynamics::BondMaterial weak{ .youngsModulus = 1e9, .criticalStretch = 2.5e-4 };
  s.model.pairs[{ 1, 1 }].material = { .youngsModulus = 1e9, .criticalStretch = 1e-3 };
  s.model.pairs[{ 1, 2 }].material = weak;
  s.model.pairs[{ 2, 2 }].material = weak;
  return s;
}

/// kind aggregate, filled, wood or lamella; keys nx, seed, saturation, grains.
inline Sample sampleOf(const std::string& kind, const Keys& keys)
{
  const auto nodes = static_cast<std::int64_t>(number(keys, "nx", 128));
  const auto seed = static_cast<std::uint64_t>(number(keys, "seed", 1));
  if (kind == "wood")
    return wood(nodes, seed);
  if (kind == "lamella")
    return woodWithLamella(nodes, seed);
  if (kind != "aggregate" && kind != "filled")
    throw ParameterError("no sample '" + kind + "'", "aggregate, filled, wood or lamella");
  const double usual = std::max(20.0, std::floor(400.0 * static_cast<double>(nodes * nodes) / (512 * 512)));
  return cemented(nodes, kind == "filled" ? 1 : number(keys, "saturation", 0.5),
    static_cast<std::int64_t>(number(keys, "grains", usual)), seed);
}

} // namespace lamella::benchmark
