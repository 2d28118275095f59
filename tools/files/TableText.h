#pragma once

#include <nlohmann/json.hpp>

#include <string>

class vtkTable;

/// Tables as files.
namespace lamella::cli
{

/// A table as comma-separated values: a row of names, then one row a row, numbers with all their digits. Names and
/// texts with a comma, a quote or a line break stand in quotes.
[[nodiscard]] std::string toCsv(vtkTable* table);

/// Units and meaning of the columns of numbers.
/// @param metres the pixel size is known; otherwise lengths are in pixels
[[nodiscard]] nlohmann::ordered_json unitsOf(vtkTable* table, bool metres);

/// The rows of a table, each an object by the names of its columns; numbers that are not finite are null.
[[nodiscard]] nlohmann::ordered_json jsonRows(vtkTable* table);

} // namespace lamella::cli
