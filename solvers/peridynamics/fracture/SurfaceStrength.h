#pragma once

#include "peridynamics/fracture/FractureStudy.h"

#include <cstdint>
#include <span>

/// What a doubt about where a sample's surfaces lie does to its strength, by pulling it twice more. Rough: the weakest
/// place decides, and only what is near to it.
namespace lamella::peridynamics
{

/// Peak stresses [Pa] of a sample whose solid has grown into its voids, and of one that has shrunk.
struct SurfaceStrengths
{
  double step = 0; ///< by which the surfaces moved [nodes]
  double grown = 0;
  double shrunk = 0;
};

/// Nodes that the smooth surface through the labels (lattice/LabelShares.h) passes change sides. Those at a surface
/// then hold more of the solid, or less, by what their voxel gains where the surface moves by its normal
/// (lattice/SurfaceMotions.h), in halves. A bond is stiffer by the mean of its two ends' gains, and breaks where it
/// did; over twice the share of energy that a node in a flat surface has of one inside, under a strain along the
/// surface: so a straight wall carries as much more as it is thicker. Surfaces between two solids stay. Each runs until
/// its stress has fallen to nine tenths of its peak, and writes nothing. Collective: the ranks pull together, as they
/// pulled the sample.
///
/// @param phase, grain of the whole sample, on every rank
/// @param options as of the sample
/// @param doubt how far surfaces may lie off on the mean [nodes]: the step, within a third of a node
/// @throws ParameterError for a sample without a surface; what studyFracture() throws
[[nodiscard]] SurfaceStrengths surfaceStrengths(const BondModel& model, const Lattice& lattice,
  std::span<const std::uint8_t> phase, std::span<const std::int32_t> grain, const FractureStudyOptions& options,
  double doubt, const Communicator& comm = Communicator());

/// At its weakest place a surface lies off by more than on the mean of all: by so many times. Found on three seeds:
/// docs/benchmarks/segmentation-error.md.
inline constexpr double weakestPlace = 3;

/// How far the strength may be off [Pa], half of an interval: the larger change, in proportion to weakestPlace × doubt.
[[nodiscard]] double strengthDoubt(double peak, const SurfaceStrengths& moved, double doubt) noexcept;

} // namespace lamella::peridynamics
