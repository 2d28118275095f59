#pragma once

#include <vtkImageData.h>
#include <vtkPNGReader.h>
#include <vtkSmartPointer.h>

#include <array>
#include <cstddef>
#include <cstdlib>
#include <ostream>
#include <set>
#include <string>

/// What a picture is made of: measures that hold for any driver and any font.
namespace pixels
{

using Rgb = std::array<int, 3>;

inline std::ostream& operator<<(std::ostream& os, const Rgb& c)
{
  return os << "rgb(" << c[0] << ", " << c[1] << ", " << c[2] << ")";
}

struct Rect
{
  int x;
  int y;
  int width;
  int height;
};

inline const unsigned char* pixel(vtkImageData* picture, int x, int y)
{
  return static_cast<const unsigned char*>(picture->GetScalarPointer()) +
    (static_cast<std::ptrdiff_t>(y) * picture->GetDimensions()[0] + x) * picture->GetNumberOfScalarComponents();
}

inline Rgb at(vtkImageData* picture, int x, int y)
{
  const unsigned char* p = pixel(picture, x, y);
  return { p[0], p[1], p[2] };
}

inline int alphaAt(vtkImageData* picture, int x, int y)
{
  return pixel(picture, x, y)[3];
}

inline Rect whole(vtkImageData* picture)
{
  return { 0, 0, picture->GetDimensions()[0], picture->GetDimensions()[1] };
}

inline std::size_t distinctColors(vtkImageData* picture, const Rect& rect)
{
  std::set<Rgb> colors;
  for (int y = rect.y; y < rect.y + rect.height; ++y)
    for (int x = rect.x; x < rect.x + rect.width; ++x)
      colors.insert(at(picture, x, y));
  return colors.size();
}

inline double shareOf(vtkImageData* picture, const Rect& rect, const Rgb& color)
{
  double count = 0;
  for (int y = rect.y; y < rect.y + rect.height; ++y)
    for (int x = rect.x; x < rect.x + rect.width; ++x)
      count += at(picture, x, y) == color ? 1 : 0;
  return count / rect.width / rect.height;
}

/// Share of the pixels of a rectangle that differ by more than `tolerance` in any channel.
inline double difference(vtkImageData* a, vtkImageData* b, const Rect& rect, int tolerance)
{
  double count = 0;
  for (int y = rect.y; y < rect.y + rect.height; ++y)
  {
    for (int x = rect.x; x < rect.x + rect.width; ++x)
    {
      const Rgb p = at(a, x, y);
      const Rgb q = at(b, x, y);
      bool differs = false;
      for (std::size_t c = 0; c < 3; ++c)
        differs = differs || std::abs(p[c] - q[c]) > tolerance;
      count += differs ? 1 : 0;
    }
  }
  return count / rect.width / rect.height;
}

} // namespace pixels
