#pragma once

#include "Canvas.h"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Colours: maps for quantities, sets for phases and grains.
namespace lamella::rendering
{

/// Colours for numbers from 0 to 1. Perceptually uniform, but for `coolwarm`:
/// viridis, inferno, magma (van der Walt and Smith, CC0), cividis (Nuñez, Anderton and Renslow 2018, CC0), gray, and
/// for values on both sides of zero coolwarm (Moreland 2009).
class ColorMap
{
public:
  /// The names that Find() knows, in the order in which messages list them.
  static std::span<const std::string_view> Names();
  /// @returns nullptr for an unknown name; the map lives as long as the program
  static const ColorMap* Find(std::string_view name);

  /// @param t 0 … 1; what lies outside takes the colour of the end
  [[nodiscard]] Color At(double t) const;

  explicit ColorMap(std::span<const std::uint32_t> points);

private:
  std::vector<std::uint32_t> Points; ///< 0xRRGGBB, evenly spaced
};

/// Where nothing is defined (NaN: a phase that does not conduct).
inline constexpr Color Undefined{ 198, 198, 198, 255 };

/// Colour of a phase by its id, and by its name where the name tells: pores and lumens are near white, walls tan, the
/// middle lamella dark brown, stone sandy; other phases take the next of a set that colour-blind readers tell apart
/// (Tol 2021).
[[nodiscard]] std::vector<Color> PhaseColors(std::span<const std::string> names);

/// Is this phase empty space by its name: void, pore, lumen, air, gas ...?
[[nodiscard]] bool IsVoidName(std::string_view name);

/// Colours for grains (ids on an nx × ny × nz lattice, 0: no grain) such that neighbours differ. A grain keeps its
/// colour from picture to picture as long as its neighbours allow. One colour an id, from 0 to the largest id.
[[nodiscard]] std::vector<Color> GrainColors(std::span<const std::int64_t> ids, int nx, int ny, int nz);

} // namespace lamella::rendering
