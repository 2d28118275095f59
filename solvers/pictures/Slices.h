#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lamella::micrograph
{

/// Numbered pictures that make a volume, in the order of their numbers.
struct Slices
{
  std::vector<std::filesystem::path> files;
  std::vector<std::string> warnings;
};

/// Does a name stand for several files: has it `*`, `?` or `%d` in it, and is it no file itself?
[[nodiscard]] bool isSlicePattern(const std::filesystem::path& path);

/// The pictures in a folder, or those that a pattern (`*`, `?`, or one `%d`, `%4d`, `%04d`; in the file's name, not in
/// the folder's) stands for, sorted by the last number in their names.
/// @throws InputError when there are none, when a folder holds several series, when two have the same number, and when
///         a `%d` pattern lacks a number in between
[[nodiscard]] Slices listSlices(const std::filesystem::path& folderOrPattern);

} // namespace lamella::micrograph
