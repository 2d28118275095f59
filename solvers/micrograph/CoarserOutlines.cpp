#include "micrograph/CoarserOutlines.h"

#include "lattice/Error.h"
#include "lattice/Subsample.h"

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

} // namespace lamella::micrograph
