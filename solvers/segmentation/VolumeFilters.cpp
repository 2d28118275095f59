#include "segmentation/VolumeFilters.h"

#include "lattice/GreyLevels.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace lamella::micrograph
{
namespace
{

constexpr int degree = 4;
constexpr int terms = (degree + 1) * (degree + 2) * (degree + 3) / 6;

/// Position of a mirrored plane or row outside 0 … n - 1.
std::int64_t mirrored(std::int64_t i, std::int64_t n)
{
  while (i < 0 || i >= n)
    i = i < 0 ? -1 - i : 2 * n - 1 - i;
  return i;
}

/// −1 … 1 over an axis; 0 where it is one voxel long.
double along(double i, std::int64_t n)
{
  return n > 1 ? 2 * (i + 0.5) / static_cast<double>(n) - 1 : 0;
}

/// A polynomial of fourth degree in three variables.
class Surface
{
public:
  using Coefficients = std::array<double, terms>;

  /// x^i y^j z^k with i + j + k ≤ 4, k slowest, i fastest.
  static Coefficients powers(double x, double y, double z)
  {
    Coefficients row{};
    int term = 0;
    double ofZ = 1;
    for (int k = 0; k <= degree; ++k, ofZ *= z)
    {
      double ofY = ofZ;
      for (int j = 0; j + k <= degree; ++j, ofY *= y)
      {
        double value = ofY;
        for (int i = 0; i + j + k <= degree; ++i, value *= x)
          row[static_cast<std::size_t>(term++)] = value;
      }
    }
    return row;
  }

  void add(const Coefficients& row, double weight, double value)
  {
    for (std::size_t i = 0; i < terms; ++i)
    {
      right_[i] += weight * row[i] * value;
      for (std::size_t j = 0; j <= i; ++j)
        normal_[i * terms + j] += weight * row[i] * row[j];
    }
    weight_ += weight;
  }

  /// The surface through what was added; a thousandth of ridge keeps it flat where nothing was.
  [[nodiscard]] Coefficients fit() const
  {
    cv::Mat normal(terms, terms, CV_64F);
    cv::Mat right(terms, 1, CV_64F);
    for (int i = 0; i < terms; ++i)
    {
      right.at<double>(i) = right_[static_cast<std::size_t>(i)];
      for (int j = 0; j <= i; ++j)
        normal.at<double>(i, j) = normal.at<double>(j, i) = normal_[static_cast<std::size_t>(i * terms + j)];
      normal.at<double>(i, i) += (i == 0 ? 1e-12 : 1e-3) * weight_ + 1e-12;
    }
    cv::Mat found;
    cv::solve(normal, right, found, cv::DECOMP_SVD);
    Coefficients result{};
    std::copy_n(found.ptr<double>(), terms, result.begin());
    return result;
  }

  static double at(const Coefficients& c, const Coefficients& row)
  {
    double value = 0;
    for (std::size_t i = 0; i < terms; ++i)
      value += c[i] * row[i];
    return value;
  }

  /// The polynomial in x that is left in a row of the volume.
  static std::array<double, degree + 1> inRow(const Coefficients& c, double y, double z)
  {
    std::array<double, degree + 1> result{};
    std::size_t term = 0;
    double ofZ = 1;
    for (int k = 0; k <= degree; ++k, ofZ *= z)
    {
      double ofY = ofZ;
      for (int j = 0; j + k <= degree; ++j, ofY *= y)
        for (int i = 0; i + j + k <= degree; ++i)
          result[static_cast<std::size_t>(i)] += ofY * c[term++];
    }
    return result;
  }

private:
  std::array<double, static_cast<std::size_t>(terms) * terms> normal_{};
  std::array<double, terms> right_{};
  double weight_ = 0;
};

/// Boxes of voxels over which classes are averaged, at most 32 along each axis.
struct Blocks
{
  explicit Blocks(const Lattice& of)
    : lattice(of)
  {
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      edge[axis] = (of.size[axis] + 31) / 32;
      number[axis] = (of.size[axis] + edge[axis] - 1) / edge[axis];
    }
    for (std::int64_t k = 0; k < number[2]; ++k)
    {
      for (std::int64_t j = 0; j < number[1]; ++j)
      {
        for (std::int64_t i = 0; i < number[0]; ++i)
        {
          const auto middle = [&](std::int64_t block, std::size_t axis)
          {
            const std::int64_t first = block * edge[axis];
            const std::int64_t end = std::min(of.size[axis], first + edge[axis]);
            return along(static_cast<double>(first + end - 1) / 2, of.size[axis]);
          };
          rows.push_back(Surface::powers(middle(i, 0), middle(j, 1), middle(k, 2)));
        }
      }
    }
  }

  /// Calls f(block, grey) for every voxel.
  template <typename F>
  void each(std::span<const std::uint16_t> grey, const F& f) const
  {
    const std::uint16_t* value = grey.data();
    for (std::int64_t z = 0; z < lattice.size[2]; ++z)
    {
      for (std::int64_t y = 0; y < lattice.size[1]; ++y)
      {
        const std::int64_t row = (z / edge[2] * number[1] + y / edge[1]) * number[0];
        for (std::int64_t first = 0, block = row; first < lattice.size[0]; first += edge[0], ++block)
        {
          const std::int64_t end = std::min(lattice.size[0], first + edge[0]);
          for (std::int64_t x = first; x < end; ++x)
            f(static_cast<std::size_t>(block), *value++);
        }
      }
    }
  }

  Lattice lattice;
  std::array<std::int64_t, 3> edge{};
  std::array<std::int64_t, 3> number{};
  std::vector<Surface::Coefficients> rows;
};

/// The darkest and the brightest class over the volume.
struct TwoLevels
{
  Surface::Coefficients dark{};
  Surface::Coefficients bright{};
  double darkMean = 0;
  double brightMean = 0;
};

TwoLevels levelsOf(const Blocks& blocks, std::span<const std::uint16_t> grey, int classes)
{
  const std::size_t n = blocks.rows.size();
  // First a surface through everything, and what is left parted by Otsu's levels.
  std::vector<double> sum(n, 0);
  std::vector<double> count(n, 0);
  blocks.each(grey,
    [&](std::size_t block, std::uint16_t value)
    {
      sum[block] += value;
      count[block] += 1;
    });
  Surface all;
  for (std::size_t b = 0; b < n; ++b)
    all.add(blocks.rows[b], count[b], sum[b] / count[b]);
  const Surface::Coefficients through = all.fit();
  std::vector<int> middle(n);
  for (std::size_t b = 0; b < n; ++b)
    middle[b] = static_cast<int>(std::lround(Surface::at(through, blocks.rows[b])));
  std::vector<std::int64_t> histogram(65536, 0);
  blocks.each(grey,
    [&](std::size_t block, std::uint16_t value)
    { ++histogram[static_cast<std::size_t>(std::clamp(value - middle[block] + 32768, 0, 65535))]; });
  const GreyLevels rough = otsuLevels(histogram, classes);
  const double apart = rough.mean.back() - rough.mean.front();
  // Where between the two levels the darkest class ends and the brightest begins.
  const double lower = classes == 2 ? 0.5 : (rough.last.front() - rough.mean.front()) / apart;
  const double upper = classes == 2 ? 0.5 : (rough.last.back() - rough.mean.front()) / apart;
  std::vector<int> darkEnd(n);
  std::vector<int> brightBegin(n);
  for (std::size_t b = 0; b < n; ++b)
  {
    darkEnd[b] = middle[b] + rough.last.front() - 32768;
    brightBegin[b] = middle[b] + rough.last.back() - 32768;
  }
  TwoLevels found;
  for (int round = 0; round < 4; ++round)
  {
    std::vector<double> darkSum(n, 0);
    std::vector<double> darkCount(n, 0);
    std::vector<double> brightSum(n, 0);
    std::vector<double> brightCount(n, 0);
    blocks.each(grey,
      [&](std::size_t block, std::uint16_t value)
      {
        const double dark = value <= darkEnd[block] ? 1 : 0;
        const double bright = value > brightBegin[block] ? 1 : 0;
        darkSum[block] += dark * value;
        darkCount[block] += dark;
        brightSum[block] += bright * value;
        brightCount[block] += bright;
      });
    Surface dark;
    Surface bright;
    for (std::size_t b = 0; b < n; ++b)
    {
      dark.add(blocks.rows[b], darkCount[b], darkCount[b] > 0 ? darkSum[b] / darkCount[b] : 0);
      bright.add(blocks.rows[b], brightCount[b], brightCount[b] > 0 ? brightSum[b] / brightCount[b] : 0);
    }
    found.dark = dark.fit();
    found.bright = bright.fit();
    found.darkMean = 0;
    found.brightMean = 0;
    for (std::size_t b = 0; b < n; ++b)
    {
      const double low = Surface::at(found.dark, blocks.rows[b]);
      const double high = Surface::at(found.bright, blocks.rows[b]);
      found.darkMean += low / static_cast<double>(n);
      found.brightMean += high / static_cast<double>(n);
      darkEnd[b] = static_cast<int>(std::lround(low + lower * (high - low)));
      brightBegin[b] = static_cast<int>(std::lround(low + upper * (high - low)));
    }
  }
  return found;
}

/// Calls f(index, new grey) for every voxel of the volume made even.
template <typename F>
void eachFlattened(const Lattice& lattice, std::span<const std::uint16_t> grey, const TwoLevels& levels, const F& f)
{
  const double contrast = levels.brightMean - levels.darkMean;
  std::size_t node = 0;
  for (std::int64_t z = 0; z < lattice.size[2]; ++z)
  {
    for (std::int64_t y = 0; y < lattice.size[1]; ++y)
    {
      const double fromMiddleY = along(static_cast<double>(y), lattice.size[1]);
      const double fromMiddleZ = along(static_cast<double>(z), lattice.size[2]);
      const auto dark = Surface::inRow(levels.dark, fromMiddleY, fromMiddleZ);
      const auto bright = Surface::inRow(levels.bright, fromMiddleY, fromMiddleZ);
      for (std::int64_t x = 0; x < lattice.size[0]; ++x, ++node)
      {
        const double at = along(static_cast<double>(x), lattice.size[0]);
        double low = 0;
        double high = 0;
        for (std::size_t i = degree + 1; i-- > 0;)
        {
          low = low * at + dark[i];
          high = high * at + bright[i];
        }
        // A place with hardly any contrast of its own keeps that of the whole.
        const double gain = contrast / std::max(high - low, 0.3 * contrast);
        const double value = levels.darkMean + (grey[node] - low) * gain;
        f(node, static_cast<std::uint16_t>(std::clamp(value + 0.5, 0.0, 65535.0)));
      }
    }
  }
}

} // namespace

