#pragma once

#include "pictures/Pixels.h"
#include "pictures/Probe.h"

#include <cstdint>
#include <span>

/// PGM and PPM (netpbm's P2, P3, P5, P6), which no library that we link reads.
namespace lamella::micrograph
{

/// Begins a file with these bytes as P1 to P6 does?
[[nodiscard]] bool isNetpbm(std::span<const std::uint8_t> head) noexcept;

/// @throws InputError; also for the bitmaps P1 and P4, and for a file that is too short for its size
[[nodiscard]] Probe probeNetpbm(FileBytes& file);

/// The values as they stand in the file, not stretched where the largest is no 255: 8 bits up to 255, above 16.
/// @param probe gets a warning of what stands behind the pixels
/// @throws InputError; also for a value above the largest that the file speaks of
[[nodiscard]] Pixels decodeNetpbm(FileBytes& file, Probe& probe);

} // namespace lamella::micrograph
