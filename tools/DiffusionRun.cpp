#include "DiffusionRun.h"

#include "Text.h"

#include "lattice/Decomposition.h"
#include "lattice/Memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace lamella::cli
{

namespace
{

/// Sends or receives more bytes than an int can count.
template <typename Transfer>
void inPieces(std::size_t bytes, const Transfer& transfer)
{
  constexpr std::size_t piece = std::size_t{ 1 } << 30;
  for (std::size_t at = 0; at < bytes; at += piece)
  {
    transfer(at, static_cast<int>(std::min(piece, bytes - at)));
  }
}

} // namespace

void share(const Session& session, PhaseImage& image)
{
  if (session.ranks() == 1)
  {
    return;
  }
  session.broadcast(image.lattice);
  image.phase.resize(static_cast<std::size_t>(image.lattice.count()));
  inPieces(image.phase.size(),
    [&](std::size_t at, int bytes) { MPI_Bcast(image.phase.data() + at, bytes, MPI_BYTE, 0, session.communicator()); });
}

void share(const Session& session, std::vector<std::array<float, 2>>& axes, std::size_t nodes)
{
  if (session.ranks() == 1)
  {
    return;
  }
  axes.resize(nodes);
  auto* const first = reinterpret_cast<std::byte*>(axes.data());
  inPieces(nodes * sizeof(axes[0]),
    [&](std::size_t at, int bytes) { MPI_Bcast(first + at, bytes, MPI_BYTE, 0, session.communicator()); });
}

void gather(const Session& session, const Lattice& lattice, const Block& own, std::span<const double> part,
  std::span<double> whole, int components)
{
  constexpr int tag = 1;
  if (!session.root())
  {
    inPieces(part.size_bytes(),
      [&](std::size_t at, int bytes)
      { MPI_Send(reinterpret_cast<const char*>(part.data()) + at, bytes, MPI_BYTE, 0, tag, session.communicator()); });
    return;
  }
  const auto place = [&](const Block& block, std::span<const double> values)
  {
    const auto row = static_cast<std::size_t>(block.size[0] * components);
    auto from = values.begin();
    for (std::int64_t z = 0; z < block.size[2]; ++z)
    {
      for (std::int64_t y = 0; y < block.size[1]; ++y, from += static_cast<std::ptrdiff_t>(row))
      {
        const std::int64_t first = lattice.index(block.start[0], block.start[1] + y, block.start[2] + z) * components;
        std::copy_n(from, row, whole.begin() + first);
      }
    }
  };
  place(own, part);
  const Decomposition parts(lattice, Communicator(session.communicator()));
  std::vector<double> received;
  for (int rank = 1; rank < session.ranks(); ++rank)
  {
    const Block block = parts.block(rank);
    received.resize(static_cast<std::size_t>(block.count() * components));
    inPieces(received.size() * sizeof(double),
      [&](std::size_t at, int bytes)
      {
        MPI_Recv(reinterpret_cast<char*>(received.data()) + at, bytes, MPI_BYTE, rank, tag, session.communicator(),
          MPI_STATUS_IGNORE);
      });
    place(block, received);
  }
}

void requireMemory(const DiffusionSize& size)
{
  const Lattice& lattice = size.lattice;
  const int refinement = size.refinement;
  const lbm::Method method =
    size.conducting == lattice.count() ? lbm::Method::Multigrid : lbm::Method::AlgebraicMultigrid;
  const auto count = static_cast<double>(lattice.count());
  const auto solver = static_cast<double>(lbm::estimateBytes(lattice, size.stencil, method, size.conducting));
  // In doubles, for a refinement typed wrongly can have more nodes than 64 bits count. Beside the solver's arrays: the
  // refined picture on every rank, the solver's copy of its part, and on rank 0 value and flux as they are written.
  const auto bytes = [&](int n)
  {
    const double scale = std::pow(static_cast<double>(n), lattice.dimension);
    return scale *
      (solver * size.ranksOnMachine / size.ranks + count * (size.ranksOnMachine + 1) +
        (size.fields ? count * (8 + 24 + 2) : 0));
  };
  const auto available = static_cast<double>(availableMemory());
  if (bytes(refinement) <= available)
  {
    return;
  }
  // Bytes grow with the refinement to the power of the dimension.
  const double largest = std::pow(available / bytes(1), 1.0 / lattice.dimension);
  const int fits = std::min(refinement - 1, static_cast<int>(std::min(largest, 1e6)));
  std::string nodes;
  for (int axis = 0; axis < lattice.dimension; ++axis)
  {
    nodes += fmt::format(
      "{}{:.0f}", axis == 0 ? "" : " × ", static_cast<double>(refinement) * static_cast<double>(lattice.size[axis]));
  }
  throw MemoryError(fmt::format("{} nodes at refinement {} need about {} of memory, and {} are free", nodes, refinement,
                      bytesText(bytes(refinement)), bytesText(available)),
    fmt::format("{}take a smaller --window, or share the work between machines with mpirun",
      fits > 0 ? fmt::format("--refine {} fits; or ", fits) : ""));
}

void requirePaths(const PhaseImage& image, std::span<const double> conductivity, const lbm::StudyOptions& options)
{
  // Refining splits pixels and changes no neighbourhood, so the picture as it is tells.
  lbm::SteadyOptions steady = options.steady;
  steady.progress = {};
  if (options.directed) // and its links are refused here, before anything is solved
  {
    steady.links =
      std::make_shared<lbm::LinkTable>(lbm::directedLinks(image.lattice, image.phase, *options.directed, steady.sides));
  }
  lbm::SteadyDiffusion solver(
    image.lattice, { { 0, 0, 0 }, image.lattice.size }, image.phase, conductivity, steady, MPI_COMM_SELF);
  std::string blocked;
  std::string open;
  for (int axis = 0; axis < image.lattice.dimension; ++axis)
  {
    const bool asked = std::find(options.axes.begin(), options.axes.end(), axis) != options.axes.end();
    if (solver.percolates(axis))
    {
      open += open.empty() ? axisNames[axis] : std::string(" or --direction ") + axisNames[axis];
    }
    else if (asked)
    {
      blocked += blocked.empty() ? axisNames[axis] : std::string(" or ") + axisNames[axis];
    }
  }
  if (!blocked.empty())
  {
    throw NoPathError("no conducting path crosses the sample along " + blocked,
      (open.empty() ? "" : "--direction " + open + " has one; or ") +
        std::string("give a phase that blocks the way a conductivity above 0"));
  }
}

} // namespace lamella::cli
