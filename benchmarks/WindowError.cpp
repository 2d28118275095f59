// Does the window error hold? Pictures cut out of much larger samples of random materials; the truth is the mean of the
// large samples. A line a kind, size and property: how many of the intervals of 95 % hold the truth, half their median
// width, the median error of the pictures' own values, and what the windows cost over the solve.
//
// study=conductivity; study=tensors: walls that conduct five times better along a direction askew to the picture, and
// study=shares: of smoothed labels; study=stiffness: Young's moduli, sides straight (as those of the windows are) and
// periodic;
// study=pores: porosity, number and mean size; study=strength: peak stresses of bonds; study=rings: how often the
// gradient of a growth ring is seen.
//
// Keys: seed=N of the first sample (1001), samples=N (5), pictures=N of each sample and size (8), kind=NAME, what=NAME
// (as the table has it). The rule's weights were found on other seeds, see docs/benchmarks/window.md.
#include "Keys.h"
#include "Table.h"
#include "Tissues.h"

#include "core/Clock.h"
#include "elasticity/Materials.h"
#include "elasticity/VoxelStiffness.h"
#include "lbm/DiffusionStudy.h"
#include "lbm/DirectedDiffusivity.h"
#include "lbm/Shares.h"
#include "peridynamics/fracture/WindowStrength.h"
#include "pores/PoreWindows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;

lbm::StudyOptions optionsFor(const PhaseImage& image, bool windows)
{
  lbm::StudyOptions options;
  options.axes = image.lattice.dimension == 3 ? std::vector{ 0, 1, 2 } : std::vector{ 0, 1 };
  options.estimateError = false;
  options.windowError = windows;
  options.steady.maxIterations = 2000;
  if (image.lattice.dimension == 3)
    options.steady.stencil = lbm::Stencil::D3Q7;
  return options;
}

std::vector<lbm::DiffusionAnswer> solved(const PhaseImage& image, const std::vector<double>& conductivity, bool windows)
{
  return lbm::studyDiffusion(image, conductivity, optionsFor(image, windows), MPI_COMM_SELF);
}

/// By a smooth surface through the labels.
std::vector<lbm::DiffusionAnswer> smoothed(
  const PhaseImage& image, const std::vector<double>& conductivity, bool windows)
{
  return lbm::studyLabels(image, 1, { conductivity[0], conductivity[1] }, optionsFor(image, windows), MPI_COMM_SELF)
    .answers;
}

/// The better phase conducts a fifth across a direction that is 30° askew to the picture.
std::vector<lbm::DiffusionAnswer> askew(const PhaseImage& image, const std::vector<double>& conductivity, bool windows)
{
  constexpr double across = 0.2;
  const double c = std::cos(std::numbers::pi / 6);
  const double s = std::sin(std::numbers::pi / 6);
  lbm::DirectedDiffusivity directed{ .along = conductivity, .across = conductivity };
  directed.source.assign(2, lbm::DirectedDiffusivity::Source::Axial);
  directed.ofPhase.resize(2);
  const std::size_t better = conductivity[1] > conductivity[0] ? 1 : 0;
  const double k = conductivity[better];
  directed.source[better] = lbm::DirectedDiffusivity::Source::Phase;
  directed.ofPhase[better] = { k * (c * c + across * s * s), k * (s * s + across * c * c), k * across,
    k * (1 - across) * c * s, 0, 0 };
  directed.takeTensors(image.lattice, image.phase);
  lbm::StudyOptions options = optionsFor(image, windows);
  options.steady.stencil = lbm::Stencil::Q1;
  const std::vector<double> larger = directed.larger();
  options.directed = std::make_shared<const lbm::DirectedDiffusivity>(std::move(directed));
  return lbm::studyDiffusion(image, larger, options, MPI_COMM_SELF);
}

double valueOf(const lbm::DiffusionAnswer& answer)
{
  return answer.result.effective[static_cast<std::size_t>(answer.axis)];
}

double median(std::vector<double> values)
{
  std::ranges::sort(values);
  return values.empty() ? std::nan("") : values[values.size() / 2];
}

/// What one line of the table is made of.
struct Line
{
  int held = 0;
  int gradients = 0;
  std::vector<double> widths, errors; ///< relative to the truth
  double solve = 0, windows = 0;      ///< [s]
};

