#pragma once

#include <cstdint>

namespace lamella::cli
{

/// Begins anew to look for the largest memory of this process. Where the system does not let it, peakMemory() stays
/// that since the start.
void resetPeakMemory();

/// Bytes of this process that were in memory at once, at most, since resetPeakMemory().
[[nodiscard]] std::uint64_t peakMemory();

/// Bytes that are in memory now.
[[nodiscard]] std::uint64_t memoryNow();

} // namespace lamella::cli
