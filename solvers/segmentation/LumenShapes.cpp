#include "segmentation/LumenShapes.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace lamella::micrograph
{
namespace
{

/// How many times longer than wide the neighbours on one side are, in the frame of a lumen; none where there are few.
std::optional<double> sideAspect(
  const cv::Mat& labels, const std::vector<LumenShape>& shapes, int own, double acrossX, double acrossY)
{
  const LumenShape& shape = shapes[static_cast<std::size_t>(own)];
  constexpr int places = 9;
  std::vector<double> aspects;
  for (int i = 0; i < places; ++i)
  {
    const double f = 0.4 * shape.length * (2.0 * i / (places - 1) - 1);
    for (double t = 0; t < shape.length + shape.width; t += 1)
    {
      const auto x = static_cast<int>(std::lround(shape.x + f * shape.cosine + t * acrossX));
      const auto y = static_cast<int>(std::lround(shape.y + f * shape.sine + t * acrossY));
      if (x < 0 || y < 0 || x >= labels.cols || y >= labels.rows)
        break;
      const int other = labels.at<int>(y, x);
      if (other != 0 && other != own)
      {
        const LumenShape& neighbour = shapes[static_cast<std::size_t>(other)];
        aspects.push_back(neighbour.along(shape.cosine, shape.sine) / neighbour.along(acrossX, acrossY));
        break;
      }
    }
  }
  if (aspects.size() < places / 3)
    return std::nullopt;
  const auto middle = aspects.begin() + static_cast<std::ptrdiff_t>(aspects.size() / 2);
  std::nth_element(aspects.begin(), middle, aspects.end());
  return *middle;
}

} // namespace

double LumenShape::along(double dx, double dy) const
{
  const double u = dx * cosine + dy * sine;
  const double v = dy * cosine - dx * sine;
  return std::hypot(length * u, width * v);
}

std::vector<LumenShape> lumenShapes(const cv::Mat& labels, int count)
{
  struct Sums
  {
    double n = 0, x = 0, y = 0, xx = 0, yy = 0, xy = 0;
  };
  std::vector<Sums> sums(static_cast<std::size_t>(count));
  std::vector<LumenShape> shapes(static_cast<std::size_t>(count));
  for (int row = 0; row < labels.rows; ++row)
  {
    const auto* label = labels.ptr<int>(row);
    for (int x = 0; x < labels.cols; ++x)
    {
      if (label[x] == 0)
        continue;
      const auto which = static_cast<std::size_t>(label[x]);
      Sums& s = sums[which];
      s.n += 1;
      s.x += x;
      s.y += row;
      s.xx += static_cast<double>(x) * x;
      s.yy += static_cast<double>(row) * row;
      s.xy += static_cast<double>(x) * row;
      shapes[which].cut = shapes[which].cut || row == 0 || x == 0 || row == labels.rows - 1 || x == labels.cols - 1;
    }
  }
  for (std::size_t i = 1; i < shapes.size(); ++i)
  {
    const Sums& s = sums[i];
    LumenShape& shape = shapes[i];
    if (!(s.n > 0))
      continue;
    shape.area = static_cast<std::int64_t>(s.n);
    shape.x = s.x / s.n;
    shape.y = s.y / s.n;
    // A pixel is a square, which has moments of its own.
    const double xx = s.xx / s.n - shape.x * shape.x + 1.0 / 12;
    const double yy = s.yy / s.n - shape.y * shape.y + 1.0 / 12;
    const double xy = s.xy / s.n - shape.x * shape.y;
    const double mean = (xx + yy) / 2;
    const double apart = std::hypot((xx - yy) / 2, xy);
    shape.length = 4 * std::sqrt(mean + apart);
    shape.width = 4 * std::sqrt(std::max(1.0 / 12, mean - apart));
    const double angle = std::atan2(2 * xy, xx - yy) / 2;
    shape.cosine = std::cos(angle);
    shape.sine = std::sin(angle);
  }
  return shapes;
}

std::vector<int> slenderAmongBroad(const cv::Mat& labels, const std::vector<LumenShape>& shapes, double slender)
{
  std::vector<int> found;
  for (std::size_t i = 1; i < shapes.size(); ++i)
  {
    const LumenShape& shape = shapes[i];
    if (shape.area == 0 || shape.length < slender * shape.width)
      continue;
    const int own = static_cast<int>(i);
    const auto left = sideAspect(labels, shapes, own, -shape.sine, shape.cosine);
    const auto right = sideAspect(labels, shapes, own, shape.sine, -shape.cosine);
    if (left && right && shape.length / shape.width >= slender * std::max(*left, *right))
      found.push_back(own);
  }
  return found;
}

} // namespace lamella::micrograph
