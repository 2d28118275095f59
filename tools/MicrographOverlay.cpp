#include "MicrographOverlay.h"

#include <vtkFreeTypeTools.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkStdString.h>
#include <vtkTextProperty.h>

#include <fmt/format.h>

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <string>

namespace lamella::cli
{

namespace
{

using Colour = cv::Vec3f; // red, green, blue

const Colour outlineColour(0, 90, 200);
const Colour strokeColour(20, 20, 20);
const Colour lamellaColour(255, 170, 0);
const Colour vesselColour(0, 170, 150);
const Colour markColour(220, 0, 60);
const Colour wallColour(214, 208, 202);
const Colour ink(25, 25, 25);

constexpr int finer = 2; // lines are drawn this much larger and averaged

cv::Scalar scalar(const Colour& c)
{
  return { c[0], c[1], c[2] };
}

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
  {
    return {};
  }
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

/// Blends a colour into a picture where a mask (0 … 1, its corner at `at`) says so.
void blend(cv::Mat& picture, const cv::Mat& mask, const Colour& colour, float alpha, cv::Point at = { 0, 0 })
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

struct Drawing
{
  cv::Mat picture; // finer times as large as what comes out
  double scale;    // its pixels a metre
  double line;     // width of an outline in it
  double height;   // of the micrograph [m]

