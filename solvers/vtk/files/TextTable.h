#pragma once

#include "vtkLamellaSolversVTKModule.h" // for the export macro

#include "vtkSmartPointer.h"

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

class vtkTable;

namespace lamella
{

/// A table of numbers as a text file: one line of names, one line a row. Commas, semicolons, tabs or blanks separate
/// columns, whichever the line of names has.
class VTKLAMELLASOLVERSVTK_EXPORT TextTable
{
public:
  /// @param wanted what the line of names is to hold: the hint where it does not
  /// @throws InputError: no file, no text, no line of names, a row with more or fewer cells than there are names
  TextTable(const std::filesystem::path& path, std::string wanted);

  [[nodiscard]] const std::vector<std::string>& names() const noexcept { return names_; }
  [[nodiscard]] std::size_t rows() const noexcept;
  /// @throws InputError: nothing, a decimal comma or text where a number belongs (row and column)
  [[nodiscard]] double number(std::size_t row, std::size_t column) const;
  [[nodiscard]] const std::string& text(std::size_t row, std::size_t column) const;

  /// "  Radius [mm]" → "radius"
  [[nodiscard]] static std::string plainName(std::string_view name);

  /// An error about this file. @throws InputError always
  [[noreturn]] void refuse(const std::string& what, const std::string& remedy) const;
  /// That it lacks columns; lists those it has. @throws InputError always
  [[noreturn]] void lacks(const std::string& columns) const;

private:
  /// Else numbers stand under the wrong names, and nothing says so.
  void requireWholeRows(char separator) const;

  std::filesystem::path path_;
  std::string wanted_;
  std::string separator_;
  std::vector<std::string> names_;
  vtkSmartPointer<vtkTable> table_; ///< of texts
};

} // namespace lamella
