#pragma once

#include "../tests/BreakableSamples.h"
#include "Keys.h"

#include "generators/TissueTruth.h"
#include "outlines/MiddleLamella.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

namespace lamella::benchmark
{

using breakable::cemented;
using breakable::Sample;
using breakable::wood;

/// Walls of softwood with a middle lamella of the thickness of the horizon, four times less tough at the same modulus.
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
  breakable::addPlatens(s.phase, s.lattice);
  const peridynamics::BondMaterial weak{ .youngsModulus = 1e9, .criticalStretch = 2.5e-4 };
  s.model.pairs[{ 1, 1 }].material = { .youngsModulus = 1e9, .criticalStretch = 1e-3 };
  s.model.pairs[{ 1, 2 }].material = weak;
  s.model.pairs[{ 2, 2 }].material = weak;
  return s;
}

/// kind aggregate, filled, wood or lamella; keys nx, seed, saturation, grains, dimension.
inline Sample sampleOf(const std::string& kind, const Keys& keys)
{
  const auto nodes = static_cast<std::int64_t>(number(keys, "nx", 128));
  const auto seed = static_cast<std::uint64_t>(number(keys, "seed", 1));
  if (kind == "wood")
    return wood(nodes, seed, 0.5e-6);
  if (kind == "lamella")
    return woodWithLamella(nodes, seed);
  if (kind != "aggregate" && kind != "filled")
    throw ParameterError("no sample '" + kind + "'", "aggregate, filled, wood or lamella");
  const double usual = std::max(20.0, std::floor(400.0 * static_cast<double>(nodes * nodes) / (512 * 512)));
  return cemented({ .nodes = nodes,
    .saturation = kind == "filled" ? 1 : number(keys, "saturation", 0.5),
    .grains = static_cast<std::int64_t>(number(keys, "grains", usual)),
    .seed = seed,
    .dimension = static_cast<int>(number(keys, "dimension", 2)) });
}

} // namespace lamella::benchmark
