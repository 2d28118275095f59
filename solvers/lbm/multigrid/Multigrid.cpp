#include "lbm/multigrid/Multigrid.h"

#include "lattice/Error.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace lamella::lbm
{
namespace
{

constexpr std::int64_t coarsestNodes = 600;
constexpr std::int64_t gatherNodes = 32768;

} // namespace

void Level::allocateLinks(int count)
{
  links.assign(static_cast<std::size_t>(count), FloatArray(grid.floats(), 0.0F));
}

void Level::wrapRow(float* row) const noexcept
{
  // nodes nx and -1; an odd row has no coarser level, but it is multiplied by
  row[grid.node(grid.nx)] = row[0];
  row[grid.half - 1] = row[grid.node(grid.nx - 1)];
}

void Level::exchange(FloatArray& v) const
{
  if (periodic[0])
    for (std::int64_t z = 0; z < grid.nz; ++z)
      for (std::int64_t y = 0; y < grid.ny; ++y)
        wrapRow(v.data() + grid.row(y, z));
  halo.exchange(v.data() + Grid::lead, static_cast<std::size_t>(grid.stride) * sizeof(float));
}

bool canHalve(const std::array<std::int64_t, 3>& size, const std::array<bool, 3>& periodic)
{
  if (size[0] * size[1] * size[2] <= coarsestNodes)
    return false;
  for (int a = 0; a < 3; ++a)
    if (periodic[a] && (size[a] % 2 != 0 || size[a] < 4))
      return false;
  return true;
}

Multigrid::Multigrid(Level finest, int threads)
  : threads_(std::max(1, threads))
{
  levels_.push_back(std::make_unique<Level>(std::move(finest)));
  Level& top = *levels_.front();
  top.halo = Halo(top.grid.dimension, { top.grid.nx, top.grid.ny, top.grid.nz }, *top.parts, *top.comm, top.periodic);
  build();
}

void Multigrid::build()
{
  int distributedLeft = levels_.front()->parts->levels();
  for (;;)
  {
    Level& level = *levels_.back();
    const bool parallel = level.comm->parallel();
    const bool more = canHalve(level.size, level.periodic);
    if (parallel &&
      (!more || distributedLeft == 0 ||
        (levels_.size() > 1 && level.size[0] * level.size[1] * level.size[2] <= gatherNodes)))
    {
      level.gathered = true;
      levels_.push_back(gather(level));
      continue;
    }
    if (!more)
      break;
    levels_.push_back(coarsen(level));
    --distributedLeft;
  }
  factorize(*levels_.back());
}

std::uint64_t Multigrid::bytes() const
{
  std::uint64_t total = 0;
  for (const auto& level : levels_)
  {
    for (const auto& a : level->links)
      total += a.size() * sizeof(float);
    for (const auto& a : level->residual)
      total += a.size() * sizeof(float);
    total += (level->inverse.size() + level->u.size() + level->f.size()) * sizeof(float);
    total += level->weights.size() * sizeof(std::uint16_t);
  }
  return total;
}

// ---- cycle ------------------------------------------------------------------------------------------------------

void Multigrid::apply(const FloatArray& r, FloatArray& z)
{
  cycle(0, r, z, true);
}

void Multigrid::cycle(std::size_t index, const FloatArray& f, FloatArray& u, bool fromZero)
{
  Level& level = *levels_[index];
  if (index + 1 == levels_.size())
  {
    solveDirectly(level, f, u);
    return;
  }
  Level& next = *levels_[index + 1];
  if (level.gathered)
  {
    gatherVector(level, f, next, next.f);
    cycle(index + 1, next.f, next.u, fromZero);
    scatterVector(next, next.u, level, u);
    return;
  }
  relax(level, f, u, true, fromZero);
  restrictResidual(level, f, u, next);
  cycle(index + 1, next.f, next.u, true);
  // in 3D the second visits begin a level further down: the first coarse level is four fifths of their cost
  const bool again = level.grid.dimension == 2 || index > 0;
  for (int visit = 1; again && visit < visits_ && index + 2 < levels_.size(); ++visit)
    cycle(index + 1, next.f, next.u, false);
  interpolateAdd(level, u, next);
  relax(level, f, u, false, false);
}

void Multigrid::relaxRow(
  const Level& level, const FloatArray& f, FloatArray& u, std::int64_t y, std::int64_t z, int part, bool fromZero) const
{
  const Grid& g = level.grid;
  const Kernels& k = kernels();
  const std::int64_t n = g.count(part);
  const std::int64_t row = g.row(y, z);
  const std::int64_t here = row + g.shift(part, 0);
  const float* link[2 * maxForward];
  const float* value[2 * maxForward];
  const int(*directions)[3] = g.dimension == 3 ? directions3 : directions2;
  const int forward = level.directions();
  for (int d = 0; d < forward; ++d)
  {
    const int* s = directions[d];
    const std::int64_t there = g.row(y + s[1], z + s[2]) + g.shift(part, s[0]);
    const std::int64_t back = g.row(y - s[1], z - s[2]) + g.shift(part, -s[0]);
    const float* array = level.links[static_cast<std::size_t>(d)].data();
    link[2 * d] = array + back;
    value[2 * d] = u.data() + back;
    link[2 * d + 1] = array + here;
    value[2 * d + 1] = u.data() + there;
  }
  if (level.straight && fromZero)
    k.relaxStraightFromZero(2 * forward, n, u.data() + here, f.data() + here, link);
  else if (level.straight)
    k.relaxStraight(2 * forward, n, u.data() + here, f.data() + here, link, value);
  else
    k.relaxGeneral(2 * forward, n, u.data() + here, f.data() + here, level.inverse.data() + here, link, value);
  if (level.periodic[0])
    level.wrapRow(u.data() + row);
}

void Multigrid::relax(const Level& level, const FloatArray& f, FloatArray& u, bool forward, bool fromZero) const
{
  const Grid& g = level.grid;
  const std::int64_t rows = g.ny * g.nz;
  const auto communicates = [&]
  {
    for (const int axis : { 1, 2 })
      if (level.halo.inside(axis, -1) || level.halo.inside(axis, +1))
        return true;
    return false;
  };
  if (level.straight)
  {
    const auto colourOf = [&](std::int64_t y, std::int64_t z, int colour)
    { relaxRow(level, f, u, y, z, static_cast<int>((y + z + colour) & 1), fromZero && colour == 0); };
    const int first = forward ? 0 : 1;
    if (threads_ == 1 && !communicates())
    {
      // both colours in one pass, the second a layer behind the first, so that data is still in cache
      const std::int64_t layers = g.dimension == 3 ? g.nz : g.ny;
      const auto layer = [&](std::int64_t l, int colour)
      {
        if (g.dimension == 2)
          colourOf(l, 0, colour);
        else
          for (std::int64_t y = 0; y < g.ny; ++y)
            colourOf(y, l, colour);
      };
      for (std::int64_t l = 0; l <= layers; ++l)
      {
        if (l < layers)
          layer(l, first);
        if (l > 0)
          layer(l - 1, 1 - first);
      }
      return;
    }
    for (const int colour : { first, 1 - first })
    {
#pragma omp parallel for num_threads(threads_) if (threads_ > 1) schedule(static)
      for (std::int64_t i = 0; i < rows; ++i)
        colourOf(i % g.ny, i / g.ny, colour);
      level.halo.exchange(u.data() + Grid::lead, static_cast<std::size_t>(g.stride) * sizeof(float));
    }
    return;
  }

  if (fromZero)
    std::fill(u.begin(), u.end(), 0.0F);
  // Rows of equal parity in y and z do not touch; within a row the even nodes come first, or last on the way back.
  const auto rowsOf = [&](std::int64_t startY, std::int64_t z)
  {
    for (std::int64_t y = startY; y < g.ny; y += 2)
    {
      relaxRow(level, f, u, y, z, forward ? 0 : 1, false);
      relaxRow(level, f, u, y, z, forward ? 1 : 0, false);
    }
  };
  const std::int64_t firstY = forward ? 0 : 1;
  if (threads_ == 1 && !communicates() && g.dimension == 3)
  {
    // The order of colours even planes first (or last), a plane at a time: a plane of one parity follows as soon as
    // both its neighbours are done, so that links are still in cache. The same numbers as colour by colour.
    const std::int64_t firstParity = forward ? 0 : 1;
    const auto plane = [&](std::int64_t z)
    {
      rowsOf(firstY, z);
      rowsOf(1 - firstY, z);
    };
    for (std::int64_t z = 0; z <= g.nz; ++z)
    {
      if (z < g.nz && (z & 1) == firstParity)
        plane(z);
      // the plane below, of the other parity, has both neighbours once z is done, or lies at the end
      if (z > 0 && ((z - 1) & 1) != firstParity && (z == g.nz || (z & 1) == firstParity))
        plane(z - 1);
    }
    return;
  }
  const int colours = g.dimension == 3 ? 4 : 2;
  for (int i = 0; i < colours; ++i)
  {
    const int colour = forward ? i : colours - 1 - i;
    const std::int64_t startY = colour & 1;
    const std::int64_t startZ = colour >> 1;
    const std::int64_t rowsY = (g.ny - startY + 1) / 2;
    const std::int64_t rowsZ = (g.nz - startZ + 1) / 2;
#pragma omp parallel for num_threads(threads_) if (threads_ > 1) schedule(static)
    for (std::int64_t r = 0; r < rowsY * rowsZ; ++r)
    {
      const std::int64_t y = startY + 2 * (r % rowsY);
      const std::int64_t z = startZ + 2 * (r / rowsY);
      relaxRow(level, f, u, y, z, forward ? 0 : 1, false);
      relaxRow(level, f, u, y, z, forward ? 1 : 0, false);
    }
    level.halo.exchange(u.data() + Grid::lead, static_cast<std::size_t>(g.stride) * sizeof(float));
  }
}

void Multigrid::residualRow(const Level& level, const FloatArray& f, const FloatArray& u, std::int64_t y,
  std::int64_t z, float* out, bool afterForwardSweep) const
{
  const Grid& g = level.grid;
  const Kernels& k = kernels();
  const int(*directions)[3] = g.dimension == 3 ? directions3 : directions2;
  const int forward = level.directions();
  const std::int64_t row = g.row(y, z);
  for (const int part : { 0, 1 })
  {
    const std::int64_t n = g.count(part);
    if (level.straight && afterForwardSweep && ((part + y + z) & 1) != 0)
    {
      std::fill_n(out + g.shift(part, 0), n, 0.0F); // this colour was relaxed last
      continue;
    }
    const std::int64_t here = row + g.shift(part, 0);
    const float* link[2 * maxForward];
    const float* value[2 * maxForward];
    for (int d = 0; d < forward; ++d)
    {
      const int* s = directions[d];
      const std::int64_t there = g.row(y + s[1], z + s[2]) + g.shift(part, s[0]);
      const std::int64_t back = g.row(y - s[1], z - s[2]) + g.shift(part, -s[0]);
      const float* array = level.links[static_cast<std::size_t>(d)].data();
      link[2 * d] = array + back;
      value[2 * d] = u.data() + back;
      link[2 * d + 1] = array + here;
      value[2 * d + 1] = u.data() + there;
    }
    (level.straight ? k.residualStraight : k.residualGeneral)(
      2 * forward, n, out + g.shift(part, 0), f.data() + here, u.data() + here, link, value);
  }
}

double Multigrid::multiply(FloatArray& p, FloatArray& q) const
{
  const Level& level = *levels_.front();
  const Grid& g = level.grid;
  const Kernels& k = kernels();
  const int(*directions)[3] = g.dimension == 3 ? directions3 : directions2;
  const int forward = level.directions();
  level.exchange(p);
  std::vector<double> sums(static_cast<std::size_t>(g.ny * g.nz));
#pragma omp parallel for num_threads(threads_) if (threads_ > 1) schedule(static)
  for (std::int64_t i = 0; i < g.ny * g.nz; ++i)
  {
    const std::int64_t y = i % g.ny;
    const std::int64_t z = i / g.ny;
    const std::int64_t row = g.row(y, z);
    double sum = 0;
    for (const int part : { 0, 1 })
    {
      const std::int64_t here = row + g.shift(part, 0);
      const float* link[2 * maxForward];
      const float* value[2 * maxForward];
      for (int d = 0; d < forward; ++d)
      {
        const int* s = directions[d];
        const std::int64_t there = g.row(y + s[1], z + s[2]) + g.shift(part, s[0]);
        const std::int64_t back = g.row(y - s[1], z - s[2]) + g.shift(part, -s[0]);
        const float* array = level.links[static_cast<std::size_t>(d)].data();
        link[2 * d] = array + back;
        value[2 * d] = p.data() + back;
        link[2 * d + 1] = array + here;
        value[2 * d + 1] = p.data() + there;
      }
      sum += (level.straight ? k.applyStraight : k.applyGeneral)(
        2 * forward, g.count(part), q.data() + here, p.data() + here, link, value);
    }
    sums[static_cast<std::size_t>(i)] = sum;
  }
  double total = 0;
  for (const double s : sums)
    total += s;
  return total;
}

// ---- transfer ---------------------------------------------------------------------------------------------------

namespace
{

// Views of the interpolation weights of one row of cells.
struct WeightLayout
{
  int arrays;
  std::int64_t length; // cells and one ghost at each end
  int index[8][8];

  WeightLayout(int dimension, std::int64_t cells)
    : arrays(0)
    , length(cells + 2)
  {
    const int kinds = dimension == 3 ? 8 : 4;
    for (auto& row : index)
      std::fill(std::begin(row), std::end(row), -1);
    for (int kind = 1; kind < kinds; ++kind)
      for (int corner = 0; corner < kinds; ++corner)
        if ((corner & ~kind) == 0)
          index[kind][corner] = arrays++;
  }
  [[nodiscard]] std::int64_t rowLength() const { return arrays * length; }
  template <class T>
  [[nodiscard]] T* at(T* base, std::int64_t row, int kind, int corner) const
  {
    return base + row * rowLength() + index[kind][corner] * length + 1;
  }
};

} // namespace

int weightArrays(int dimension) noexcept
{
  return dimension == 3 ? 26 : 8;
}

void Multigrid::restrictResidual(Level& fine, const FloatArray& f, const FloatArray& u, Level& coarse) const
{
  const Grid& g = fine.grid;
  const Grid& c = coarse.grid;
  const Kernels& k = kernels();
  const WeightLayout layout(g.dimension, c.nx);
  const std::int64_t lastY = coarse.halo.inside(1, +1) ? c.ny : c.ny - 1;
  const std::int64_t lastZ = coarse.halo.inside(2, +1) ? c.nz : c.nz - 1;
  const std::int64_t planes = static_cast<std::int64_t>(fine.residual.size());
  const auto residualPlane = [&](std::int64_t z) { return fine.residual[static_cast<std::size_t>(z % planes)].data(); };

  std::int64_t ready = 0;
  for (std::int64_t cz = 0; cz <= lastZ; ++cz)
  {
    const std::int64_t upTo = std::min(2 * cz + 1, g.nz - 1);
    for (; ready <= upTo; ++ready)
    {
#pragma omp parallel for num_threads(threads_) if (threads_ > 1) schedule(static)
      for (std::int64_t y = 0; y < g.ny; ++y)
        residualRow(fine, f, u, y, ready, residualPlane(ready) + y * g.stride, true);
    }
#pragma omp parallel for num_threads(threads_) if (threads_ > 1) schedule(static)
    for (std::int64_t cy = 0; cy <= lastY; ++cy)
    {
      std::vector<float> natural(static_cast<std::size_t>(c.nx + 1), 0.0F);
      float* out = natural.data();
      for (int dz = -1; dz <= 1; ++dz)
        for (int dy = -1; dy <= 1; ++dy)
        {
          const std::int64_t y = 2 * cy + dy;
          const std::int64_t z = 2 * cz + dz;
          if (y < 0 || y >= g.ny || z < 0 || z >= g.nz)
            continue;
          const float* r = residualPlane(z) + y * g.stride;
          const std::int64_t cell = coarse.halo.row(cy - (dy < 0 ? 1 : 0), cz - (dz < 0 ? 1 : 0));
          const int kind = (dy != 0 ? 2 : 0) + (dz != 0 ? 4 : 0);
          const int corner = (dy < 0 ? 2 : 0) + (dz < 0 ? 4 : 0);
          if (kind == 0)
            k.axpy(g.even, 1.0F, r, out);
          else
            k.addWeighted(g.even, out, layout.at(fine.weights.data(), cell, kind, corner), r);
          k.addWeighted(g.odd, out, layout.at(fine.weights.data(), cell, kind + 1, corner), r + g.half);
          k.addWeighted(g.odd, out + 1, layout.at(fine.weights.data(), cell, kind + 1, corner + 1), r + g.half);
        }
      if (fine.periodic[0])
        out[0] += out[c.nx];
      k.split(c.nx, c.half, out, coarse.f.data() + c.row(cy, cz));
    }
  }
  coarse.halo.addHighGhosts(coarse.f.data() + Grid::lead, static_cast<std::size_t>(c.stride));
}

void Multigrid::interpolateAdd(const Level& fine, FloatArray& u, const Level& coarse) const
{
  const Grid& g = fine.grid;
  const Grid& c = coarse.grid;
  const Kernels& k = kernels();
  const WeightLayout layout(g.dimension, c.nx);
  const int layers = g.dimension == 3 ? 2 : 1;
#pragma omp parallel for num_threads(threads_) if (threads_ > 1) schedule(static)
  for (std::int64_t i = 0; i < c.ny * c.nz; ++i)
  {
    const std::int64_t cy = i % c.ny;
    const std::int64_t cz = i / c.ny;
    // the four (two) coarse rows around this row of cells, in natural order, one ghost at the end
    std::vector<float> natural(static_cast<std::size_t>(4 * (c.nx + 1)));
    const auto coarseRow = [&](int by, int bz) { return natural.data() + (by + 2 * bz) * (c.nx + 1); };
    for (int bz = 0; bz < layers; ++bz)
      for (int by = 0; by < 2; ++by)
      {
        const float* source = coarse.u.data() + c.row(cy + by, cz + bz);
        k.merge(c.nx, c.half, source, coarseRow(by, bz));
        coarseRow(by, bz)[c.nx] = fine.periodic[0] ? source[0] : 0.0F;
      }
    for (int bz = 0; bz < layers; ++bz)
      for (int by = 0; by < 2; ++by)
      {
        const std::int64_t y = 2 * cy + by;
        const std::int64_t z = 2 * cz + bz;
        if (y >= g.ny || z >= g.nz)
          continue;
        float* row = u.data() + g.row(y, z);
        const std::int64_t cell = coarse.halo.row(cy, cz);
        const int kind = 2 * by + 4 * bz;
        for (int corner = 0; corner < 8; ++corner)
        {
          if ((corner & ~(kind | 1)) != 0)
            continue;
          const float* value = coarseRow((corner >> 1) & 1, (corner >> 2) & 1);
          if ((corner & 1) == 0)
          {
            if (kind == 0)
              k.axpy(g.even, 1.0F, value, row);
            else
              k.addWeighted(g.even, row, layout.at(fine.weights.data(), cell, kind, corner), value);
          }
          k.addWeighted(
            g.odd, row + g.half, layout.at(fine.weights.data(), cell, kind + 1, corner), value + (corner & 1));
        }
        if (fine.periodic[0])
          fine.wrapRow(row);
      }
  }
  fine.halo.exchange(u.data() + Grid::lead, static_cast<std::size_t>(g.stride) * sizeof(float));
}

// ---- set-up -----------------------------------------------------------------------------------------------------

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
        const auto atHighestCorner = [&](std::int64_t x)
        {
          for (auto* t : target)
            if (t != nullptr)
              t[x] = 0;
          target[static_cast<std::size_t>(kind)][x] = 65535;
        };
        if (y >= g.ny || z >= g.nz)
        {
          for (std::int64_t x = 0; x < c.nx; ++x)
            atHighestCorner(x);
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
          atHighestCorner(x);
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
            links.link[by][bz][d] = fine.links[static_cast<std::size_t>(d)].data() + g.row(y, z);
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

  coarse->inverse.assign(c.floats(), 0.0F);
  const int(*directions)[3] = g.dimension == 3 ? directions3 : directions2;
  for (std::int64_t z = 0; z < c.nz; ++z)
    for (std::int64_t y = 0; y < c.ny; ++y)
      for (const int part : { 0, 1 })
      {
        const float* link[2 * maxForward];
        for (int d = 0; d < forward; ++d)
        {
          const int* s = directions[d];
          const float* array = coarse->links[static_cast<std::size_t>(d)].data();
          link[2 * d] = array + c.row(y - s[1], z - s[2]) + c.shift(part, -s[0]);
          link[2 * d + 1] = array + c.row(y, z) + c.shift(part, 0);
        }
        kernels().inverseSum(2 * forward, c.count(part), coarse->inverse.data() + c.row(y, z) + c.shift(part, 0), link);
      }

  coarse->u.assign(c.floats(), 0.0F);
  coarse->f.assign(c.floats(), 0.0F);
  // residual planes of the fine level
  fine.residual.assign(g.dimension == 3 ? 3 : 1, FloatArray(static_cast<std::size_t>(g.ny * g.stride), 0.0F));
  return coarse;
}

void Multigrid::factorize(const Level& coarsest)
{
  const Grid& g = coarsest.grid;
  const int(*directions)[3] = g.dimension == 3 ? directions3 : directions2;
  std::vector<Eigen::Triplet<double>> entries;
  const auto id = [&](std::int64_t x, std::int64_t y, std::int64_t z)
  { return static_cast<int>(x + g.nx * (y + g.ny * z)); };
  double toGhosts = 0;
  double largest = 0;
  for (std::int64_t z = 0; z < g.nz; ++z)
    for (std::int64_t y = 0; y < g.ny; ++y)
      for (std::int64_t x = 0; x < g.nx; ++x)
      {
        double diagonal = 0;
        for (int d = 0; d < coarsest.directions(); ++d)
          for (const int sign : { 1, -1 })
          {
            std::array<std::int64_t, 3> q{ x + sign * directions[d][0], y + sign * directions[d][1],
              z + sign * directions[d][2] };
            const FloatArray& array = coarsest.links[static_cast<std::size_t>(d)];
            const double link = sign > 0 ? array[static_cast<std::size_t>(g.row(y, z) + g.node(x))]
                                         : array[static_cast<std::size_t>(g.row(q[1], q[2]) + g.node(q[0]))];
            const std::array<std::int64_t, 3> size{ g.nx, g.ny, g.nz };
            bool ghost = false;
            for (std::size_t a = 0; a < 3; ++a)
              if (q[a] < 0 || q[a] >= size[a])
              {
                if (coarsest.periodic[a])
                  q[a] = (q[a] + size[a]) % size[a];
                else
                  ghost = true;
              }
            const int other = ghost ? -1 : id(q[0], q[1], q[2]);
            if (other == id(x, y, z))
              continue;
            diagonal += link;
            if (ghost)
              toGhosts += link;
            else
              entries.emplace_back(id(x, y, z), other, -link);
          }
        largest = std::max(largest, diagonal);
        entries.emplace_back(id(x, y, z), id(x, y, z), diagonal);
      }
  if (toGhosts == 0.0) // periodic: the constant is free; one node holds it
    entries.emplace_back(0, 0, largest);
  const int n = static_cast<int>(g.nx * g.ny * g.nz);
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  direct_.compute(matrix);
  if (direct_.info() != Eigen::Success)
    throw DivergenceError("the coarsest multigrid level could not be factorised",
      "use --method algebraic-multigrid; and please report this with the picture and the conductivities");
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
  const Eigen::VectorXd left = direct_.solve(right);
  i = 0;
  for (std::int64_t z = 0; z < g.nz; ++z)
    for (std::int64_t y = 0; y < g.ny; ++y)
      for (std::int64_t x = 0; x < g.nx; ++x)
        u[static_cast<std::size_t>(g.row(y, z) + g.node(x))] = static_cast<float>(left[i++]);
  coarsest.exchange(u);
}

// ---- gathering --------------------------------------------------------------------------------------------------

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

std::unique_ptr<Level> Multigrid::gather(const Level& part) const
{
  auto whole = std::make_unique<Level>();
  whole->grid = Grid(part.grid.dimension, part.size[0], part.size[1], part.size[2]);
  whole->periodic = part.periodic;
  whole->straight = part.straight;
  whole->size = part.size;
  whole->comm = std::make_unique<Communicator>(MPI_COMM_SELF);
  Lattice lattice;
  lattice.dimension = part.grid.dimension;
  lattice.size = part.size;
  whole->parts = std::make_unique<Decomposition>(lattice, *whole->comm);
  const Grid& w = whole->grid;
  whole->halo = Halo(w.dimension, { w.nx, w.ny, w.nz }, *whole->parts, *whole->comm, whole->periodic);
  whole->allocateLinks(part.directions());
  if (!part.straight)
    whole->inverse.assign(w.floats(), 0.0F);
  whole->u.assign(w.floats(), 0.0F);
  whole->f.assign(w.floats(), 0.0F);

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