void smooth(const Lattice& lattice, std::span<std::uint16_t> grey, double deviation)
{
  if (deviation <= 0)
    return;
  const auto [nx, ny, nz] = lattice.size;
  const auto reach = static_cast<std::int64_t>(std::ceil(4 * deviation));
  std::vector<float> kernel;
  float whole = 0;
  for (std::int64_t i = -reach; i <= reach; ++i)
  {
    const double from = static_cast<double>(i) / deviation;
    kernel.push_back(static_cast<float>((3 - from * from) / 2 * std::exp(-from * from / 2)));
    whole += kernel.back();
  }
  for (float& weight : kernel)
    weight /= whole;
  const cv::Mat line(1, static_cast<int>(kernel.size()), CV_32F, kernel.data());
  const std::int64_t planes = 2 * reach + 1;
  std::vector<cv::Mat> ring(static_cast<std::size_t>(planes));
  const auto plane = [&](std::int64_t z) -> cv::Mat& { return ring[static_cast<std::size_t>(z % planes)]; };
  const std::int64_t area = nx * ny;
  const auto read = [&](std::int64_t z)
  {
    const cv::Mat from(static_cast<int>(ny), static_cast<int>(nx), CV_16U, grey.data() + z * area);
    cv::Mat asFloat;
    from.convertTo(asFloat, CV_32F);
    cv::sepFilter2D(asFloat, plane(z), CV_32F, line, line, cv::Point(-1, -1), 0, cv::BORDER_REFLECT);
  };
  for (std::int64_t z = 0; z < std::min(nz, reach); ++z)
    read(z);
  // Near the far face planes are mirrored, and those are in the ring still: it is as long as the kernel.
  for (std::int64_t z = 0; z < nz; ++z)
  {
    if (z + reach < nz)
      read(z + reach);
    cv::Mat sum(static_cast<int>(ny), static_cast<int>(nx), CV_32F, cv::Scalar(0));
    for (std::int64_t k = -reach; k <= reach; ++k)
      cv::scaleAdd(plane(mirrored(z + k, nz)), kernel[static_cast<std::size_t>(k + reach)], sum, sum);
    cv::Mat to(static_cast<int>(ny), static_cast<int>(nx), CV_16U, grey.data() + z * area);
    sum.convertTo(to, CV_16U);
  }
}

