#include "outlines/PolygonRings.h"

#include "core/Error.h"
#include "outlines/ContourBorder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace lamella::micrograph
{

void RingReader::fail(const std::string& what, const std::string& hint) const
{
  throw InputError(fmt::format("'{}': {}", name_, what), hint);
}

double RingReader::findUnit(const Json& json, std::optional<double> given) const
{
  if (given)
    return *given;
  if (!json.is_object() || !(json.contains("units") || json.contains("unit")))
    fail("it does not say the unit of its coordinates", "give the unit, or write \"units\": \"um\" into the file");
  const Json& said = json.contains("units") ? json["units"] : json["unit"];
  if (!said.is_string())
    fail(fmt::format("its units are a {}, not a name", said.type_name()), "write \"units\": \"um\"");
  std::string word = said.get<std::string>();
  if (word.size() > 2 && word.back() == 's')
    word.pop_back();
  static const std::map<std::string, double> metres{ { "m", 1 }, { "metre", 1 }, { "meter", 1 }, { "mm", 1e-3 },
    { "millimetre", 1e-3 }, { "millimeter", 1e-3 }, { "um", 1e-6 }, { "µm", 1e-6 }, { "μm", 1e-6 },
    { "micrometre", 1e-6 }, { "micrometer", 1e-6 }, { "micron", 1e-6 }, { "nm", 1e-9 }, { "nanometre", 1e-9 },
    { "nanometer", 1e-9 } };
  const auto found = metres.find(word);
  if (found == metres.end())
    fail(fmt::format("its units '{}' are not known", word.substr(0, 40)), "use m, mm, um or nm, or give the unit");
  return found->second;
}

double RingReader::number(const Json& value, const std::string& what) const
{
  if (!value.is_number())
  {
    fail(fmt::format("{} has a {} where a number should be", what, value.type_name()),
      "points are lists of two numbers: [x, y]");
  }
  const double v = value.get<double>();
  if (!std::isfinite(v))
    fail(fmt::format("{} has a coordinate that is no finite number", what), "take the point out");
  return v;
}

Polygon RingReader::points(const Json& list, const std::string& what) const
{
  if (!list.is_array())
    fail(fmt::format("{} is a {}, not a list of points", what, list.type_name()), polygonKinds);
  Polygon result;
  result.reserve(list.size());
  for (const Json& p : list)
  {
    if (!p.is_array() || p.size() != 2)
    {
      fail(p.is_array() ? fmt::format("{} has a point of {} numbers", what, p.size())
                        : fmt::format("{} has a {} where a point should be", what, p.type_name()),
        "points are lists of two numbers: [x, y]");
    }
    result.push_back({ number(p[0], what), number(p[1], what) });
  }
  return result;
}

Polygon RingReader::ring(const Json& list, const std::string& what, double unit, bool yDown)
{
  Polygon p = points(list, what);
  const std::size_t given = p.size();
  p.erase(std::unique(p.begin(), p.end()), p.end());
  repeated_ += given - p.size();
  double gap = 0;
  if (p.size() > 1 && p.front() == p.back())
    p.pop_back();
  else if (p.size() > 1)
    gap = std::hypot(p.back()[0] - p.front()[0], p.back()[1] - p.front()[1]);
  if (p.size() < 3)
  {
    fail(fmt::format("{} has {} different point{}", what, p.size(), p.size() == 1 ? "" : "s"),
      "a polygon needs three or more; take it out");
  }
  double longest = 0;
  for (std::size_t i = 1; i < p.size(); ++i)
    longest = std::max(longest, std::hypot(p[i][0] - p[i - 1][0], p[i][1] - p[i - 1][1]));
  for (Point& q : p)
  {
    q = { q[0] * unit, q[1] * (yDown ? -unit : unit) };
    for (const double v : q)
      if (!(std::abs(v) <= 1e3 * largestPicture))
        fail(fmt::format("{} has the coordinate {:g} m", what, v), "check the file, and the unit of its coordinates");
  }
  const double area = polygonArea(p);
  if (area < 0)
    std::reverse(p.begin(), p.end());
  if (area == 0)
  {
    warnings_.push_back(fmt::format("{} has no area and was left out", what));
    p.clear();
  }
  else if (gap > 1.5 * longest)
  {
    warnings_.push_back(
      fmt::format("{} is open by {:.3g} (its longest side is {:.3g}): closed by a straight line", what, gap, longest));
  }
  return p;
}

std::vector<std::string> RingReader::warnings() const
{
  std::vector<std::string> all = warnings_;
  if (repeated_ > 0)
    all.push_back(fmt::format("{} point{} repeated in a row left out", repeated_, repeated_ == 1 ? "" : "s"));
  return all;
}

} // namespace lamella::micrograph