void add(Line& line, const statistics::WindowError& window, double truth)
{
  line.held += window.low <= truth && truth <= window.high ? 1 : 0;
  line.gradients += window.gradient ? 1 : 0;
  line.widths.push_back(0.5 * (window.high - window.low) / truth);
  line.errors.push_back(std::abs(window.value - truth) / truth);
}

/// Shares that held, by what was asked for.
using Totals = std::map<std::string, std::array<double, 2>>;

void tell(
  Table& table, Totals& totals, const std::string& kind, const std::string& what, std::int64_t edge, const Line& line)
{
  const double cases = static_cast<double>(line.widths.size());
  totals[what][0] += line.held;
  totals[what][1] += cases;
  fmt::print("{:<20} {:<14} {:>5} {:>6} {:>4.0f} %  {:>8.1f} % {:>6.1f} % {:>6} {:>6.2f}\n", kind, what, edge, cases,
    100 * line.held / cases, 100 * median(line.widths), 100 * median(line.errors), line.gradients,
    line.windows / line.solve);
  std::fflush(stdout);
  table.line(kind, what, edge, cases, line.held / cases, median(line.widths), median(line.errors),
    median(line.widths) / median(line.errors), line.gradients, line.windows / line.solve);
}

constexpr const char* columns = "kind,what,nodes,cases,held,half_width,error,width_over_error,gradients,cost";

void heading()
{
  fmt::print("{:<20} {:<14} {:>5} {:>6} {:>6}  {:>10} {:>8} {:>6} {:>6}\n", "kind", "what", "nodes", "cases", "held",
    "half width", "error", "grad.", "cost");
}

void tellTotals(const Totals& totals)
{
  for (const auto& [name, of] : totals)
    fmt::print("all {:<14} {:.1f} % of {}\n", name, 100 * of[0] / of[1], of[1]);
}

std::vector<PhaseImage> largeSamples(const Tissue& tissue, std::int64_t edge, const Keys& keys)
{
  std::vector<PhaseImage> large;
  for (int s = 0; s < static_cast<int>(number(keys, "samples", 5)); ++s)
    large.push_back(
      tissue.make(edge, static_cast<std::uint64_t>(number(keys, "seed", 1001)) + static_cast<std::uint64_t>(s)));
  return large;
}

/// Calls f with pictures cut out of the samples, the same for the same keys.
template <class F>
void forPictures(const std::vector<PhaseImage>& large, std::int64_t edge, const Keys& keys, F&& f)
{
  const auto first = static_cast<std::uint64_t>(number(keys, "seed", 1001));
  for (std::size_t s = 0; s < large.size(); ++s)
  {
    Random random(first + 7919 * (s + 1));
    for (int p = 0; p < static_cast<int>(number(keys, "pictures", 8)); ++p)
      f(someWindow(large[s], edge, random));
  }
}

bool wants(const Keys& keys, const Tissue& tissue)
{
  const std::string wanted = text(keys, "kind", "");
  return wanted.empty() || tissue.kind == wanted;
}

using ConductionSolve = std::vector<lbm::DiffusionAnswer>(const PhaseImage&, const std::vector<double>&, bool);

/// Conductivities of the connected phase and of the other one.
struct Conduction
{
  std::string name;
  std::array<double, 2> conductivity;
  ConductionSolve* solve = solved;
};

void conduction(const Keys& keys, const std::string& study, const std::vector<Conduction>& kinds)
{
  Table table(keys, "window-error", study, columns);
  Totals totals;
  heading();
  for (const Tissue& tissue : tissues())
  {
    if (!wants(keys, tissue))
      continue;
    const std::vector<PhaseImage> large = largeSamples(tissue, tissue.large, keys);
    for (const auto& [name, of, solve] : kinds)
    {
      if (!text(keys, "what", "").empty() && text(keys, "what", "") != name)
        continue;
      const std::vector<double> k = tissue.connected == 1 ? std::vector{ of[1], of[0] } : std::vector{ of[0], of[1] };
      std::array<double, 3> truth{ 0, 0, 0 };
      for (const PhaseImage& image : large)
        for (const auto& answer : solve(image, k, false))
          truth[static_cast<std::size_t>(answer.axis)] += valueOf(answer) / static_cast<double>(large.size());
      for (const std::int64_t edge : tissue.windows)
      {
        Line line;
        forPictures(large, edge, keys,
          [&](const PhaseImage& picture)
          {
            std::vector<lbm::DiffusionAnswer> answers;
            try
            {
              answers = solve(picture, k, true);
            }
            catch (const NoPathError&)
            {
              return; // nothing leads across: no value to speak of
            }
            for (const auto& answer : answers)
            {
              add(line, *answer.window, truth[static_cast<std::size_t>(answer.axis)]);
              for (const lbm::RefinementStep& step : answer.steps)
                (step.parts > 1 ? line.windows : line.solve) += step.seconds;
            }
          });
        tell(table, totals, tissue.kind, name, edge, line);
      }
    }
  }
  tellTotals(totals);
}

