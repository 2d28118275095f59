#pragma once

#include "peridynamics/NodeField.h"
#include "peridynamics/multigrid/MultigridOptions.h"

#include <cstdint>
#include <vector>

/// What a hierarchy of levels takes, before there is one.
namespace lamella::peridynamics
{

/// Layouts of the levels of BondMultigrid, the finest first. Sides are taken as not periodic: levels of periodic ones
/// are smaller.
/// @param finest one rank's, its rim as deep as bonds reach
/// @param parallel is it a part of the whole lattice?
[[nodiscard]] std::vector<NodeLayout> levelLayouts(const NodeLayout& finest, bool parallel);

struct MultigridBytes
{
  double held = 0;   ///< matrices and vectors of the levels
  double making = 0; ///< beside these, while they are made
};
/// @param rim is any of it shared with other ranks or by periodic sides?
[[nodiscard]] MultigridBytes multigridBytes(
  const std::vector<NodeLayout>& levels, bool rim, const MultigridOptions& options = {});

} // namespace lamella::peridynamics
