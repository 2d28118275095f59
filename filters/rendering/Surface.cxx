#include "Surface.h"

#include "vtkCamera.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkOffScreenWindows.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkSmartPointer.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <array>

namespace lamella::rendering
{
namespace
{

// Drawn larger and averaged; flat drawings have four samples a pixel besides, which makes sixteen levels of grey.
constexpr int Oversampling = 2;
constexpr int Samples = 4;

/// Averages a tile of Oversampling² times as many pixels into the picture.
void Reduce(vtkUnsignedCharArray* tile, int tileWidth, int tileHeight, int x0, int y0, int width, int height,
  std::vector<std::uint8_t>& pixels)
{
  constexpr auto n = static_cast<std::size_t>(Oversampling);
  const unsigned char* source = tile->GetPointer(0);
  const std::size_t stride = 4 * n * static_cast<std::size_t>(tileWidth);
  for (int y = 0; y < std::min(tileHeight, height - y0); ++y)
  {
    std::uint8_t* out =
      &pixels[4 * (static_cast<std::size_t>(y0 + y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x0))];
    const unsigned char* row = source + static_cast<std::size_t>(y) * n * stride;
    for (int x = 0; x < std::min(tileWidth, width - x0); ++x, row += 4 * n)
    {
      for (std::size_t c = 0; c < 4; ++c)
      {
        unsigned sum = static_cast<unsigned>(n * n) / 2;
        for (std::size_t v = 0; v < n; ++v)
          for (std::size_t u = 0; u < n; ++u)
            sum += row[v * stride + 4 * u + c];
        *out++ = static_cast<std::uint8_t>(sum / static_cast<unsigned>(n * n));
      }
    }
  }
}

} // namespace

bool Draw(vtkRenderer* renderer, int width, int height, int tileSide, bool transparent,
  std::vector<std::uint8_t>& pixels, std::string& whyNot)
{
  const auto window = vtkSmartPointer<vtkRenderWindow>::Take(vtkOffScreenWindows::NewWindow());
  if (!window)
  {
    whyNot = vtkOffScreenWindows::GetMessage();
    return false;
  }
  const int tileWidth = std::min(width, tileSide);
  const int tileHeight = std::min(height, tileSide);
  window->SetMultiSamples(tileSide <= SmallTiles ? Samples : 0);
  window->SetAlphaBitPlanes(1);
  window->SetSize(tileWidth * Oversampling, tileHeight * Oversampling);
  window->AddRenderer(renderer);
  if (transparent)
    renderer->SetBackground(0, 0, 0);
  renderer->SetBackgroundAlpha(transparent ? 0 : 1);

  // Each tile is seen by the same camera, moved within the plane that it looks at.
  vtkCamera* camera = renderer->GetActiveCamera();
  vtkNew<vtkCamera> whole;
  whole->DeepCopy(camera);
  std::array<double, 3> forward{};
  std::array<double, 3> up{};
  std::array<double, 3> right{};
  whole->OrthogonalizeViewUp();
  whole->GetDirectionOfProjection(forward.data());
  whole->GetViewUp(up.data());
  vtkMath::Cross(forward.data(), up.data(), right.data());
  const double pixel = 2 * whole->GetParallelScale() / height;
  camera->SetParallelScale(0.5 * tileHeight * pixel);

  pixels.assign(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0);
  vtkNew<vtkUnsignedCharArray> data;
  bool read = true;
  for (int y = 0; y < height && read; y += tileHeight)
  {
    for (int x = 0; x < width && read; x += tileWidth)
    {
      const double dx = (x + 0.5 * tileWidth - 0.5 * width) * pixel;
      const double dy = (y + 0.5 * tileHeight - 0.5 * height) * pixel;
      std::array<double, 3> focus{};
      std::array<double, 3> position{};
      for (std::size_t axis = 0; axis < 3; ++axis)
      {
        const double move = dx * right.at(axis) + dy * up.at(axis);
        focus.at(axis) = whole->GetFocalPoint()[axis] + move;
        position.at(axis) = whole->GetPosition()[axis] + move;
      }
      camera->SetFocalPoint(focus.data());
      camera->SetPosition(position.data());
      window->Render();
      read =
        window->GetRGBACharPixelData(0, 0, tileWidth * Oversampling - 1, tileHeight * Oversampling - 1, 0, data) != 0 &&
        data->GetNumberOfValues() == 4LL * tileWidth * Oversampling * tileHeight * Oversampling;
      if (read)
        Reduce(data, tileWidth, tileHeight, x, y, width, height, pixels);
    }
  }
  camera->DeepCopy(whole);
  window->RemoveRenderer(renderer);
  if (!read)
    whyNot = std::string("the drawing cannot be read back (") + vtkOffScreenWindows::GetMessage() + ")";
  return read;
}

bool DrawFlat(vtkRenderer* renderer, int width, int height, std::vector<std::uint8_t>& pixels, std::string& whyNot)
{
  vtkCamera* camera = renderer->GetActiveCamera();
  camera->ParallelProjectionOn();
  camera->SetParallelScale(0.5 * height);
  camera->SetFocalPoint(0.5 * width, 0.5 * height, 0);
  camera->SetPosition(0.5 * width, 0.5 * height, 1);
  camera->SetViewUp(0, 1, 0);
  camera->SetClippingRange(0.5, 2);
  return Draw(renderer, width, height, SmallTiles, false, pixels, whyNot);
}

} // namespace lamella::rendering
