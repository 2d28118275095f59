#include "micrograph/CoarserOutlines.h"

#include "lattice/Error.h"
#include "lattice/Subsample.h"

#include <cmath>

namespace lamella::micrograph
{

std::vector<CoarserOutlines> coarserOutlines(
  const PhaseImage& image, std::uint8_t lumen, std::span<const float> level, const ExtractOptions& options)
{
  constexpr std::size_t most = 4; // of nine with every third pixel five are as good
  std::vector<CoarserOutlines> coarser;
  for (const int stride : { 2, 3 })
  {
    CoarserOutlines& outlines = coarser.emplace_back();
    outlines.stride = stride;
    for (const auto& first : subsampleStarts(image.lattice, stride, most))
    {
      const PhaseImage part = subsample(image, first, stride);
      std::vector<float> levels;
      for (std::int64_t y = first[1]; !level.empty() && y < image.lattice.size[1]; y += stride)
      {
        for (std::int64_t x = first[0]; x < image.lattice.size[0]; x += stride)
        {
          levels.push_back(level[static_cast<std::size_t>(image.lattice.index(x, y))]);
        }
      }
      try
      {
        outlines.sets.push_back(extractContours(part, lumen, levels, options).contours);
      }
      catch (const InputError&)
      {
      }
    }
  }
  return coarser;
}

ContourSet movedOutlines(const ContourSet& set, double distance)
{
  ContourSet moved = set;
  for (std::size_t c = 0; c < set.contours.size(); ++c)
  {
    const Contour& from = set.contours[c];
    const std::size_t n = from.points.size();
    for (std::size_t i = 0; i < n; ++i)
    {
      // The lumen lies on the left: the wall is where (dy, −dx) points.
      Point normal{ 0, 0 };
      const auto add = [&](std::size_t a, std::size_t b)
      {
        const Point way{ from.points[b][0] - from.points[a][0], from.points[b][1] - from.points[a][1] };
        if (const double length = std::hypot(way[0], way[1]); length > 0)
        {
          normal = { normal[0] + way[1] / length, normal[1] - way[0] / length };
        }
      };
      const bool first = i == 0;
      const bool last = i + 1 == n;
      if (from.closed || !first)
      {
        add(first ? n - 1 : i - 1, i);
      }
      if (from.closed || !last)
      {
        add(i, last ? 0 : i + 1);
      }
      const double length = std::hypot(normal[0], normal[1]);
      for (const std::size_t axis : { 0U, 1U })
      {
        const double at = from.points[i][axis];
        const double border = 1e-6 * set.size[axis];
        const bool stays = !from.closed && (first || last) && (at < border || at > set.size[axis] - border);
        if (length > 0 && !stays)
        {
          moved.contours[c].points[i][axis] = at + distance * normal[axis] / length;
        }
      }
    }
  }
  return moved;
}

} // namespace lamella::micrograph
