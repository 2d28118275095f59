#include "MicrographDiffusion.h"

#include "Text.h"

#include "lattice/Error.h"
#include "lattice/Memory.h"
#include "lattice/PhaseNames.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace lamella::cli
{

namespace
{

std::string percentOf(double share)
{
  return fmt::format("{:.2g} %", 100 * share);
}

} // namespace

Conductivities parseConductivities(const std::vector<std::string>& texts, bool hasLamella)
{
  const std::array<std::string, 3> names{ "lumen", "wall", "middle lamella" };
  std::array<std::optional<double>, 3> values;
  for (const std::string& part : listItems(texts))
  {
    const auto [name, number] = keyValue("--conductivity", part, "NAME=VALUE");
    const auto found = phaseMeant(names, name);
    if (!found)
    {
      const std::vector<std::string> words{ "lumen", "wall", "lamella" };
      throw ParameterError("--conductivity names '" + name + "', which is no phase of a micrograph",
        suggestion(name, words, "its phases are " + quotedList({ names.begin(), names.end() }, "and")));
    }
    const auto value = toNumber(number);
    if (!value || !std::isfinite(*value) || *value < 0)
    {
      throw ParameterError("--conductivity " + part + ": a conductivity must be a finite number of at least 0",
        "write it as --conductivity wall=1 --conductivity lumen=0.05");
    }
    auto& place = values[*found];
    if (place && *place != *value)
    {
      throw ParameterError(
        fmt::format("--conductivity gives '{}' two values, {:g} and {:g}", names[*found], *place, *value),
        "give every phase one value");
    }
    place = value;
  }
  if (!values[0] || !values[1])
  {
    throw ParameterError(fmt::format("no conductivity was given for '{}'", values[0] ? "wall" : "lumen"),
      fmt::format("add --conductivity {}=VALUE", values[0] ? "wall" : "lumen"));
  }
  if (values[2] && !hasLamella)
  {
    throw ParameterError("--conductivity of a lamella, and there is none with --lamella none",
      "leave it out, or choose --lamella growth, constant or labels");
  }
  if (*values[0] == 0 && *values[1] == 0 && values[2].value_or(0) == 0)
  {
    throw NoPathError("no phase conducts: all conductivities are 0", "give at least one phase a value above 0");
  }
  Conductivities result;
  for (std::size_t i = 0; i < 3; ++i)
  {
    if (values[i])
    {
      result.named.emplace_back(names[i], *values[i]);
      if (i < 2 || *values[2] != *values[1])
      {
        result.values.push_back(*values[i]);
      }
    }
  }
  return result;
}

std::vector<lbm::ContourAnswer> solveMicrograph(
  Session& session, const MicrographProblem& problem, const PhaseMaker& phases)
{
  constexpr double share = 0.5; // of the memory that is free, for a target's sake
  lbm::ContourStudyOptions study;
  study.spacing = problem.spacing;
  study.axes = problem.axes;
  study.conductivity = problem.conductivities.values;
  study.steady.threads = problem.threads;
  study.coarser = problem.coarser;
  study.pixel = problem.pixel;
  study.shares = problem.shares;
  if (problem.doubt > 0)
  {
    study.moved = micrograph::movedOutlines(problem.contours, problem.doubt);
  }
  if (!problem.coarser.empty())
  {
    study.sealed = micrograph::sealedOutlines(problem.contours, problem.pixel);
  }
  const Lattice lattice = micrograph::fitContours(problem.contours, problem.spacing, 2).lattice;
  // The solver, its links, the lattice and what its outlines cut; directions where there is a lamella.
  const auto nodes = static_cast<double>(lattice.count());
  const double bytes = static_cast<double>(lbm::estimateBytes(
                         lattice, lbm::Stencil::D2Q5, lbm::Method::AlgebraicMultigrid, lattice.count())) +
    nodes * (16 + 9 + 30 + (problem.conductivities.values.size() > 2 ? 60 : 0));
  const auto available = static_cast<double>(availableMemory());
  if (bytes > available)
  {
    throw MemoryError(fmt::format("diffusion on {} nodes takes about {}, and {} are free", sizeText(lattice.size, 2),
                        bytesText(bytes), bytesText(available)),
      "take a larger --spacing or a part of the picture with --window");
  }
  study.targetError = problem.targetError;
  study.mostNodes = static_cast<std::int64_t>(share * available / bytes * nodes);
  study.plan = [&](const lbm::ContourPlan& plan)
  {
    const double takes = bytes / nodes * static_cast<double>(plan.nodes);
    const bool reaches = plan.pictureError < plan.target;
    std::string text = fmt::format("the error bar is {}; ", percentOf(plan.error));
    text += reaches ? percentOf(plan.target) + " takes"
                    : fmt::format("of the {} asked for only a finer picture can reach, half of the picture's {} takes",
                        percentOf(plan.target), percentOf(plan.pictureError));
    text += fmt::format(" about {} nodes and {} of memory", grouped(plan.nodes), bytesText(takes));
    if (takes > share * available)
    {
      text += fmt::format(", and no more than half of the {} that are free is taken", bytesText(available));
    }
    session.note(text);
  };
  // Three lattices, each of four times the nodes of the one before, and one for every coarser picture, each solved
  // along every axis; nobody knows how many with a target, and each begins anew.
  struct State
  {
    std::size_t begun = 0;
    double before = 0;
  };
  auto state = std::make_shared<State>();
  std::size_t others = 2;
  for (const micrograph::ContourSet* set : { &study.moved, &study.sealed })
  {
    others += set->contours.empty() ? 0 : 1;
  }
  for (const micrograph::CoarserOutlines& outlines : problem.coarser)
  {
    others += outlines.sets.size();
  }
  const std::size_t coarse = others * problem.axes.size();
  const double each = 1.0 / static_cast<double>(coarse + 4 * problem.axes.size());
  study.steady.progress = [&session, state, each, coarse, axes = problem.axes.size()](double part, const char* what)
  {
    const auto weight = [&](std::size_t solve) { return solve <= coarse ? each : 4 * each; };
    if (part <= 0 || state->begun == 0)
    {
      state->before += state->begun > 0 ? weight(state->begun) : 0;
      ++state->begun;
    }
    if (state->begun > coarse + axes)
    {
      const std::size_t ofThis = (state->begun - 1 - coarse) % axes;
      return session.progress((static_cast<double>(ofThis) + part) / static_cast<double>(axes), what);
    }
    return session.progress(std::min(1.0, state->before + part * weight(state->begun)), what);
  };
  if (problem.conductivities.values.size() > 2)
  {
    study.phases = phases;
  }
  auto answers = lbm::studyContours(problem.contours, study, MPI_COMM_SELF);
  session.endProgress();
  return answers;
}

} // namespace lamella::cli
