#pragma once

#include "cracks/CrackPaths.h"

namespace lamella::cracks
{

/// How far a crack has come: where it began, and the end of it that is farthest from there along its paths.
struct CrackTip
{
  bool found = false;
  Place start{};        ///< where it broke first; the end that is nearest to there, where the horizon reaches so far
  Place tip{};          ///< an end of the crack: in solid, at a void or at a side of the picture
  ChainEnd end{};       ///< which of these
  double extension = 0; ///< length of the crack from the one to the other [spacings]
};

/// The paths are those of findCrackPaths(). Of a crack that began at several places at once, that counts from which the
/// way is longest. Which bonds were first tells the place to a horizon, as far as bonds reach. A closed crack has no
/// end and no tip.
/// @param crack its number @param horizon [spacings]
/// Dijkstra's algorithm from each of its ends.
[[nodiscard]] CrackTip crackTip(const CrackPaths& paths, std::size_t crack, double horizon);

} // namespace lamella::cracks
