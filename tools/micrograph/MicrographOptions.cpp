#include "micrograph/MicrographOptions.h"

#include "commands/PackingInput.h"
#include "program/Commands.h"
#include "session/Text.h"

#include "core/Error.h"

#include <algorithm>
#include <cmath>

namespace lamella::cli
{

namespace
{

const std::vector<std::string> channels{ "auto", "grey", "red", "green", "blue", "stain" };
const std::vector<std::string> sides{ "auto", "bright", "dark" };

/// A number of at least 0, or nothing where the option was not given. @throws ParameterError
std::optional<double> pixels(const std::string& option, const std::string& text)
{
  if (text.empty())
    return std::nullopt;
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

} // namespace

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

double greyLevel(const MicrographOptions& options)
{
  if (options.level.empty())
    return 0.5;
  const auto level = toNumber(options.level);
  if (!level || !(*level > 0 && *level < 1))
  {
    throw ParameterError(
      "--level '" + options.level + "' is not between 0 and 1", "give a part of the largest grey value: --level 0.5");
  }
  return *level;
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

void addMicrographInput(CLI::App& command, MicrographOptions& o)
{
  command
    .add_option("FILE", o.picture.file,
      "A scan (PNG, JPEG, TIFF, PGM, PPM, BMP), a label picture, a .vti with phases, or outlines: .json, .json.gz, "
      ".vtp")
    ->required();
  const auto flag = [](const char* group, CLI::Option* option) { return option->group(group); };
  CLI::Option* const pixelSize = addOption(command, "Sample", "--pixel-size", o.picture.pixelSize,
    "Edge of a pixel, as 0.5e-6 or 0.5um; wins over what the file says", "METRES");
  addOption(command, "Sample", "--window", o.picture.window,
    "Use this part only: pixels from the top left; of polygons the file's own coordinates, from the lower left",
    "X,Y,WIDTH,HEIGHT");
  o.forLabels = { addOption(command, "Labels", "--phase", o.picture.phase,
                    "These grey values, one or a range such as 90..255, are this phase: FILE holds labels",
                    "GREY=NAME"),
    addOption(
      command, "Labels", "--other", o.picture.other, "All grey values that are not listed are this phase", "NAME"),
    addOption(command, "Labels", "--lumen-phase", o.lumenPhase,
      "The phase of the lumens; else 'lumen', 'void', 'pore' or 'air'", "NAME") };
  o.arrayOption = addOption(command, "Labels", "--array", o.picture.array,
    "In a .vti: the array of whole numbers to take for grey values", "NAME");
  o.forGreys = { addOption(command, "Grey", "--level", o.level,
                   "FILE is grey and smooth: outlines where it passes this part of the largest grey, as 0.5", "SHARE"),
    flag("Grey", command.add_flag("--shares", o.shares, "FILE's greys are lumen's share of each pixel")) };
  flag("Scan", command.add_flag("--segment", o.picture.segment, "FILE is a scan, however few grey values it has"));
  o.lumenOption = addOption(
    command, "Scan", "--lumen", o.picture.lumen, "Lumens are brighter or darker than walls", "auto|bright|dark")
                    ->capture_default_str();
  o.forScans = { addOption(command, "Scan", "--channel", o.channel,
                   "Where to look; stain: the mixture that separates best", "auto|grey|red|green|blue|stain")
                   ->capture_default_str(),
    addOption(command, "Scan", "--threshold", o.picture.threshold,
      "Grey between the two, 0 to 255, once the light is even", "GREY"),
    addOption(
      command, "Scan", "--background", o.background, "Scale over which the stain may vary; 0: no flattening", "PIXELS"),
    addOption(command, "Scan", "--smoothing", o.smoothing, "Gaussian before the threshold; 0: none", "PIXELS"),
    addOption(
      command, "Scan", "--smallest-lumen", o.smallestLumen, "Specks of lumen of fewer pixels become wall", "PIXELS"),
    addOption(command, "Scan", "--smallest-wall", o.smallestWall,
      "Specks of wall in lumens of fewer pixels become lumen", "PIXELS"),
    addOption(command, "Scan", "--opening", o.opening, "Radius of the disk that closes necks between lumens; 0: none",
      "PIXELS"),
    addOption(
      command, "Scan", "--rim", o.rim, "How far outlines move outwards, onto a dark rim; 0: not at all", "PIXELS"),
    addOption(command, "Scan", "--ray-slenderness", o.raySlenderness,
      "Gaps in rays so much longer than wide become wall; 0: none", "RATIO")
      ->capture_default_str(),
    addOption(
      command, "Scan", "--grow", o.grow, "Move outlines outwards by so much besides; inwards if negative", "PIXELS"),
    flag(
      "Scan", command.add_flag("--keep-graphics", o.keepGraphics, "Do not paint over margins, scale bars and text")) };
  o.outlines.declare(
    command, "vtkMicrographContours", { "basis", "level", "lumen-below", "lumen-phase", "smallest-area" });
  o.outlines.declare(command, "vtkMicrographPolygonReader", { "file", "file-name", "window" });
  o.forMasks = { command.get_option("--no-smooth"), command.get_option("--wavelength") };
  o.forPictures = { pixelSize, command.get_option("--tolerance") };
  o.forPolygons = { command.get_option("--unit"), command.get_option("--y-down") };
}

} // namespace lamella::cli
