#include "peridynamics/ElasticStudy.h"

#include "core/Clock.h"
#include "core/Error.h"
#include "core/Memory.h"
#include "peridynamics/BondForces.h"
#include "peridynamics/PairTable.h"
#include "peridynamics/fracture/PlatenForce.h"
#include "peridynamics/multigrid/LevelSizes.h"

#include <fmt/format.h>

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lamella::peridynamics
{
namespace
{

void checkLoad(const Loading& loading)
{
  if (loading.load == LoadCase::Pressure) // applyLoading() looks at it
    return;
  const bool traction = loading.load == LoadCase::Traction;
  if (traction ? loading.traction == 0 : loading.strain == 0)
    throw ParameterError(fmt::format("the {} is 0: nothing is loaded", traction ? "traction" : "strain"),
      traction ? "give it in Pa, tension positive" : "give a strain, such as 1e-3; tension is positive");
}

/// Forces on the nodes, linear or not.
NodeField<double> forces(const BondLattice& bonds, const NodeField<double>& u, bool nonlinear)
{
  NodeField<double> f(bonds.layout());
  if (nonlinear)
    nonlinearForce(bonds, u, f);
  else
    linearForce(bonds, u, f);
  return f;
}

/// Σ of the nodes' stresses over their number, which is −Σ f ⊗ (x + u) over the volume: what is left of Σ f ⊗ (ξ + η)
/// over all bonds when each bond's sum is split between its ends. Bonds across a periodic side have no such split.
std::array<double, 6> meanFromForces(
  const BondLattice& bonds, const NodeField<double>& f, const NodeField<double>& u, bool nonlinear)
{
  const NodeLayout& l = bonds.layout();
  std::vector<std::array<double, 6>> rows(static_cast<std::size_t>(l.size[1] * l.size[2]));
#pragma omp parallel for schedule(static)
  for (std::int64_t r = 0; r < l.size[1] * l.size[2]; ++r)
  {
    std::array<double, 6> sum{};
    for (std::int64_t n = 0; n < l.size[0]; ++n)
    {
      const std::int64_t i = l.index(n, r % l.size[1], r / l.size[1]);
      const std::array<std::int64_t, 3> node{ n + l.start[0], r % l.size[1] + l.start[1], r / l.size[1] + l.start[2] };
      std::array<double, 3> x{};
      std::array<double, 3> force{};
      for (int c = 0; c < l.dimension; ++c)
      {
        const auto a = static_cast<std::size_t>(c);
        x[a] = bonds.spacing() * static_cast<double>(node[a]) + (nonlinear ? u.component(c)[i] : 0);
        force[a] = f.component(c)[i];
      }
      for (std::size_t a = 0; a < 3; ++a)
      {
        const std::size_t b = (a + 1) % 3;
        sum[a] -= force[a] * x[a];
        sum[3 + a] -= 0.5 * (force[a] * x[b] + force[b] * x[a]); // xy, yz, zx
      }
    }
    rows[static_cast<std::size_t>(r)] = sum;
  }
  std::array<double, 6> total{};
  for (const auto& row : rows)
    for (std::size_t c = 0; c < 6; ++c)
      total[c] += row[c];
  return total;
}

/// A sum over the nodes of this rank, of stress times volume, as the mean over the box.
std::array<double, 6> ofBox(const BondLattice& bonds, std::array<double, 6> sum, Continuum continuum)
{
  const NodeLayout& l = bonds.layout();
  bonds.communicator().sum(sum);
  for (double& value : sum)
    value /= std::pow(bonds.spacing(), l.dimension) * static_cast<double>(l.global[0] * l.global[1] * l.global[2]);
  if (continuum == Continuum::PlaneStrain)
    sum[2] = poissonsRatio(continuum) * (sum[0] + sum[1]);
  return sum;
}

/// Mean displacement of the high platen's solid nodes.
double movement(const BondLattice& bonds, const ElasticResult& r)
{
  const NodeLayout& l = bonds.layout();
  const auto a = static_cast<std::size_t>(r.axis);
  std::array<double, 2> sums{};
  for (std::int64_t z = 0; z < l.size[2]; ++z)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
      for (std::int64_t x = 0; x < l.size[0]; ++x)
      {
        const std::array<std::int64_t, 3> node{ x + l.start[0], y + l.start[1], z + l.start[2] };
        const std::int64_t i = l.index(x, y, z);
        if (node[a] != r.highPlaten[0] || !bonds.solid(i))
          continue;
        sums[0] += r.displacement.component(r.across)[i];
        sums[1] += 1;
      }
  bonds.communicator().sum(sums);
  return sums[1] > 0 ? sums[0] / sums[1] : 0;
}

std::optional<FirstBreak> firstBreak(const BondLattice& bonds, const Lattice& lattice,
  std::span<const std::uint8_t> phase, const StretchMaximum& most, const ElasticResult& r)
{
  if (!most.bond)
    return std::nullopt;
  FirstBreak first;
  first.ratio = most.ratio;
  first.strain = r.strain / most.ratio;
  first.stress = r.effectiveStress / most.ratio;
  first.bond = *most.bond;
  const Offset& o = bonds.stencil().half()[static_cast<std::size_t>(first.bond.offset)];
  const NodeLayout& l = bonds.layout();
  std::array<double, 2> ids{ -1, -1 };
  for (int end = 0; end < 2; ++end)
  {
    std::array<std::int64_t, 3> node = first.bond.node;
    for (std::size_t a = 0; a < 3; ++a)
    {
      node[a] += end * o.step[a];
      node[a] = (node[a] + l.global[a]) % l.global[a] - l.start[a];
    }
    if (l.ownedNode(node))
      ids[static_cast<std::size_t>(end)] =
        phase[static_cast<std::size_t>((node[2] * l.size[1] + node[1]) * l.size[0] + node[0])];
    first.phases[static_cast<std::size_t>(end)] =
      static_cast<std::uint8_t>(bonds.communicator().max(ids[static_cast<std::size_t>(end)]));
  }
  for (std::size_t a = 0; a < static_cast<std::size_t>(lattice.dimension); ++a)
    first.position[a] =
      lattice.origin[a] + lattice.spacing * (static_cast<double>(first.bond.node[a]) + 0.5 * o.step[a]);
  return first;
}

std::vector<std::string> warningsOf(const BondModel& model, const ElasticResult& r, bool twoPlatens)
{
  std::vector<std::string> warnings = modelWarnings(model, r.thickness);
  if (r.loosePieces > 0)
    warnings.push_back(looseWarning(r.loosePieces, r.looseNodes, r.solidNodes));
  if (r.openNodes > 0)
    warnings.push_back(openWarning(r.openNodes));
  if (r.solve.hinges > 0)
    warnings.push_back(
      fmt::format("{} nodes hang on too few bonds to resist in every direction: they follow where nothing resists",
        r.solve.hinges));
  // The residual counts over the forces that hold the stiffest nodes, which can be far above the load itself.
  double stiffest = 0;
  for (const auto& [ids, pair] : model.pairs)
    stiffest = std::max(stiffest, pair.material.youngsModulus);
  constexpr double noted = 0.01;
  const auto along = static_cast<std::size_t>(r.across);
  const double low = r.reactions.low[along];
  const double high = r.reactions.high[along];
  if (twoPlatens && std::abs(low + high) > noted * std::max(std::abs(low), std::abs(high)))
    warnings.push_back(fmt::format("the platens pull with {:.4g} and {:.4g} N, which should be opposite: the load is "
                                   "within the solver's tolerance of "
                                   "nothing. Ask for a smaller tolerance, or make the phases less different",
      low, high));
  // A board of diagonals, say, that turn into each other without force: what is left is the residual, of either sign.
  else if (r.effectiveModulus < r.solve.residual * stiffest)
    warnings.push_back(
      fmt::format("a modulus of {:.4g} Pa is within the solver's tolerance of nothing: either nothing carries the "
                  "load, or a smaller tolerance tells what does",
        r.effectiveModulus));
  else if (const std::string text = doubtWarning(r.solve.doubt, !twoPlatens); !text.empty())
    warnings.push_back(text);
  return warnings;
}

} // namespace

std::string doubtWarning(double doubt, bool traction)
{
  constexpr double noted = 1e-3;
  if (!(doubt > noted))
    return "";
  return fmt::format("{}: the modulus may be off by as much. Ask for a smaller tolerance, or make the phases less "
                     "different",
    traction ? fmt::format("the forces that are not in balance do {:.2g} times the work of the load", doubt)
             : fmt::format("forces through sections of the sample differ by {:.2g} times that on the platens", doubt));
}

std::array<double, 6> meanStress(const BondLattice& bonds, const NodeField<double>& stress, Continuum continuum)
{
  const NodeLayout& l = bonds.layout();
  const bool flat = l.dimension == 2;
  constexpr std::array<std::size_t, 3> place{ 0, 1, 3 }; // of xx, yy, xy
  std::array<double, 6> total{};
  for (int c = 0; c < stress.components(); ++c)
  {
    double sum = 0;
    for (std::int64_t r = 0; r < l.size[1] * l.size[2]; ++r)
    {
      const double* row = stress.component(c) + l.index(0, r % l.size[1], r / l.size[1]);
      double part = 0;
      for (std::int64_t x = 0; x < l.size[0]; ++x)
        part += row[x];
      sum += part;
    }
    total[flat ? place[static_cast<std::size_t>(c)] : static_cast<std::size_t>(c)] =
      sum * std::pow(bonds.spacing(), l.dimension);
  }
  return ofBox(bonds, total, continuum);
}

std::array<double, 6> meanStress(const BondLattice& bonds, const NodeField<double>& force,
  const NodeField<double>& displacement, bool nonlinear, Continuum continuum)
{
  return ofBox(bonds, meanFromForces(bonds, force, displacement, nonlinear), continuum);
}

ThreadScope::ThreadScope(int count)
  : before_(omp_get_max_threads())
{
  if (count > 0)
    omp_set_num_threads(count);
}

ThreadScope::~ThreadScope()
{
  omp_set_num_threads(before_);
}

void requireMemory(
  const char* what, const Lattice& lattice, double need, double given, const Communicator& comm, const char* remedy)
{
  const double available = given > 0 ? given : static_cast<double>(availableMemory());
  if (comm.any(need > available))
    throw MemoryError(fmt::format("the {} of {} nodes needs {} of memory on each of {} ranks, and {} are free", what,
                        lattice.count(), bytesText(need), comm.size(), bytesText(available)),
      remedy);
}

std::string looseWarning(std::int64_t pieces, std::int64_t nodes, std::int64_t solidNodes)
{
  return fmt::format(
    "{} loose pieces with {} nodes ({:.2g} % of the solid) hang on no platen and were taken out: they carry nothing",
    pieces, nodes, 100.0 * static_cast<double>(nodes) / static_cast<double>(solidNodes));
}

std::string openWarning(std::int64_t nodes)
{
  return fmt::format("{} nodes of the phases under pressure lie in pores that are open, to a free side or to another "
                     "empty phase: these hold none",
    nodes);
}

std::string horizonWarning(const BondModel& model)
{
  const Stencil stencil = bondStencil(model);
  const LatticeModuli m = latticeModuli(stencil, model.continuum);
  constexpr double roundOff = 1e-9;
  if (m.worst < roundOff)
    return "";
  if (model.micromodulus == Micromodulus::Isotropic)
    return fmt::format(
      "a horizon of {:g} spacings has bonds along the axes only, which no micromodulus makes isotropic: "
      "nothing resists shear. Take 1.5 or more",
      model.horizon);
  if (model.horizon < 3)
    return fmt::format("a horizon of {:g} spacings is below 3: the lattice is not isotropic (Young's modulus at 45° is "
                       "{:.2f} of that along the axes). An isotropic micromodulus mends it",
      model.horizon, m.youngsModulusDiagonal / m.youngsModulus);
  if (model.continuum != Continuum::Space)
    return "";
  return fmt::format(
    "the lattice of bonds is not isotropic: at a horizon of {:g} spacings Young's modulus at 45° is "
    "{:.3f} of that along the axes, and strains are resisted with up to {:.2g} % more or less than they "
    "should be. An isotropic micromodulus mends it",
    model.horizon, m.youngsModulusDiagonal / m.youngsModulus, 100 * m.worst);
}

std::vector<std::string> modelWarnings(const BondModel& model, const std::vector<PhaseThickness>& thickness)
{
  std::vector<std::string> warnings;
  if (const std::string text = horizonWarning(model); !text.empty())
    warnings.push_back(text);
  // thinner than the horizon in a good part: a disk has such nodes at its four tips only. Where bonds between grains
  // have a material of their own, those that jump over a layer have it too.
  for (const PhaseThickness& t : thickness)
    if (t.thinShare > 0.25 && !model.pairByGrain)
      warnings.push_back(fmt::format(
        "{} is {:g} nodes thick (median; {:.0f} % of its nodes lie where it is thinner than the horizon of "
        "{:g}): bonds jump over it. Refine the picture, or give bonds between grains a material of their own",
        pairName(model, t.phase, t.phase), t.median, 100 * t.thinShare, model.horizon));
  return warnings;
}

namespace
{

/// u, residual, direction, product, and one more while they are made; which nodes are fixed
double vectorBytesPerNode(int dimension)
{
  return 8 * dimension * 5 + 1;
}

} // namespace

double leastElasticBytes(const Lattice& lattice, double horizon, int refinement)
{
  const Stencil stencil(lattice.dimension, horizon);
  const auto words = static_cast<double>((stencil.half().size() + 31) / 32);
  const double nodes = static_cast<double>(lattice.count()) * std::pow(refinement, lattice.dimension);
  return nodes * (4 * words + 1 + vectorBytesPerNode(lattice.dimension));
}

double elasticBytes(
  const BondModel& model, const Lattice& lattice, bool grains, const ElasticOptions& options, int ranks)
{
  const double bonds = BondLattice::bytesNeeded(model, lattice, ranks, grains);
  const Stencil stencil(lattice.dimension, model.horizon);
  const NodeLayout layout =
    NodeLayout::largestPart(lattice.dimension, stencil.layers(), lattice.size, ranks, model.periodic[0]);
  const auto nodes = static_cast<double>(layout.count());
  const double d = lattice.dimension;
  double levels = 0; // of multigrid
  double perNode = vectorBytesPerNode(lattice.dimension);
  switch (options.equilibrium.solver)
  {
    case EquilibriumSolver::Multigrid:
    {
      const bool rim = ranks > 1 || std::any_of(model.periodic.begin(), model.periodic.end(), [](bool p) { return p; });
      const MultigridBytes all = multigridBytes(levelLayouts(layout, ranks > 1), rim);
      levels = all.held + all.making;
      break;
    }
    case EquilibriumSolver::Jacobi:
      perNode += 4 * (d * d + 2 * d);
      break;
    case EquilibriumSolver::Direct:
      perNode += 12 * d * d * static_cast<double>(stencil.bondsPerNode()) * 20; // fill-in of small samples
      break;
    case EquilibriumSolver::DynamicRelaxation:
      perNode += 8 * 3 * d;
  }
  if (options.equilibrium.strains == Strains::Large)
    perNode += 8 * 3 * d;
  const double stress = d == 2 ? 3 : 6;
  perNode += 8 * ((options.stress ? stress : 0) + (options.energyDensity ? 1 : 0));
  perNode += options.sensitivity ? 8 * 2 * d : 0;                        // the adjoint and its load
  perNode += options.loading.load == LoadCase::Pressure ? 8 * d + 2 : 0; // its forces, and which nodes are pores
  return bonds + levels + nodes * perNode;
}

ElasticResult studyElastic(const BondModel& asked, const Lattice& lattice, std::span<const std::uint8_t> phase,
  std::span<const std::int32_t> grain, const ElasticOptions& options, const Communicator& comm)
{
  checkLoad(options.loading);
  const bool pressure = options.loading.load == LoadCase::Pressure;
  if (pressure && options.equilibrium.strains == Strains::Large)
    throw ParameterError("a pressure in large strains, where it would turn with the surfaces",
      "leave large strains out: the pressure acts on the surfaces as they are without a load");
  if (pressure && options.equilibrium.solver == EquilibriumSolver::Direct && !options.loading.straightSides)
    throw ParameterError("the direct solver of a sample that nothing holds: its matrix is singular",
      "use the multigrid solver, or straight sides");
  if (options.sensitivity && options.equilibrium.strains == Strains::Large)
    throw ParameterError("a sensitivity of the first break in large strains, where none is found",
      "leave the sensitivity or the large strains out");
  BondModel model = asked;
  if (!options.sensitivity)
    model.pairGroups.clear();
  else if (model.pairGroups.empty())
  {
    model.pairGroups.resize(describePairs(model, lattice.spacing).size());
    std::iota(model.pairGroups.begin(), model.pairGroups.end(), 0);
  }
  const ThreadScope threads(options.threads);
  requireMemory(
    "equilibrium", lattice, elasticBytes(model, lattice, !grain.empty(), options, comm.size()), options.memory, comm);
  ElasticResult r;
  const bool nonlinear = options.equilibrium.strains == Strains::Large;
  double start = lamella::seconds();
  const auto lap = [&start]
  {
    const double before = start;
    start = lamella::seconds();
    return start - before;
  };
  const BondLattice bonds(model, lattice, phase, grain, comm);
  r.bondSeconds = lap();
  LoadedSample sample = applyLoading(bonds, options.loading, phase);
  r.loadSeconds = lap();

  const int d = lattice.dimension;
  r.axis = options.loading.axis < 0 ? d - 1 : options.loading.axis;
  r.across = options.loading.load == LoadCase::Shear ? (r.axis + 1) % d : r.axis;
  r.lowPlaten = sample.lowLayers;
  r.highPlaten = sample.highLayers;
  r.loosePieces = sample.loosePieces;
  r.looseNodes = sample.looseNodes;
  if (sample.pores)
  {
    r.poreVolume = sample.pores->volume();
    r.openNodes = sample.pores->openNodes();
  }
  r.area = 1;
  for (int c = 0; c < d; ++c)
    r.area *= c == r.axis ? 1 : lattice.length(c);
  r.length =
    pressure ? lattice.length(r.axis) : static_cast<double>(r.highPlaten[0] - r.lowPlaten[1] + 1) * lattice.spacing;
  std::optional<Equilibrium> equilibrium;
  {
    EquilibriumOptions equilibriumOptions = options.equilibrium;
    std::optional<PlatenForce> platens;
    if (!sample.load)
    {
      platens.emplace(bonds, options.loading, sample);
      equilibriumOptions.doubt = [&](const NodeField<double>&, const NodeField<double>& force)
      { return platens->imbalance(bonds, force); };
    }
    else
      equilibriumOptions.doubt = [&](const NodeField<double>& u, const NodeField<double>& force)
      { return workOfResidual(bonds, sample, u, force); };
    equilibrium.emplace(bonds, sample.fixed, equilibriumOptions);
    try
    {
      r.solve = equilibrium->solve(sample.displacement, sample.load ? &*sample.load : nullptr);
    }
    catch (const DivergenceError& e)
    {
      if (!pressure)
        throw;
      throw DivergenceError(
        fmt::format("parts of the sample seem to move without end under the pressure: {}", e.what()),
        "walls that are a node thin, or hang by hinges, close a pore: straight sides, another window, or thicker "
        "walls");
    }
    equilibrium->setDoubt({}); // what it looks at goes
    if (!options.sensitivity)
      equilibrium.reset();
  }
  if (!sample.held)
    takeOutRigidMotion(bonds, *sample.pores, sample.displacement);
  const double grown = pressure ? poreStrain(bonds, sample, sample.displacement) : 0;
  r.displacement = std::move(sample.displacement);
  lap();
  const StretchMaximum most = largestStretch(bonds, r.displacement, nonlinear);

  const NodeField<double> f = forces(bonds, r.displacement, nonlinear);
  r.reactions.low = layerSum(bonds, f, r.axis, r.lowPlaten[0], r.lowPlaten[1]);
  r.reactions.high = layerSum(bonds, f, r.axis, r.highPlaten[0], r.highPlaten[1]);
  const bool traction = options.loading.load == LoadCase::Traction;
  r.strain = pressure ? grown : traction ? movement(bonds, r) / r.length : options.loading.strain;
  // the sample pulls the low platen up and the high one down
  r.effectiveStress =
    pressure ? options.loading.pressure : -r.reactions.high[static_cast<std::size_t>(r.across)] / r.area;
  r.effectiveModulus = r.effectiveStress / r.strain;
  if (options.sensitivity && most.bond)
  {
    r.measureSeconds = lap();
    const bool platen = !pressure && !traction;
    const bool alone = platen && (options.loading.load != LoadCase::Biaxial || options.loading.lateralStrain == 0);
    r.sensitivity =
      breakSensitivity(bonds, BondKinds(model, bonds.stencil(), lattice.spacing).ofPairs(), *equilibrium, sample,
        { r.displacement, f, *most.bond, r.axis, r.across,
          platen ? -r.reactions.high[static_cast<std::size_t>(r.across)] : 0, alone ? r.strain * r.length : 0 });
    r.sensitivitySeconds = lap();
  }
  equilibrium.reset();
  r.elasticEnergy = elasticEnergy(bonds, r.displacement, nonlinear);
  if (options.stress)
  {
    r.stress.emplace(bonds.layout(), d == 2 ? 3 : 6);
    nodalStress(bonds, r.displacement, *r.stress, nonlinear);
  }
  if (options.energyDensity)
  {
    r.energyDensity.emplace(bonds.layout(), 1);
    energyDensity(bonds, r.displacement, *r.energyDensity, nonlinear);
  }
  if (bonds.periodic() == std::array{ false, false, false })
    r.meanStress = meanStress(bonds, f, r.displacement, nonlinear, model.continuum);
  else if (r.stress)
    r.meanStress = meanStress(bonds, *r.stress, model.continuum);
  else
  {
    NodeField<double> stress(bonds.layout(), d == 2 ? 3 : 6);
    nodalStress(bonds, r.displacement, stress, nonlinear);
    r.meanStress = meanStress(bonds, stress, model.continuum);
  }

  r.largestRatio = most.ratio;
  if (!nonlinear)
    r.firstBreak = firstBreak(bonds, lattice, phase, most, r);
  static_cast<SampleCounts&>(r) = countSample(bonds, model, phase);
  const std::int64_t fields =
    (1 + (options.stress ? (d == 2 ? 3 : 6) : 0) + (options.energyDensity ? 1 : 0)) * bonds.layout().count() * 8;
  r.bytes = comm.sum(bonds.bytes() + r.solve.bytes + fields);
  r.warnings = warningsOf(model, r, !traction && !pressure);
  r.measureSeconds += lap();
  return r;
}

} // namespace lamella::peridynamics