void conductivity(const Keys& keys)
{
  conduction(
    keys, "conductivity", { { "1 : 0.023", { 1, 0.023 } }, { "0.004 : 1", { 0.004, 1 } }, { "1 : 0", { 1, 0 } } });
}

void tensors(const Keys& keys)
{
  conduction(
    keys, "tensors", { { "1 : 0.023 askew", { 1, 0.023 }, askew }, { "0.004 : 1 askew", { 0.004, 1 }, askew } });
}

void shares(const Keys& keys)
{
  conduction(
    keys, "shares", { { "1 : 0.023 smooth", { 1, 0.023 }, smoothed }, { "0.004 : 1 smooth", { 0.004, 1 }, smoothed } });
}

elasticity::VoxelStiffness stiffnessOf(
  const PhaseImage& image, int solid, elasticity::StiffnessSides sides, bool windows)
{
  using namespace elasticity;
  const Continuum continuum = image.lattice.dimension == 3 ? Continuum::Space : Continuum::PlaneStress;
  std::vector<VoxelMaterial> materials(2);
  for (int id = 0; id < 2; ++id)
    materials[static_cast<std::size_t>(id)].stiffness =
      id == solid ? isotropicStiffness(continuum, 1, 0.3) : voidStiffness(continuum);
  VoxelStiffnessOptions options;
  options.sides = sides;
  options.estimateError = false;
  options.windowError = windows;
  return studyVoxelStiffness(image.lattice, image.phase, materials, {}, options);
}

/// Of Young's moduli alone.
bool isModulus(const std::string& name)
{
  return name.starts_with("E_");
}

void stiffness(const Keys& keys)
{
  using elasticity::StiffnessSides;
  Table table(keys, "window-error", "stiffness", columns);
  Totals totals;
  heading();
  for (const Tissue& tissue : tissues())
  {
    if (!wants(keys, tissue) || tissue.dimension == 3)
      continue;
    const std::vector<PhaseImage> large = largeSamples(tissue, tissue.large / 2, keys);
    std::map<std::string, double> truth;
    const std::vector<std::string> names = elasticity::constantNames(tissue.dimension);
    for (const PhaseImage& image : large)
    {
      const auto values =
        elasticity::constantValues(stiffnessOf(image, tissue.connected, StiffnessSides::Straight, false).constants);
      for (std::size_t i = 0; i < names.size(); ++i)
        truth[names[i]] += values[i] / static_cast<double>(large.size());
    }
    for (const auto& [what, sides] :
      { std::pair{ "E straight", StiffnessSides::Straight }, std::pair{ "E periodic", StiffnessSides::Periodic } })
    {
      const std::int64_t edge = tissue.windows.front();
      Line line;
      forPictures(large, edge, keys,
        [&](const PhaseImage& picture)
        {
          try
          {
            const auto found = stiffnessOf(picture, tissue.connected, sides, true);
            for (const statistics::WindowError& window : found.windows)
              if (isModulus(window.name))
                add(line, window, truth[window.name]);
            line.solve += found.setupSeconds + found.solveSeconds;
            line.windows += found.windowSeconds;
          }
          catch (const NoPathError&)
          {
          }
        });
      tell(table, totals, tissue.kind, what, edge, line);
    }
  }
  tellTotals(totals);
}

