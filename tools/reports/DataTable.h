#pragma once

#include "TextTable.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace lamella::reports
{

/// Larger tables are not read: a page is for people. [bytes]
inline constexpr std::uintmax_t largestTable = std::uintmax_t{ 64 } << 20;

/// A table of results: comma-separated values, and what NAME.csv.json beside it says about its columns.
class DataTable
{
public:
  /// @throws InputError: no such file, no table, too large
  explicit DataTable(const std::filesystem::path& path);

  [[nodiscard]] const std::vector<std::string>& names() const noexcept { return table_.names(); }
  [[nodiscard]] std::size_t rows() const noexcept { return table_.rows(); }
  /// @throws InputError with the columns that there are
  [[nodiscard]] std::size_t column(const std::string& name) const;
  /// Without blanks around it.
  [[nodiscard]] std::string text(std::size_t row, std::size_t column) const;
  /// NaN where there is no number.
  [[nodiscard]] double number(std::size_t row, std::size_t column) const;
  [[nodiscard]] std::vector<double> numbers(std::size_t column) const;
  /// Every cell that is not empty holds a number, and one is not empty.
  [[nodiscard]] bool isNumeric(std::size_t column) const;
  /// "m", "Pa", ...; empty where nothing says.
  [[nodiscard]] std::string unit(const std::string& name) const;
  /// "strength [Pa]"
  [[nodiscard]] std::string label(const std::string& name) const;
  /// What a column is; its name where nothing says.
  [[nodiscard]] std::string meaning(const std::string& name) const;
  /// The only row whose cells are these; numbers are compared as numbers.
  /// @throws InputError where there is none, or more than one
  [[nodiscard]] std::size_t row(const std::map<std::string, std::string>& cells) const;

private:
  TextTable table_;
  std::string name_;
  std::map<std::string, std::string> units_;
  std::map<std::string, std::string> meanings_;
};

} // namespace lamella::reports
