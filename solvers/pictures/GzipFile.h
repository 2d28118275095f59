#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace lamella::micrograph
{

/// The text of a file, unpacked where it begins as gzip does.
/// @throws InputError: no such file, a damaged or truncated stream, more than `most` bytes of text
[[nodiscard]] std::string readText(const std::filesystem::path& path, std::size_t most);

/// Writes a text, packed by gzip if the name ends in .gz.
/// @throws Error as writeWhole()
void writeText(const std::string& text, const std::filesystem::path& path);

} // namespace lamella::micrograph
