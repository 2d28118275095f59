#include "segmentation/Graphics.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace lamella::micrograph
{
namespace
{

/// Pixels that are fully black (0) or fully white (1).
std::array<cv::Mat, 2> extremes(const Picture& picture)
{
  const auto width = static_cast<int>(picture.lattice.size[0]);
  const auto height = static_cast<int>(picture.lattice.size[1]);
  const std::size_t channels = picture.colour.empty() ? 1 : 3;
  const std::vector<std::uint16_t>& values = picture.colour.empty() ? picture.grey : picture.colour;
  // What fills a 16-bit picture's range is its brightest value, as the camera may have fewer bits.
  const double top = picture.bits == 16 ? std::max<double>(1, *std::max_element(values.begin(), values.end())) : 255;
  const auto low = static_cast<std::uint16_t>(0.02 * top);
  const auto high = static_cast<std::uint16_t>(std::ceil(0.98 * top));
  std::array<cv::Mat, 2> masks{ cv::Mat(height, width, CV_8U), cv::Mat(height, width, CV_8U) };
  const std::uint16_t* value = values.data();
  for (int row = 0; row < height; ++row)
  {
    auto* black = masks[0].ptr<std::uint8_t>(row);
    auto* white = masks[1].ptr<std::uint8_t>(row);
    for (int x = 0; x < width; ++x, value += channels)
    {
      const auto [least, most] = std::minmax_element(value, value + channels);
      black[x] = *most <= low ? 255 : 0;
      white[x] = *least >= high ? 255 : 0;
    }
  }
  return masks;
}

/// How many rows from the first on are a margin.
int marginRows(const cv::Mat& mask, int first, int step)
{
  const int most = mask.rows / 10;
  int margin = 0;
  for (int i = 0; i < most; ++i)
  {
    const double share = cv::countNonZero(mask.row(first + step * i)) / static_cast<double>(mask.cols);
    if (share < 0.5)
      break;
    margin = share >= 0.95 ? i + 1 : margin;
  }
  return margin;
}

struct Shape
{
  cv::Rect box;
  int label = 0;
  double fill = 0; ///< share of the box
};

void findMargins(const cv::Mat& mask, std::vector<Mark>& marks)
{
  const cv::Mat turned = mask.t();
  const auto add = [&](int x0, int y0, int x1, int y1)
  {
    if (x1 > x0 && y1 > y0)
      marks.push_back({ Mark::Kind::Margin, x0, y0, x1, y1 });
  };
  add(0, 0, mask.cols, marginRows(mask, 0, 1));
  add(0, mask.rows - marginRows(mask, mask.rows - 1, -1), mask.cols, mask.rows);
  add(0, 0, marginRows(turned, 0, 1), mask.rows);
  add(mask.cols - marginRows(turned, mask.cols - 1, -1), 0, mask.cols, mask.rows);
}

/// Shapes with thin strokes, as letters are made of: nowhere thicker than a third of their height.
bool thinStroked(const cv::Mat& labels, const Shape& shape)
{
  cv::Mat own = labels(shape.box) == shape.label;
  cv::copyMakeBorder(own, own, 1, 1, 1, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  cv::Mat depth;
  cv::distanceTransform(own, depth, cv::DIST_L2, cv::DIST_MASK_3);
  double thickest = 0;
  cv::minMaxLoc(depth, nullptr, &thickest);
  return 2 * thickest - 1 <= std::max(1.0, shape.box.height / 3.0);
}

/// Lines of at least three letters: like heights, side by side.
void findText(const cv::Mat& labels, std::vector<Shape> letters, std::vector<Mark>& marks)
{
  std::sort(letters.begin(), letters.end(), [](const Shape& a, const Shape& b) { return a.box.x < b.box.x; });
  std::vector<bool> used(letters.size(), false);
  for (std::size_t i = 0; i < letters.size(); ++i)
  {
    if (used[i] || !thinStroked(labels, letters[i]))
      continue;
    cv::Rect line = letters[i].box;
    const double height = line.height;
    std::vector<std::size_t> members{ i };
    double fill = letters[i].fill;
    for (std::size_t j = i + 1; j < letters.size(); ++j)
    {
      const cv::Rect& box = letters[j].box;
      if (box.x > line.x + line.width + 1.5 * height)
        break;
      const bool level = std::abs(box.y - letters[i].box.y) <= 0.4 * height &&
        std::abs(box.y + box.height - letters[i].box.y - letters[i].box.height) <= 0.4 * height;
      if (!used[j] && level && thinStroked(labels, letters[j]))
      {
        members.push_back(j);
        line |= box;
        fill += letters[j].fill;
      }
    }
    if (members.size() >= 3 && fill / static_cast<double>(members.size()) < 0.75)
    {
      for (const std::size_t member : members)
        used[member] = true;
      marks.push_back({ Mark::Kind::Text, line.x, line.y, line.x + line.width, line.y + line.height });
    }
  }
}

void findShapes(const cv::Mat& mask, std::vector<Mark>& marks)
{
  cv::Mat labels;
  cv::Mat stats;
  cv::Mat centres;
  const int count = cv::connectedComponentsWithStats(mask, labels, stats, centres, 8, CV_32S);
  std::vector<Shape> letters;
  for (int i = 1; i < count; ++i)
  {
    const cv::Rect box(stats.at<int>(i, cv::CC_STAT_LEFT), stats.at<int>(i, cv::CC_STAT_TOP),
      stats.at<int>(i, cv::CC_STAT_WIDTH), stats.at<int>(i, cv::CC_STAT_HEIGHT));
    const double fill = stats.at<int>(i, cv::CC_STAT_AREA) / static_cast<double>(box.area());
    const int thick = std::min(box.width, box.height);
    const int length = std::max(box.width, box.height);
    if (fill >= 0.95 && thick >= 3 && length >= std::max(20, 5 * thick))
      marks.push_back({ Mark::Kind::Bar, box.x, box.y, box.x + box.width, box.y + box.height });
    else if (box.height >= 6 && 10 * box.height <= std::max(mask.rows, 100) && box.width <= 2 * box.height)
      letters.push_back({ box, i, fill });
  }
  // Noise and foam in a saturated picture are no text: letters come by the dozen, not by the thousand.
  if (letters.size() <= 1000)
    findText(labels, std::move(letters), marks);
}

/// Share of the picture in places that are all of one extreme.
double emptyShare(const cv::Mat& mask, double place)
{
  const int columns = std::max(1, static_cast<int>(mask.cols / place));
  const int rows = std::max(1, static_cast<int>(mask.rows / place));
  if (columns * rows < 4)
    return 0;
  cv::Mat share;
  cv::resize(mask, share, cv::Size(columns, rows), 0, 0, cv::INTER_AREA);
  return cv::countNonZero(share >= 253) / static_cast<double>(columns * rows);
}

} // namespace

std::string name(Mark::Kind kind)
{
  static constexpr std::array names{ "margin", "scale bar", "text", "ray gap", "gap" };
  return names.at(static_cast<std::size_t>(kind));
}

Graphics findGraphics(const Picture& picture, double place)
{
  Graphics result;
  const std::array<cv::Mat, 2> masks = extremes(picture);
  for (const cv::Mat& mask : masks)
  {
    const double share = cv::countNonZero(mask) / static_cast<double>(mask.total());
    if (share > 0 && share <= 0.25)
    {
      const std::size_t before = result.marks.size();
      findMargins(mask, result.marks);
      cv::Mat rest = mask.clone();
      for (std::size_t i = before; i < result.marks.size(); ++i)
      {
        const Mark& mark = result.marks[i];
        rest(cv::Rect(mark.x0, mark.y0, mark.x1 - mark.x0, mark.y1 - mark.y0)).setTo(0);
      }
      findShapes(rest, result.marks);
    }
  }
  result.black = emptyShare(masks[0], place);
  result.white = emptyShare(masks[1], place);
  if (!result.marks.empty())
  {
    result.mask = cv::Mat::zeros(masks[0].size(), CV_8U);
    for (const Mark& mark : result.marks)
    {
      // Two pixels round about are blurred, by JPEG as a rule.
      const cv::Rect box(mark.x0 - 2, mark.y0 - 2, mark.x1 - mark.x0 + 4, mark.y1 - mark.y0 + 4);
      result.mask(box & cv::Rect(0, 0, result.mask.cols, result.mask.rows)).setTo(255);
    }
  }
  return result;
}

void paintOver(cv::Mat& grey, const cv::Mat& mask)
{
  if (mask.empty() || cv::countNonZero(mask) == static_cast<int>(mask.total()))
    return;
  cv::Mat distance;
  cv::Mat nearest;
  cv::distanceTransform(mask, distance, nearest, cv::DIST_L2, cv::DIST_MASK_5, cv::DIST_LABEL_PIXEL);
  std::vector<float> values(mask.total() + 1);
  for (int pass = 0; pass < 2; ++pass)
  {
    for (int row = 0; row < mask.rows; ++row)
    {
      const auto* masked = mask.ptr<std::uint8_t>(row);
      const auto* label = nearest.ptr<int>(row);
      auto* value = grey.ptr<float>(row);
      for (int x = 0; x < mask.cols; ++x)
      {
        const auto which = static_cast<std::size_t>(label[x]);
        if (pass == 0 && masked[x] == 0)
          values[which] = value[x];
        else if (pass == 1 && masked[x] > 0)
          value[x] = values[which];
      }
    }
  }
}

} // namespace lamella::micrograph
