#pragma once

#include "CrackTables.h"

#include <array>
#include <functional>
#include <string>
#include <vector>

/// Helpers of vtkCrackPath; not installed.
namespace lamella
{

constexpr const char* crackCreator = "vtkCrackPath";

/// A number of a path: the same in the table and at the poly-lines.
struct PathColumn
{
  const char* name;
  const char* unit;
  const char* description;
  std::function<double(const cracks::CrackPath&)> value; ///< of a path of `all`
  bool whole = false;
};
/// @param all,scale must outlive the columns
[[nodiscard]] std::vector<PathColumn> pathColumns(const cracks::CrackPaths& all, const CrackScale& scale);

/// Unit of CutBond::when.
[[nodiscard]] const char* unitOf(const std::string& when);

/// Where a point lies [m].
[[nodiscard]] std::array<double, 3> placed(const CrackScale& scale, const cracks::CrackPoint& point);

} // namespace lamella
