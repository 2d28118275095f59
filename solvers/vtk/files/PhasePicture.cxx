#include "PhasePicture.h"

#include "GridChecks.h"
#include "GridReaders.h"
#include "vtkLatticeConversion.h"
#include "vtkProvenance.h"

#include "core/Error.h"
#include "core/Lower.h"
#include "pictures/RawVolume.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkIdList.h"
#include "vtkImageData.h"
#include "vtkPointData.h"
#include "vtkXMLImageDataReader.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <system_error>
#include <vector>

namespace lamella
{
namespace
{

namespace fs = std::filesystem;

bool isVti(const fs::path& path)
{
  return endingOf(path) == ".vti";
}

bool isRaw(const fs::path& path)
{
  return endingOf(path) == ".raw" || endingOf(path) == ".bin";
}

/// What is told of a size; without a distance of slices voxels are cubes.
void setSpacing(Lattice& lattice, double spacing, const std::optional<double>& sliceDistance)
{
  lattice = makeLattice(lattice.size[0], lattice.size[1], lattice.size[2], lattice.dimension, spacing,
    { 1, 1, lattice.dimension == 3 ? sliceDistance.value_or(spacing) / spacing : 1 });
}

vtkSmartPointer<vtkImageData> readVti(const fs::path& path, const micrograph::ReadOptions& options)
{
  std::error_code problem;
  const auto bytes = fs::file_size(path, problem);
  if (problem)
    throw InputError("cannot read " + path.string() + ": " + problem.message(), "check the file's name");
  if (bytes == 0)
    throw InputError(path.string() + " is empty", "write the file again");
  const auto reader = newImageReader();
  reader->SetFileName(path.c_str());
  if (reader->CanReadFile(path.c_str()) == 0)
  {
    throw InputError("'" + path.string() + "' is not a .vti file, or is cut short",
      "give a whole .vti file, VTK XML image data; make or copy it again");
  }
  requireReadable(reader, path.string());
  if (options.sizeKnown)
  {
    if (const auto lattice = latticeInFile(reader); lattice)
      options.sizeKnown(*lattice);
  }
  update(reader, path.string());
  return reader->GetOutput();
}

struct ImageArray
{
  vtkDataArray* array = nullptr;
  bool cells = false;
};

ImageArray chooseArray(vtkImageData* image, const std::string& wanted, const fs::path& path)
{
  const std::array<vtkDataSetAttributes*, 2> places{ image->GetPointData(), image->GetCellData() };
  const auto usable = [](vtkDataArray* array)
  {
    return array != nullptr && array->GetNumberOfComponents() == 1 &&
      (array->GetDataType() != VTK_FLOAT && array->GetDataType() != VTK_DOUBLE);
  };
  for (const std::string& name : { wanted.empty() ? std::string("phase") : wanted })
  {
    for (std::size_t place = 0; place < places.size(); ++place)
      if (vtkDataArray* const array = places[place]->GetArray(name.c_str()))
        return { array, place == 1 };
  }
  std::string there;
  for (std::size_t place = 0; place < places.size(); ++place)
  {
    for (int i = 0; i < places[place]->GetNumberOfArrays(); ++i)
    {
      vtkDataArray* const array = places[place]->GetArray(i);
      if (wanted.empty() && usable(array))
        return { array, place == 1 };
      there += (there.empty() ? "" : ", ") +
        std::string(places[place]->GetArrayName(i) != nullptr ? places[place]->GetArrayName(i) : "?");
    }
  }
  throw InputError(wanted.empty() ? path.string() + " holds no array of whole numbers"
                                  : path.string() + " holds no array '" + wanted + "'",
    there.empty() ? "write the file with an array" : "it holds: " + there);
}

/// Lattice and values of an image file; cells become nodes.
micrograph::Picture greysOf(vtkImageData* image, const ImageArray& chosen, const micrograph::ReadOptions& options)
{
  requireUpright(image);
  micrograph::Picture picture;
  std::array<int, 6> extent{};
  std::array<double, 3> origin{};
  std::copy_n(image->GetExtent(), 6, extent.begin());
  std::copy_n(image->GetOrigin(), 3, origin.begin());
  if (chosen.cells)
  {
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      if (extent[2 * axis + 1] > extent[2 * axis])
      {
        --extent[2 * axis + 1];
        origin[axis] += image->GetSpacing()[axis] / 2;
      }
    }
  }
  picture.lattice = latticeOf(extent.data(), origin.data(), image->GetSpacing(), Voxels::Any);
  picture.pixelSizeSource = fieldText(image, "pixel_size_source").value_or("VTK image spacing");
  if (options.pixelSize || options.sliceDistance)
  {
    setSpacing(picture.lattice, options.pixelSize.value_or(picture.lattice.spacing), options.sliceDistance);
    picture.pixelSizeSource = "option";
  }
  const vtkIdType count = chosen.array->GetNumberOfTuples();
  const int type = chosen.array->GetDataType();
  const bool real = options.levels && type != VTK_UNSIGNED_CHAR && type != VTK_UNSIGNED_SHORT;
  if (real)
    picture.levels = options.levels;
  picture.grey.resize(static_cast<std::size_t>(count));
  for (vtkIdType node = 0; node < count; ++node)
  {
    const double value = chosen.array->GetComponent(node, 0);
    if (options.levels && std::isnan(value))
      throw InputError("array '" + std::string(chosen.array->GetName()) + "' holds values that are no numbers",
        "give every node a grey");
    if (real)
    {
      picture.grey[static_cast<std::size_t>(node)] = options.levels->of(value);
      continue;
    }
    if (!(value >= 0 && value <= std::numeric_limits<std::uint16_t>::max()) || value != std::floor(value))
    {
      throw InputError("array '" + std::string(chosen.array->GetName()) + "' holds " + std::to_string(value) +
          "; grey values and phases are whole numbers from 0 to 65535",
        "choose another array");
    }
    picture.grey[static_cast<std::size_t>(node)] = static_cast<std::uint16_t>(value);
  }
  picture.fileSize = picture.lattice.size;
  if (options.sizeKnown) // of cells it was not, so far
    options.sizeKnown(picture.lattice);
  if (options.window)
    crop(picture, *options.window);
  picture.bits = std::ranges::all_of(picture.grey, [](std::uint16_t grey) { return grey < 256; }) ? 8 : 16;
  return picture;
}

/// Node of the file that each node of the image lies in.
vtkSmartPointer<vtkIdList> nodesOfFile(
  const Lattice& image, const Lattice& file, const std::array<std::int64_t, 3>& first, int refinement)
{
  const std::int64_t deep = image.dimension == 3 ? refinement : 1;
  const auto nodes = vtkSmartPointer<vtkIdList>::New();
  nodes->SetNumberOfIds(image.count());
  vtkIdType node = 0;
  for (std::int64_t z = 0; z < image.size[2]; ++z)
  {
    for (std::int64_t y = 0; y < image.size[1]; ++y)
      for (std::int64_t x = 0; x < image.size[0]; ++x)
        nodes->SetId(node++, file.index(first[0] + x / refinement, first[1] + y / refinement, first[2] + z / deep));
  }
  return nodes;
}

/// Every value a phase of its own.
GreyMap everyGrey(const micrograph::Picture& picture)
{
  std::vector<bool> seen(65536, false);
  for (const std::uint16_t grey : picture.grey)
    seen[grey] = true;
  const auto different = std::ranges::count(seen, true);
  if (different > 256)
  {
    throw InputError("the picture has " + std::to_string(different) + " different grey values and no phase is named",
      "name the phases, or segment the picture");
  }
  GreyMap map;
  for (int grey = 0; grey < 65536; ++grey)
    if (seen[static_cast<std::size_t>(grey)])
      map.phaseOfGrey[grey] = std::to_string(grey);
  return map;
}

/// Every grey a phase of its own, or every level where there are too many.
PhaseImage leveled(const micrograph::Picture& picture, const GreyBins& levels)
{
  std::vector<bool> seen(65536, false);
  for (const std::uint16_t grey : picture.grey)
    seen[grey] = true;
  if (!picture.levels && std::ranges::count(seen, true) <= 256)
    return everyGrey(picture).apply(picture.lattice, picture.grey);
  PhaseImage image{ picture.lattice, {}, {} };
  for (std::size_t level = 0; level < levels.count(); ++level)
    image.phases.add(levels.name(level));
  image.phase.reserve(picture.grey.size());
  for (const std::uint16_t grey : picture.grey)
    image.phase.push_back(picture.levels ? static_cast<std::uint8_t>(grey) : levels.of(grey));
  return image;
}

/// Phases that a .vti names; nothing where it does not, or where other greys are asked for.
std::optional<PhasePicture> phasesOfImage(
  vtkImageData* image, const fs::path& path, const PictureOptions& options, const micrograph::ReadOptions& read)
{
  const bool other = !options.greys.empty() || !(options.array.empty() || options.array == "phase");
  if (other || phaseNames(image).size() == 0 || !image->GetPointData()->HasArray("phase"))
    return std::nullopt;
  if (options.segment)
  {
    throw ParameterError("'" + path.string() + "' holds phases already, and segmentation is for scans",
      "leave segmentation out: the file says which phase is where");
  }
  PhasePicture found;
  try
  {
    found.image = toPhaseImage(image, "phase", Voxels::Any);
  }
  catch (const Error& error)
  {
    throw InputError("'" + path.string() + "': " + error.what(), error.hint());
  }
  found.pixelSizeSource = fieldText(image, "pixel_size_source").value_or("VTK image spacing");
  if (const std::vector<double> doubt = fieldNumbers(image, "surface_doubt"); doubt.size() == 1)
    found.surfaceDoubt = doubt.front();
  found.fileSize = found.image.lattice.size;
  found.provenance = provenance(image);
  found.file = image;
  if (read.pixelSize || read.sliceDistance)
  {
    setSpacing(found.image.lattice, read.pixelSize.value_or(found.image.lattice.spacing), read.sliceDistance);
    found.pixelSizeSource = "option";
  }
  if (options.window)
    found.image = crop(found.image, *options.window);
  return found;
}

/// What of the options contradicts each other in a picture or volume of this size.
void requireOneWord(const PictureOptions& options, const Lattice& whole)
{
  if (!options.segment)
    return;
  if (whole.dimension == 2 && !options.greys.empty())
  {
    throw ParameterError("segmentation and phases contradict each other",
      "name no phases: those of a segmented scan are 'lumen' and 'wall'");
  }
  micrograph::SegmentOptions ofPicture = *options.segment;
  ofPicture.lumen = micrograph::LumenSide::Auto;
  ofPicture.threshold.reset();
  if (whole.dimension == 3 && ofPicture != micrograph::SegmentOptions())
  {
    throw ParameterError("this is a volume, and what was said of scans is for pictures",
      "leave it out: of a volume, lumen and threshold alone count");
  }
  if (whole.dimension == 3 && !options.greys.empty() && !(*options.segment == ofPicture))
  {
    throw ParameterError(
      std::string(options.segment->threshold ? "threshold" : "lumen") + " and phases contradict each other",
      "in a volume the ranges of greys say both: ..89 is void and 90.. is fibre, or ..otsu and otsu..");
  }
}

void segmentVolume(PhasePicture& result, micrograph::Picture picture, const PictureOptions& options)
{
  micrograph::VolumeOptions how;
  how.phases = options.greys;
  how.empty = options.segment->lumen;
  how.threshold = options.segment->threshold;
  micrograph::VolumeSegmentation found = micrograph::segmentVolume(std::move(picture), how);
  result.warnings.insert(result.warnings.end(), found.warnings.begin(), found.warnings.end());
  result.notes = found.report.lines();
  result.surfaceDoubt = found.report.surfaceDoubt;
  result.volumeSegmentation = std::move(found.report);
  result.image = std::move(found.image);
}

/// The whole scan, for the light and the threshold; the window is cut afterwards.
void segmentPicture(PhasePicture& result, const micrograph::Picture& picture, const PictureOptions& options)
{
  micrograph::SegmentOptions how = *options.segment;
  how.judged = options.window;
  micrograph::Segmentation found = micrograph::segment(picture, how);
  result.warnings.insert(result.warnings.end(), found.warnings.begin(), found.warnings.end());
  result.notes = found.report.lines();
  result.surfaceDoubt = found.report.surfaceDoubt;
  result.segmentation = std::move(found.report);
  result.image = options.window ? crop(found.image, *options.window) : std::move(found.image);
}

void nameGreys(PhasePicture& result, const PictureFile& file, bool ofImage, const PictureOptions& options)
{
  const micrograph::Picture& picture = file.picture;
  if (!options.greys.empty())
  {
    GreyRanges::Applied named =
      options.greys.apply(picture.lattice, picture.grey, { ofImage ? 16 : picture.bits, 1, std::nullopt });
    result.warnings.insert(result.warnings.end(), named.warnings.begin(), named.warnings.end());
    if (named.levels)
      result.notes.push_back(named.levels->text());
    result.image = std::move(named.image);
  }
  else if (file.record && !file.record->phases.empty())
  {
    result.image = GreyMap{ file.record->phases, std::nullopt }.apply(picture.lattice, picture.grey);
  }
  else
  {
    if (options.unnamed)
      options.unnamed(picture);
    result.image = options.read.levels ? leveled(picture, *options.read.levels)
                                       : everyGrey(picture).apply(picture.lattice, picture.grey);
  }
}

PhasePicture namedPhases(const fs::path& path, const PictureOptions& options)
{
  micrograph::ReadOptions read = options.read;
  read.sizeKnown = [&options](const Lattice& whole)
  {
    requireOneWord(options, whole);
    if (options.read.sliceDistance && whole.dimension == 2)
      throw ParameterError("a distance of slices of a picture, which has one", "leave it out: it is for volumes");
    if (options.read.sizeKnown)
      options.read.sizeKnown(whole);
  };
  read.keepColour = read.keepColour || options.segment;
  // A picture is segmented whole, for its light; of a volume, whose corners may be empty, only the window is looked at.
  if (!options.segment || (options.window && options.window->size[2] != 0))
    read.window = options.window;
  vtkSmartPointer<vtkImageData> image = options.data;
  if (image != nullptr)
    read.sizeKnown(latticeOf(image, Voxels::Any));
  else if (image == nullptr && isVti(path))
    image = readVti(path, read);
  if (image != nullptr)
    if (std::optional<PhasePicture> named = phasesOfImage(image, path, options, read))
      return std::move(*named);

  PictureFile file = readPictureFile(path, read, options.array, image);
  PhasePicture result;
  result.pixelSizeSource = file.picture.pixelSizeSource;
  result.fileSize = file.picture.fileSize;
  result.warnings = file.picture.warnings;
  result.provenance = file.record ? file.record->provenance : image != nullptr ? provenance(image) : "";
  result.file = file.file;
  if (options.segment && file.picture.lattice.dimension == 3)
    segmentVolume(result, std::move(file.picture), options);
  else if (options.segment)
    segmentPicture(result, file.picture, options);
  else
    nameGreys(result, file, image != nullptr, options);
  return result;
}

} // namespace

