#include "files/Input.h"

#include "core/Error.h"
#include "core/Lower.h"
#include "core/Memory.h"
#include "files/GridFile.h"
#include "pictures/RawVolume.h"
#include "program/Commands.h"
#include "session/Text.h"
#include "session/Workspace.h"

#include <fmt/format.h>
#include <vtkImageData.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace lamella::cli
{

void addFileOption(CLI::App& command, PictureOptions& options)
{
  command
    .add_option("FILE", options.file,
      "PNG, JPEG, TIFF or TIFF stack, PGM, PPM, BMP, a folder of numbered pictures, .raw, .mhd, .nrrd, .npy, .nii, "
      ".vtk, or .vti; - for standard input")
    ->required();
}

void addRawOptions(CLI::App& command, PictureOptions& options)
{
  addOption(command, "Sample", "--pixel-size", options.pixelSize,
    "Edge of a pixel, as 0.5e-6 or 0.5um; wins over what the file says", "METRES");
  addOption(
    command, "Sample", "--raw-size", options.rawSize, "Size of a raw volume whose name does not tell it", "NX,NY,NZ");
  addOption(
    command, "Sample", "--raw-bits", options.rawBits, "Bits a voxel in a raw volume: 8 (the default) or 16", "8|16");
  addOption(
    command, "Sample", "--raw-header", options.rawHeader, "Bytes before the first voxel in a raw volume", "BYTES");
}

void addPictureOptions(CLI::App& command, PictureOptions& options)
{
  addFileOption(command, options);
  addPhaseOptions(command, options);
  addRawOptions(command, options);
  addOption(command, "Sample", "--array", options.array,
    "In a .vti: the array of whole numbers, at points or in cells, to take for grey values [phase]", "NAME");
}

void addPhaseOptions(CLI::App& command, PictureOptions& options)
{
  addOption(command, "Sample", "--phase", options.phase,
    "These grey values are this phase: one, as 255, or a range with both ends in it, as 90..255, 90.. or "
    "..89; ..otsu "
    "and otsu.. part the greys where the picture says (otsu1, otsu2: three classes)",
    "GREY=NAME")
    ->allow_extra_args(false);
  addOption(command, "Sample", "--other", options.other, "All grey values that are not listed are this phase", "NAME");
  command
    .add_flag("--segment", options.segment,
      "A raw scan, not labels: find 'lumen' and 'wall' in a picture, 'void' and 'solid' (or what --phase names) in a "
      "volume")
    ->group("Sample");
  addOption(command, "Sample", "--lumen", options.lumen,
    "With --segment: lumens are brighter or darker than walls, void than solid; in volumes auto is dark",
    "auto|bright|dark")
    ->capture_default_str();
  addOption(command, "Sample", "--threshold", options.threshold,
    "With --segment: grey value between the two once the light is even, in pictures 0 to 255; found when not given",
    "GREY");
  addOption(command, "Sample", "--window", options.window,
    "Use this part only: pixels from the top left; for volumes X,Y,Z,WIDTH,HEIGHT,DEPTH from the first voxel",
    "X,Y,WIDTH,HEIGHT");
}

std::optional<Window> parseWindow(const std::string& text)
{
  if (text.empty())
    return std::nullopt;
  const std::size_t counts[] = { 4, 6 };
  const auto v = integerList("--window", text, counts, "X,Y,WIDTH,HEIGHT (volumes: X,Y,Z,WIDTH,HEIGHT,DEPTH)");
  if (v.size() == 6 && v[5] < 1)
    throw ParameterError("--window '" + text + "' is empty along z", "give a DEPTH of at least 1");
  return v.size() == 4 ? Window{ { v[0], v[1], 0 }, { v[2], v[3], 0 } }
                       : Window{ { v[0], v[1], v[2] }, { v[3], v[4], v[5] } };
}

void requireWindowFits(const Lattice& lattice, const std::optional<Window>& window)
{
  if (window && (window->size[2] != 0) != (lattice.dimension == 3))
  {
    throw ParameterError(
      fmt::format("--window has {} numbers, and the file holds a {} of {}", window->size[2] != 0 ? 6 : 4,
        lattice.dimension == 3 ? "volume" : "picture", sizeText(lattice.size, lattice.dimension)),
      lattice.dimension == 3 ? "write it as --window X,Y,Z,WIDTH,HEIGHT,DEPTH"
                             : "write it as --window X,Y,WIDTH,HEIGHT");
  }
}

micrograph::ReadOptions readOptions(const PictureOptions& options)
{
  micrograph::ReadOptions read;
  if (!options.pixelSize.empty())
    read.pixelSize = lengthInMetres("--pixel-size", options.pixelSize);
  if (!options.rawSize.empty())
  {
    const std::size_t counts[] = { 3 };
    const auto v = integerList("--raw-size", options.rawSize, counts, "NX,NY,NZ");
    if (*std::min_element(v.begin(), v.end()) < 1)
    {
      throw ParameterError(
        "--raw-size '" + options.rawSize + "' has a size below 1", "give the numbers of voxels along x, y and z");
    }
    read.rawSize = { v[0], v[1], v[2] };
  }
  if (options.rawBits != 0 && options.rawBits != 8 && options.rawBits != 16)
  {
    throw ParameterError(
      "--raw-bits " + std::to_string(options.rawBits) + " is neither 8 nor 16", "leave it out when the name tells it");
  }
  if (options.rawBits != 0)
    read.rawBits = options.rawBits;
  read.rawHeader = options.rawHeader;
  return read;
}

std::optional<GreyRanges> greyRanges(const PictureOptions& options)
{
  if (options.phase.empty() && options.other.empty())
    return std::nullopt;
  GreyRanges ranges;
  for (const std::string& text : listItems(options.phase))
  {
    const auto [range, name] = keyValue("--phase", text, "GREY=NAME");
    ranges.add(range, name);
  }
  if (!options.other.empty())
    ranges.other = options.other;
  return ranges;
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

micrograph::LumenSide segmentSide(const PictureOptions& options)
{
  const std::vector<std::string> sides{ "auto", "bright", "dark" };
  return static_cast<micrograph::LumenSide>(oneOf("--lumen", options.lumen, sides));
}

double thresholdOf(const std::string& text, int top)
{
  const std::optional<double> threshold = toNumber(text);
  if (!threshold || !(*threshold > 0 && *threshold < top))
  {
    throw ParameterError(
      fmt::format("--threshold '{}' is not a grey value between 0 and {}", text, top), "leave it out to have it found");
  }
  return *threshold;
}

/// Of a volume, where ranges say both.
void requireOneWord(const PictureOptions& options, const Lattice& whole)
{
  if (options.segment && whole.dimension == 3 && !options.phase.empty() &&
    (!options.threshold.empty() || options.lumen != "auto"))
  {
    throw ParameterError(
      std::string(!options.threshold.empty() ? "--threshold" : "--lumen") + " and --phase contradict each other",
      "in a volume the ranges say both: --phase ..89=void --phase 90..=fibre, or ..otsu and otsu..");
  }
  if (options.segment && whole.dimension == 2 && !(options.phase.empty() && options.other.empty()))
  {
    throw ParameterError("--segment and --phase contradict each other",
      "leave --phase and --other out: the phases of a segmented scan are 'lumen' and 'wall'");
  }
  if (options.segment && whole.dimension == 2 && !options.threshold.empty())
    (void)thresholdOf(options.threshold, 255);
}

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
  requireOneWord(options, whole);
  Lattice kept = whole;
  if (window)
  {
    (void)firstNode(whole, *window);
    kept = makeLattice(
      window->size[0], window->size[1], whole.dimension == 2 ? 1 : window->size[2], whole.dimension, whole.spacing);
  }
  if (check)
    check(kept);
  // Greys of 16 bits, and the phases that are made of them; runs of one phase where a volume is cleaned.
  const bool volume = whole.dimension == 3;
  const double each = options.segment && volume ? 5 : 3;
  const double bytes = each * static_cast<double>((options.segment && !volume ? whole : kept).count());
  if (const auto available = static_cast<double>(availableMemory()); bytes > available)
  {
    throw MemoryError(
      fmt::format("reading '{}' takes {}, and {} are free", options.file, bytesText(bytes), bytesText(available)),
      "take a part of it with --window");
  }
}

} // namespace

