#pragma once

#include "Furniture.h"
#include "Quantity.h"
#include "SnapshotOptions.h"

#include <optional>
#include <string>
#include <vector>

class vtkDataArray;
class vtkDataSet;

/// Which arrays of the data a picture is made of.
namespace lamella::rendering
{

/// The array of this name or, where several directions were solved, the first of name_x, name_y, name_z; empty: none.
[[nodiscard]] std::string FindDirection(vtkDataSet* data, const std::string& name);

/// The ending that says which direction was solved for: "_x" ... or nothing.
[[nodiscard]] std::string DirectionOf(const std::string& name);

/// Name of the array that a preset draws by itself.
/// @throws InputError when there is none at all
[[nodiscard]] std::string DefaultArray(vtkDataSet* data, int preset);

[[nodiscard]] int PresetOfName(const std::string& name);

/// @throws InputError for an array that is not there (lists those that are), or only as cell data where points count
[[nodiscard]] vtkDataArray* GetArray(vtkDataSet* data, const std::string& name, bool allowCells, bool& onCells);

/// The vector array that lines and arrows follow; null if there is none and none was named.
/// @throws InputError for an array that was named and is not there or no vector
[[nodiscard]] vtkDataArray* FindFlow(vtkDataSet* data, const Quantity& quantity, const SnapshotOptions& options);

/// Which points are not void, from the array `phase`; empty without one or when all points are alike.
[[nodiscard]] std::vector<bool> FindSolid(vtkDataSet* data);

/// Metres for one unit of the data's coordinates, or pixels; none where coordinates are no lengths (field data
/// `length_unit`: "1"). @param spacing of a picture's pixels; 0: what is drawn has none
[[nodiscard]] std::optional<Scale> FindScale(vtkDataSet* data, double spacing);

} // namespace lamella::rendering
