#include "micrograph/MicrographOverlay.h"

#include "micrograph/MicrographLegend.h"

#include "outlines/ContourBorder.h"
#include "vtkLatticeConversion.h"

#include <vtkFloatArray.h>
#include <vtkPointData.h>
#include <vtkUnsignedCharArray.h>

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <functional>

namespace lamella::cli
{

namespace
{

constexpr int finer = 2; // lines are drawn this much larger and averaged

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
  [[nodiscard]] std::vector<cv::Point> points(const std::vector<micrograph::Point>& chain) const
  {
    std::vector<cv::Point> found;
    for (const micrograph::Point& p : chain)
      found.push_back(at(p[0], p[1]));
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

/// Lumens with the picture's border where it cuts them.
void fillLumens(
  Drawing& drawing, const micrograph::ContourSet& set, const std::function<bool(std::int32_t)>& which, cv::Mat& mask)
{
  for (const micrograph::Outline& outline : micrograph::outlines(set))
  {
    if (which(outline.lumen))
    {
      const std::vector<std::vector<cv::Point>> polygon{ drawing.points(outline.points) };
      cv::fillPoly(mask, polygon, cv::Scalar(1), cv::LINE_8, 8);
    }
  }
}

/// An array at the lattice's points.
template <class Array>
auto* values(const OverlayParts& parts, const char* name)
{
  return Array::SafeDownCast(parts.lattice->GetPointData()->GetArray(name))->GetPointer(0);
}

void drawShares(Drawing& drawing, const OverlayParts& parts)
{
  const Lattice lattice = latticeOf(parts.lattice);
  const auto nx = static_cast<int>(lattice.size[0]);
  const auto ny = static_cast<int>(lattice.size[1]);
  const float* const shares = values<vtkFloatArray>(parts, "lumen_share");
  cv::Mat share(ny, nx, CV_32F);
  for (int y = 0; y < ny; ++y)
    std::copy_n(shares + static_cast<std::ptrdiff_t>(nx) * y, nx, share.ptr<float>(ny - 1 - y));
  cv::Mat wide;
  const int height =
    std::min(drawing.picture.rows, static_cast<int>(std::lround(ny * lattice.spacing * drawing.scale)));
  cv::resize(share, wide, cv::Size(drawing.picture.cols, height), 0, 0, cv::INTER_LINEAR);
  cv::Mat below = drawing.picture(cv::Rect(0, drawing.picture.rows - height, drawing.picture.cols, height));
  blend(below, wide, Colour(255, 255, 255), 1);
}

void tintLamella(Drawing& drawing, const OverlayParts& parts)
{
  const Lattice lattice = latticeOf(parts.lattice);
  const unsigned char* const phase = values<vtkUnsignedCharArray>(parts, "phase");
  const auto nx = static_cast<int>(lattice.size[0]);
  const auto ny = static_cast<int>(lattice.size[1]);
  cv::Mat mask(ny, nx, CV_32F);
  for (int y = 0; y < ny; ++y)
  {
    for (int x = 0; x < nx; ++x)
    {
      mask.at<float>(ny - 1 - y, x) =
        phase[static_cast<std::size_t>(x) + static_cast<std::size_t>(nx) * static_cast<std::size_t>(y)] == 2 ? 1.0F
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
  const Lattice lattice = latticeOf(parts.lattice);
  const float* const directions = values<vtkFloatArray>(parts, "axis");
  const double wall = parts.wall * drawing.scale;
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
        continue;
      const auto node = static_cast<std::size_t>(lattice.index(x, y));
      const float* const axis = directions + 3 * node;
      if (axis[0] == 0 && axis[1] == 0)
        continue;
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
    cv::polylines(drawing.picture, std::vector<std::vector<cv::Point>>{ drawing.points(contour.points) },
      contour.closed, scalar(outlineColour), std::max(1, static_cast<int>(std::lround(drawing.line))), cv::LINE_AA, 8);
  }
}

void drawMarks(Drawing& drawing, const OverlayParts& parts)
{
  for (const micrograph::Mark& mark : parts.marks)
  {
    cv::rectangle(drawing.picture, drawing.at(mark.x0 * parts.pixel, mark.y0 * parts.pixel),
      drawing.at(mark.x1 * parts.pixel, mark.y1 * parts.pixel),
      scalar(mark.kind == micrograph::Mark::Kind::Gap ? gapColour : markColour),
      std::max(1, static_cast<int>(std::lround(drawing.line))), cv::LINE_AA, 8);
  }
}

} // namespace

int overlayWidth(const OverlayParts& parts)
{
  if (parts.width > 0)
    return parts.width;
  // Walls a dozen pixels thick, but a picture of 1200 to 2400 pixels along its longer side; a large scan keeps its own.
  const auto& size = parts.contours->size;
  const double longer = std::max(size[0], size[1]);
  double pixels = std::clamp(parts.wall > 0 ? 16 * longer / parts.wall : 1600.0, 1200.0, 2400.0);
  if (parts.scan != nullptr)
    pixels = std::max(pixels, std::min(6000.0, longer / parts.pixel));
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
    drawShares(drawing, parts);
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
  drawStrokes(drawing, parts);
  if (parts.lamella) // over the strokes, which would hide a thin one
    tintLamella(drawing, parts);
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
        out.colour[3 * node + static_cast<std::size_t>(k)] = pixel[k];
    }
  }
  return out;
}

} // namespace lamella::cli
