#pragma once

#include "lbm/Backend.h"

#include <memory>

namespace lamella::lbm
{

/// The steady system on the nodes that carry flux, and on no others: one unknown a node of a cluster that leads from
/// face to face, numbered row by row through a NodeSet (1.5 bits a node of the box). Solved by conjugate gradients
/// preconditioned by algebraic multigrid (hypre BoomerAMG, HMIS coarsening, extended+i interpolation), which does not
/// mind how the void cuts the lattice up.
///
/// Memory: about 0.5 kB a carrying node, nearly all of it hypre's.
///
/// @throws NoPathError when no cluster leads across
[[nodiscard]] std::unique_ptr<Backend> makeCompactSystem(const Problem& problem);

} // namespace lamella::lbm
