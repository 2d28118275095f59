#include "segmentation/VolumeSegmentation.h"

#include "core/Error.h"
#include "segmentation/VolumeFilters.h"
#include "segmentation/VolumePieces.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lamella::micrograph
{
namespace
{

void check(const Picture& picture, const VolumeOptions& options)
{
  if (picture.lattice.dimension != 3)
    throw ParameterError("segmentation of a volume was asked for a picture", "segment() is for pictures");
  if (!options.phases.empty() && (options.threshold || options.empty != LumenSide::Auto))
  {
    throw ParameterError("a threshold or a side of the void contradicts phases named by their greys",
      "the ranges say both: ..89=void and 90..=fibre, or ..otsu=void and otsu..=fibre");
  }
  const int top = picture.bits == 8 ? 255 : 65535;
  if (options.threshold && !(*options.threshold > 0 && *options.threshold < top))
  {
    throw ParameterError(fmt::format("a threshold of {:g} for greys from 0 to {}", *options.threshold, top),
      "give a grey value of the volume, or leave it out to have it found");
  }
  if (options.smoothing && !(*options.smoothing >= 0 && *options.smoothing <= 100))
    throw ParameterError(fmt::format("a smoothing of {:g} voxels", *options.smoothing), "give 0 to 100, 0 for none");
  if (options.smallest && *options.smallest < 0)
    throw ParameterError(fmt::format("a smallest piece of {} voxels", *options.smallest), "give 0 to keep all");
}

/// The class of a value: 0 the darkest.
std::uint8_t classOf(std::uint16_t value, std::span<const int> last)
{
  std::uint8_t cls = 0;
  for (const int end : last)
    cls = static_cast<std::uint8_t>(cls + (value > end ? 1 : 0));
  return cls;
}

/// Greys of the classes away from their edges.
struct Inside
{
  std::vector<double> mean;
  std::vector<double> deviation;
  std::vector<std::int64_t> voxels;
};

/// Of the voxels whose neighbours so many voxels away along every axis are of their class.
/// @param smoothing of the volume: what it took from the greys of thin walls is given back to the first order, I + s⁴/8
///                  (∂x⁴ + ∂y⁴ + ∂z⁴) I, which leaves the mean over noise as it is
Inside insideBy(std::int64_t away, const Lattice& lattice, std::span<const std::uint16_t> grey,
  std::span<const int> last, double smoothing)
{
  const std::size_t classes = last.size() + 1;
  std::vector<double> sum(classes, 0);
  std::vector<double> square(classes, 0);
  std::vector<double> fourths(classes, 0);
  Inside found{ sum, sum, std::vector<std::int64_t>(classes, 0) };
  const auto [nx, ny, nz] = lattice.size;
  // Of a large volume every second voxel along each axis says as much.
  const std::int64_t step = lattice.count() > 1'500'000 ? 2 : 1;
  const std::int64_t deep = nz > 2 * away ? away : 0;
  const std::int64_t slice = nx * ny;
  for (std::int64_t z = deep; z < nz - deep; z += step)
  {
    for (std::int64_t y = away; y < ny - away; y += step)
    {
      for (std::int64_t x = away; x < nx - away; x += step)
      {
        const std::uint16_t* const at = grey.data() + lattice.index(x, y, z);
        const std::uint8_t cls = classOf(*at, last);
        const auto same = [&](std::int64_t by)
        { return classOf(at[by], last) == cls && classOf(at[-by], last) == cls; };
        if (same(away) && same(away * nx) && same(deep * slice))
        {
          const double value = *at;
          sum[cls] += value;
          square[cls] += value * value;
          ++found.voxels[cls];
          const auto fourth = [&](std::int64_t by)
          { return at[2 * by] + at[-2 * by] - 4 * (at[by] + at[-by]) + 6 * *at; };
          fourths[cls] += fourth(1) + fourth(nx) + (deep > 0 ? fourth(slice) : 0);
        }
      }
    }
  }
  for (std::size_t k = 0; k < classes; ++k)
  {
    const double n = std::max<double>(1, static_cast<double>(found.voxels[k]));
    const double mean = sum[k] / n;
    found.deviation[k] = std::sqrt(std::max(0.0, square[k] / n - mean * mean));
    found.mean[k] = mean + std::pow(smoothing, 4) / 8 * fourths[k] / n;
  }
  return found;
}

/// Of each class as far from its edges as there are voxels enough to tell its mean to some hundredths of the noise.
Inside inside(const Lattice& lattice, std::span<const std::uint16_t> grey, std::span<const int> last, double smoothing)
{
  constexpr std::int64_t enough = 1000;
  Inside found = insideBy(2, lattice, grey, last, smoothing);
  for (const std::int64_t away : { 3, 4, 6 })
  {
    const Inside deeper = insideBy(away, lattice, grey, last, smoothing);
    for (std::size_t k = 0; k < found.mean.size(); ++k)
    {
      if (deeper.voxels[k] >= enough)
      {
        found.mean[k] = deeper.mean[k];
        found.deviation[k] = deeper.deviation[k];
        found.voxels[k] = deeper.voxels[k];
      }
    }
  }
  return found;
}

/// Root mean square over the classes, over the smallest contrast between neighbours.
double noiseWithin(const Inside& found)
{
  double square = 0;
  double voxels = 0;
  double contrast = 1e30;
  for (std::size_t k = 0; k < found.mean.size(); ++k)
  {
    square += found.deviation[k] * found.deviation[k] * static_cast<double>(found.voxels[k]);
    voxels += static_cast<double>(found.voxels[k]);
    if (k > 0 && found.voxels[k] > 0 && found.voxels[k - 1] > 0)
      contrast = std::min(contrast, found.mean[k] - found.mean[k - 1]);
  }
  return voxels > 0 && contrast > 0 ? std::sqrt(square / voxels) / contrast : 0;
}

/// Otsu's levels, moved to half height between what the classes are away from their edges.
std::vector<int> halfHeights(
  const Lattice& lattice, std::span<const std::uint16_t> grey, std::vector<int> last, double smoothing)
{
  for (int round = 0; round < 3; ++round)
  {
    const Inside found = inside(lattice, grey, last, smoothing);
    for (std::size_t k = 0; k + 1 < found.mean.size(); ++k)
    {
      // A hundred voxels tell a mean to a tenth of the deviation.
      if (found.voxels[k] > 100 && found.voxels[k + 1] > 100)
        last[k] = static_cast<int>(std::lround((found.mean[k] + found.mean[k + 1]) / 2));
    }
  }
  return last;
}

/// Eight boxes of at most 48 voxels' edge, spread over the volume: enough to choose the smoothing by.
std::vector<std::pair<Lattice, std::vector<std::uint16_t>>> boxesOf(
  const Lattice& lattice, std::span<const std::uint16_t> grey)
{
  std::array<std::int64_t, 3> edge{};
  std::array<std::int64_t, 3> number{};
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    number[axis] = lattice.size[axis] >= 32 ? 2 : 1;
    edge[axis] = std::min<std::int64_t>(48, lattice.size[axis] / number[axis]);
  }
  std::vector<std::pair<Lattice, std::vector<std::uint16_t>>> boxes;
  for (std::int64_t box = 0; box < number[0] * number[1] * number[2]; ++box)
  {
    const std::array<std::int64_t, 3> at{ box % number[0], box / number[0] % number[1], box / number[0] / number[1] };
    std::array<std::int64_t, 3> first{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      first[axis] = (2 * at[axis] + 1) * lattice.size[axis] / (2 * number[axis]) - edge[axis] / 2;
    auto& [of, values] = boxes.emplace_back(makeLattice(edge[0], edge[1], edge[2], 3, 1), std::vector<std::uint16_t>());
    values.reserve(static_cast<std::size_t>(of.count()));
    for (std::int64_t z = 0; z < edge[2]; ++z)
    {
      for (std::int64_t y = 0; y < edge[1]; ++y)
      {
        const std::uint16_t* const row = grey.data() + lattice.index(first[0], first[1] + y, first[2] + z);
        values.insert(values.end(), row, row + edge[0]);
      }
    }
  }
  return boxes;
}

/// The width of the smoothing after which the classes are farthest apart: less would leave noise, more would take
/// away what is thin. Of noise from voxel to voxel, noise that hangs together and rings alike it left nearly the fewest
/// voxels wrong (docs/solvers/segmentation.md).
double bestSmoothing(const Lattice& lattice, std::span<const std::uint16_t> grey, int classes)
{
  auto boxes = boxesOf(lattice, grey);
  const auto separability = [&]
  {
    std::vector<std::int64_t> histogram(65536, 0);
    for (const auto& box : boxes)
    {
      const std::vector<std::int64_t> own = greyHistogram(box.second);
      std::ranges::transform(own, histogram, histogram.begin(), std::plus<>());
    }
    const auto greys = std::ranges::count_if(histogram, [](std::int64_t count) { return count > 0; });
    return greys < classes ? 0.0 : otsuLevels(histogram, classes).separability;
  };
  double best = 0;
  double reached = separability();
  const auto before = boxes;
  // All are tried: where noise buries a rare phase the classes are halves of the noise at first.
  for (const double next : { 0.7, 0.85, 1.0, 1.2, 1.4, 1.7, 2.0, 2.4, 2.8 })
  {
    boxes = before;
    for (auto& [of, values] : boxes)
      smooth(of, values, next);
    if (const double found = separability(); found > reached)
    {
      best = next;
      reached = found;
    }
  }
  return best;
}

/// The share of the volume outside a round field of view: that has the grey of the edges along z to the last digit,
/// where that fills the corners and is next to nowhere within the round; else 0.
double outsideShare(const Lattice& lattice, std::span<const std::uint16_t> grey)
{
  const auto [nx, ny, nz] = lattice.size;
  const std::uint16_t corner = grey[0];
  std::array<std::int64_t, 2> voxels{}; // within nine tenths of the inscribed ellipse, in the corners
  std::array<std::int64_t, 2> same{};
  std::int64_t all = 0;
  for (std::int64_t z = 0; z < nz; ++z)
  {
    for (std::int64_t y = 0; y < ny; ++y)
    {
      const std::uint16_t* const row = grey.data() + lattice.index(0, y, z);
      const double v = (2 * static_cast<double>(y) + 1) / static_cast<double>(ny) - 1;
      for (std::int64_t x = 0; x < nx; ++x)
      {
        const double u = (2 * static_cast<double>(x) + 1) / static_cast<double>(nx) - 1;
        const double radius = u * u + v * v;
        all += row[x] == corner ? 1 : 0;
        if (radius < 0.81 || radius > 1.21)
        {
          const std::size_t place = radius > 1 ? 1 : 0;
          ++voxels[place];
          same[place] += row[x] == corner ? 1 : 0;
        }
      }
    }
  }
  const auto share = [&](std::size_t place)
  { return static_cast<double>(same[place]) / static_cast<double>(std::max<std::int64_t>(1, voxels[place])); };
  return share(1) > 0.99 && share(0) < 0.05 ? static_cast<double>(all) / static_cast<double>(grey.size()) : 0;
}

/// Noise and light.
void prepare(const Lattice& lattice, std::vector<std::uint16_t>& grey, const VolumeOptions& options, int classes,
  VolumeReport& report)
{
  report.separabilityBefore = otsuLevels(greyHistogram(grey), classes).separability;
  report.smoothing = options.smoothing ? *options.smoothing : bestSmoothing(lattice, grey, classes);
  smooth(lattice, grey, report.smoothing);
  if (options.flatten)
  {
    const VolumeLight light = flattenVolume(lattice, grey, classes);
    report.unevenness = light.unevenness;
    report.flattened = light.flattened;
  }
}

void measure(const std::vector<std::int64_t>& histogram, std::span<const int> last, const VolumeSegmentation& result,
  std::span<const std::uint8_t> idOfClass, VolumeReport& report)
{
  const PhaseImage& image = result.image;
  report.phases = image.phases.names();
  report.shares = image.fractions();
  report.thickness = thicknesses(image.lattice, image.phase, image.phases.size());
  // What 5 % of the contrast to either side of a level would change hands; half of it for the shift one way.
  report.shareError.assign(report.phases.size(), 0);
  const double total = static_cast<double>(image.phase.size());
  for (std::size_t k = 0; k < last.size(); ++k)
  {
    const double shift = 0.05 * (report.means[k + 1] - report.means[k]);
    double hands = 0;
    for (int value = std::max(0, static_cast<int>(last[k] - shift));
         value <= std::min(65535, static_cast<int>(last[k] + shift)); ++value)
      hands += static_cast<double>(histogram[static_cast<std::size_t>(value)]);
    for (const std::size_t cls : { k, k + 1 })
      report.shareError[idOfClass[cls]] += hands / total / 2;
  }
  // Of a phase's voxels 2 over its thickness lie at its surface: so many change hands where that moves by one. A blur
  // that makes 5 % of the contrast as wide as that has moved curved surfaces, too: those of the thinnest phase most.
  double shift = 0;
  double thinnest = std::numeric_limits<double>::infinity();
  for (std::size_t id = 0; id < report.phases.size(); ++id)
    if (report.shares[id] > 0 && report.shares[id] < 1)
    {
      shift = std::max(shift, report.shareError[id] / report.shares[id] * report.thickness[id] / 2);
      thinnest = std::min(thinnest, report.thickness[id]);
    }
  report.surfaceDoubt =
    shift > 0 ? surfaceDoubt(shift / surfaceDoubt(1, std::numeric_limits<double>::infinity()), thinnest) : 0;
}

void warn(const GreyLevels& levels, double outside, VolumeSegmentation& result)
{
  const VolumeReport& report = result.report;
  const auto say = [&](std::string text) { result.warnings.push_back(std::move(text)); };
  if (outside > 0.02)
  {
    say(
      fmt::format("{:.0f} % of the volume lie outside a round field of view, all one grey, and are taken for a phase: "
                  "give a window within it",
        100 * outside));
  }
  if (std::string doubt = levels.doubt(); !doubt.empty())
    say(std::move(doubt));
  if (report.noiseLeft > 0.25)
  {
    say(fmt::format("noise of {:.0f} % of the contrast is left after smoothing over {:.1f} voxels: phases are wrong at "
                    "many voxels",
      100 * report.noiseLeft, report.smoothing));
  }
  if (report.flattened && report.unevenness > 1)
  {
    say(fmt::format("the light varied by {:.0f} % of the contrast before it was made even: look at the result",
      100 * report.unevenness));
  }
  for (std::size_t id = 0; id < report.phases.size(); ++id)
  {
    if (report.shares[id] <= 0 || report.shares[id] >= 1)
    {
      say(fmt::format("{} of the volume is '{}': give the greys that part the phases",
        report.shares[id] <= 0 ? "nothing" : "all", report.phases[id]));
    }
    else if (report.thickness[id] < 3)
    {
      say(fmt::format(
        "'{}' is {:.1f} voxels thick on average: what is thinner than about three is lost or too thick; scan it finer",
        report.phases[id], report.thickness[id]));
    }
    if (report.shareError[id] > 0.03)
    {
      say(fmt::format("the share of '{}' is uncertain: it changes by {:.3f} where a level moves by 5 % of the contrast",
        report.phases[id], report.shareError[id]));
    }
  }
  const double cleared = static_cast<double>(report.speckVoxels) / static_cast<double>(result.image.phase.size());
  if (cleared > 0.02)
  {
    say(
      fmt::format("{} specks, {:.1f} % of the volume, took the phase around them: noise, or a phase too fine for this "
                  "scan",
        report.specks, 100 * cleared));
  }
  const double shells = static_cast<double>(report.shellVoxels) / static_cast<double>(result.image.phase.size());
  if (shells > 0.01)
  {
    say(fmt::format("{:.1f} % of the volume lay between a dark and a bright phase within two voxels on either side and "
                    "were taken for blur: a middle phase as thin as that is lost",
      100 * shells));
  }
}

/// The phase of each class, and whether that holds for all of its voxels: numbers beside levels may part it further.
std::pair<std::vector<std::uint8_t>, bool> phasesOfClasses(
  std::span<const std::uint16_t> grey, std::span<const int> last, std::span<const std::uint8_t> phase)
{
  constexpr int none = -1;
  std::vector<int> found(last.size() + 1, none);
  bool one = true;
  for (std::size_t node = 0; node < grey.size(); ++node)
  {
    int& id = found[classOf(grey[node], last)];
    one = one && (id == none || id == phase[node]);
    id = phase[node];
  }
  std::vector<std::uint8_t> ids;
  for (const int id : found)
    ids.push_back(static_cast<std::uint8_t>(std::max(id, 0)));
  return { ids, one };
}

/// Values of the volume so many times finer than the file's greys, so that smoothing rounds nothing off.
constexpr int finer = 128;

GreyRanges rangesOf(const VolumeOptions& options, VolumeReport& report)
{
  if (!options.phases.empty())
    return options.phases;
  const bool darkVoid = options.empty != LumenSide::Bright;
  report.polarity = fmt::format("void is {}", darkVoid ? "dark" : "bright");
  GreyRanges ranges;
  ranges.add("..otsu", darkVoid ? "void" : "solid");
  ranges.add("otsu..", darkVoid ? "solid" : "void");
  return ranges;
}

} // namespace

VolumeSegmentation segmentVolume(Picture picture, const VolumeOptions& options)
{
  check(picture, options);
  VolumeSegmentation result;
  VolumeReport& report = result.report;
  const Lattice& lattice = picture.lattice;
  std::vector<std::uint16_t>& grey = picture.grey;
  const GreyRanges ranges = rangesOf(options, report);
  const int scale = picture.bits == 8 ? finer : 1;
  const double outside = outsideShare(lattice, grey);
  for (std::uint16_t& value : grey)
    value = static_cast<std::uint16_t>(value * scale);

  // Levels that are numbers part the classes as they are; for the light darkest and brightest are enough.
  std::vector<int> last;
  for (const int cut : ranges.classes() > 0 ? std::vector<int>{} : ranges.cuts())
    last.push_back(cut * scale + scale - scale / 2 - 1);
  if (options.threshold)
    last = { static_cast<int>(std::lround(*options.threshold * scale)) - 1 };
  const int classes = !last.empty() ? (last.size() == 1 ? 2 : 3) : std::max(2, ranges.classes());
  prepare(lattice, grey, options, classes, report);
  std::vector<std::int64_t> histogram = greyHistogram(grey);
  if (last.empty())
    last = halfHeights(lattice, grey, otsuLevels(histogram, classes).last, report.smoothing);
  const GreyLevels levels = describeLevels(histogram, last);
  const Inside pure = inside(lattice, grey, last, report.smoothing);
  report.noiseLeft = noiseWithin(pure);
  report.separability = levels.separability;
  report.valley = levels.valley;
  report.means = pure.mean;
  for (std::size_t k = 0; k < report.means.size(); ++k)
    report.means[k] = pure.voxels[k] > 0 ? pure.mean[k] : levels.mean[k];

  GreyScale how{ picture.bits, scale, levels };
  result.image = ranges.apply(lattice, grey, how).image;
  const auto [idOfClass, onePhaseEach] = phasesOfClasses(grey, last, result.image.phase);
  if (last.size() == 2 && onePhaseEach && idOfClass[0] != idOfClass[1] && idOfClass[1] != idOfClass[2])
  {
    std::vector<std::uint8_t>& phase = result.image.phase;
    std::ranges::transform(grey, phase.begin(), [&](std::uint16_t value) { return classOf(value, last); });
    report.shellVoxels = clearShells(lattice, phase, grey, (report.means.front() + report.means.back()) / 2, 2);
    std::ranges::transform(phase, phase.begin(), [&](std::uint8_t cls) { return idOfClass[cls]; });
  }
  report.smallest = options.smallest.value_or(27); // three voxels cubed
  const ClearedPieces cleared = clearPieces(lattice, result.image.phase, report.smallest);
  report.specks = cleared.pieces;
  report.speckVoxels = cleared.voxels;
  measure(histogram, last, result, idOfClass, report);
  for (const int end : last)
    report.levels.push_back((end + 0.5) / scale);
  for (double& mean : report.means)
    mean /= scale;
  warn(levels, outside, result);
  return result;
}

std::vector<std::string> VolumeReport::lines() const
{
  std::vector<std::string> text;
  text.push_back(flattened ? fmt::format("light: made even; it varied by {:.0f} % of the contrast", 100 * unevenness)
                           : "light: left as it is; making it even parts the phases no better");
  text.push_back(
    fmt::format("noise: smoothed over {:.2g} voxels, which takes the separability from {:.3f}; {:.1f} % of "
                "the contrast left within phases",
      smoothing, separabilityBefore, 100 * noiseLeft));
  std::string parted;
  for (std::size_t k = 0; k < means.size(); ++k)
    parted += fmt::format("{}{:.1f}", k == 0 ? "" : ", ", means[k]);
  std::string at;
  for (std::size_t k = 0; k < levels.size(); ++k)
    at += fmt::format("{}{:.1f}", k == 0 ? "" : " and ", levels[k]);
  text.push_back(fmt::format("greys: {} away from edges, parted at {}, separability {:.3f}, valley {:.2f}{}", parted,
    at, separability, valley, polarity.empty() ? "" : "; " + polarity));
  text.push_back(fmt::format("cleaning: {} specks below {} voxels, {} voxels in all", specks, smallest, speckVoxels));
  if (shellVoxels > 0)
    text.push_back(fmt::format("blur: {} voxels between dark and bright given to the nearer", shellVoxels));
  std::string result;
  for (std::size_t id = 0; id < phases.size(); ++id)
  {
    result += fmt::format("{}{} {:.4f} ± {:.4f}, {:.1f} voxels thick", id == 0 ? "" : "; ", phases[id], shares[id],
      shareError[id], thickness[id]);
  }
  text.push_back("result: " + result);
  text.push_back(fmt::format("surfaces: within {:.2f} voxels, for levels within 5 % of the contrast", surfaceDoubt));
  return text;
}

} // namespace lamella::micrograph
