#include "micrograph/MicrographLegend.h"

#include <vtkFreeTypeTools.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkStdString.h>
#include <vtkTextProperty.h>

#include <fmt/format.h>

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

namespace lamella::cli
{

namespace
{

/// Text as a share of ink, its upper left corner at the letters' own box.
cv::Mat textMask(const std::string& text, double height)
{
  vtkNew<vtkTextProperty> property;
  property->SetFontFamilyToArial();
  property->SetColor(1, 1, 1);
  property->SetFontSize(static_cast<int>(std::lround(4 * height)));
  vtkNew<vtkImageData> image;
  int size[2] = { 0, 0 };
  if (!vtkFreeTypeTools::GetInstance()->RenderString(property, vtkStdString(text), 72, image, size) || size[0] < 1 ||
    size[1] < 1)
    return {};
  cv::Mat mask(size[1], size[0], CV_32F, cv::Scalar(0));
  for (int y = 0; y < size[1]; ++y)
  {
    for (int x = 0; x < size[0]; ++x)
    {
      const auto* rgba = static_cast<const unsigned char*>(image->GetScalarPointer(x, y, 0));
      mask.at<float>(size[1] - 1 - y, x) = static_cast<float>(rgba[3]) / 255.0F;
    }
  }
  cv::Mat small;
  cv::resize(mask, small, {}, 0.25, 0.25, cv::INTER_AREA);
  return small;
}

/// 1, 2 or 5 times a power of ten.
double roundLength(double metres)
{
  const double power = std::pow(10.0, std::floor(std::log10(metres)));
  const double ratio = metres / power;
  return power * (ratio >= 5 ? 5 : ratio >= 2 ? 2 : 1);
}

std::string lengthText(double metres)
{
  return metres >= 0.9995e-3 ? fmt::format("{:g} mm", 1e3 * metres)
    : metres >= 0.9995e-6    ? fmt::format("{:g} µm", 1e6 * metres)
                             : fmt::format("{:g} nm", 1e9 * metres);
}

} // namespace

cv::Scalar scalar(const Colour& c)
{
  return { c[0], c[1], c[2] };
}

void blend(cv::Mat& picture, const cv::Mat& mask, const Colour& colour, float alpha, cv::Point at)
{
  const cv::Rect box = cv::Rect(at, mask.size()) & cv::Rect({ 0, 0 }, picture.size());
  for (int y = box.y; y < box.y + box.height; ++y)
  {
    for (int x = box.x; x < box.x + box.width; ++x)
    {
      const float share = alpha * mask.at<float>(y - at.y, x - at.x);
      auto& pixel = picture.at<cv::Vec3b>(y, x);
      for (int k = 0; k < 3; ++k)
      {
        pixel[k] =
          cv::saturate_cast<uchar>(std::lround((1 - share) * static_cast<float>(pixel[k]) + share * colour[k]));
      }
    }
  }
}

cv::Mat withLegend(const cv::Mat& picture, const OverlayParts& parts, double scale)
{
  const double font = std::clamp(picture.cols / 60.0, 9.0, 26.0);
  const int row = static_cast<int>(std::lround(1.8 * font));
  struct Item
  {
    std::string text;
    std::function<void(cv::Mat&, cv::Rect)> swatch;
    int swatchWidth;
  };
  const auto line = [](const Colour& colour, double thick)
  {
    return [=](cv::Mat& to, cv::Rect box)
    {
      const int h = std::max(1, static_cast<int>(std::lround(thick)));
      cv::rectangle(to, cv::Rect(box.x, box.y + (box.height - h) / 2, box.width, h), scalar(colour), cv::FILLED);
    };
  };
  const auto area = [](const Colour& colour, double alpha)
  {
    const Colour c = alpha * colour + (1 - alpha) * Colour(255, 255, 255);
    return [=](cv::Mat& to, cv::Rect box) { cv::rectangle(to, box, scalar(c), cv::FILLED); };
  };
  std::vector<Item> items;
  const double bar = roundLength(picture.cols / 4.5 / scale);
  const int wide = static_cast<int>(std::lround(1.6 * font));
  items.push_back({ lengthText(bar), line(ink, std::max(2.0, font / 4)), static_cast<int>(std::lround(bar * scale)) });
  items.push_back({ "outline", line(outlineColour, std::max(2.0, font / 8)), wide });
  if (parts.lattice != nullptr)
    items.push_back({ "wall direction", line(strokeColour, std::max(1.0, font / 12)), static_cast<int>(0.6 * wide) });
  if (parts.lamella)
    items.push_back({ "middle lamella", area(lamellaColour, 0.9), wide });
  if (std::find(parts.vessel.begin(), parts.vessel.end(), true) != parts.vessel.end())
    items.push_back({ parts.cells ? "vessel" : "large pore", area(vesselColour, 0.45), wide });
  const auto frame = [](const Colour& colour)
  { return [=](cv::Mat& to, cv::Rect box) { cv::rectangle(to, box, scalar(colour), std::max(1, box.height / 8)); }; };
  const auto gaps = std::count_if(parts.marks.begin(), parts.marks.end(),
    [](const micrograph::Mark& mark) { return mark.kind == micrograph::Mark::Kind::Gap; });
  if (gaps < static_cast<std::ptrdiff_t>(parts.marks.size()))
    items.push_back({ "not counted", frame(markColour), wide });
  if (gaps > 0)
    items.push_back({ "tear or background", frame(gapColour), wide });

  const int margin = static_cast<int>(std::lround(0.5 * font));
  const int between = static_cast<int>(std::lround(1.5 * font));
  struct Placed
  {
    cv::Rect swatch;
    cv::Point text;
    cv::Mat mask;
    std::size_t item;
  };
  std::vector<Placed> placed;
  int x = 0;
  int rows = 1;
  for (std::size_t i = 0; i < items.size(); ++i)
  {
    const cv::Mat mask = textMask(items[i].text, font);
    const int width = items[i].swatchWidth + margin + mask.cols;
    if (x > 0 && x + width > picture.cols)
    {
      x = 0;
      ++rows;
    }
    const int middle = picture.rows + margin + row * (rows - 1) + row / 2;
    const int high = static_cast<int>(std::lround(0.8 * font));
    placed.push_back({ { x, middle - high / 2, items[i].swatchWidth, high },
      { x + items[i].swatchWidth + margin, middle - mask.rows / 2 }, mask, i });
    x += width + between;
  }
  cv::Mat whole(picture.rows + margin + row * rows, picture.cols, CV_8UC3, cv::Scalar(255, 255, 255));
  picture.copyTo(whole(cv::Rect({ 0, 0 }, picture.size())));
  for (const Placed& p : placed)
  {
    items[p.item].swatch(whole, p.swatch);
    if (!p.mask.empty())
      blend(whole, p.mask, ink, 1, p.text);
  }
  return whole;
}

} // namespace lamella::cli
