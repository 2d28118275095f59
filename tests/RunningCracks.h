#pragma once

#include "lattice/Lattice.h"
#include "peridynamics/fracture/Dynamics.h"

#include <array>
#include <span>
#include <vector>

/// What broken bonds say of cracks in the plane that run through bonds in motion: where, how fast, at which angle.
namespace lamella::peridynamics
{

using PlanePoint = std::array<double, 2>; ///< [m]

/// The middle of a bond, undeformed [m].
[[nodiscard]] PlanePoint middleOf(const Bond& bond, const Stencil& stencil, const Lattice& lattice);

/// The bond that a mirror halfway up the lattice (across y) shows.
[[nodiscard]] Bond mirrored(const Bond& bond, const Stencil& stencil, const Lattice& lattice);

/// How far cracks are symmetric across y.
struct MirrorSymmetry
{
  double share = 1;    ///< of the broken bonds whose mirror image broke too
  double sameStep = 1; ///< of them those that broke in the same step
  double until = 0;    ///< time of the last step before the first bond without its image in the same step [s]
};
[[nodiscard]] MirrorSymmetry mirrorSymmetry(
  std::span<const DynamicBreak> broken, const Stencil& stencil, const Lattice& lattice);

/// A straight line through points by least squares of the distances from it.
struct FittedLine
{
  PlanePoint centre{};
  double angle = 0;     ///< from x [rad], −π/2 … π/2
  double deviation = 0; ///< root mean square distance from it [m]
  double length = 0;    ///< from the first point to the last along it [m]
};
/// @throws ParameterError: fewer than two points
[[nodiscard]] FittedLine fitLine(std::span<const PlanePoint> points);

struct TipPoint
{
  double time = 0;     ///< [s]
  double position = 0; ///< [m]
};

/// How far cracks have come: the largest projection on a direction of the middles of what broke so far, whenever it
/// grows. Bonds that broke next to nothing else (no other within `reach` so far) are not of a crack.
/// @param direction need not be of length 1
[[nodiscard]] std::vector<TipPoint> tipAdvance(std::span<const DynamicBreak> broken, const Stencil& stencil,
  const Lattice& lattice, const PlanePoint& direction, double reach);

/// Speeds of a tip: slopes of straight lines through its positions in windows of time, one after the other [m/s], at
/// the windows' middles. A window without two positions counts as 0.
struct TipSpeed
{
  double time = 0;  ///< [s]
  double speed = 0; ///< [m/s]
};
[[nodiscard]] std::vector<TipSpeed> tipSpeeds(std::span<const TipPoint> tip, double window);

/// Cracks that a column of the lattice meets: groups of the middles of broken bonds, more than `gap` apart along y,
/// each with at least a quarter of the bonds that a crack across y takes on that width.
struct ColumnCracks
{
  double x = 0;                ///< middle of the column [m]
  std::vector<double> heights; ///< mean y of each [m], upwards
};
[[nodiscard]] std::vector<ColumnCracks> cracksByColumn(
  std::span<const DynamicBreak> broken, const Stencil& stencil, const Lattice& lattice, double width, double gap);

/// Speed of Rayleigh's waves [m/s], that of shear waves times (0.862 + 1.14 ν)/(1 + ν): within 0.5 %.
[[nodiscard]] double rayleighSpeed(double youngsModulus, double poissonsRatio, double density) noexcept;

} // namespace lamella::peridynamics