PictureFile readPictureFile(
  const fs::path& path, micrograph::ReadOptions options, const std::string& array, vtkImageData* data)
{
  PictureFile file;
  if (data != nullptr || isVti(path))
  {
    const vtkSmartPointer<vtkImageData> image = data != nullptr ? data : readVti(path, options).GetPointer();
    const ImageArray chosen = chooseArray(image, array, path);
    file.picture = greysOf(image, chosen, options);
    if (!chosen.cells)
      file.file = image;
    return file;
  }
  const bool raw = isRaw(path);
  if (raw || micrograph::rawHeader(path) != micrograph::RawHeader::None)
  {
    file.record = micrograph::readRecordBeside(path);
    if (raw && file.record && file.record->size && !options.rawSize)
    {
      options.rawSize = file.record->size;
      options.rawBits = file.record->bits;
    }
  }
  file.picture = micrograph::readPicture(path, options);
  if (!file.record)
    file.record = micrograph::parseRecord(file.picture.description);
  if (file.record && file.record->pixelSize && !options.pixelSize)
  {
    setSpacing(file.picture.lattice, *file.record->pixelSize, options.sliceDistance);
    file.picture.pixelSizeSource = "lamella record";
    // What the reader doubts about the picture's own metadata does not matter then.
    std::erase_if(
      file.picture.warnings, [](const std::string& w) { return w.find(": left out") != std::string::npos; });
  }
  return file;
}

