#include "segmentation/Otsu.h"

#include <algorithm>
#include <array>

namespace lamella::micrograph
{

Otsu otsu(const cv::Mat& grey)
{
  std::array<double, 256> histogram{};
  for (int row = 0; row < grey.rows; ++row)
  {
    const auto* value = grey.ptr<float>(row);
    for (int x = 0; x < grey.cols; ++x)
      histogram[static_cast<std::size_t>(std::clamp(value[x], 0.0F, 255.0F))] += 1;
  }
  const double nodes = static_cast<double>(grey.total());
  double mean = 0;
  double variance = 0;
  for (std::size_t i = 0; i < 256; ++i)
    mean += static_cast<double>(i) * histogram[i] / nodes;
  for (std::size_t i = 0; i < 256; ++i)
    variance += (static_cast<double>(i) - mean) * (static_cast<double>(i) - mean) * histogram[i] / nodes;
  Otsu best;
  double below = 0;
  double sum = 0;
  for (std::size_t i = 0; i < 255; ++i)
  {
    below += histogram[i] / nodes;
    sum += static_cast<double>(i) * histogram[i] / nodes;
    if (below > 0 && below < 1)
    {
      const double apart = mean * below - sum;
      const double between = apart * apart / (below * (1 - below));
      if (variance > 0 && between / variance > best.separability)
        best = { static_cast<double>(i) + 1, between / variance };
    }
  }
  return best;
}

} // namespace lamella::micrograph
