#pragma once

#include "lbm/DiffusionStudy.h"
#include "lbm/LinkTable.h"
#include "micrograph/ContourLattice.h"

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
  double spacing = 0; ///< [m]
  double value = 0;   ///< effective conductivity along the axis
  std::int64_t nodes = 0;
  int iterations = 0;
  double seconds = 0; ///< wall, lattice included
};

struct ContourAnswer
{
  int axis = 0;
  ContourStep coarse;
  ContourStep fine;
  double value = 0;               ///< 2 fine − coarse: Richardson's, for an error that halves with the spacing
  double error = 0;               ///< |fine − coarse|: of `value`, relative to it (see studyContours())
  std::vector<ContourStep> steps; ///< all lattices, the coarsest first; `coarse` and `fine` are the last two
  SteadyResult result;
};

struct ContourStudyOptions
{
  SteadyOptions steady; ///< D2Q5, insulated sides; `links` is set here
  double spacing = 0;   ///< of the finer lattice [m]; of the first such one where there is a target
  /// The spacing is halved until `error` of every axis is at most this; 0: the two lattices only.
  double targetError = 0;
  std::int64_t mostNodes = 0; ///< no lattice of more than these for the target's sake; 0: no bound
  std::vector<int> axes{ 0, 1 };
  std::vector<double> conductivity; ///< one a phase: lumen, wall, and what `phases` adds
  /// Gives walls other phases, a middle lamella for instance, or empty.
  std::function<void(micrograph::ContourLattice&)> phases;
};

/// Called after the finer solve of an axis, before the solver goes: take value() and flux() here.
using ContourSink = std::function<void(const SteadyDiffusion& solver, const ContourAnswer& answer,
  const micrograph::ContourLattice& lattice, const Block& block)>;

/// Effective conductivity of a picture of outlines at a spacing and at twice that, and what follows for a spacing of
/// zero. The error bar is the change from the finer value to the extrapolated one; on fewer than 64² nodes, where two
/// lattices may agree by chance, at least half the change before that one, from a lattice coarser still. On arrays of
/// disks (five conductivities, four area fractions, 64 and 128 nodes) it holds 18 errors of 20 and is 2.7 times the
/// error in the median. With a target the last pair of lattices counts; each halving takes about four times as long and
/// as much memory as the last, and halves the error bar.
/// @param sink with a target it is called for every pair
/// @throws ParameterError for a target that is negative or not finite; what contourLattice(), linksOf() and
/// SteadyDiffusion throw
[[nodiscard]] std::vector<ContourAnswer> studyContours(const micrograph::ContourSet& contours,
  const ContourStudyOptions& options, MPI_Comm comm, const ContourSink& sink = {});

} // namespace lamella::lbm
