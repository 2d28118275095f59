#pragma once

#include "core/Random.h"
#include "generators/MicrographLook.h"

#include <cstdint>
#include <vector>

/// What makeLook() does one after another.
namespace lamella::generators
{

/// A picture in the making: light from 0 to 1, the channels of a pixel side by side, first row at the bottom.
struct LookCanvas
{
  std::int64_t width = 0, height = 0;
  int channels = 3;
  double pixel = 1; ///< [m]
  std::vector<float> light;
};

/// exp(−x) for x ≥ 0 by its series at x/256, squared eight times: the same bits on every machine, to 1e-9.
[[nodiscard]] double decay(double x) noexcept;
/// Smooth noise over the plane, one independent value a unit: mean 0, standard deviation near 0.6.
[[nodiscard]] double smoothField(const Random& random, RandomUse use, std::int64_t field, double x, double y) noexcept;
/// Numbers from 1 the pieces of marked nodes connected through faces, in the order of their first nodes; 0 elsewhere.
[[nodiscard]] std::vector<std::int32_t> labelled(
  const std::vector<std::uint8_t>& marked, std::int64_t nx, std::int64_t ny);

/// Cracks: no stain along short crooked lines.
void tear(std::vector<float>& stain, std::int64_t nx, std::int64_t ny, double spacing, const LookOptions& options);
void addDirt(LookCanvas& canvas, const LookOptions& options);
/// Gaussian of standard deviation sigma [pixels]; the picture goes on beyond its border as at it.
void blur(LookCanvas& canvas, double sigma);
void addUnevenLight(LookCanvas& canvas, const LookOptions& options);
void addNoise(LookCanvas& canvas, const LookOptions& options);
/// @param values 8 bits a channel, arranged as the canvas
void drawScaleBar(std::vector<std::uint16_t>& values, const LookCanvas& canvas, const LookOptions& options);

} // namespace lamella::generators
