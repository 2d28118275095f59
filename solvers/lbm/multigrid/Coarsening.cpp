// From one level to the next: interpolation weights and the Galerkin product.
#include "lbm/multigrid/Multigrid.h"
#include "lbm/multigrid/WeightLayout.h"

#include <algorithm>
#include <bit>

namespace lamella::lbm
{

void Multigrid::computeWeights(Level& fine, const Level& coarse) const
{
  const Grid& g = fine.grid;
  const Grid& c = coarse.grid;
  const WeightLayout layout(g.dimension, c.nx);
  const int kinds = g.dimension == 3 ? 8 : 4;
  const int axes = g.dimension;
  const int(*directions)[3] = g.dimension == 3 ? directions3 : directions2;

  // the lowest corner of the cell until told otherwise: right for what lies below the box
  fine.weights.assign(static_cast<std::size_t>(coarse.halo.rows() * layout.rowLength()), 0);
  for (std::int64_t row = 0; row < coarse.halo.rows(); ++row)
    for (int kind = 1; kind < kinds; ++kind)
      std::fill_n(layout.at(fine.weights.data(), row, kind, 0) - 1, layout.length, std::uint16_t{ 65535 });

  for (int order = 1; order <= axes; ++order)
  {
    for (int kind = 1; kind < kinds; ++kind)
    {
      if (std::popcount(static_cast<unsigned>(kind)) != order)
        continue;
      const int part = kind & 1;
#pragma omp parallel for num_threads(threads_) if (threads_ > 1) schedule(static)
      for (std::int64_t i = 0; i < c.ny * c.nz; ++i)
      {
        const std::int64_t cy = i % c.ny;
        const std::int64_t cz = i / c.ny;
        const std::int64_t y = 2 * cy + ((kind >> 1) & 1);
        const std::int64_t z = 2 * cz + ((kind >> 2) & 1);
        const std::int64_t cellRow = coarse.halo.row(cy, cz);
        std::array<std::uint16_t*, 8> target{};
        for (int corner = 0; corner < kinds; ++corner)
          if ((corner & ~kind) == 0)
            target[static_cast<std::size_t>(corner)] = layout.at(fine.weights.data(), cellRow, kind, corner);
        // A node beyond the last one: a wall's ghost, or the image of the first node, which lies in the next cell.
        // There it has the parity `axis` less.
        const auto beyond = [&](std::int64_t x, int axis)
        {
          for (auto* t : target)
            if (t != nullptr)
              t[x] = 0;
          const int rest = kind & ~(1 << axis);
          if (!fine.periodic[static_cast<std::size_t>(axis)] || rest == 0)
          {
            target[static_cast<std::size_t>(kind)][x] = 65535;
            return;
          }
          const std::int64_t row = coarse.halo.row(cy + (axis == 1 ? 1 : 0), cz + (axis == 2 ? 1 : 0));
          for (int corner = 0; corner < kinds; ++corner)
            if ((corner & ~rest) == 0)
              target[static_cast<std::size_t>(corner | (1 << axis))][x] =
                layout.at(fine.weights.data(), row, rest, corner)[x + (axis == 0 ? 1 : 0)];
        };
        if (y >= g.ny || z >= g.nz)
        {
          for (std::int64_t x = 0; x < c.nx; ++x)
            beyond(x, y >= g.ny ? 1 : 2);
          continue;
        }

        // Neighbours along the odd axes, the links of the other axes collapsed onto them.
        struct Neighbour
        {
          int links = 0;
          std::array<const float*, 9> link{};
          int kind = 0; // of the neighbour; 0: a coarse node
          int base = 0; // lowest corner it reaches
          std::array<const std::uint16_t*, 8> weight{};
        };
        std::vector<Neighbour> neighbours;
        for (int oz = -1; oz <= 1; ++oz)
          for (int oy = -1; oy <= 1; ++oy)
            for (int ox = -1; ox <= 1; ++ox)
            {
              const std::array<int, 3> o{ ox, oy, oz };
              bool inPlane = ox != 0 || oy != 0 || oz != 0;
              for (int a = 0; a < 3; ++a)
                if (((kind >> a) & 1) == 0 && o[static_cast<std::size_t>(a)] != 0)
                  inPlane = false;
              if (!inPlane)
                continue;
              Neighbour nb;
              for (int a = 0; a < 3; ++a)
                if ((kind >> a) & 1)
                {
                  nb.kind |= o[static_cast<std::size_t>(a)] == 0 ? 1 << a : 0;
                  nb.base |= o[static_cast<std::size_t>(a)] > 0 ? 1 << a : 0;
                }
              for (int d = 0; d < fine.directions(); ++d)
                for (const int sign : { 1, -1 })
                {
                  const std::array<int, 3> s{ sign * directions[d][0], sign * directions[d][1],
                    sign * directions[d][2] };
                  bool same = true;
                  for (int a = 0; a < 3; ++a)
                    if (((kind >> a) & 1) != 0 && s[static_cast<std::size_t>(a)] != o[static_cast<std::size_t>(a)])
                      same = false;
                  if (!same)
                    continue;
                  const float* array = fine.links[static_cast<std::size_t>(d)].data();
                  nb.link[static_cast<std::size_t>(nb.links++)] = sign > 0
                    ? array + g.row(y, z) + g.shift(part, 0)
                    : array + g.row(y + s[1], z + s[2]) + g.shift(part, s[0]);
                }
              if (nb.links == 0)
                continue;
              const std::int64_t row = coarse.halo.row(cy + ((nb.base >> 1) & 1), cz + ((nb.base >> 2) & 1));
              for (int corner = 0; nb.kind != 0 && corner < kinds; ++corner)
                if ((corner & ~nb.kind) == 0)
                  nb.weight[static_cast<std::size_t>(corner)] =
                    layout.at(fine.weights.data(), row, nb.kind, corner) + (nb.base & 1);
              neighbours.push_back(nb);
            }

        // sums for the whole row at once: total, one row a corner, and the links to one neighbour
        const std::int64_t n = g.count(part);
        std::vector<float> sums(static_cast<std::size_t>(10 * n), 0.0F);
        float* total = sums.data();
        float* link = total + n;
        const auto cornerSum = [&](int corner) { return sums.data() + (2 + corner) * n; };
        for (const Neighbour& nb : neighbours)
        {
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
            continue;
          }
          for (int corner = 0; corner < kinds; ++corner)
            if (const std::uint16_t* weight = nb.weight[static_cast<std::size_t>(corner)])
            {
              float* w = cornerSum(nb.base + corner);
              for (std::int64_t x = 0; x < n; ++x)
                w[x] += link[x] * static_cast<float>(static_cast<std::int32_t>(weight[x]));
            }
        }
        // fractions of 65535, what rounding leaves going to the corner with the largest; no link at all: lowest corner
        std::vector<int> values(static_cast<std::size_t>(3 * n), 0);
        int* rest = values.data();
        int* largest = rest + n;
        int* owner = largest + n;
        std::fill_n(rest, n, 65535);
        for (int corner = 0; corner < kinds; ++corner)
        {
          std::uint16_t* out = target[static_cast<std::size_t>(corner)];
          if (out == nullptr)
            continue;
          const float* w = cornerSum(corner);
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
            std::uint16_t& w = target[static_cast<std::size_t>(owner[x])][x];
            w = static_cast<std::uint16_t>(w + rest[x]);
          }
        for (std::int64_t x = n; x < c.nx; ++x)
          beyond(x, 0);
      }
    }
    // neighbours' cells, and the cells round periodic sides
    if (fine.periodic[0])
      for (std::int64_t row = 0; row < coarse.halo.rows(); ++row)
        for (int a = 0; a < layout.arrays; ++a)
        {
          std::uint16_t* w = fine.weights.data() + row * layout.rowLength() + a * layout.length + 1;
          w[-1] = w[c.nx - 1];
          w[c.nx] = w[0];
        }
    coarse.halo.exchange(fine.weights.data(), static_cast<std::size_t>(layout.rowLength()) * sizeof(std::uint16_t));
  }
}

