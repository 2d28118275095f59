#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

class vtkTable;

namespace lamella::cli
{

/// Tables by name, as groups of one HDF5 file: a dataset a column, numbers as doubles, texts as UTF-8; and a text
/// `provenance`. The same tables make the same bytes but for that.
/// @throws OutputError
void writeArchive(const std::filesystem::path& path, const std::vector<std::pair<std::string, vtkTable*>>& tables,
  const std::string& provenance);

} // namespace lamella::cli