VolumeLight flattenVolume(const Lattice& lattice, std::span<std::uint16_t> grey, int classes)
{
  VolumeLight light;
  const Blocks blocks(lattice);
  const TwoLevels levels = levelsOf(blocks, grey, classes);
  const double contrast = levels.brightMean - levels.darkMean;
  if (!(contrast > 0))
    return light;
  std::vector<double> middle;
  for (const Surface::Coefficients& row : blocks.rows)
    middle.push_back((Surface::at(levels.dark, row) + Surface::at(levels.bright, row)) / 2);
  // From the fifth to the ninety-fifth hundredth: in a corner without one of the classes the surfaces run away.
  std::ranges::sort(middle);
  const std::size_t edge = middle.size() / 20;
  light.unevenness = (middle[middle.size() - 1 - edge] - middle[edge]) / contrast;
  std::vector<std::int64_t> histogram(65536, 0);
  eachFlattened(lattice, grey, levels, [&](std::size_t, std::uint16_t value) { ++histogram[value]; });
  const double before = otsuLevels(greyHistogram(grey), classes).separability;
  light.flattened = otsuLevels(histogram, classes).separability > before + 0.002;
  if (light.flattened)
    eachFlattened(lattice, grey, levels, [&](std::size_t node, std::uint16_t value) { grey[node] = value; });
  return light;
}

} // namespace lamella::micrograph
