#include "generators/MicrographLook.h"

#include "generators/LookParts.h"
#include "generators/Nearest.h"

#include "core/Error.h"
#include "core/Memory.h"
#include "lattice/PhaseNames.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lamella::generators
{
namespace
{

void check(const PhaseImage& truth, int n, const LookOptions& o)
{
  const auto [nx, ny, nz] = truth.lattice.size;
  if (truth.lattice.dimension != 2)
    throw ParameterError("a micrograph of a volume", "give a cross-section, a picture of one layer");
  if (n < 1 || n > 16 || nx % n != 0 || ny % n != 0)
  {
    throw ParameterError(fmt::format("{} × {} nodes for pixels of {} × {} nodes", nx, ny, n, n),
      "give 1 to 16 nodes a pixel, and a multiple of them along x and y");
  }
  const auto within = [](const char* name, double value, double low, double high, const char* unit)
  {
    if (!(value >= low) || !(value <= high))
      throw ParameterError(
        fmt::format("{} of {}{}", name, value, unit), fmt::format("it lies between {:g} and {:g}{}", low, high, unit));
  };
  within("a stain's strength", o.strength, 0.2, 2, "");
  within("a variation from cell to cell", o.cellVariation, 0, 1, "");
  within("a variation along walls", o.wallVariation, 0, 1, "");
  within("a depth of the lamella's stain", o.lamella, 0, 3, "");
  within("a lamella's width", o.lamellaWidth, 1e-9, 1e-4, " m");
  within("a rim's depth", o.rim, 0, 3, "");
  within("a rim's width", o.rimWidth, 1e-9, 1e-4, " m");
  within("a tint", o.tint, 0, 1, "");
  within("noise", o.noise, 0, 0.5, "");
  within("uneven light", o.unevenLight, 0, 0.95, "");
  within("dirt", o.dirt, 0, 1e4, " specks a mm²");
  within("tears", o.tears, 0, 1e4, " a mm²");
  const double pixel = truth.lattice.spacing * n;
  within("a blur", o.blur, 0, 50 * pixel, " m");
  const double width = static_cast<double>(nx / n) * pixel;
  if (o.scaleBar != 0 && !(o.scaleBar > 0 && o.scaleBar <= 0.8 * width))
  {
    throw ParameterError(fmt::format("a scale bar of {} m in a picture {} m wide", o.scaleBar, width),
      "make it shorter than four fifths of the picture, or 0 for none");
  }
  if (o.scaleBar != 0 && (nx / n < 120 || ny / n < 80))
  {
    throw ParameterError(fmt::format("a scale bar in a picture of {} × {} pixels", nx / n, ny / n),
      "give at least 120 × 80 pixels, or no bar");
  }
  const double bytes = 35 * static_cast<double>(nx) * static_cast<double>(ny);
  if (const auto available = static_cast<double>(availableMemory()); bytes > available)
  {
    throw MemoryError(fmt::format("a micrograph from {} × {} nodes takes {} to make, and {} are free", nx, ny,
                        bytesText(bytes), bytesText(available)),
      "make a smaller one, or fewer nodes a pixel");
  }
}

/// How deeply every node of the truth is stained.
std::vector<float> stainOf(const PhaseImage& truth, const LookOptions& o, const std::vector<std::uint8_t>& open)
{
  const auto [nx, ny, nz] = truth.lattice.size;
  const double spacing = truth.lattice.spacing;
  const Random random(o.seed);
  std::vector<float> stain(open.size(), static_cast<float>(o.tint));
  const std::vector<std::int32_t> lumens = labelled(open, nx, ny);
  const Nearest toLumen = nearestMarked(open, nx, ny);
  // Where the nearest lumen changes.
  std::vector<std::uint8_t> middle(open.size(), 0);
  const auto lumenOf = [&](std::size_t i)
  { return toLumen.node[i] < 0 ? 0 : lumens[static_cast<std::size_t>(toLumen.node[i])]; };
  for (std::int64_t y = 0; y < ny; ++y)
  {
    for (std::int64_t x = 0; x < nx; ++x)
    {
      const auto i = static_cast<std::size_t>(x + nx * y);
      const auto right = x + 1 < nx ? i + 1 : i;
      const auto up = y + 1 < ny ? i + static_cast<std::size_t>(nx) : i;
      middle[i] = open[i] == 0 && (lumenOf(right) != lumenOf(i) || lumenOf(up) != lumenOf(i));
    }
  }
  const Nearest toMiddle = o.lamella > 0 ? nearestMarked(middle, nx, ny) : Nearest{};
  const Nearest toWall = [&]
  {
    std::vector<std::uint8_t> walls(open.size());
    std::transform(open.begin(), open.end(), walls.begin(), [](std::uint8_t v) { return v == 0; });
    return o.rim > 0 ? nearestMarked(walls, nx, ny) : Nearest{};
  }();
  const double lamellaHalf = o.lamellaWidth / spacing / 2;
  const double rim = o.rimWidth / spacing;
  const double patch = 12e-6 / spacing;
  for (std::int64_t y = 0; y < ny; ++y)
  {
    for (std::int64_t x = 0; x < nx; ++x)
    {
      const auto i = static_cast<std::size_t>(x + nx * y);
      double depth = o.tint;
      double edge = 0; // distance to the lumen's edge
      if (open[i] == 0)
      {
        depth = std::max(0.2, 1 + o.cellVariation * random.normal(RandomUse::Stain, lumenOf(i))) *
          std::max(0.2,
            1 +
              o.wallVariation *
                smoothField(
                  random, RandomUse::Stain, 1, static_cast<double>(x) / patch, static_cast<double>(y) / patch));
        if (o.lamella > 0 && toMiddle.node[i] >= 0)
        {
          const double d = std::sqrt(static_cast<double>(toMiddle.squared[i])) / lamellaHalf;
          depth += o.lamella * (d < 2 ? (1 - d * d / 4) * (1 - d * d / 4) : 0.0);
        }
        edge = std::sqrt(static_cast<double>(toLumen.squared[i])) - 0.5;
      }
      else if (o.rim > 0)
      {
        edge = std::sqrt(static_cast<double>(toWall.squared[i])) - 0.5;
      }
      if (o.rim > 0 && edge < rim)
      {
        const double d = edge / rim;
        depth += o.rim * (1 - d * d) * (1 - d * d) * (open[i] == 0 ? 1.0 : 0.5);
      }
      stain[i] = static_cast<float>(depth * (open[i] == 0 ? o.strength : 1.0));
    }
  }
  return stain;
}

/// Light of every pixel in three channels (one where grey), 0 … 1: means over the n × n nodes of each.
std::vector<float> lightOf(
  const std::vector<float>& stain, std::int64_t nx, std::int64_t ny, int n, int channels, Stain kind)
{
  // Absorption of red, green and blue a unit of stain; a wall of 1 passes 0.82, 0.23 and 0.61 of the light when
  // magenta.
  constexpr std::array<std::array<double, 3>, 2> absorption{ { { 0.2, 1.45, 0.5 }, { 1.35, 0.75, 0.28 } } };
  const std::int64_t width = nx / n;
  const std::int64_t height = ny / n;
  std::vector<float> light(static_cast<std::size_t>(width * height * channels));
  for (std::int64_t row = 0; row < height; ++row)
  {
    for (std::int64_t column = 0; column < width; ++column)
    {
      std::array<double, 3> sum{};
      for (int j = 0; j < n; ++j)
      {
        for (int i = 0; i < n; ++i)
        {
          const double s = stain[static_cast<std::size_t>(column * n + i + nx * (row * n + j))];
          for (int c = 0; c < channels; ++c)
          {
            sum[static_cast<std::size_t>(c)] += kind == Stain::Grey
              ? 0.06 + 0.94 * (1 - decay(0.9 * s))
              : 0.96 * decay(absorption[static_cast<std::size_t>(kind)][static_cast<std::size_t>(c)] * s);
          }
        }
      }
      for (int c = 0; c < channels; ++c)
      {
        light[static_cast<std::size_t>((column + width * row) * channels + c)] =
          static_cast<float>(sum[static_cast<std::size_t>(c)] / (n * n));
      }
    }
  }
  return light;
}

} // namespace

micrograph::Picture makeLook(const PhaseImage& truth, int n, const LookOptions& options)
{
  check(truth, n, options);
  const auto [nx, ny, nz] = truth.lattice.size;
  std::vector<std::uint8_t> isOpen(truth.phases.size(), 0);
  for (std::size_t id = 0; id < isOpen.size(); ++id)
  {
    const std::string& name = truth.phases.names()[id];
    isOpen[id] = isVoidName(name);
  }
  std::vector<std::uint8_t> open(truth.phase.size());
  std::transform(truth.phase.begin(), truth.phase.end(), open.begin(), [&](std::uint8_t id) { return isOpen[id]; });

  LookCanvas canvas;
  canvas.width = nx / n;
  canvas.height = ny / n;
  canvas.channels = options.stain == Stain::Grey ? 1 : 3;
  canvas.pixel = truth.lattice.spacing * n;
  {
    std::vector<float> stain = stainOf(truth, options, open);
    tear(stain, nx, ny, truth.lattice.spacing, options);
    canvas.light = lightOf(stain, nx, ny, n, canvas.channels, options.stain);
  }
  addDirt(canvas, options);
  blur(canvas, options.blur / canvas.pixel);
  addUnevenLight(canvas, options);
  addNoise(canvas, options);

  micrograph::Picture picture;
  picture.lattice = makeLattice(canvas.width, canvas.height, 1, 2, canvas.pixel);
  picture.fileSize = picture.lattice.size;
  picture.format = "generated";
  picture.pixelSizeSource = "option";
  const auto byte = [](double value) { return static_cast<std::uint16_t>(std::clamp(value * 255, 0.0, 255.0) + 0.5); };
  std::vector<std::uint16_t> values(canvas.light.size());
  std::transform(canvas.light.begin(), canvas.light.end(), values.begin(), byte);
  drawScaleBar(values, canvas, options);
  if (canvas.channels == 1)
  {
    picture.grey = std::move(values);
    return picture;
  }
  picture.grey.resize(values.size() / 3);
  for (std::size_t i = 0; i < picture.grey.size(); ++i)
  {
    picture.grey[i] = static_cast<std::uint16_t>(
      (299 * values[3 * i] + 587 * values[3 * i + 1] + 114 * values[3 * i + 2] + 500) / 1000);
  }
  picture.colour = std::move(values);
  return picture;
}

} // namespace lamella::generators
