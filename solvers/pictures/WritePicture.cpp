#include "pictures/WritePicture.h"

#include "pictures/PngFile.h"
#include "pictures/TiffFile.h"

#include "core/Error.h"
#include "core/Lower.h"
#include "core/WholeFile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>

namespace lamella::micrograph
{
namespace
{

namespace fs = std::filesystem;

/// Greys of a slice with rows from the top, as files have them.
Pixels rowsFromTop(const PhaseImage& image, std::span<const std::uint8_t> grey, std::int64_t z)
{
  const auto [nx, ny, nz] = image.lattice.size;
  Pixels pixels{ nx, ny };
  pixels.values.resize(static_cast<std::size_t>(nx * ny));
  for (std::int64_t row = 0; row < ny; ++row)
  {
    const std::int64_t y = image.lattice.dimension == 2 ? ny - 1 - row : row;
    for (std::int64_t x = 0; x < nx; ++x)
    {
      pixels.values[static_cast<std::size_t>(x + nx * row)] =
        grey[image.phase[static_cast<std::size_t>(image.lattice.index(x, y, z))]];
    }
  }
  return pixels;
}

void writePng(const fs::path& path, const Pixels& pixels, const Lattice& lattice, bool hasPixelSize,
  std::string_view description, int effort)
{
  const double perMetre = hasPixelSize ? std::round(1 / lattice.spacing) : 0;
  const std::vector<std::uint8_t> bytes = encodePng(pixels, perMetre, description, effort);
  writeWhole(path, std::as_bytes(std::span(bytes)));
}

void writeTiff(const fs::path& path, const PhaseImage& image, std::span<const std::uint8_t> grey,
  std::string_view description, bool hasPixelSize)
{
  const auto [nx, ny, nz] = image.lattice.size;
  TiffForm form{ nx, ny, nz };
  if (hasPixelSize)
    form.pixelSize = { image.lattice.spacing, image.lattice.spacing };
  writeWhole(path,
    [&](const PartFile& part)
    {
      errno = 0;
      TiffWriter tiff(part.path(), form);
      for (std::int64_t z = 0; z < nz && tiff.good(); ++z)
        tiff.add(rowsFromTop(image, grey, z).values.data(), z == 0 ? std::string(description) : "");
      return tiff.finish() ? 0 : errno != 0 ? errno : EIO;
    });
}

/// Rows from the top.
template <typename Value>
std::vector<std::uint8_t> rowsOf(const Picture& picture, const std::vector<std::uint16_t>& values, std::size_t channels)
{
  const auto row = static_cast<std::size_t>(picture.lattice.size[0]) * channels;
  const auto height = static_cast<std::size_t>(picture.lattice.size[1]);
  std::vector<std::uint8_t> bytes(row * height * sizeof(Value));
  auto* to = reinterpret_cast<Value*>(bytes.data());
  for (std::size_t y = 0; y < height; ++y)
  {
    const std::uint16_t* const from = values.data() + row * (height - 1 - y);
    to = std::transform(from, from + row, to, [](std::uint16_t value) { return static_cast<Value>(value); });
  }
  return bytes;
}

} // namespace

void writeLabels(const PhaseImage& image, const fs::path& path, std::span<const std::uint8_t> grey,
  std::string_view description, bool hasPixelSize)
{
  std::vector<std::uint8_t> greys(grey.begin(), grey.end());
  const std::size_t phases = image.phases.size();
  for (std::size_t id = 0; grey.empty() && id < phases; ++id)
    greys.push_back(static_cast<std::uint8_t>(phases > 1 ? id * 255 / (phases - 1) : 0));
  std::vector<std::uint8_t> sorted = greys;
  std::sort(sorted.begin(), sorted.end());
  if (greys.size() != phases || std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end())
  {
    throw ParameterError(
      fmt::format("{} greys for {} phases, or two alike", greys.size(), phases), "give every phase a grey of its own");
  }
  const std::string ending = endingOf(path);
  const bool flat = image.lattice.dimension == 2;
  if (ending == ".png" && flat)
  {
    writePng(path, rowsFromTop(image, greys, 0), image.lattice, hasPixelSize, description, 9);
  }
  else if (ending == ".tif" || ending == ".tiff")
  {
    writeTiff(path, image, greys, description, hasPixelSize);
  }
  else
  {
    throw ParameterError(fmt::format("labels cannot be written as '{}'", path.filename().string()),
      flat ? "let its name end in .png or .tif" : "let its name end in .tif: a volume becomes one page a slice");
  }
}

void writePicture(const Picture& picture, const fs::path& path, std::string_view description, int effort)
{
  if (endingOf(path) != ".png" || picture.lattice.dimension != 2)
  {
    throw ParameterError(
      fmt::format("a {}D picture cannot be written as '{}'", picture.lattice.dimension, path.filename().string()),
      "a picture can be written as .png");
  }
  const bool colour = !picture.colour.empty();
  const std::vector<std::uint16_t>& values = colour ? picture.colour : picture.grey;
  Pixels pixels{ picture.lattice.size[0], picture.lattice.size[1], colour ? 3 : 1, picture.bits == 16 ? 16 : 8 };
  const auto channels = static_cast<std::size_t>(pixels.channels);
  pixels.values = pixels.bits == 16 ? rowsOf<std::uint16_t>(picture, values, channels)
                                    : rowsOf<std::uint8_t>(picture, values, channels);
  writePng(path, pixels, picture.lattice, picture.pixelSizeSource != "none", description, effort);
}

} // namespace lamella::micrograph
