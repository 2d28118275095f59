#include "PackingTable.h"

#include "lattice/Error.h"

#include "vtkAbstractArray.h"
#include "vtkDelimitedTextReader.h"
#include "vtkNew.h"
#include "vtkStringArray.h"
#include "vtkTable.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

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

[[noreturn]] void refuse(const fs::path& path, const std::string& what, const std::string& remedy)
{
  throw InputError("'" + path.string() + "' " + what, remedy);
}

/// "x,z,r" and the rest of what every message about columns ends in.
constexpr const char* wanted = "the first line names the columns: x,z,r or x,y,r for disks, x,y,z,r for spheres";

/// The line of names.
std::string firstLine(const fs::path& path)
{
  std::error_code failed;
  const auto status = fs::status(path, failed);
  if (!fs::exists(status))
  {
    throw InputError("there is no file '" + path.string() + "'", "check the name and the folder");
  }
  if (fs::is_directory(status))
  {
    refuse(path, "is a folder, not a file", "give the name of a file in it");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file)
  {
    throw InputError("cannot read '" + path.string() + "': " + std::strerror(errno), "check its permissions");
  }
  std::string line;
  std::getline(file, line);
  if (line.find_first_not_of(" \t\r") == std::string::npos)
  {
    refuse(path, line.empty() && file.eof() ? "is empty" : "begins with an empty line", wanted);
  }
  if (std::any_of(line.begin(), line.end(), [](unsigned char c) { return c == 0; }))
  {
    refuse(path, "is no text file", "save the table as comma-separated text (UTF-8)");
  }
  return line;
}

/// "  Radius [mm]" → "radius"
std::string plainName(std::string_view text)
{
  std::string name;
  for (const char c : text)
  {
    if (std::isalpha(static_cast<unsigned char>(c)) != 0)
    {
      name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
    else if (!name.empty())
    {
      break;
    }
  }
  return name;
}

std::optional<double> toNumber(std::string_view text)
{
  text.remove_prefix(std::min(text.size(), text.find_first_not_of(" \t\r+")));
  text = text.substr(0, text.find_last_not_of(" \t\r") + 1);
  double value = 0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
  return failed == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

struct Column
{
  std::string name; ///< as in the file
  vtkStringArray* cells = nullptr;

  [[nodiscard]] double number(const fs::path& path, vtkIdType row) const
  {
    const std::string& text = this->cells->GetValue(row);
    if (const auto value = toNumber(text))
    {
      return *value;
    }
    const std::string where = "row " + std::to_string(row + 2) + ", column '" + this->name + "'";
    if (text.find_first_not_of(" \t\r") == std::string::npos)
    {
      refuse(path, "has nothing in " + where, "give every grain a number in every column");
    }
    std::string point = text;
    std::replace(point.begin(), point.end(), ',', '.');
    if (point != text && toNumber(point))
    {
      refuse(path, "has a decimal comma: '" + text + "' in " + where,
        "write decimal points, as in " + point + "; commas may separate columns");
    }
    refuse(path, "has the text '" + text + "' where a number belongs, in " + where, "write a number, as in 0.0012");
  }
};

struct Columns
{
  std::optional<Column> x;
  std::optional<Column> y;
  std::optional<Column> z;
  std::optional<Column> size;
  double sizeToRadius = 1;
};

Columns findColumns(const fs::path& path, vtkTable* table, const char* separator)
{
  Columns columns;
  std::string found;
  bool numbers = true;
  for (vtkIdType i = 0; i < table->GetNumberOfColumns(); ++i)
  {
    auto* const cells = vtkStringArray::SafeDownCast(table->GetColumn(i));
    const std::string header = cells != nullptr && cells->GetName() != nullptr ? cells->GetName() : "";
    numbers = numbers && toNumber(header).has_value();
    found += (found.empty() ? "'" : ", '") + header + "'";
    const std::string name = plainName(header);
    const Column column{ header, cells };
    const auto take = [&](std::optional<Column>& place)
    {
      if (place)
      {
        refuse(path, "has two columns for the same: '" + place->name + "' and '" + header + "'", "leave one out");
      }
      place = column;
    };
    if (name == "x")
    {
      take(columns.x);
    }
    else if (name == "y")
    {
      take(columns.y);
    }
    else if (name == "z")
    {
      take(columns.z);
    }
    else if (name == "r" || name == "radius" || name == "d" || name == "diameter")
    {
      take(columns.size);
      columns.sizeToRadius = name[0] == 'd' ? 0.5 : 1;
    }
  }
  if (found.empty() || std::any_of(found.begin(), found.end(), [](unsigned char c) { return c < 32 || c == 127; }))
  {
    refuse(path, "is no table: its first line holds no names", wanted);
  }
  if (numbers)
  {
    refuse(path, "has no line of names: it begins with " + found, wanted);
  }
  std::string missing;
  const auto need = [&](bool there, const char* name)
  { missing += there ? "" : (missing.empty() ? "" : ", ") + std::string(name); };
  need(columns.x.has_value(), "x");
  need(columns.y || columns.z, "y or z");
  need(columns.size.has_value(), "r");
  if (!missing.empty())
  {
    refuse(path, "lacks the column " + missing + "; separated by " + separator + ", it has " + found, wanted);
  }
  return columns;
}

} // namespace

packing::Packing readPackingTable(const fs::path& path, const PackingTableOptions& options)
{
  if (!(options.unit > 0))
  {
    throw ParameterError("the table's unit of length is " + std::to_string(options.unit) + " m",
      "give a length above 0, such as 1e-3 for millimetres");
  }
  const std::string names = firstLine(path);
  const auto* const separator = std::find_if(
    separators.begin(), separators.end(), [&](const Separator& s) { return names.find(s.sign) != std::string::npos; });
  const bool blanks = separator == separators.end() || separator->sign == ' ';
  const std::array<char, 2> sign{ blanks ? ' ' : separator->sign, '\0' };
  vtkNew<vtkDelimitedTextReader> reader;
  reader->SetFileName(path.c_str());
  reader->SetHaveHeaders(true);
  reader->SetFieldDelimiterCharacters(sign.data());
  reader->SetMergeConsecutiveDelimiters(blanks);
  reader->DetectNumericColumnsOff(); // text among the numbers is for us to point at
  reader->Update();
  vtkTable* const table = reader->GetOutput();
  const Columns columns = findColumns(path, table, blanks ? "blanks" : separator->name);

  const bool spheres = columns.y && columns.z;
  const Column& second = columns.y ? *columns.y : *columns.z;
  std::vector<std::array<double, 3>> centre;
  std::vector<double> radius;
  for (vtkIdType row = 0; row < table->GetNumberOfRows(); ++row)
  {
    centre.push_back({ columns.x->number(path, row) * options.unit, second.number(path, row) * options.unit,
      spheres ? columns.z->number(path, row) * options.unit : 0.0 });
    radius.push_back(columns.size->number(path, row) * columns.sizeToRadius * options.unit);
  }
  try
  {
    return packing::packingOf(spheres ? 3 : 2, centre, radius, options.box);
  }
  catch (const InputError& error)
  {
    throw InputError("'" + path.string() + "': " + error.what(), error.hint());
  }
}

} // namespace lamella
