#include "outlines/PolygonCells.h"

#include "core/Error.h"
#include "outlines/ContourCheck.h"
#include "outlines/ContourEdit.h"
#include "outlines/PolygonRings.h"

#include <algorithm>
#include <map>

namespace lamella::micrograph
{
namespace
{

std::map<std::int32_t, ContourSet> byNumber(const ContourSet& cells)
{
  std::map<std::int32_t, ContourSet> found;
  for (const Contour& contour : cells.contours)
    found.try_emplace(contour.lumen, ContourSet{ cells.size, {} }).first->second.contours.push_back(contour);
  return found;
}

/// One cell's chains behind the others', with numbers that follow theirs. @param last the highest number so far
void append(ContourSet& cells, ContourSet one, std::int32_t& last)
{
  const std::int32_t before = last;
  for (Contour& contour : one.contours)
  {
    contour.lumen += before;
    last = std::max(last, contour.lumen);
    cells.contours.push_back(std::move(contour));
  }
}

} // namespace

ContourSet clipCells(const std::vector<std::vector<Point>>& outers, const std::vector<std::size_t>& numbers,
  const Point& low, const Point& high, const LeaveOut& leaveOut)
{
  ContourSet cells{ { high[0] - low[0], high[1] - low[1] }, {} };
  std::int32_t last = 0;
  for (std::size_t i = 0; i < outers.size(); ++i)
  {
    if (!findCrossings({ { largestPicture, largestPicture }, { { outers[i], true, 1 } } }).empty())
    {
      leaveOut(numbers[i]);
      continue;
    }
    append(cells, clipToWindow({ outers[i] }, low, high, Covering::NoContour), last);
  }
  return cells;
}

ContourSet soundCells(const ContourSet& cells, const LeaveOut& leaveOut)
{
  ContourSet sound{ cells.size, {} };
  std::map<std::int32_t, bool> good;
  for (const auto& [number, cell] : byNumber(cells))
  {
    good[number] = validate(cell).empty();
    if (!good[number])
      leaveOut(static_cast<std::size_t>(std::max(number, 0)));
  }
  std::copy_if(cells.contours.begin(), cells.contours.end(), std::back_inserter(sound.contours),
    [&](const Contour& contour) { return good[contour.lumen]; });
  return sound;
}

ContourSet cropCells(const ContourSet& cells, const Point& low, const Point& high)
{
  ContourSet part{ { high[0] - low[0], high[1] - low[1] }, {} };
  std::int32_t last = 0;
  for (const auto& [number, cell] : byNumber(cells))
  {
    try
    {
      append(part, cropContours(cell, low, high), last);
    }
    catch (const InputError&)
    {
      // It has no outline in the window.
    }
  }
  return part;
}

} // namespace lamella::micrograph
