#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace lamella::micrograph
{

/// Vessels told from fibres.
struct LumenClasses
{
  bool two = false;         ///< there are two classes; else nobody is a vessel
  std::vector<bool> vessel; ///< by lumen
  std::size_t vessels = 0;
  double threshold = 0;    ///< the size from which on a lumen is a vessel; 0 with one class
  double separability = 0; ///< Ashman's D: the distance of the two means over the mean width; 2 and more is two classes
  double ratio = 1;        ///< of the two classes' geometric mean sizes
};

/// Tells large lumens from small ones by their sizes alone, areas as a rule, in any unit.
///
/// Two Gaussians are fitted to the logarithm of the size (maximum likelihood by expectation maximisation, started from
/// Otsu's split and from the widest gap; of the two what is clean by the following goes first). There are two classes
/// where the two explain the sizes better than one does by more than 10 in the Bayesian information criterion (Schwarz
/// 1978), they are clean apart (Ashman's D > 2, Ashman et al. 1994), the larger class has on the mean four times the
/// area, twice the diameter, of the smaller, and it is the smaller in number, of three lumens at least: vessels stand
/// among fibres, not the other way round.
///
/// Latewood is flattened earlywood, not fibres: to keep it in the class of its earlywood give the area of the circle
/// over each lumen's longest diameter instead of its own.
/// @throws ParameterError for a size that is not positive and finite
[[nodiscard]] LumenClasses classifyLumens(std::span<const double> sizes);

/// Axes of a lumen, in any unit.
struct LumenExtent
{
  double length = 0;   ///< its longest diameter, or the major axis of the ellipse of the same second moments
  double width = 0;    ///< across it
  bool whole = true;   ///< not cut by the picture's border
  double solidity = 1; ///< its area over that of its convex hull
};

/// Vessels among lumens of any kind: the classes are those of whole lumens by the circles over their lengths. Lumens
/// more than three times as long as wide, cells of rays among them, are neither vessels nor fibres, unless most are.
/// What the border cuts is a vessel where the part that is seen is long enough for one; where the cut made it slender,
/// its ellipse must have the area of a vessel as well. Ragged lumens (a solidity below 0.75) are tears or run together,
/// and what the border cuts and is more than three times as large as any whole lumen is slide beside the tissue: both
/// are no vessels and say nothing of the classes.
/// @throws ParameterError for a length that is not positive and finite
[[nodiscard]] LumenClasses tellVessels(std::span<const LumenExtent> lumens);

} // namespace lamella::micrograph