Sample loadSample(const PictureOptions& options, const SampleCheck& check)
{
  lamella::PictureOptions how;
  how.window = parseWindow(options.window);
  how.greys = greyRanges(options).value_or(GreyRanges());
  how.read = readOptions(options);
  how.read.sizeKnown = [&](const Lattice& whole) { checkSize(options, whole, how.window, check); };
  how.array = options.array;
  how.unnamed = [&](const micrograph::Picture& picture) { refuseUnnamed(options, picture); };
  if (options.segment)
  {
    how.segment.emplace();
    how.segment->lumen = segmentSide(options);
    if (!options.threshold.empty())
      how.segment->threshold = thresholdOf(options.threshold, 65535);
  }
  else if (options.lumen != "auto" || !options.threshold.empty())
  {
    throw ParameterError("--lumen and --threshold are for --segment",
      "add --segment, or leave them out; greys are parted without it by ranges: --phase ..89=void --phase 90..=solid");
  }
  requirePicture(options.file);
  const vtkSmartPointer<vtkDataObject> held = inMemory(options.file);
  how.data = vtkImageData::SafeDownCast(held);
  (void)VtkMessages::takeErrors();
  Sample sample = readPhases(options.file, how);
  if (std::string doubt = pixelSizeDoubt(options.pixelSize); !doubt.empty())
    sample.warnings.insert(sample.warnings.begin(), std::move(doubt));
  return sample;
}

PictureFile readPictureFile(const PictureOptions& options, micrograph::ReadOptions read)
{
  requirePicture(options.file);
  const vtkSmartPointer<vtkDataObject> held = inMemory(options.file);
  return lamella::readPictureFile(options.file, std::move(read), options.array, vtkImageData::SafeDownCast(held));
}

} // namespace lamella::cli
