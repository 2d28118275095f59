#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

/// A vector field on the pixels of a picture, and points on it. Positions are in pixels: pixel (i, j) covers
/// [i, i + 1] × [j, j + 1].
namespace lamella::rendering
{

using Point2 = std::array<double, 2>;
using Polyline = std::vector<Point2>;

/// A plane vector field on the pixels.
struct PlaneField
{
  int nx = 0;
  int ny = 0;
  std::vector<float> x; ///< nx * ny
  std::vector<float> y;

  [[nodiscard]] std::size_t Index(int i, int j) const
  {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(i);
  }
};

[[nodiscard]] inline double Distance(const Point2& a, const Point2& b)
{
  return std::hypot(a[0] - b[0], a[1] - b[1]);
}

[[nodiscard]] inline double MeanMagnitude(const PlaneField& field)
{
  double sum = 0;
  for (std::size_t i = 0; i < field.x.size(); ++i)
    sum += std::hypot(field.x[i], field.y[i]);
  return sum / static_cast<double>(std::max<std::size_t>(1, field.x.size()));
}

/// Bilinear interpolation between pixel centres, constant beyond the outer ones.
class Sampler
{
public:
  explicit Sampler(const PlaneField& field)
    : Field(field)
  {
  }
  [[nodiscard]] Point2 At(const Point2& p) const
  {
    const double u = std::clamp(p[0] - 0.5, 0.0, this->Field.nx - 1.0);
    const double v = std::clamp(p[1] - 0.5, 0.0, this->Field.ny - 1.0);
    const int i = std::clamp(static_cast<int>(u), 0, std::max(0, this->Field.nx - 2));
    const int j = std::clamp(static_cast<int>(v), 0, std::max(0, this->Field.ny - 2));
    const int right = std::min(i + 1, this->Field.nx - 1);
    const int above = std::min(j + 1, this->Field.ny - 1);
    const double a = u - i;
    const double b = v - j;
    const auto mix = [&](const std::vector<float>& c)
    {
      return (1 - b) * ((1 - a) * c[this->Field.Index(i, j)] + a * c[this->Field.Index(right, j)]) +
        b * ((1 - a) * c[this->Field.Index(i, above)] + a * c[this->Field.Index(right, above)]);
    };
    return { mix(this->Field.x), mix(this->Field.y) };
  }

private:
  const PlaneField& Field;
};

} // namespace lamella::rendering
