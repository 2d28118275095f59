#include "TextTable.h"

#include "core/Error.h"

#include "vtkDelimitedTextReader.h"
#include "vtkNew.h"
#include "vtkStringArray.h"
#include "vtkTable.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <optional>
#include <utility>

namespace fs = std::filesystem;

namespace lamella
{
namespace
{

/// What separates the columns, as VTK's reader takes it.
struct Separator
{
  char sign;
  const char* name;
};
constexpr std::array<Separator, 4> separators{ { { ';', "semicolons" }, { '\t', "tabs" }, { ',', "commas" },
  { ' ', "blanks" } } };

std::optional<double> toNumber(std::string_view text)
{
  text.remove_prefix(std::min(text.size(), text.find_first_not_of(" \t\r+")));
  text = text.substr(0, text.find_last_not_of(" \t\r") + 1);
  double value = 0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
  return failed == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

/// The line of names.
std::string firstLine(const TextTable& table, const fs::path& path, const std::string& wanted)
{
  std::error_code failed;
  const auto status = fs::status(path, failed);
  if (!fs::exists(status))
    throw InputError("there is no file '" + path.string() + "'", "check the name and the folder");
  if (fs::is_directory(status))
    table.refuse("is a folder, not a file", "give the name of a file in it");
  std::ifstream file(path, std::ios::binary);
  if (!file)
    throw InputError("cannot read '" + path.string() + "': " + std::strerror(errno), "check its permissions");
  std::string line;
  std::getline(file, line);
  if (line.find_first_not_of(" \t\r") == std::string::npos)
    table.refuse(line.empty() && file.eof() ? "is empty" : "begins with an empty line", wanted);
  if (std::any_of(line.begin(), line.end(), [](unsigned char c) { return c == 0; }))
    table.refuse("is no text file", "save the table as comma-separated text (UTF-8)");
  return line;
}

/// The cells of a row, which goes on in the next line where a text in quotes does.
struct Row
{
  std::size_t cells = 0;  ///< begun
  std::size_t filled = 0; ///< up to the last that is not blank
  bool quoted = false;
};

void countCells(std::string_view line, char separator, Row& row)
{
  const bool blanks = separator == ' '; // any number of them separates
  bool inside = !blanks;
  row.cells = std::max<std::size_t>(row.cells, inside ? 1 : 0);
  for (const char c : line)
  {
    row.quoted ^= c == '"';
    if (c == separator && !row.quoted)
    {
      inside = !blanks;
      row.cells += inside ? 1 : 0;
    }
    else if (c != ' ' && c != '\t' && c != '\r')
    {
      row.cells += inside ? 0 : 1;
      inside = true;
      row.filled = row.cells;
    }
  }
}

std::string listed(const std::vector<std::string>& names)
{
  std::string list;
  for (const std::string& name : names)
    list += (list.empty() ? "'" : ", '") + name + "'";
  return list;
}

} // namespace

TextTable::TextTable(const fs::path& path, std::string wanted)
  : path_(path)
  , wanted_(std::move(wanted))
{
  const std::string line = firstLine(*this, path_, wanted_);
  const auto* const separator = std::find_if(
    separators.begin(), separators.end(), [&](const Separator& s) { return line.find(s.sign) != std::string::npos; });
  const bool blanks = separator == separators.end() || separator->sign == ' ';
  separator_ = blanks ? "blanks" : separator->name;
  const std::array<char, 2> sign{ blanks ? ' ' : separator->sign, '\0' };
  vtkNew<vtkDelimitedTextReader> reader;
  reader->SetFileName(path_.c_str());
  reader->SetHaveHeaders(true);
  reader->SetFieldDelimiterCharacters(sign.data());
  reader->SetMergeConsecutiveDelimiters(blanks);
  reader->DetectNumericColumnsOff(); // text among the numbers is for us to point at
  reader->Update();
  table_ = reader->GetOutput();
  bool numbers = true;
  for (vtkIdType i = 0; i < table_->GetNumberOfColumns(); ++i)
  {
    auto* const cells = vtkStringArray::SafeDownCast(table_->GetColumn(i));
    names_.emplace_back(cells != nullptr && cells->GetName() != nullptr ? cells->GetName() : "");
    numbers = numbers && toNumber(names_.back()).has_value();
  }
  const std::string found = listed(names_);
  if (found.empty() || std::any_of(found.begin(), found.end(), [](unsigned char c) { return c < 32 || c == 127; }))
    this->refuse("is no table: its first line holds no names", wanted_);
  if (numbers)
    this->refuse("has no line of names: it begins with " + found, wanted_);
  this->requireWholeRows(sign[0]);
}

void TextTable::requireWholeRows(char separator) const
{
  std::ifstream file(path_, std::ios::binary);
  std::string line;
  std::size_t columns = 0;
  for (std::size_t number = 1, first = 1; std::getline(file, line); first = ++number)
  {
    Row row;
    countCells(line, separator, row);
    for (; row.quoted && std::getline(file, line); ++number)
      countCells(line, separator, row);
    if (columns == 0)
    {
      columns = row.cells;
    }
    else if (row.filled > columns || (row.filled > 0 && row.cells < columns))
    {
      this->refuse("has " + std::to_string(columns) + " columns, and " +
          std::to_string(std::max(row.filled, row.cells)) + " values in row " + std::to_string(first),
        "give every row a value, perhaps an empty one, for each name; texts with the separator in them stand in "
        "quotes");
    }
  }
}

std::size_t TextTable::rows() const noexcept
{
  return static_cast<std::size_t>(table_->GetNumberOfRows());
}

const std::string& TextTable::text(std::size_t row, std::size_t column) const
{
  auto* const cells = vtkStringArray::SafeDownCast(table_->GetColumn(static_cast<vtkIdType>(column)));
  return cells->GetValue(static_cast<vtkIdType>(row));
}

double TextTable::number(std::size_t row, std::size_t column) const
{
  const std::string& text = this->text(row, column);
  if (const auto value = toNumber(text))
    return *value;
  const std::string where = "row " + std::to_string(row + 2) + ", column '" + names_[column] + "'";
  if (text.find_first_not_of(" \t\r") == std::string::npos)
    this->refuse("has nothing in " + where, "give a number in every row of every column");
  std::string point = text;
  std::replace(point.begin(), point.end(), ',', '.');
  if (point != text && toNumber(point))
  {
    this->refuse("has a decimal comma: '" + text + "' in " + where,
      "write decimal points, as in " + point + "; commas may separate columns");
  }
  this->refuse("has the text '" + text + "' where a number belongs, in " + where, "write a number, as in 0.0012");
}

std::string TextTable::plainName(std::string_view name)
{
  std::string plain;
  for (const char c : name)
    if (std::isalpha(static_cast<unsigned char>(c)) != 0)
      plain += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    else if (!plain.empty())
      break;
  return plain;
}

void TextTable::refuse(const std::string& what, const std::string& remedy) const
{
  throw InputError("'" + path_.string() + "' " + what, remedy);
}

void TextTable::lacks(const std::string& columns) const
{
  this->refuse("lacks the column " + columns + "; separated by " + separator_ + ", it has " + listed(names_), wanted_);
}

} // namespace lamella
