// The coarsest level, by sparse Cholesky; and levels shared out anew or gathered on every rank.
#include "core/Error.h"
#include "lbm/multigrid/Multigrid.h"

#include <algorithm>

namespace lamella::lbm
{
namespace
{

// Beyond that a band has so many zeros that sparse factors are cheaper.
constexpr std::int64_t widestBand = 128;

} // namespace

void Multigrid::factorize(const Level& coarsest)
{
  const Grid& g = coarsest.grid;
  const int(*directions)[3] = g.dimension == 3 ? directions3 : directions2;
  const std::int64_t n = g.nx * g.ny * g.nz;
  // How far the corners of a node's neighbourhood are; a side that wraps makes that as far as its axis is long.
  const auto reach = [&](std::size_t axis, std::int64_t nodes) { return coarsest.periodic[axis] ? nodes - 1 : 1; };
  const std::int64_t width = reach(0, g.nx) + g.nx * (reach(1, g.ny) + (g.dimension == 3 ? g.ny * reach(2, g.nz) : 0));
  const bool narrow = width <= std::min(widestBand, n - 1);
  band_ = narrow ? BandCholesky(n, width) : BandCholesky();
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](int row, int column, double value)
  {
    if (narrow)
      band_.add(row, column, value);
    else
      entries.emplace_back(row, column, value);
  };
  // Place along an axis: a wall's ghost is none, what lies beyond a side that wraps an image.
  constexpr std::int64_t ghost = -1;
  const std::array<std::int64_t, 3> size{ g.nx, g.ny, g.nz };
  const auto place = [&](std::int64_t at, std::size_t axis)
  {
    if (at >= 0 && at < size[axis])
      return at;
    return coarsest.periodic[axis] ? (at + size[axis]) % size[axis] : ghost;
  };
  const auto isImage = [&](std::int64_t at, std::size_t axis)
  { return coarsest.periodic[axis] && (at < 0 || at >= size[axis]); };
  std::vector<double> diagonal(static_cast<std::size_t>(n), 0.0);
  double toGhosts = 0;
  // Of a row of nodes, ghosts at its ends included, the links along direction d; those of images are their nodes'.
  const auto addRow = [&](std::size_t d, std::int64_t y, std::int64_t z)
  {
    const std::int64_t otherY = place(y + directions[d][1], 1);
    const std::int64_t otherZ = place(z + directions[d][2], 2);
    const bool fromGhosts = place(y, 1) == ghost || place(z, 2) == ghost;
    const bool towardsGhosts = otherY == ghost || otherZ == ghost;
    if (isImage(y, 1) || isImage(z, 2) || (fromGhosts && towardsGhosts))
      return;
    const float* const row = coarsest.links[d].data() + g.row(y, z);
    const std::int64_t here = g.nx * (y + g.ny * z);
    const std::int64_t there = g.nx * (otherY + g.ny * otherZ);
    for (std::int64_t x = -1; x <= g.nx; ++x)
    {
      if (isImage(x, 0))
        continue;
      const std::int64_t otherX = place(x + directions[d][0], 0);
      const bool from = !fromGhosts && x >= 0 && x < g.nx;
      const bool to = !towardsGhosts && otherX != ghost;
      const double link = row[g.node(x)];
      if (from && to)
      {
        if (here + x == there + otherX)
          continue;
        add(static_cast<int>(here + x), static_cast<int>(there + otherX), -link);
        add(static_cast<int>(there + otherX), static_cast<int>(here + x), -link);
      }
      if (from)
        diagonal[static_cast<std::size_t>(here + x)] += link;
      if (to)
        diagonal[static_cast<std::size_t>(there + otherX)] += link;
      toGhosts += from != to ? link : 0.0;
    }
  };
  for (std::size_t d = 0; d < coarsest.links.size(); ++d)
    for (std::int64_t z = -g.ghostZ; z < g.nz; ++z)
      for (std::int64_t y = -1; y <= g.ny; ++y)
        addRow(d, y, z);
  for (std::int64_t i = 0; i < n; ++i)
    add(static_cast<int>(i), static_cast<int>(i), diagonal[static_cast<std::size_t>(i)]);
  if (toGhosts == 0.0) // periodic: the constant is free; one node holds it
    add(0, 0, std::ranges::max(diagonal));
  bool factorized = narrow && band_.factorize();
  if (!narrow)
  {
    Eigen::SparseMatrix<double> matrix(n, n);
    matrix.setFromTriplets(entries.begin(), entries.end());
    direct_.compute(matrix);
    factorized = direct_.info() == Eigen::Success;
  }
  if (!factorized)
    throw DivergenceError("the coarsest multigrid level could not be factorised",
      "use method algebraic-multigrid; and please report this with the picture and the conductivities");
}

