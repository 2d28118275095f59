#include "lbm/SteadyDiffusion.h"

#include "core/Clock.h"
#include "core/Error.h"
#include "core/Memory.h"
#include "core/Passes.h"
#include "lattice/PlaneParts.h"
#include "lbm/Backend.h"
#include "lbm/CompactSystem.h"
#include "lbm/Connectivity.h"
#include "lbm/DirectedLinks.h"
#include "lbm/MultigridSystem.h"
#include "lbm/SurfaceDerivatives.h"
#include "lbm/elements/ElementSystem.h"
#include "lbm/lean/LeanSystem.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace lamella::lbm
{
namespace
{

// Iterations after which multigrid is left for algebraic multigrid when the choice is ours.
constexpr int patience = 100;

// Of the edges of a voxel.
constexpr double mostUnlike = 1000;

// Relative error of a field in single precision in the energy norm, with something to spare.
constexpr double leanField = 1e-5;

int dimensionOf(Stencil stencil)
{
  return stencil == Stencil::D2Q5 || stencil == Stencil::D2Q9 ? 2 : 3;
}

} // namespace

const char* name(Stencil stencil) noexcept
{
  switch (stencil)
  {
    case Stencil::D2Q5:
      return "d2q5";
    case Stencil::D2Q9:
      return "d2q9";
    case Stencil::D3Q7:
      return "d3q7";
    case Stencil::D3Q19:
      return "d3q19";
    case Stencil::Q1:
      return "q1";
  }
  return "";
}

const char* name(Method method) noexcept
{
  switch (method)
  {
    case Method::Auto:
      return "auto";
    case Method::LeanMultigrid:
      return "lean-multigrid";
    case Method::PieceMultigrid:
      return "piece-multigrid";
    case Method::Multigrid:
      return "multigrid";
    case Method::AlgebraicMultigrid:
      return "algebraic-multigrid";
  }
  return "";
}

double Problem::contrast() const
{
  double least = std::numeric_limits<double>::infinity();
  double most = 0;
  const auto see = [&](std::span<const double> values)
  {
    for (const double k : values)
      if (k > 0)
      {
        least = std::min(least, k);
        most = std::max(most, k);
      }
  };
  if (table != nullptr)
    for (const auto* links : { &table->x, &table->y, &table->rising, &table->falling })
      see(*links);
  else if (options.pairs)
    see(options.pairs->link);
  else
    see(diffusivity);
  return most / least;
}

void setEffective(SteadyResult& result, const FieldSums& sums, const Lattice& lattice, int axis, double scale)
{
  const double n = static_cast<double>(lattice.size[axis]);
  const double nodes = static_cast<double>(lattice.count());
  // flux through a face of nodes / n nodes, over a gradient of 1 / n; links carry (δ_x / δ_a)²
  const double stretch = lattice.aspect[axis] / lattice.aspect[0];
  const double perFace = scale * n * n / nodes * stretch * stretch;
  const double energy = sums.energy * perFace;
  result.inletFlux = sums.inlet * perFace;
  result.outletFlux = sums.outlet * perFace;
  for (int a = 0; a < 3; ++a)
    result.effective[a] = sums.flux[a] * scale * n / nodes * stretch * lattice.aspect[a] / lattice.aspect[0];
  result.effective[axis] = energy;
  result.balance = energy > 0
    ? std::max(std::abs(result.inletFlux - energy), std::abs(result.outletFlux - energy)) / energy
    : std::numeric_limits<double>::quiet_NaN();
}

std::array<double, 3> fluxUnits(const Links& links, const Lattice& lattice) noexcept
{
  std::array<double, 3> units{};
  for (int a = 0; a < 3; ++a)
    units[static_cast<std::size_t>(a)] = links.scale() / (links.factor(a) * lattice.spacingAlong(a));
  return units;
}

void reportProgress(const SteadyOptions& options, const Communicator& comm, double fraction, const char* what)
{
  if (!options.progress)
    return;
  if (comm.any(!options.progress(fraction, what)))
    throw Cancelled();
}

double progressOf(double error, double wanted)
{
  if (!(error > 0) || error <= wanted)
    return 1.0;
  return std::clamp(std::log(error) / std::log(wanted), 0.05, 0.99);
}

struct SteadyDiffusion::Impl
{
  Lattice lattice;
  Communicator comm;
  Decomposition parts;
  std::vector<std::uint8_t> own; ///< phases that were handed over
  std::span<const std::uint8_t> phase;
  std::vector<double> diffusivity;
  SteadyOptions options;
  bool allConduct = true;
  std::int64_t conducting = 0;
  std::unique_ptr<Backend> backend;
  double effective = 0; ///< of the last solve, along its axis
  int axis = 0;

  Impl(const Lattice& box, MPI_Comm handle)
    : lattice(box)
    , comm(handle)
    , parts(box, comm)
  {
  }

  [[nodiscard]] Problem problem(int axis) const
  {
    return Problem{ lattice, parts, comm, options, phase, diffusivity, axis, options.links.get() };
  }

  /// Of layers of this rank's block; none where they are not in it.
  [[nodiscard]] std::size_t nodes(Layers layers) const
  {
    const auto& size = parts.block().size;
    const bool inside = layers.first >= 0 && layers.first <= layers.last && layers.last <= size[2];
    return inside ? static_cast<std::size_t>(size[0] * size[1] * (layers.last - layers.first)) : 0;
  }

  /// The ways to try, the leanest first; what is too much for one is left to the next.
  [[nodiscard]] std::vector<Method> ways(int axis) const
  {
    if (options.stencil == Stencil::Q1)
    {
      if (options.method != Method::Auto && options.method != Method::Multigrid)
        throw ParameterError(fmt::format("{} on elements", lbm::name(options.method)), "leave the method at auto");
      return { Method::Multigrid };
    }
    const bool halves = allConduct && multigridFits(lattice, options.sides);
    const bool lean = halves && leanFits(problem(axis));
    const auto refuse = [&](Method way, const char* where)
    {
      throw ParameterError(allConduct || way == Method::PieceMultigrid
          ? fmt::format("{} cannot take a {}lattice of {} × {} × {} nodes{}", lbm::name(way),
              options.sides == Sides::Insulated ? "" : "periodic ", lattice.size[0], lattice.size[1], lattice.size[2],
              where)
          : std::string("geometric multigrid needs every phase to conduct, and one has conductivity 0"),
        "leave the method at auto: another one solves it");
    };
    switch (options.method)
    {
      case Method::LeanMultigrid:
        if (!lean)
          refuse(Method::LeanMultigrid,
            ": it needs straight links, 8 rows a rank, spacings within a ratio of 2, conductivities within one of 1e8, "
            "and "
            "an even number of nodes where sides are periodic");
        return { options.method };
      case Method::PieceMultigrid:
        if (!piecesFit(problem(axis)))
          refuse(Method::PieceMultigrid,
            ": it needs straight links, 8 rows a rank, conductivities within a ratio of 1e8, and an even number of "
            "nodes where sides are periodic");
        return { options.method };
      case Method::Multigrid:
        if (!halves)
          refuse(Method::Multigrid, "");
        return { options.method };
      case Method::AlgebraicMultigrid:
        return { options.method };
      case Method::Auto:
        break;
    }
    // The lean ones for volumes: pictures are small, and exact in no time.
    std::vector<Method> all;
    const bool volume = lattice.dimension == 3;
    const Method exact = halves ? Method::Multigrid : Method::AlgebraicMultigrid;
    const bool enough = volume && (precisionOfLean() || !fits(exact));
    if (lean && enough)
      all.push_back(Method::LeanMultigrid);
    if (piecesFit(problem(axis)) && enough)
      all.push_back(Method::PieceMultigrid);
    if (halves)
      all.push_back(Method::Multigrid);
    all.push_back(Method::AlgebraicMultigrid);
    return all;
  }

  /// Is single precision enough for what is asked?
  [[nodiscard]] bool precisionOfLean() const
  {
    return options.fieldTolerance >= leanField && (options.sides != Sides::Periodic || options.tolerance >= leanField);
  }

  [[nodiscard]] std::uint64_t bytes(Method way) const
  {
    return estimateBytes(lattice, options.stencil, way, conducting);
  }
  [[nodiscard]] bool fits(Method way) const
  {
    constexpr std::uint64_t little = 1U << 24; // to ask how much is left would take longer than a small solve's set-up
    const int sharing = ranksSharing(lattice, options.stencil, comm.size());
    const std::uint64_t share = bytes(way) / static_cast<std::uint64_t>(sharing);
    return share <= little || !comm.any(share > availableMemory());
  }
};

namespace
{

std::unique_ptr<Backend> makeBackend(Method method, const Problem& problem)
{
  if (problem.options.stencil == Stencil::Q1)
    return makeElementSystem(problem);
  if (method == Method::LeanMultigrid)
    return makeLeanSystem(problem);
  if (method == Method::PieceMultigrid)
    return makePieceSystem(problem);
  return method == Method::Multigrid ? makeMultigridSystem(problem) : makeCompactSystem(problem);
}

void requirePairs(const SteadyOptions& options, std::span<const double> diffusivity)
{
  const PairTable& pairs = *options.pairs;
  if (options.stencil != Stencil::D2Q5 && options.stencil != Stencil::D3Q7)
    throw ParameterError(
      fmt::format("conductivities of links by pairs of phases were given for {}", name(options.stencil)),
      "they go with straight links: d2q5, d3q7");
  const std::size_t all = pairs.ids * pairs.ids;
  bool good = pairs.ids == diffusivity.size() && (pairs.link.size() == all || pairs.link.size() == 3 * all);
  for (std::size_t table = 0; good && table < pairs.link.size(); table += all)
    for (std::size_t a = 0; a < pairs.ids; ++a)
      for (std::size_t b = 0; b <= a; ++b)
      {
        const double g = pairs.link[table + a * pairs.ids + b];
        good = good && std::isfinite(g) && g >= 0 && g == pairs.link[table + b * pairs.ids + a] &&
          (a != b || g == diffusivity[a]);
      }
  if (!good)
    throw ParameterError("the table of links by pairs of phases does not fit the diffusivities",
      "give a symmetric table of finite values of at least 0, with the diffusivities on its diagonal, or one an axis");
}

void requireLinks(const Lattice& lattice, const SteadyOptions& options)
{
  const LinkTable& table = *options.links;
  const bool diagonals = options.stencil == Stencil::D2Q9;
  if ((options.stencil != Stencil::D2Q5 && !diagonals) || diagonals != !table.rising.empty())
    throw ParameterError(fmt::format("conductivities of single links {} diagonals were given for {}",
                           table.rising.empty() ? "without" : "with", name(options.stencil)),
      "without diagonals they go with d2q5, with diagonals with d2q9");
  const auto nx = static_cast<std::size_t>(lattice.size[0]);
  const auto ny = static_cast<std::size_t>(lattice.size[1]);
  const std::size_t corners = diagonals ? (nx + 1) * (ny + 1) : 0;
  if (table.size[0] != lattice.size[0] || table.size[1] != lattice.size[1] || table.x.size() != (nx + 1) * ny ||
    table.y.size() != nx * (ny + 1) || table.rising.size() != corners || table.falling.size() != corners)
    throw ParameterError(fmt::format("links of {} × {} nodes were given for a lattice of {} × {}", table.size[0],
                           table.size[1], lattice.size[0], lattice.size[1]),
      "give (nx + 1) ny along x, nx (ny + 1) along y and (nx + 1) (ny + 1) along each diagonal");
  for (const auto* values : { &table.x, &table.y, &table.rising, &table.falling })
    for (const double g : *values)
      if (!std::isfinite(g) || g < 0)
        throw ParameterError(fmt::format("a link has the conductivity {}", g), "give finite values of at least 0");
  if (options.sides == Sides::Mixed)
    throw ParameterError(
      "conductivities of single links were given for mixed sides", "take insulated or periodic sides");
  if (options.sides != Sides::Periodic)
    return;
  bool wraps = true;
  for (std::size_t j = 0; j < ny; ++j)
    wraps = wraps && table.x[(nx + 1) * j] == table.x[(nx + 1) * j + nx];
  for (std::size_t i = 0; i < nx; ++i)
    wraps = wraps && table.y[i] == table.y[i + nx * ny];
  for (const auto* values : { &table.rising, &table.falling })
    for (std::size_t j = 0; j <= ny && diagonals; ++j)
      for (std::size_t i = 0; i <= nx; ++i)
        wraps = wraps && (*values)[i + (nx + 1) * j] == (*values)[i % nx + (nx + 1) * (j % ny)];
  if (!wraps)
    throw ParameterError("links that differ on opposite sides were given for periodic sides",
      "the first link of a row or column and its last are one and the same: give them one value");
}

} // namespace

SteadyDiffusion::SteadyDiffusion(const Lattice& lattice, const Block& block, std::span<const std::uint8_t> phase,
  std::span<const double> diffusivity, SteadyOptions options, MPI_Comm comm)
  : impl_(std::make_unique<Impl>(lattice, comm))
{
  Impl& m = *impl_;
  if (options.stencil != Stencil::Q1 && dimensionOf(options.stencil) != lattice.dimension)
    throw ParameterError(
      fmt::format("lattice {} does not fit a {}-dimensional picture", name(options.stencil), lattice.dimension),
      lattice.dimension == 2 ? "use d2q5 or d2q9" : "use d3q7 or d3q19");
  const bool diagonals = options.stencil == Stencil::D2Q9 || options.stencil == Stencil::D3Q19;
  if (!lattice.cubes() && (options.links || diagonals))
    throw ParameterError(
      fmt::format("spacings that differ between axes ({}, {}, {}) go with straight links, not with {}",
        lattice.spacingAlong(0), lattice.spacingAlong(1), lattice.spacingAlong(2),
        options.links ? "links one by one" : name(options.stencil)),
      options.links              ? "resample the picture to square pixels"
        : lattice.dimension == 2 ? "use d2q5"
                                 : "use d3q7");
  for (int a = 0; a < lattice.dimension; ++a)
    if (const double ratio = lattice.aspect[static_cast<std::size_t>(a)] / lattice.aspect[0];
        !(ratio >= 0.999 / mostUnlike && ratio <= 1.001 * mostUnlike))
      throw ParameterError(
        fmt::format("voxels with edges of {:g} and {:g}", lattice.spacingAlong(0), lattice.spacingAlong(a)),
        fmt::format(
          "they may differ by a factor of {:g}: look at the distance of slices and the pixel size", mostUnlike));
  if (!(options.tolerance > 0) || options.tolerance >= 1)
    throw ParameterError(fmt::format("tolerance {} is not between 0 and 1", options.tolerance),
      "ask for the relative error of the face fluxes, for instance 1e-8");
  if (!(options.fieldTolerance > 0))
    throw ParameterError(fmt::format("field tolerance {} is not above 0", options.fieldTolerance),
      "ask for the relative error of the field's flux, for instance 1e-6, or infinity when the field does not matter");
  if (options.maxIterations < 1)
    throw ParameterError(fmt::format("{} iterations are too few", options.maxIterations), "allow at least 1");
  if (m.parts.block().size != block.size || m.parts.block().start != block.start)
    throw ParameterError("this rank's block is not the one of decompose()",
      "hand over the part of the lattice that decompose(lattice, comm) names");
  if (phase.size() != static_cast<std::size_t>(block.count()))
    throw ParameterError(fmt::format("{} phase ids were given for a block of {} nodes", phase.size(), block.count()),
      "hand over one id a node of this rank's block");
  for (std::size_t i = 0; i < diffusivity.size(); ++i)
    if (!std::isfinite(diffusivity[i]) || diffusivity[i] < 0)
      throw ParameterError(
        fmt::format("conductivity {} of phase {} is not a finite number of at least 0", diffusivity[i], i),
        "give a positive value, or 0 for a phase that does not conduct");

  std::array<double, 256> count{}; // of all ranks, so that all refuse what one of them has
  for (const std::uint8_t id : phase)
    ++count[id];
  m.comm.sum(count);
  for (std::size_t id = 0; id < count.size(); ++id)
  {
    if (count[id] > 0 && id >= diffusivity.size())
      throw ParameterError(fmt::format("phase {} has no conductivity", id), "give one value for each phase");
    if (id < diffusivity.size() && diffusivity[id] > 0)
      m.conducting += static_cast<std::int64_t>(count[id]);
  }
  m.allConduct = m.conducting == lattice.count();
  if (options.pairs)
    requirePairs(options, diffusivity);
  if (options.links)
  {
    requireLinks(lattice, options);
    const auto& table = *options.links;
    const auto open = [](double g) { return g > 0; };
    m.allConduct = m.conducting > 0 && std::all_of(table.x.begin(), table.x.end(), open) &&
      std::all_of(table.y.begin(), table.y.end(), open);
    if (!m.allConduct) // which nodes take part is not worth counting
      m.conducting = m.conducting > 0 ? lattice.count() : 0;
  }
  if (m.conducting == 0)
    throw NoPathError("no node of the picture conducts", "give at least one phase that occurs a conductivity above 0");
  m.phase = phase;
  m.diffusivity.assign(diffusivity.begin(), diffusivity.end());
  m.options = std::move(options);
}

SteadyDiffusion::SteadyDiffusion(const Lattice& lattice, const Block& block, std::vector<std::uint8_t>&& phase,
  std::span<const double> diffusivity, SteadyOptions options, MPI_Comm comm)
  : SteadyDiffusion(lattice, block, std::span<const std::uint8_t>(phase), diffusivity, std::move(options), comm)
{
  impl_->own = std::move(phase);
  impl_->phase = impl_->own;
}

SteadyDiffusion::~SteadyDiffusion() = default;
SteadyDiffusion::SteadyDiffusion(SteadyDiffusion&&) noexcept = default;
SteadyDiffusion& SteadyDiffusion::operator=(SteadyDiffusion&&) noexcept = default;

bool SteadyDiffusion::percolates(int axis)
{
  const Impl& m = *impl_;
  if (m.allConduct)
    return true;
  const Problem problem = m.problem(axis);
  const Links links = problem.links();
  const Halo halo(m.lattice.dimension, m.parts.block().size, m.parts, m.comm, problem.periodic());
  return findPercolation(m.lattice, m.parts, halo, m.comm, links, axis, m.phase).exists;
}

SteadyResult SteadyDiffusion::solve(int axis)
{
  Impl& m = *impl_;
  if (axis < 0 || axis >= m.lattice.dimension)
    throw ParameterError(fmt::format("there is no axis {} in {} dimensions", axis, m.lattice.dimension),
      m.lattice.dimension == 2 ? "choose 0 (x) or 1 (y)" : "choose 0 (x), 1 (y) or 2 (z)");
  m.backend.reset(); // its memory before the next one's
  const std::vector<Method> ways = m.ways(axis);
  if (!m.fits(ways.front()))
    throw MemoryError(
      fmt::format("solving on {} nodes needs about {}, and {} are available", m.lattice.count(),
        bytesText(static_cast<double>(m.bytes(ways.front()))), bytesText(static_cast<double>(availableMemory()))),
      "use a smaller window or refinement, or more machines with mpirun");

  reportProgress(m.options, m.comm, 0.0, "setting up");
  const auto start = Clock::now();
  double setup = 0;
  SteadyResult result;
  const int allowed = m.options.maxIterations;
  for (std::size_t i = 0; i < ways.size(); ++i)
  {
    // A contrast far above 1000 can be too much for geometric coarsening; algebraic coarsening, slower, does not mind.
    const bool last = i + 1 == ways.size();
    m.options.maxIterations = last ? allowed : std::min(allowed, patience);
    try
    {
      m.backend = makeBackend(ways[i], m.problem(axis));
      setup = secondsSince(start);
      result = m.backend->solve();
      break;
    }
    catch (const DivergenceError&)
    {
      m.options.maxIterations = allowed;
      m.backend.reset();
      if (last || !m.fits(ways[i + 1]))
        throw;
    }
    catch (...)
    {
      m.options.maxIterations = allowed;
      throw;
    }
  }
  m.options.maxIterations = allowed;
  m.axis = axis;
  m.effective = result.effective[static_cast<std::size_t>(axis)];
  result.setupSeconds = setup;
  result.solveSeconds = secondsSince(start) - setup;
  return result;
}

void SteadyDiffusion::value(std::span<double> out) const
{
  value(out, { 0, impl_->parts.block().size[2] });
}

void SteadyDiffusion::flux(std::span<double> out) const
{
  flux(out, { 0, impl_->parts.block().size[2] });
}

void SteadyDiffusion::value(std::span<double> out, Layers layers) const
{
  if (!impl_->backend || out.size() != impl_->nodes(layers))
    throw ParameterError("there is no field to return, or its size is not that of the block",
      "solve first, and hand over one number a node of this rank's block, or of layers of it");
  impl_->backend->value(out, layers);
}

void SteadyDiffusion::flux(std::span<double> out, Layers layers) const
{
  if (!impl_->backend || out.size() != 3 * impl_->nodes(layers))
    throw ParameterError("there is no flux to return, or its size is not three times that of the block",
      "solve first, and hand over three numbers a node of this rank's block, or of layers of it");
  countPass(Pass::Flux);
  impl_->backend->flux(out, layers);
}

namespace
{

// Of energies in any unit, whose sum is `value`.
void scaleTo(double value, double sum, std::span<double> derivatives)
{
  for (double& d : derivatives)
    d = sum > 0 ? d * (value / sum) : std::numeric_limits<double>::quiet_NaN();
}

} // namespace

std::vector<double> SteadyDiffusion::pairDerivatives() const
{
  if (!impl_->backend)
    throw ParameterError("there is no field to tell derivatives by", "solve first");
  if (impl_->options.links || impl_->options.stencil == Stencil::Q1)
    throw ParameterError("derivatives by pairs of phases where links are no pairs'", "ask for derivatives()");
  std::vector<double> energy = impl_->backend->energies().links;
  scaleTo(impl_->effective, std::accumulate(energy.begin(), energy.end(), 0.0), energy);
  return energy;
}

ConductivityDerivatives SteadyDiffusion::derivatives() const
{
  if (!impl_->backend)
    throw ParameterError("there is no field to tell derivatives by", "solve first");
  const SteadyOptions& options = impl_->options;
  if (options.links || options.pairs)
    throw ParameterError("derivatives by phases' conductivities where links are given",
      options.pairs ? "ask for pairDerivatives()" : "with conductivities along and across take elements, q1");
  const std::vector<double>& k = impl_->diffusivity;
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  ConductivityDerivatives d;
  if (options.stencil == Stencil::Q1)
  {
    FieldEnergies energies = impl_->backend->energies();
    const DirectedDiffusivity* const directed = options.directed.get();
    double sum = 0;
    for (std::size_t id = 0; id < k.size(); ++id)
    {
      const double along = directed ? directed->along[id] : k[id];
      const double across = directed ? directed->across[id] : k[id];
      sum += energies.along[id] * along + energies.across[id] * across;
      if (along == across) // one conductivity
        energies.along[id] += std::exchange(energies.across[id], 0.0);
    }
    scaleTo(impl_->effective, sum, energies.along);
    scaleTo(impl_->effective, sum, energies.across);
    d.along = std::move(energies.along);
    if (directed)
      d.across = std::move(energies.across);
    for (std::size_t id = 0; id < k.size(); ++id)
    {
      if ((directed ? directed->along[id] : k[id]) == 0)
        d.along[id] = none;
      if (directed && (directed->across[id] == 0 || directed->along[id] == directed->across[id]))
        d.across[id] = none;
    }
    return d;
  }
  // of the harmonic mean 2 a b / (a + b): ∂ ln / ∂a = b / (a (a + b))
  const std::vector<double> energy = pairDerivatives();
  d.along.assign(k.size(), 0.0);
  for (std::size_t a = 0; a < k.size(); ++a)
    for (std::size_t b = a; b < k.size(); ++b)
      if (const double e = energy[a * k.size() + b]; e > 0)
      {
        d.along[a] += e / (k[a] + k[b]) * (k[b] / k[a]);
        d.along[b] += e / (k[a] + k[b]) * (k[a] / k[b]);
      }
  for (std::size_t id = 0; id < k.size(); ++id)
    if (k[id] == 0)
      d.along[id] = none;
  return d;
}

SurfaceDerivatives SteadyDiffusion::surfaceDerivatives() const
{
  if (!impl_->backend)
    throw ParameterError("there is no field to tell derivatives by", "solve first");
  return lbm::surfaceDerivatives(impl_->problem(impl_->axis), *impl_->backend);
}

Method leanest(const Lattice& lattice, Stencil stencil, bool everyNodeConducts) noexcept
{
  if (stencil == Stencil::Q1)
    return Method::Multigrid;
  const bool lean = lattice.dimension == 3 && stencil == Stencil::D3Q7;
  if (!everyNodeConducts)
    return lean ? Method::PieceMultigrid : Method::AlgebraicMultigrid;
  return lean ? Method::LeanMultigrid : Method::Multigrid;
}

int ranksSharing(const Lattice& lattice, Stencil stencil, int ranks) noexcept
{
  return stencil != Stencil::Q1 || PlaneParts::canSplit(std::max(lattice.size[1], lattice.size[2]), ranks) ? ranks : 1;
}

std::uint64_t estimateBytes(const Lattice& lattice, Stencil stencil, Method method, std::int64_t conducting)
{
  const bool diagonal = stencil == Stencil::D2Q9 || stencil == Stencil::D3Q19;
  if (stencil == Stencil::Q1)
    return elementBytes(lattice);
  if (method == Method::AlgebraicMultigrid)
  {
    const std::uint64_t entries = lattice.dimension == 2 ? (diagonal ? 9 : 5) : (diagonal ? 19 : 7);
    return static_cast<std::uint64_t>(conducting) * (entries * 41 + 110) +
      static_cast<std::uint64_t>(lattice.count()) / 2;
  }
  if (method == Method::PieceMultigrid) // measured, on tissue, balls and sandstone
    return static_cast<std::uint64_t>(lattice.count()) * 8 + static_cast<std::uint64_t>(conducting) * 22;
  if (method == Method::LeanMultigrid)
    return leanBytes(lattice);
  // multigrid: measured, with the ghost rows of an ordinary size
  const std::uint64_t perNode = lattice.dimension == 2 ? (diagonal ? 90 : 80) : (diagonal ? 120 : 56);
  return static_cast<std::uint64_t>(lattice.count()) * perNode;
}

} // namespace lamella::lbm
