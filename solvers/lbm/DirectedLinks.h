#pragma once

#include "lattice/Lattice.h"
#include "lbm/DirectedDiffusivity.h"
#include "lbm/LinkTable.h"
#include "lbm/SteadyDiffusion.h"

#include <cstdint>
#include <span>

/// Diffusivities that differ along and across the walls: a tensor in every node, on the links of D2Q9.
namespace lamella::lbm
{

/// Largest ratio of the two diffusivities that the links carry in every direction of the axis: 3 + 2√2.
inline constexpr double mostDirected = 5.82842712474619;

/// Do the links carry these, whatever the directions?
[[nodiscard]] bool linksCarry(std::span<const double> along, std::span<const double> across) noexcept;

/// Links of steady diffusion with the tensor D = D_along a aᵀ + D_across (1 − a aᵀ) in every node.
///
/// The tensor is a sum over links, D_xx = s_x + r + f, D_yy = s_y + r + f, D_xy = r − f, with the least diagonals:
/// r = max(D_xy, 0) on the rising one, f = max(−D_xy, 0) on the falling one. No share is negative where |D_xy| ≤
/// min(D_xx, D_yy), so that no value of the field exceeds those at the faces; that holds at every angle up to a ratio
/// of 3 + 2√2, and up to any along the lattice's axes and diagonals. (Non-negative stencils: Fehrenbach and Mirebeau,
/// J. Math. Imaging Vis. 49 (2014) 123, who go to wider ones beyond.) An isotropic phase has no diagonals: D2Q5.
///
/// A straight link carries the harmonic mean of its nodes' shares, a diagonal one, which passes between two other
/// nodes, the arithmetic mean; 0 where a node does not conduct. Of four rules tried this one errs least on coated
/// disks, whose exact conductivity is known (docs/solvers/steady-diffusion.md). At an insulated side the diagonals cut
/// off there come back as links along it, ½ (|D_xy| − D_xy²/D_nn) of each node, n the side's normal: a uniform tensor
/// between insulated sides then conducts D_tt − D_xy²/D_nn along them, exactly. A fixed face conducts twice D_nn.
///
/// Time and memory: one pass over the nodes; 32 bytes a node for the table and 24 while it is made.
///
/// @param lattice of two dimensions  @param phase ids of all its nodes
/// @throws ParameterError in three dimensions; sizes or values that do not fit; a directed phase's node without an
/// axis; a tensor that the links cannot carry
[[nodiscard]] LinkTable directedLinks(
  const Lattice& lattice, std::span<const std::uint8_t> phase, const DirectedDiffusivity& diffusivity, Sides sides);

} // namespace lamella::lbm