std::unique_ptr<Level> Multigrid::coarsen(Level& fine) const
{
  const Grid& g = fine.grid;
  auto coarse = std::make_unique<Level>();
  coarse->grid = Grid(g.dimension, (g.nx + 1) / 2, (g.ny + 1) / 2, (g.nz + 1) / 2);
  const Grid& c = coarse->grid;
  coarse->periodic = fine.periodic;
  coarse->straight = false;
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
  computeWeights(fine, *coarse);

  // Galerkin product: links accumulate in natural order, one slot to the right for the ghost at x = -1.
  coarse->allocateLinks(g.dimension == 3 ? 13 : 4);
  const int forward = coarse->directions();
  const WeightLayout layout(g.dimension, c.nx);
  const std::int64_t firstY = coarse->halo.inside(1, -1) ? 0 : -1;
  const std::int64_t firstZ = g.dimension == 2 || coarse->halo.inside(2, -1) ? 0 : -1;
  const int kinds = g.dimension == 3 ? 8 : 4;
  const int layers = g.dimension == 3 ? 2 : 1;
  const int(*directions)[3] = g.dimension == 3 ? directions3 : directions2;
  // likewise along x, where the kernel takes whole rows
  const bool oddX = fine.periodic[0] && g.nx % 2 != 0;
  if (oddX)
    for (int d = 0; d < fine.directions(); ++d)
      for (std::int64_t row = 0; directions[d][0] >= 0 && row < g.rows(); ++row)
        fine.links[static_cast<std::size_t>(d)][static_cast<std::size_t>(Grid::lead + row * g.stride + g.node(g.nx))] =
          0;
  for (std::int64_t cz = firstZ; cz < c.nz; ++cz)
    for (std::int64_t cy = firstY; cy < c.ny; ++cy)
    {
      CellLinks links{};
      CellWeights weights[2][2]{};
      float* out[2][2][maxForward]{};
      for (int bz = 0; bz < 3; ++bz)
        for (int by = 0; by < 3; ++by)
        {
          const std::int64_t y = 2 * cy + by;
          const std::int64_t z = 2 * cz + bz;
          const bool exists = y >= -1 && y <= g.ny && z >= -g.ghostZ && z < g.nz + g.ghostZ;
          for (int d = 0; exists && d < fine.directions(); ++d)
          {
            // the image of the first row is that row: its links but those back to the last row belong to the first cell
            const bool image = (by == 1 && y == g.ny && fine.periodic[1] && directions[d][1] >= 0) ||
              (bz == 1 && z == g.nz && fine.periodic[2]);
            if (!image)
              links.link[by][bz][d] = fine.links[static_cast<std::size_t>(d)].data() + g.row(y, z);
          }
        }
      for (int bz = 0; bz < layers; ++bz)
        for (int by = 0; by < 2; ++by)
        {
          for (int d = 0; d < forward; ++d)
            out[by][bz][d] = coarse->links[static_cast<std::size_t>(d)].data() + c.row(cy + by, cz + bz) + 1;
          for (int kind = 1; kind < kinds; ++kind)
            for (int corner = 0; corner < kinds; ++corner)
              if ((corner & ~kind) == 0)
                weights[by][bz].w[kind][corner] =
                  layout.at(fine.weights.data(), coarse->halo.row(cy + by, cz + bz), kind, corner);
        }
      kernels().galerkin(g.dimension, fine.straight, fine.periodic[0] ? 0 : -1, c.nx, g.half, links, weights, out);
    }

  if (oddX)
    for (FloatArray& array : fine.links)
      fine.exchange(array);
  std::vector<float> natural(static_cast<std::size_t>(c.nx + 2));
  for (FloatArray& array : coarse->links)
  {
    if (fine.periodic[0])
      for (std::int64_t z = -c.ghostZ; z < c.nz + c.ghostZ; ++z)
        for (std::int64_t y = -1; y <= c.ny; ++y)
        {
          float* row = array.data() + c.row(y, z) + 1;
          row[0] += row[c.nx];
          row[c.nx] = 0;
        }
    coarse->halo.addHighGhosts(array.data() + Grid::lead, static_cast<std::size_t>(c.stride));
    for (std::int64_t z = -c.ghostZ; z < c.nz + c.ghostZ; ++z)
      for (std::int64_t y = -1; y <= c.ny; ++y)
      {
        float* row = array.data() + c.row(y, z);
        std::copy_n(row, c.nx + 2, natural.data());
        std::fill_n(row, c.stride, 0.0F);
        for (std::int64_t x = -1; x <= c.nx; ++x)
          row[c.node(x)] = natural[static_cast<std::size_t>(x + 1)];
      }
    coarse->exchange(array);
  }

  computeInverse(*coarse);
  coarse->u.assign(c.floats(), 0.0F);
  coarse->f.assign(c.floats(), 0.0F);
  // residual planes of the fine level
  fine.residual.assign(g.dimension == 3 ? 3 : 1, FloatArray(static_cast<std::size_t>(g.ny * g.stride), 0.0F));
  return coarse;
}

} // namespace lamella::lbm
