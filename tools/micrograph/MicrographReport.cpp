#include "micrograph/MicrographReport.h"

#include "files/FieldReport.h"
#include "files/Record.h"
#include "session/Text.h"

#include "core/Median.h"
#include "lattice/AxisNames.h"
#include "vtkLatticeConversion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace lamella::cli
{

namespace
{

constexpr std::array<const char*, 4> kinds{ "scan", "labels", "polygons", "grey" };

/// Of one class of lumens.
struct ClassNumbers
{
  std::int64_t count = 0;
  double areaShare = 0; ///< of the picture
  double diameter = 0;  ///< median, of whole lumens [m]
};

ClassNumbers numbersOf(const MicrographReport& report, const std::function<bool(std::size_t)>& belongs)
{
  ClassNumbers numbers;
  std::vector<double> diameters;
  for (std::size_t i = 0; i < report.measures.size(); ++i)
  {
    if (belongs(i))
    {
      ++numbers.count;
      numbers.areaShare += report.measures[i].area;
      if (!report.measures[i].open)
        diameters.push_back(report.measures[i].equivalentDiameter);
    }
  }
  const auto& size = report.micrograph->contours.size;
  numbers.areaShare /= size[0] * size[1];
  numbers.diameter = median(std::move(diameters));
  return numbers;
}

Json jsonOf(const ClassNumbers& numbers)
{
  return { { "count", numbers.count }, { "area_share", numbers.areaShare }, { "median_diameter", numbers.diameter } };
}

Json jsonOf(const lbm::ContourStep& step)
{
  return { { "spacing", step.spacing }, { "value", step.value }, { "nodes", step.nodes },
    { "iterations", step.iterations }, { "seconds", step.seconds } };
}

std::string micrometres(double metres)
{
  return fmt::format("{:.4g} µm", 1e6 * metres);
}

std::string percentText(double share)
{
  return fmt::format("{:.2f} %", 100 * share);
}

/// The error bar and its parts.
std::string errorText(const lbm::ContourAnswer& a, bool picture)
{
  if (!picture)
    return fmt::format("{:.2g} ({:.2g} % lattice; outlines as given)", a.error * a.value, 100 * a.error);
  if (!std::isfinite(a.pictureError))
    return fmt::format("unknown ({:.2g} % lattice, picture unknown)", 100 * a.latticeError);
  return fmt::format("{:.2g} ({:.2g} %: {:.2g} % lattice, {:.2g} % picture)", a.error * a.value, 100 * a.error,
    100 * a.latticeError, 100 * a.pictureError);
}

} // namespace

micrograph::LumenClasses classify(const std::vector<micrograph::LumenMeasures>& measures)
{
  std::vector<micrograph::LumenExtent> extents;
  extents.reserve(measures.size());
  for (const auto& m : measures)
    extents.push_back({ m.major, m.minor, !m.open, m.solidity });
  return micrograph::tellVessels(extents);
}

bool lookLikeCells(const Micrograph& micrograph, const std::vector<micrograph::LumenMeasures>& measures)
{
  double compact = 0;
  double area = 0;
  for (const auto& m : measures)
  {
    area += m.area;
    compact += m.solidity >= micrograph::compactSolidity ? m.area : 0;
  }
  constexpr double most = 0.8; // of their area, as of lumens in a scan
  return (!micrograph.segmentation || micrograph.segmentation->cells) && compact >= most * area;
}

Json segmentationJson(const micrograph::SegmentReport& r)
{
  return { { "channel", r.channel }, { "weights", r.weights }, { "lumen", r.brightLumen ? "bright" : "dark" },
    { "background", r.background }, { "unevenness", r.unevenness }, { "noise", r.noise }, { "smoothing", r.smoothing },
    { "threshold", r.threshold }, { "separability", r.separability }, { "smallest_lumen", r.smallestLumen },
    { "smallest_wall", r.smallestWall }, { "lumens_removed", r.lumensRemoved }, { "walls_removed", r.wallsRemoved },
    { "opening", r.opening }, { "neck_nodes", r.neckNodes }, { "rim", r.rim }, { "rim_depth", r.rimDepth },
    { "rim_channel", r.rimChannel }, { "half_height", r.halfHeight }, { "edge_blur", r.edgeBlur },
    { "surface_doubt", r.surfaceDoubt }, { "ray_gaps", r.rays }, { "graphics_share", r.graphicsShare },
    { "vessels", r.vessels }, { "lumens", r.lumens }, { "lumen_fraction", r.lumenFraction }, { "cells", r.cells },
    { "doubts", r.doubtNames() }, { "lines", r.lines() } };
}

namespace
{

Json contoursJson(const Micrograph& m)
{
  std::int64_t points = 0;
  for (const auto& contour : m.contours.contours)
    points += static_cast<std::int64_t>(contour.points.size());
  Json contours{ { "chains", m.contours.contours.size() }, { "points", points } };
  if (m.picture != nullptr)
  {
    const auto number = [&](const char* name) { return fieldNumbers(m.outlines, name).at(0); };
    for (const auto& [key, name] : { std::pair{ "islands", "islands" }, std::pair{ "nested_lumens", "nested_lumens" },
           std::pair{ "small", "small_lumens" }, std::pair{ "ragged", "ragged_lumens" } })
      contours[key] = std::llround(number(name));
    contours["area_missing"] = number("area_missing") * m.pixel * m.pixel;
  }
  return contours;
}

Json diffusionJson(const MicrographReport& report)
{
  Json diffusion;
  for (const auto& [name, value] : report.found.conductivity)
    diffusion["conductivity"][name] = value;
  for (const lbm::ContourAnswer& a : report.found.answers)
  {
    Json& axis = diffusion["axes"][axisNames[static_cast<std::size_t>(a.axis)]];
    axis = { { "value", a.value }, { "error", jsonNumber(a.error * a.value) },
      { "relative_error", jsonNumber(a.error) }, { "lattice_error", a.latticeError },
      { "picture_error", jsonNumber(a.pictureError) }, { "fine", jsonOf(a.fine) }, { "coarse", jsonOf(a.coarse) },
      { "balance", a.result.balance }, { "seconds", a.seconds } };
    for (const lbm::ContourStep& step : a.steps)
      axis["steps"].push_back(jsonOf(step));
    if (report.micrograph->kind == MicrographKind::Scan)
      axis["segmentation_doubt"] = std::abs(a.moved);
    if (!a.coarser.empty())
      axis["border_doubt"] = std::abs(a.sealed);
    for (const SubsampleValues& c : a.coarser)
      axis["coarser_pictures"].push_back({ { "stride", std::lround(c.stride) }, { "values", c.values } });
  }
  return diffusion;
}

Json lamellaJson(const LamellaReport& l)
{
  Json json{ { "method", l.method }, { "thickness", l.thickness }, { "radius", l.radius }, { "horizon", l.horizon },
    { "nodes_across", { { "mean", l.mean }, { "low", l.low } } }, { "wall_share", l.wallShare } };
  if (l.method != "labels")
  {
    json.update({ { "networks", l.networks }, { "largest_network", l.largestNetwork }, { "cells", l.cells },
      { "cells_touched", l.cellsTouched }, { "cells_cut_off", l.cellsCutOff } });
  }
  return json;
}

} // namespace

std::string toJson(const MicrographReport& report)
{
  const Micrograph& m = *report.micrograph;
  Json json;
  json["file"] = report.file;
  json["kind"] = kinds[static_cast<std::size_t>(m.kind)];
  json["picture"] = { { "width", m.contours.size[0] }, { "height", m.contours.size[1] } };
  if (m.pixel > 0)
  {
    json["pixels"] = { m.size[0], m.size[1] };
    json["pixel_size"] = m.pixel;
    json["pixel_size_source"] = m.pixelSizeSource;
  }
  else
  {
    json["unit"] = m.unit;
  }
  if (m.segmentation)
    json["segmentation"] = segmentationJson(*m.segmentation);
  json["contours"] = contoursJson(m);
  json["lumens"] = jsonOf(numbersOf(
    report, [](std::size_t) { return true; }));
  json["lumens"]["open"] =
    std::count_if(report.measures.begin(), report.measures.end(), [](const auto& l) { return l.open; });
  std::vector<double> solidity;
  for (const auto& l : report.measures)
    solidity.push_back(l.solidity);
  json["lumens"]["median_solidity"] = median(std::move(solidity));
  json["cells"] = report.cells;
  if (report.classes.two)
  {
    json["vessels"] = jsonOf(numbersOf(report, [&](std::size_t i) { return report.classes.vessel[i]; }));
    json["vessels"]["longer_than"] = std::sqrt(report.classes.threshold * 4 / std::numbers::pi);
    json["vessels"]["separability"] = report.classes.separability;
    json["fibres"] = jsonOf(numbersOf(report, [&](std::size_t i) { return !report.classes.vessel[i]; }));
  }
  else
  {
    json["vessels"] = nullptr;
  }
  json["wall_fraction"] = report.wallFraction;
  json["wall_thickness"] = { { "median", report.thickness.median }, { "low", report.thickness.low } };
  Json& lattice = json["lattice"];
  lattice["size"] = { report.size[0], report.size[1] };
  lattice["spacing"] = report.spacing;
  lattice["cropped"] = report.cropped;
  lattice["wall_nodes"] = report.wallNodes;
  lattice["wall_fraction"] = report.wallFractionOnLattice;
  lattice["nodes_across_wall"] = { { "median", report.thickness.median / report.spacing },
    { "low", report.thickness.low / report.spacing } };
  lattice["phases"] = phasesJson(report.phases, report.fractions);
  lattice["seconds"] = report.latticeSeconds;
  json["lamella"] = report.lamella ? lamellaJson(*report.lamella) : Json(nullptr);
  if (!report.found.answers.empty())
    json["diffusion"] = diffusionJson(report);
  json["files"] = report.written;
  json["warnings"] = report.warnings;
  json["seconds"] = report.seconds;
  addRecord(json, report.provenance);
  return dump(json);
}

std::string toTable(const MicrographReport& report)
{
  const Micrograph& m = *report.micrograph;
  const auto& size = m.contours.size;
  std::string text = fmt::format("{}: {}, {}\n\n", report.file, kinds[static_cast<std::size_t>(m.kind)],
    m.pixel > 0 ? fmt::format("{} pixels of {}", sizeText(m.size, 2), micrometres(m.pixel))
                : fmt::format("{} × {}", micrometres(size[0]), micrometres(size[1])));
  const auto line = [&](const char* name, const std::string& value)
  { text += fmt::format("  {:<13} {}\n", name, value); };
  if (m.segmentation)
  {
    const auto& s = *m.segmentation;
    line("segmentation",
      fmt::format("{}, lumens are {}, threshold {:.0f}, separability {:.3f}", s.channel,
        s.brightLumen ? "bright" : "dark", s.threshold, s.separability));
    std::string more = s.rim > 0 ? fmt::format("outlines moved by {:.2f} pixels onto the dark rim", s.rim) : "";
    const auto add = [&](bool there, const std::string& what)
    {
      if (there)
        more += (more.empty() ? "" : ", ") + what;
    };
    add(s.rays > 0, fmt::format("{} gaps in rays closed", s.rays));
    add(s.graphicsShare > 0, fmt::format("{} painted over", percentText(s.graphicsShare)));
    if (!more.empty())
      line("", more);
  }
  const auto open = std::count_if(report.measures.begin(), report.measures.end(), [](const auto& l) { return l.open; });
  const auto of = [&](const std::function<bool(std::size_t)>& belongs)
  {
    const ClassNumbers n = numbersOf(report, belongs);
    return fmt::format("{}, diameter {} (median), {} of the picture", grouped(n.count), micrometres(n.diameter),
      percentText(n.areaShare));
  };
  line("lumens",
    of([](std::size_t) { return true; }) + (open > 0 ? fmt::format("; {} cut by the border", grouped(open)) : ""));
  if (report.classes.two)
  {
    line(report.cells ? "vessels" : "large pores", of([&](std::size_t i) { return report.classes.vessel[i]; }));
    line(report.cells ? "fibres" : "small pores", of([&](std::size_t i) { return !report.classes.vessel[i]; }));
  }
  line("walls",
    fmt::format("{} of the picture, {} thick (median), thinner than {} in 5 % of their length",
      percentText(report.wallFraction), micrometres(report.thickness.median), micrometres(report.thickness.low)));
  line("lattice",
    fmt::format("{} nodes of {}, {} in walls, {:.3g} across them (median){}", sizeText(report.size, 2),
      micrometres(report.spacing), grouped(report.wallNodes), report.thickness.median / report.spacing,
      report.cropped > 1e-6 * report.spacing ? fmt::format("; {} at the top cut off", micrometres(report.cropped))
                                             : ""));
  if (report.lamella)
  {
    const LamellaReport& l = *report.lamella;
    line("lamella",
      fmt::format("{}{}, {:.3g} nodes across (5 % of it {:.3g} or less), {} of the walls{}{}", l.method,
        l.thickness > 0 ? " of " + micrometres(l.thickness) : "", l.mean, l.low, percentText(l.wallShare),
        l.cells > 0 ? fmt::format(", touches {} of {} cells", l.cellsTouched, l.cells) : "",
        l.cellsCutOff > 0 ? fmt::format(" ({} across the picture's border)", l.cellsCutOff) : ""));
  }
  for (const lbm::ContourAnswer& a : report.found.answers)
  {
    line(a.axis == report.found.answers.front().axis ? "conductivity" : "",
      fmt::format("{}  {:.6g} ± {}, {:.6g} at {} and {:.6g} at {}, {:.2f} s",
        axisNames[static_cast<std::size_t>(a.axis)], a.value, errorText(a, m.pixel > 0), a.coarse.value,
        micrometres(a.coarse.spacing), a.fine.value, micrometres(a.fine.spacing), a.seconds));
  }
  text += wroteText(report.written);
  return text;
}

} // namespace lamella::cli
