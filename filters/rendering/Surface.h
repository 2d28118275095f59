#pragma once

#include <cstdint>
#include <string>
#include <vector>

class vtkRenderer;

/// Drawing with VTK's OpenGL in a window that no screen shows (vtkOffScreenWindows), with smooth edges.
namespace lamella::rendering
{

/// Draws what the renderer holds, seen through its camera and on its background.
/// @param transparent leave the background out
/// @param pixels      premultiplied RGBA, width × height, lowest row first
/// @returns false, and why, when nothing on this machine can draw
[[nodiscard]] bool Draw(vtkRenderer* renderer, int width, int height, bool transparent,
  std::vector<std::uint8_t>& pixels, std::string& whyNot);

/// The same for a flat drawing in the plane z = 0 whose unit is a pixel.
[[nodiscard]] bool DrawFlat(
  vtkRenderer* renderer, int width, int height, std::vector<std::uint8_t>& pixels, std::string& whyNot);

} // namespace lamella::rendering
