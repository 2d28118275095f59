// From one level to the next: interpolation weights and the Galerkin product.
#include "lbm/multigrid/Multigrid.h"
#include "lbm/multigrid/WeightLayout.h"

#include <algorithm>
#include <bit>

namespace lamella::lbm
{

namespace
{

const int (*directionsOf(const Grid& grid))[3]
{
  return grid.dimension == 3 ? directions3 : directions2;
}

int kindsOf(const Grid& grid)
{
  return grid.dimension == 3 ? 8 : 4;
}

bool along(int kind, int axis)
{
  return ((kind >> axis) & 1) != 0;
}

/// What a row of nodes is linked to on one side, the links of the other axes collapsed onto it.
struct Neighbour
{
  int links = 0;
  std::array<const float*, 9> link{};
  int kind = 0; // of the neighbour; 0: a coarse node
  int base = 0; // lowest corner it reaches
  std::array<const std::uint16_t*, 8> weight{};
};

/// The weights of the nodes of one kind in a row of cells; the kinds of lower order are there.
class WeightRow
{
public:
  WeightRow(Level& fine, const Level& coarse, const WeightLayout& layout, int kind, std::int64_t cy, std::int64_t cz)
    : fine_(fine)
    , coarse_(coarse)
    , layout_(layout)
    , kind_(kind)
    , kinds_(kindsOf(fine.grid))
    , cy_(cy)
    , cz_(cz)
    , y_(2 * cy + ((kind >> 1) & 1))
    , z_(2 * cz + ((kind >> 2) & 1))
  {
    const std::int64_t cellRow = coarse.halo.row(cy, cz);
    for (int corner = 0; corner < kinds_; ++corner)
      if ((corner & ~kind) == 0)
        target_[static_cast<std::size_t>(corner)] = layout.at(fine.weights.data(), cellRow, kind, corner);
  }

  void compute() const
  {
    const Grid& g = fine_.grid;
    const std::int64_t cells = coarse_.grid.nx;
    if (y_ >= g.ny || z_ >= g.nz)
    {
      for (std::int64_t x = 0; x < cells; ++x)
        beyond(x, y_ >= g.ny ? 1 : 2);
      return;
    }
    // for the whole row at once: total, links to one neighbour, sums of the corners
    const std::int64_t n = g.count(kind_ & 1);
    thread_local std::vector<float> sums; // as many rows as there are would ask for memory
    sums.assign(static_cast<std::size_t>(10 * n), 0.0F);
    for (const Neighbour& nb : neighbours())
      add(nb, n, sums.data());
    setFractions(n, sums.data());
    for (std::int64_t x = n; x < cells; ++x)
      beyond(x, 0);
  }

private:
  /// A node beyond the last one: a wall's ghost, or the image of the first node, which lies in the next cell. There it
  /// has the parity `axis` less.
  void beyond(std::int64_t x, int axis) const
  {
    for (auto* t : target_)
      if (t != nullptr)
        t[x] = 0;
    const int rest = kind_ & ~(1 << axis);
    if (!fine_.periodic[static_cast<std::size_t>(axis)] || rest == 0)
    {
      target_[static_cast<std::size_t>(kind_)][x] = 65535;
      return;
    }
    const std::int64_t row = coarse_.halo.row(cy_ + (axis == 1 ? 1 : 0), cz_ + (axis == 2 ? 1 : 0));
    for (int corner = 0; corner < kinds_; ++corner)
      if ((corner & ~rest) == 0)
        target_[static_cast<std::size_t>(corner | (1 << axis))][x] =
          layout_.at(fine_.weights.data(), row, rest, corner)[x + (axis == 0 ? 1 : 0)];
  }

  /// Along the odd axes.
  [[nodiscard]] std::vector<Neighbour> neighbours() const
  {
    std::vector<Neighbour> found;
    for (int oz = -1; oz <= 1; ++oz)
      for (int oy = -1; oy <= 1; ++oy)
        for (int ox = -1; ox <= 1; ++ox)
        {
          const std::array<int, 3> o{ ox, oy, oz };
          bool inPlane = ox != 0 || oy != 0 || oz != 0;
          for (int a = 0; a < 3; ++a)
            if (!along(kind_, a) && o[static_cast<std::size_t>(a)] != 0)
              inPlane = false;
          if (!inPlane)
            continue;
          if (const Neighbour nb = neighbourAt(o); nb.links > 0)
            found.push_back(nb);
        }
    return found;
  }

