// Marching squares: walks along outlines from cell to cell.
#include "outlines/ContourTracing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace lamella::micrograph
{
namespace
{

// Sides of a cell, counter-clockwise; the cell beyond side s is entered through side (s + 2) % 4.
enum Side : std::int8_t
{
  Bottom,
  Right,
  Top,
  Left,
  None = -1
};

/// Where a chain with the lumen on its left leaves a cell, by its corners (bit 0 lower left, then counter-clockwise)
/// and the side on which it enters.
constexpr std::array<std::array<Side, 4>, 16> exits{ {
  { None, None, None, None },   // no lumen
  { Left, None, None, None },   // lower left
  { None, Bottom, None, None }, // lower right
  { None, Left, None, None },   // both lower
  { None, None, Right, None },  // upper right
  { Left, None, Right, None },  // crosswise: lumens part
  { None, None, Bottom, None }, // both right
  { None, None, Left, None },   // all but the upper left
  { None, None, None, Top },    // upper left
  { Top, None, None, None },    // both left
  { None, Bottom, None, Top },  // crosswise: lumens part
  { None, Top, None, None },    // all but the upper right
  { None, None, None, Right },  // both upper
  { Right, None, None, None },  // all but the lower right
  { None, None, None, Bottom }, // all but the lower left
  { None, None, None, None },   // all lumen
} };

/// Corners that a half-way chain cuts off (+) or fills (−) in a cell of that kind.
constexpr std::array<std::int8_t, 16> cuts{ 0, 1, 1, 0, 1, 1, 0, -1, 1, 0, 1, -1, 0, -1, -1, 0 };

class Tracer
{
public:
  Tracer(const Lattice& lattice, std::span<const std::uint8_t> lumen, std::span<const float> level, double margin)
    : nx_(lattice.size[0])
    , ny_(lattice.size[1])
    , width_(nx_ + 2)
    , level_(level)
    , margin_(margin)
    , inside_(static_cast<std::size_t>(width_ * (ny_ + 2)))
    , owner_(static_cast<std::size_t>((nx_ + 1) * (ny_ + 2)), 0)
  {
    for (std::int64_t j = 0; j < ny_ + 2; ++j)
    {
      const std::uint8_t* from = lumen.data() + nx_ * std::clamp<std::int64_t>(j - 1, 0, ny_ - 1);
      std::uint8_t* to = inside_.data() + width_ * j;
      std::transform(from, from + nx_, to + 1, [](std::uint8_t v) { return static_cast<std::uint8_t>(v != 0); });
      to[0] = to[1];
      to[nx_ + 1] = to[nx_];
    }
  }

  Traces run()
  {
    openChains();
    closedChains();
    return std::move(traces_);
  }

private:
  /// A loop or chain that was met, by number from 1.
  struct Met
  {
    bool island = false;
    bool nested = false; ///< lies in an island
  };

  [[nodiscard]] bool inside(std::int64_t i, std::int64_t j) const noexcept
  {
    return inside_[static_cast<std::size_t>(i + width_ * j)] != 0;
  }
  [[nodiscard]] unsigned corners(std::int64_t i, std::int64_t j) const noexcept
  {
    const std::uint8_t* at = inside_.data() + i + width_ * j;
    return unsigned{ at[0] } | unsigned{ at[1] } << 1U | unsigned{ at[width_ + 1] } << 2U |
      unsigned{ at[width_] } << 3U;
  }
  [[nodiscard]] double placeX(std::int64_t i) const noexcept
  {
    return std::clamp(static_cast<double>(i) - 0.5, 0.0, static_cast<double>(nx_));
  }
  [[nodiscard]] double placeY(std::int64_t j) const noexcept
  {
    return std::clamp(static_cast<double>(j) - 0.5, 0.0, static_cast<double>(ny_));
  }

  /// The level at a padded node; on the border half a pixel farther out by extrapolation.
  [[nodiscard]] double levelAt(std::int64_t i, std::int64_t j) const noexcept
  {
    const auto value = [&](std::int64_t x, std::int64_t y)
    { return static_cast<double>(level_[static_cast<std::size_t>(x + nx_ * y)]); };
    const std::int64_t x = std::clamp<std::int64_t>(i - 1, 0, nx_ - 1);
    const std::int64_t y = std::clamp<std::int64_t>(j - 1, 0, ny_ - 1);
    double v = value(x, y);
    if (i == 0 || i == nx_ + 1)
      v += 0.5 * (v - value(i == 0 ? std::min<std::int64_t>(1, nx_ - 1) : std::max<std::int64_t>(nx_ - 2, 0), y));
    else if (j == 0 || j == ny_ + 1)
      v += 0.5 * (v - value(x, j == 0 ? std::min<std::int64_t>(1, ny_ - 1) : std::max<std::int64_t>(ny_ - 2, 0)));
    return v;
  }

  /// The crossing on a side of a cell.
  [[nodiscard]] Crossing crossing(std::int64_t i, std::int64_t j, int side) const noexcept
  {
    const bool alongX = side == Bottom || side == Top;
    const std::int64_t x = side == Right ? i + 1 : i;
    const std::int64_t y = side == Top ? j + 1 : j;
    const bool first = inside(x, y);
    Crossing c;
    c.x = placeX(x) + (alongX ? 0.5 : 0.0);
    c.y = placeY(y) + (alongX ? 0.0 : 0.5);
    const std::int8_t way = first ? 1 : -1;
    c.ex = alongX ? way : std::int8_t{ 0 };
    c.ey = alongX ? std::int8_t{ 0 } : way;
    if (!level_.empty())
    {
      double in = levelAt(x, y);
      double out = alongX ? levelAt(x + 1, y) : levelAt(x, y + 1);
      if (!first)
        std::swap(in, out);
      in = std::max(in, 0.0);
      out = std::min(out, 0.0);
      const double share = in - out > 0 ? in / (in - out) : 0.5;
      c.t = std::clamp(share - 0.5, margin_ - 0.5, 0.5 - margin_);
    }
    return c;
  }

  /// Follows a chain that enters cell (i, j) through a side, to the border or back to its begin.
  Trace follow(std::int64_t i, std::int64_t j, int entry, std::int32_t number, bool closed)
  {
    Trace trace;
    trace.closed = closed;
    trace.width = static_cast<double>(nx_);
    trace.height = static_cast<double>(ny_);
    const std::int64_t firstI = i;
    const std::int64_t firstJ = j;
    const int firstEntry = entry;
    std::int64_t balance = 0;
    for (;;)
    {
      trace.crossings.push_back(crossing(i, j, entry));
      if (entry == Bottom || entry == Top)
        owner_[edge(i, entry == Bottom ? j : j + 1)] = number;
      const unsigned kind = corners(i, j);
      balance += cuts[kind];
      const Side out = exits[kind][static_cast<std::size_t>(entry)];
      const std::int64_t nextI = out == Left ? i - 1 : out == Right ? i + 1 : i;
      const std::int64_t nextJ = out == Bottom ? j - 1 : out == Top ? j + 1 : j;
      if (nextI < 0 || nextI > nx_ || nextJ < 0 || nextJ > ny_)
      {
        trace.crossings.push_back(crossing(i, j, out));
        if (out == Bottom || out == Top)
          owner_[edge(i, out == Bottom ? j : j + 1)] = number;
        break;
      }
      i = nextI;
      j = nextJ;
      entry = (out + 2) % 4;
      if (closed && i == firstI && j == firstJ && entry == firstEntry)
        break;
    }
    trace.corners = static_cast<double>(balance) / 8;
    return trace;
  }

  [[nodiscard]] std::size_t edge(std::int64_t i, std::int64_t j) const noexcept
  {
    return static_cast<std::size_t>(i + (nx_ + 1) * j);
  }

  void open(std::int64_t i, std::int64_t j, int entry)
  {
    met_.push_back({});
    traces_.chains.push_back(follow(i, j, entry, static_cast<std::int32_t>(met_.size()), false));
  }

  /// Chains begin where, counter-clockwise along the border, wall follows lumen.
  void openChains()
  {
    for (std::int64_t i = 0; i <= nx_; ++i)
      if (inside(i, 0) && !inside(i + 1, 0))
        open(i, 0, Bottom);
    for (std::int64_t j = 0; j <= ny_; ++j)
      if (inside(nx_ + 1, j) && !inside(nx_ + 1, j + 1))
        open(nx_, j, Right);
    for (std::int64_t i = nx_; i >= 0; --i)
      if (inside(i + 1, ny_ + 1) && !inside(i, ny_ + 1))
        open(i, ny_, Top);
    for (std::int64_t j = ny_; j >= 0; --j)
      if (inside(0, j + 1) && !inside(0, j))
        open(0, j, Left);
    traces_.borderIsLumen = traces_.chains.empty() && inside(0, 0);
  }

  /// Loops are met first in their lowest row, at their leftmost crossing there. The crossing before it in that row
  /// tells what they lie in (Suzuki and Abe, Computer Vision, Graphics, and Image Processing 30, 1985, 32–46).
  void closedChains()
  {
    for (std::int64_t j = 1; j <= ny_; ++j)
    {
      std::int32_t before = 0;
      const std::uint8_t* row = inside_.data() + width_ * j;
      for (std::int64_t i = 0; i <= nx_; ++i)
      {
        if (row[i] == row[i + 1])
          continue;
        if (owner_[edge(i, j)] == 0)
          loop(i, j, row[i] != 0, before);
        before = owner_[edge(i, j)];
      }
    }
  }

  void loop(std::int64_t i, std::int64_t j, bool island, std::int32_t before)
  {
    // A lumen begins in wall: that of an island if the outline crossed last is an island's. An island begins in a
    // lumen: the one whose outline was crossed last, or the one around the island that was left.
    Met me;
    me.island = island;
    if (before != 0)
    {
      const Met& last = met_[static_cast<std::size_t>(before - 1)];
      me.nested = last.nested || (!island && last.island);
    }
    met_.push_back(me);
    const auto number = static_cast<std::int32_t>(met_.size());
    Trace trace = island ? follow(i, j, Bottom, number, true) : follow(i, j - 1, Top, number, true);
    if (island)
    {
      if (!me.nested)
      {
        ++traces_.islands;
        traces_.islandArea += area(trace);
      }
    }
    else if (me.nested)
    {
      ++traces_.nestedLumens;
    }
    else
    {
      traces_.chains.push_back(std::move(trace));
    }
  }

  /// Of the pixels that an island's outline encloses.
  [[nodiscard]] static double area(const Trace& trace)
  {
    double twice = 0;
    const Crossing* last = &trace.crossings.back();
    for (const Crossing& c : trace.crossings)
    {
      twice += last->x * c.y - c.x * last->y;
      last = &c;
    }
    return std::abs(twice / 2 + trace.corners);
  }

  std::int64_t nx_, ny_, width_;
  std::span<const float> level_;
  double margin_;
  std::vector<std::uint8_t> inside_; ///< with a rim of one node
  std::vector<std::int32_t> owner_;  ///< which chain crosses between nodes i and i + 1 of a row
  std::vector<Met> met_;
  Traces traces_;
};

} // namespace

Traces traceOutlines(
  const Lattice& lattice, std::span<const std::uint8_t> lumen, std::span<const float> level, double margin)
{
  return Tracer(lattice, lumen, level, margin).run();
}

} // namespace lamella::micrograph
