#pragma once

#include "lattice/Phases.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

/// The windows that a picture (volume) is cut into evenly: for how far it speaks for its material
/// (statistics/WindowError.h).
namespace lamella
{

struct SubWindow
{
  std::array<std::int64_t, 3> first{ 0, 0, 0 }; ///< node of the picture, as memory counts
  std::array<std::int64_t, 3> size{ 1, 1, 1 };
};

struct SubWindows
{
  std::array<std::size_t, 3> counts{ 1, 1, 1 }; ///< along x, y, z
  std::vector<SubWindow> windows;               ///< x fastest, then y; every node is in one of them
};

/// Cuts each axis into this many parts, as even as whole nodes allow; an axis on which a part would have fewer than
/// four nodes is not cut.
/// @param parts from 2 on
[[nodiscard]] SubWindows subWindows(const Lattice& lattice, int parts);

/// Into how many parts pictures are cut, the largest windows first.
inline constexpr std::array windowParts{ 2, 3 };

/// To which their values are found: windows differ by per cents, more digits of them tell nothing.
inline constexpr double windowTolerance = 1e-3;

/// What a window holds of values, one a node of the picture.
template <class Value>
[[nodiscard]] std::vector<Value> cut(const Lattice& from, std::span<const Value> values, const SubWindow& window)
{
  std::vector<Value> part;
  part.reserve(static_cast<std::size_t>(window.size[0] * window.size[1] * window.size[2]));
  for (std::int64_t z = 0; z < window.size[2]; ++z)
    for (std::int64_t y = 0; y < window.size[1]; ++y)
    {
      const auto row = values.begin() + from.index(window.first[0], window.first[1] + y, window.first[2] + z);
      part.insert(part.end(), row, row + window.size[0]);
    }
  return part;
}

/// The lattice of a window; its origin is that of its first node.
[[nodiscard]] Lattice latticeOf(const Lattice& from, const SubWindow& window);

/// One of them as a picture of its own.
[[nodiscard]] PhaseImage cut(const PhaseImage& image, const SubWindow& window);

} // namespace lamella
