#include "peridynamics/StiffnessStudy.h"

#include "core/Clock.h"
#include "core/Error.h"
#include "core/Memory.h"
#include "peridynamics/CellWindow.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace lamella::peridynamics
{
namespace
{

StiffnessStep stepOf(const EffectiveStiffness& cell, const Lattice& lattice, double seconds)
{
  StiffnessStep step{ 1, 1, lattice.count(), cell.stiffness, {}, seconds };
  for (const EquilibriumResult& s : cell.solutions)
    step.iterations.push_back(s.iterations);
  return step;
}

/// What a cell takes before the first iteration, in iterations.
constexpr double workOfSetup = 10;

double workOf(const StiffnessStep& step)
{
  std::int64_t iterations = 0;
  for (const std::int64_t n : step.iterations)
    iterations += n;
  return static_cast<double>(step.nodes) * (static_cast<double>(iterations) + workOfSetup);
}

/// The solve at the sample's own spacing, with what is told of it.
void solveSample(const BondModel& model, const Lattice& lattice, std::span<const std::uint8_t> phase,
  std::span<const std::int32_t> grain, const EquilibriumOptions& equilibrium, const Communicator& comm,
  StiffnessResult& r)
{
  const double start = lamella::seconds();
  const BondLattice bonds(model, lattice, phase, grain, comm);
  r.bondSeconds = lamella::seconds() - start;
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
  const double took = lamella::seconds() - start;
  r.measureSeconds = took - r.bondSeconds - r.setupSeconds - r.solveSeconds;
  r.steps.push_back(stepOf(r.cell, lattice, took));
}

// Every second, third and fourth pixel make pictures; of each kind about so many are solved. In the plane there are 4,
// 9 and 16, in space 8, 27 and 64.
constexpr std::array strides{ 2, 3, 4 };
constexpr std::size_t fewPictures = 8;
// Walls and grains of a few horizons are not yet where errors fall like the pixel: of a halved pixel the change is less
// than what is left, in honeycombs and boxes by up to 1.4 times (found on other shapes and seeds than those of
// docs/benchmarks/stiffness.md). That is an order of 0.74.
constexpr double leftOverChange = 1.5;
// A picture of fewer pixels along an axis tells nothing.
constexpr std::int64_t fewestAcross = 3;
// Nodes from which on a picture is shared out among ranks.
constexpr std::int64_t fewestShared = std::int64_t{ 1 } << 18;

/// Coarser pictures of the cell, and their tensors.
class CoarserPictures
{
public:
  CoarserPictures(const BondModel& model, const Lattice& lattice, std::span<const std::uint8_t> phase,
    std::span<const std::int32_t> grain, const StiffnessOptions& options, const Communicator& comm)
    : model_(model)
    , lattice_(lattice)
    , pixels_(lattice)
    , phase_(phase)
    , grain_(grain)
    , options_(options)
    , all_(comm)
    , alone_(MPI_COMM_SELF)
    , slab_(slab(lattice, Stencil(lattice.dimension, model.horizon), comm))
  {
    for (std::size_t a = 0; a < static_cast<std::size_t>(lattice.dimension); ++a)
      pixels_.size[a] = lattice.size[a] / options.nodesPerPixel;
  }

  /// Why there are none; empty: there are. Known before anything is solved.
  [[nodiscard]] std::string missing(const StiffnessResult& r)
  {
    for (std::size_t a = 0; a < static_cast<std::size_t>(lattice_.dimension); ++a)
      matters_[a] = r.sides[a].across > 0 || r.sides[a].inside > 0 || all_.any(!grain_.empty());
    for (std::size_t a = 0; a < static_cast<std::size_t>(lattice_.dimension); ++a)
      if (lattice_.size[a] % options_.nodesPerPixel != 0)
        return fmt::format("{} nodes along {} are no whole number of pixels of {} nodes", lattice_.size[a], "xyz"[a],
          options_.nodesPerPixel);
    for (std::size_t a = 0; a < static_cast<std::size_t>(lattice_.dimension); ++a)
      if (!serves(a, strides.front()))
        return fmt::format("of {} pixels along {} every second one is too few to tell anything: it takes {}",
          pixels_.size[a], "xyz"[a], fewestAcross * strides.front());
    return "";
  }

  /// Nodes of all pictures, as far as they can be foreseen.
  [[nodiscard]] double foreseen()
  {
    double nodes = 0;
    for (const int stride : strides)
      if (serves(stride))
        nodes +=
          static_cast<double>(starts(stride).size()) * static_cast<double>(thinned(lattice_, thinning(stride)).count());
    return nodes;
  }

  /// @param progress told the nodes of all pictures before one and its own
  /// @return of every second pixel first; none where all the work went before one was solved
  std::vector<elasticity::SubsampleTensors> solve(
    const std::function<std::function<bool(double)>(double, double)>& progress, StiffnessResult& r)
  {
    std::vector<elasticity::SubsampleTensors> answers;
    double left = workOfEstimate * workOf(r.steps.front());
    double done = 0;
    for (const int stride : strides)
    {
      if (!serves(stride))
        continue;
      CellThinning t = thinning(stride);
      elasticity::SubsampleTensors answer{ t.pixels.stride, {} };
      StiffnessStep sum{ t.pixels.stride, 0, 0, {}, {}, 0 };
      for (const auto& first : starts(stride))
      {
        t.first = first;
        const Lattice lattice = thinned(lattice_, t);
        const auto nodes = static_cast<double>(lattice.count());
        const double most = left / nodes - workOfSetup; // iterations of all strains
        if (most < 1)
          return answers;
        try
        {
          const StiffnessStep step = solveOne(t, static_cast<std::int64_t>(most), progress(done, nodes));
          left -= workOf(step);
          answer.tensors.push_back(step.stiffness);
          add(sum, step);
        }
        catch (const DivergenceError&)
        {
          return answers;
        }
        done += nodes;
      }
      for (double& c : sum.stiffness)
        c /= sum.pictures;
      r.steps.push_back(sum);
      answers.push_back(std::move(answer));
    }
    return answers;
  }

private:
  [[nodiscard]] bool serves(std::size_t axis, int stride) const
  {
    return !matters_[axis] || pixels_.size[axis] >= stride * fewestAcross;
  }
  [[nodiscard]] bool serves(int stride) const
  {
    for (std::size_t a = 0; a < static_cast<std::size_t>(lattice_.dimension); ++a)
      if (!serves(a, stride))
        return false;
    return true;
  }

  [[nodiscard]] CellThinning thinning(int stride) const
  {
    CellThinning t{ periodicThinning(pixels_, stride, matters_), {}, options_.nodesPerPixel, { 1, 1, 1 } };
    const std::int64_t layers = Stencil(lattice_.dimension, model_.horizon).layers();
    for (std::size_t a = 0; a < static_cast<std::size_t>(lattice_.dimension); ++a)
      t.times[a] = layers / (t.pixels.size[a] * t.split) + 1;
    return t;
  }

  /// Along an axis that does not matter all are alike.
  [[nodiscard]] std::vector<std::array<std::int64_t, 3>> starts(int stride) const
  {
    Lattice lattice = pixels_;
    for (std::size_t a = 0; a < static_cast<std::size_t>(lattice.dimension); ++a)
      lattice.size[a] = matters_[a] ? lattice.size[a] : 1;
    return subsampleStarts(lattice, stride, fewPictures);
  }

  StiffnessStep solveOne(const CellThinning& t, std::int64_t most, const std::function<bool(double)>& progress) const
  {
    const double start = lamella::seconds();
    const CellWindow window = thinned(lattice_, slab_, phase_, grain_, t, all_);
    const Lattice& lattice = window.lattice;
    const Stencil stencil(lattice.dimension, model_.horizon);
    const std::int64_t layers = lattice.size[lattice.dimension == 3 ? 2 : 1];
    // small ones are not shared out, each rank does the same: in thin slabs multigrid does not get far
    const bool together =
      !all_.parallel() || (layers / all_.size() >= 8 * stencil.layers() && lattice.count() >= fewestShared);
    const Communicator& comm = together ? all_ : alone_;
    const CellWindow mine = partOf(window, slab(lattice, stencil, comm));
    EquilibriumOptions equilibrium = options_.equilibrium;
    equilibrium.maxIterations = std::min<std::int64_t>(equilibrium.maxIterations, most);
    equilibrium.progress = together ? progress : nullptr; // a rank that stops alone would leave the others waiting
    try
    {
      const BondLattice bonds(model_, lattice, mine.phase, mine.grain, comm);
      return stepOf(effectiveStiffness(bonds, equilibrium), lattice, lamella::seconds() - start);
    }
    catch (const NoPathError&)
    {
    }
    catch (const InputError&) // no solid node is left
    {
    }
    const std::size_t n = lattice.dimension == 3 ? 6 : 3;
    return { 1, 1, lattice.count(), std::vector<double>(n * n, 0.0), {}, lamella::seconds() - start };
  }

  static void add(StiffnessStep& sum, const StiffnessStep& one)
  {
    ++sum.pictures;
    sum.nodes += one.nodes;
    sum.seconds += one.seconds;
    sum.stiffness.resize(one.stiffness.size(), 0.0);
    for (std::size_t i = 0; i < one.stiffness.size(); ++i)
      sum.stiffness[i] += one.stiffness[i];
    sum.iterations.resize(std::max(sum.iterations.size(), one.iterations.size()), 0);
    for (std::size_t i = 0; i < one.iterations.size(); ++i)
      sum.iterations[i] += one.iterations[i];
  }

  const BondModel& model_;
  const Lattice& lattice_;
  Lattice pixels_;
  std::span<const std::uint8_t> phase_;
  std::span<const std::int32_t> grain_;
  const StiffnessOptions& options_;
  const Communicator& all_;
  Communicator alone_;
  Block slab_;
  std::array<bool, 3> matters_{ true, true, true }; ///< whether the picture changes along an axis
};

constexpr std::int64_t manyIterations = 200;

/// What the residual, which counts over the forces of the mean strain, may leave of a component far below Voigt's
/// bound.
std::string doubtOfSolver(const EffectiveStiffness& cell, int dimension)
{
  constexpr double noted = 0.01;
  const std::vector<std::string> names = elasticity::voigtNames(dimension);
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
    "of it: ask for a smaller tolerance, or take it for none",
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
  const std::vector<std::string> sides = elasticity::sideWarnings(r.sides, dimension);
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
  const auto nodes = static_cast<double>(
    NodeLayout::largestPart(lattice.dimension, stencil.layers(), lattice.size, ranks, model.periodic[0]).count());
  // the mean strain's displacements and its load, and which nodes are loose
  return elasticBytes(model, lattice, grains, elastic, ranks) + nodes * (2 * 8 * lattice.dimension + 1);
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

  // in nodes: the cell, and before it is solved what its coarser pictures are thought to have
  const auto own = static_cast<double>(lattice.count());
  const double all = own * (options.estimateError ? 2 : 1);
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

  const double start = lamella::seconds();
  const auto unknown = [&](const std::string& why) { r.warnings.push_back("the error is not known: " + why); };
  // of the values, which may be the lesser for it
  const double anisotropy = latticeModuli(bondStencil(model), model.continuum).worst;
  CoarserPictures coarser(model, lattice, phase, grain, options, comm);
  if (const std::string why = coarser.missing(r); !why.empty())
    unknown(why);
  else if (!(anisotropy < 1))
    unknown(fmt::format("at a horizon of {:g} spacings there are strains that no bond resists", model.horizon));
  else
    try
    {
      const double ahead = std::max(1.0, coarser.foreseen());
      const auto told = [&](double done, double nodes)
      { return stretch(own + own * done / ahead, own * nodes / ahead); };
      const std::vector<elasticity::SubsampleTensors> tensors = coarser.solve(told, r);
      if (tensors.empty())
        unknown(
          fmt::format("coarser pictures of the cell took {:g} times its own work and were not done", workOfEstimate));
      else
        r.error = elasticity::stiffnessError(r.cell.stiffness, tensors, d,
          { leftOverChange, anisotropy / (1 - anisotropy), std::max(1e-10, 10 * options.equilibrium.tolerance) });
    }
    catch (const Cancelled&)
    {
      throw;
    }
    catch (const Error& error) // the answer itself is there
    {
      unknown(error.what());
    }
  r.estimateSeconds = lamella::seconds() - start;
  return r;
}

} // namespace lamella::peridynamics
