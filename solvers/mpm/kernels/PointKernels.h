#pragma once

#include <cstdint>

/// The fused step of material points with quadratic splines, lumped mass, APIC and the stress of their law: one pass
/// takes the velocities from the grid, moves and strains the points, and gives momentum and forces to the next grid.
/// Compiled once for every instruction set and chosen at run time; no standard library type crosses this interface.
///
/// In a cell splines are polynomials: the nodes' velocities become 3^Dim coefficients of powers of the place in the
/// cell, once a cell; a point evaluates them by Horner's scheme, and its gradients and affine velocities come from the
/// same coefficients. Backwards likewise: points add to moments, which become the nodes' sums once a cell.
///
/// In single precision a point's place is kept from the middle of its cell, and F less the identity: what a step adds
/// is a millionth of a box's length or less, which a float of that length would not notice. The nodes stay double, and
/// so do the coefficients until they are made: neighbours' velocities differ by little.
namespace lamella::mpm
{

/// Points of one cell: those whose splines begin at the same node.
struct PointCell
{
  std::int32_t base[3]; ///< first node along each axis, −1 … cells − 1
  std::uint32_t begin;  ///< first point; the end is the next cell's
};

/// An axis of the grid, before and after the step.
struct SweepAxis
{
  double lower[2];
  double spacing[2];
  double least; ///< coordinates [spacings] beyond which a point is reported as outside, after the step
  double most;
  double end;          ///< −½ … end: where all nodes that a point reaches are there
  std::int64_t stride; ///< from a node to the next, in nodes
};

/// Columns of the points' state in single precision.
template <int Dim>
struct StateColumns
{
  static constexpr int positions = 0;      ///< from the middle node of the cell's splines [spacings], −½ … ½
  static constexpr int deformations = Dim; ///< F − I
  static constexpr int masses = Dim + Dim * Dim; ///< over massScale
  static constexpr int volumes = masses + 1;     ///< at the start, over massScale
  static constexpr int axes = masses + 2;
  static constexpr int count = axes + Dim;
};

struct PointSweep
{
  double* columns; ///< of MaterialPoints; in single precision only the velocities are used
  std::int64_t pitch;
  /// Affine velocities C of the cells' points, column by column, and a vector's length to spare behind each; read where
  /// points only give to the grid.
  const double* affines;
  std::int64_t affinesPitch;
  std::int64_t affinesFirst; ///< point that they begin with
  bool forcesOnly;           ///< where points only give to the grid: neither mass nor the momentum that they have
  float* state;              ///< of the kernels in single precision
  std::int64_t statePitch;
  double massScale; ///< [kg]: of what is far below 1 no product may underflow
  const std::uint8_t* phase;
  const PointCell* cells;
  SweepAxis axis[3];
  const double* velocity; ///< of the nodes, four values each, the first unused
  double* momentum;       ///< mass and momentum of the nodes, added to
  double dt;
  double kick; ///< of the forces that are added
  bool keep;   ///< writes the points' velocities: nothing within the sweeps reads them
  bool look;   ///< finds the sums below: the stiffness,
  bool sums;   ///< and the energies too
  double gravity[3];
  const double* constants; ///< of the law, phase by phase
  bool onePhase;           ///< the constants are those of all phases

  // results, added to
  std::int64_t strays; ///< points outside the cell that they are listed under; they are dealt with one by one
  bool far;            ///< one of them by more than a cell
  bool outside;        ///< a point beyond `least` or `most`, or no longer finite
  double fastest;      ///< with `keep`: largest component of the points' affine velocities [1/s]
  // with `look`, where the whole step is made
  double kinetic;  ///< with `sums`: energy before the forces that are added, what affine velocities hold included
  double elastic;  ///< with `sums`: energy after the step
  double stiffest; ///< greatest stiffness over density after it [m²/s²], not below what it was; infinite
                   ///< where one is not finite or turned inside out
};

/// Cells first … last − 1.
using SweepCells = void (*)(PointSweep& sweep, std::int64_t first, std::int64_t last);

inline constexpr int lawKinds = 5;
inline constexpr int singleLawKinds = 3; ///< in single precision: the first ones of LawKind

struct PointKernels
{
  const char* name;
  int lanes; ///< points at once, twice as many in single precision
  int cells; ///< that they are of
  /// By precision (double, single), dimension − 2, law, [0] only giving to the grid, [1] the whole step; null where
  /// there is none.
  SweepCells sweep[2][2][lawKinds][2];
};

/// The fastest that this processor can run.
[[nodiscard]] const PointKernels& pointKernels();

} // namespace lamella::mpm
