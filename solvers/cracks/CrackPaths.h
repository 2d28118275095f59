#pragma once

#include "cracks/BondCount.h"
#include "cracks/CrackCurves.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace lamella::cracks
{

struct CrackPathOptions
{
  /// Cracks of less are left out, unless they lead from a void or a side of the picture to another place there and are
  /// longer than two spacings: what parts a thin wall is short. Below 0: the horizon. [spacings]
  double minimumLength = -1;
  /// Chains from a junction to a tip of no more are taken away. Below 0: twice the horizon. [spacings]
  double spurLength = -1;
};

/// What bonds say of a point of a path.
struct CrackPoint
{
  Place place{};
  std::int64_t event = 0; ///< when half of the bonds there were broken
  double when = 0;
  std::array<std::uint8_t, 2> phases{}; ///< of the two nodes that the crack parts, the lesser first
  bool betweenGrains = false;
  double opening = 0; ///< how far these two went apart, across the path [m]; by openings()
  double sliding = 0; ///< and along it, either way [m]
};

/// Length within a pair of phases.
struct PairShare
{
  std::array<std::uint8_t, 2> phases{};
  bool betweenGrains = false;
  double length = 0;      ///< [spacings]
  std::int64_t bonds = 0; ///< broken, with these ends
  double counted = 0;     ///< BondCount::size() of them
};

/// How a set of segments lies.
struct Orientation
{
  double angle = 0;  ///< axial mean, weighted by length, to x [rad], −π/2 < angle ≤ π/2
  double spread = 0; ///< axial standard deviation √(−ln R/2) of Fisher, R = |Σ l exp(2iθ)|/Σ l [rad]
};

/// A line without a junction but at its ends.
struct CrackPath
{
  std::vector<CrackPoint> points; ///< closed: the last is the first
  std::vector<CrackEdge> edges;   ///< points[1 + k] lies on edges[k]
  std::array<ChainEnd, 2> ends{};
  int crack = 0;            ///< number of the crack that it belongs to, from 0
  double length = 0;        ///< [spacings]
  double chord = 0;         ///< between its ends; of a closed one 0
  double expectedBonds = 0; ///< that a crack of this line cuts in a sample without voids and sides
  std::int64_t bonds = 0;   ///< broken bonds that cross it
  Orientation orientation{};
  std::array<std::int64_t, 2> events{}; ///< first and last of its bonds
  std::array<double, 2> when{};
  std::vector<PairShare> pairs; ///< in order of phases

  /// The length that the number of its broken bonds stands for (Cauchy and Crofton, with the path's own directions).
  [[nodiscard]] double countedLength() const noexcept
  {
    return expectedBonds > 0 ? length * static_cast<double>(bonds) / expectedBonds : 0;
  }
  [[nodiscard]] double tortuosity() const noexcept; ///< NaN of a closed one
};

/// Paths that hang together.
struct Crack
{
  std::vector<std::size_t> paths;
  double length = 0; ///< [spacings]
  std::array<Place, 2> extent{ Place{ 1e300, 1e300 }, Place{ -1e300, -1e300 } };
  std::array<bool, 2> through{}; ///< along x, y: from one side of the picture to the other
};

/// What was left out of the paths.
struct LeftOut
{
  std::int64_t cracks = 0; ///< shorter than the minimum
  double length = 0;       ///< of these [spacings]
  std::int64_t spurs = 0;
  std::int64_t islands = 0; ///< crushed pieces that were joined to a side
  std::int64_t bonds = 0;   ///< broken bonds that no path crosses
};

struct CrackPaths
{
  std::vector<CrackPath> paths; ///< the longest first
  std::vector<Crack> cracks;    ///< the same
  std::vector<PairShare> pairs; ///< of all paths together
  double length = 0;            ///< of all [spacings]
  Orientation orientation{};
  LeftOut leftOut{};
};

/// Finds cracks in a picture.
/// @param bonds as canonical() gives them
/// @param phase, solid one a node; may be empty: then phases are those of the bonds, and all nodes are solid
/// @throws as crackEdges(); InputError for arrays of the wrong length
[[nodiscard]] CrackPaths findCrackPaths(const Lattice& lattice, double horizon, std::span<const CutBond> bonds,
  std::span<const std::uint8_t> phase = {}, std::span<const std::uint8_t> solid = {}, CrackPathOptions options = {});

/// In an order that does not depend on who found them: by event, then by place; each bond once, told from the end from
/// which its last nonzero step is positive.
[[nodiscard]] std::vector<CutBond> canonical(std::vector<CutBond> bonds);

/// Broken bonds by pair of phases, in order of phases. Lengths are 0.
[[nodiscard]] std::vector<PairShare> bondsByPair(std::span<const CutBond> bonds, const BondCount& count);

/// Fills in the openings of all points.
/// @param displacement three numbers a node [m]
void openings(CrackPaths& paths, const Lattice& lattice, std::span<const double> displacement);

/// How long the paths were after each event at which they grew.
struct Growth
{
  std::int64_t event = 0;
  double when = 0;
  double length = 0; ///< [spacings]
  double rate = 0;   ///< of it, over what grew within `reach` before and after; NaN where that took no time
};
/// @param crack all when it is below 0
[[nodiscard]] std::vector<Growth> growth(const CrackPaths& paths, int crack = -1, double reach = 10);

} // namespace lamella::cracks
