// What can be read from the populations, and what is kept of them on disk.
#include "core/Error.h"
#include "core/Passes.h"
#include "lbm/stepping/Impl.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace lamella::lbm
{
namespace
{

constexpr const char* kind = "lattice Boltzmann steps";
constexpr std::int64_t recordNumbers = 5;

const char* nameOf(Boundary side)
{
  return side == Boundary::Fixed ? "fixed" : side == Boundary::Insulated ? "insulated" : "periodic";
}

} // namespace

void LatticeBoltzmann::value(std::span<double> out) const
{
  const Impl& m = *impl_;
  if (out.size() != static_cast<std::size_t>(m.parts.block().count()))
    throw ParameterError(
      fmt::format("room for {} values was given for a block of {} nodes", out.size(), m.parts.block().count()),
      "hand over one number a node of this rank's block");
  std::fill(out.begin(), out.end(), std::numeric_limits<double>::quiet_NaN());
  m.forEachArrived(
    [&](std::int32_t, std::int64_t index, const std::array<double, maxPopulations>& f)
    {
      double u = 0;
      for (int q = 0; q < m.velocities.count(); ++q)
        u += f[q];
      out[index] = u;
    });
}

void LatticeBoltzmann::flux(std::span<double> out) const
{
  countPass(Pass::Flux);
  const Impl& m = *impl_;
  if (out.size() != 3 * static_cast<std::size_t>(m.parts.block().count()))
    throw ParameterError(fmt::format("room for {} numbers was given for the flux on a block of {} nodes", out.size(),
                           m.parts.block().count()),
      "hand over three numbers a node of this rank's block");
  std::fill(out.begin(), out.end(), 0.0);
  m.forEachArrived(
    [&](std::int32_t node, std::int64_t index, const std::array<double, maxPopulations>& f)
    {
      // (τ − ½)/τ Σ c f: eq. 10, τ that of the odd populations
      const double rate = m.sweep->rate(node);
      const double share = 1 - 0.5 * (m.two ? 2 - rate : rate);
      for (int q = m.velocities.rest; q < m.velocities.count(); ++q)
        for (int a = 0; a < 3; ++a)
          out[3 * index + a] += share * m.velocities.c[q][a] * f[q] * m.lattice.spacing / m.dt;
    });
}

double LatticeBoltzmann::mean() const
{
  const Impl& m = *impl_;
  const std::int64_t nx = m.parts.block().size[0];
  const std::int64_t ny = m.parts.block().size[1];
  double sum = 0;
  m.forEachArrived(
    [&](std::int32_t, std::int64_t index, const std::array<double, maxPopulations>& f)
    {
      double u = 0;
      for (int q = 0; q < m.velocities.count(); ++q)
        u += f[q];
      const std::int64_t row = index / nx;
      sum += u * m.map->share({ index % nx, row % ny + m.parts.block().start[1], row / ny + m.parts.block().start[2] });
    });
  return m.comm.sum(sum) / (m.across() * m.length(m.options.axis));
}

double LatticeBoltzmann::Impl::unrest(double flux, double fall) const
{
  const int axis = options.axis;
  const std::int64_t nx = parts.block().size[0];
  const std::int64_t ny = parts.block().size[1];
  const auto& first = parts.block().start;
  // of each plane what crosses to the next one; last what is dissipated
  std::vector<double> sums(static_cast<std::size_t>(lattice.size[axis]) + 1, 0.0);
  forEachArrived(
    [&](std::int32_t node, std::int64_t index, const std::array<double, maxPopulations>& f)
    {
      std::array<std::int64_t, 3> p{ index % nx, index / nx % ny + first[1], index / (nx * ny) + first[2] };
      double u = 0;
      for (int q = 0; q < velocities.count(); ++q)
        u += f[q];
      const double rate = sweep->rate(node);
      double forward = 0;
      for (int q = velocities.rest; q < velocities.count(); ++q)
      {
        const double back = f[velocities.opposite(q)];
        const double net = (1 - rate) * (two ? back : f[q]) + rate * velocities.weight[q] * u - back;
        forward += velocities.c[q][axis] > 0 ? net : 0.0;
        // half a link conducts 4 Λ w, and 1/s − ½ = 1/(4 Λ)
        sums.back() += two ? net * net * (1 / rate - 0.5) / velocities.weight[q] : 0.0;
      }
      const auto plane = static_cast<std::size_t>(p[axis]);
      p[axis] = lattice.size[axis] / 2; // shares of the area across alone
      sums[plane] += forward * map->share(p);
    });
  comm.sum(sums);
  double worst = two ? std::fabs(sums.back() / (across() * fall * flux) - 1) : 0.0;
  // of two planes both are outer ones: what crosses between them is what crosses the faces
  for (std::size_t k = 0; lattice.size[axis] > 2 && k + 2 < sums.size(); ++k)
    worst = std::max(worst, std::fabs(sums[k] / (across() * flux) - 1));
  return worst;
}

std::string LatticeBoltzmann::Impl::scene() const
{
  std::string s =
    fmt::format("lattice: {} × {} × {} nodes, {} m apart\nphases: {}\nstencil: {}\ncollision: {}\n", lattice.size[0],
      lattice.size[1], lattice.size[2], lattice.spacing, phaseSum, name(options.stencil), two ? "trt" : "bgk");
  for (int a = 0; a < lattice.dimension; ++a)
    s += fmt::format("sides along {}: {} {} {}\n", "xyz"[a], nameOf(options.sides[a]), options.faceValues[a][0],
      options.faceValues[a][1]);
  s += fmt::format("axis: {}\ndrop: {}\nsteady: {}\ntime step: {}\ndiffusivities: {} m²/s\ninitial value: {}\n",
    options.axis, options.drop, options.steady, adapts ? "chosen" : fmt::format("{} s", dt),
    fmt::join(diffusivity, " "), initial);
  return s;
}

void LatticeBoltzmann::save()
{
  Impl& m = *impl_;
  m.savedAt = m.steps;
  m.pace.written();
  // The populations as gathered, which go one by one as the file is put together.
  if (!io::roomFor(static_cast<std::uint64_t>(m.lattice.count()) *
          static_cast<std::uint64_t>(m.velocities.count() + 4) * sizeof(double),
        m.options.checkpoint, m.comm))
    return;
  io::Checkpoint c;
  c.kind = kind;
  c.scene = m.scene();
  c.provenance = m.options.checkpoint.provenance;
  c.numbers["relaxation"] = m.relaxation;
  c.numbers["steps"] = static_cast<double>(m.steps);
  c.numbers["most squares"] = m.mostSquares;
  const Block& block = m.parts.block();
  const auto count = static_cast<std::size_t>(block.count());
  std::vector<double> mine(count, 0.0);
  for (int q = 0; q < m.velocities.count(); ++q)
  {
    for (std::size_t r = 0; r < m.map->rows().size(); ++r)
      m.map->forEach(
        r, [&](std::int32_t node, std::int64_t index) { mine[index] = m.sweep->data()[q * m.map->stride() + node]; });
    const std::vector<double> gathered = m.comm.gather(mine);
    if (m.comm.rank() != 0)
      continue;
    std::vector<double> whole(static_cast<std::size_t>(m.lattice.count()));
    auto from = gathered.begin();
    for (int rank = 0; rank < m.comm.size(); ++rank) // blocks of whole rows, in the order of the ranks
    {
      const Block b = m.parts.block(rank);
      for (std::int64_t z = b.start[2]; z < b.start[2] + b.size[2]; ++z)
        for (std::int64_t y = b.start[1]; y < b.start[1] + b.size[1]; ++y, from += b.size[0])
          std::copy_n(from, b.size[0], whole.begin() + m.lattice.index(0, y, z));
    }
    c.arrays[fmt::format("f{:02}", q)] = { { m.lattice.size[2], m.lattice.size[1], m.lattice.size[0] },
      std::move(whole), "1", "population that arrived, 0 at nodes that are not stored" };
  }
  if (!m.records.empty())
  {
    std::vector<double> numbers;
    for (const SteppingRecord& r : m.records)
      numbers.insert(numbers.end(), { static_cast<double>(r.steps), r.time, r.faceFlux[0], r.faceFlux[1], r.mean });
    c.arrays["records"] = { { static_cast<std::int64_t>(m.records.size()), recordNumbers }, std::move(numbers), "SI",
      "by stop: steps, time, flux through the low and the high face, mean value" };
  }
  if (io::write(std::move(c), m.options.checkpoint, m.comm))
  {
    ++m.checkpoints;
    m.lastCheckpoint = m.steps;
  }
}

void LatticeBoltzmann::restore(const std::filesystem::path& path)
{
  Impl& m = *impl_;
  const io::Checkpoint c = io::readCheckpoint(path, kind, m.scene(), m.comm);
  if (m.adapts)
    m.relaxAt(c.number("relaxation"));
  const Block& block = m.parts.block();
  for (int q = 0; q < m.velocities.count(); ++q)
  {
    const std::vector<double>& whole = c.reals(fmt::format("f{:02}", q));
    c.expectFinite(fmt::format("f{:02}", q));
    if (whole.size() != static_cast<std::size_t>(m.lattice.count()))
      throw InputError("the checkpoint's populations have another number of nodes", "start the run anew");
    for (std::size_t r = 0; r < m.map->rows().size(); ++r)
      m.map->forEach(r,
        [&](std::int32_t node, std::int64_t index)
        {
          const auto p = m.map->position(r, index - static_cast<std::int64_t>(r) * block.size[0]);
          m.sweep->data()[q * m.map->stride() + node] = whole[m.lattice.index(p[0], p[1], p[2])];
        });
  }
  m.records.clear();
  if (c.arrays.contains("records"))
  {
    const std::vector<double>& numbers = c.reals("records");
    if (numbers.size() % recordNumbers != 0)
      throw InputError("the checkpoint's records have another shape", "start the run anew");
    for (std::size_t i = 0; i < numbers.size(); i += recordNumbers)
      m.records.push_back(
        { static_cast<std::int64_t>(numbers[i]), numbers[i + 1], { numbers[i + 2], numbers[i + 3] }, numbers[i + 4] });
  }
  m.steps = c.count("steps");
  m.mostSquares = c.number("most squares");
  m.savedAt = m.steps;
}

} // namespace lamella::lbm
