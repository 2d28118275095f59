#include "Surface.h"

#include "vtkCamera.h"
#include "vtkNew.h"
#include "vtkOffScreenWindows.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkSmartPointer.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>

namespace lamella::rendering
{
namespace
{

// Drawn larger and averaged, on top of four samples a pixel: sixteen levels of grey on every edge.
constexpr int Oversampling = 2;
constexpr int Samples = 4;
constexpr int LargestSide = 8192; // what every OpenGL 3.2 driver draws

} // namespace

bool Draw(vtkRenderer* renderer, int width, int height, bool transparent, std::vector<std::uint8_t>& pixels,
  std::string& whyNot)
{
  const auto window = vtkSmartPointer<vtkRenderWindow>::Take(vtkOffScreenWindows::NewWindow());
  if (!window)
  {
    whyNot = vtkOffScreenWindows::GetMessage();
    return false;
  }
  const int n = std::max(width, height) * Oversampling <= LargestSide ? Oversampling : 1;
  if (std::max(width, height) > LargestSide)
  {
    whyNot = "a drawing of " + std::to_string(width) + " × " + std::to_string(height) +
      " pixels is larger than OpenGL allows (" + std::to_string(LargestSide) + ")";
    return false;
  }
  window->SetMultiSamples(Samples);
  window->SetAlphaBitPlanes(1);
  window->SetSize(width * n, height * n);
  window->AddRenderer(renderer);
  if (transparent)
  {
    renderer->SetBackground(0, 0, 0);
    renderer->SetBackgroundAlpha(0);
  }
  else
  {
    renderer->SetBackgroundAlpha(1);
  }
  window->Render();
  vtkNew<vtkUnsignedCharArray> data;
  const bool read = window->GetRGBACharPixelData(0, 0, width * n - 1, height * n - 1, 0, data) != 0 &&
    data->GetNumberOfValues() == 4LL * width * n * height * n;
  window->RemoveRenderer(renderer);
  if (!read)
  {
    whyNot = std::string("the drawing cannot be read back (") + vtkOffScreenWindows::GetMessage() + ")";
    return false;
  }

  const unsigned char* source = data->GetPointer(0);
  pixels.assign(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0);
  const auto stride = 4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(n);
  std::uint8_t* out = pixels.data();
  for (int y = 0; y < height; ++y)
  {
    for (int x = 0; x < width; ++x)
    {
      for (std::size_t c = 0; c < 4; ++c)
      {
        unsigned sum = static_cast<unsigned>(n * n) / 2;
        for (int v = 0; v < n; ++v)
        {
          for (int u = 0; u < n; ++u)
          {
            sum += source[static_cast<std::size_t>(y * n + v) * stride + 4 * static_cast<std::size_t>(x * n + u) + c];
          }
        }
        *out++ = static_cast<std::uint8_t>(sum / static_cast<unsigned>(n * n));
      }
    }
  }
  return true;
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
  return Draw(renderer, width, height, false, pixels, whyNot);
}

} // namespace lamella::rendering
