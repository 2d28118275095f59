#include "files/Input.h"

#include "core/Error.h"
#include "core/Lower.h"
#include "core/Memory.h"
#include "files/GridFile.h"
#include "pictures/RawVolume.h"
#include "program/Commands.h"
#include "session/Text.h"
#include "session/Workspace.h"

#include "vtkPictureReader.h"

#include <fmt/format.h>
#include <vtkImageData.h>
#include <vtkNew.h>

#include <algorithm>
#include <filesystem>

namespace lamella::cli
{

namespace
{

const char* const reader = "vtkPictureReader";

} // namespace

void addPhaseOptions(CLI::App& command, PictureOptions& options)
{
  options.settings.declareSome(
    command, reader, { "phase", "other", "segment", "lumen", "threshold", "window" }, "Sample");
}

void addRawOptions(CLI::App& command, PictureOptions& options)
{
  options.settings.declareSome(command, reader, { "pixel-size", "raw-size", "raw-bits", "raw-header" }, "Sample");
}

void addSliceDistance(CLI::App& command, PictureOptions& options)
{
  options.settings.declareSome(command, reader, { "slice-distance" }, "Sample");
}

void addPictureOptions(CLI::App& command, PictureOptions& options)
{
  command
    .add_option("FILE", options.file,
      "PNG, JPEG, TIFF or TIFF stack, PGM, PPM, BMP, a folder of numbered pictures, .raw, .mhd, .nrrd, .npy, .nii, "
      ".vtk, or .vti; - for standard input")
    ->required();
  addPhaseOptions(command, options);
  addRawOptions(command, options);
  options.settings.declareSome(command, reader, { "array" }, "Sample");
}

const std::vector<std::string>& rawWords()
{
  static const std::vector<std::string> words{ "pixel-size", "raw-size", "raw-bits", "raw-header", "raw-type",
    "raw-order" };
  return words;
}

const std::vector<std::string>& scanWords()
{
  static const std::vector<std::string> words{ "threshold", "channel", "background", "smoothing", "smallest-lumen",
    "smallest-wall", "opening", "rim", "ray-slenderness", "grow", "keep-graphics" };
  return words;
}

lamella::PictureOptions readerOptions(const PictureOptions& options)
{
  vtkNew<vtkPictureReader> said;
  options.settings.give(said);
  lamella::PictureOptions found = said->GetOptions();
  if (options.settings.given("window") && !found.window)
    throw ParameterError("the window is empty", "give a width and a height");
  return found;
}

void requireWindowFits(const Lattice& lattice, const std::optional<Window>& window)
{
  if (window && (window->size[2] != 0) != (lattice.dimension == 3))
  {
    throw ParameterError(
      fmt::format("the window has {} depth, and the file holds a {} of {}", window->size[2] != 0 ? "a" : "no",
        lattice.dimension == 3 ? "volume" : "picture", sizeText(lattice.size, lattice.dimension)),
      lattice.dimension == 3 ? "write it as --window X,Y,Z,WIDTH,HEIGHT,DEPTH"
                             : "write it as --window X,Y,WIDTH,HEIGHT");
  }
}

namespace
{

/// What has nothing to do with the format, said before a reader says it in its own words.
void requirePicture(const std::string& path)
{
  std::error_code failed;
  if (std::filesystem::is_regular_file(path, failed))
    requireFile(path);
  if (endingOf(path).ends_with(".gz") && micrograph::rawHeader(path) == micrograph::RawHeader::None)
    throw InputError("'" + path + "' is packed", "unpack it first: gunzip --keep " + path);
}

/// "0 (63.2 %), 255 (36.8 %)", the commonest first, at most `most` of them.
std::string greyShares(const std::vector<std::pair<int, std::int64_t>>& greys, std::int64_t total, std::size_t most)
{
  std::string text;
  for (std::size_t i = 0; i < std::min(most, greys.size()); ++i)
  {
    text += fmt::format("{}{} ({:.1f} %)", i == 0 ? "" : ", ", greys[i].first,
      100.0 * static_cast<double>(greys[i].second) / static_cast<double>(total));
  }
  return greys.size() > most ? text + fmt::format(" and {} more", greys.size() - most) : text;
}

[[noreturn]] void refuseUnnamed(const PictureOptions& options, const micrograph::Picture& picture)
{
  std::vector<std::int64_t> count(65536, 0);
  for (const std::uint16_t grey : picture.grey)
    ++count[grey];
  std::vector<std::pair<int, std::int64_t>> greys;
  for (std::size_t grey = 0; grey < count.size(); ++grey)
    if (count[grey] > 0)
      greys.emplace_back(static_cast<int>(grey), count[grey]);
  std::stable_sort(greys.begin(), greys.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  const bool volume = picture.lattice.dimension == 3;
  std::string hint;
  if (greys.size() <= 8)
  {
    hint = "name each of them:";
    for (const auto& [grey, nodes] : greys)
      hint += fmt::format(" --phase {}=NAME", grey);
  }
  else
  {
    hint = volume
      ? "this looks like a grey volume: add --segment to find void and solid in it; or name ranges of its grey values, "
        "as "
        "--phase ..89=void --phase 90..=solid, or --phase ..otsu=void --phase otsu..=solid"
      : "this looks like a scan: add --segment to find lumens and walls in it; or name its grey values with "
        "--phase GREY=NAME, ranges of them with --phase 0..89=NAME, and --other NAME";
  }
  throw InputError(fmt::format("which phases are in '{}'? Its grey values are {}", options.file,
                     greyShares(greys, static_cast<std::int64_t>(picture.grey.size()), 8)),
    hint);
}

} // namespace

bool isVtkImage(const std::string& path)
{
  return endingOf(path) == ".vti";
}

std::string pixelSizeDoubt(const std::string& given)
{
  // Nobody's pixels are of a millimetre by mistake where it says mm; a bare 0.5 is surely 0.5 µm.
  const std::optional<double> metres = toNumber(given);
  return !metres || *metres < 1e-3
    ? ""
    : fmt::format("--pixel-size {0:g} is {0:g} metres; for micrometres write {0:g}um", *metres);
}

namespace
{

/// What a scene keeps under a file's name; null: it is a file.
vtkSmartPointer<vtkDataObject> inMemory(const std::string& path)
{
  return Workspace::holds(path) ? Workspace::find(path) : nullptr;
}

/// What can be said once the size of the file is known.
void checkSize(
  const PictureOptions& options, const Lattice& whole, const std::optional<Window>& window, const SampleCheck& check)
{
  requireWindowFits(whole, window);
  Lattice kept = whole;
  if (window)
  {
    (void)firstNode(whole, *window);
    kept = makeLattice(window->size[0], window->size[1], whole.dimension == 2 ? 1 : window->size[2], whole.dimension,
      whole.spacing, whole.aspect);
  }
  if (check)
    check(kept);
  // Greys of 16 bits, and the phases that are made of them; runs of one phase where a volume is cleaned.
  const bool volume = whole.dimension == 3;
  const bool segment = options.settings.given("segment");
  const double each = segment && volume ? 5 : 3;
  const double bytes = each * static_cast<double>((segment && !volume ? whole : kept).count());
  if (const auto available = static_cast<double>(availableMemory()); bytes > available)
  {
    throw MemoryError(
      fmt::format("reading '{}' takes {}, and {} are free", options.file, bytesText(bytes), bytesText(available)),
      "take a part of it with --window");
  }
}

} // namespace

Sample loadSample(const PictureOptions& options, const SampleCheck& check, const std::optional<GreyBins>& greys)
{
  lamella::PictureOptions how = readerOptions(options);
  how.read.sizeKnown = [&](const Lattice& whole) { checkSize(options, whole, how.window, check); };
  how.read.levels = greys;
  if (!greys)
    how.unnamed = [&](const micrograph::Picture& picture) { refuseUnnamed(options, picture); };
  requirePicture(options.file);
  const vtkSmartPointer<vtkDataObject> held = inMemory(options.file);
  how.data = vtkImageData::SafeDownCast(held);
  (void)VtkMessages::takeErrors();
  Sample sample = readPhases(options.file, how);
  if (std::string doubt = pixelSizeDoubt(options.settings.text("pixel-size")); !doubt.empty())
    sample.warnings.insert(sample.warnings.begin(), std::move(doubt));
  return sample;
}

PictureFile readPictureFile(const std::string& file, micrograph::ReadOptions read, const std::string& array)
{
  requirePicture(file);
  const vtkSmartPointer<vtkDataObject> held = inMemory(file);
  return lamella::readPictureFile(file, std::move(read), array, vtkImageData::SafeDownCast(held));
}

} // namespace lamella::cli
