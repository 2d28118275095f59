// Multicolour Gauss–Seidel sweeps, residuals and products, a row at a time.
#include "lbm/multigrid/Smoothing.h"

#include <algorithm>
#include <utility>

namespace lamella::lbm
{

RowStencil::RowStencil(const Level& level, const float* values, std::int64_t y, std::int64_t z, int part)
  : count(2 * level.directions())
{
  const Grid& g = level.grid;
  const int(*directions)[3] = g.dimension == 3 ? directions3 : directions2;
  const std::int64_t here = g.row(y, z) + g.shift(part, 0);
  for (int d = 0; d < level.directions(); ++d)
  {
    const int* s = directions[d];
    const std::int64_t there = g.row(y + s[1], z + s[2]) + g.shift(part, s[0]);
    const std::int64_t back = g.row(y - s[1], z - s[2]) + g.shift(part, -s[0]);
    const float* array = level.links[static_cast<std::size_t>(d)].data();
    link[2 * d] = array + back;
    link[2 * d + 1] = array + here;
    if (values != nullptr)
    {
      value[2 * d] = values + back;
      value[2 * d + 1] = values + there;
    }
  }
}

namespace
{

void relaxRow(
  const Level& level, const FloatArray& f, FloatArray& u, std::int64_t y, std::int64_t z, int part, bool fromZero)
{
  const Grid& g = level.grid;
  const Kernels& k = kernels();
  const std::int64_t n = g.count(part);
  const std::int64_t here = g.row(y, z) + g.shift(part, 0);
  const RowStencil s(level, u.data(), y, z, part);
  if (level.straight && fromZero)
    k.relaxStraightFromZero(s.count, n, u.data() + here, f.data() + here, s.link);
  else if (level.straight)
    k.relaxStraight(s.count, n, u.data() + here, f.data() + here, s.link, s.value);
  else
    k.relaxGeneral(s.count, n, u.data() + here, f.data() + here, level.inverse.data() + here, s.link, s.value);
  if (level.periodic[0])
    level.wrapRow(u.data() + g.row(y, z));
}

/// Where an odd number of nodes begins again, nodes of one colour are neighbours.
bool coloursMeet(const Level& level)
{
  bool meet = false;
  for (std::size_t a = 0; a < 3; ++a)
    meet = meet || (level.periodic[a] && level.size[a] % 2 != 0);
  return meet;
}

} // namespace

bool touching(const Level& level, int axis)
{
  return level.halo.inside(axis, -1) || level.halo.inside(axis, +1);
}

LayerSweep::LayerSweep(
  const Level& level, const FloatArray& f, FloatArray& u, bool forward, bool fromZero, LayerHook prepare)
  : level_(level)
  , f_(f)
  , u_(u)
  , layers_(level.grid.dimension == 3 ? level.grid.nz : level.grid.ny)
  , forward_(forward)
  , fromZero_(fromZero)
  , touching_(lbm::touching(level, level.grid.dimension == 3 ? 2 : 1))
  , prepare_(std::move(prepare))
{
  if (fromZero_ && coloursMeet(level))
    std::fill(u.begin(), u.end(), 0.0F); // else the second colour would read what it still holds of the last cycle
  if (!touching_)
    return;
  // What the neighbours need of our outer layers is done ahead of all others: both colours of the outermost.
  if (prepare_)
  {
    for (std::int64_t l = 0; l < layers_; ++l)
      if (early(l))
        prepareAround(l);
    exchange();
  }
  for (std::int64_t l = 0; l < layers_; ++l)
    if (early(l))
      relax(l, 0);
  exchange();
  relax(0, 1);
  if (layers_ > 1)
    relax(layers_ - 1, 1);
  exchange();
}

bool LayerSweep::possible(const Level& level, int threads)
{
  return level.straight && threads == 1 && !(level.grid.dimension == 3 && lbm::touching(level, 1));
}

bool LayerSweep::early(std::int64_t layer) const
{
  return touching_ && (layer < 2 || layer >= layers_ - 2);
}

void LayerSweep::exchange()
{
  level_.halo.exchange(u_.data() + Grid::lead, static_cast<std::size_t>(level_.grid.stride) * sizeof(float));
}

void LayerSweep::prepareAround(std::int64_t layer)
{
  for (std::int64_t l = std::max<std::int64_t>(layer - 1, 0); l <= std::min(layer + 1, layers_ - 1); ++l)
    prepare_(l);
}

void LayerSweep::relax(std::int64_t layer, int pass)
{
  const Grid& g = level_.grid;
  const int colour = forward_ ? pass : 1 - pass;
  const bool fromZero = fromZero_ && pass == 0;
  if (g.dimension == 2)
    relaxRow(level_, f_, u_, layer, 0, static_cast<int>((layer + colour) & 1), fromZero);
  else
    for (std::int64_t y = 0; y < g.ny; ++y)
      relaxRow(level_, f_, u_, y, layer, static_cast<int>((y + layer + colour) & 1), fromZero);
}

void LayerSweep::finish(std::int64_t layer)
{
  for (; second_ <= std::min(layer, layers_ - 1); ++second_)
  {
    for (; first_ <= std::min(second_ + 1, layers_ - 1); ++first_)
      if (!early(first_))
      {
        if (prepare_)
          prepareAround(first_);
        relax(first_, 0);
      }
    if (!touching_ || (second_ != 0 && second_ != layers_ - 1))
      relax(second_, 1);
  }
}

void relax(const Level& level, const FloatArray& f, FloatArray& u, bool forward, bool fromZero, int threads)
{
  const Grid& g = level.grid;
  if (LayerSweep::possible(level, threads))
  {
    LayerSweep(level, f, u, forward, fromZero).finish(g.dimension == 3 ? g.nz : g.ny);
    return;
  }
  const auto exchange = [&]
  { level.halo.exchange(u.data() + Grid::lead, static_cast<std::size_t>(g.stride) * sizeof(float)); };
  if (level.straight)
  {
    if (fromZero && coloursMeet(level))
      std::fill(u.begin(), u.end(), 0.0F);
    for (const int pass : { 0, 1 })
    {
      const int colour = forward ? pass : 1 - pass;
#pragma omp parallel for num_threads(threads) if (threads > 1) schedule(static)
      for (std::int64_t i = 0; i < g.ny * g.nz; ++i)
        relaxRow(
          level, f, u, i % g.ny, i / g.ny, static_cast<int>((i % g.ny + i / g.ny + colour) & 1), fromZero && pass == 0);
      exchange();
    }
    return;
  }

  if (fromZero)
    std::fill(u.begin(), u.end(), 0.0F);
  // Rows of equal parity in y and z do not touch; within a row the even nodes come first, or last on the way back.
  const auto relaxBoth = [&](std::int64_t y, std::int64_t z)
  {
    relaxRow(level, f, u, y, z, forward ? 0 : 1, false);
    relaxRow(level, f, u, y, z, forward ? 1 : 0, false);
  };
  if (threads == 1 && g.dimension == 3 && !touching(level, 1))
  {
    // The order of colours, a plane at a time, so that links are still in cache: planes of one parity come first; one
    // of the other follows as soon as both its neighbours are done.
    const bool outside = touching(level, 2);
    const auto isFirst = [&](std::int64_t z) { return ((z & 1) == 0) == forward; };
    const auto early = [&](std::int64_t z) { return outside && isFirst(z) && (z == 0 || z == g.nz - 1); };
    const auto plane = [&](std::int64_t z)
    {
      for (const std::int64_t start : { forward ? 0 : 1, forward ? 1 : 0 })
        for (std::int64_t y = start; y < g.ny; y += 2)
          relaxBoth(y, z);
    };
    for (const std::int64_t z : { std::int64_t{ 0 }, g.nz - 1 })
      if (early(z) && (z == 0 || g.nz > 1))
        plane(z);
    if (outside)
      exchange();
    for (std::int64_t z = 0; z <= g.nz; ++z)
    {
      if (z < g.nz && isFirst(z) && !early(z))
        plane(z);
      if (z > 0 && !isFirst(z - 1) && (z == g.nz || isFirst(z)))
        plane(z - 1);
    }
    if (outside)
      exchange();
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
#pragma omp parallel for num_threads(threads) if (threads > 1) schedule(static)
    for (std::int64_t r = 0; r < rowsY * rowsZ; ++r)
      relaxBoth(startY + 2 * (r % rowsY), startZ + 2 * (r / rowsY));
    exchange();
  }
}

void residualRow(const Level& level, const FloatArray& f, const FloatArray& u, std::int64_t y, std::int64_t z,
  float* out, bool afterForwardSweep)
{
  const Grid& g = level.grid;
  const Kernels& k = kernels();
  const bool twoColours = !coloursMeet(level);
  for (const int part : { 0, 1 })
  {
    const std::int64_t n = g.count(part);
    if (level.straight && twoColours && afterForwardSweep && ((part + y + z) & 1) != 0)
    {
      std::fill_n(out + g.shift(part, 0), n, 0.0F); // this colour was relaxed last
      continue;
    }
    const std::int64_t here = g.row(y, z) + g.shift(part, 0);
    const RowStencil s(level, u.data(), y, z, part);
    (level.straight ? k.residualStraight : k.residualGeneral)(
      s.count, n, out + g.shift(part, 0), f.data() + here, u.data() + here, s.link, s.value);
  }
}

double applyRow(const Level& level, const FloatArray& p, FloatArray& q, std::int64_t y, std::int64_t z)
{
  const Grid& g = level.grid;
  const Kernels& k = kernels();
  double sum = 0;
  for (const int part : { 0, 1 })
  {
    const std::int64_t here = g.row(y, z) + g.shift(part, 0);
    const RowStencil s(level, p.data(), y, z, part);
    sum += (level.straight ? k.applyStraight : k.applyGeneral)(
      s.count, g.count(part), q.data() + here, p.data() + here, s.link, s.value);
  }
  return sum;
}

void computeInverse(Level& level)
{
  const Grid& g = level.grid;
  level.inverse.assign(g.floats(), 0.0F);
  for (std::int64_t z = 0; z < g.nz; ++z)
    for (std::int64_t y = 0; y < g.ny; ++y)
      for (const int part : { 0, 1 })
      {
        const RowStencil s(level, nullptr, y, z, part);
        kernels().inverseSum(s.count, g.count(part), level.inverse.data() + g.row(y, z) + g.shift(part, 0), s.link);
      }
}

} // namespace lamella::lbm
