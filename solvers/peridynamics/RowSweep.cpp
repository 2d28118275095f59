#include "peridynamics/RowSweep.h"

namespace lamella::peridynamics
{

std::vector<Chunk> chunks(const Stencil& stencil, int largest)
{
  std::vector<Chunk> list;
  const auto& half = stencil.half();
  const int n = static_cast<int>(half.size());
  for (int first = 0; first < n;)
  {
    const auto& step = half[static_cast<std::size_t>(first)].step;
    // those that follow it in its row, up to the end of the word; x steps one by one
    int end = first + 1;
    while (end < n && end % 32 != 0 && half[static_cast<std::size_t>(end)].step[1] == step[1] &&
      half[static_cast<std::size_t>(end)].step[2] == step[2])
      ++end;
    int count = 1;
    for (const int size : { 5, 3, 2 })
      if (size <= largest && end - first >= size)
      {
        count = size;
        break;
      }
    list.push_back({ first, count, step });
    first += count;
  }
  return list;
}

bool RowRuns::find(const BondLattice& bonds, std::int64_t row, int unit)
{
  push.clear();
  pull.clear();
  gaps.clear();
  const std::uint8_t* strip = bonds.stripsOf(row);
  const NodeLayout& l = bonds.layout();
  const std::int64_t n = l.pitch / 16;
  const std::int64_t before = l.before / 16; // strips before x = 0
  // To skip the bits saves less than to start a run costs, where the run is short.
  constexpr std::int64_t worthwhile = 4;
  for (std::int64_t s = 0; s < n;)
  {
    std::int64_t end = s + 1;
    while (end < n && strip[end] == strip[s])
      ++end;
    if (strip[s] != 0)
    {
      const int kind = end - s < worthwhile ? 255 : strip[s];
      const std::int64_t begin = (s - before) * 16;
      if (!push.empty() && push.back().kind == kind && push.back().end == begin)
        push.back().end = (end - before) * 16;
      else
        push.push_back({ begin, (end - before) * 16, kind });
    }
    s = end;
  }
  if (push.empty())
    return false;
  const auto up = [&](std::int64_t x) { return (x + unit - 1) / unit * unit; };
  const std::int64_t rim = bonds.periodic()[0] ? l.ghost : 0;
  push.back().end = std::min(push.back().end, up(l.size[0] + rim));
  push.front().begin = std::max(push.front().begin, -up(rim));
  // second ends lie at most 8 nodes, so one strip, further
  const std::int64_t last = up(l.size[0]);
  for (const Run& r : push)
  {
    const std::int64_t begin = std::max<std::int64_t>(0, r.begin - 16);
    const std::int64_t end = std::min(last, r.end + 16);
    if (!pull.empty() && begin <= pull.back().end)
      pull.back().end = std::max(pull.back().end, end);
    else
      pull.push_back({ begin, end, 0 });
  }
  // pull() reads a strip to either side of what it writes
  for (const Run& r : pull)
  {
    std::int64_t at = r.begin - 16;
    for (const Run& p : push)
      if (p.end > at && p.begin < r.end + 16)
      {
        if (p.begin > at)
          gaps.push_back({ at, p.begin, 0 });
        at = p.end;
      }
    if (at < r.end + 16)
      gaps.push_back({ at, r.end + 16, 0 });
  }
  return true;
}

std::vector<Band> bands(const BondLattice& bonds, int count)
{
  const NodeLayout& l = bonds.layout();
  return bands(bonds, count, { 0, l.size[1] * l.size[2] });
}

std::vector<Band> bands(const BondLattice& bonds, int count, const Band& within)
{
  const NodeLayout& l = bonds.layout();
  const std::int64_t rows = within.end - within.begin;
  if (count == 1)
    return { within };
  std::vector<std::int64_t> upTo(static_cast<std::size_t>(rows) + 1, 0);
  for (std::int64_t r = 0; r < rows; ++r)
  {
    const std::int64_t ordinal = within.begin + r;
    const std::uint8_t* strip = bonds.stripsOf(l.row(ordinal % l.size[1], ordinal / l.size[1]));
    std::int64_t full = 1; // a row costs something even when it is empty
    for (std::int64_t s = 0; s < l.pitch / 16; ++s)
      full += strip[s] != 0 ? 4 : 0;
    upTo[static_cast<std::size_t>(r) + 1] = upTo[static_cast<std::size_t>(r)] + full;
  }
  std::vector<Band> list(static_cast<std::size_t>(count));
  std::int64_t begin = 0;
  for (int b = 0; b < count; ++b)
  {
    const std::int64_t share = upTo.back() * (b + 1) / count;
    const std::int64_t end = b + 1 == count
      ? rows
      : std::max(begin, static_cast<std::int64_t>(std::lower_bound(upTo.begin(), upTo.end(), share) - upTo.begin()));
    list[static_cast<std::size_t>(b)] = { within.begin + begin, within.begin + std::min(end, rows) };
    begin = std::min(end, rows);
  }
  return list;
}

} // namespace lamella::peridynamics
