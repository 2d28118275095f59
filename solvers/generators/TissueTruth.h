#pragma once

#include "generators/CellGeometry.h"
#include "generators/Generators.h"
#include "outlines/Contour.h"

#include <vector>

/// The geometry of a generated tissue as vectors: what softwood() and hardwood() put on a lattice, known at any
/// resolution. For judging what is made of its pictures.
namespace lamella::generators
{

struct TissueTruth
{
  /// Lumens: all within `tolerance` of the exact outline. Together they leave the solid fraction asked for, to 1e-6.
  micrograph::ContourSet lumens;
  /// The cells out to the middle of their walls, the centre lines of the compound middle lamella, numbered as the
  /// lumens. Neighbouring cells share them to 1 % of a cell's diameter where rays bend.
  micrograph::ContourSet cells;
  /// What cell `number` of the contours is: kinds[number − 1]. Cells of which the picture shows wall alone have no
  /// lumen.
  std::vector<CellKind> kinds;
  /// Thickness of the wall between two usual cells at the start of the ring [m].
  double doubleWall = 0;
};

/// @param tolerance largest distance of a chord from the lumen it stands for [m]
/// @throws ParameterError as softwood(), for three dimensions, and for a tolerance outside 1e-10 … 1e-6 m
/// About 1 s for 1000 cells: the one factor on all walls is found by tracing all lumens some ten times.
[[nodiscard]] TissueTruth softwoodTruth(const SoftwoodOptions& options, double tolerance = 2e-9);
/// @throws ParameterError as hardwood(), and for a tolerance outside 1e-10 … 1e-6 m
[[nodiscard]] TissueTruth hardwoodTruth(const HardwoodOptions& options, double tolerance = 2e-9);

} // namespace lamella::generators
