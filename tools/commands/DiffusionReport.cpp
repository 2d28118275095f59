#include "commands/DiffusionReport.h"

#include "commands/SensitivityReport.h"
#include "commands/WindowReport.h"
#include "files/JsonReport.h"
#include "files/Record.h"
#include "micrograph/MicrographReport.h"
#include "session/Text.h"

#include "core/Memory.h"

#include <fmt/format.h>

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace lamella::cli
{

namespace
{

double own(const lbm::DiffusionAnswer& answer)
{
  return answer.result.effective[static_cast<std::size_t>(answer.axis)];
}

Json stepsJson(const lbm::DiffusionAnswer& answer)
{
  Json steps = Json::array();
  for (const auto& step : answer.steps)
  {
    steps.push_back({ { "refine", step.refinement }, { "value", jsonNumber(step.value) }, { "nodes", step.nodes },
      { "iterations", step.iterations }, { "seconds", step.seconds }, { "part_of_sample", step.sampled },
      { "every_pixel", step.every }, { "parts", step.parts }, { "pictures", step.pictures },
      { "scatter", jsonNumber(step.scatter) } });
  }
  return steps;
}

/// By id of the findings.
const std::vector<std::string>& phaseNames(const DiffusionReport& report)
{
  return report.found.shares ? report.found.phases : report.sample->image.phases.names();
}

constexpr std::array ordinals{ "", "first", "second", "third", "fourth" };

/// How a volume was segmented; greys as in its file, lengths in voxels.
Json jsonOf(const micrograph::VolumeReport& found)
{
  Json json{ { "polarity", found.polarity.empty() ? Json(nullptr) : Json(found.polarity) },
    { "unevenness", found.unevenness }, { "flattened", found.flattened }, { "smoothing", found.smoothing },
    { "separability_before", found.separabilityBefore }, { "noise_left", found.noiseLeft }, { "levels", found.levels },
    { "means", found.means }, { "separability", found.separability }, { "valley", found.valley },
    { "smallest", found.smallest }, { "specks", found.specks }, { "speck_voxels", found.speckVoxels },
    { "shell_voxels", found.shellVoxels }, { "surface_doubt", found.surfaceDoubt } };
  json["phases"] = Json::array();
  for (std::size_t id = 0; id < found.phases.size(); ++id)
  {
    json["phases"].push_back({ { "name", found.phases[id] }, { "fraction", found.shares[id] },
      { "fraction_error", found.shareError[id] }, { "thickness", found.thickness[id] } });
  }
  return json;
}

} // namespace

std::uint64_t peakMemoryBytes()
{
  struct rusage usage = {};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024; // Linux counts kilobytes
}

namespace
{

/// By direction and phase: ∂K/∂k, and what the phases' uncertainty leaves, relative; by direction and pair of phases
/// how the value changes where the first grows into the second by a pixel, and what the doubt about surfaces leaves.
/// null where that was not asked for.
void addSensitivity(Json& json, const SteadyFindings& found)
{
  for (const char* const name :
    { "sensitivity", "input_errors", "surface_sensitivity", "segmentation_errors", "total_errors" })
    json[name] = nullptr;
  json["surface_doubt"] = jsonNumber(found.surfaceDoubt);
  for (const auto& answer : found.answers)
  {
    const char* const axis = axisNames[answer.axis];
    for (const bool other : { false, true })
    {
      const auto& by = other ? answer.derivatives.across : answer.derivatives.along;
      for (std::size_t id = 0; id < by.size(); ++id)
        if (found.fractions[id] > 0 && (!other || std::isfinite(by[id])))
          json["sensitivity"][axis][found.phases[id] + (other ? ":across" : "")] = jsonNumber(by[id]);
    }
    if (const double error = found.inputError(answer); !std::isnan(error))
      json["input_errors"][axis] = jsonNumber(error);
    if (const double error = found.segmentationError(answer); !std::isnan(error))
    {
      json["segmentation_errors"][axis] = jsonNumber(error);
      const std::size_t ids = found.conductivity.size();
      for (std::size_t a = 0; a < ids; ++a)
        for (std::size_t b = a + 1; b < ids; ++b)
          if (const std::size_t pair = a * ids + b; answer.surfaces.area[pair] > 0)
            json["surface_sensitivity"][axis][found.phases[a] + ":" + found.phases[b]] =
              jsonNumber(answer.surfaces.shift[pair]);
    }
    if (found.tellsParts())
      json["total_errors"][axis] = jsonNumber(found.totalError(answer));
  }
}

/// Of each pair of phases with a resistance between them; null where there is none.
void addMembranes(Json& json, const SteadyFindings& found)
{
  json["membranes"] = nullptr;
  for (const FoundMembrane& membrane : found.membranes)
  {
    Json one{ { "name", membrane.name }, { "resistance", membrane.resistance }, { "area", membrane.area },
      { "sensitivity", nullptr } };
    for (const auto& answer : found.answers)
      if (const double by = found.membraneSensitivity(answer, membrane); !std::isnan(by))
        one["sensitivity"][axisNames[answer.axis]] = by;
    json["membranes"].push_back(one);
  }
}

/// How far the picture speaks for its material, by direction; null where it was not asked for.
void addWindow(Json& json, const SteadyFindings& found)
{
  json["window_error"] = jsonNumber(found.windowError());
  json["window_errors"] = nullptr;
  if (!found.windows)
    return;
  json["window_errors"] = Json::object();
  for (const auto& answer : found.answers)
    if (answer.window)
      json["window_errors"][axisNames[answer.axis]] = windowJson(*answer.window);
}

void addValues(Json& json, const DiffusionReport& report)
{
  for (const auto& answer : report.found.answers)
  {
    const char* const axis = axisNames[answer.axis];
    json["effective"][axis] = jsonNumber(own(answer));
    json["extrapolated"][axis] = jsonNumber(answer.error.extrapolated);
  }
  const std::optional<std::size_t> alone = report.found.conductingPhase();
  json["conducting_phase"] = alone ? Json(report.found.phases[*alone]) : Json(nullptr);
  for (const auto& answer : report.found.answers)
  {
    const char* const axis = axisNames[answer.axis];
    json["relative"][axis] = jsonNumber(report.found.relative(answer));
    json["formation_factor"][axis] = jsonNumber(1 / report.found.relative(answer));
    json["tortuosity_factor"][axis] = jsonNumber(report.found.tortuosityFactor(answer));
  }
  for (const auto& [key, kind] : { std::pair{ "estimated_error", &ErrorEstimate::relative },
         std::pair{ "lattice_error", &ErrorEstimate::lattice }, std::pair{ "picture_error", &ErrorEstimate::picture } })
  {
    json[key] = jsonNumber(report.found.error(kind));
    for (const auto& answer : report.found.answers)
      json[std::string(key) + "s"][axisNames[answer.axis]] = jsonNumber(answer.error.*kind);
  }
  addSensitivity(json, report.found);
  addMembranes(json, report.found);
  addWindow(json, report.found);
  const bool aimed = report.found.targetError > 0;
  json["target_error"] = aimed ? Json(report.found.targetError) : Json(nullptr);
  json["target"] = aimed ? Json(lbm::name(report.found.answers.front().target)) : Json(nullptr);
  const auto tensor = report.found.tensor();
  const int dimension = report.sample->image.lattice.dimension;
  json["tensor"] = Json::array();
  for (int row = 0; row < dimension; ++row)
  {
    Json line = Json::array();
    for (int column = 0; column < dimension; ++column)
    {
      // Between insulated sides the mean flux across the gradient is the box's, not the material's.
      const bool known = row == column || report.found.sides == "periodic";
      line.push_back(known ? jsonNumber(tensor[static_cast<std::size_t>(3 * row + column)]) : Json(nullptr));
    }
    json["tensor"].push_back(line);
  }
  json["bounds"] = { { "series", report.found.bounds.series }, { "parallel", report.found.bounds.parallel },
    { "hashin_shtrikman", { report.found.bounds.hashinShtrikmanLower, report.found.bounds.hashinShtrikmanUpper } } };
}

/// What solving took, of all directions and of each.
void addCost(Json& json, const DiffusionReport& report)
{
  int iterations = 0;
  double setup = 0;
  double solve = 0;
  double balance = 0;
  double solverError = 0;
  std::uint64_t solverBytes = 0;
  for (const auto& answer : report.found.answers)
  {
    const auto& result = answer.result;
    iterations += result.iterations;
    setup += result.setupSeconds;
    solve += result.solveSeconds;
    balance = std::max(balance, result.balance);
    solverError = std::max(solverError, result.solverError);
    solverBytes = std::max(solverBytes, result.bytes);
    json["directions"][axisNames[answer.axis]] = { { "iterations", result.iterations },
      { "balance", jsonNumber(result.balance) }, { "solver_error", jsonNumber(result.solverError) },
      { "inlet", jsonNumber(result.inletFlux) }, { "outlet", jsonNumber(result.outletFlux) },
      { "residual", jsonNumber(result.residual) }, { "setup_seconds", result.setupSeconds },
      { "solve_seconds", result.solveSeconds }, { "solver_bytes", result.bytes }, { "nodes", result.nodes },
      { "stored", result.stored }, { "skipped", result.skipped }, { "refine", answer.refinement },
      { "steps", stepsJson(answer) } };
  }
  const auto& first = report.found.answers.front().result;
  json.update({ { "iterations", iterations }, { "seconds", report.seconds }, { "setup_seconds", setup },
    { "solve_seconds", solve }, { "peak_memory_bytes", report.peakMemory }, { "method", lbm::name(first.method) },
    { "balance", jsonNumber(balance) }, { "solver_error", jsonNumber(solverError) }, { "nodes", first.nodes },
    { "stored", first.stored }, { "skipped", first.skipped }, { "solver_bytes", solverBytes } });
}

} // namespace

std::string toJson(const DiffusionReport& report)
{
  const Lattice& lattice = report.sample->image.lattice;
  const int dimension = lattice.dimension;
  Json json;
  addValues(json, report);
  addCost(json, report);
  json["phases"] = Json::array();
  for (std::size_t id = 0; id < phaseNames(report).size(); ++id)
  {
    const bool there = id < report.found.fractions.size();
    const double share = there ? report.found.fractions[id] : 0;
    const double value = there ? report.found.conductivity[id] : 0; // 0 also where none was given, and no node either
    json["phases"].push_back({ { "name", phaseNames(report)[id] }, { "fraction", share },
      { "conductivity", share > 0 || value > 0 ? jsonNumber(value) : Json(nullptr) } });
    if (there && !report.found.across.empty())
      json["phases"].back()["conductivity_across"] = jsonNumber(report.found.across[id]);
    if (there && report.found.general(id))
      json["phases"].back()["conductivity_tensor"] = report.found.tensors[id];
  }
  json["file"] = report.file;
  json["size"] = std::vector<std::int64_t>(lattice.size.begin(), lattice.size.begin() + dimension);
  json["window"] = nullptr;
  if (const auto& w = report.sample->window)
  {
    json["window"] = dimension == 3 ? Json{ w->start[0], w->start[1], w->start[2], w->size[0], w->size[1], w->size[2] }
                                    : Json{ w->start[0], w->start[1], w->size[0], w->size[1] };
  }
  const bool known = report.sample->pixelSizeSource != "none";
  json["pixel_size"] = known ? Json(lattice.spacing) : Json(nullptr);
  json["conductivity_rounding"] = report.found.rounding ? Json(*report.found.rounding) : Json(nullptr);
  json["slice_distance"] = known && dimension == 3 ? Json(lattice.spacingAlong(2)) : Json(nullptr);
  json["pixel_size_source"] = report.sample->pixelSizeSource;
  json["warnings"] = report.sample->warnings;
  if (report.sample->segmentation)
    json["segmentation"] = segmentationJson(*report.sample->segmentation);
  if (report.sample->volumeSegmentation)
    json["segmentation"] = jsonOf(*report.sample->volumeSegmentation);
  json["refine"] = report.found.answers.front().refinement;
  json["lattice"] = lbm::name(report.found.stencil);
  json["sides"] = report.found.sides;
  json["length"] =
    "one spacing a node; faces half a spacing outside the outer nodes; an empty box of conductivity 1 has 1";
  json["tolerance"] = report.found.tolerance;
  json["threads"] = report.threads;
  json["ranks"] = report.ranks;
  json["files"] = report.written;
  addRecord(json, report.provenance);
  return dump(json);
}

namespace
{

/// Edges of a voxel [µm]; of a cube one.
std::string voxelText(const Lattice& lattice)
{
  const auto edge = [&](int axis) { return fmt::format("{:.6g}", lattice.spacingAlong(axis) * 1e6); };
  if (lattice.cubes())
    return edge(0);
  return edge(0) + " × " + edge(1) + (lattice.dimension == 3 ? " × " + edge(2) : "");
}

/// What it took to come to the target.
std::string stepsText(const DiffusionReport& report)
{
  std::string text = fmt::format("\n  what an error below {} took\n", percent(report.found.targetError));
  double total = 0;
  for (const auto& answer : report.found.answers)
  {
    for (const auto& step : answer.steps)
    {
      text += fmt::format("    {}  refine {:<3} {:<10.7g}  {:>13} nodes  {:.2f} s{}\n", axisNames[answer.axis],
        step.refinement, step.value, grouped(step.nodes), step.seconds,
        step.every > 1
          ? fmt::format("  every {} pixel, {} pictures", ordinals[static_cast<std::size_t>(step.every)], step.pictures)
          : "");
      total += step.seconds;
    }
  }
  return text + fmt::format("    {:.2f} s in all\n", total);
}

} // namespace

namespace
{

std::string phasesText(const DiffusionReport& report)
{
  std::size_t width = 5;
  for (const std::string& phase : phaseNames(report))
    width = std::max(width, phase.size());
  std::string text = fmt::format("  {:<{}}   share    conductivity\n", "phase", width);
  for (std::size_t id = 0; id < report.found.fractions.size(); ++id)
  {
    if (report.found.fractions[id] > 0)
    {
      text += fmt::format("  {:<{}}  {:.5f}  {:g}", phaseNames(report)[id], width, report.found.fractions[id],
        report.found.conductivity[id]);
      if (!report.found.across.empty() && report.found.across[id] != report.found.conductivity[id])
        text += fmt::format(" along the walls, {:g} across", report.found.across[id]);
      if (report.found.general(id))
      {
        const auto& t = report.found.tensors[id];
        text += report.found.dimension == 2
          ? fmt::format(" at the most; xx {:.6g}, yy {:.6g}, xy {:.6g}", t[0], t[1], t[3])
          : fmt::format(" at the most; xx {:.6g}, yy {:.6g}, zz {:.6g}, xy {:.6g}, yz {:.6g}, xz {:.6g}", t[0], t[1],
              t[2], t[3], t[4], t[5]);
      }
      text += "\n";
    }
  }
  width = 8;
  for (const FoundMembrane& membrane : report.found.membranes)
    width = std::max(width, membrane.name.size());
  if (!report.found.membranes.empty())
    text += fmt::format("\n  {:<{}}  resistance  {} [1/µm]\n", "membrane", width,
      report.found.dimension == 3 ? "surface over volume" : "length over area");
  for (const FoundMembrane& membrane : report.found.membranes)
    text += fmt::format("  {:<{}}  {:<10g}  {:.4g}\n", membrane.name, width, membrane.resistance, membrane.area * 1e-6);
  return text;
}

/// Of conductivities between greys: what there is of them.
std::string greysText(const DiffusionReport& report)
{
  const SteadyFindings& found = report.found;
  double low = std::numeric_limits<double>::infinity();
  double high = 0;
  int greys = 0;
  for (std::size_t id = 0; id < found.fractions.size(); ++id)
    if (found.fractions[id] > 0)
    {
      low = std::min(low, found.conductivity[id]);
      high = std::max(high, found.conductivity[id]);
      ++greys;
    }
  const bool binned = *found.rounding > 0;
  return fmt::format("  {} {} of greys, conductivity from {:g} to {:g}, mean {:.6g}{}\n", greys,
    binned ? "bins" : "values", low, high, found.bounds.parallel,
    binned ? fmt::format("; a bin is within {} of its greys'", percent(*found.rounding)) : "");
}

} // namespace

namespace
{

/// By direction: what a change of a conductivity by 1 % does to the value, and what the conductivities' own uncertainty
/// leaves of it.
std::string sensitivitiesText(const DiffusionReport& report)
{
  const SteadyFindings& found = report.found;
  std::string text;
  for (const auto& answer : found.answers)
  {
    Sensitivity one{ axisNames[answer.axis], {}, {} };
    for (const bool other : { false, true })
    {
      const auto& by = other ? answer.derivatives.across : answer.derivatives.along;
      const auto& values = other ? found.across : found.conductivity;
      for (std::size_t id = 0; id < by.size(); ++id)
      {
        if (!(found.fractions[id] > 0) || std::isnan(by[id]))
          continue;
        const std::string name = found.phases[id] + (other ? " across" : "");
        one.changes.emplace_back(name, by[id] * values[id] / own(answer));
        one.inputs.emplace_back(name, found.inputError(answer, id, other));
      }
    }
    for (const FoundMembrane& membrane : found.membranes)
      if (const double by = found.membraneSensitivity(answer, membrane); !std::isnan(by))
        one.changes.emplace_back("membrane " + membrane.name, by * membrane.resistance / own(answer));
    text += sensitivityText(one, 1, "the conductivities'");
  }
  return text.empty() ? text
                      : fmt::format("  1 % more of a conductivity {}changes the value by\n",
                          found.membranes.empty() ? "" : "or a resistance ") +
      text;
}

/// By direction: what moving surfaces does to the value, and what the doubt about them leaves.
std::string surfacesText(const DiffusionReport& report)
{
  const SteadyFindings& found = report.found;
  if (std::isnan(found.surfaceDoubt))
    return "";
  std::string text = fmt::format(
    "  surfaces within {:.2g} pixels of where the picture has them change the value by\n", found.surfaceDoubt);
  for (const auto& answer : found.answers)
    text += fmt::format("    {}  {}\n", axisNames[answer.axis], percent(found.segmentationError(answer)));
  return text;
}

/// The whole error of each value, where more than that of lattice and picture was asked for.
std::string totalsText(const DiffusionReport& report)
{
  const SteadyFindings& found = report.found;
  if (!found.tellsParts())
    return "";
  std::string text;
  for (const auto& answer : found.answers)
    text += totalText({ axisNames[answer.axis], 1, own(answer), "" }, found.errorParts(answer), found.surfaceDoubt);
  return text.empty() ? text : totalHeading + text;
}

} // namespace

std::string toTable(const DiffusionReport& report)
{
  const Lattice& lattice = report.sample->image.lattice;
  const int refinement = report.found.answers.front().refinement;
  std::string text = fmt::format(
    "{}: {} {}", report.file, sizeText(lattice.size, lattice.dimension), lattice.dimension == 3 ? "voxels" : "pixels");
  text +=
    report.sample->pixelSizeSource == "none" ? ", pixel size unknown" : fmt::format(" of {} µm", voxelText(lattice));
  text += refinement > 1
    ? fmt::format(", each split into {}\n\n",
        lattice.dimension == 3 ? fmt::format("{0} × {0} × {0}", refinement) : fmt::format("{0} × {0}", refinement))
    : "\n\n";

  for (const std::string& line : report.sample->notes)
    text += "  " + line + "\n";
  text += report.sample->notes.empty() ? "" : "\n";
  text += report.found.rounding ? greysText(report) : phasesText(report);

  const bool known = report.estimated && !report.found.shares; // where they are shares, one error for both
  text += fmt::format("\n  effective conductivity      error     {}from series (0 %) to parallel (100 %)\n",
    known ? "lattice   picture   " : "");
  for (const auto& answer : report.found.answers)
  {
    const double span = report.found.bounds.parallel - report.found.bounds.series;
    text += fmt::format("    {}  {:<20.7g}  {:<8}  ", axisNames[answer.axis], own(answer),
      report.estimated ? percent(answer.error.relative) : "-");
    if (known)
      text += fmt::format("{:<8}  {:<8}  ", percent(answer.error.lattice), percent(answer.error.picture));
    text += span > 0 ? fmt::format("{:.1f} %\n", 100 * (own(answer) - report.found.bounds.series) / span) : "-\n";
  }
  const bool nearer = std::ranges::any_of(
    report.found.answers, [](const auto& answer) { return std::isfinite(answer.error.extrapolated); });
  if (nearer)
  {
    text += "  expected of the material, from how the value changes with the pixel\n";
    for (const auto& answer : report.found.answers)
      if (std::isfinite(answer.error.extrapolated))
        text += fmt::format("    {}  {:.5g}\n", axisNames[answer.axis], answer.error.extrapolated);
  }
  if (std::ranges::any_of(report.found.answers, [](const auto& answer) { return answer.window.has_value(); }))
  {
    text += windowHeading;
    for (const auto& answer : report.found.answers)
      if (answer.window)
        text += windowText(axisNames[answer.axis], *answer.window, "", 1);
  }
  if (const std::optional<std::size_t> alone = report.found.conductingPhase())
  {
    text += fmt::format(
      "  relative to {}, which alone conducts; formation factor; tortuosity factor\n", report.found.phases[*alone]);
    for (const auto& answer : report.found.answers)
      text += fmt::format("    {}  {:<20.7g}  {:<8.5g}  {:.5g}\n", axisNames[answer.axis],
        report.found.relative(answer), 1 / report.found.relative(answer), report.found.tortuosityFactor(answer));
  }
  text += report.found.rounding ? "" : sensitivitiesText(report);
  text += surfacesText(report);
  text += totalsText(report);
  text +=
    fmt::format("  bounds\n    series {:.7g}   parallel {:.7g}   Hashin-Shtrikman (isotropic media) {:.7g} to {:.7g}\n",
      report.found.bounds.series, report.found.bounds.parallel, report.found.bounds.hashinShtrikmanLower,
      report.found.bounds.hashinShtrikmanUpper);

  if (report.found.targetError > 0)
    text += stepsText(report);
  const double picture = report.found.error(&ErrorEstimate::picture);
  if (picture > 0.005 && picture >= report.found.error(&ErrorEstimate::lattice) && report.found.outlinesServe())
  {
    text += "\n  Most of the error is the pixels' own steps. Outlines through them err less: lamella micrograph with\n"
            "  the same --conductivity.\n";
  }
  std::string iterations;
  double solve = 0;
  for (const auto& answer : report.found.answers)
  {
    iterations += (iterations.empty() ? "" : " + ") + std::to_string(answer.result.iterations);
    solve += answer.result.setupSeconds + answer.result.solveSeconds;
  }
  const auto& first = report.found.answers.front().result;
  text += fmt::format("\n  {}, {}, {} sides; {} iterations, {:.3f} s (everything: {:.2f} s, {})\n",
    lbm::name(report.found.stencil), lbm::name(first.method), report.found.sides, iterations, solve, report.seconds,
    bytesText(static_cast<double>(report.peakMemory)));
  text += fmt::format(
    "  {} nodes, of which {} were skipped because they do not conduct\n", grouped(first.nodes), grouped(first.skipped));
  text += report.found.sides == "periodic"
    ? "  Length: one spacing a node. An empty box of conductivity 1 has 1.\n"
    : "  Length: one spacing a node; the faces lie half a spacing outside the outer nodes. An empty box of\n"
      "  conductivity 1 has 1.\n";
  text += wroteText(report.written);
  return text;
}

} // namespace lamella::cli
