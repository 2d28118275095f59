#include "scenes/Estimate.h"

#include "scenes/Rehearsal.h"

#include "session/Text.h"

#include "lattice/PhaseNames.h"
#include "lattice/Phases.h"
#include "vtkLatticeConversion.h"

#include <vtkImageData.h>
#include <vtkPolyData.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

namespace lamella::cli
{

namespace
{

/// The text of an option in words; what holds without it otherwise.
std::string textOf(const std::vector<std::string>& words, const std::string& option, const std::string& otherwise)
{
  const std::string dashed = "--" + option + "=";
  const auto found = std::ranges::find_if(words, [&](const std::string& word) { return word.starts_with(dashed); });
  return found == words.end() ? otherwise : found->substr(dashed.size());
}

double numberOf(const std::vector<std::string>& words, const std::string& option, double otherwise)
{
  return toNumber(textOf(words, option, "")).value_or(otherwise);
}

/// The numbers that an option lists, or gives to names.
std::vector<double> numbersOf(const std::vector<std::string>& words, const std::string& option)
{
  const std::string dashed = "--" + option + "=";
  std::vector<double> numbers;
  for (const std::string& word : words)
    for (const std::string& part :
      word.starts_with(dashed) ? split(word.substr(word.rfind('=') + 1), ',') : std::vector<std::string>())
      numbers.push_back(toNumber(part).value_or(0));
  return numbers;
}

/// 0 where there is none.
double largest(const std::vector<double>& numbers)
{
  return numbers.empty() ? 0 : *std::ranges::max_element(numbers);
}

bool has(const std::vector<std::string>& words, const std::string& flag)
{
  return std::ranges::find(words, "--" + flag) != words.end();
}

/// What a formula is given.
struct Size
{
  double nodes;
  double solid;  ///< nodes that are no void
  double across; ///< nodes along an edge
  int dimension;
  double spacing;
};

/// Directions solved for.
double directions(const std::vector<std::string>& words, const Size& s)
{
  return textOf(words, "direction", "all") == "all" ? s.dimension : 1;
}

// Bytes a node and seconds are those of docs/benchmarks, on one core, rounded up.

Cost diffusion(const std::vector<std::string>& words, const Size& s)
{
  // the error comes from a lattice twice as fine and from every second, third and fourth pixel, of at most 2^22 nodes
  // each
  const bool error = !has(words, "no-error-estimate");
  const double finer = error ? std::min(s.nodes * std::pow(2, s.dimension), 4194304.0) : 0;
  const double coarser = error ? 3 * std::min(s.nodes, 4194304.0) : 0;
  const double iterations = 15;
  const double windows = has(words, "window-error") ? 2 * s.nodes : 0; // halves and thirds of it along each axis
  const double all = (s.nodes + finer + coarser + windows) * directions(words, s);
  return { "", 54 * std::max(s.nodes, finer) + 60 * s.nodes, all * iterations, "node iterations", 4e-7 * all };
}

Cost transient(const std::vector<std::string>& words, const Size& s)
{
  const double fastest = largest(numbersOf(words, "diffusivity"));
  const double step = numberOf(words, "step", fastest > 0 ? s.spacing * s.spacing / (6 * fastest) : 1);
  const double end = std::max(numberOf(words, "end-time", 0), largest(numbersOf(words, "at-time")));
  const double steps = std::max({ end / step, largest(numbersOf(words, "at-step")), numberOf(words, "frames", 2) });
  return { "", 150 * s.nodes, s.nodes * steps, "node steps", s.nodes * steps / 5e7 };
}

/// An equilibrium of bonds, whose number grows with the horizon.
double reach(const std::vector<std::string>& words, const Size& s)
{
  return std::pow(numberOf(words, "horizon", 3) / 3, s.dimension);
}

Cost equilibrium(const std::vector<std::string>& words, const Size& s)
{
  const double flat = s.dimension == 2 ? 1 : 0;
  return { "", (flat > 0 ? 330 : 900) * s.nodes, 25 * s.nodes, "node iterations",
    (flat > 0 ? 5e-6 : 2e-5) * s.nodes * reach(words, s) };
}

Cost bondStiffness(const std::vector<std::string>& words, const Size& s)
{
  const double cases = s.dimension == 2 ? 3 : 6;
  const double finer = has(words, "no-error-estimate") ? 1 : 1 + std::pow(2, s.dimension);
  Cost cost = equilibrium(words, s);
  cost.bytes *= finer > 1 ? std::pow(2, s.dimension) : 1;
  cost.work *= cases * finer;
  cost.seconds *= cases * finer;
  return cost;
}

Cost stiffness(const std::vector<std::string>& words, const Size& s)
{
  const double cases = has(words, "no-tensor") ? 1 : s.dimension == 2 ? 3 : 6;
  const double all = cases * (has(words, "no-error-estimate") ? 1 : s.dimension == 2 ? 3 : 2);
  return { "", (s.dimension == 2 ? 50 : 60) * s.nodes, 15 * all * s.nodes, "node iterations", 1e-6 * all * s.nodes };
}

/// Of the solver's cost; solves are those of docs/benchmarks/fit.md in the median, each of all samples.
Cost fit(const std::vector<std::string>& words, const Size& s)
{
  const double solves = 6;
  const auto solver = [&](const std::vector<std::string>& with)
  { return words.at(1) == "stiffness" ? stiffness(with, s) : diffusion(with, s); };
  std::vector<std::string> search = words;
  search.emplace_back("--no-error-estimate");
  const Cost one = solver(search);
  Cost cost = solver(words);
  std::set<std::string> samples; // each at each of its moistures: "2/" and "0.12" of "2/y@0.12"
  for (const std::string& word : words)
    if (const std::string before = "--measured="; word.starts_with(before))
    {
      const std::string name = word.substr(before.size(), word.find('=', before.size()) - before.size());
      const std::size_t slash = name.find('/');
      const std::size_t at = name.find('@');
      samples.insert(
        (slash == std::string::npos ? "1" : name.substr(0, slash)) + (at == std::string::npos ? "" : name.substr(at)));
    }
  const auto times = static_cast<double>(std::max<std::size_t>(samples.size(), 1));
  cost.work = times * (cost.work + solves * one.work);
  cost.seconds = times * (cost.seconds + solves * one.seconds);
  return cost;
}

Cost fracture(const std::vector<std::string>& words, const Size& s)
{
  // a crack through the sample and what breaks beside it: bonds that cross a section, ten times
  const double events = std::min(numberOf(words, "max-broken", 1e300), 10 * s.across * reach(words, s));
  return { "", (s.dimension == 2 ? 400 : 1300) * s.nodes, events, "broken bonds", events * (1e-3 + 4e-8 * s.nodes) };
}

Cost dynamics(const std::vector<std::string>& words, const Size& s)
{
  // a wave takes about one step a node to cross; platens break a sample in twice the time to the first break
  const std::vector<double> density = numbersOf(words, "density");
  const double lightest = density.empty() ? 1 : *std::ranges::min_element(density);
  const double step = numberOf(words, "step", s.spacing * std::sqrt(lightest / largest(numbersOf(words, "young"))));
  const double end = numberOf(words, "end-time", 0);
  const double steps = end > 0 && std::isfinite(step) ? end / step : 2 * numberOf(words, "travel-times", 30) * s.across;
  return { "", 400 * s.nodes, s.nodes * steps, "node steps", s.nodes * steps * reach(words, s) / 2e7 };
}

Cost compression(const std::vector<std::string>& words, const Size& s)
{
  const double points = s.solid * std::pow(numberOf(words, "points-per-node", 2), s.dimension);
  if (has(words, "stiffness-only"))
    return { "", 500 * points, 300 * points * s.dimension, "point iterations", 1e-4 * points * s.dimension };
  // platens that move at some thousandths of the wave's speed
  const double steps = 1200 * s.across * numberOf(words, "strain", 0.48);
  return { "", 300 * points, points * steps, "point steps", points * steps / 8e6 };
}

const std::map<std::string, std::function<Cost(const std::vector<std::string>&, const Size&)>>& formulas()
{
  static const std::map<std::string, std::function<Cost(const std::vector<std::string>&, const Size&)>> all{
    { "diffusion", diffusion }, { "transient", transient }, { "equilibrium", equilibrium }, { "stiffness", stiffness },
    { "fit", fit }, { "bond-stiffness", bondStiffness }, { "fracture", fracture }, { "dynamics", dynamics },
    { "compression", compression }
  };
  return all;
}

/// Bytes that a checkpoint takes while it is written: gathered, as HDF5 has it, as a file.
double checkpointBytes(const std::string& command, const std::vector<std::string>& words, const Size& s)
{
  const double d = s.dimension;
  const double numbers = command == "fracture" ? 2 * d
    : command == "dynamics"                    ? 5 * d
    : command == "transient"                   ? 2 * d + 1
    : command == "compression"                 ? std::pow(numberOf(words, "points-per-node", 2), d) * (d == 2 ? 18 : 28)
                                               : 0;
  return 3 * 8 * numbers * s.nodes;
}

/// What drawing takes, whatever is drawn: Mesa and its compiler.
constexpr double drawingBytes = 1.5e8;

bool draws(const PlannedStage& planned)
{
  return planned.stage->command == "snapshot" ||
    std::ranges::any_of(
      planned.each, [](const PlannedEach& each) { return each.each->command == "snapshot"; });
}

/// Bytes and seconds a node of filters and of what makes samples.
Cost simple(const std::string& command, const Size& s)
{
  const double perNode = command == "generate" || command == "micrograph" ? 2e-6 : command == "snapshot" ? 1e-6 : 3e-7;
  return { "", 60 * s.nodes, s.nodes, "nodes", 0.05 + perNode * s.nodes };
}

/// How many nodes the options of a sample say, up to a factor that all samples of a scene share.
double scaleOf(const SamplePlan& plan, int dimension)
{
  double scale = 1;
  for (const PlannedStage& stage : plan.stages)
  {
    const std::string size = textOf(stage.words, "size", "");
    for (const std::string& edge : size.empty() ? std::vector<std::string>{} : split(size, ','))
      scale *= toNumber(edge).value_or(1);
    if (stage.stage->command == "bridges")
      scale *= std::pow(numberOf(stage.words, "nodes", 1), dimension);
  }
  return scale;
}

} // namespace

Estimator::Estimator(const Scene& scene, const Rehearsal& first)
  : checkpoint_(scene.checkpoint)
  , base_(first.bytesBefore())
{
  for (const PlannedStage& stage : first.made())
  {
    const auto data = Workspace::find(stage.outputs.at("output"));
    if (auto* const image = vtkImageData::SafeDownCast(data))
    {
      const Lattice lattice = latticeOf(image, Voxels::Any);
      nodes_ = static_cast<double>(lattice.count());
      dimension_ = lattice.dimension;
      spacing_ = lattice.spacing;
      const PhaseImage phases = toPhaseImage(image, "phase", Voxels::Any);
      solid_ = 0;
      for (std::size_t id = 0; id < phases.phases.size(); ++id)
        solid_ += isVoidName(phases.phases.names()[id]) ? 0 : phases.fractions()[id];
    }
    else if (auto* const grains = vtkPolyData::SafeDownCast(data))
    {
      nodes_ = std::max(nodes_, static_cast<double>(grains->GetNumberOfPoints()));
    }
  }
  scaleOfFirst_ = scaleOf(first.plan(), dimension_);
}

SampleCost Estimator::operator()(const SamplePlan& plan) const
{
  SampleCost cost;
  cost.nodes = nodes_ * scaleOf(plan, dimension_) / scaleOfFirst_;
  cost.dimension = dimension_;
  double most = 0;
  double held = 20 * cost.nodes; // the sample, and what is joined to it
  for (const PlannedStage& planned : plan.stages)
  {
    Size size{ cost.nodes, solid_ * cost.nodes, std::pow(cost.nodes, 1.0 / dimension_), dimension_, spacing_ };
    const double refine = numberOf(planned.words, "refine", 1);
    size.nodes *= std::pow(refine, dimension_);
    size.solid *= std::pow(refine, dimension_);
    size.across *= refine;
    const auto formula = formulas().find(planned.stage->command);
    Cost one =
      formula == formulas().end() ? simple(planned.stage->command, size) : formula->second(planned.words, size);
    one.stage = planned.stage->name;
    one.seconds /= std::max(1.0, std::min(numberOf(planned.words, "threads", 1), 64.0));
    if (checkpoint_ && one.seconds > *checkpoint_)
      one.bytes += checkpointBytes(planned.stage->command, planned.words, size);
    if (planned.outputs.contains("output"))
      held += 24 * size.nodes;
    most = std::max(most, one.bytes);
    cost.seconds += one.seconds;
    cost.stages.push_back(std::move(one));
  }
  cost.bytes = base_ + most + held + (std::ranges::any_of(plan.stages, draws) ? drawingBytes : 0);
  return cost;
}

} // namespace lamella::cli