void poreNumbers(const Keys& keys)
{
  Table table(keys, "window-error", "pores", columns);
  Totals totals;
  heading();
  for (const Tissue& tissue : tissues())
  {
    if (!wants(keys, tissue) || tissue.dimension == 3 || tissue.kind == "overlapping disks")
      continue;
    const auto wanted = static_cast<std::uint8_t>(1 - tissue.connected);
    const std::vector<PhaseImage> large = largeSamples(tissue, tissue.large, keys);
    std::map<std::string, double> truth;
    for (const PhaseImage& image : large)
      for (const statistics::WindowError& w : pores::poreWindows(image.lattice, image.phase, wanted, {}))
        truth[w.name] += w.value / static_cast<double>(large.size());
    for (const std::int64_t edge : tissue.windows)
    {
      std::map<std::string, Line> lines;
      forPictures(large, edge, keys,
        [&](const PhaseImage& picture)
        {
          for (const statistics::WindowError& w : pores::poreWindows(picture.lattice, picture.phase, wanted, {}))
            add(lines[w.name], w, truth[w.name]);
        });
      for (const auto& [name, line] : lines)
        tell(table, totals, tissue.kind, name, edge, line);
    }
  }
  tellTotals(totals);
}

peridynamics::BondModel breakable(int solid)
{
  peridynamics::BondModel model;
  const auto id = static_cast<std::uint8_t>(solid);
  model.voids = { static_cast<std::uint8_t>(1 - solid) };
  model.pairs[{ id, id }].material = { .youngsModulus = 1e9, .criticalStretch = 1e-3 };
  return model;
}

/// The truth is the mean of all pictures of one kind and size: strength falls with the size.
void strength(const Keys& keys)
{
  Table table(keys, "window-error", "strength", columns);
  Totals totals;
  heading();
  for (const Tissue& tissue : tissues())
  {
    if (!wants(keys, tissue) || tissue.dimension == 3)
      continue;
    const std::vector<PhaseImage> large = largeSamples(tissue, tissue.large, keys);
    const peridynamics::BondModel model = breakable(tissue.connected);
    for (const std::int64_t edge : tissue.windows)
      for (const int axis : { 0, 1 })
      {
        Line line;
        std::vector<statistics::WindowError> found;
        double truth = 0;
        forPictures(large, edge, keys,
          [&](const PhaseImage& picture)
          {
            peridynamics::FractureStudyOptions o;
            o.loading.axis = axis;
            o.displacement = false;
            o.threads = 1;
            try
            {
              const double start = seconds();
              const auto whole =
                peridynamics::studyFracture(model, picture.lattice, picture.phase, {}, o, Communicator(MPI_COMM_SELF));
              const double solved = seconds();
              found.push_back(statistics::strengthError(
                whole.peak.stress, peridynamics::windowStrengths(model, picture.lattice, picture.phase, {}, o))
                                .error);
              line.solve += solved - start;
              line.windows += seconds() - solved;
              truth += whole.peak.stress;
            }
            catch (const NoPathError&)
            {
            }
            catch (const InputError&) // nothing but hinges leads across
            {
            }
          });
        for (const statistics::WindowError& window : found)
          add(line, window, truth / static_cast<double>(found.size()));
        if (!found.empty())
          tell(table, totals, tissue.kind, fmt::format("strength {}", axis == 0 ? 'x' : 'y'), edge, line);
      }
  }
  tellTotals(totals);
}

/// From earlywood to latewood along x.
void rings(const Keys& keys)
{
  const auto first = static_cast<std::uint64_t>(number(keys, "seed", 1001));
  const int samples = static_cast<int>(number(keys, "samples", 20));
  for (const double end : { 0.3, 0.6, 1.0 })
  {
    int found = 0;
    int elsewhere = 0;
    for (int s = 0; s < samples; ++s)
    {
      generators::SoftwoodOptions o;
      o.size = { 400, 400, 1 };
      o.spacing = 1.5e-6;
      o.ringPosition1 = end;
      o.solidFraction = 0.45;
      o.seed = first + static_cast<std::uint64_t>(s);
      for (const auto& answer : solved(generators::softwood(o), { 0.023, 1 }, true))
        if (answer.window->gradient)
          (answer.window->gradient->axis == 0 ? found : elsewhere) += 1;
    }
    fmt::print(
      "ring 0 to {}: gradient along x in {} of {} values, along y in {}\n", end, found, 2 * samples, elsewhere);
  }
}

} // namespace

int main(int argc, char** argv)
{
  return runStudies(argc, argv,
    { { "conductivity", conductivity }, { "tensors", tensors }, { "shares", shares }, { "stiffness", stiffness },
      { "pores", poreNumbers }, { "rings", rings }, { "strength", strength } });
}
