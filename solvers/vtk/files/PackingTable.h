#pragma once

#include "packing/Packing.h"

#include "vtkLamellaSolversVTKModule.h" // for the export macro

#include <array>
#include <filesystem>
#include <optional>

namespace lamella
{

struct PackingTableOptions
{
  double unit = 1;                          ///< length of the table's unit [m]
  std::optional<std::array<double, 3>> box; ///< edges [m]; none: that of the grains, moved to the origin
};

/// A packing from a table: one line of names, one line a grain. Columns are found by their names, in any order and
/// case: x, z, r (or x, y, r) for disks, whose second coordinate points up; x, y, z, r for spheres, but for disks where
/// every z is 0. `radius` stands for r, `d` or `diameter` for twice r, and both may be there; what follows the name,
/// such as a unit in brackets, and other columns are ignored. Commas, semicolons, tabs or blanks separate columns,
/// whichever the line of names has.
/// @throws InputError: no file, no line of names, columns that are missing (lists those found), text where a number
/// belongs (row and column), decimal commas, and what packing::packingOf() refuses
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT packing::Packing readPackingTable(
  const std::filesystem::path& path, const PackingTableOptions& options = {});

} // namespace lamella
