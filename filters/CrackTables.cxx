#include "CrackTables.h"

#include "TableColumns.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkIntArray.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"
#include "vtkTypeInt64Array.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>

namespace lamella
{
namespace
{

using cracks::ChainEnd;
using cracks::CrackPath;
using cracks::CrackPaths;
using cracks::CrackPoint;

constexpr const char* creator = "vtkCrackPath";
constexpr double degrees = 180 / std::numbers::pi;
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

const char* wordOf(ChainEnd end)
{
  switch (end)
  {
    case ChainEnd::Tip:
      return "tip";
    case ChainEnd::Junction:
      return "junction";
    case ChainEnd::Border:
      return "side";
    case ChainEnd::Void:
      return "void";
    default:
      return "closed";
  }
}

/// Unit of CutBond::when.
const char* unitOf(const std::string& when)
{
  return when == "time" ? "s" : "1";
}

double share(double part, double all)
{
  return all > 0 ? part / all : 0;
}

template <typename Array>
vtkSmartPointer<Array> arrayOf(const std::string& name, int components, const char* unit, const char* description)
{
  const auto array = vtkSmartPointer<Array>::New();
  array->SetName(name.c_str());
  array->SetNumberOfComponents(components);
  describe(array, unit, description, creator);
  return array;
}

/// Numbers of paths: the same in the table and at the poly-lines.
struct PathColumn
{
  const char* name;
  const char* unit;
  const char* description;
  std::function<double(const CrackPath&)> value;
  bool whole = false;
};

std::vector<PathColumn> pathColumns(const CrackScale& scale)
{
  const auto metres = [&scale](double spacings) { return scale.metres(spacings); };
  std::vector<PathColumn> columns{
    { "crack", "1", "paths that hang together have the same number; 1 is the longest crack",
      [](const CrackPath& p) { return p.crack + 1; }, true },
    { "length", "m", "length of the path", [=](const CrackPath& p) { return metres(p.length); } },
    { "chord", "m", "distance between its ends; 0 of a closed one",
      [=](const CrackPath& p) { return metres(p.chord); } },
    { "tortuosity", "1", "length over chord; NaN of a closed one", [](const CrackPath& p) { return p.tortuosity(); } },
    { "angle", "deg", "axial mean direction to x, weighted by length",
      [](const CrackPath& p) { return degrees * p.orientation.angle; } },
    { "angle_spread", "deg", "axial standard deviation",
      [](const CrackPath& p) { return degrees * p.orientation.spread; } },
    { "bonds", "1", "broken bonds that cross it", [](const CrackPath& p) { return static_cast<double>(p.bonds); },
      true },
    { "counted_length", "m", "length that the number of its broken bonds stands for",
      [=](const CrackPath& p) { return metres(p.countedLength()); } },
    { "first_event", "1", "of its bonds", [](const CrackPath& p) { return static_cast<double>(p.events[0]); }, true },
    { "last_event", "1", "of its bonds", [](const CrackPath& p) { return static_cast<double>(p.events[1]); }, true },
    { "closed", "1", "1: it ends where it begins",
      [](const CrackPath& p) { return p.ends[0] == ChainEnd::None ? 1.0 : 0.0; }, true },
  };
  if (scale.input.when != "event")
  {
    const bool time = scale.input.when == "time";
    columns.push_back({ time ? "first_time" : "first_strain", unitOf(scale.input.when), "of its bonds",
      [](const CrackPath& p) { return p.when[0]; } });
    columns.push_back({ time ? "last_time" : "last_strain", unitOf(scale.input.when), "of its bonds",
      [](const CrackPath& p) { return p.when[1]; } });
  }
  if (scale.opening)
  {
    columns.push_back({ "largest_opening", "m", "of its points",
      [](const CrackPath& p)
      {
        double most = -std::numeric_limits<double>::infinity();
        for (const CrackPoint& point : p.points)
        {
          most = std::max(most, point.opening);
        }
        return most;
      } });
  }
  return columns;
}

double lengthIn(const CrackPath& path, const cracks::PairShare& wanted)
{
  for (const cracks::PairShare& s : path.pairs)
  {
    if (s.phases == wanted.phases && s.betweenGrains == wanted.betweenGrains)
    {
      return s.length;
    }
  }
  return 0;
}

std::array<double, 3> placed(const CrackScale& scale, const CrackPoint& point)
{
  const Lattice& l = scale.input.lattice;
  return { l.origin[0] + l.spacing * point.place[0], l.origin[1] + l.spacing * point.place[1], l.origin[2] };
}

/// Points of all paths; ends that coincide are one.
class PointWriter
{
public:
  explicit PointWriter(const CrackScale& scale)
    : scale_(scale)
  {
    points_->SetDataTypeToDouble();
  }

