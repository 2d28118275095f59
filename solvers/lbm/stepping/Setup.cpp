// What LatticeBoltzmann checks and builds before the first step.
#include "core/Error.h"
#include "core/Memory.h"
#include "core/Plausible.h"
#include "lbm/Connectivity.h"
#include "lbm/stepping/Impl.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

namespace lamella::lbm
{
namespace
{

constexpr double usual = 0.5; // relaxation where nothing is asked for

int dimensionsOf(Stencil stencil)
{
  return stencil == Stencil::D2Q5 || stencil == Stencil::D2Q9 ? 2 : 3;
}

} // namespace

LatticeBoltzmann::Impl::Impl(const Lattice& box, MPI_Comm handle, SteppingOptions given)
  : lattice(box)
  , comm(handle)
  , parts(box, comm)
  , options(std::move(given))
  , velocities(options.stencil)
  , two(options.collision != Collision::BGK)
{
}

void LatticeBoltzmann::Impl::check(const Block& block, std::span<const std::uint8_t> phase) const
{
  require(dimensionsOf(options.stencil) == lattice.dimension,
    fmt::format("lattice {} does not fit a {}-dimensional picture", name(options.stencil), lattice.dimension),
    lattice.dimension == 2 ? "use d2q5 or d2q9" : "use d3q7 or d3q19");
  require(options.axis >= 0 && options.axis < lattice.dimension,
    fmt::format("there is no axis {} in {} dimensions", options.axis, lattice.dimension),
    lattice.dimension == 2 ? "choose 0 (x) or 1 (y)" : "choose 0 (x), 1 (y) or 2 (z)");
  require(parts.block().size == block.size && parts.block().start == block.start,
    "this rank's block is not the one of decompose()",
    "hand over the part of the lattice that decompose(lattice, comm) names");
  require(phase.size() == static_cast<std::size_t>(block.count()),
    fmt::format("{} phase ids were given for a block of {} nodes", phase.size(), block.count()),
    "hand over one id a node of this rank's block");
  require(std::isfinite(lattice.spacing) && lattice.spacing > 0,
    fmt::format("a spacing of {} m is not above 0", lattice.spacing), "give the distance of two nodes in metres");
  require(std::isfinite(options.memory) && options.memory >= 0,
    fmt::format("{} bytes of memory are allowed", options.memory), "give a number above 0, or 0 for all there is");
  require(options.threads >= 1, fmt::format("{} threads are too few", options.threads), "allow at least 1");
  for (std::size_t i = 0; i < diffusivity.size(); ++i)
    require(std::isfinite(diffusivity[i]) && diffusivity[i] >= 0,
      fmt::format("diffusivity {} of phase {} is not a finite number of at least 0", diffusivity[i], i),
      "give a positive value in m²/s, or 0 for a phase that does not conduct");
  if (const auto beyond = std::ranges::find_if(phase, [&](std::uint8_t id) { return id >= diffusivity.size(); });
      beyond != phase.end())
    throw ParameterError(fmt::format("phase {} has no diffusivity", *beyond), "give one value for each phase");
  for (int a = 0; a < lattice.dimension; ++a)
  {
    if (options.sides[a] == Boundary::Fixed)
      for (const double u : options.faceValues[a])
      {
        require(std::isfinite(u), fmt::format("the value {} on a face is not finite", u), "give finite numbers");
        require(u == 0 || plausible(u),
          fmt::format("the value {:g} on a face is neither 0 nor between 1e-30 and 1e30 in size", u),
          "give numbers such as 1 and 0");
      }
    require(two || options.sides[a] == Boundary::Periodic || lattice.size[a] > 1,
      fmt::format("bgk has its faces on the outer nodes, and there is one node along {}", "xyz"[a]),
      "use two relaxation times (trt), whose faces are half a spacing outside, or at least 2 nodes");
  }
  require(std::isfinite(options.drop) && (options.drop == 0 || options.sides[options.axis] == Boundary::Periodic),
    fmt::format("the value cannot fall by {} over the box", options.drop),
    "a finite drop goes with periodic sides along the axis; values on faces with fixed ones");
  require(!options.steady || options.sides[options.axis] == Boundary::Fixed ||
      (options.sides[options.axis] == Boundary::Periodic && options.drop != 0),
    "no flux is driven through the box, so there is none to come to rest",
    "fix values on the faces of the axis, or give a drop between periodic sides");
  require(options.relaxation == 0 || options.timeStep == 0, "both a relaxation and a time step were given",
    "one follows from the other: leave one of them at 0");
  require(std::isfinite(options.relaxation) && options.relaxation >= 0,
    fmt::format("a relaxation time τ of {} is not above ½", options.relaxation + 0.5),
    "the diffusivity is (τ − ½) δx²/(3 δt): choose τ > ½");
  require(std::isfinite(options.timeStep) && options.timeStep >= 0,
    fmt::format("a time step of {} s is not above 0", options.timeStep), "give a time in seconds, or none");
}

bool LatticeBoltzmann::Impl::onlyAxisFixed() const
{
  return std::none_of(
    options.sides.begin(), options.sides.begin() + lattice.dimension,
    [&](const Boundary& b) { return b == Boundary::Fixed && &b != &options.sides[options.axis]; });
}

NodeSet LatticeBoltzmann::Impl::participants(const Halo& halo, std::span<const std::uint8_t> phase) const
{
  const Block& block = parts.block();
  if (options.steady && onlyAxisFixed()) // faces across another axis hold what leads to them, too
  {
    const Links links(lattice, options.stencil, options.sides, diffusivity);
    Percolation found = findPercolation(lattice, parts, halo, comm, links, options.axis, phase);
    if (!found.exists)
      throw NoPathError(fmt::format("no conducting path leads across the box along {}", "xyz"[options.axis]),
        "give the phase that should conduct a diffusivity above 0, or choose another window or direction");
    found.carrying.number();
    return std::move(found.carrying);
  }
  NodeSet set(block.size[0], halo);
  for (std::int64_t z = 0; z < block.size[2]; ++z)
    for (std::int64_t y = 0; y < block.size[1]; ++y)
      for (std::int64_t x = 0; x < block.size[0]; ++x)
        if (diffusivity[phase[x + block.size[0] * (y + block.size[1] * z)]] > 0)
          set.insert(halo.row(y, z), x);
  set.exchange(halo);
  set.number();
  return set;
}

SlotSides LatticeBoltzmann::Impl::slotSides() const
{
  SlotSides s;
  s.boundary = options.sides;
  s.value = options.faceValues;
  s.onNodes = !two;
  s.drop[options.axis] = options.drop;
  return s;
}

void LatticeBoltzmann::Impl::build(std::span<const std::uint8_t> phase)
{
  const Block& block = parts.block();
  std::array<std::int64_t, 256> counts{};
  for (const std::uint8_t id : phase)
    ++counts[id];
  std::int64_t conducting = 0;
  std::int64_t sum = 0; // of a number from phase and place, whichever rank holds the node
  for (std::size_t id = 0; id < diffusivity.size() && id < counts.size(); ++id)
    if (diffusivity[id] > 0 && counts[id] > 0)
    {
      conducting += counts[id];
      largest = std::max(largest, diffusivity[id]);
    }
  largest = comm.max(largest);
  conducting = comm.sum(conducting);
  if (conducting == 0)
    throw NoPathError("no node of the picture conducts", "give at least one phase that occurs a diffusivity above 0");
  const double needed = static_cast<double>(conducting) * (8.0 * velocities.count() + 1) / comm.size() +
    static_cast<double>(block.count()) / 4;
  const double available = options.memory > 0 ? options.memory : static_cast<double>(availableMemory());
  if (comm.any(needed > available))
    throw MemoryError(fmt::format("stepping on {} nodes needs about {} on each rank, and {} are available", conducting,
                        bytesText(needed), bytesText(available)),
      "use a smaller window or refinement, a lattice of fewer populations, or more machines with mpirun");
  const auto axis = static_cast<std::size_t>(options.axis);
  std::array<double, 2 * 256> runs{}; // nodes and runs of each phase
  for (std::int64_t z = 0, i = 0; z < block.size[2]; ++z)
    for (std::int64_t y = 0; y < block.size[1]; ++y)
      for (std::int64_t x = 0; x < block.size[0]; ++x, ++i)
      {
        runs[2 * phase[i]] += 1;
        const std::int64_t along = std::array{ x, y + block.start[1], z + block.start[2] }[axis];
        if (along == 0)
          atFaces[0] = std::max(atFaces[0], diffusivity[phase[i]]);
        if (along == lattice.size[axis] - 1)
          atFaces[1] = std::max(atFaces[1], diffusivity[phase[i]]);
        runs[2 * phase[i] + 1] += x == 0 || diffusivity[phase[i - 1]] != diffusivity[phase[i]] ? 1 : 0;
        sum += mark(lattice.index(x, y + block.start[1], z + block.start[2]), phase[i]);
      }
  comm.sum(runs);
  for (double& d : atFaces)
    d = comm.max(d);
  std::map<double, std::array<double, 2>, std::greater<>> alike;
  for (std::size_t id = 0; id < diffusivity.size() && id < counts.size(); ++id)
    if (runs[2 * id] > 0)
      for (const std::size_t k : { 0, 1 })
        alike[diffusivity[id]][k] += runs[2 * id + k];
  for (const auto& [d, sums] : alike)
    chords.push_back({ d / largest, sums[0] / sums[1] });
  phaseSum = fmt::format("{:x}", comm.sum(sum));
  chooseTime(phase);

  const std::array<bool, 3> periodic{ options.sides[0] == Boundary::Periodic, options.sides[1] == Boundary::Periodic,
    options.sides[2] == Boundary::Periodic && lattice.dimension == 3 };
  const Halo halo(lattice.dimension, block.size, parts, comm, periodic);
  map = std::make_unique<SlotMap>(lattice, parts, halo, comm, velocities, slotSides(), participants(halo, phase));
  std::vector<std::uint8_t> stored(static_cast<std::size_t>(map->stride()), 0);
  for (std::size_t r = 0; r < map->rows().size(); ++r)
    map->forEach(r, [&](std::int32_t node, std::int64_t index) { stored[node] = phase[index]; });
  const StepLoops& loops = stepKernels().loops[two ? 1 : 0][static_cast<int>(options.stencil)];
  sweep = std::make_unique<Sweep>(
    *map, comm, loops, std::move(stored), rates(), block.size, periodic[1] && parts.parts()[1] == 1, options.threads);
  planes = map->planes(options.axis);
}

void LatticeBoltzmann::Impl::chooseTime(std::span<const std::uint8_t> phase)
{
  const double perTime = 3 * largest / (lattice.spacing * lattice.spacing);
  if (options.timeStep > 0)
    relaxation = options.timeStep * perTime;
  else if (options.relaxation > 0)
    relaxation = options.relaxation;
  else
  {
    adapts = options.steady && two;
    // half-way, on a logarithmic scale, between layers across and layers along the flux, until the flux is known
    std::array<double, 3> sums{};
    for (const std::uint8_t id : phase)
      if (diffusivity[id] > 0)
      {
        sums[0] += diffusivity[id];
        sums[1] += 1 / diffusivity[id];
        sums[2] += 1;
      }
    comm.sum(sums);
    relaxation = adapts ? restRelaxation(std::sqrt(sums[0] / sums[1])) : usual;
  }
  dt = relaxation / perTime;
}

std::vector<double> LatticeBoltzmann::Impl::rates() const
{
  std::vector<double> rate(256, 0.0);
  for (std::size_t id = 0; id < diffusivity.size() && id < rate.size(); ++id)
    if (diffusivity[id] > 0)
      rate[id] = two ? 1 / (0.25 / relaxationOf(diffusivity[id]) + 0.5) : 1 / (relaxationOf(diffusivity[id]) + 0.5);
  return rate;
}

} // namespace lamella::lbm
