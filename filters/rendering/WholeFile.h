#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace lamella::rendering
{

/// Writes a file that is there whole or not at all: beside the target first, then renamed onto it.
/// @param overwrite may an existing file be replaced? Without it the file must not exist, not even since a moment ago.
/// @returns false and the system's reason on an error; nothing is left behind then
[[nodiscard]] bool WriteWholeFile(const std::filesystem::path& target, const unsigned char* bytes, std::size_t count,
  bool overwrite, std::string& whyNot);

} // namespace lamella::rendering
