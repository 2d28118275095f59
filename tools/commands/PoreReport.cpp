#include "commands/PoreReport.h"

#include "files/JsonReport.h"
#include "files/Record.h"
#include "session/Text.h"

#include "lattice/AxisNames.h"
#include "vtkLatticeConversion.h"
#include "vtkPoreFloodFill.h"

#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkTable.h>

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <span>

namespace lamella::cli
{

namespace
{

double cell(vtkTable* table, vtkIdType row, const std::string& column)
{
  return vtkDataArray::SafeDownCast(table->GetColumnByName(column.c_str()))->GetTuple1(row);
}

std::int64_t wholeCell(vtkTable* table, vtkIdType row, const std::string& column)
{
  return std::llround(cell(table, row, column));
}

/// Numbers of the field data, by name.
struct Numbers
{
  vtkImageData* image;
  double operator()(const char* name, std::size_t i = 0) const { return fieldNumbers(image, name).at(i); }
  [[nodiscard]] std::int64_t whole(const char* name, std::size_t i = 0) const { return std::llround((*this)(name, i)); }
};

std::vector<std::string> percolating(const Numbers& numbers)
{
  std::vector<std::string> found;
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (numbers("pore_percolates", axis) != 0)
      found.emplace_back(axisNames[axis]);
  return found;
}

/// The box of a pore as --window takes it: of a picture from the top row. A box that goes on over a periodic side is
/// given as it is.
std::vector<std::int64_t> window(vtkTable* table, vtkIdType row, const Lattice& lattice)
{
  std::vector<std::int64_t> start;
  std::vector<std::int64_t> size;
  for (int axis = 0; axis < lattice.dimension; ++axis)
  {
    const std::string name = axisNames[static_cast<std::size_t>(axis)];
    const std::int64_t first = wholeCell(table, row, name + "_first");
    const std::int64_t last = wholeCell(table, row, name + "_last");
    const bool fromTop = lattice.dimension == 2 && axis == 1;
    start.push_back(fromTop ? lattice.size[1] - 1 - last : first);
    size.push_back(last - first + 1);
  }
  start.insert(start.end(), size.begin(), size.end());
  return start;
}

/// The sides that a pore touches, as people see them.
std::vector<std::string> sides(vtkTable* table, vtkIdType row, int dimension)
{
  static const std::array<std::pair<const char*, const char*>, 6> names{ { { "touches_x_min", "left" },
    { "touches_x_max", "right" }, { "touches_y_max", "top" }, { "touches_y_min", "bottom" },
    { "touches_z_min", "z_min" }, { "touches_z_max", "z_max" } } };
  std::vector<std::string> found;
  for (const auto& [column, word] : names)
    if (cell(table, row, column) != 0)
      found.push_back(dimension == 3 ? std::string(column).substr(8) : word);
  return found;
}

std::string joined(const std::vector<std::int64_t>& values)
{
  return fmt::format("{}", fmt::join(values, ","));
}

} // namespace

std::string toJson(const PoreReport& report)
{
  auto* const image = vtkImageData::SafeDownCast(report.filter->GetOutputDataObject(0));
  const Numbers number{ image };
  const Lattice lattice = latticeOf(image);
  vtkTable* const pores = report.filter->GetPores();
  vtkTable* const classes = report.filter->GetSizeDistribution();
  Json json;
  json["file"] = report.file;
  json["phase"] = fieldText(image, "pore_phase").value_or("");
  json["connectivity"] = number.whole("pore_connectivity");
  json["periodic"] = Json::array();
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (number("pore_periodic", axis) != 0)
      json["periodic"].push_back(axisNames[axis]);
  json["size"] = std::vector<std::int64_t>(lattice.size.begin(), lattice.size.begin() + lattice.dimension);
  json["unit"] = lattice.dimension == 3 ? "voxels" : "pixels";
  json["pixel_size"] = report.metres ? Json(lattice.spacing) : Json(nullptr);
  json["count"] = number.whole("pore_count");
  json["largest"] = number.whole("pore_largest");
  json["mean"] = number("pore_mean");
  json["total"] = number.whole("pore_total");
  json["porosity"] = number("porosity");
  json["minimum_size"] = report.filter->GetMinimumSize();
  json["dropped"] = { { "count", number.whole("pore_dropped") }, { "total", number.whole("pore_dropped", 1) } };
  json["open"] = { { "count", number.whole("pore_open_count") }, { "share", number("pore_open") } };
  json["closed"] = { { "count", number.whole("pore_count") - number.whole("pore_open_count") },
    { "share", number("pore_closed") } };
  json["percolates"] = percolating(number);
  json["largest_pore"] = nullptr;
  if (pores->GetNumberOfRows() > 0)
  {
    vtkIdType row = 0;
    while (wholeCell(pores, row, "size") != number.whole("pore_largest"))
      ++row;
    json["largest_pore"] = { { "pore", wholeCell(pores, row, "pore") }, { "size", wholeCell(pores, row, "size") },
      { "equivalent_diameter", report.metres ? Json(cell(pores, row, "equivalent_diameter")) : Json(nullptr) },
      { "window", window(pores, row, lattice) }, { "touches", sides(pores, row, lattice.dimension) } };
  }
  json["distribution"] = Json::array();
  for (vtkIdType row = 0; row < classes->GetNumberOfRows(); ++row)
  {
    json["distribution"].push_back(
      { { "from", wholeCell(classes, row, "size_from") }, { "to", wholeCell(classes, row, "size_to") },
        { "count", wholeCell(classes, row, "pores") }, { "total", wholeCell(classes, row, "nodes") } });
  }
  json["ranks"] = report.ranks;
  json["seconds"] = report.seconds;
  json["files"] = report.written;
  addRecord(json, report.provenance);
  return dump(json);
}

std::string toTable(const PoreReport& report)
{
  auto* const image = vtkImageData::SafeDownCast(report.filter->GetOutputDataObject(0));
  const Numbers number{ image };
  const Lattice lattice = latticeOf(image);
  vtkTable* const pores = report.filter->GetPores();
  const std::string unit = lattice.dimension == 3 ? "voxels" : "pixels";
  const std::string kind = lattice.dimension == 3 ? "volume" : "picture";
  const auto line = [](const std::string& name, const std::string& text)
  { return fmt::format("  {:<11}{}\n", name, text); };
  std::string text =
    fmt::format("{}: pores of {}, {} neighbours, {}\n\n", report.file, fieldText(image, "pore_phase").value_or(""),
      number.whole("pore_connectivity"), sizeText(lattice.size, lattice.dimension));
  text += line("pores", grouped(number.whole("pore_count")));
  text += line("total",
    fmt::format(
      "{} {}; porosity {:.4f} of the {}", grouped(number.whole("pore_total")), unit, number("porosity"), kind));
  text += line("mean", fmt::format("{:.1f} {}", number("pore_mean"), unit));
  if (pores->GetNumberOfRows() > 0)
  {
    vtkIdType row = 0;
    while (wholeCell(pores, row, "size") != number.whole("pore_largest"))
      ++row;
    std::string largest = fmt::format("{} {}", grouped(number.whole("pore_largest")), unit);
    if (report.metres)
    {
      largest += fmt::format(", {} of {:.4g} µm", lattice.dimension == 3 ? "a sphere" : "a circle",
        1e6 * cell(pores, row, "equivalent_diameter"));
    }
    text += line("largest", largest + ", window " + joined(window(pores, row, lattice)));
  }
  if (number("pore_dropped") > 0)
  {
    text += line("left out",
      fmt::format("{} pores below {} {}, {} {} in all", grouped(number.whole("pore_dropped")),
        report.filter->GetMinimumSize(), unit, grouped(number.whole("pore_dropped", 1)), unit));
  }
  text += line("open",
    fmt::format("{} pores, {:.1f} % of the total; they touch a border", grouped(number.whole("pore_open_count")),
      100 * number("pore_open")));
  const std::vector<std::string> through = percolating(number);
  text += line("percolates",
    through.empty() ? "no pore leads from side to side" : fmt::format("along {}", fmt::join(through, ", ")));
  text += wroteText(report.written);
  return text;
}

} // namespace lamella::cli
