#pragma once

#include "packing/Packing.h"

#include <vector>

/// Internal: what is asked of a packing.
namespace lamella::packing
{

/// Diameters over their number mean, from small to large.
[[nodiscard]] std::vector<double> diameters(const PackingOptions& options);

/// @throws ParameterError: values outside their range
void check(const PackingOptions& options);

} // namespace lamella::packing
