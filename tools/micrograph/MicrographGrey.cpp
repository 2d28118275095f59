#include "micrograph/MicrographGrey.h"

#include "files/GridFile.h"
#include "session/Text.h"

#include "core/Error.h"
#include "vtkLatticeConversion.h"

#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkPointData.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnsignedShortArray.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace lamella::cli
{

namespace
{

constexpr const char* kGrey = "grey";

/// The greys of a picture as points of an image.
template <class Array, class Number>
vtkSmartPointer<vtkImageData> greyImage(const micrograph::Picture& picture)
{
  const auto image = vtkSmartPointer<vtkImageData>::New();
  setGeometry(image, picture.lattice);
  const auto greys = vtkSmartPointer<Array>::New();
  greys->SetName(kGrey);
  greys->SetNumberOfValues(static_cast<vtkIdType>(picture.grey.size()));
  std::transform(picture.grey.begin(), picture.grey.end(), greys->GetPointer(0),
    [](std::uint16_t grey) { return static_cast<Number>(grey); });
  image->GetPointData()->AddArray(greys);
  return image;
}

/// One array of an image, or the part of it that a window shows.
vtkSmartPointer<vtkImageData> part(
  vtkImageData* image, vtkDataArray* array, Lattice lattice, const std::optional<Window>& window)
{
  const Lattice whole = lattice;
  const auto first = window ? firstNode(lattice, *window) : std::array<std::int64_t, 3>{ 0, 0, 0 };
  if (window)
    std::copy_n(window->size.begin(), 2, lattice.size.begin());
  const auto shown = vtkSmartPointer<vtkImageData>::New();
  setGeometry(shown, lattice);
  const auto values = vtkSmartPointer<vtkDataArray>::Take(array->NewInstance());
  values->SetName(array->GetName());
  values->SetNumberOfComponents(array->GetNumberOfComponents());
  values->SetNumberOfTuples(static_cast<vtkIdType>(lattice.count()));
  for (std::int64_t y = 0; y < lattice.size[1]; ++y)
  {
    values->InsertTuples(
      lattice.index(0, y), lattice.size[0], static_cast<vtkIdType>(whole.index(first[0], first[1] + y)), array);
  }
  shown->GetPointData()->AddArray(values);
  shown->GetFieldData()->ShallowCopy(image->GetFieldData());
  return shown;
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
  const SettingOptions& settings = picture.settings;
  if (options.shares && settings.given("level"))
    throw ParameterError("--level and --shares contradict each other", "of shares the level is one half: leave it out");
  if (settings.given("segment"))
    throw ParameterError("--segment and --level or --shares contradict each other", "leave one of them out");
  const lamella::PictureOptions said = pictureOptions(options, true);
  const auto& window = said.window;
  GreyPicture found;
  if (isVtkImage(picture.file))
  {
    const auto data = readGrid(picture.file, refuseVolume);
    auto* const image = vtkImageData::SafeDownCast(data);
    found.array = said.array.empty() ? "lumen_share" : said.array;
    found.pixelSizeSource = said.read.pixelSize ? "option" : fieldText(image, "pixel_size_source").value_or("file");
    found.provenance = provenance(image);
    Lattice lattice = latticeOf(image);
    lattice.spacing = said.read.pixelSize.value_or(lattice.spacing);
    requireWindowFits(lattice, window);
    vtkDataArray* const array = image->GetPointData()->GetArray(found.array.c_str());
    found.image = image;
    if (array != nullptr) // else the class says what is wrong
      found.image = part(image, array, lattice, window);
    return found;
  }
  micrograph::ReadOptions read = said.read;
  read.window = window;
  read.sizeKnown = refuseVolume;
  PictureFile file = readPictureFile(picture.file, read);
  refuseVolume(file.picture.lattice);
  found.array = kGrey;
  found.image = file.picture.bits > 8 ? greyImage<vtkUnsignedShortArray, unsigned short>(file.picture)
                                      : greyImage<vtkUnsignedCharArray, unsigned char>(file.picture);
  found.pixelSizeSource = file.picture.pixelSizeSource;
  found.provenance = file.record ? file.record->provenance : "";
  found.warnings = file.picture.warnings;
  found.picture = std::move(file.picture);
  return found;
}

} // namespace lamella::cli