  void add(const CrackPath& path, vtkCellArray* lines)
  {
    std::vector<vtkIdType> ids;
    double along = 0;
    for (std::size_t i = 0; i < path.points.size(); ++i)
    {
      const CrackPoint& p = path.points[i];
      if (i > 0)
      {
        const cracks::Place& before = path.points[i - 1].place;
        along += std::hypot(p.place[0] - before[0], p.place[1] - before[1]);
      }
      const bool end = i == 0 || i + 1 == path.points.size();
      if (const auto known = ends_.find(p.place); end && known != ends_.end())
      {
        ids.push_back(known->second);
        continue;
      }
      ids.push_back(points_->InsertNextPoint(placed(scale_, p).data()));
      if (end)
      {
        ends_[p.place] = ids.back();
      }
      event_->InsertNextValue(p.event);
      when_->InsertNextValue(p.when);
      phases_->InsertNextTuple2(p.phases[0], p.phases[1]);
      between_->InsertNextValue(p.betweenGrains ? 1 : 0);
      along_->InsertNextValue(scale_.metres(along));
      opening_->InsertNextValue(p.opening);
      sliding_->InsertNextValue(p.sliding);
    }
    lines->InsertNextCell(static_cast<vtkIdType>(ids.size()), ids.data());
  }

  void write(vtkPolyData* output) const
  {
    output->SetPoints(points_);
    vtkPointData* const data = output->GetPointData();
    data->AddArray(event_);
    if (scale_.input.when != "event")
    {
      data->AddArray(when_);
    }
    if (!scale_.phases.empty())
    {
      data->AddArray(phases_);
      data->AddArray(between_);
    }
    data->AddArray(along_);
    if (scale_.opening)
    {
      data->AddArray(opening_);
      data->AddArray(sliding_);
    }
  }

private:
  const CrackScale& scale_;
  std::map<cracks::Place, vtkIdType> ends_;
  vtkNew<vtkPoints> points_;
  vtkSmartPointer<vtkTypeInt64Array> event_ =
    arrayOf<vtkTypeInt64Array>("event", 1, "1", "at which half of the bonds there were broken");
  vtkSmartPointer<vtkDoubleArray> when_ = arrayOf<vtkDoubleArray>(
    scale_.input.when, 1, unitOf(scale_.input.when), "at which half of the bonds there were broken");
  vtkSmartPointer<vtkUnsignedCharArray> phases_ =
    arrayOf<vtkUnsignedCharArray>("phases", 2, "1", "of the two nodes that the crack parts, the lesser first");
  vtkSmartPointer<vtkUnsignedCharArray> between_ =
    arrayOf<vtkUnsignedCharArray>("between_grains", 1, "1", "1: these lie in two different grains");
  vtkSmartPointer<vtkDoubleArray> along_ = arrayOf<vtkDoubleArray>("arc_length", 1, "m", "from the path's first point");
  vtkSmartPointer<vtkDoubleArray> opening_ =
    arrayOf<vtkDoubleArray>("opening", 1, "m", "how far the two nodes went apart, across the path");
  vtkSmartPointer<vtkDoubleArray> sliding_ = arrayOf<vtkDoubleArray>("sliding", 1, "m", "the same along the path");
};

} // namespace

std::string CrackScale::pair(const cracks::PairShare& s) const
{
  const auto name = [&](std::uint8_t id) { return id < phases.size() ? phases[id] : std::to_string(id); };
  if (s.phases[0] == s.phases[1])
  {
    return s.betweenGrains ? name(s.phases[0]) + "-" + name(s.phases[0]) : name(s.phases[0]);
  }
  return name(s.phases[0]) + "-" + name(s.phases[1]) + (s.betweenGrains ? " (grains)" : "");
}

void fillCrackPaths(vtkPolyData* output, const CrackPaths& paths, const CrackScale& scale)
{
  PointWriter writer(scale);
  vtkNew<vtkCellArray> lines;
  for (const CrackPath& path : paths.paths)
  {
    writer.add(path, lines);
  }
  writer.write(output);
  output->SetLines(lines);
  const auto number = arrayOf<vtkIntArray>("path", 1, "1", "number of the path; 1 is the longest");
  for (std::size_t p = 0; p < paths.paths.size(); ++p)
  {
    number->InsertNextValue(static_cast<int>(p) + 1);
  }
  output->GetCellData()->AddArray(number);
  const auto add = [&](auto array, const PathColumn& column)
  {
    for (const CrackPath& path : paths.paths)
    {
      array->InsertNextTuple1(column.value(path));
    }
    output->GetCellData()->AddArray(array);
  };
  for (const PathColumn& column : pathColumns(scale))
  {
    if (column.whole)
    {
      add(arrayOf<vtkTypeInt64Array>(column.name, 1, column.unit, column.description), column);
    }
    else
    {
      add(arrayOf<vtkDoubleArray>(column.name, 1, column.unit, column.description), column);
    }
  }
}

void fillPathTable(vtkTable* table, const CrackPaths& paths, const CrackScale& scale)
{
  const std::vector<CrackPath>& list = paths.paths;
  const Columns columns{ table, list.size(), creator };
  columns.counts(
    "path", "number of the path; 1 is the longest", [](std::size_t i) { return static_cast<vtkIdType>(i) + 1; });
  for (const PathColumn& column : pathColumns(scale))
  {
    if (column.whole)
    {
      columns.counts(
        column.name, column.description, [&](std::size_t i) { return std::llround(column.value(list[i])); });
    }
    else
    {
      columns.numbers(
        column.name, column.unit, column.description, [&](std::size_t i) { return column.value(list[i]); });
    }
  }
  for (const std::size_t end : { std::size_t{ 0 }, std::size_t{ 1 } })
  {
    vtkNew<vtkStringArray> words;
    words->SetName(end == 0 ? "begins_at" : "ends_at");
    for (const CrackPath& path : list)
    {
      words->InsertNextValue(wordOf(path.ends[end]));
    }
    table->AddColumn(words);
  }
  for (std::size_t axis = 0; axis < 2; ++axis)
  {
    for (const bool high : { false, true })
    {
      columns.numbers(std::string(axis == 0 ? "x" : "y") + (high ? "_max" : "_min"), "m", "extent",
        [&](std::size_t i)
        {
          double bound = placed(scale, list[i].points.front())[axis];
          for (const CrackPoint& point : list[i].points)
          {
            const double at = placed(scale, point)[axis];
            bound = high ? std::max(bound, at) : std::min(bound, at);
          }
          return bound;
        });
    }
  }
  if (!scale.phases.empty())
  {
    for (const cracks::PairShare& pair : paths.pairs)
    {
      columns.numbers("share_" + scale.pair(pair), "1", "share of the length between nodes of these phases",
        [&](std::size_t i) { return share(lengthIn(list[i], pair), list[i].length); });
    }
  }
}

void fillPairTable(
  vtkTable* table, const CrackPaths& paths, std::span<const cracks::PairShare> counted, const CrackScale& scale)
{
  struct Row
  {
    cracks::PairShare pair;
    double length = 0;
  };
  std::vector<Row> rows;
  double bonds = 0;
  double size = 0;
  for (const cracks::PairShare& s : counted)
  {
    const auto on = std::find_if(paths.pairs.begin(), paths.pairs.end(),
      [&](const cracks::PairShare& p) { return p.phases == s.phases && p.betweenGrains == s.betweenGrains; });
    rows.push_back({ s, on != paths.pairs.end() ? on->length : 0 });
    bonds += static_cast<double>(s.bonds);
    size += s.counted;
  }
  // paths may run between phases that only the image knows
  for (const cracks::PairShare& p : paths.pairs)
  {
    if (std::none_of(counted.begin(), counted.end(),
          [&](const cracks::PairShare& s) { return p.phases == s.phases && p.betweenGrains == s.betweenGrains; }))
    {
      rows.push_back({ { p.phases, p.betweenGrains }, p.length });
    }
  }
  const bool space = scale.input.lattice.dimension == 3;
  const Columns columns{ table, rows.size(), creator };
  vtkNew<vtkStringArray> names;
  names->SetName("pair");
  for (const Row& row : rows)
  {
    names->InsertNextValue(scale.pair(row.pair));
  }
  table->AddColumn(names);
  columns.counts("phase_low", "lesser phase", [&](std::size_t i) { return rows[i].pair.phases[0]; });
  columns.counts("phase_high", "greater phase", [&](std::size_t i) { return rows[i].pair.phases[1]; });
  columns.counts(
    "between_grains", "1: in two different grains", [&](std::size_t i) { return rows[i].pair.betweenGrains ? 1 : 0; });
  if (!space)
  {
    columns.numbers("length", "m", "of the paths between nodes of these phases",
      [&](std::size_t i) { return scale.metres(rows[i].length); });
    columns.numbers(
      "share", "1", "of the length of all paths", [&](std::size_t i) { return share(rows[i].length, paths.length); });
  }
  columns.counts("bonds", "broken bonds between these phases", [&](std::size_t i) { return rows[i].pair.bonds; });
  columns.numbers("share_of_bonds", "1", "of all broken bonds",
    [&](std::size_t i) { return share(static_cast<double>(rows[i].pair.bonds), bonds); });
  columns.numbers(space ? "counted_area" : "counted_length", space ? "m^2" : "m", "that their number stands for",
    [&](std::size_t i)
    { return rows[i].pair.counted * std::pow(scale.input.lattice.spacing, scale.input.lattice.dimension - 1); });
  columns.numbers(
    "share_of_counted", "1", "of all of it", [&](std::size_t i) { return share(rows[i].pair.counted, size); });
}

void fillGrowthTable(vtkTable* table, const CrackPaths& paths, const CrackScale& scale)
{
  const std::vector<cracks::Growth> all = cracks::growth(paths);
  const std::vector<cracks::Growth> main =
    paths.cracks.empty() ? std::vector<cracks::Growth>() : cracks::growth(paths, 0);
  const Columns columns{ table, all.size(), creator };
  const auto mainAt = [&](std::size_t i) -> const cracks::Growth*
  {
    const auto after = std::upper_bound(main.begin(), main.end(), all[i].event,
      [](std::int64_t event, const cracks::Growth& g) { return event < g.event; });
    return after == main.begin() ? nullptr : &*std::prev(after);
  };
  columns.counts("event", "at which a path grew", [&](std::size_t i) { return all[i].event; });
  const bool time = scale.input.when == "time";
  if (scale.input.when != "event")
  {
    columns.numbers(
      scale.input.when, unitOf(scale.input.when), "of the event", [&](std::size_t i) { return all[i].when; });
  }
  columns.numbers("length", "m", "of all paths after it", [&](std::size_t i) { return scale.metres(all[i].length); });
  columns.numbers("main_length", "m", "of the longest crack's paths after it",
    [&](std::size_t i) { return mainAt(i) != nullptr ? scale.metres(mainAt(i)->length) : 0; });
  if (time)
  {
    columns.numbers("rate", "m/s", "at which all paths grow, over ten spacings before and after",
      [&](std::size_t i) { return scale.metres(all[i].rate); });
    columns.numbers("main_rate", "m/s", "the same of the longest crack",
      [&](std::size_t i) { return mainAt(i) != nullptr ? scale.metres(mainAt(i)->rate) : unknown; });
  }
}

void fillFragmentTable(vtkTable* table, const CrackFragments& fragments, const Lattice& lattice)
{
  const std::vector<CrackFragment>& list = fragments.list;
  const bool space = lattice.dimension == 3;
  const Columns columns{ table, list.size(), creator };
  columns.counts("fragment", "number of the fragment; 1 is the largest",
    [](std::size_t i) { return static_cast<vtkIdType>(i) + 1; });
  columns.counts("nodes", "of the fragment", [&](std::size_t i) { return list[i].nodes; });
  columns.numbers(space ? "volume" : "area", space ? "m^3" : "m^2", "of the fragment",
    [&](std::size_t i) { return static_cast<double>(list[i].nodes) * std::pow(lattice.spacing, lattice.dimension); });
  columns.numbers("share", "1", "of the solid",
    [&](std::size_t i) { return share(static_cast<double>(list[i].nodes), static_cast<double>(fragments.nodes())); });
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(lattice.dimension); ++axis)
  {
    for (const std::size_t end : { std::size_t{ 0 }, std::size_t{ 1 } })
    {
      const std::string name = std::string("touches_") + "xyz"[axis] + (end == 0 ? "_min" : "_max");
      columns.counts(name, end == 0 ? "1: it has a node in the first layer" : "1: it has a node in the last layer",
        [&](std::size_t i) { return list[i].touches[axis][end] ? 1 : 0; });
    }
  }
}

} // namespace lamella
