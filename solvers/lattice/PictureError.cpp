#include "lattice/PictureError.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lamella
{
namespace
{

double mean(std::span<const double> values)
{
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Standard deviation of the population that these are a sample of; 0 of one value.
double deviation(std::span<const double> values)
{
  if (values.size() < 2)
    return 0;
  const double m = mean(values);
  double sum = 0;
  for (const double v : values)
    sum += (v - m) * (v - m);
  return std::sqrt(sum / static_cast<double>(values.size() - 1));
}

} // namespace

PictureError::PictureError(double value, std::span<const SubsampleValues> subsamples, double unit)
  : value_(value)
{
  const SubsampleValues& second = subsamples.front();
  const double m2 = mean(second.values);
  bias_ = (value - m2) / ((second.stride - 1) * unit);
  biases_.fill(bias_);
  for (const SubsampleValues& of : subsamples)
  {
    scatter_ = std::max(scatter_, deviation(of.values) * std::pow(2.0 / of.stride, 1.5) / unit);
    const double m = mean(of.values);
    if (std::lround(of.stride) == 3)
      biases_[1] = (value - m) / ((of.stride - 1) * unit);
    if (std::lround(of.stride) == 4)
      biases_[2] = (m2 - m) / ((of.stride - second.stride) * unit);
  }
}

double PictureError::bar(double change) const noexcept
{
  double worst = std::abs(bias_ - change); // NaN stays: it is the first of each comparison
  for (const double bias : biases_)
    worst = std::max(worst, std::abs(bias - change));
  return worst + scatter_;
}

ErrorEstimate PictureError::estimate(double change, double lattice) const noexcept
{
  ErrorEstimate result;
  const double scale = 1 + change; // of the solve's value over the picture's
  result.relative = bar(change) / scale;
  result.lattice = std::abs(lattice) / scale;
  result.picture = bar(change + lattice) / scale;
  // Over the scatter by so much the expected value was the nearer one in 37 cases of 39 (docs/benchmarks/diffusion.md).
  if (std::abs(bias_ - change) > 2 * scatter_)
    result.extrapolated = value_ * (1 + bias_);
  return result;
}

} // namespace lamella
