#include "MicrographGrey.h"

#include "GridFile.h"
#include "Text.h"

#include "lattice/Error.h"
#include "micrograph/ShareLevel.h"
#include "vtkLatticeConversion.h"

#include <vtkImageData.h>

#include <fmt/format.h>

namespace lamella::cli
{

namespace
{

/// A picture of greys, smooth ones or shares, as outlines take it.
ContourField greyField(const MicrographOptions& options, const micrograph::Picture& picture, bool below)
{
  ContourField field;
  const double full = picture.bits > 8 ? 65535 : 255;
  const double level = greyLevel(options);
  field.level.reserve(picture.grey.size());
  for (const std::uint16_t grey : picture.grey)
  {
    const double share = below ? 1 - grey / full : grey / full;
    field.level.push_back(static_cast<float>(options.shares ? share : share - (below ? 1 - level : level)));
  }
  if (options.shares)
  {
    field.level = micrograph::levelOfShares(picture.lattice, field.level);
  }
  field.image = { picture.lattice, {}, PhaseTable({ "lumen", "wall" }) };
  for (const float value : field.level)
  {
    field.image.phase.push_back(value > 0 ? 0 : 1);
  }
  return field;
}

/// The part of a field that a window shows.
void crop(ContourField& field, const Window& window)
{
  const auto first = firstNode(field.image.lattice, window);
  PhaseImage part = lamella::crop(field.image, window);
  std::vector<float> level;
  for (std::int64_t y = 0; y < part.lattice.size[1]; ++y)
  {
    const auto row = field.level.begin() + field.image.lattice.index(first[0], first[1] + y);
    level.insert(level.end(), row, row + part.lattice.size[0]);
  }
  field.image = std::move(part);
  field.level = std::move(level);
}

} // namespace

void refuseVolume(const Lattice& whole)
{
  if (whole.dimension == 3)
  {
    throw InputError(
      fmt::format("this is a volume of {} voxels, and a micrograph is a picture", sizeText(whole.size, 3)),
      "give one slice of it");
  }
}

GreyPicture readGreyPicture(const MicrographOptions& options)
{
  const PictureOptions& picture = options.picture;
  if (options.shares && !options.level.empty())
  {
    throw ParameterError("--level and --shares contradict each other", "of shares the level is one half: leave it out");
  }
  if (picture.segment)
  {
    throw ParameterError("--segment and --level or --shares contradict each other", "leave one of them out");
  }
  (void)greyLevel(options);
  const auto window = parseWindow(picture.window);
  const bool below = oneOf("--lumen", picture.lumen, std::vector<std::string>{ "auto", "bright", "dark" }) == 2;
  GreyPicture found;
  ContourField& field = found.field;
  if (isVtkImage(picture.file))
  {
    const auto data = readGrid(picture.file, refuseVolume);
    auto* const image = vtkImageData::SafeDownCast(data);
    field = contourField(image, picture.array, options.shares, greyLevel(options), below);
    if (!picture.pixelSize.empty())
    {
      field.image.lattice.spacing = lengthInMetres("--pixel-size", picture.pixelSize);
    }
    found.pixelSizeSource =
      picture.pixelSize.empty() ? fieldText(image, "pixel_size_source").value_or("file") : "option";
    found.provenance = provenance(image);
    requireWindowFits(field.image.lattice, window);
    if (window)
    {
      crop(field, *window);
    }
  }
  else
  {
    micrograph::ReadOptions read = readOptions(picture);
    read.window = window;
    read.sizeKnown = refuseVolume;
    PictureFile file = readPictureFile(picture, read);
    refuseVolume(file.picture.lattice);
    field = greyField(options, file.picture, below);
    found.pixelSizeSource = file.picture.pixelSizeSource;
    found.provenance = file.record ? file.record->provenance : "";
    found.warnings = file.picture.warnings;
    found.picture = std::move(file.picture);
  }
  return found;
}

} // namespace lamella::cli
