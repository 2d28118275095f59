#include "CrackColumns.h"

#include <algorithm>
#include <limits>
#include <numbers>

namespace lamella
{
namespace
{

using cracks::ChainEnd;
using cracks::CrackPath;
using cracks::CrackPoint;

constexpr double degrees = 180 / std::numbers::pi;

} // namespace

std::vector<PathColumn> pathColumns(const cracks::CrackPaths& all, const CrackScale& scale)
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
  for (const std::size_t axis : { std::size_t{ 0 }, std::size_t{ 1 } })
  {
    columns.push_back({ axis == 0 ? "through_x" : "through_y", "1", "1: on the shortest way from side to side",
      [=, &scale, &all](const CrackPath& p)
      {
        const std::vector<std::size_t>& on = scale.through[axis].paths;
        const auto number = static_cast<std::size_t>(&p - all.paths.data());
        return std::find(on.begin(), on.end(), number) != on.end() ? 1.0 : 0.0;
      },
      true });
  }
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
          most = std::max(most, point.opening);
        return most;
      } });
  }
  return columns;
}

const char* unitOf(const std::string& when)
{
  return when == "time" ? "s" : "1";
}

std::array<double, 3> placed(const CrackScale& scale, const CrackPoint& point)
{
  const Lattice& l = scale.input.lattice;
  return { l.origin[0] + l.spacing * point.place[0], l.origin[1] + l.spacing * point.place[1], l.origin[2] };
}

} // namespace lamella
