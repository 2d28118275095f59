#pragma once

#include "lbm/Backend.h"

#include <cstdint>
#include <memory>

namespace lamella::lbm
{

/// Steady diffusion on trilinear elements, one a voxel (Stencil::Q1): values on the corners of voxels, the faces of the
/// box on their outer corners, no condition on insulated sides. A voxel has a tensor,
/// D = D_along a aᵀ + D_across (1 − a aᵀ) with the axis a of its own, one diffusivity, or any tensor that is positive
/// definite, of its phase or its own (DirectedDiffusivity). Whatever the tensors, the
/// system is symmetric and positive definite, so any ratio and direction goes; values may overshoot those at the faces
/// a little. The effective conductivity is a minimum of energy over fewer fields than there are, so it exceeds that of
/// the voxels as they stand, where the finite volumes' may be above or below. Pictures are volumes one element thick.
///
/// Conjugate gradients on the field and its residual in double, directions in single precision, preconditioned by
/// ElementMultigrid; at the end PlaneBalance makes both faces' fluxes equal to the energy. Tensors are in single
/// precision: the error told is at least 6e-8. Voxels conduct to those
/// that they share an edge or a corner with; a path across the box must lead over their faces.
///
/// Ranks share the elements out (ElementShare), and the levels of the multigrid with them: the iterations are those of
/// one rank. The field goes to the ranks' blocks when it is first asked for.
///
/// Memory: 52 bytes a voxel, 24 more with axes, 48 more with a tensor a voxel; pictures have two layers of nodes.
///
/// @throws NoPathError; ParameterError: tensors that do not fit, a directed phase's node without an axis
[[nodiscard]] std::unique_ptr<Backend> makeElementSystem(const Problem& problem);

/// Of its arrays.
[[nodiscard]] std::uint64_t elementBytes(const Lattice& lattice) noexcept;

} // namespace lamella::lbm
