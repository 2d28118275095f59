#pragma once

#include "lbm/DiffusionStudy.h"
#include "lbm/LinkTable.h"
#include "outlines/CoarserOutlines.h"
#include "outlines/ContourLattice.h"

#include <functional>
#include <span>
#include <vector>

/// Steady diffusion on lattices made from outlines, whose links know exactly where they cross from wall to lumen.
namespace lamella::lbm
{

/// Conductivities of the links of a lattice made from outlines (`lines` = 1, `across` = true), for flux along an axis.
///
/// A link that no outline passes carries the harmonic mean of the phases at its ends. One that is cut carries the
/// harmonic mean along its own line, unless the better conductor of the two leads across the box there, from face to
/// face along the axis: then the arithmetic mean across the link, half-way. (Walls do, but where a lumen parts them
/// from side to side.) So where walls hang together and lumens do
/// not, which is tissue, lumen and wall are in series where the lumen conducts better and in parallel where it conducts
/// worse, as they are along the field lines that matter, which lie in the worse conductor in the first case and in the
/// better one in the second. Each is the other's dual (Keller's theorem turns one into the other with the lattice of
/// the links' faces), so both err alike: on arrays of disks at 128 nodes by 0.07 % at worst up to an area fraction of
/// one half, where the mean over the face of harmonic means along errs by 1.4 % (docs/benchmarks/contours.md). Layers
/// along the axis and across it are exact.
///
/// @param lattice its phases may be more than lumen and wall; the lumen is phase 0
/// @param conductivity one a phase, ≥ 0
/// @throws ParameterError for a lattice without these shares, or conductivities that are negative, not finite or too
/// few
[[nodiscard]] LinkTable linksOf(
  const micrograph::ContourLattice& lattice, std::span<const double> conductivity, int axis);

/// What the solve on one lattice gave.
struct ContourStep
{
  double spacing = 0; ///< along x [m]
  double value = 0;   ///< effective conductivity along the axis
  std::int64_t nodes = 0;
  int iterations = 0;
  double seconds = 0; ///< wall, lattice included
};

/// Error that a picture's pixels leave in the value that its outlines have, from those of every second and every third
/// pixel (outlines/CoarserOutlines.h): outlineDeviations() times the standard deviation that follows from the squared
/// mean of their differences from `value`. The area of a lumen in a mask errs like the pixel to the power 3/2, and so,
/// as measured, do the values; then values of pixels n times as large, which share every n² th pixel with the picture,
/// differ from its own with n³ − 1 times the variance of its own error. Of two strides the finer has the weight 3/4.
/// @param value what the picture's own outlines conduct on the same lattice, > 0
/// @return relative to `value`; NaN where there are fewer than two values of the finest stride
/// How often it holds: docs/benchmarks/contours.md.
[[nodiscard]] double outlineError(double value, std::span<const SubsampleValues> coarser, double deviations);

/// How many standard deviations a picture's error bar is long: 1.4 + 6/w², where lumens or walls are w ≥ 1 pixels wide
/// (micrograph::leastWidth()); where they are narrow, pixels twice and three times as large tell too little. Of shares
/// 1: every second pixel of them knows less of an outline than a picture of larger pixels would. Chosen on pictures
/// whose truth is known (docs/benchmarks/contours.md).
/// @param pixel [m], > 0
/// @param shares the picture has each pixel's share of lumen, not a mask
[[nodiscard]] double outlineDeviations(const micrograph::ContourSet& contours, double pixel, bool shares);

struct ContourAnswer
{
  int axis = 0;
  ContourStep coarse;
  ContourStep fine;
  double value = 0;        ///< 2 fine − coarse: Richardson's, for an error that halves with the spacing
  double latticeError = 0; ///< of `value`, relative to it: of the lattices, see studyContours()
  /// Of `value`, relative to it: of the picture that the outlines are from, see outlineError(); 0 where they are taken
  /// as they are, NaN where nothing can be said.
  double pictureError = 0;
  double error = 0;                     ///< the root of the sum of both squares; NaN as the picture's
  std::vector<ContourStep> steps;       ///< all lattices, the coarsest first; `coarse` and `fine` are the last two
  std::vector<SubsampleValues> coarser; ///< of the outlines from coarser pictures, on the first coarse lattice
  double moved = 0;                     ///< of `moved` outlines, relative to those as they are; 0 where there are none
  double sealed = 0;                    ///< likewise of `sealed` ones
  double seconds = 0;                   ///< wall, of all lattices, coarser pictures included
  SteadyResult result;
};

/// What a target for the error takes, as seen from two lattices.
struct ContourPlan
{
  double target = 0;
  double error = 0;        ///< the largest of the axes, now
  double pictureError = 0; ///< the largest that is known; not below the target: only a finer picture reaches it
  std::int64_t nodes = 0;  ///< of the finest lattice that it should take, the error halving with the spacing
};

struct ContourStudyOptions
{
  SteadyOptions steady; ///< D2Q5, insulated sides; `links` is set here
  double spacing = 0;   ///< of the finer lattice [m]; of the first such one where there is a target
  /// The spacing is halved until `error` of every axis is at most this; 0: the lattices above only. Where the picture's
  /// error is larger, until the lattice's is at most half of it, which no halving makes much better.
  double targetError = 0;
  std::int64_t mostNodes = 0;                   ///< no lattice of more than these for the target's sake; 0: no bound
  std::function<void(const ContourPlan&)> plan; ///< told once, before the first lattice for the target's sake
  std::vector<int> axes{ 0, 1 };
  std::vector<double> conductivity; ///< one a phase: lumen, wall, and what `phases` adds
  /// Gives walls other phases, a middle lamella for instance, or empty. The outlines are stretched along y.
  std::function<void(const micrograph::FittedContours&, micrograph::ContourLattice&)> phases;
  /// Outlines of the same material from coarser pictures, for the picture's error; empty: the outlines are taken as
  /// they are.
  std::vector<micrograph::CoarserOutlines> coarser;
  double pixel = 0;    ///< of the picture [m]; with `coarser` > 0
  bool shares = false; ///< the picture has each pixel's share of lumen, not a mask
  /// The outlines moved by as much as is in doubt about where walls begin (micrograph::movedOutlines()), of a picture
  /// that was segmented: what it changes is added, squared, to the picture's error. Empty: no doubt.
  micrograph::ContourSet moved;
  /// The outlines with what wall may lie along the border of their picture (micrograph::sealedOutlines()); added
  /// likewise. Empty: none may.
  micrograph::ContourSet sealed;
};

/// Effective conductivity of the whole of a picture of outlines, at a spacing, twice and four times that, and what
/// follows for a spacing of zero. Each lattice covers exactly the picture (micrograph::fitContours()), in numbers of
/// nodes of which each is twice the one before, so that cells are longer or shorter along y by a part in twice the
/// number of their rows; links conduct by their true lengths and widths.
///
/// The lattice's error bar is the change from the finer value to the extrapolated one, |fine − coarse|, or a third of
/// the change before that one where that is larger, since two lattices may agree by chance. The picture's is
/// outlineError() of `coarser`. How often they hold: docs/benchmarks/contours.md. With a target the last three lattices
/// count; each halving takes about four times as long and as much memory as the last, and halves the lattice's error.
/// @throws ParameterError for a target that is negative or not finite, or coarser pictures and no pixel; what
/// contourLattice(), linksOf() and SteadyDiffusion throw
[[nodiscard]] std::vector<ContourAnswer> studyContours(
  const micrograph::ContourSet& contours, const ContourStudyOptions& options, MPI_Comm comm);

} // namespace lamella::lbm
