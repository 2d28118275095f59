#include "PackingTable.h"

#include "TextTable.h"

#include "core/Error.h"

#include <cmath>
#include <string>
#include <vector>

namespace fs = std::filesystem;

namespace lamella
{
namespace
{

/// "x,z,r" and the rest of what every message about columns ends in.
constexpr const char* wanted = "the first line names the columns: x,z,r or x,y,r for disks, x,y,z,r for spheres";

struct Columns
{
  std::optional<std::size_t> x;
  std::optional<std::size_t> y;
  std::optional<std::size_t> z;
  std::optional<std::size_t> radius;
  std::optional<std::size_t> diameter;
};

Columns findColumns(const TextTable& table)
{
  Columns columns;
  for (std::size_t i = 0; i < table.names().size(); ++i)
  {
    const std::string name = TextTable::plainName(table.names()[i]);
    const auto take = [&](std::optional<std::size_t>& place)
    {
      if (place)
        table.refuse("has two columns for the same: '" + table.names()[*place] + "' and '" + table.names()[i] + "'",
          "leave one out");
      place = i;
    };
    if (name == "x")
      take(columns.x);
    else if (name == "y")
      take(columns.y);
    else if (name == "z")
      take(columns.z);
    else if (name == "r" || name == "radius")
      take(columns.radius);
    else if (name == "d" || name == "diameter")
      take(columns.diameter);
  }
  std::string missing;
  const auto need = [&](bool there, const char* name)
  { missing += there ? "" : (missing.empty() ? "" : ", ") + std::string(name); };
  need(columns.x.has_value(), "x");
  need(columns.y || columns.z, "y or z");
  need(columns.radius || columns.diameter, "r");
  if (!missing.empty())
    table.lacks(missing);
  return columns;
}

/// The radius in a row. Where the table has the diameter as well, as ours do, it must be twice that: the last of seven
/// digits may differ.
double radiusOf(const TextTable& table, const Columns& columns, std::size_t row)
{
  if (!columns.radius)
    return table.number(row, *columns.diameter) / 2;
  const double radius = table.number(row, *columns.radius);
  if (columns.diameter)
  {
    const double diameter = table.number(row, *columns.diameter);
    if (!(std::abs(diameter - 2 * radius) <= 1e-6 * std::abs(diameter)))
    {
      table.refuse("has a radius of " + table.text(row, *columns.radius) + " and a diameter of " +
          table.text(row, *columns.diameter) + " in row " + std::to_string(row + 2),
        "make the diameter twice the radius, or leave one of the columns out");
    }
  }
  return radius;
}

} // namespace

packing::Packing readPackingTable(const fs::path& path, const PackingTableOptions& options)
{
  if (!(options.unit > 0))
  {
    throw ParameterError("the table's unit of length is " + std::to_string(options.unit) + " m",
      "give a length above 0, such as 1e-3 for millimetres");
  }
  const TextTable table(path, wanted);
  const Columns columns = findColumns(table);

  // Disks of a .vtp lie at z = 0, and so they do in a table that lamella convert made of it.
  bool spheres = false;
  for (std::size_t row = 0; row < table.rows() && columns.y && columns.z && !spheres; ++row)
    spheres = table.number(row, *columns.z) != 0;
  const std::size_t second = columns.y ? *columns.y : *columns.z;
  std::vector<std::array<double, 3>> centre;
  std::vector<double> radius;
  for (std::size_t row = 0; row < table.rows(); ++row)
  {
    centre.push_back({ table.number(row, *columns.x) * options.unit, table.number(row, second) * options.unit,
      spheres ? table.number(row, *columns.z) * options.unit : 0.0 });
    radius.push_back(radiusOf(table, columns, row) * options.unit);
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
