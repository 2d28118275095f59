#include "DiffusionReport.h"

#include "DiffusionRun.h"
#include "JsonReport.h"
#include "Record.h"
#include "Text.h"

#include "lattice/Memory.h"

#include <fmt/format.h>

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lamella::cli
{

namespace
{

/// JSON has no NaN and no infinity.
Json number(double value)
{
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

double own(const lbm::DiffusionAnswer& answer)
{
  return answer.result.effective[static_cast<std::size_t>(answer.axis)];
}

const char* name(lbm::Sides sides)
{
  return sides == lbm::Sides::Periodic ? "periodic" : "insulated";
}

double worstError(const DiffusionReport& report)
{
  double worst = std::numeric_limits<double>::quiet_NaN();
  for (const auto& answer : report.answers)
  {
    worst = std::isnan(worst) || answer.error.relative > worst ? answer.error.relative : worst;
  }
  return worst;
}

Json stepsJson(const lbm::DiffusionAnswer& answer)
{
  Json steps = Json::array();
  for (const auto& step : answer.steps)
  {
    steps.push_back({ { "refine", step.refinement }, { "value", number(step.value) }, { "nodes", step.nodes },
      { "iterations", step.iterations }, { "seconds", step.seconds }, { "part_of_sample", step.sampled } });
  }
  return steps;
}

std::string percent(double share)
{
  return std::isfinite(share) ? fmt::format("{:.2g} %", 100 * share) : "unknown";
}

} // namespace

std::uint64_t peakMemoryBytes()
{
  struct rusage usage = {};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024; // Linux counts kilobytes
}

int refinementOf(const lbm::DiffusionAnswer& answer)
{
  // The value is that of the last solve of all nodes that the result counts.
  for (const auto& step : answer.steps)
  {
    if (!step.sampled && step.nodes == answer.result.nodes)
    {
      return step.refinement;
    }
  }
  return answer.steps.empty() ? 1 : answer.steps.front().refinement;
}

std::array<double, 9> tensorOf(const std::vector<lbm::DiffusionAnswer>& answers, int dimension)
{
  std::array<double, 9> tensor{};
  tensor.fill(std::numeric_limits<double>::quiet_NaN());
  for (const auto& answer : answers)
  {
    for (int row = 0; row < dimension; ++row)
    {
      tensor[static_cast<std::size_t>(3 * row + answer.axis)] = answer.result.effective[static_cast<std::size_t>(row)];
    }
  }
  return tensor;
}

std::string toJson(const DiffusionReport& report)
{
  const Lattice& lattice = report.sample->image.lattice;
  const int dimension = lattice.dimension;
  const int refinement = refinementOf(report.answers.front());
  Json json;
  Json effective;
  Json extrapolated;
  Json errors;
  for (const auto& answer : report.answers)
  {
    const char* axis = axisNames[answer.axis];
    effective[axis] = number(own(answer));
    extrapolated[axis] = number(answer.error.extrapolated);
    errors[axis] = number(answer.error.relative);
  }
  json["effective"] = std::move(effective);
  json["extrapolated"] = std::move(extrapolated);
  json["estimated_errors"] = std::move(errors);
  json["estimated_error"] = number(worstError(report));
  const auto tensor = tensorOf(report.answers, dimension);
  json["tensor"] = Json::array();
  for (int row = 0; row < dimension; ++row)
  {
    Json line = Json::array();
    for (int column = 0; column < dimension; ++column)
    {
      // Between insulated sides the mean flux across the gradient is the box's, not the material's.
      const bool known = row == column || report.options.steady.sides == lbm::Sides::Periodic;
      line.push_back(known ? number(tensor[static_cast<std::size_t>(3 * row + column)]) : Json(nullptr));
    }
    json["tensor"].push_back(line);
  }
  json["bounds"] = { { "series", report.bounds.series }, { "parallel", report.bounds.parallel },
    { "hashin_shtrikman", { report.bounds.hashinShtrikmanLower, report.bounds.hashinShtrikmanUpper } } };

  int iterations = 0;
  double setup = 0;
  double solve = 0;
  double balance = 0;
  double solverError = 0;
  std::uint64_t solverBytes = 0;
  for (const auto& answer : report.answers)
  {
    iterations += answer.result.iterations;
    setup += answer.result.setupSeconds;
    solve += answer.result.solveSeconds;
    balance = std::max(balance, answer.result.balance);
    solverError = std::max(solverError, answer.result.solverError);
    solverBytes = std::max(solverBytes, answer.result.bytes);
  }
  json["iterations"] = iterations;
  json["seconds"] = report.seconds;
  json["setup_seconds"] = setup;
  json["solve_seconds"] = solve;
  json["peak_memory_bytes"] = report.peakMemory;
  json["method"] = lbm::name(report.answers.front().result.method);

  Json directions;
  for (const auto& answer : report.answers)
  {
    const auto& result = answer.result;
    directions[axisNames[answer.axis]] = { { "iterations", result.iterations }, { "balance", number(result.balance) },
      { "solver_error", number(result.solverError) }, { "inlet", number(result.inletFlux) },
      { "outlet", number(result.outletFlux) }, { "residual", number(result.residual) },
      { "setup_seconds", result.setupSeconds }, { "solve_seconds", result.solveSeconds },
      { "solver_bytes", result.bytes }, { "nodes", result.nodes }, { "stored", result.stored },
      { "skipped", result.skipped }, { "refine", refinementOf(answer) },
      { "convergence_order", number(answer.error.order) }, { "steps", stepsJson(answer) } };
  }

  json["directions"] = std::move(directions);

  json["phases"] = Json::array();
  for (std::size_t id = 0; id < report.fractions.size(); ++id)
  {
    json["phases"].push_back({ { "name", report.sample->image.phases.names()[id] },
      { "fraction", report.fractions[id] }, { "conductivity", number(report.conductivity[id]) } });
    if (!report.across.empty())
    {
      json["phases"].back()["conductivity_across"] = number(report.across[id]);
    }
  }
  json["file"] = report.file;
  json["size"] = std::vector<std::int64_t>(lattice.size.begin(), lattice.size.begin() + dimension);
  if (report.sample->window)
  {
    const Window& w = *report.sample->window;
    json["window"] = dimension == 3 ? Json{ w.start[0], w.start[1], w.start[2], w.size[0], w.size[1], w.size[2] }
                                    : Json{ w.start[0], w.start[1], w.size[0], w.size[1] };
  }
  else
  {
    json["window"] = nullptr;
  }
  const bool known = report.sample->pixelSizeSource != "none";
  json["pixel_size"] = known ? Json(lattice.spacing) : Json(nullptr);
  json["pixel_size_source"] = report.sample->pixelSizeSource;
  if (report.sample->segmentation)
  {
    const micrograph::SegmentReport& found = *report.sample->segmentation;
    json["segmentation"] = { { "channel", found.channel }, { "bright_lumen", found.brightLumen },
      { "background", found.background }, { "smoothing", found.smoothing }, { "threshold", found.threshold },
      { "separability", found.separability }, { "smallest_lumen", found.smallestLumen },
      { "smallest_wall", found.smallestWall }, { "lumens_removed", found.lumensRemoved },
      { "walls_removed", found.wallsRemoved }, { "opening", found.opening }, { "rim", found.rim },
      { "half_height", found.halfHeight }, { "ray_gaps", found.rays }, { "graphics", found.graphicsShare },
      { "vessels", found.vessels }, { "lumens", found.lumens }, { "lumen_fraction", found.lumenFraction } };
  }
  json["refine"] = refinement;
  json["lattice"] = lbm::name(report.options.steady.stencil);
  json["sides"] = name(report.options.steady.sides);
  json["length"] =
    "one spacing a node; faces half a spacing outside the outer nodes; an empty box of conductivity 1 has 1";
  json["tolerance"] = report.options.steady.tolerance;
  json["balance"] = number(balance);
  json["solver_error"] = number(solverError);
  json["nodes"] = report.answers.front().result.nodes;
  json["stored"] = report.answers.front().result.stored;
  json["skipped"] = report.answers.front().result.skipped;
  json["solver_bytes"] = solverBytes;
  json["threads"] = report.options.steady.threads;
  json["ranks"] = report.ranks;
  json["files"] = report.written;
  addRecord(json, report.provenance);
  return dump(json);
}

std::string toTable(const DiffusionReport& report)
{
  const Lattice& lattice = report.sample->image.lattice;
  const int refinement = refinementOf(report.answers.front());
  std::string text = fmt::format(
    "{}: {} {}", report.file, sizeText(lattice.size, lattice.dimension), lattice.dimension == 3 ? "voxels" : "pixels");
  text += report.sample->pixelSizeSource == "none" ? ", pixel size unknown"
                                                   : fmt::format(" of {:g} µm", lattice.spacing * 1e6);
  text += refinement > 1
    ? fmt::format(", each split into {}\n\n",
        lattice.dimension == 3 ? fmt::format("{0} × {0} × {0}", refinement) : fmt::format("{0} × {0}", refinement))
    : "\n\n";

  if (report.sample->segmentation)
  {
    for (const std::string& line : report.sample->segmentation->lines())
    {
      text += "  " + line + "\n";
    }
    text += "\n";
  }
  std::size_t width = 5;
  for (const std::string& phase : report.sample->image.phases.names())
  {
    width = std::max(width, phase.size());
  }
  text += fmt::format("  {:<{}}   share    conductivity\n", "phase", width);
  for (std::size_t id = 0; id < report.fractions.size(); ++id)
  {
    if (report.fractions[id] > 0)
    {
      text += fmt::format("  {:<{}}  {:.5f}  {:g}", report.sample->image.phases.names()[id], width,
        report.fractions[id], report.conductivity[id]);
      if (!report.across.empty() && report.across[id] != report.conductivity[id])
      {
        text += fmt::format(" along the walls, {:g} across", report.across[id]);
      }
      text += "\n";
    }
  }

  text += "\n  effective conductivity      error     from series (0 %) to parallel (100 %)\n";
  for (const auto& answer : report.answers)
  {
    const double span = report.bounds.parallel - report.bounds.series;
    text += fmt::format("    {}  {:<20.7g}  {:<8}  {}\n", axisNames[answer.axis], own(answer),
      report.options.estimateError || report.options.targetError ? percent(answer.error.relative) : "-",
      span > 0 ? fmt::format("{:.1f} %", 100 * (own(answer) - report.bounds.series) / span) : "-");
  }
  text +=
    fmt::format("  bounds\n    series {:.7g}   parallel {:.7g}   Hashin-Shtrikman (isotropic media) {:.7g} to {:.7g}\n",
      report.bounds.series, report.bounds.parallel, report.bounds.hashinShtrikmanLower,
      report.bounds.hashinShtrikmanUpper);

  if (report.options.targetError)
  {
    text += fmt::format("\n  what an error below {} took\n", percent(*report.options.targetError));
    double total = 0;
    for (const auto& answer : report.answers)
    {
      for (const auto& step : answer.steps)
      {
        text += fmt::format("    {}  refine {:<3} {:<10.7g}  {:>13} nodes  {:.2f} s\n", axisNames[answer.axis],
          step.refinement, step.value, grouped(step.nodes), step.seconds);
        total += step.seconds;
      }
    }
    text += fmt::format("    {:.2f} s in all\n", total);
  }

  std::string iterations;
  double solve = 0;
  for (const auto& answer : report.answers)
  {
    iterations += (iterations.empty() ? "" : " + ") + std::to_string(answer.result.iterations);
    solve += answer.result.setupSeconds + answer.result.solveSeconds;
  }
  const auto& first = report.answers.front().result;
  text += fmt::format("\n  {}, {}, {} sides; {} iterations, {:.3f} s (everything: {:.2f} s, {})\n",
    lbm::name(report.options.steady.stencil), lbm::name(first.method), name(report.options.steady.sides), iterations,
    solve, report.seconds, bytesText(static_cast<double>(report.peakMemory)));
  text += fmt::format(
    "  {} nodes, of which {} were skipped because they do not conduct\n", grouped(first.nodes), grouped(first.skipped));
  text += report.options.steady.sides == lbm::Sides::Periodic
    ? "  Length: one spacing a node. An empty box of conductivity 1 has 1.\n"
    : "  Length: one spacing a node; the faces lie half a spacing outside the outer nodes. An empty box of\n"
      "  conductivity 1 has 1.\n";
  text += wroteText(report.written);
  return text;
}

} // namespace lamella::cli
