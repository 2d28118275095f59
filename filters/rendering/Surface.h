#pragma once

#include <cstdint>
#include <string>
#include <vector>

class vtkRenderer;

/// Drawing with VTK's OpenGL in a window that no screen shows (vtkOffScreenWindows), with smooth edges.
namespace lamella::rendering
{

inline constexpr int SmallTiles = 512;  ///< small buffers, with extra samples at edges
inline constexpr int LargeTiles = 2048; ///< few passes; twice as many pixels a side are within every driver's limits

/// Draws what the renderer holds, seen through its camera (parallel projection, its scale half the picture's height)
/// and on its background.
/// @param tileSide    the picture is drawn in tiles of at most this many pixels a side, each of which costs a pass over
/// all
///                    shapes: small for few shapes, large for many
/// @param transparent leave the background out
/// @param pixels      premultiplied RGBA, width × height, lowest row first
/// @returns false, and why, when nothing on this machine can draw
[[nodiscard]] bool Draw(vtkRenderer* renderer, int width, int height, int tileSide, bool transparent,
  std::vector<std::uint8_t>& pixels, std::string& whyNot);

/// The same for a flat drawing in the plane z = 0 whose unit is a pixel.
[[nodiscard]] bool DrawFlat(
  vtkRenderer* renderer, int width, int height, std::vector<std::uint8_t>& pixels, std::string& whyNot);

} // namespace lamella::rendering
