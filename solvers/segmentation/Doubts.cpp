#include "segmentation/Doubts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace lamella::micrograph
{
namespace
{

std::string percent(double share)
{
  return fmt::format("{:.{}f} %", 100 * share, share < 0.095 ? 1 : 0);
}

// Whole tissue, in drawings and in a real scan, has 0.95 and more; grains that touch, what fibres leave between them,
// and pores of rock 0.8 and less, most below 0.7.
constexpr double leastCompact = 0.8;

/// Whether the lumens are closed cells, but for tears and what lies beside them.
bool cells(const Evidence& e)
{
  return e.compactWithoutGaps >= leastCompact && !(e.lumens.compact < 0.5 && e.gaps >= 2);
}

std::optional<Remark> doubtTheSide(const Evidence& e, const SegmentReport& report, const SegmentOptions& options)
{
  if (cells(e) || options.lumen != LumenSide::Auto)
    return std::nullopt;
  const char* const taken = report.brightLumen ? "bright" : "dark";
  const char* const left = report.brightLumen ? "dark" : "bright";
  return Remark{ Doubt::Side,
    fmt::format(
      "the {} side was taken for lumens or pores, but they do not look like closed cells: {} of their area is "
      "in compact pieces, {} of the {} side's; say which side it is: lumen bright or lumen dark",
      taken, percent(e.lumens.compact), percent(e.walls.compact), left) };
}

/// A third class matters where two do not hold the picture: tomograms of three phases have a separability of 0.8 and
/// less, rocks of several minerals 0.86. Tissue with some dark contents has three classes too, and two that are clearly
/// apart.
bool manyGreys(const Evidence& e, const SegmentReport& report)
{
  constexpr double clear = 0.88;
  return (e.classes.size() >= 3 || e.evenClasses.size() >= 3) && report.separability < clear;
}

/// Three classes and more, of the picture as it is or of the grey that was split.
std::optional<Remark> doubtTheGreys(const Evidence& e, const SegmentReport& report, const Picture& picture)
{
  const bool asSeen = e.classes.size() >= 3;
  const std::vector<GreyClass>& classes = asSeen ? e.classes : e.evenClasses;
  if (!manyGreys(e, report))
    return std::nullopt;
  // The even grey is mirrored where lumens are dark; the threshold is not.
  const bool mirrored = !asSeen && !report.brightLumen;
  std::vector<std::string> summits;
  std::vector<double> limits;
  for (std::size_t i = 0; i < classes.size(); ++i)
  {
    const GreyClass& one = classes[mirrored ? classes.size() - 1 - i : i];
    summits.push_back(fmt::format("{:.0f} ({})", mirrored ? 255 - one.grey : one.grey, percent(one.share)));
    if (i > 0)
    {
      const GreyClass& above = classes[mirrored ? classes.size() - i : i];
      limits.push_back(mirrored ? 256 - above.from : above.from);
    }
  }
  std::string at;
  for (const double limit : limits)
    at += fmt::format("{}threshold {:.0f}", at.empty() ? "" : " or ", limit);
  const std::string where = report.channel == "grey" ? "greys" : "greys of the channel " + report.channel;
  std::string text =
    fmt::format("the picture has {} classes of {}, not two, around {} of 255; split at {:.0f}, what lies on one side "
                "is one phase: choose where to split with {}",
      classes.size(), where, fmt::join(summits, ", "), report.threshold, at);
  // Ranges of greys are of the file's own values.
  if (asSeen && picture.colour.empty() && picture.bits == 8)
  {
    text += ", or give each class a phase:";
    for (std::size_t i = 0; i < classes.size(); ++i)
    {
      const double last = i + 1 < classes.size() ? classes[i + 1].from - 1 : 255;
      text += fmt::format("{} {:.0f}..{:.0f}=NAME", i > 0 ? "," : " phase", classes[i].from, last);
    }
  }
  return Remark{ Doubt::Greys, text };
}

std::optional<Remark> doubtTheResolution(const Evidence& e)
{
  std::string text;
  const auto add = [&](const std::string& what) { text += (text.empty() ? "" : ", ") + what; };
  // Whole tissue with lumens six pixels wide and more has none of these; in a real scan spots are a third as many as
  // lumens and hold 0.1 %.
  const bool outnumbered = e.spots >= 20 && static_cast<double>(e.spots) > 0.8 * static_cast<double>(e.lumens.pieces);
  if (e.spotShare > 0.01 || outnumbered)
  {
    add(fmt::format("{} lumens or so of a few pixels within the walls are not seen, some {} of the picture", e.spots,
      percent(e.spotShare)));
  }
  if (e.narrow > 0.3)
    add(fmt::format("{} of the lumens are no wider than 4 pixels", percent(e.narrow)));
  if (e.edgeWidth > 0.8 * e.wallThickness && e.wallThickness > 0)
  {
    add(fmt::format("the walls are {:.1f} pixels thick and edges take {:.1f} to go from light to dark", e.wallThickness,
      e.edgeWidth));
  }
  if (e.lumenWidth > 0 && e.edgeWidth > 0.8 * e.lumenWidth)
  {
    add(fmt::format(
      "the lumens are {:.1f} pixels wide and edges take {:.1f} to go from light to dark", e.lumenWidth, e.edgeWidth));
  }
  if (text.empty())
    return std::nullopt;
  return Remark{ Doubt::Resolution, "the picture is too coarse or too blurred for its shares to hold: " + text };
}

std::optional<Remark> doubtTheWalls(const Evidence& e, const SegmentReport& report)
{
  // Whole tissue 0.2 and less, the scan with torn rays 0.38, tissue with every third cell filled 0.8.
  constexpr double most = 0.5;
  std::string text;
  if (e.wallShareThick > most)
  {
    text = fmt::format("{} of the walls by area lie in places several times as thick as the walls between lumens",
      percent(e.wallShareThick));
  }
  // None in a hundred pictures of whole tissue; where rays are torn their gaps are told of already.
  else if (e.blind > 0 && report.rays == 0)
  {
    text = fmt::format("in {} within the walls a lumen would fit with its wall all around",
      e.blind == 1 ? "one place" : fmt::format("{} places", e.blind));
  }
  if (text.empty())
    return std::nullopt;
  return Remark{ Doubt::Filled,
    text +
      ": cells filled with stain, resin or bark may have been taken for wall; look at the overlay, or move the "
      "threshold" };
}

std::optional<Remark> doubtTheGaps(const Evidence& e)
{
  constexpr double most = 0.02; // of the picture
  // Where hardly anything is a cell, what is ragged is no tear.
  constexpr double someCells = 0.4;
  if (e.gapShare <= most || (e.compactWithoutGaps < leastCompact && e.lumens.compact < someCells))
    return std::nullopt;
  return Remark{ Doubt::Gaps,
    fmt::format("{} ({} of the picture), far larger than the lumens and ragged or open at the border, "
                "count{} as lumen: a tear, or slide beside the tissue? Give a window without {}",
      e.gaps == 1 ? "one place" : fmt::format("{} places", e.gaps), percent(e.gapShare), e.gaps == 1 ? "s" : "",
      e.gaps == 1 ? "it" : "them") };
}

std::optional<Remark> doubtTheContrast(const SegmentReport& report)
{
  constexpr double least = 0.75; // whole tissue 0.88 and more
  if (report.separability >= least)
    return std::nullopt;
  return Remark{ Doubt::Contrast,
    fmt::format(
      "lumens and walls are hard to tell apart (separability {:.2f}): look at the result", report.separability) };
}

std::optional<Remark> doubtTheShare(const SegmentReport& report)
{
  constexpr double least = 0.03;
  if (report.lumenFraction <= 0 || report.lumenFraction >= 1 ||
    (report.lumenFraction >= least && report.lumenFraction <= 1 - least))
    return std::nullopt;
  return Remark{ Doubt::Share,
    fmt::format(
      "{} of the picture is lumen: if that cannot be, give threshold or lumen", percent(report.lumenFraction)) };
}

} // namespace

std::string name(Doubt doubt)
{
  static constexpr std::array names{ "side", "greys", "filled", "resolution", "gaps", "contrast", "share" };
  return names.at(static_cast<std::size_t>(doubt));
}

std::vector<Remark> doubtsOf(
  const Evidence& evidence, const SegmentReport& report, const SegmentOptions& options, const Picture& picture)
{
  std::vector<Remark> all;
  const auto add = [&](std::optional<Remark> one)
  {
    if (one)
      all.push_back(std::move(*one));
    return one.has_value();
  };
  if (evidence.lumens.pieces > 0)
  {
    add(doubtTheGreys(evidence, report, picture));
    const bool side = add(doubtTheSide(evidence, report, options));
    const bool coarse = add(doubtTheResolution(evidence));
    // Where lumens are too small to be seen, or are no cells, walls are thick for that reason.
    if (!coarse && !side && cells(evidence))
      add(doubtTheWalls(evidence, report));
    add(doubtTheGaps(evidence));
  }
  add(doubtTheContrast(report));
  add(doubtTheShare(report));
  return all;
}

bool looksLikeCells(const Evidence& evidence, const SegmentReport& report)
{
  return cells(evidence) && !manyGreys(evidence, report);
}

} // namespace lamella::micrograph
