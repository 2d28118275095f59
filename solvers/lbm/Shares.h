#pragma once

#include "lbm/DiffusionStudy.h"
#include "lbm/SteadyDiffusion.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lamella::lbm
{

/// How a link conducts that a surface crosses.
enum class AcrossSurface
{
  Series,  ///< both phases one after the other, along the link: where flux meets the surface head-on
  Parallel ///< side by side, across it: where flux runs along the surface
};

/// Where the phase that conducts better leads from face to face, flux runs in it along surfaces: Parallel; else it has
/// to cross the other one and meets surfaces head-on: Series. (Grains that touch at points lead so on a lattice only:
/// studyShares() finds out.)
[[nodiscard]] AcrossSurface ruleFor(bool betterPercolates) noexcept;

/// Links of a picture of two phases whose nodes tell how much of them is in the second one: `share` by id, in 0 … 1.
///
/// In series, the part of a link in the second phase is s = a + b − ½ within 0 and 1, which is exact for a flat surface
/// across the link: the conductance is 1 / (s / k₁ + (1 − s) / k₀). In parallel it is s = (a + b) / 2, the share of the
/// box around the link, and the conductance s k₁ + (1 − s) k₀. A node that does not conduct itself has no links, but
/// for one id that may keep them: nodes of the phase that insulates in a corner of the surface, by which the nodes of
/// both sides of the corner conduct to each other.
///
/// @param corner that id, or −1; it conducts a millionth of the other phase
/// @throws ParameterError shares outside 0 … 1, conductivities that are not finite or below 0
[[nodiscard]] PairTable shareLinks(
  std::span<const double> share, double first, double second, AcrossSurface rule, int corner = -1);

/// The whole job for a picture whose ids tell shares: solves along options.axes with the rule that suits each, and with
/// options.estimateError those of twice the spacing, whose nodes hold the mean shares of 2 × 2 (× 2); where a side is
/// odd, of all but its last nodes.
///
/// The errors of such values have a part in proportion to the spacing h and one to h². error.extrapolated is without
/// both, from the values of h, 2h and 4h: fine + (fine − coarse) (5 − r)/3, r = (coarse − coarser)/(fine − coarse)
/// within 2 (the first part alone) and 4 (the second). Where half as many nodes are odd or fewer than 6 on some side,
/// there is no 4h: 2 × fine − coarse. error.relative is 1.5 |fine − coarse|, or a third of the change before that one
/// where it is more; of lattice and picture together, told as the lattice's. How often it holds:
/// docs/benchmarks/volumes.md.
///
/// Where the better phase leads from face to face, both rules are tried with 2h and 4h, and Series is taken if it
/// changes less: less than 0.7 times as much, or than 0.25 times where nodes that are filled lead from face to face,
/// too. Where it is taken, or they do not, the error is at least 0.75 times what the rules differ by with 2h, and 1.5
/// times that where more than 30 % of the nodes have some of both phases.
///
/// @param image  the whole picture, the same on every rank  @param share by id
/// @param options refinement, targetError, directed and steady.links are not used
/// @throws what shareLinks() and SteadyDiffusion throw
[[nodiscard]] std::vector<DiffusionAnswer> studyShares(const PhaseImage& image, std::span<const double> share,
  double first, double second, const StudyOptions& options, MPI_Comm comm, const FieldSink& sink = {});

struct LabelAnswers
{
  std::vector<DiffusionAnswer> answers; ///< by axis
  double second = 0;                    ///< the second phase's part of the picture, by the shares
};

/// The whole job for labels of two phases: studyShares() of what labelShares() makes of them. Periodic sides wrap.
///
/// error.picture is what the labels may err by, added to what shares may: twice the spacing once more, from labels of
/// every second node, smoothed, beginning at two nodes; 0.75 times the root of the mean square of how far these are
/// from the mean shares of all labels. How often both hold: docs/benchmarks/volumes.md.
///
/// @param labels the whole picture, the same on every rank; ids other than `second` are the first phase
/// @param conductivity of the first and of the second phase
/// @param options as of studyShares()
/// @throws what studyShares() throws
[[nodiscard]] LabelAnswers studyLabels(const PhaseImage& labels, std::uint8_t second,
  const std::array<double, 2>& conductivity, const StudyOptions& options, MPI_Comm comm, const FieldSink& sink = {});

} // namespace lamella::lbm
