#pragma once

#include "cracks/CrackEdges.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lamella::cracks
{

/// The face of two voxels between which a crack runs, and what the broken bonds there say of it.
struct CrackFace
{
  CrackEdge pair;
  std::array<std::int64_t, 4> corners{}; ///< points of the surface, in order around the face
  std::size_t crack = 0;                 ///< number from 0, the one with most faces first
  std::int64_t event = 0;                ///< when half of the bonds there were broken
  double when = 0;
  std::array<std::uint8_t, 2> phases{}; ///< of the two nodes, the lesser first
  bool betweenGrains = false;
};

/// Cracks in a volume, as stairs: faces of voxels that hang together by their edges.
struct CrackSurface
{
  std::vector<std::array<double, 3>> points; ///< corners of voxels, in node numbers
  std::vector<CrackFace> faces;              ///< by crack, then in the order of memory
  std::size_t cracks = 0;
  std::int64_t leftOutCracks = 0; ///< of fewer faces than the least
  std::int64_t leftOutFaces = 0;

  /// The points between which each point may be smoothed: the ends of its edges; for a point of a rim (or of a line
  /// where surfaces meet) those along that, and none where it ends or forks or leaves a side of the lattice. From
  /// first[i] to first[i + 1].
  std::vector<std::int64_t> first;
  std::vector<std::int64_t> neighbours;
  std::vector<char> onRim;           ///< or on such a line
  std::vector<std::uint8_t> onSides; ///< of the lattice: a bit an axis
};

/// @param bonds as canonical() gives them
/// @param phase, solid one a node; may be empty: then phases are those of the bonds, and all nodes are solid
/// @param leastFaces cracks of fewer are left out
/// @throws as crackEdges(); InputError for arrays of the wrong length
[[nodiscard]] CrackSurface findCrackSurface(const Lattice& lattice, double horizon, std::span<const CutBond> bonds,
  std::span<const std::uint8_t> phase = {}, std::span<const std::uint8_t> solid = {}, double leastFaces = 0);

} // namespace lamella::cracks
