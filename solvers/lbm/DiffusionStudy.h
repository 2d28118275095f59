#pragma once

#include "lattice/Phases.h"
#include "lbm/DirectedLinks.h"
#include "lbm/SteadyDiffusion.h"

#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace lamella::lbm
{

/// One solve of a study: the picture at one refinement, in one direction.
struct RefinementStep
{
  int refinement = 1;
  double value = 0; ///< effective conductivity along the axis
  std::int64_t nodes = 0;
  int iterations = 0;
  double seconds = 0;   ///< wall, set-up included
  bool sampled = false; ///< solved on a centred window only, for the error estimate
};

/// What is known about the error of an effective conductivity from two or more refinements of one picture.
struct ErrorEstimate
{
  double relative = std::numeric_limits<double>::quiet_NaN(); ///< of the finest full solve; NaN: could not be had
  double extrapolated = std::numeric_limits<double>::quiet_NaN();
  double order = 1; ///< order of convergence used: 1, or observed from three refinements (between 1 and 2)
};

/// Error of `coarse` and `fine`, solved with a ratio of 2 in spacing, when the error falls like spacing^order:
/// the fine one errs by |fine − coarse| / (2^order − 1), the coarse one by that and |fine − coarse|. Pixels converge
/// with an order between 1 and 2, whatever their corners do; order 1 is the cautious choice.
[[nodiscard]] double richardsonError(double coarse, double fine, double order, bool ofFine);

struct DiffusionAnswer
{
  int axis = 0;
  SteadyResult result; ///< of the solve whose fields are handed out
  ErrorEstimate error;
  std::vector<RefinementStep> steps; ///< every solve, in order
};

struct StudyOptions
{
  SteadyOptions steady;
  std::vector<int> axes{ 0, 1 };
  int refinement = 1;                ///< each pixel split into n × n (× n)
  bool estimateError = true;         ///< one more solve at twice the refinement
  std::optional<double> targetError; ///< relative; refines by 2 from `refinement` until the estimate is below
  /// Above this many nodes the solve for the estimate is done on a centred window of the picture at both refinements
  /// instead of on all of it: the lattice's error is a local matter, and the window's relative change stands for it.
  std::int64_t estimateNodes = std::int64_t{ 1 } << 22;
  /// Of the picture's phases and nodes: conductivities along and across an axis (directedLinks()), on D2Q9. A refined
  /// pixel's nodes have its axis. The study's diffusivities are then directed->larger().
  std::shared_ptr<const DirectedDiffusivity> directed;
};

/// Called after the solve whose fields count, for each axis, before the solver goes: take value() and flux() here.
using FieldSink = std::function<void(
  const SteadyDiffusion& solver, const DiffusionAnswer& answer, const Lattice& lattice, const Block& block)>;

/// The whole job: refinement, solves along the axes, error estimate.
///
/// @param image        the whole picture, the same on every rank
/// @param diffusivity  one a phase id
/// @throws what SteadyDiffusion and refine() throw; ParameterError when the target error needs more memory than there
/// is
[[nodiscard]] std::vector<DiffusionAnswer> studyDiffusion(const PhaseImage& image, std::span<const double> diffusivity,
  const StudyOptions& options, MPI_Comm comm, const FieldSink& sink = {});

/// This rank's part of a picture that every rank holds.
[[nodiscard]] std::vector<std::uint8_t> blockOf(const PhaseImage& image, const Block& block);

} // namespace lamella::lbm
