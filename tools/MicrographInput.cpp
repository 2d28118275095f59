#include "MicrographInput.h"

#include "GridFile.h"
#include "PackingInput.h"
#include "Session.h"
#include "Text.h"

#include "ContourData.h"
#include "lattice/Error.h"
#include "lattice/Memory.h"
#include "micrograph/ContourEdit.h"
#include "micrograph/PolygonFile.h"
#include "vtkLatticeConversion.h"

#include <vtkPolyData.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

namespace lamella::cli
{

namespace
{

const std::vector<std::string> channels{ "auto", "grey", "red", "green", "blue", "stain" };
const std::vector<std::string> sides{ "auto", "bright", "dark" };

bool endsWith(std::string text, const std::string& end)
{
  std::transform(
    text.begin(), text.end(), text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text.ends_with(end);
}

/// A number of at least 0, or nothing where the option was not given. @throws ParameterError
std::optional<double> pixels(const std::string& option, const std::string& text)
{
  if (text.empty())
  {
    return std::nullopt;
  }
  const auto value = toNumber(text);
  if (!value || !std::isfinite(*value) || *value < 0)
  {
    throw ParameterError(
      option + " '" + text + "' is not a number of pixels", "give one of at least 0, or leave it out to have it found");
  }
  return value;
}

std::optional<std::int64_t> wholePixels(const std::string& option, const std::string& text)
{
  const auto value = pixels(option, text);
  return value ? std::optional(std::llround(*value)) : std::nullopt;
}

micrograph::SegmentOptions segmentOptions(const MicrographOptions& options)
{
  micrograph::SegmentOptions segment;
  segment.lumen = static_cast<micrograph::LumenSide>(oneOf("--lumen", options.picture.lumen, sides));
  segment.channel = static_cast<micrograph::Channel>(oneOf("--channel", options.channel, channels));
  segment.graphics = !options.keepGraphics;
  segment.background = pixels("--background", options.background);
  segment.smoothing = pixels("--smoothing", options.smoothing);
  segment.opening = pixels("--opening", options.opening);
  segment.rim = pixels("--rim", options.rim);
  segment.smallestLumen = wholePixels("--smallest-lumen", options.smallestLumen);
  segment.smallestWall = wholePixels("--smallest-wall", options.smallestWall);
  segment.raySlenderness = options.raySlenderness;
  segment.grow = options.grow;
  if (!options.picture.threshold.empty())
  {
    segment.threshold = toNumber(options.picture.threshold);
    if (!segment.threshold || !(*segment.threshold > 0 && *segment.threshold < 255))
    {
      throw ParameterError("--threshold '" + options.picture.threshold + "' is not a grey value between 0 and 255",
        "leave it out to have it found");
    }
  }
  return segment;
}

micrograph::LumenFilter lumenFilter(const MicrographOptions& options)
{
  micrograph::LumenFilter filter;
  if (!options.leastDiameter.empty())
  {
    const double d = lengthInMetres("--least-diameter", options.leastDiameter);
    filter.smallestArea = std::numbers::pi / 4 * d * d;
  }
  if (!options.leastSolidity.empty())
  {
    filter.leastSolidity = share("--least-solidity", options.leastSolidity);
    if (!(filter.leastSolidity >= 0 && filter.leastSolidity <= 1))
    {
      throw ParameterError("--least-solidity '" + options.leastSolidity + "' is outside 0 to 1", "write it as 0.8");
    }
  }
  return filter;
}

void refuse(const std::vector<CLI::Option*>& options, const std::string& file, const std::string& why)
{
  if (const std::string given = firstGiven(options); !given.empty())
  {
    throw ParameterError(given + " is for " + why, "leave it out: '" + file + "' is something else");
  }
}

void requirePixelSize(const std::string& source, const std::string& file)
{
  if (source == "none")
  {
    throw InputError("the pixel size of '" + file + "' is not known", "add --pixel-size, such as --pixel-size 0.5um");
  }
}

std::array<double, 4> polygonWindow(const std::string& text)
{
  std::array<double, 4> box{};
  const auto parts = split(text, ',');
  for (std::size_t i = 0; i < 4; ++i)
  {
    const auto value = parts.size() == 4 ? toNumber(parts[i]) : std::nullopt;
    if (!value || !std::isfinite(*value) || (i > 1 && *value <= 0))
    {
      throw ParameterError("--window '" + text + "' is no window of polygons",
        "write it as --window X,Y,WIDTH,HEIGHT in the file's own coordinates, from the lower left");
    }
    box[i] = *value;
  }
  return { box[0], box[1], box[0] + box[2], box[1] + box[3] };
}

Micrograph loadOutlines(const MicrographOptions& options)
{
  const std::string& file = options.picture.file;
  refuse(options.forScans, file, "scans");
  refuse(options.forLabels, file, "labels");
  refuse(options.forPictures, file, "pictures");
  requireFile(file);
  Micrograph found;
  found.kind = MicrographKind::Polygons;
  if (endsWith(file, ".vtp"))
  {
    refuse(options.forPolygons, file, "polygons in .json or .json.gz");
    if (!options.picture.window.empty())
    {
      throw ParameterError("--window of outlines in a .vtp", "cut the picture that they were made from");
    }
    const auto data = readGrid(file);
    auto* const outlines = vtkPolyData::SafeDownCast(data);
    try
    {
      found.contours = contoursFrom(outlines);
    }
    catch (const InputError& error)
    {
      throw InputError("'" + file + "': " + error.what(), error.hint());
    }
    found.provenance = provenance(outlines);
    found.unit = 1;
  }
  else
  {
    micrograph::PolygonReadOptions read;
    read.yDown = options.yDown;
    if (!options.unit.empty())
    {
      read.unit = lengthInMetres("--unit", options.unit);
    }
    if (!options.picture.window.empty())
    {
      read.window = polygonWindow(options.picture.window);
    }
    micrograph::PolygonFile polygons = micrograph::readPolygons(file, read);
    found.contours = std::move(polygons.lumens);
    found.unit = polygons.unit;
    found.warnings = std::move(polygons.warnings);
  }
  const micrograph::LumenFilter filter = lumenFilter(options);
  if (filter.smallestArea > 0 || filter.leastSolidity > 0)
  {
    found.contours = micrograph::filterLumens(found.contours, filter);
    if (found.contours.contours.empty())
    {
      throw InputError("no lumen of '" + file + "' is left", "lower --least-diameter or --least-solidity");
    }
  }
  return found;
}

/// Which phase the lumens are. @throws ParameterError, InputError
std::uint8_t lumenOf(const MicrographOptions& options, const PhaseTable& phases)
{
  if (!options.lumenPhase.empty())
  {
    if (const auto id = phases.find(options.lumenPhase))
    {
      return *id;
    }
    throw ParameterError("--lumen-phase '" + options.lumenPhase + "' is no phase of this picture",
      suggestion(options.lumenPhase, phases.names(), "its phases are " + quotedList(phases.names(), "and")));
  }
  for (const char* const name : { "lumen", "void", "pore" })
  {
    if (const auto id = phases.find(name))
    {
      return *id;
    }
  }
  throw InputError("which phase is the lumens? '" + options.picture.file + "' has " + quotedList(phases.names(), "and"),
    "add --lumen-phase NAME");
}

void refuseVolume(const Lattice& whole)
{
  if (whole.dimension == 3)
  {
    throw InputError(
      fmt::format("this is a volume of {} voxels, and a micrograph is a picture", sizeText(whole.size, 3)),
      "give one slice of it");
  }
}

void extract(Micrograph& found, const PhaseImage& image, std::uint8_t lumen, const MicrographOptions& options)
{
  micrograph::ExtractOptions how;
  how.smooth = !options.noSmooth;
  how.wavelength = options.wavelength;
  how.tolerance = options.tolerance;
  const micrograph::LumenFilter filter = lumenFilter(options);
  how.smallestArea = filter.smallestArea;
  how.leastSolidity = filter.leastSolidity;
  micrograph::Extraction result = micrograph::extractContours(image, lumen, {}, how);
  found.contours = std::move(result.contours);
  found.extraction = result.report;
  found.warnings.insert(found.warnings.end(), result.warnings.begin(), result.warnings.end());
  found.pixel = image.lattice.spacing;
  found.size = image.lattice.size;
}

Micrograph loadLabels(const MicrographOptions& options)
{
  refuse(options.forScans, options.picture.file, "scans");
  Sample sample = loadSample(options.picture, refuseVolume);
  refuseVolume(sample.image.lattice);
  requirePixelSize(sample.pixelSizeSource, options.picture.file);
  Micrograph found;
  found.kind = MicrographKind::Labels;
  found.pixelSizeSource = sample.pixelSizeSource;
  found.provenance = sample.provenance;
  found.warnings = sample.warnings;
  extract(found, sample.image, lumenOf(options, sample.image.phases), options);
  found.labels = std::move(sample.image);
  return found;
}

/// Marks as seen from a window of the picture; those outside it go.
std::vector<micrograph::Mark> marksIn(
  std::vector<micrograph::Mark> marks, const std::array<std::int64_t, 3>& first, const Lattice& lattice)
{
  const auto width = static_cast<int>(lattice.size[0]);
  const auto height = static_cast<int>(lattice.size[1]);
  for (micrograph::Mark& m : marks)
  {
    m.x0 = std::clamp(m.x0 - static_cast<int>(first[0]), 0, width);
    m.x1 = std::clamp(m.x1 - static_cast<int>(first[0]), 0, width);
    m.y0 = std::clamp(m.y0 - static_cast<int>(first[1]), 0, height);
    m.y1 = std::clamp(m.y1 - static_cast<int>(first[1]), 0, height);
  }
  std::erase_if(marks, [](const micrograph::Mark& m) { return m.x1 <= m.x0 || m.y1 <= m.y0; });
  return marks;
}

Micrograph segmentScan(const MicrographOptions& options, PictureFile file)
{
  refuse(options.forLabels, options.picture.file, "labels");
  micrograph::Picture& picture = file.picture;
  refuseVolume(picture.lattice);
  const auto window = parseWindow(options.picture.window);
  requireWindowFits(picture.lattice, window);
  const auto first = window ? firstNode(picture.lattice, *window) : std::array<std::int64_t, 3>{ 0, 0, 0 };
  const micrograph::SegmentOptions how = segmentOptions(options);
  // The whole scan, for the light and the threshold; the window is cut afterwards.
  micrograph::Segmentation parts = micrograph::segment(picture, how);
  Session::checkInterrupt();
  Micrograph found;
  found.pixelSizeSource = picture.pixelSizeSource;
  found.provenance = file.record ? file.record->provenance : "";
  found.warnings = picture.warnings;
  found.warnings.insert(found.warnings.end(), parts.warnings.begin(), parts.warnings.end());
  found.segmentation = parts.report;
  if (window)
  {
    parts.image = crop(parts.image, *window);
    micrograph::crop(picture, *window);
  }
  found.marks = marksIn(std::move(parts.marks), first, picture.lattice);
  extract(found, parts.image, 0, options);
  found.scan = std::move(picture);
  return found;
}

/// Few greys: labels whose names are not known, rather than a scan.
bool looksLikeLabels(const micrograph::Picture& picture)
{
  if (!picture.colour.empty())
  {
    return false;
  }
  std::set<std::uint16_t> greys;
  for (const std::uint16_t grey : picture.grey)
  {
    greys.insert(grey);
    if (greys.size() > 8)
    {
      return false;
    }
  }
  return greys.size() > 1; // one grey: segment() says it best
}

} // namespace

bool isOutlineFile(const std::string& path)
{
  return endsWith(path, ".json") || endsWith(path, ".json.gz") || endsWith(path, ".vtp");
}

Micrograph loadMicrograph(const MicrographOptions& options)
{
  const PictureOptions& picture = options.picture;
  if (isOutlineFile(picture.file))
  {
    if (picture.segment)
    {
      throw ParameterError("--segment is for scans, and '" + picture.file + "' holds outlines", "leave --segment out");
    }
    return loadOutlines(options);
  }
  refuse(options.forPolygons, picture.file, "polygons");
  if (picture.segment && greyMap(picture))
  {
    throw ParameterError("--segment and --phase contradict each other",
      "leave --phase and --other out: the phases of a segmented scan are 'lumen' and 'wall'");
  }
  if (!picture.segment && (isVtkImage(picture.file) || greyMap(picture)))
  {
    return loadLabels(options);
  }
  (void)parseWindow(picture.window);
  (void)segmentOptions(options); // mistakes in them are told before the picture is read
  micrograph::ReadOptions read = readOptions(picture);
  read.keepColour = true;
  read.sizeKnown = [&](const Lattice& whole)
  {
    refuseVolume(whole);
    // Greys and colours of 16 bits and what segmenting holds beside them.
    const double bytes = 40 * static_cast<double>(whole.count());
    if (const auto available = static_cast<double>(availableMemory()); bytes > available)
    {
      throw MemoryError(fmt::format("segmenting {} pixels takes about {}, and {} are free", sizeText(whole.size, 2),
                          bytesText(bytes), bytesText(available)),
        "cut the scan into parts");
    }
  };
  PictureFile file = readPictureFile(picture, read);
  if (!picture.segment && ((file.record && !file.record->phases.empty()) || looksLikeLabels(file.picture)))
  {
    return loadLabels(options);
  }
  requirePixelSize(file.picture.pixelSizeSource, picture.file);
  return segmentScan(options, std::move(file));
}

void addMicrographInput(CLI::App& command, MicrographOptions& o)
{
  command
    .add_option("FILE", o.picture.file,
      "A scan (PNG, JPEG, TIFF), a label picture, a .vti with phases, or outlines: .json, .json.gz, .vtp")
    ->required();
  const auto in = [](const char* group, const char* type, CLI::Option* option)
  { return option->type_name(type)->group(group); };
  const auto flag = [](const char* group, CLI::Option* option) { return option->group(group); };
  CLI::Option* const pixelSize = in("Sample", "METRES",
    command.add_option(
      "--pixel-size", o.picture.pixelSize, "Edge of a pixel, as 0.5e-6 or 0.5um; wins over what the file says"));
  in("Sample", "X,Y,WIDTH,HEIGHT",
    command.add_option("--window", o.picture.window,
      "Use this part only: pixels from the top left; of polygons the file's own coordinates, from the lower left"));
  o.forLabels = { in("Labels", "GREY=NAME",
                    command.add_option("--phase", o.picture.phase, "This grey value is this phase: FILE holds labels")
                      ->allow_extra_args(false)),
    in("Labels", "NAME",
      command.add_option("--other", o.picture.other, "All grey values that are not listed are this phase")),
    in("Labels", "NAME",
      command.add_option("--array", o.picture.array, "In a .vti: the array of whole numbers to take for grey values")),
    in("Labels", "NAME",
      command.add_option("--lumen-phase", o.lumenPhase, "The phase of the lumens; else 'lumen', 'void' or 'pore'")) };
  flag("Scan", command.add_flag("--segment", o.picture.segment, "FILE is a scan, however few grey values it has"));
  o.forScans = { in("Scan", "auto|bright|dark",
                   command.add_option("--lumen", o.picture.lumen, "Lumens are brighter or darker than walls")
                     ->capture_default_str()),
    in("Scan", "auto|grey|red|green|blue|stain",
      command.add_option("--channel", o.channel, "Where to look; stain: the mixture that separates best")
        ->capture_default_str()),
    in("Scan", "GREY",
      command.add_option("--threshold", o.picture.threshold, "Grey between the two, 0 to 255, once the light is even")),
    in("Scan", "PIXELS",
      command.add_option("--background", o.background, "Scale over which the stain may vary; 0: no flattening")),
    in("Scan", "PIXELS", command.add_option("--smoothing", o.smoothing, "Gaussian before the threshold; 0: none")),
    in("Scan", "PIXELS",
      command.add_option("--smallest-lumen", o.smallestLumen, "Specks of lumen of fewer pixels become wall")),
    in("Scan", "PIXELS",
      command.add_option("--smallest-wall", o.smallestWall, "Specks of wall in lumens of fewer pixels become lumen")),
    in("Scan", "PIXELS",
      command.add_option("--opening", o.opening, "Radius of the disk that closes necks between lumens; 0: none")),
    in("Scan", "PIXELS",
      command.add_option("--rim", o.rim, "How far outlines move outwards, onto a dark rim; 0: not at all")),
    in("Scan", "RATIO",
      command
        .add_option("--ray-slenderness", o.raySlenderness, "Gaps in rays so much longer than wide become wall; 0: none")
        ->capture_default_str()),
    in("Scan", "PIXELS",
      command.add_option("--grow", o.grow, "Move outlines outwards by so much besides; inwards if negative")),
    flag(
      "Scan", command.add_flag("--keep-graphics", o.keepGraphics, "Do not paint over margins, scale bars and text")) };
  o.forPictures = { pixelSize,
    flag("Outlines", command.add_flag("--no-smooth", o.noSmooth, "Keep the steps of the pixels")),
    in("Outlines", "PIXELS",
      command.add_option("--wavelength", o.wavelength, "Waves along an outline shorter than this are damped, 4 to 200")
        ->capture_default_str()),
    in("Outlines", "PIXELS",
      command.add_option("--tolerance", o.tolerance, "Points this near to the line of their neighbours go; 0: none")
        ->capture_default_str()) };
  in("Outlines", "LENGTH",
    command.add_option("--least-diameter", o.leastDiameter, "Lumens smaller than this circle become wall, as 3um"));
  in("Outlines", "SHARE",
    command.add_option("--least-solidity", o.leastSolidity, "Lumens of a smaller share of their hull become wall"));
  o.forPolygons = { in("Polygons", "LENGTH",
                      command.add_option("--unit", o.unit, "Unit of the coordinates, as 1um; else what the file says")),
    flag("Polygons", command.add_flag("--y-down", o.yDown, "y points down, as rows of a picture do")) };
}

} // namespace lamella::cli
