#include "outlines/CellOutlines.h"

namespace lamella::micrograph
{

void zeroLines(const Corners& values, const Point& low, double spacing, std::int32_t chain, std::vector<Segment>& lines)
{
  constexpr std::array<Point, 4> corner{ { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } } };
  // Around the square: where the value falls below 0 a piece begins, where it rises above one ends.
  std::array<Point, 2> falls;
  std::array<Point, 2> rises;
  std::array<int, 2> fallAt{};
  std::size_t fallen = 0;
  std::size_t risen = 0;
  for (std::size_t i = 0; i < 4; ++i)
  {
    const std::size_t next = (i + 1) % 4;
    const double from = values[i];
    const double to = values[next];
    if ((from > 0) == (to > 0))
      continue;
    const double t = from / (from - to);
    const Point at{ low[0] + spacing * (corner[i][0] + t * (corner[next][0] - corner[i][0])),
      low[1] + spacing * (corner[i][1] + t * (corner[next][1] - corner[i][1])) };
    if (from > 0)
    {
      fallAt[fallen] = static_cast<int>(i);
      falls[fallen++] = at;
    }
    else
    {
      rises[risen++] = at;
    }
  }
  if (fallen == 0)
    return;
  if (fallen == 1)
  {
    lines.push_back({ falls[0], rises[0], 1, chain });
    return;
  }
  // A saddle. Corners alternate; a positive middle joins the positive ones, and each piece cuts off a negative corner:
  // it runs from the fall before that corner to the rise after it.
  const bool joined = values[0] + values[1] + values[2] + values[3] > 0;
  const bool firstFallLeads = fallAt[0] == 0;
  const std::size_t after = firstFallLeads ? 0 : 1; // of the rises, the one that follows falls[0] around the square
  const std::size_t mate = joined ? after : 1 - after;
  lines.push_back({ falls[0], rises[mate], 1, chain });
  lines.push_back({ falls[1], rises[1 - mate], 1, chain });
}

} // namespace lamella::micrograph
