#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

class vtkImageData;

namespace lamella::rendering
{

/// A colour, each channel 0 … 255; alpha is not premultiplied.
struct Color
{
  std::uint8_t r = 0;
  std::uint8_t g = 0;
  std::uint8_t b = 0;
  std::uint8_t a = 255;
  bool operator==(const Color&) const = default;
};

/// Whole pixels: lower left corner and size. As everywhere in VTK, y points up and row 0 is the lowest.
struct PixelRect
{
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
  [[nodiscard]] int Right() const { return this->x + this->width; }
  [[nodiscard]] int Top() const { return this->y + this->height; }
};

enum class Align
{
  Low, ///< left, or bottom (baseline of the text)
  Middle,
  High
};

/// A picture in the making: exact pixels for what is made of pixels, blending for what is drawn elsewhere.
class Canvas
{
public:
  Canvas(int width, int height, Color background);

  [[nodiscard]] int Width() const { return this->Size[0]; }
  [[nodiscard]] int Height() const { return this->Size[1]; }

  void Fill(const PixelRect& rect, Color color);
  /// A frame just outside the rectangle.
  void Frame(const PixelRect& rect, int thickness, Color color);
  void SetPixel(int x, int y, Color color);
  [[nodiscard]] Color Pixel(int x, int y) const;

  /// Lays a colour over the rectangle, as strongly as `coverage` (rect.width × rect.height bytes) says.
  void Cover(const PixelRect& rect, const std::vector<std::uint8_t>& coverage, Color color);
  /// Lays premultiplied RGBA pixels (rect.width × rect.height × 4 bytes) over the rectangle.
  void Blend(const PixelRect& rect, const std::vector<std::uint8_t>& premultiplied);

  /// Text with its anchor at (x, y): the baseline vertically (Low), or the middle or top of the capitals; ends of the
  /// line horizontally. `upwards` turns it by 90°, reading from bottom to top; the anchor's meaning turns with it.
  void Text(double x, double y, const std::string& text, double size, Color color, Align along, Align across,
    bool upwards = false);

  /// The picture as vtkImageData, unsigned char: RGB, or RGBA when any pixel is not opaque and `alpha` asks for it.
  void CopyTo(vtkImageData* image, bool alpha) const;

private:
  std::uint8_t* At(int x, int y)
  {
    return &this->Pixels[4 *
      (static_cast<std::size_t>(y) * static_cast<std::size_t>(this->Size[0]) + static_cast<std::size_t>(x))];
  }
  void Over(std::uint8_t* pixel, std::array<std::uint8_t, 4> premultiplied);

  std::array<int, 2> Size;
  std::vector<std::uint8_t> Pixels; ///< RGBA, premultiplied
};

} // namespace lamella::rendering
