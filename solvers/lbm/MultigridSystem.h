#pragma once

#include "lbm/Backend.h"

#include <memory>

namespace lamella::lbm
{

/// Can geometric multigrid halve this lattice down to a size that is cheap to solve directly? Always with fixed and
/// insulated faces; with periodic sides as long as the number of nodes along each axis stays even.
[[nodiscard]] bool multigridFits(const Lattice& lattice, Sides sides);

[[nodiscard]] std::unique_ptr<Backend> makeMultigridSystem(const Problem& problem);

} // namespace lamella::lbm
