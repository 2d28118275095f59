#pragma once

#include "generators/Generators.h"

namespace lamella::generators
{

/// Refuses options outside their range and samples that do not fit into memory.
/// @throws ParameterError, MemoryError
void check(const SoftwoodOptions& options);
void check(const HardwoodOptions& options);

} // namespace lamella::generators