void Multigrid::solveDirectly(const Level& coarsest, const FloatArray& f, FloatArray& u) const
{
  const Grid& g = coarsest.grid;
  Eigen::VectorXd right(g.nx * g.ny * g.nz);
  Eigen::Index i = 0;
  for (std::int64_t z = 0; z < g.nz; ++z)
    for (std::int64_t y = 0; y < g.ny; ++y)
      for (std::int64_t x = 0; x < g.nx; ++x)
        right[i++] = f[static_cast<std::size_t>(g.row(y, z) + g.node(x))];
  if (!band_.empty())
    band_.solve({ right.data(), static_cast<std::size_t>(right.size()) });
  else
    right = direct_.solve(right).eval();
  i = 0;
  for (std::int64_t z = 0; z < g.nz; ++z)
    for (std::int64_t y = 0; y < g.ny; ++y)
      for (std::int64_t x = 0; x < g.nx; ++x)
        u[static_cast<std::size_t>(g.row(y, z) + g.node(x))] = static_cast<float>(right[i++]);
  coarsest.exchange(u);
}

namespace
{

// Every rank's padded block of rows, and where each begins in `all`.
std::vector<float> gatherRows(const Level& part, const float* send, std::int64_t sendCount,
  const std::function<std::int64_t(const Block&)>& countOf, std::vector<std::int64_t>& begin)
{
  std::vector<int> counts;
  std::vector<int> starts;
  int total = 0;
  for (int r = 0; r < part.comm->size(); ++r)
  {
    counts.push_back(static_cast<int>(countOf(part.parts->block(r))));
    starts.push_back(total);
    begin.push_back(total);
    total += counts.back();
  }
  std::vector<float> all(static_cast<std::size_t>(total));
  MPI_Allgatherv(send, static_cast<int>(sendCount), MPI_FLOAT, all.data(), counts.data(), starts.data(), MPI_FLOAT,
    part.comm->handle());
  return all;
}

// Another rank's block of this level; blocks begin at multiples of 2^halvings on the finest.
Grid blockGrid(const Level& part, const Block& finest, std::array<std::int64_t, 3>& start)
{
  std::array<std::int64_t, 3> size{};
  for (std::size_t a = 0; a < 3; ++a)
  {
    const std::int64_t unit = std::int64_t{ 1 } << part.halvings;
    start[a] = finest.start[a] / unit;
    size[a] = (finest.start[a] + finest.size[a] + unit - 1) / unit - start[a];
  }
  return Grid(part.grid.dimension, size[0], size[1], size[2]);
}

} // namespace

namespace
{

Lattice latticeOf(const Level& level)
{
  Lattice lattice;
  lattice.dimension = level.grid.dimension;
  lattice.size = level.size;
  return lattice;
}

// Arrays for the same lattice, shared out otherwise.
void likeBefore(const Level& part, Level& next)
{
  next.periodic = part.periodic;
  next.straight = part.straight;
  next.size = part.size;
  next.depth = part.depth;
  const Grid& g = next.grid;
  next.halo = Halo(g.dimension, { g.nx, g.ny, g.nz }, *next.parts, *next.comm, next.periodic);
  next.allocateLinks(part.directions());
  if (!part.straight)
    next.inverse.assign(g.floats(), 0.0F);
  next.u.assign(g.floats(), 0.0F);
  next.f.assign(g.floats(), 0.0F);
}

} // namespace

double unevennessAt(int dimension, int depth)
{
  return std::min(1.0, 0.05 * static_cast<double>(std::int64_t{ 1 } << (dimension * depth)));
}

std::unique_ptr<Level> Multigrid::move(Level& part) const
{
  const int ranks = part.comm->size();
  auto next = std::make_unique<Level>();
  next->comm = std::make_unique<Communicator>(*part.comm);
  next->parts =
    std::make_unique<Decomposition>(latticeOf(part), *next->comm, unevennessAt(part.grid.dimension, part.depth));
  if (next->parts->levels() == 0)
    return nullptr;
  const Block& block = next->parts->block();
  next->grid = Grid(part.grid.dimension, block.size[0], block.size[1], block.size[2]);
  next->start = block.start;
  likeBefore(part, *next);

  std::vector<Block> before;
  std::vector<Block> after;
  for (int r = 0; r < ranks; ++r)
  {
    Block& b = before.emplace_back();
    const Grid g = blockGrid(part, part.parts->block(r), b.start);
    b.size = { g.nx, g.ny, g.nz };
    after.push_back(next->parts->block(r));
  }
  part.moved =
    std::make_unique<Redistribution>(part.grid.dimension, part.size, std::move(before), std::move(after), *part.comm);
  const auto copyArray = [&](const FloatArray& from, FloatArray& to)
  {
    part.moved->forward(from.data() + Grid::lead, to.data() + Grid::lead, static_cast<std::size_t>(part.grid.stride));
    next->exchange(to);
  };
  for (std::size_t d = 0; d < part.links.size(); ++d)
    copyArray(part.links[d], next->links[d]);
  if (!part.straight)
    copyArray(part.inverse, next->inverse);
  return next;
}

