#include "peridynamics/fracture/StretchTiles.h"

#include <algorithm>

namespace lamella::peridynamics
{
namespace
{

constexpr std::int64_t strip = 16;

} // namespace

StretchTiles::StretchTiles(const BondLattice& bonds, const Communicator& team)
  : bonds_(bonds)
  , reach_(bonds.stencil().layers())
{
  const NodeLayout& l = bonds.layout();
  if (l.dimension == 3)
    size_ = { strip, 4, 4 };
  for (std::size_t a = 0; a < 3; ++a)
    count_[a] = (l.size[a] + size_[a] - 1) / size_[a];
  share_ = LayerShare(count_[l.dimension == 3 ? 2 : 1], team);
  for (const Offset& half : bonds.stencil().half())
  {
    for (std::size_t a = 0; a < 3; ++a)
      directions_[a].push_back(static_cast<float>(half.step[a] / half.length));
    std::vector<float> table(std::max<std::size_t>(4, std::size_t{ 1 } << bonds.planes()), 0.0F);
    for (std::size_t k = 1; k < bonds.kinds().size(); ++k)
      table[k] = static_cast<float>(1 / (bonds.kinds()[k].criticalStretch * half.length * bonds.spacing()));
    inverse_.push_back(std::move(table));
  }
  largest_.assign(static_cast<std::size_t>(count_[0] * count_[1] * count_[2]), 0);
  state_.assign(largest_.size(), -1);
}

std::int64_t StretchTiles::bytes() const noexcept
{
  return static_cast<std::int64_t>(largest_.size() * (sizeof(float) + sizeof(std::int64_t)));
}

Box StretchTiles::boxOf(std::int64_t tile) const noexcept
{
  const std::array<std::int64_t, 3> at{ tile % count_[0], tile / count_[0] % count_[1], tile / count_[0] / count_[1] };
  Box b;
  for (std::size_t a = 0; a < 3; ++a)
  {
    b.low[a] = at[a] * size_[a];
    b.high[a] = std::min(b.low[a] + size_[a], bonds_.layout().size[a]);
  }
  return b;
}

// Displacements against the tile's first node: their differences keep their digits in single precision.
float StretchTiles::measure(const EventHierarchy& state, std::int64_t tile) const
{
  const NodeLayout& l = bonds_.layout();
  const Box box = boxOf(tile);
  const std::int64_t stripAt = (bonds_.layout().before + box.low[0]) / strip;
  bool some = false;
  forRows(box, [&](std::int64_t y, std::int64_t z) { some = some || bonds_.stripsOf(l.row(y, z))[stripAt] != 0; });
  if (!some)
    return 0;
  const int d = l.dimension;
  const std::int64_t side = 8; // at least a bond's reach
  const std::int64_t width = strip + 2 * side;
  Box around = box;
  around.low[0] -= side;
  around.high[0] = box.low[0] + strip + side;
  around.high[1] += reach_;
  if (d == 3)
  {
    around.low[1] -= reach_;
    around.high[2] += reach_;
  }
  const std::int64_t rows = around.high[1] - around.low[1];
  const std::int64_t plane = width * rows * (around.high[2] - around.low[2]);
  thread_local std::vector<float> u;
  thread_local std::vector<float> inverse;
  thread_local std::vector<const float*> inverses;
  thread_local std::vector<std::int64_t> jumps;
  const auto& half = bonds_.stencil().half();
  u.resize(static_cast<std::size_t>(plane * d));
  inverse.resize(half.size() * strip);
  inverses.resize(half.size());
  jumps.resize(half.size());
  for (std::size_t o = 0; o < half.size(); ++o)
  {
    jumps[o] = half[o].step[0] + width * (half[o].step[1] + rows * half[o].step[2]);
    inverses[o] = inverse.data() + o * strip;
  }
  const std::int64_t origin = l.index(box.low[0], box.low[1], box.low[2]);
  for (int c = 0; c < d; ++c)
  {
    float* to = u.data() + c * plane;
    const double zero = state.base().component(c)[origin];
    forRows(around,
      [&](std::int64_t y, std::int64_t z)
      {
        const std::int64_t i = l.index(around.low[0], y, z);
        const double* base = state.base().component(c) + i;
        const float* part = state.correction().component(c) + i;
        for (std::int64_t x = 0; x < width; ++x)
          to[x] = static_cast<float>(base[x] - zero) + part[x];
        to += width;
      });
  }
  float largest = 0;
  TileRows job{};
  job.dimension = d;
  job.count = static_cast<int>(half.size());
  job.jump = jumps.data();
  job.inverse = inverses.data();
  for (int c = 0; c < d; ++c)
    job.direction[c] = directions_[static_cast<std::size_t>(c)].data();
  int uniform = 0; // the kind that the buffers hold
  forRows(box,
    [&](std::int64_t y, std::int64_t z)
    {
      const int kind = bonds_.stripsOf(l.row(y, z))[stripAt];
      if (kind == 0)
        return;
      const std::int64_t i = l.index(box.low[0], y, z);
      if (kind == 255 || kind != uniform)
        for (int o = 0; o < job.count; ++o)
        {
          const float* table = inverse_[static_cast<std::size_t>(o)].data();
          float* out = inverse.data() + o * strip;
          if (kind != 255)
          {
            std::fill_n(out, strip, table[kind]);
            continue;
          }
          const std::uint32_t* words[8]{};
          for (int p = 0; p < bonds_.planes(); ++p)
            words[p] = bonds_.plane(p, o >> 5) + i;
          eventKernels().select(bonds_.planes(), words, o & 31, table, strip, out);
        }
      uniform = kind == 255 ? 0 : kind;
      for (int c = 0; c < d; ++c)
        job.u[c] = u.data() + c * plane + side + width * (y - around.low[1] + rows * (z - around.low[2]));
      largest = std::max(largest, eventKernels().stretch(job));
    });
  return largest;
}

void StretchTiles::refreshAll(EventHierarchy& state, double least)
{
  ++now_;
  const NodeLayout& l = bonds_.layout();
  const std::size_t slowest = l.dimension == 3 ? 2 : 1;
  if (state.looked()) // else all parts are in the base
  {
    Box mine = whole(l);
    mine.low[slowest] = share_.first() * size_[slowest];
    mine.high[slowest] = std::min(l.size[slowest], share_.last() * size_[slowest]);
    if (mine.low[slowest] < mine.high[slowest])
      state.evaluate(grown(mine, reach_, l));
  }
  const double from = least * static_cast<double>(*std::max_element(largest_.begin(), largest_.end()));
  const auto count = static_cast<std::int64_t>(largest_.size());
  for (std::int64_t t = 0; t < count; ++t)
    if (static_cast<double>(largest_[static_cast<std::size_t>(t)]) >= from)
      state_[static_cast<std::size_t>(t)] = now_;
  const std::int64_t layer = count / count_[slowest]; // tiles
#pragma omp parallel for schedule(static) if (l.owned() >= worthThreads)
  for (std::int64_t t = share_.first() * layer; t < share_.last() * layer; ++t)
    if (static_cast<double>(largest_[static_cast<std::size_t>(t)]) >= from)
      largest_[static_cast<std::size_t>(t)] = measure(state, t);
  share_.gather(largest_);
}

void StretchTiles::refresh(EventHierarchy& state, const Box& window)
{
  ++now_;
  Box tiles;
  for (std::size_t a = 0; a < 3; ++a)
  {
    // bonds into the window begin up to a reach before it
    tiles.low[a] = std::max<std::int64_t>(0, window.low[a] - reach_) / size_[a];
    tiles.high[a] = std::min(count_[a], (window.high[a] + reach_ + size_[a] - 1) / size_[a]);
  }
  Box nodes;
  for (std::size_t a = 0; a < 3; ++a)
  {
    nodes.low[a] = tiles.low[a] * size_[a];
    nodes.high[a] = tiles.high[a] * size_[a];
  }
  state.evaluate(grown(nodes, reach_, bonds_.layout()));
  for (std::int64_t z = tiles.low[2]; z < tiles.high[2]; ++z)
    for (std::int64_t y = tiles.low[1]; y < tiles.high[1]; ++y)
      for (std::int64_t x = tiles.low[0]; x < tiles.high[0]; ++x)
      {
        const std::int64_t t = x + count_[0] * (y + count_[1] * z);
        largest_[static_cast<std::size_t>(t)] = measure(state, t);
        state_[static_cast<std::size_t>(t)] = now_;
      }
}

void StretchTiles::refresh(EventHierarchy& state, const Box& window, double least)
{
  refresh(state, window);
  const double from = least * static_cast<double>(*std::max_element(largest_.begin(), largest_.end()));
  for (std::size_t t = 0; t < largest_.size(); ++t)
    if (state_[t] != now_ && static_cast<double>(largest_[t]) >= from)
    {
      const auto tile = static_cast<std::int64_t>(t);
      state.evaluate(grown(boxOf(tile), reach_, bonds_.layout()));
      largest_[t] = measure(state, tile);
      state_[t] = now_;
    }
}

StretchMaximum StretchTiles::greatest(EventHierarchy& state)
{
  for (;;)
  {
    const auto top = static_cast<std::size_t>(std::max_element(largest_.begin(), largest_.end()) - largest_.begin());
    if (!(largest_[top] > 0))
      return {};
    const auto tile = static_cast<std::int64_t>(top);
    state.evaluate(grown(boxOf(tile), reach_, bonds_.layout()));
    if (state_[top] == now_)
    {
      const StretchMaximum most = search(state, tile);
      const float largest = largest_[top];
      largest_[top] = 0;
      second_ = std::max(second_, static_cast<double>(*std::max_element(largest_.begin(), largest_.end())));
      largest_[top] = largest;
      return most;
    }
    largest_[top] = measure(state, tile);
    state_[top] = now_;
  }
}

// In double precision.
StretchMaximum StretchTiles::search(EventHierarchy& state, std::int64_t tile)
{
  const NodeLayout& l = bonds_.layout();
  const auto& half = bonds_.stencil().half();
  const Box box = boxOf(tile);
  StretchMaximum most;
  second_ = 0;
  forRows(box,
    [&](std::int64_t y, std::int64_t z)
    {
      for (std::int64_t i = l.index(box.low[0], y, z); i < l.index(box.high[0], y, z); ++i)
        for (int o = 0; o < static_cast<int>(half.size()); ++o)
        {
          const int kind = bonds_.kind(i, o);
          if (kind == 0)
            continue;
          const Offset& h = half[static_cast<std::size_t>(o)];
          const std::int64_t j = i + bonds_.jump(o);
          double along = 0;
          for (int c = 0; c < l.dimension; ++c)
            along += h.step[static_cast<std::size_t>(c)] *
              (state.base().component(c)[j] - state.base().component(c)[i] +
                static_cast<double>(state.correction().component(c)[j] - state.correction().component(c)[i]));
          const double ratio = along /
            (h.length * h.length * bonds_.spacing() * bonds_.kinds()[static_cast<std::size_t>(kind)].criticalStretch);
          second_ = std::max(second_, std::min(ratio, most.ratio));
          if (ratio > most.ratio)
            most = { ratio, bonds_.bond(i, o) };
        }
    });
  return most;
}

} // namespace lamella::peridynamics
