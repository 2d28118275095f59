#pragma once

#include "lattice/Phases.h"
#include "lattice/PictureError.h"
#include "lbm/DirectedLinks.h"
#include "lbm/Membranes.h"
#include "lbm/SteadyDiffusion.h"
#include "statistics/WindowError.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace lamella::lbm
{

/// One line of what a study did: the picture at one refinement in one direction, or what stands for it.
struct RefinementStep
{
  int refinement = 1;
  double value = 0; ///< effective conductivity along the axis; of several pictures the mean
  std::int64_t nodes = 0;
  int iterations = 0;
  double seconds = 0;   ///< wall, set-up included
  bool sampled = false; ///< solved on a centred window only, for the error estimate
  int parts = 1;        ///< windows that the picture is cut into along each axis, for the window error
  int every = 1;        ///< every so many pixels along each axis make a picture
  int pictures = 1;     ///< how many such pictures were solved
  double scatter = 0;   ///< standard deviation of their values
};

/// How the search for a target error ended.
enum class Target
{
  None,             ///< none was set
  Reached,          ///< the total error is below it
  PictureTooCoarse, ///< the picture's own error is not, and splitting pixels does not change it
  MemoryShort       ///< the refinement that would reach it takes more than the share of memory
};

/// What is asked of the machine for a target error, foreseen from two refinements.
struct TargetPlan
{
  int refinement = 1;
  std::int64_t nodes = 0;
  std::uint64_t bytes = 0;   ///< largest together, this machine's ranks
  std::uint64_t allowed = 0; ///< of the memory that was free at the start: memoryShare of it
  double seconds = 0;        ///< wall, all directions, from the time of the last refinement
};

struct DiffusionAnswer
{
  int axis = 0;
  SteadyResult result; ///< of the solve whose fields are handed out
  int refinement = 1;  ///< of that solve
  ErrorEstimate error;
  ConductivityDerivatives derivatives; ///< where they were asked for
  SurfaceDerivatives surfaces;         ///< likewise; per pixel of the picture, refined or not
  double membraneError = 0;            ///< relative, what the area of surfaces with membranes leaves; in `error`
  /// How far the picture speaks for its material; none where it was not asked for, or the picture is too small to be
  /// cut.
  std::optional<statistics::WindowError> window;
  Target target = Target::None;      ///< of the study: the same in every direction
  TargetPlan plan;                   ///< where target is MemoryShort: what it would take
  std::vector<RefinementStep> steps; ///< every solve, in order
};

struct StudyOptions
{
  SteadyOptions steady; ///< its `progress` gets the share of the whole study
  std::vector<int> axes{ 0, 1 };
  int refinement = 1;        ///< each pixel split into n × n (× n)
  bool estimateError = true; ///< of the lattice, from pixels split in two, and of the picture, from its subsamples
  /// Of the value by each conductivity (SteadyDiffusion::derivatives): a pass over the field.
  bool derivatives = false;
  bool surfaces = false; ///< by where surfaces lie (SteadyDiffusion::surfaceDerivatives): likewise
  /// Also solves the windows that the picture is cut into, halves and thirds of it along each axis, with insulated
  /// sides: how far its value may be from that of the material that it was cut out of.
  bool windowError = false;
  /// Relative, of the total error: refines from `refinement` until it is below, as far as the picture itself allows.
  std::optional<double> targetError;
  /// Part of the memory that is free at the start that a target error may take.
  double memoryShare = 0.5;
  /// Told, where there is a target, what it will take before it is taken; returning false cancels.
  std::function<bool(const TargetPlan&)> announce;
  /// Above this many nodes the solves for the estimate are done on a centred window of the picture instead of on all
  /// of it: pixels are a local matter, and the window's relative changes stand for those of the whole. What chance does
  /// is larger on a window, so the error is, too.
  std::int64_t estimateNodes = std::int64_t{ 1 } << 22;
  /// Of the picture's phases and nodes: conductivities along and across an axis, on Q1 where steady.stencil says so,
  /// else on D2Q9 (directedLinks()). A refined pixel's nodes have its axis. The study's diffusivities are then
  /// directed->larger().
  std::shared_ptr<const DirectedDiffusivity> directed;
  /// Resistances on the surfaces between phases; straight links. Each picture that is solved has them by its own
  /// steps (membraneIds()), so that coarser ones tell what steps do to them.
  std::vector<Membrane> membranes;
};

/// Called after the solve whose fields count, for each axis, before the solver goes: take value() and flux() here.
using FieldSink = std::function<void(
  const SteadyDiffusion& solver, const DiffusionAnswer& answer, const Lattice& lattice, const Block& block)>;

/// The whole job: refinement, solves along the axes, error estimate.
///
/// The error is that of the value against the material's (PictureError): the picture's subsamples are solved, which
/// takes about as long as the picture itself, and its pixels split in two for the part that is the lattice's. Where
/// nothing conducts in a subsample its value is 0. With membranes between phases whose surfaces do not lie along the
/// lattice also what membraneAreaError of them is worth. What this does not see: features below a pixel of which no
/// pixel tells, a segmentation that errs (`surfaces` tells what that does), and how far the picture speaks for more
/// material than it shows.
///
/// @param image        the whole picture, the same on every rank
/// @param diffusivity  one a phase id
/// @throws what requirePaths(), SteadyDiffusion and refine() throw. A target that is not reached is no error: `target`
/// says why
[[nodiscard]] std::vector<DiffusionAnswer> studyDiffusion(const PhaseImage& image, std::span<const double> diffusivity,
  const StudyOptions& options, MPI_Comm comm, const FieldSink& sink = {});

/// This rank's part of a picture that every rank holds.
[[nodiscard]] std::vector<std::uint8_t> blockOf(const PhaseImage& image, const Block& block);
/// The same of ids.
[[nodiscard]] std::vector<std::uint8_t> blockOf(
  const Lattice& lattice, std::span<const std::uint8_t> ids, const Block& block);

} // namespace lamella::lbm
