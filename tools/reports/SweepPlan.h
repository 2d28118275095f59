#pragma once

#include "reports/Folder.h"

#include <filesystem>

namespace lamella::reports
{

/// The most that the page of a scene's results holds, however many samples there are. [bytes]
inline constexpr std::size_t largestSweepPage = 5'000'000;

/// A page of what `lamella run` wrote: what was swept, each measure over each swept key, and pictures of the samples
/// side by side; then the tables and what else lies in the folder.
[[nodiscard]] Plan planOfSweep(const std::filesystem::path& path, const Found& found);

} // namespace lamella::reports
