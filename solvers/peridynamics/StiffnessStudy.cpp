#include "peridynamics/StiffnessStudy.h"

#include "lattice/Error.h"
#include "lattice/Memory.h"
#include "peridynamics/CellWindow.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace lamella::peridynamics
{
namespace
{

double now()
{
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

StiffnessStep stepOf(const EffectiveStiffness& cell, const Lattice& lattice, int refinement, double seconds)
{
  StiffnessStep step{ refinement, lattice.count(), cell.stiffness, {}, seconds, false };
  for (const EquilibriumResult& s : cell.solutions)
    step.iterations.push_back(s.iterations);
  return step;
}

/// The solve at the sample's own spacing, with what is told of it.
void solveSample(const BondModel& model, const Lattice& lattice, std::span<const std::uint8_t> phase,
  std::span<const std::int32_t> grain, const EquilibriumOptions& equilibrium, const Communicator& comm,
  StiffnessResult& r)
{
  const double start = now();
  const BondLattice bonds(model, lattice, phase, grain, comm);
  r.bondSeconds = now() - start;
  r.cell = effectiveStiffness(bonds, equilibrium);
  static_cast<SampleCounts&>(r) = countSample(bonds, model, phase);
  r.sides = sideMatch(bonds, phase);
  std::int64_t solver = 0;
  for (const EquilibriumResult& s : r.cell.solutions)
  {
    solver = std::max(solver, s.bytes);
    r.setupSeconds = std::max(r.setupSeconds, s.setupSeconds); // one set-up serves all
    r.solveSeconds += s.solveSeconds;
  }
  const std::int64_t fields = 3 * lattice.dimension * bonds.layout().count() * 8;
  r.bytes = comm.sum(bonds.bytes() + solver + fields);
  const double seconds = now() - start;
  r.measureSeconds = seconds - r.bondSeconds - r.setupSeconds - r.solveSeconds;
  r.steps.push_back(stepOf(r.cell, lattice, 1, seconds));
}

/// Another solve, of a sample that every rank has.
class SecondSpacing
{
public:
  SecondSpacing(const BondModel& model, const CellWindow& window, const StiffnessOptions& options,
    const Communicator& comm, bool part)
    : model_(model)
    , window_(window)
    , options_(options)
    , all_(comm)
    , alone_(MPI_COMM_SELF)
    , part_(part)
  {
  }

  std::vector<double> solve(int refinement, const std::function<bool(double)>& progress, StiffnessResult& r) const
  {
    const double start = now();
    const Lattice lattice = split(window_.lattice, refinement);
    const Stencil stencil(lattice.dimension, model_.horizon);
    const std::int64_t layers = lattice.size[lattice.dimension == 3 ? 2 : 1];
    // too thin to share out: each rank does the same
    const bool together = layers / all_.size() >= stencil.layers();
    const Communicator& comm = together ? all_ : alone_;
    requireMemory("stiffness", lattice, stiffnessBytes(model_, lattice, !window_.grain.empty(), options_, all_.size()),
      options_.memory, all_);
    const CellWindow mine = split(window_, refinement, slab(lattice, stencil, comm));
    const BondLattice bonds(model_, lattice, mine.phase, mine.grain, comm);
    EquilibriumOptions equilibrium = options_.equilibrium;
    equilibrium.progress = together ? progress : nullptr; // a rank that stops alone would leave the others waiting
    const EffectiveStiffness cell = effectiveStiffness(bonds, equilibrium);
    StiffnessStep step = stepOf(cell, lattice, refinement, now() - start);
    step.part = part_;
    r.steps.push_back(step);
    return cell.stiffness;
  }

private:
  const BondModel& model_;
  const CellWindow& window_;
  const StiffnessOptions& options_;
  const Communicator& all_;
  Communicator alone_;
  bool part_;
};

constexpr std::int64_t manyIterations = 200;

/// What the residual, which counts over the forces of the mean strain, may leave of a component far below Voigt's
/// bound.
std::string doubtOfSolver(const EffectiveStiffness& cell, int dimension)
{
  constexpr double noted = 0.01;
  const std::vector<std::string> names = voigtNames(dimension);
  std::string which;
  double worst = 0;
  for (std::size_t a = 0; a < names.size(); ++a)
  {
    const std::size_t i = a * (names.size() + 1);
    const double left = cell.solutions[a].residual * cell.bounds.voigt[i];
    if (left <= noted * std::abs(cell.stiffness[i]) || cell.stiffness[i] == 0)
      continue;
    which += (which.empty() ? "" : ", ") + names[a];
    worst = std::max(worst, left / std::abs(cell.stiffness[i]));
  }
  if (which.empty())
    return "";
  return fmt::format(
    "the stiffness under {} is so far below what its phases have side by side that the solver's residual may be {} "
    "of it: ask for a smaller --tolerance, or take it for none",
    which, worst < 1 ? fmt::format("{:.2g} %", 100 * worst) : std::string("all"));
}

std::vector<std::string> warningsOf(const BondModel& model, const Lattice& lattice, const StiffnessResult& r)
{
  const int dimension = lattice.dimension;
  std::vector<std::string> warnings = modelWarnings(model, r.thickness);
  const EffectiveStiffness& cell = r.cell;
  if (cell.loosePieces > 0)
    warnings.push_back(fmt::format(
      "{} loose pieces with {} nodes ({:.2g} % of the solid) do not go on into the next cell and were taken out: they "
      "carry nothing",
      cell.loosePieces, cell.looseNodes,
      100.0 * static_cast<double>(cell.looseNodes) / static_cast<double>(r.solidNodes)));
  std::string closed;
  for (std::size_t a = 0; a < static_cast<std::size_t>(dimension); ++a)
    if (!cell.crosses[a])
      closed += (closed.empty() ? "" : " and ") + std::string(1, "xyz"[a]);
  if (!closed.empty())
    warnings.push_back(
      fmt::format("no piece of the cell goes on into the next one along {}: it has no stiffness there", closed));
  else if (cell.constants.resisting < cell.components)
    warnings.push_back(fmt::format(
      "the cell resists {} of {} independent strains: it is a mechanism", cell.constants.resisting, cell.components));
  std::int64_t hinges = 0;
  for (const EquilibriumResult& s : cell.solutions)
    hinges = std::max(hinges, s.hinges);
  if (hinges > 0)
    warnings.push_back(fmt::format(
      "{} nodes hang on too few bonds to resist in every direction: they follow where nothing resists", hinges));
  std::int64_t iterations = 0;
  for (const EquilibriumResult& s : cell.solutions)
    iterations = std::max(iterations, s.iterations);
  for (std::size_t a = 0; a < static_cast<std::size_t>(dimension); ++a)
    if (lattice.size[a] % 2 != 0 && iterations > manyIterations)
      warnings.push_back(fmt::format(
        "{} nodes along {} cannot be halved, which multigrid needs of a cell that repeats: it took up to {} "
        "iterations. An even number, best a multiple of 16, takes about ten",
        lattice.size[a], "xyz"[a], iterations));
  const std::string doubt = doubtOfSolver(cell, dimension);
  if (!doubt.empty())
    warnings.push_back(doubt);
  const std::vector<std::string> sides = sideWarnings(r.sides, dimension);
  warnings.insert(warnings.end(), sides.begin(), sides.end());
  return warnings;
}

} // namespace

double stiffnessBytes(
  const BondModel& model, const Lattice& lattice, bool grains, const StiffnessOptions& options, int ranks)
{
  ElasticOptions elastic;
  elastic.equilibrium = options.equilibrium;
  elastic.stress = true; // summed up after each solution
  const Stencil stencil(lattice.dimension, model.horizon);
  const auto nodes =
    static_cast<double>(NodeLayout::largestPart(lattice.dimension, stencil.layers(), lattice.size, ranks).count());
  // the mean strain's displacements and its load, and which nodes are loose
  return elasticBytes(model, lattice, grains, elastic, ranks) + nodes * (2 * 8 * lattice.dimension + 1);
}

StiffnessError stiffnessError(std::span<const double> stiffness, std::span<const double> coarse,
  std::span<const double> fine, int dimension, double zero)
{
  const std::size_t n = dimension == 3 ? 6 : 3;
  StiffnessError e;
  double most = 0;
  std::vector<double> scale(n, 0.0);
  for (std::size_t a = 0; a < n; ++a)
  {
    const double whole = stiffness[a * n + a];
    const double part = coarse[a * n + a];
    most = std::max(most, whole);
    scale[a] = whole > 0 && part > 0 ? std::sqrt(whole / part) : 0;
  }
  double worst = 0;
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b < n; ++b)
    {
      const std::size_t i = a * n + b;
      const double change = 2 * scale[a] * scale[b] * (fine[i] - coarse[i]);
      e.extrapolated.push_back(stiffness[i] + change);
      e.components.push_back(std::abs(change));
      if (a == b && stiffness[i] > zero * most)
        worst = std::max(worst, std::abs(change) / stiffness[i]);
    }
  e.relative = worst;
  // the limit may lie so far off that it is none
  const ElasticConstants constants = elasticConstants(e.extrapolated, dimension, zero);
  if (constants.eigenvalues.front() >= -zero * constants.eigenvalues.back())
  {
    e.constants = constants;
    const std::vector<double> limit = constantValues(constants);
    const std::vector<double> here = constantValues(elasticConstants(stiffness, dimension, zero));
    for (std::size_t i = 0; i < limit.size(); ++i)
      e.ofConstants.push_back(std::abs(limit[i] - here[i]));
  }
  return e;
}

StiffnessResult studyStiffness(const BondModel& given, const Lattice& lattice, std::span<const std::uint8_t> phase,
  std::span<const std::int32_t> grain, const StiffnessOptions& options, const Communicator& comm)
{
  const ThreadScope threads(options.threads);
  BondModel model = given;
  const int d = lattice.dimension;
  for (int a = 0; a < 3; ++a)
    model.periodic[static_cast<std::size_t>(a)] = a < d;
  requireMemory(
    "stiffness", lattice, stiffnessBytes(model, lattice, !grain.empty(), options, comm.size()), options.memory, comm);

  // what there is to do, in nodes, for the progress
  const int finer = 2;
  const auto factor = static_cast<std::int64_t>(std::pow(finer, d));
  const Block part = centredPart(lattice, options.estimateNodes / factor);
  const bool whole = part.count() == lattice.count();
  const auto own = static_cast<double>(lattice.count());
  const auto again = static_cast<double>(part.count());
  const double all = own + (options.estimateError ? again * static_cast<double>(factor) + (whole ? 0 : again) : 0);
  const auto stretch = [&](double from, double length) -> std::function<bool(double)>
  {
    if (!options.equilibrium.progress)
      return nullptr;
    return [&, from, length](double share) { return options.equilibrium.progress((from + length * share) / all); };
  };

  StiffnessResult r;
  EquilibriumOptions equilibrium = options.equilibrium;
  equilibrium.progress = stretch(0, own);
  solveSample(model, lattice, phase, grain, equilibrium, comm, r);
  r.warnings = warningsOf(model, lattice, r);
  if (!options.estimateError)
    return r;

  const double start = now();
  const auto unknown = [&](const std::string& why) { r.warnings.push_back("the error is not known: " + why); };
  if (!whole && !model.notches.empty())
    unknown(fmt::format(
      "with notches it takes the whole sample at half its spacing, which has {} nodes", lattice.count() * factor));
  else
    try
    {
      const CellWindow window =
        collect(lattice, slab(lattice, Stencil(d, model.horizon), comm), phase, grain, part, comm);
      const SecondSpacing second(model, window, options, comm, !whole);
      const std::vector<double> coarse = whole ? r.cell.stiffness : second.solve(1, stretch(own, again), r);
      const double before = own + (whole ? 0 : again);
      const std::vector<double> fine = second.solve(finer, stretch(before, all - before), r);
      r.error = stiffnessError(r.cell.stiffness, coarse, fine, d, std::max(1e-10, 10 * options.equilibrium.tolerance));
    }
    catch (const Cancelled&)
    {
      throw;
    }
    catch (const NoPathError&)
    {
      unknown("nothing crosses the part of the sample that was solved again");
    }
    catch (const Error& error) // the answer itself is there
    {
      unknown(error.what());
    }
  r.estimateSeconds = now() - start;
  return r;
}

} // namespace lamella::peridynamics
