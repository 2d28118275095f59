#include "Canvas.h"

#include "Text.h"
#include "vtkImageData.h"

#include <algorithm>
#include <cmath>

namespace lamella::rendering
{
namespace
{

std::uint8_t Multiply(std::uint8_t a, std::uint8_t b)
{
  const unsigned product = static_cast<unsigned>(a) * b + 127;
  return static_cast<std::uint8_t>(product / 255);
}

std::array<std::uint8_t, 4> Premultiply(Color color, std::uint8_t coverage)
{
  const std::uint8_t alpha = Multiply(color.a, coverage);
  return { Multiply(color.r, alpha), Multiply(color.g, alpha), Multiply(color.b, alpha), alpha };
}

PixelRect Clip(const PixelRect& rect, int width, int height)
{
  const int x0 = std::clamp(rect.x, 0, width);
  const int y0 = std::clamp(rect.y, 0, height);
  return { x0, y0, std::clamp(rect.Right(), 0, width) - x0, std::clamp(rect.Top(), 0, height) - y0 };
}

} // namespace

Canvas::Canvas(int width, int height, Color background)
  : Size{ width, height }
  , Pixels(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height))
{
  const auto filled = Premultiply(background, 255);
  for (std::size_t i = 0; i < this->Pixels.size(); i += 4)
    std::copy(filled.begin(), filled.end(), this->Pixels.begin() + static_cast<std::ptrdiff_t>(i));
}

void Canvas::Over(std::uint8_t* pixel, std::array<std::uint8_t, 4> premultiplied)
{
  const auto rest = static_cast<std::uint8_t>(255 - premultiplied[3]);
  for (std::size_t c = 0; c < 4; ++c)
    pixel[c] = static_cast<std::uint8_t>(std::min(255, premultiplied[c] + Multiply(pixel[c], rest)));
}

void Canvas::SetPixel(int x, int y, Color color)
{
  const auto premultiplied = Premultiply(color, 255);
  std::copy(premultiplied.begin(), premultiplied.end(), this->At(x, y));
}

Color Canvas::Pixel(int x, int y) const
{
  const std::uint8_t* p = const_cast<Canvas*>(this)->At(x, y);
  if (p[3] == 0)
    return { 0, 0, 0, 0 };
  const auto straight = [&](std::uint8_t c)
  { return static_cast<std::uint8_t>(std::min(255, (c * 255 + p[3] / 2) / p[3])); };
  return { straight(p[0]), straight(p[1]), straight(p[2]), p[3] };
}

void Canvas::Fill(const PixelRect& rect, Color color)
{
  const PixelRect inside = Clip(rect, this->Width(), this->Height());
  const auto premultiplied = Premultiply(color, 255);
  for (int y = inside.y; y < inside.Top(); ++y)
    for (int x = inside.x; x < inside.Right(); ++x)
      this->Over(this->At(x, y), premultiplied);
}

void Canvas::Frame(const PixelRect& rect, int thickness, Color color)
{
  const int t = thickness;
  this->Fill({ rect.x - t, rect.y - t, rect.width + 2 * t, t }, color);
  this->Fill({ rect.x - t, rect.Top(), rect.width + 2 * t, t }, color);
  this->Fill({ rect.x - t, rect.y, t, rect.height }, color);
  this->Fill({ rect.Right(), rect.y, t, rect.height }, color);
}

void Canvas::Cover(const PixelRect& rect, const std::vector<std::uint8_t>& coverage, Color color)
{
  const PixelRect inside = Clip(rect, this->Width(), this->Height());
  for (int y = inside.y; y < inside.Top(); ++y)
  {
    for (int x = inside.x; x < inside.Right(); ++x)
    {
      const std::uint8_t strength =
        coverage[static_cast<std::size_t>(y - rect.y) * static_cast<std::size_t>(rect.width) +
          static_cast<std::size_t>(x - rect.x)];
      if (strength != 0)
        this->Over(this->At(x, y), Premultiply(color, strength));
    }
  }
}

void Canvas::Blend(const PixelRect& rect, const std::vector<std::uint8_t>& premultiplied)
{
  const PixelRect inside = Clip(rect, this->Width(), this->Height());
  for (int y = inside.y; y < inside.Top(); ++y)
  {
    const std::uint8_t* source = &premultiplied[4 *
      (static_cast<std::size_t>(y - rect.y) * static_cast<std::size_t>(rect.width) +
        static_cast<std::size_t>(inside.x - rect.x))];
    for (int x = inside.x; x < inside.Right(); ++x, source += 4)
      this->Over(this->At(x, y), { source[0], source[1], source[2], source[3] });
  }
}

void Canvas::Text(
  double x, double y, const std::string& text, double size, Color color, Align along, Align across, bool upwards)
{
  const TextImage image = DrawText(text, size);
  const TextMetrics metrics = MeasureText(text, size);
  const double share = along == Align::Low ? 0.0 : along == Align::Middle ? 0.5 : 1.0;
  const double rise = across == Align::Low ? 0.0 : across == Align::Middle ? 0.5 : 1.0;
  const double left = -share * metrics.width;
  const double base = -rise * metrics.capHeight;
  // Lower left corner of the text's image relative to the anchor, in the text's own axes.
  const double u = left - image.originX;
  const double v = base - image.originY;
  if (!upwards)
  {
    this->Cover(
      { static_cast<int>(std::lround(x + u)), static_cast<int>(std::lround(y + v)), image.width, image.height },
      image.coverage, color);
    return;
  }
  // Turned by 90°: along the text is up, across it is to the left.
  std::vector<std::uint8_t> turned(image.coverage.size());
  for (int j = 0; j < image.height; ++j)
  {
    for (int i = 0; i < image.width; ++i)
    {
      turned[static_cast<std::size_t>(i) * static_cast<std::size_t>(image.height) +
        static_cast<std::size_t>(image.height - 1 - j)] =
        image
          .coverage[static_cast<std::size_t>(j) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(i)];
    }
  }
  this->Cover({ static_cast<int>(std::lround(x - v)) - image.height, static_cast<int>(std::lround(y + u)), image.height,
                image.width },
    turned, color);
}

void Canvas::CopyTo(vtkImageData* image, bool alpha) const
{
  const int components = alpha ? 4 : 3;
  image->SetDimensions(this->Width(), this->Height(), 1);
  image->SetSpacing(1, 1, 1);
  image->SetOrigin(0, 0, 0);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, components);
  auto* out = static_cast<unsigned char*>(image->GetScalarPointer());
  for (int y = 0; y < this->Height(); ++y)
  {
    for (int x = 0; x < this->Width(); ++x, out += components)
    {
      const Color color = this->Pixel(x, y);
      out[0] = color.r;
      out[1] = color.g;
      out[2] = color.b;
      if (alpha)
        out[3] = color.a;
    }
  }
}

} // namespace lamella::rendering
