#pragma once

#include "reports/Folder.h"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>

namespace lamella::reports
{

struct PageOptions
{
  std::string title;                               ///< wins over report.json's
  int mostWide = 1600;                             ///< wider pictures are scaled down [pixels]
  std::string made;                                ///< the last line: what made the page, and when
  std::function<void(double share)> progress = {}; ///< after every piece; may throw to stop
};

struct PageOfResults
{
  std::string html;
  std::string title;
  std::size_t figures = 0;
  std::size_t scaled = 0;
  std::size_t charts = 0;
  std::size_t tables = 0;
  bool ordered = false; ///< there was a report.json
  Problems problems;
};

/// Everything of a folder in one page that needs no other file.
///
/// What is missing or damaged is named where it would stand and in `problems`; the page is made all the same.
/// @param own the page's own file, which is not shown in it
/// @throws InputError as look() and readPlan(); what `progress` throws
[[nodiscard]] PageOfResults pageOf(
  const std::filesystem::path& folder, const std::filesystem::path& own, const PageOptions& options);

} // namespace lamella::reports
