#pragma once

#include "reports/Chart.h"
#include "reports/Html.h"

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

/// What a page of results shows, in which order: report.json, or made from what lies in the folder.
///
/// Texts are CommonMark. Files are named from the folder of the results and lie in it.
namespace lamella::reports
{

struct FigurePlan
{
  std::string file;
  std::string number; ///< "4", "4 (a)"; may be empty
  std::string caption;
  std::string alt;
};

struct ColumnPlan
{
  std::string name;
  std::string label; ///< the name where it is empty
  std::string unit;  ///< what NAME.csv.json says where it is empty
  Rounding rounding;
  double factor = 1; ///< numbers are multiplied by it: 1e-6 shows Pa as MPa
  std::string error; ///< the column that stands behind ±
};

struct TablePlan
{
  std::string file;
  std::string caption;
  std::vector<ColumnPlan> columns; ///< all of them where it is empty
  std::size_t rows = 200;          ///< no more are shown
};

struct CurvesPlan
{
  std::string file;
  std::string x;
  std::vector<std::string> y;
  std::string group; ///< each value of this column is a curve of its own
  std::string error;
  std::string xLabel;
  std::string yLabel;
  double xFactor = 1; ///< numbers are multiplied by it
  double yFactor = 1;
  bool logX = false;
  bool logY = false;
  bool points = false;
  std::string caption;
};

/// A chart whose numbers are there already.
struct ChartPlan
{
  Chart chart;
  std::string caption;
};

/// Small pictures side by side.
struct GridPlan
{
  struct Cell
  {
    std::string file;    ///< empty: there is none
    std::string caption; ///< plain text
  };
  std::string caption;
  std::size_t columns = 0; ///< up to 6; 0: as many as there is room for
  std::vector<Cell> cells;
};

/// One number of a table.
struct CellPlan
{
  std::string file;
  std::string column;
  std::map<std::string, std::string> where;
  std::string error;
  double factor = 1;
};

/// A number with or without its error.
struct Measured
{
  double value = 0;
  std::optional<double> error;
};

using Said = std::variant<std::string, Measured, CellPlan>;

/// What somebody says beside what was found here.
struct ComparisonPlan
{
  std::string what;
  std::string unit;
  std::optional<Said> paper;
  std::optional<Said> ours;
  std::string difference; ///< made from the two where both are numbers and it is empty
  std::string why;
  Rounding rounding;
};

struct SectionPlan
{
  std::string title;
  std::string text;
  std::vector<ComparisonPlan> comparison;
  std::vector<FigurePlan> figures;
  std::vector<CurvesPlan> curves;
  std::vector<ChartPlan> charts;
  std::vector<GridPlan> grids;
  std::vector<TablePlan> tables;
  std::string discussion;
  std::vector<SectionPlan> sections;
};

struct TimePlan
{
  std::string what;
  std::optional<double> seconds;          ///< by the clock
  std::optional<double> processorSeconds; ///< of all processors
  std::string note;
};

struct Plan
{
  std::string title;
  std::string text;
  std::string machine;
  std::vector<SectionPlan> sections;
  std::vector<TimePlan> times;
  std::size_t mostBytes = 0;                ///< of the page; 0: any
  bool scene = false;                       ///< scenes stand behind the sections, and reports are not shown
  std::map<std::string, std::string> names; ///< what people call files whose errors are shown
};

/// report.json.
/// @throws InputError: no JSON (with the line), a key that is not known, a value of another kind, a file outside the
///         folder; what() names the place, such as sections[2].figures[0].file
[[nodiscard]] Plan readPlan(const std::filesystem::path& file);

} // namespace lamella::reports