PhasePicture readPhases(const fs::path& path, const PictureOptions& options)
{
  PhasePicture result = namedPhases(path, options);
  result.window = options.window;
  if (options.refine != 1)
    result.image = refine(result.image, options.refine);
  if (result.surfaceDoubt)
    *result.surfaceDoubt *= options.refine;
  return result;
}

void carryAlong(vtkImageData* image, vtkImageData* file, const std::optional<Window>& window, int refine,
  const std::vector<std::string>& names)
{
  const Lattice whole = latticeOf(file, Voxels::Any);
  const bool all = !window && refine == 1;
  const auto first = window ? firstNode(whole, *window) : std::array<std::int64_t, 3>{ 0, 0, 0 };
  const auto nodes = all ? nullptr : nodesOfFile(latticeOf(image, Voxels::Any), whole, first, refine);
  vtkPointData* const held = file->GetPointData();
  for (int i = 0; i < held->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* const array = held->GetAbstractArray(i);
    const std::string name = array->GetName() != nullptr ? array->GetName() : "";
    const bool ofPixel = name == "grain" || name == "axis" || name == "tensor";
    const bool wanted = names.empty() ? refine == 1 || ofPixel : std::ranges::find(names, name) != names.end();
    if (name.empty() || !wanted || image->GetPointData()->HasArray(name.c_str()))
      continue;
    if (all)
    {
      image->GetPointData()->AddArray(array);
      continue;
    }
    const auto part = vtkSmartPointer<vtkAbstractArray>::Take(array->NewInstance());
    part->SetName(name.c_str());
    part->SetNumberOfComponents(array->GetNumberOfComponents());
    part->CopyComponentNames(array);
    part->CopyInformation(array->GetInformation());
    part->SetNumberOfTuples(nodes->GetNumberOfIds());
    array->GetTuples(nodes, part);
    image->GetPointData()->AddArray(part);
  }
}

} // namespace lamella
