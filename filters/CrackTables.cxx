#include "CrackTables.h"
#include "Columns.h"
#include "CrackColumns.h"

#include "vtkDataSetAttributes.h"
#include "vtkTable.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lamella
{
namespace
{

using cracks::ChainEnd;
using cracks::CrackPath;
using cracks::CrackPaths;
using cracks::CrackPoint;

constexpr double notFound = std::numeric_limits<double>::quiet_NaN();

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

double share(double part, double all)
{
  return all > 0 ? part / all : 0;
}

double lengthIn(const CrackPath& path, const cracks::PairShare& wanted)
{
  for (const cracks::PairShare& s : path.pairs)
    if (s.phases == wanted.phases && s.betweenGrains == wanted.betweenGrains)
      return s.length;
  return 0;
}

} // namespace

std::string CrackScale::pair(const cracks::PairShare& s) const
{
  const auto name = [&](std::uint8_t id) { return id < phases.size() ? phases[id] : std::to_string(id); };
  if (s.phases[0] == s.phases[1])
    return s.betweenGrains ? name(s.phases[0]) + "-" + name(s.phases[0]) : name(s.phases[0]);
  return name(s.phases[0]) + "-" + name(s.phases[1]) + (s.betweenGrains ? " (grains)" : "");
}

void fillPathTable(vtkTable* table, const CrackPaths& paths, const CrackScale& scale)
{
  const std::vector<CrackPath>& list = paths.paths;
  const Columns columns{ table->GetRowData(), list, crackCreator };
  columns.counts("path", "number of the path; 1 is the longest", [](std::size_t i) { return i + 1; });
  for (const PathColumn& column : pathColumns(paths, scale))
    if (column.whole)
      columns.counts(column.name, column.description, column.value);
    else
      columns.numbers(column.name, column.unit, column.description, column.value);
  for (const std::size_t end : { std::size_t{ 0 }, std::size_t{ 1 } })
    columns.words(end == 0 ? "begins_at" : "ends_at", [&](const CrackPath& path) { return wordOf(path.ends[end]); });
  for (const bool last : { false, true })
  {
    for (std::size_t axis = 0; axis < 2; ++axis)
    {
      columns.numbers(
        std::string(last ? "end_" : "begin_") + "xy"[axis], "m", last ? "its last point" : "its first point",
        [&](std::size_t i) { return placed(scale, last ? list[i].points.back() : list[i].points.front())[axis]; });
    }
  }
  for (std::size_t axis = 0; axis < 2; ++axis)
  {
    for (const bool high : { false, true })
    {
      columns.numbers(
        std::string(axis == 0 ? "x" : "y") + (high ? "_max" : "_min"), "m", "extent",
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
      columns.numbers(
        "share_" + scale.pair(pair), "1", "share of the length between nodes of these phases",
        [&](std::size_t i) { return share(lengthIn(list[i], pair), list[i].length); });
    }
  }
}

void fillPairTable(vtkTable* table, std::span<const cracks::PairShare> found, double all,
  std::span<const cracks::PairShare> counted, const CrackScale& scale)
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
    const auto on = std::find_if(found.begin(), found.end(),
      [&](const cracks::PairShare& p) { return p.phases == s.phases && p.betweenGrains == s.betweenGrains; });
    rows.push_back({ s, on != found.end() ? on->length : 0 });
    bonds += static_cast<double>(s.bonds);
    size += s.counted;
  }
  // cracks may run between phases that only the image knows
  for (const cracks::PairShare& p : found)
    if (std::none_of(counted.begin(), counted.end(),
          [&](const cracks::PairShare& s) { return p.phases == s.phases && p.betweenGrains == s.betweenGrains; }))
      rows.push_back({ { p.phases, p.betweenGrains }, p.length });
  const bool space = scale.input.lattice.dimension == 3;
  const Columns columns{ table->GetRowData(), rows, crackCreator };
  columns.words(
    "pair", [&](const Row& row) { return scale.pair(row.pair); });
  columns.counts(
    "phase_low", "lesser phase", [](const Row& row) { return row.pair.phases[0]; });
  columns.counts(
    "phase_high", "greater phase", [](const Row& row) { return row.pair.phases[1]; });
  columns.counts(
    "between_grains", "1: in two different grains", [&](const Row& row) { return row.pair.betweenGrains ? 1 : 0; });
  const double unit = std::pow(scale.input.lattice.spacing, scale.input.lattice.dimension - 1);
  columns.numbers(
    space ? "area" : "length", space ? "m^2" : "m", "of the cracks between nodes of these phases",
    [&](const Row& row) { return unit * row.length; });
  columns.numbers(
    "share", "1", "of that of all cracks", [&](const Row& row) { return share(row.length, all); });
  columns.counts(
    "bonds", "broken bonds between these phases", [&](const Row& row) { return row.pair.bonds; });
  columns.numbers(
    "share_of_bonds", "1", "of all broken bonds",
    [&](const Row& row) { return share(static_cast<double>(row.pair.bonds), bonds); });
  columns.numbers(
    space ? "counted_area" : "counted_length", space ? "m^2" : "m", "that their number stands for",
    [&](const Row& row) { return row.pair.counted * unit; });
  columns.numbers(
    "share_of_counted", "1", "of all of it", [&](const Row& row) { return share(row.pair.counted, size); });
}

void fillGrowthTable(vtkTable* table, const CrackPaths& paths, const CrackScale& scale)
{
  const std::vector<cracks::Growth> all = cracks::growth(paths);
  const std::vector<cracks::Growth> main =
    paths.cracks.empty() ? std::vector<cracks::Growth>() : cracks::growth(paths, 0);
  const Columns columns{ table->GetRowData(), all, crackCreator };
  const auto mainAt = [&](std::size_t i) -> const cracks::Growth*
  {
    const auto after = std::upper_bound(main.begin(), main.end(), all[i].event,
      [](std::int64_t event, const cracks::Growth& g) { return event < g.event; });
    return after == main.begin() ? nullptr : &*std::prev(after);
  };
  columns.counts("event", "at which a path grew", &cracks::Growth::event);
  const bool time = scale.input.when == "time";
  if (scale.input.when != "event")
    columns.numbers(scale.input.when, unitOf(scale.input.when), "of the event", &cracks::Growth::when);
  columns.numbers(
    "length", "m", "of all paths after it", [&](std::size_t i) { return scale.metres(all[i].length); });
  columns.numbers("main_length", "m", "of the longest crack's paths after it",
    [&](std::size_t i) { return mainAt(i) != nullptr ? scale.metres(mainAt(i)->length) : 0; });
  if (time)
  {
    columns.numbers(
      "rate", "m/s", "at which all paths grow, over ten spacings before and after",
      [&](std::size_t i) { return scale.metres(all[i].rate); });
    columns.numbers("main_rate", "m/s", "the same of the longest crack",
      [&](std::size_t i) { return mainAt(i) != nullptr ? scale.metres(mainAt(i)->rate) : notFound; });
  }
}

void fillFragmentTable(vtkTable* table, const CrackFragments& fragments, const Lattice& lattice)
{
  const std::vector<CrackFragment>& list = fragments.list;
  const bool space = lattice.dimension == 3;
  const Columns columns{ table->GetRowData(), list, crackCreator };
  columns.counts("fragment", "number of the fragment; 1 is the largest", [](std::size_t i) { return i + 1; });
  columns.counts("nodes", "of the fragment", &CrackFragment::nodes);
  columns.numbers(
    space ? "volume" : "area", space ? "m^3" : "m^2", "of the fragment",
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
