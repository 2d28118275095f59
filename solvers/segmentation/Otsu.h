#pragma once

#include <opencv2/core.hpp>

namespace lamella::micrograph
{

struct Otsu
{
  double threshold = 0;
  double separability = 0; ///< between-class over total variance
};

/// Otsu's threshold (IEEE Trans. SMC 9, 1979, 62–66) of a CV_32F picture, over its values in 0 … 256.
[[nodiscard]] Otsu otsu(const cv::Mat& grey);

} // namespace lamella::micrograph
