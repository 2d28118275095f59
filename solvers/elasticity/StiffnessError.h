#pragma once

#include "elasticity/ElasticConstants.h"

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

/// How far an effective stiffness may be from the material's.
namespace lamella::elasticity
{

/// Of the value against the material's, whose solid is isotropic with the model's Poisson's ratio: what one node a
/// pixel does (steps of boundaries, soft layers as thick as the horizon) and what the pixels' own steps do. Not in it:
/// another Poisson's ratio than the model's, features of which no pixel tells, how far the sample speaks for more of
/// its material.
struct StiffnessError
{
  std::vector<double> components; ///< of each component [Pa]; empty: not known
  /// Of the diagonal's worst, relative; NaN: not known
  double relative = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> extrapolated; ///< tensor that the material is expected to have [Pa]
  ElasticConstants constants;       ///< of that; empty where it has no inverse that makes sense
  std::vector<double> ofConstants;  ///< as constantValues(); NaN where one is not known; empty: none is
  /// Part of `components` and `ofConstants` that no finer picture mends, relative: of a lattice of bonds that is not
  /// isotropic, w/(1 - w) with w LatticeModuli::worst.
  double lattice = 0;
};

/// Tensors of the pictures that about every `stride`-th pixel gives; zeros where nothing goes on.
struct SubsampleTensors
{
  double stride = 2;
  std::vector<std::vector<double>> tensors;
};

/// The solves of a study: of the sample, or of the pictures of one stride.
struct StiffnessStep
{
  double every = 1;                     ///< pixels between those that are used, about; 1: the sample
  int pictures = 1;                     ///< how many were solved
  std::int64_t nodes = 0;               ///< of all of them
  std::vector<double> stiffness;        ///< [Pa], components², mean of them
  std::vector<std::int64_t> iterations; ///< one a unit strain, sums
  double seconds = 0;                   ///< wall, all of it
};

/// What a method's error is made of.
struct StiffnessErrorRule
{
  /// What is left of the mean error over the change that a halved pixel makes. 1: it falls like the pixel, as that of
  /// elements does.
  double leftOverChange = 1;
  double lattice = 0; ///< StiffnessError::lattice
  double zero = 1e-9; ///< as elasticConstants()
};

/// The error of each component and of each constant, from coarser pictures of the same cell (lattice/PictureError.h):
/// a boundary errs over a layer as thick as a pixel, or as a horizon of so many, hence like the pixel, and so do its
/// steps.
/// @param stiffness  of the sample, components²
/// @param subsamples of every second pixel first
[[nodiscard]] StiffnessError stiffnessError(std::span<const double> stiffness,
  std::span<const SubsampleTensors> subsamples, int dimension, const StiffnessErrorRule& rule);

/// The same of voxels that phases share, from those of twice and of four times the spacing over the same box
/// (lattice/SpacingError.h).
/// @param coarser may be empty
/// @param mixed   part of the voxels that hold some of both phases: where surfaces lie so close that these are more
///   than a quarter, errors hardly fall from spacing to spacing, and bars are 1 + 12 (mixed − 1/4) times as long,
///   in relative terms at least the longest one of the diagonal (docs/benchmarks/elements.md)
[[nodiscard]] StiffnessError sharedStiffnessError(std::span<const double> stiffness, std::span<const double> coarse,
  std::span<const double> coarser, int dimension, double zero, double mixed);

} // namespace lamella::elasticity
