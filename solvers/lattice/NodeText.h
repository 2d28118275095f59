#pragma once

#include "lattice/Lattice.h"

#include <cstdint>
#include <string>

namespace lamella
{

/// Where a node is, in the words of the command line: "pixel 3, 0 from the top left" in 2D, "voxel 3, 0, 7" in the
/// order of the file in 3D.
[[nodiscard]] std::string nodeText(const Lattice& lattice, std::int64_t node);

} // namespace lamella
