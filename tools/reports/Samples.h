#pragma once

#include "reports/DataTable.h"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace lamella::reports
{

/// A key of a scene that has several values.
struct SweptKey
{
  std::string path; ///< column of the table: "sample.solid-fraction"
  std::string name; ///< without its section, where no other is called so
  std::string unit;
  bool numbers = false;
  bool averaged = false;             ///< samples that differ in it alone are one setting
  std::vector<std::string> values{}; ///< in the order in which they come, for people
  std::vector<double> coordinates{}; ///< along an axis: numbers, or places of words
  std::vector<std::size_t> ofRow{};  ///< which of them

  /// "width 0.5 mm"
  [[nodiscard]] std::string text(std::size_t value) const;
};

/// The samples of a scene: its table, as `lamella run` writes it.
class Samples
{
public:
  /// @throws InputError: no such table
  explicit Samples(const std::filesystem::path& folder);

  [[nodiscard]] const DataTable& table() const noexcept { return table_; }
  [[nodiscard]] const std::vector<SweptKey>& keys() const noexcept { return keys_; }
  /// Columns of numbers that were measured.
  [[nodiscard]] const std::vector<std::size_t>& measures() const noexcept { return measures_; }
  /// "samples/KEY"
  [[nodiscard]] std::string folderOf(std::size_t row) const { return "samples/" + table_.text(row, key_); }
  [[nodiscard]] bool failed(std::size_t row) const { return table_.text(row, status_) == "failed"; }
  /// "solid-fraction 0.3, seed 2"
  [[nodiscard]] std::string caption(std::size_t row) const;
  /// The same of these rows, without what is the same in all of them.
  [[nodiscard]] std::vector<std::string> captions(const std::vector<std::size_t>& rows) const;
  /// Rows, all of them; of more than `most` as many whole sets of settings as there is room for, or settings evenly
  /// taken.
  [[nodiscard]] std::vector<std::size_t> some(std::size_t most) const;

private:
  [[nodiscard]] SweptKey keyOf(std::size_t column) const;

  DataTable table_;
  std::size_t key_;
  std::size_t status_;
  std::vector<SweptKey> keys_;
  std::vector<std::size_t> measures_;
};

} // namespace lamella::reports