  /// With 8 bits of fraction, y down. OpenCV has pixel centres at whole numbers.
  [[nodiscard]] cv::Point at(double x, double y) const
  {
    return { static_cast<int>(std::lround(256 * (x * scale - 0.5))),
      static_cast<int>(std::lround(256 * ((height - y) * scale - 0.5))) };
  }
  [[nodiscard]] std::vector<cv::Point> points(const micrograph::Contour& contour) const
  {
    std::vector<cv::Point> found;
    for (const micrograph::Point& p : contour.points)
    {
      found.push_back(at(p[0], p[1]));
    }
    return found;
  }
};

/// The scan in colour, as large as the drawing.
cv::Mat background(const micrograph::Picture& scan, cv::Size size)
{
  const auto nx = static_cast<int>(scan.lattice.size[0]);
  const auto ny = static_cast<int>(scan.lattice.size[1]);
  const double full = scan.bits == 16 ? 257.0 : 1.0;
  cv::Mat picture(ny, nx, CV_8UC3);
  for (int y = 0; y < ny; ++y)
  {
    for (int x = 0; x < nx; ++x)
    {
      const auto node = static_cast<std::size_t>(nx) * static_cast<std::size_t>(y) + static_cast<std::size_t>(x);
      auto& pixel = picture.at<cv::Vec3b>(ny - 1 - y, x);
      for (int k = 0; k < 3; ++k)
      {
        const std::uint16_t v =
          scan.colour.empty() ? scan.grey[node] : scan.colour[3 * node + static_cast<std::size_t>(k)];
        pixel[k] = cv::saturate_cast<uchar>(v / full);
      }
    }
  }
  cv::Mat large;
  cv::resize(picture, large, size, 0, 0, size.width > nx ? cv::INTER_CUBIC : cv::INTER_AREA);
  return large;
}

/// What a lumen encloses with the picture's border: its chains in order. Lumens without a corner of the border in them
/// only; where there is one the fill cuts it off, which a tint does not show.
void fillLumens(
  Drawing& drawing, const micrograph::ContourSet& set, const std::function<bool(std::int32_t)>& which, cv::Mat& mask)
{
  std::map<std::int32_t, std::vector<cv::Point>> outlines;
  for (const micrograph::Contour& contour : set.contours)
  {
    if (which(contour.lumen))
    {
      const auto points = drawing.points(contour);
      auto& outline = outlines[contour.lumen];
      outline.insert(outline.end(), points.begin(), points.end());
    }
  }
  for (const auto& [lumen, outline] : outlines)
  {
    cv::fillPoly(mask, std::vector<std::vector<cv::Point>>{ outline }, cv::Scalar(1), cv::LINE_8, 8);
  }
}

void drawShares(Drawing& drawing, const micrograph::ContourLattice& lattice)
{
  const auto nx = static_cast<int>(lattice.image.lattice.size[0]);
  const auto ny = static_cast<int>(lattice.image.lattice.size[1]);
  cv::Mat share(ny, nx, CV_32F);
  for (int y = 0; y < ny; ++y)
  {
    std::copy_n(lattice.lumenShare.begin() + static_cast<std::ptrdiff_t>(nx) * y, nx, share.ptr<float>(ny - 1 - y));
  }
  cv::Mat wide;
  const double spacing = lattice.image.lattice.spacing;
  const int height = std::min(drawing.picture.rows, static_cast<int>(std::lround(ny * spacing * drawing.scale)));
  cv::resize(share, wide, cv::Size(drawing.picture.cols, height), 0, 0, cv::INTER_LINEAR);
  cv::Mat below = drawing.picture(cv::Rect(0, drawing.picture.rows - height, drawing.picture.cols, height));
  blend(below, wide, Colour(255, 255, 255), 1);
}

void tintLamella(Drawing& drawing, const OverlayParts& parts)
{
  const Lattice& lattice = parts.lattice->image.lattice;
  const auto nx = static_cast<int>(lattice.size[0]);
  const auto ny = static_cast<int>(lattice.size[1]);
  cv::Mat mask(ny, nx, CV_32F);
  for (int y = 0; y < ny; ++y)
  {
    for (int x = 0; x < nx; ++x)
    {
      mask.at<float>(ny - 1 - y, x) =
        (*parts.phase)[static_cast<std::size_t>(x) + static_cast<std::size_t>(nx) * static_cast<std::size_t>(y)] == 2
        ? 1.0F
        : 0.0F;
    }
  }
  const int height =
    std::min(drawing.picture.rows, static_cast<int>(std::lround(ny * lattice.spacing * drawing.scale)));
  const cv::Size size(drawing.picture.cols, height);
  cv::Mat wide;
  cv::resize(mask, wide, size, 0, 0, size.width > nx ? cv::INTER_LINEAR : cv::INTER_AREA);
  cv::Mat below = drawing.picture(cv::Rect(0, drawing.picture.rows - height, size.width, height));
  blend(below, wide, lamellaColour, parts.scan != nullptr ? 0.75F : 0.9F);
}

/// Strokes along the walls, one for each square of a grid whose middle lies in a wall.
void drawStrokes(Drawing& drawing, const OverlayParts& parts)
{
  const Lattice& lattice = parts.lattice->image.lattice;
  const double wall = parts.lattice->thickness.median * drawing.scale;
  const double step = std::clamp(wall / 2.5, 5 * drawing.line, 11 * drawing.line) / drawing.scale; // [m]
  const double half = 0.36 * step;
  const int width = std::max(1, static_cast<int>(std::lround(0.7 * drawing.line)));
  const auto count = [&](int axis) { return static_cast<std::int64_t>(std::ceil(lattice.length(axis) / step)); };
  for (std::int64_t j = 0; j < count(1); ++j)
  {
    for (std::int64_t i = 0; i < count(0); ++i)
    {
      const auto x =
        static_cast<std::int64_t>((static_cast<double>(i) + (j % 2 == 0 ? 0.25 : 0.75)) * step / lattice.spacing);
      const auto y = static_cast<std::int64_t>((static_cast<double>(j) + 0.5) * step / lattice.spacing);
      if (x >= lattice.size[0] || y >= lattice.size[1])
      {
        continue;
      }
      const auto node = static_cast<std::size_t>(lattice.index(x, y));
      const std::array<float, 2>& axis = parts.directions->axis[node];
      if (axis[0] == 0 && axis[1] == 0)
      {
        continue;
      }
      const double cx = (static_cast<double>(x) + 0.5) * lattice.spacing;
      const double cy = (static_cast<double>(y) + 0.5) * lattice.spacing;
      cv::line(drawing.picture, drawing.at(cx - half * axis[0], cy - half * axis[1]),
        drawing.at(cx + half * axis[0], cy + half * axis[1]), scalar(strokeColour), width, cv::LINE_AA, 8);
    }
  }
}

void drawOutlines(Drawing& drawing, const micrograph::ContourSet& set)
{
  for (const micrograph::Contour& contour : set.contours)
  {
    cv::polylines(drawing.picture, std::vector<std::vector<cv::Point>>{ drawing.points(contour) }, contour.closed,
      scalar(outlineColour), std::max(1, static_cast<int>(std::lround(drawing.line))), cv::LINE_AA, 8);
  }
}

void drawMarks(Drawing& drawing, const OverlayParts& parts)
{
  for (const micrograph::Mark& mark : parts.marks)
  {
    cv::rectangle(drawing.picture, drawing.at(mark.x0 * parts.pixel, mark.y0 * parts.pixel),
      drawing.at(mark.x1 * parts.pixel, mark.y1 * parts.pixel), scalar(markColour),
      std::max(1, static_cast<int>(std::lround(drawing.line))), cv::LINE_AA, 8);
  }
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

/// The picture over a white strip with a scale bar and what the colours mean; as many rows of them as are needed.
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
  if (parts.directions != nullptr)
  {
    items.push_back({ "wall direction", line(strokeColour, std::max(1.0, font / 12)), static_cast<int>(0.6 * wide) });
  }
  if (parts.phase != nullptr)
  {
    items.push_back({ "middle lamella", area(lamellaColour, 0.9), wide });
  }
  if (std::find(parts.vessel.begin(), parts.vessel.end(), true) != parts.vessel.end())
  {
    items.push_back({ "vessel", area(vesselColour, 0.45), wide });
  }
  if (!parts.marks.empty())
  {
    items.push_back({ "not counted",
      [](cv::Mat& to, cv::Rect box) { cv::rectangle(to, box, scalar(markColour), std::max(1, box.height / 8)); },
      wide });
  }

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
    {
      blend(whole, p.mask, ink, 1, p.text);
    }
  }
  return whole;
}

} // namespace

