#include "segmentation/Segmentation.h"

#include "core/Error.h"
#include "segmentation/Doubts.h"
#include "segmentation/Evidence.h"
#include "segmentation/Flatten.h"
#include "segmentation/Graphics.h"
#include "segmentation/HalfHeight.h"
#include "segmentation/LumenShapes.h"
#include "segmentation/Otsu.h"
#include "segmentation/PieceShapes.h"
#include "segmentation/Pieces.h"
#include "segmentation/Rays.h"
#include "segmentation/Rims.h"
#include "segmentation/Stain.h"

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lamella::micrograph
{
namespace
{

void check(const Picture& picture, const SegmentOptions& options)
{
  if (picture.lattice.dimension != 2)
    throw ParameterError("segmentation of a volume", "segment pictures; give volumes as labels");
  const auto refuse = [](const char* what, double value, const char* hint)
  { throw ParameterError(fmt::format("a {} of {} for the segmentation", what, value), hint); };
  for (const auto& [what, value] :
    { std::pair{ "background scale", options.background }, std::pair{ "smoothing", options.smoothing },
      std::pair{ "opening", options.opening }, std::pair{ "rim", options.rim } })
    if (value && (!(*value >= 0) || !(*value <= 1e5)))
      refuse(what, *value, "give it in pixels, 0 for none");
  if (options.threshold && (!(*options.threshold > 0) || !(*options.threshold < 255)))
    refuse("threshold", *options.threshold, "it lies between 0 and 255, on the flattened grey");
  if (!(std::abs(options.grow) <= 1000))
    refuse("growth", options.grow, "give it in pixels, 0 for none");
  if (!(options.raySlenderness >= 0))
    refuse("slenderness of rays", options.raySlenderness, "give how many times longer than wide, 0 to keep all lumens");
  for (const auto& value : { options.smallestLumen, options.smallestWall })
    if (value && *value < 0)
      refuse("smallest size", static_cast<double>(*value), "give it in pixels, 0 to keep all");
}

double runOf(const cv::Mat& mask)
{
  cv::Mat asFloat;
  mask.convertTo(asFloat, CV_32F, 1.0 / 255);
  return meanRun(asFloat);
}

/// What is smaller is a speck: a twentieth of the usual lumen, told by how far one can go in it (its area would mislead
/// where lumens run together), but no more than a hole half as wide as the walls are thick (vessels would have fibres
/// cleared away), and never less than 3 × 3 pixels.
std::int64_t smallestPiece(double lumenRun, double wallRun)
{
  return std::max<std::int64_t>(9, std::llround(std::min(lumenRun * lumenRun / 20, wallRun * wallRun / 4)));
}

/// From greys to a first mask: light, noise, threshold, which side is lumen.
struct Thresholded
{
  cv::Mat lumen;
  cv::Mat bright; ///< the grey, mirrored if need be so that lumens are above the level
  double level = 0;
};

/// Before anything is known of lumens and walls.
std::vector<GreyClass> classesOf(const cv::Mat& grey)
{
  const cv::Mat bright = grey >= otsu(grey).threshold;
  const double contrast = std::max(1.0, cv::mean(grey, bright)[0] - cv::mean(grey, 255 - bright)[0]);
  return greyClasses(grey, contrast, noiseOf(grey) / contrast);
}

double nearestValley(const std::vector<GreyClass>& classes, double threshold)
{
  double best = classes[1].from;
  for (std::size_t i = 2; i < classes.size(); ++i)
    best = std::abs(classes[i].from - threshold) < std::abs(best - threshold) ? classes[i].from : best;
  return best;
}

Thresholded threshold(const cv::Mat& grey, const SegmentOptions& options, SegmentReport& report)
{
  // Bringing two classes to one level each would tear a third one apart.
  const std::vector<GreyClass> classes = classesOf(grey);
  constexpr double clear = 0.85; // where two classes hold the picture well, a third is some dark content
  const bool many = classes.size() >= 3 && otsu(grey).separability < clear;
  Flattened flat = many && !options.background ? Flattened{ grey.clone(), 0, 0 } : flatten(grey, options.background);
  Otsu rough = otsu(flat.grey);
  // Where a few walls stand in much lumen, or the other way round, the classes themselves may pass for uneven light.
  constexpr double lossAllowed = 0.1;
  if (!options.background && !options.threshold)
  {
    const Otsu asItIs = otsu(grey);
    if (rough.separability < asItIs.separability - lossAllowed)
    {
      flat = { grey.clone(), 0, 0 };
      rough = asItIs;
    }
  }
  report.background = flat.scale;
  report.unevenness = flat.unevenness;
  cv::Mat brightMask = flat.grey >= rough.threshold;
  const double contrast = std::max(1e-3, cv::mean(flat.grey, brightMask)[0] - cv::mean(flat.grey, 255 - brightMask)[0]);
  report.noise = noiseOf(flat.grey) / contrast;
  // A Gaussian of deviation s divides white noise by 2 sqrt(pi) s. A twentieth of the contrast is left: ten deviations
  // between threshold and either class. More smoothing would cost thin walls.
  constexpr double noiseLeft = 0.05;
  report.smoothing = options.smoothing.value_or(
    report.noise <= noiseLeft ? 0.0 : std::max(0.5, report.noise / (noiseLeft * 2 * std::sqrt(std::numbers::pi))));
  if (report.smoothing > 0)
    cv::GaussianBlur(flat.grey, flat.grey, cv::Size(), report.smoothing, report.smoothing, cv::BORDER_REFLECT);
  const Otsu split = otsu(flat.grey);
  const bool between = many && !options.background;
  report.threshold = options.threshold.value_or(between ? nearestValley(classes, split.threshold) : split.threshold);
  report.separability = split.separability;
  brightMask = flat.grey >= report.threshold;
  report.brightLumen = options.lumen == LumenSide::Bright ||
    (options.lumen == LumenSide::Auto && enclosedPieces(brightMask) >= enclosedPieces(255 - brightMask));
  Thresholded result;
  result.lumen = report.brightLumen ? brightMask : cv::Mat(255 - brightMask);
  result.bright = report.brightLumen ? flat.grey : cv::Mat(255 - flat.grey);
  result.level = report.brightLumen ? report.threshold : 255 - report.threshold;
  return result;
}

void clean(cv::Mat& lumen, SegmentReport& report)
{
  report.lumensRemoved += clearSmall(lumen, report.smallestLumen, false, false, report.nodesChanged);
  cv::Mat wall = 255 - lumen;
  report.wallsRemoved += clearSmall(wall, report.smallestWall, true, true, report.nodesChanged);
  lumen = 255 - wall;
}

/// How far beside the outlines to look for what walls are like [pixels].
double reachOf(double wallRun)
{
  return std::clamp(wallRun, 6.0, 40.0);
}

/// Finds how far the outlines have to move to lie on the middle of dark rims.
void findRims(const cv::Mat& lumen, const EdgeDistance& edge, const Picture& picture, const Graphics& graphics,
  double wallRun, SegmentReport& report)
{
  const Rim rim = findRim(picture, lumen, edge, report.brightLumen, reachOf(wallRun), graphics.mask);
  // What lies a quarter of a wall away is not the wall's edge.
  if (rim.found && rim.shift <= std::max(2.0, wallRun / 4))
  {
    report.rim = rim.shift;
    report.rimDepth = rim.depth;
    report.rimChannel = rim.channel;
  }
}

/// Of lumens, twice their area over their perimeter [pixels]; steps of pixels are 4/π as long as a line in any
/// direction.
double radiusOf(const cv::Mat& lumen)
{
  double area = 0;
  double steps = 0;
  for (int row = 0; row < lumen.rows; ++row)
  {
    const auto* const here = lumen.ptr<std::uint8_t>(row);
    const auto* const above = row > 0 ? lumen.ptr<std::uint8_t>(row - 1) : here;
    for (int x = 0; x < lumen.cols; ++x)
    {
      area += here[x] != 0 ? 1 : 0;
      steps += ((here[x] != 0) != (above[x] != 0) ? 1 : 0) + (x > 0 && (here[x] != 0) != (here[x - 1] != 0) ? 1 : 0);
    }
  }
  return 2 * area / std::max(1.0, steps * std::numbers::pi / 4);
}

/// Rims and rays: what takes a look at the neighbourhood of every lumen.
void refine(cv::Mat& lumen, const Thresholded& from, const Picture& picture, const Graphics& graphics, double wallRun,
  const SegmentOptions& options, Segmentation& result)
{
  SegmentReport& report = result.report;
  const bool rays = options.raySlenderness > 0 && report.brightLumen;
  const bool rims = !options.rim || *options.rim > 0;
  const auto area = static_cast<std::size_t>(cv::countNonZero(lumen));
  report.surfaceDoubt = surfaceDoubt(0, radiusOf(lumen));
  if ((!rays && !rims) || area == 0 || area == lumen.total())
    return;
  const EdgeDistance edge = edgeDistance(lumen, from.bright, from.level);
  if (options.rim)
    report.rim = *options.rim;
  else
    findRims(lumen, edge, picture, graphics, wallRun, report);
  if (report.rim == 0 && !options.rim && !options.threshold)
  {
    const HalfHeight found = toHalfHeight(lumen, edge, from.bright, reachOf(wallRun));
    report.halfHeight = found.moved;
    report.edgeBlur = found.blur;
  }
  else
    report.edgeBlur = edgeBlur(edge, from.bright, reachOf(wallRun));
  report.surfaceDoubt = surfaceDoubt(report.edgeBlur, radiusOf(lumen));
  if (report.rim > 0)
    moveOutwards(lumen, edge, report.rim);
  if (report.neckNodes > 0 || report.rim > 0 || report.halfHeight != 0)
    clean(lumen, report);
  if (rays)
  {
    RayGaps gaps = dropRayGaps(
      lumen, picture, edge, report.rim + 1, report.rim + std::max(3.0, wallRun / 3), options.raySlenderness);
    report.rays = static_cast<std::int64_t>(gaps.marks.size());
    report.rayNodes = gaps.nodes;
    result.marks.insert(result.marks.end(), gaps.marks.begin(), gaps.marks.end());
  }
}

/// Numbers, shapes and classes of what is left.
void describe(const cv::Mat& lumen, Segmentation& result)
{
  const Pieces pieces = piecesOf(lumen, false);
  result.lumen.assign(pieces.labels.begin<int>(), pieces.labels.end<int>());
  result.shapes = lumenShapes(pieces.labels, static_cast<int>(pieces.area.size()));
  result.shapes.erase(result.shapes.begin());
  // Both number the pieces alike: rows first, through faces.
  const std::vector<PieceShape> solid = pieceShapes(lumen, 1);
  std::vector<LumenExtent> extents;
  for (std::size_t i = 0; i < result.shapes.size(); ++i)
  {
    const LumenShape& shape = result.shapes[i];
    extents.push_back({ shape.length, shape.width, !shape.cut, solid[i].solidity });
  }
  const LumenClasses classes = tellVessels(extents);
  SegmentReport& report = result.report;
  report.vesselsFound = classes.two;
  report.vesselSize = classes.threshold;
  report.vesselSeparability = classes.separability;
  report.vessels = static_cast<std::int64_t>(classes.vessels);
  result.vessel = classes.vessel;
  report.lumens = static_cast<std::int64_t>(result.shapes.size());
  report.lumenFraction = static_cast<double>(cv::countNonZero(lumen)) / static_cast<double>(lumen.total());
}

std::string counted(const std::vector<Mark>& marks, Mark::Kind kind)
{
  const auto number = std::count_if(marks.begin(), marks.end(), [&](const Mark& mark) { return mark.kind == kind; });
  const bool plural = number > 1 && kind != Mark::Kind::Text;
  return number == 0
    ? ""
    : fmt::format("{} {}{}", number, kind == Mark::Kind::Text ? "line(s) of text" : name(kind), plural ? "s" : "");
}

void warn(const Graphics& graphics, Segmentation& result)
{
  const SegmentReport& report = result.report;
  const auto say = [&](std::string text) { result.warnings.push_back(std::move(text)); };
  std::string drawn;
  for (const auto kind : { Mark::Kind::Margin, Mark::Kind::Bar, Mark::Kind::Text })
  {
    const std::string part = counted(graphics.marks, kind);
    drawn += part.empty() ? "" : (drawn.empty() ? "" : ", ") + part;
  }
  if (!drawn.empty())
  {
    say(fmt::format("{} in the picture ({:.1f} % of it) painted over with what lies beside: cut it off to be sure",
      drawn, 100 * report.graphicsShare));
  }
  for (const auto& [colour, share] : { std::pair{ "white", graphics.white }, std::pair{ "black", graphics.black } })
  {
    if (share > 0.1)
    {
      say(
        fmt::format("{:.0f} % of the picture is plain {} over places as wide as several cells: what was there is lost; "
                    "give a window without it",
          100 * share, colour));
    }
  }
  for (const Remark& remark : report.doubts)
    say(remark.text);
  if (report.rays > 0)
  {
    say(fmt::format("{} {} ({:.1f} % of the picture) taken for wall: look at the result", report.rays,
      report.cells ? "gaps in rays" : "slender gaps in dark places",
      100 * static_cast<double>(report.rayNodes) / static_cast<double>(result.lumen.size())));
  }
  if (report.lumenFraction <= 0)
  {
    say("no lumen was found: give the threshold, or which side is lumen");
  }
  else if (report.lumenFraction >= 1)
  {
    say("no wall was found: give the threshold, or which side is lumen");
  }
  else if (report.lumens == 1 && report.lumenFraction > 0.5)
  {
    say(fmt::format("one lumen fills {:.0f} % of the picture: give a threshold that closes its walls, or another side "
                    "for lumen",
      100 * report.lumenFraction));
  }
}

/// In nodes of the picture.
cv::Rect judgedPart(const Picture& picture, const SegmentOptions& options)
{
  const auto& size = picture.lattice.size;
  if (!options.judged)
    return { 0, 0, static_cast<int>(size[0]), static_cast<int>(size[1]) };
  const auto first = firstNode(picture.lattice, *options.judged);
  return { static_cast<int>(first[0]), static_cast<int>(first[1]), static_cast<int>(options.judged->size[0]),
    static_cast<int>(options.judged->size[1]) };
}

void markGaps(const Evidence& evidence, const cv::Rect& part, Segmentation& result)
{
  const auto& doubts = result.report.doubts;
  if (std::any_of(doubts.begin(), doubts.end(), [](const Remark& r) { return r.doubt == Doubt::Gaps; }))
  {
    for (const cv::Rect& box : evidence.gapBoxes)
    {
      const cv::Rect at = box + part.tl();
      result.marks.push_back({ Mark::Kind::Gap, at.x, at.y, at.x + at.width, at.y + at.height });
    }
  }
}

} // namespace

double surfaceDoubt(double blur, double radius)
{
  constexpr double level = 0.05;
  const double s = blur > 0 ? blur : 1.5;
  return std::hypot(level * std::sqrt(2 * std::numbers::pi) * s, s * s / (2 * std::max(radius, 1.0)));
}

std::vector<std::string> SegmentReport::doubtNames() const
{
  std::vector<std::string> names;
  for (const Remark& remark : doubts)
    names.push_back(name(remark.doubt));
  return names;
}

std::vector<std::string> SegmentReport::lines() const
{
  std::vector<std::string> text;
  const bool mixed = channel == "stain";
  text.push_back(fmt::format("channel: {}{}, lumens are {}", channel,
    mixed ? fmt::format(" ({:.2f} red {:+.2f} green {:+.2f} blue)", weights[0], weights[1], weights[2]) : "",
    brightLumen ? "bright" : "dark"));
  text.push_back(background > 0
      ? fmt::format(
          "light: flattened over {:.0f} pixels; it varied by {:.0f} % of the contrast", background, 100 * unevenness)
      : "light: taken as even");
  text.push_back(fmt::format("noise: {:.1f} % of the contrast, smoothed over {:.1f} pixels", 100 * noise, smoothing));
  text.push_back(fmt::format("threshold: {:.0f} of 255, separability {:.3f}", threshold, separability));
  text.push_back(fmt::format("cleaning: {} specks of lumen below {} pixels, {} of wall below {}, {} pixels in all",
    lumensRemoved, smallestLumen, wallsRemoved, smallestWall, nodesChanged));
  text.push_back(fmt::format("necks: closed up to {:.1f} pixels wide, {} pixels in all", 2 * opening, neckNodes));
  if (rim > 0)
  {
    text.push_back(rimDepth > 0
        ? fmt::format("rims: outlines moved outwards by {:.2f} pixels onto the dark rim, {:.0f} % of "
                      "the contrast deep in {}",
            rim, 100 * rimDepth, rimChannel)
        : fmt::format("rims: outlines moved outwards by {:.2f} pixels, as asked", rim));
  }
  if (surfaceDoubt > 0)
    text.push_back(fmt::format("edges: {}; outlines within {:.2f} pixels, for greys within 5 % of the contrast",
      edgeBlur > 0 ? fmt::format("blurred over {:.2f} pixels", edgeBlur) : "too few to tell their blur", surfaceDoubt));
  if (rays > 0)
    text.push_back(fmt::format("{}: {} gaps taken for wall, {} pixels", cells ? "rays" : "slender", rays, rayNodes));
  if (graphicsShare > 0)
    text.push_back(fmt::format("graphics: {:.1f} % of the picture painted over", 100 * graphicsShare));
  text.push_back(fmt::format("result: {} lumens, {:.2f} % of the picture", lumens, 100 * lumenFraction));
  if (vesselsFound)
  {
    text.push_back(fmt::format("{} longer than {:.1f} pixels",
      cells ? fmt::format("vessels: {} lumens", vessels) : fmt::format("large pores: {}", vessels),
      std::sqrt(vesselSize * 4 / std::numbers::pi)));
  }
  return text;
}

Segmentation segment(const Picture& picture, const SegmentOptions& options)
{
  check(picture, options);
  Segmentation result;
  SegmentReport& report = result.report;

  StainGrey stain = stainGrey(picture, options.channel);
  report.channel = stain.name;
  report.weights = stain.weights;
  if (stain.separability <= 0)
  {
    throw InputError(fmt::format("the picture is of one single grey, {:.0f} of 255: there is nothing to tell apart",
                       static_cast<double>(stain.grey.at<float>(0, 0))),
      "check that it is the picture you mean");
  }
  const double longest = std::max(stain.grey.rows, stain.grey.cols);
  const Graphics graphics = options.graphics ? findGraphics(picture, std::max(16.0, longest / 12)) : Graphics{};
  result.marks = graphics.marks;
  if (!graphics.mask.empty())
  {
    report.graphicsShare = cv::countNonZero(graphics.mask) / static_cast<double>(graphics.mask.total());
    paintOver(stain.grey, graphics.mask);
  }

  const Thresholded found = threshold(stain.grey, options, report);
  cv::Mat lumen = found.lumen;
  const double lumenRun = runOf(lumen);
  const double wallRun = runOf(255 - lumen);
  const std::int64_t smallest = smallestPiece(lumenRun, wallRun);
  report.smallestLumen = options.smallestLumen.value_or(smallest);
  report.smallestWall =
    options.smallestWall.value_or(std::max<std::int64_t>(9, std::llround(lumenRun * lumenRun / 20)));
  clean(lumen, report);
  report.opening = options.opening.value_or(lumenRun / 20);
  report.neckNodes = openPieces(lumen, report.opening);
  refine(lumen, found, picture, graphics, wallRun, options, result);
  if (options.grow != 0)
    growBy(lumen, options.grow);
  describe(lumen, result);
  const cv::Rect part = judgedPart(picture, options);
  const Evidence evidence =
    gather(lumen(part), stain.grey(part), found.bright(part), report.noise, report.smallestLumen);
  report.cells = looksLikeCells(evidence, report);
  report.doubts = doubtsOf(evidence, report, options, picture);
  markGaps(evidence, part, result);
  warn(graphics, result);

  result.image.lattice = picture.lattice;
  result.image.phases = PhaseTable({ "lumen", "wall" });
  result.image.phase.resize(picture.grey.size());
  for (int row = 0; row < lumen.rows; ++row)
  {
    const auto* value = lumen.ptr<std::uint8_t>(row);
    std::transform(value, value + lumen.cols,
      result.image.phase.begin() + static_cast<std::ptrdiff_t>(row) * lumen.cols,
      [](std::uint8_t inside) { return static_cast<std::uint8_t>(inside == 0); });
  }
  return result;
}

} // namespace lamella::micrograph