  [[nodiscard]] Neighbour neighbourAt(const std::array<int, 3>& o) const
  {
    Neighbour nb;
    for (int a = 0; a < 3; ++a)
      if (along(kind_, a))
      {
        nb.kind |= o[static_cast<std::size_t>(a)] == 0 ? 1 << a : 0;
        nb.base |= o[static_cast<std::size_t>(a)] > 0 ? 1 << a : 0;
      }
    const Grid& g = fine_.grid;
    const int part = kind_ & 1;
    const int(*directions)[3] = directionsOf(g);
    for (int d = 0; d < fine_.directions(); ++d)
      for (const int sign : { 1, -1 })
      {
        const std::array<int, 3> s{ sign * directions[d][0], sign * directions[d][1], sign * directions[d][2] };
        bool same = true;
        for (int a = 0; a < 3; ++a)
          if (along(kind_, a) && s[static_cast<std::size_t>(a)] != o[static_cast<std::size_t>(a)])
            same = false;
        if (!same)
          continue;
        const float* array = fine_.links[static_cast<std::size_t>(d)].data();
        nb.link[static_cast<std::size_t>(nb.links++)] = sign > 0
          ? array + g.row(y_, z_) + g.shift(part, 0)
          : array + g.row(y_ + s[1], z_ + s[2]) + g.shift(part, s[0]);
      }
    const std::int64_t row = coarse_.halo.row(cy_ + ((nb.base >> 1) & 1), cz_ + ((nb.base >> 2) & 1));
    for (int corner = 0; nb.kind != 0 && corner < kinds_; ++corner)
      if ((corner & ~nb.kind) == 0)
        nb.weight[static_cast<std::size_t>(corner)] =
          layout_.at(fine_.weights.data(), row, nb.kind, corner) + (nb.base & 1);
    return nb;
  }

  /// @param sums  n of each: total, links to the neighbour, and a row a corner
  void add(const Neighbour& nb, std::int64_t n, float* sums) const
  {
    float* total = sums;
    float* link = total + n;
    const auto cornerSum = [&](int corner) { return sums + (2 + corner) * n; };
    std::copy_n(nb.link[0], n, link);
    for (int l = 1; l < nb.links; ++l)
    {
      const float* more = nb.link[static_cast<std::size_t>(l)];
      for (std::int64_t x = 0; x < n; ++x)
        link[x] += more[x];
    }
    for (std::int64_t x = 0; x < n; ++x)
    {
      link[x] = link[x] > 0.0F ? link[x] : 0.0F;
      total[x] += link[x];
    }
    if (nb.kind == 0)
    {
      float* w = cornerSum(nb.base);
      for (std::int64_t x = 0; x < n; ++x)
        w[x] += link[x] * 65535.0F;
      return;
    }
    for (int corner = 0; corner < kinds_; ++corner)
      if (const std::uint16_t* weight = nb.weight[static_cast<std::size_t>(corner)])
      {
        float* w = cornerSum(nb.base + corner);
        for (std::int64_t x = 0; x < n; ++x)
          w[x] += link[x] * static_cast<float>(static_cast<std::int32_t>(weight[x]));
      }
  }

  /// Fractions of 65535, what rounding leaves going to the corner with the largest; no link at all: lowest corner.
  void setFractions(std::int64_t n, const float* sums) const
  {
    const float* total = sums;
    thread_local std::vector<int> values;
    values.assign(static_cast<std::size_t>(3 * n), 0);
    int* rest = values.data();
    int* largest = rest + n;
    int* owner = largest + n;
    std::fill_n(rest, n, 65535);
    for (int corner = 0; corner < kinds_; ++corner)
    {
      std::uint16_t* out = target_[static_cast<std::size_t>(corner)];
      if (out == nullptr)
        continue;
      const float* w = sums + (2 + corner) * n;
      for (std::int64_t x = 0; x < n; ++x)
      {
        const int value = total[x] > 0.0F ? static_cast<int>(w[x] / total[x] + 0.5F) : 0;
        out[x] = static_cast<std::uint16_t>(value);
        rest[x] -= value;
        owner[x] = value > largest[x] ? corner : owner[x];
        largest[x] = value > largest[x] ? value : largest[x];
      }
    }
    for (std::int64_t x = 0; x < n; ++x)
      if (rest[x] != 0)
      {
        std::uint16_t& w = target_[static_cast<std::size_t>(owner[x])][x];
        w = static_cast<std::uint16_t>(w + rest[x]);
      }
  }

