#include "outlines/WallThickness.h"

#include "outlines/NearestContours.h"

#include <algorithm>
#include <cmath>

namespace lamella::micrograph
{

WallThickness wallThickness(const ContourSet& contours, int samples)
{
  const NearestContours search(segmentsOf(contours), 2);
  double length = 0;
  for (const Segment& segment : search.segments())
    length += std::hypot(segment.to[0] - segment.from[0], segment.to[1] - segment.from[1]);
  std::vector<double> thickness;
  const double step = length / samples;
  double next = step / 2;
  for (const Segment& segment : search.segments())
  {
    const double own = std::hypot(segment.to[0] - segment.from[0], segment.to[1] - segment.from[1]);
    while (next < own)
    {
      const double t = next / own;
      next += step;
      const Nearest nearest = search.at({ segment.from[0] + t * (segment.to[0] - segment.from[0]),
        segment.from[1] + t * (segment.to[1] - segment.from[1]) });
      if (nearest.squared[1] < Nearest::kNone)
        thickness.push_back(std::sqrt(nearest.squared[1]));
    }
    next -= own;
  }
  if (thickness.empty())
    return {};
  std::sort(thickness.begin(), thickness.end());
  return { thickness[thickness.size() / 20], thickness[thickness.size() / 2] };
}

} // namespace lamella::micrograph
