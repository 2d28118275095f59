#pragma once

#include "core/PartFile.h"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>

namespace lamella
{

/// Writes a file whole or not at all, over one that has its name: `write` fills a new file beside it (PartFile), which
/// is brought to the disk and then takes the name.
/// @param write returns 0, or the number of what stood in the way, as in errno
/// @throws Error when the folder cannot be written to or the disk is full, Cancelled after PartFile::removeAll(), and
///         what `write` throws; nothing is left behind then
void writeWhole(const std::filesystem::path& path, const std::function<int(const PartFile&)>& write);

/// The same with these bytes.
void writeWhole(const std::filesystem::path& path, std::span<const std::byte> bytes);

} // namespace lamella
