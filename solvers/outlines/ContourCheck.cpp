#include "outlines/ContourCheck.h"

#include "core/Error.h"
#include "outlines/ContourBorder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace lamella::micrograph
{
namespace
{

/// Faults that a chain has by itself.
void checkChain(const ContourSet& set, std::size_t k, std::vector<ContourFinding>& found)
{
  const Contour& c = set.contours[k];
  const auto tell = [&](ContourFault fault, const Point& at) { found.push_back({ fault, k, k, at }); };
  for (const Point& p : c.points)
  {
    if (!std::isfinite(p[0]) || !std::isfinite(p[1]))
    {
      tell(ContourFault::NotFinite, p);
      return;
    }
  }
  if (c.points.size() < (c.closed ? 3U : 2U))
  {
    tell(ContourFault::FewPoints, c.points.empty() ? Point{ 0, 0 } : c.points.front());
    return;
  }
  for (std::size_t i = c.closed ? 0 : 1; i < c.points.size(); ++i)
  {
    if (c.points[i] == c.points[i == 0 ? c.points.size() - 1 : i - 1])
    {
      tell(ContourFault::Repeated, c.points[i]);
      break;
    }
  }
  const double near = 1e-9 * (set.size[0] + set.size[1]);
  for (const Point& p : c.points)
  {
    if (p[0] < -near || p[1] < -near || p[0] > set.size[0] + near || p[1] > set.size[1] + near)
    {
      tell(ContourFault::Outside, p);
      break;
    }
  }
  if (c.closed)
  {
    if (polygonArea(c.points) <= 0)
      tell(ContourFault::Clockwise, c.points.front());
    return;
  }
  for (const Point& p : { c.points.front(), c.points.back() })
  {
    if (!borderPosition(set.size, p))
    {
      tell(ContourFault::EndInside, p);
      break;
    }
  }
}

/// Lumens inside others: each outline's first point against those whose box holds it, found by bands along y.
void findNested(const ContourSet& set, const std::vector<Outline>& all, std::vector<ContourFinding>& found)
{
  struct Box
  {
    Point low{ std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity() };
    Point high{ -std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity() };
  };
  std::vector<Box> box(all.size());
  for (std::size_t i = 0; i < all.size(); ++i)
  {
    for (const Point& p : all[i].points)
    {
      for (std::size_t axis = 0; axis < 2; ++axis)
      {
        box[i].low[axis] = std::min(box[i].low[axis], p[axis]);
        box[i].high[axis] = std::max(box[i].high[axis], p[axis]);
      }
    }
  }
  const std::size_t bands = std::clamp<std::size_t>(all.size() / 4, 1, 4096);
  const auto band = [&](double y)
  {
    const double share = set.size[1] > 0 ? y / set.size[1] : 0.0;
    return static_cast<std::size_t>(std::clamp(share, 0.0, 1.0) * static_cast<double>(bands - 1));
  };
  std::vector<std::vector<std::size_t>> inBand(bands);
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t b = band(box[i].low[1]); b <= band(box[i].high[1]); ++b)
      inBand[b].push_back(i);
  for (std::size_t i = 0; i < all.size(); ++i)
  {
    const Point& p = all[i].points.front();
    for (const std::size_t k : inBand[band(p[1])])
    {
      const bool within = k != i && box[k].low[0] <= box[i].low[0] && box[k].low[1] <= box[i].low[1] &&
        box[k].high[0] >= box[i].high[0] && box[k].high[1] >= box[i].high[1];
      if (within && holds(all[k].points, p))
      {
        found.push_back({ ContourFault::Nested, all[i].chains.front(), all[k].chains.front(), p });
        break;
      }
    }
  }
}

/// Do chains of one outline share a number that no other has?
void checkNumbers(const ContourSet& set, const std::vector<Outline>& all, std::vector<ContourFinding>& found)
{
  std::map<std::int32_t, std::size_t> owner;
  for (const Outline& outline : all)
  {
    const std::size_t first = outline.chains.front();
    const auto [at, fresh] = owner.try_emplace(outline.lumen, first);
    if (!fresh)
    {
      found.push_back({ ContourFault::LumenNumber, first, at->second, set.contours[first].points.front() });
      continue;
    }
    for (const std::size_t k : outline.chains)
    {
      if (set.contours[k].lumen != outline.lumen)
      {
        found.push_back({ ContourFault::LumenNumber, k, first, set.contours[k].points.front() });
        break;
      }
    }
  }
}

} // namespace

