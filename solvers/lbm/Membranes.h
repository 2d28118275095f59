#pragma once

#include "lattice/Phases.h"
#include "lbm/SteadyDiffusion.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lamella::lbm
{

/// A resistance on the surface between two phases, where the value jumps by it times the flux through the surface: of
/// heat the thermal boundary (Kapitza) resistance, of what diffuses the inverse of a permeance.
struct Membrane
{
  std::uint8_t first = 0; ///< ids of two different phases
  std::uint8_t second = 0;
  double resistance = 0; ///< length over conductivity, the length in the unit of the lattice's spacing [m]; ≥ 0
};

/// A picture whose ids tell, beside the phase, how surfaces with membranes lie.
///
/// A staircase has faces of a larger area than the surface that it stands for: |n_x| + |n_y| + |n_z| times as large, n
/// its unit normal, whatever the edges of a voxel. So each face carries a resistance as many times as large. Normals
/// are of the 5 × 5 (× 5) nodes around (SurfaceSlope.h); where edges differ the window is as long along all axes, of 5
/// nodes along the longest edge. Of nodes at a membrane the inverse, 1/(|n_x| + |n_y| + |n_z|), goes into ids of its
/// own, up to 32 of each phase, and a link takes the mean of its two ends. Of planes that lie along the lattice it is 1
/// exactly, and no id is added.
struct MembraneIds
{
  std::vector<std::uint8_t> id;    ///< by node
  std::vector<std::uint8_t> phase; ///< by id
  std::vector<double> flatness;    ///< by id: surface over faces, 1/√3 … 1
  /// By membrane, over the volume, times the spacing along x: the surface; and of each axis the faces across it, each
  /// as many times as its resistance is larger.
  std::vector<double> area;
  std::vector<std::array<double, 3>> across;
};

/// @param image      phases; of pixels that were split, `refinement` nodes a pixel along each axis, whose steps stay
///                   those of the pixels
/// @param wraps      by axis: whether sides are periodic
/// @throws ParameterError for a membrane between a phase and itself, a resistance that is negative or not finite, two
/// membranes between the same phases, more phases than ids are left for, edges beyond a ratio of 16
[[nodiscard]] MembraneIds membraneIds(
  const PhaseImage& image, int refinement, std::span<const Membrane> membranes, std::array<bool, 3> wraps);

/// Links of such ids: 1/(1/2k + R/(δ f) + 1/2k′) where a membrane lies between, f the mean flatness of both ends, δ the
/// spacing along the link; else harmonic means. One table of cubes, three by axis of other voxels.
/// @param conductivity by phase
/// @throws ParameterError for a phase without one, and what membraneIds() throws of membranes
[[nodiscard]] PairTable membraneLinks(const MembraneIds& ids, std::span<const double> conductivity,
  std::span<const Membrane> membranes, const Lattice& lattice);

/// By phases and membranes, from those of links by pairs of ids (SteadyDiffusion::pairDerivatives).
/// K = Σ k ∂K/∂k − Σ R ∂K/∂R.
[[nodiscard]] ConductivityDerivatives membraneDerivatives(std::span<const double> pairDerivatives,
  const MembraneIds& ids, std::span<const double> conductivity, std::span<const Membrane> membranes,
  const Lattice& lattice);

/// Part of the surface's area by which the normals of steps err: measured on spheres of more than 30 nodes across it is
/// 0.5 %, on planes at many angles at most 1.1 %.
inline constexpr double membraneAreaError = 0.01;

} // namespace lamella::lbm