std::unique_ptr<Level> Multigrid::gather(const Level& part) const
{
  auto whole = std::make_unique<Level>();
  whole->grid = Grid(part.grid.dimension, part.size[0], part.size[1], part.size[2]);
  whole->comm = std::make_unique<Communicator>(MPI_COMM_SELF);
  whole->parts = std::make_unique<Decomposition>(latticeOf(part), *whole->comm);
  likeBefore(part, *whole);
  const Grid& w = whole->grid;

  const auto copyArray = [&](const FloatArray& from, FloatArray& to)
  {
    std::vector<std::int64_t> begin;
    const std::int64_t count = part.grid.rows() * part.grid.stride;
    const auto all = gatherRows(
      part, from.data() + Grid::lead, count,
      [&](const Block& b)
      {
        std::array<std::int64_t, 3> start{};
        const Grid g = blockGrid(part, b, start);
        return g.rows() * g.stride;
      },
      begin);
    for (int r = 0; r < part.comm->size(); ++r)
    {
      std::array<std::int64_t, 3> start{};
      const Grid g = blockGrid(part, part.parts->block(r), start);
      for (std::int64_t z = -g.ghostZ; z < g.nz + g.ghostZ; ++z)
        for (std::int64_t y = -1; y <= g.ny; ++y)
        {
          const std::int64_t wy = y + start[1];
          const std::int64_t wz = z + start[2];
          const bool ownedY = y >= 0 && y < g.ny;
          const bool ownedZ = z >= 0 && z < g.nz;
          if ((ownedY || wy < 0 || wy >= w.ny) && (ownedZ || wz < 0 || wz >= w.nz))
            std::copy_n(all.data() + begin[static_cast<std::size_t>(r)] + g.row(y, z) - Grid::lead, g.stride,
              to.data() + w.row(wy, wz));
        }
    }
    whole->exchange(to);
  };
  for (int d = 0; d < part.directions(); ++d)
    copyArray(part.links[static_cast<std::size_t>(d)], whole->links[static_cast<std::size_t>(d)]);
  if (!part.straight)
    copyArray(part.inverse, whole->inverse);
  return whole;
}

void Multigrid::gatherVector(const Level& part, const FloatArray& v, Level& whole, FloatArray& out) const
{
  const Grid& g = part.grid;
  std::vector<float> send(static_cast<std::size_t>(g.ny * g.nz * g.stride));
  for (std::int64_t i = 0; i < g.ny * g.nz; ++i)
    std::copy_n(v.data() + g.row(i % g.ny, i / g.ny), g.stride, send.data() + i * g.stride);
  std::vector<std::int64_t> begin;
  const auto all = gatherRows(
    part, send.data(), static_cast<std::int64_t>(send.size()),
    [&](const Block& b)
    {
      std::array<std::int64_t, 3> start{};
      const Grid block = blockGrid(part, b, start);
      return block.ny * block.nz * block.stride;
    },
    begin);
  for (int r = 0; r < part.comm->size(); ++r)
  {
    std::array<std::int64_t, 3> start{};
    const Grid block = blockGrid(part, part.parts->block(r), start);
    for (std::int64_t i = 0; i < block.ny * block.nz; ++i)
      std::copy_n(all.data() + begin[static_cast<std::size_t>(r)] + i * block.stride, block.stride,
        out.data() + whole.grid.row(i % block.ny + start[1], i / block.ny + start[2]));
  }
}

void Multigrid::scatterVector(const Level& whole, const FloatArray& v, const Level& part, FloatArray& out) const
{
  // ghost rows too: the whole level has all of them
  const Grid& g = part.grid;
  for (std::int64_t z = -g.ghostZ; z < g.nz + g.ghostZ; ++z)
    for (std::int64_t y = -1; y <= g.ny; ++y)
      std::copy_n(v.data() + whole.grid.row(y + part.start[1], z + part.start[2]), g.stride, out.data() + g.row(y, z));
}

} // namespace lamella::lbm
