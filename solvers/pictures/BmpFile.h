#pragma once

#include "pictures/Pixels.h"
#include "pictures/Probe.h"

/// BMP, not packed, of 8 (with a palette), 24 and 32 bits a pixel, which no library that we link reads.
namespace lamella::micrograph
{

/// @throws InputError; also for other kinds of BMP, and for a file that is too short for its size
[[nodiscard]] Probe probeBmp(FileBytes& file);

/// Red, green and blue; with alpha where a mask of the file names it.
/// @throws InputError; also for a colour that the palette lacks
[[nodiscard]] Pixels decodeBmp(FileBytes& file);

} // namespace lamella::micrograph
