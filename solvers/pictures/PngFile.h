#pragma once

#include "pictures/Pixels.h"
#include "pictures/Probe.h"

#include <cstdint>
#include <string_view>
#include <vector>

/// PNG, by libpng: what is read and written here are its settings, its callbacks and our error lines.
namespace lamella::micrograph
{

/// What stands before the pixels. @throws InputError
[[nodiscard]] Probe probePng(FileBytes& file);

/// Greys of fewer than 8 bits are stretched to 0 to 255, palettes turned into colours, alpha kept as it is.
/// @param probe gets the texts that stand behind the pixels, and warnings of damaged ones
/// @throws InputError
[[nodiscard]] Pixels decodePng(FileBytes& file, Probe& probe);

/// The bytes of a PNG file.
/// @param perMetre    pixels a metre, for pHYs; 0: not told
/// @param description goes into a text of that name, if it is not empty
/// @param effort      of packing, 0 to 9
/// @throws ParameterError for what libpng takes for no picture
[[nodiscard]] std::vector<std::uint8_t> encodePng(
  const Pixels& pixels, double perMetre, std::string_view description, int effort);

} // namespace lamella::micrograph