std::string ContourFinding::text() const
{
  const std::size_t a = contour + 1;
  const std::size_t b = other + 1;
  const std::string place = fmt::format("({:.6g}, {:.6g}) m", at[0], at[1]);
  switch (fault)
  {
    case ContourFault::NotFinite:
      return fmt::format("contour {} has a coordinate that is no finite number", a);
    case ContourFault::FewPoints:
      return fmt::format("contour {} has too few points to enclose anything", a);
    case ContourFault::Repeated:
      return fmt::format("contour {} has the point {} twice in a row", a, place);
    case ContourFault::Outside:
      return fmt::format("contour {} leaves the picture at {}", a, place);
    case ContourFault::EndInside:
      return fmt::format("open contour {} ends inside the picture, at {}", a, place);
    case ContourFault::Clockwise:
      return fmt::format("contour {} runs clockwise or has no area", a);
    case ContourFault::BorderOrder:
      return fmt::format("open contour {} does not fit the others along the border, at {}", a, place);
    case ContourFault::LumenNumber:
      return fmt::format("contours {} and {} have the wrong lumen numbers", a, b);
    case ContourFault::Crossing:
      return a == b ? fmt::format("contour {} crosses or touches itself near {}", a, place)
                    : fmt::format("contours {} and {} cross or touch near {}", a, b, place);
    case ContourFault::Nested:
      return fmt::format("contour {} lies inside contour {}, at {}", a, b, place);
  }
  return {};
}

std::vector<ContourFinding> validate(const ContourSet& set)
{
  std::vector<ContourFinding> found;
  for (std::size_t k = 0; k < set.contours.size(); ++k)
    checkChain(set, k, found);
  const auto has = [&](ContourFault fault)
  { return std::any_of(found.begin(), found.end(), [&](const ContourFinding& f) { return f.fault == fault; }); };
  if (has(ContourFault::NotFinite))
    return found;
  const std::vector<ContourFinding> crossings = findCrossings(set);
  found.insert(found.end(), crossings.begin(), crossings.end());
  if (!crossings.empty() || has(ContourFault::FewPoints) || has(ContourFault::EndInside))
    return found;
  try
  {
    const std::vector<Outline> all = outlines(set);
    findNested(set, all, found);
    checkNumbers(set, all, found);
  }
  catch (const InputError&)
  {
    const auto open =
      std::find_if(set.contours.begin(), set.contours.end(), [](const Contour& c) { return !c.closed; });
    const auto k = static_cast<std::size_t>(open - set.contours.begin());
    found.push_back({ ContourFault::BorderOrder, k, k, open->points.front() });
  }
  return found;
}

void requireValid(const ContourSet& set, const std::string& what)
{
  const std::vector<ContourFinding> found = validate(set);
  if (found.empty())
    return;
  std::string hint;
  switch (found.front().fault)
  {
    case ContourFault::Crossing:
      hint = "draw these contours anew; the walls between lumens have a thickness everywhere";
      break;
    case ContourFault::Nested:
      hint = "a lumen has no wall inside it: take out one of the two, or give cells under \"outer\"";
      break;
    case ContourFault::Outside:
      hint = "give a picture (size, window) that holds all contours";
      break;
    default:
      hint = "closed contours run counter-clockwise; open ones have their lumen on the left and end on the border";
  }
  throw InputError(fmt::format("{}: {}{}", what, found.front().text(),
                     found.size() > 1 ? fmt::format(" (and {} more such faults)", found.size() - 1) : std::string{}),
    hint);
}

} // namespace lamella::micrograph
