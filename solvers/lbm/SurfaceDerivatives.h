#pragma once

#include "lbm/Backend.h"

namespace lamella::lbm
{

/// ∂K/∂δ of the effective conductivity along the axis by how far the surface between each two phases is moved, from the
/// field of a solve alone. Of phases a and b, where a grows into b by δ:
///
///   ∂K/∂δ = 1/(V G²) ∫ (k_a − k_b) |∇_t u|² + (1/k_b − 1/k_a) q_n² dS,
///
/// with the gradient along the surface and the flux through it, which no surface jumps in (Hadamard's derivative of the
/// energy; the field's own change counts only to second order).
///
/// A picture has steps instead of surfaces, and fields beside steps are not those beside what they stand for: a link
/// across a step carries little where the phases differ much, whatever the flux through the surface. So gradients are
/// those of links within a phase, that along the surface from the phase that conducts better, the flux through it from
/// the other one; normals from 3 × 3 (× 3) nodes; a step's face counts for |n| of the surface. Arrays of disks at
/// contrasts of 0 to 10⁴ have 0.73 to 1.01 of their exact derivative so, from 64 nodes a side on
/// (docs/solvers/steady-diffusion.md). Elements, which may have tensors, go with the surfaces instead
/// (lattice/SurfaceMotions.h), by the volume integral that is the same where fields are exact.
///
/// Collective. @throws ParameterError for links that were given
[[nodiscard]] SurfaceDerivatives surfaceDerivatives(const Problem& problem, const Backend& backend);

} // namespace lamella::lbm