int overlayWidth(const OverlayParts& parts)
{
  if (parts.width > 0)
  {
    return parts.width;
  }
  // Walls a dozen pixels thick, but a picture of 1200 to 2400 pixels along its longer side; a large scan keeps its own.
  const auto& size = parts.contours->size;
  const double longer = std::max(size[0], size[1]);
  const double wall = parts.lattice != nullptr ? parts.lattice->thickness.median : 0;
  double pixels = std::clamp(wall > 0 ? 16 * longer / wall : 1600.0, 1200.0, 2400.0);
  if (parts.scan != nullptr)
  {
    pixels = std::max(pixels, std::min(6000.0, longer / parts.pixel));
  }
  return std::max(1, static_cast<int>(std::lround(pixels * size[0] / longer)));
}

micrograph::Picture drawOverlay(const OverlayParts& parts)
{
  const auto& size = parts.contours->size;
  const int width = overlayWidth(parts);
  const int height = std::max(1, static_cast<int>(std::lround(width * size[1] / size[0])));
  Drawing drawing;
  drawing.scale = finer * width / size[0];
  drawing.height = size[1];
  drawing.line = finer * std::clamp(std::max(width, height) / 1000.0, 1.0, 4.0);
  const cv::Size large(finer * width, finer * height);
  if (parts.scan != nullptr)
  {
    drawing.picture = background(*parts.scan, large);
  }
  else
  {
    drawing.picture = cv::Mat(large, CV_8UC3, scalar(wallColour));
    drawShares(drawing, *parts.lattice);
  }
  if (std::find(parts.vessel.begin(), parts.vessel.end(), true) != parts.vessel.end())
  {
    cv::Mat mask(large, CV_8U, cv::Scalar(0));
    fillLumens(
      drawing, *parts.contours,
      [&](std::int32_t lumen)
      {
        const auto i = static_cast<std::size_t>(lumen - 1);
        return lumen >= 1 && i < parts.vessel.size() && parts.vessel[i];
      },
      mask);
    mask.convertTo(mask, CV_32F);
    blend(drawing.picture, mask, vesselColour, 0.45F);
  }
  if (parts.directions != nullptr)
  {
    drawStrokes(drawing, parts);
  }
  if (parts.phase != nullptr) // over the strokes, which would hide a thin one
  {
    tintLamella(drawing, parts);
  }
  drawOutlines(drawing, *parts.contours);
  drawMarks(drawing, parts);
  cv::Mat small;
  cv::resize(drawing.picture, small, cv::Size(width, height), 0, 0, cv::INTER_AREA);
  const cv::Mat whole = withLegend(small, parts, width / size[0]);

  micrograph::Picture out;
  out.lattice = makeLattice(whole.cols, whole.rows, 1, 2, size[0] / width);
  out.fileSize = out.lattice.size;
  out.pixelSizeSource = "overlay";
  out.grey.resize(static_cast<std::size_t>(out.lattice.count()));
  out.colour.resize(3 * out.grey.size());
  std::size_t node = 0;
  for (int y = whole.rows - 1; y >= 0; --y)
  {
    for (int x = 0; x < whole.cols; ++x, ++node)
    {
      const auto& pixel = whole.at<cv::Vec3b>(y, x);
      out.grey[node] = static_cast<std::uint16_t>(std::lround(0.299 * pixel[0] + 0.587 * pixel[1] + 0.114 * pixel[2]));
      for (int k = 0; k < 3; ++k)
      {
        out.colour[3 * node + static_cast<std::size_t>(k)] = pixel[k];
      }
    }
  }
  return out;
}

} // namespace lamella::cli
