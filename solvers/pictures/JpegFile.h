#pragma once

#include "pictures/Pixels.h"
#include "pictures/Probe.h"

#include <cstdint>
#include <vector>

/// JPEG, by libjpeg.
namespace lamella::micrograph
{

/// @throws InputError; also for a JPEG of four components (CMYK)
[[nodiscard]] Probe probeJpeg(FileBytes& file);

/// @throws InputError; also for what libjpeg only warns of: damaged data
[[nodiscard]] Pixels decodeJpeg(FileBytes& file);

/// The bytes of a JPEG file. @param pixels of 8 bits and 1 or 3 channels
/// @throws ParameterError for what libjpeg takes for no picture
[[nodiscard]] std::vector<std::uint8_t> encodeJpeg(const Pixels& pixels, int quality = 95);

} // namespace lamella::micrograph