  Level& fine_;
  const Level& coarse_;
  const WeightLayout& layout_;
  int kind_;
  int kinds_;
  std::int64_t cy_;
  std::int64_t cz_;
  std::int64_t y_;
  std::int64_t z_;
  std::array<std::uint16_t*, 8> target_{};
};

/// Neighbours' cells, and the cells round periodic sides.
void exchangeWeights(Level& fine, const Level& coarse, const WeightLayout& layout)
{
  const std::int64_t nx = coarse.grid.nx;
  if (fine.periodic[0])
    for (std::int64_t row = 0; row < coarse.halo.rows(); ++row)
      for (int a = 0; a < layout.arrays; ++a)
      {
        std::uint16_t* w = fine.weights.data() + row * layout.rowLength() + a * layout.length + 1;
        w[-1] = w[nx - 1];
        w[nx] = w[0];
      }
  coarse.halo.exchange(fine.weights.data(), static_cast<std::size_t>(layout.rowLength()) * sizeof(std::uint16_t));
}

/// The fine links of the cells of one row. The image of the first row is that row: its links but those back to the last
/// row belong to the first cell.
CellLinks linksOfCells(const Level& fine, std::int64_t cy, std::int64_t cz)
{
  const Grid& g = fine.grid;
  const int(*directions)[3] = directionsOf(g);
  CellLinks links{};
  for (int bz = 0; bz < 3; ++bz)
    for (int by = 0; by < 3; ++by)
    {
      const std::int64_t y = 2 * cy + by;
      const std::int64_t z = 2 * cz + bz;
      const bool exists = y >= -1 && y <= g.ny && z >= -g.ghostZ && z < g.nz + g.ghostZ;
      for (int d = 0; exists && d < fine.directions(); ++d)
      {
        const bool image = (by == 1 && y == g.ny && fine.periodic[1] && directions[d][1] >= 0) ||
          (bz == 1 && z == g.nz && fine.periodic[2]);
        if (!image)
          links.link[by][bz][d] = fine.links[static_cast<std::size_t>(d)].data() + g.row(y, z);
      }
    }
  return links;
}

/// Galerkin product: links accumulate in natural order, one slot to the right for the ghost at x = -1.
void addGalerkinLinks(Level& fine, Level& coarse)
{
  const Grid& g = fine.grid;
  const Grid& c = coarse.grid;
  const WeightLayout layout(g.dimension, c.nx);
  const int forward = coarse.directions();
  const std::int64_t firstY = coarse.halo.inside(1, -1) ? 0 : -1;
  const std::int64_t firstZ = g.dimension == 2 || coarse.halo.inside(2, -1) ? 0 : -1;
  const int kinds = kindsOf(g);
  const int layers = g.dimension == 3 ? 2 : 1;
  for (std::int64_t cz = firstZ; cz < c.nz; ++cz)
    for (std::int64_t cy = firstY; cy < c.ny; ++cy)
    {
      CellWeights weights[2][2]{};
      float* out[2][2][maxForward]{};
      for (int bz = 0; bz < layers; ++bz)
        for (int by = 0; by < 2; ++by)
        {
          for (int d = 0; d < forward; ++d)
            out[by][bz][d] = coarse.links[static_cast<std::size_t>(d)].data() + c.row(cy + by, cz + bz) + 1;
          for (int kind = 1; kind < kinds; ++kind)
            for (int corner = 0; corner < kinds; ++corner)
              if ((corner & ~kind) == 0)
                weights[by][bz].w[kind][corner] =
                  layout.at(fine.weights.data(), coarse.halo.row(cy + by, cz + bz), kind, corner);
        }
      kernels().galerkin(
        g.dimension, fine.straight, fine.periodic[0] ? 0 : -1, c.nx, g.half, linksOfCells(fine, cy, cz), weights, out);
    }
}

/// From natural order to that of the colours, with what lies beyond the high sides brought home.
void settleLinks(Level& coarse)
{
  const Grid& c = coarse.grid;
  std::vector<float> natural(static_cast<std::size_t>(c.nx + 2));
  for (FloatArray& array : coarse.links)
  {
    if (coarse.periodic[0])
      for (std::int64_t z = -c.ghostZ; z < c.nz + c.ghostZ; ++z)
        for (std::int64_t y = -1; y <= c.ny; ++y)
        {
          float* row = array.data() + c.row(y, z) + 1;
          row[0] += row[c.nx];
          row[c.nx] = 0;
        }
    coarse.halo.addHighGhosts(array.data() + Grid::lead, static_cast<std::size_t>(c.stride));
    for (std::int64_t z = -c.ghostZ; z < c.nz + c.ghostZ; ++z)
      for (std::int64_t y = -1; y <= c.ny; ++y)
      {
        float* row = array.data() + c.row(y, z);
        std::copy_n(row, c.nx + 2, natural.data());
        std::fill_n(row, c.stride, 0.0F);
        for (std::int64_t x = -1; x <= c.nx; ++x)
          row[c.node(x)] = natural[static_cast<std::size_t>(x + 1)];
      }
    coarse.exchange(array);
  }
}

} // namespace

void Multigrid::computeWeights(Level& fine, const Level& coarse) const
{
  const Grid& c = coarse.grid;
  const WeightLayout layout(fine.grid.dimension, c.nx);
  const int kinds = kindsOf(fine.grid);

  // the lowest corner of the cell until told otherwise: right for what lies below the box
  fine.weights.assign(static_cast<std::size_t>(coarse.halo.rows() * layout.rowLength()), 0);
  for (std::int64_t row = 0; row < coarse.halo.rows(); ++row)
    for (int kind = 1; kind < kinds; ++kind)
      std::fill_n(layout.at(fine.weights.data(), row, kind, 0) - 1, layout.length, std::uint16_t{ 65535 });

  for (int order = 1; order <= fine.grid.dimension; ++order)
  {
    for (int kind = 1; kind < kinds; ++kind)
    {
      if (std::popcount(static_cast<unsigned>(kind)) != order)
        continue;
#pragma omp parallel for num_threads(threads_) if (threads_ > 1) schedule(static)
      for (std::int64_t i = 0; i < c.ny * c.nz; ++i)
        WeightRow(fine, coarse, layout, kind, i % c.ny, i / c.ny).compute();
    }
    exchangeWeights(fine, coarse, layout);
  }
}

std::unique_ptr<Level> halved(const Level& fine)
{
  const Grid& g = fine.grid;
  auto coarse = std::make_unique<Level>();
  coarse->grid = Grid(g.dimension, (g.nx + 1) / 2, (g.ny + 1) / 2, (g.nz + 1) / 2);
  const Grid& c = coarse->grid;
  coarse->periodic = fine.periodic;
  coarse->depth = fine.depth + 1;
  coarse->halvings = fine.halvings + 1;
  for (std::size_t a = 0; a < 3; ++a)
  {
    coarse->start[a] = fine.start[a] / 2;
    coarse->size[a] = (fine.size[a] + 1) / 2;
  }
  coarse->comm = std::make_unique<Communicator>(*fine.comm);
  coarse->parts = std::make_unique<Decomposition>(*fine.parts);
  coarse->halo = Halo(g.dimension, { c.nx, c.ny, c.nz }, *coarse->parts, *coarse->comm, coarse->periodic);
  return coarse;
}

std::unique_ptr<Level> Multigrid::coarsen(Level& fine) const
{
  if (coarsening_ == Coarsening::Blocks)
    return coarsenBlocks(
      fine,
      [&](int d, std::int64_t y, std::int64_t z, float* out)
      {
        const Grid& g = fine.grid;
        const float* row = fine.links[static_cast<std::size_t>(d)].data() + g.row(y, z);
        out[0] = row[g.node(-1)];
        kernels().merge(g.nx, g.half, row, out + 1);
      },
      threadsOn(fine));
  const Grid& g = fine.grid;
  auto coarse = halved(fine);
  const Grid& c = coarse->grid;
  coarse->straight = false;
  computeWeights(fine, *coarse);

  coarse->allocateLinks(g.dimension == 3 ? 13 : 4);
  // The image of the first node along x: as for rows in linksOfCells(), but the kernel takes whole rows.
  const int(*directions)[3] = directionsOf(g);
  const bool oddX = fine.periodic[0] && g.nx % 2 != 0;
  if (oddX)
    for (int d = 0; d < fine.directions(); ++d)
      for (std::int64_t row = 0; directions[d][0] >= 0 && row < g.rows(); ++row)
        fine.links[static_cast<std::size_t>(d)][static_cast<std::size_t>(Grid::lead + row * g.stride + g.node(g.nx))] =
          0;
  addGalerkinLinks(fine, *coarse);
  if (oddX)
    for (FloatArray& array : fine.links)
      fine.exchange(array);
  settleLinks(*coarse);

  computeInverse(*coarse);
  coarse->u.assign(c.floats(), 0.0F);
  coarse->f.assign(c.floats(), 0.0F);
  // residual planes of the fine level
  fine.residual.assign(g.dimension == 3 ? 3 : 1, FloatArray(static_cast<std::size_t>(g.ny * g.stride), 0.0F));
  return coarse;
}

} // namespace lamella::lbm
