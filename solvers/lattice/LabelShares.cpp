#include "lattice/LabelShares.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <span>
#include <utility>
#include <vector>

namespace lamella
{
namespace
{

using Level = std::int16_t;
constexpr float levelUnit = 1.0F / 16000; // levels lie within about ±1.3
constexpr int little = 1600;              // levels, for what second differences add
constexpr float leastLevel = 2e-3F;       // by which a level keeps to the side of its label
constexpr float leastSlope = 0.05F;
constexpr float leastArea = 1e-3F;
constexpr int moves = 2;
constexpr float gentle = 0.6F; // differences of a slope over it, below which one plane a node will do
constexpr int most = shareLevels - 1;
constexpr int half = most / 2;
constexpr std::int64_t blockRows = 32;
constexpr std::int64_t slabPlanes = 64;

Level toLevel(float value) noexcept
{
  return static_cast<Level>(std::lrintf(std::clamp(value / levelUnit, -32000.0F, 32000.0F)));
}

/// A binomial blur: `passes` times (1, 2, 1)/4, whose variance is passes/2. From the middle outward.
template <std::size_t passes>
constexpr std::array<float, passes + 1> binomial()
{
  std::array<double, 2 * passes + 1> all{};
  all[0] = 1;
  for (std::size_t n = 1; n <= 2 * passes; ++n)
  {
    for (std::size_t k = n; k > 0; --k)
      all[k] = 0.5 * (all[k] + all[k - 1]);
    all[0] *= 0.5;
  }
  std::array<float, passes + 1> tap{};
  for (std::size_t k = 0; k <= passes; ++k)
    tap[k] = static_cast<float>(all[passes + k]);
  return tap;
}

/// The node that stands for one beyond the end.
std::int64_t inside(std::int64_t i, std::int64_t n, bool wraps) noexcept
{
  if (i >= 0 && i < n)
    return i;
  const std::int64_t period = wraps ? n : 2 * n;
  i = ((i % period) + period) % period;
  return i < n ? i : 2 * n - 1 - i;
}

/// What is common to all steps: the box, and how it goes on.
struct Grid
{
  std::array<std::int64_t, 3> size;
  std::array<bool, 3> wraps;
  int threads;

  [[nodiscard]] std::int64_t row(std::int64_t y, std::int64_t z) const noexcept
  {
    return size[0] * (inside(y, size[1], wraps[1]) + size[1] * inside(z, size[2], wraps[2]));
  }
  /// The first and the last node's neighbours beyond the ends of a row.
  [[nodiscard]] std::int64_t before() const noexcept { return inside(-1, size[0], wraps[0]); }
  [[nodiscard]] std::int64_t behind() const noexcept { return inside(size[0], size[0], wraps[0]); }
};

/// out = Σ taps of rows, which lie at both sides of the middle one.
template <int radius, class Row>
void blend(const std::array<float, radius + 1>& tap, std::int64_t n, Row&& row, float* __restrict out)
{
  const float* const middle = row(0);
  for (std::int64_t x = 0; x < n; ++x)
    out[x] = tap[0] * middle[x];
  for (int k = 1; k <= radius; ++k)
  {
    const float t = tap[static_cast<std::size_t>(k)];
    const float* const low = row(-k);
    const float* const high = row(k);
#pragma omp simd
    for (std::int64_t x = 0; x < n; ++x)
      out[x] += t * (low[x] + high[x]);
  }
}

/// How a field goes on beyond a face where the sample does not repeat.
enum class Beyond
{
  Straight, ///< 2 f₀ − f₁: the surface of a level goes straight on
  Mirrored
};

/// Blurs `fields` fields at a time: fill(y, z, f, row) gives their rows, sink(y, z, rows) takes what comes out.
template <int radius, int fields, Beyond beyond, class Fill, class Sink>
void blurred(const Grid& grid, Fill&& fill, Sink&& sink)
{
  constexpr std::array<float, radius + 1> tap = binomial<radius>();
  const std::int64_t nx = grid.size[0];
  const std::int64_t ny = grid.size[1];
  const std::int64_t nz = grid.size[2];
  const bool deep = nz > 1;
  const std::int64_t blocks = (ny + blockRows - 1) / blockRows;
  const std::int64_t slabs = (nz + slabPlanes - 1) / slabPlanes;
  const std::int64_t ring = deep ? 2 * radius + 1 : 1;
#pragma omp parallel num_threads(grid.threads) if (grid.threads > 1)
  {
    const std::int64_t plane = blockRows * nx;
    std::vector<float> padded(static_cast<std::size_t>(nx + 2 * radius));
    std::vector<float> along(static_cast<std::size_t>((blockRows + 2 * radius) * nx));
    std::vector<float> planes(static_cast<std::size_t>(fields * ring * plane));
    std::vector<float> out(static_cast<std::size_t>(fields * nx));
    std::array<std::vector<float>, 2> opposite{ std::vector<float>(static_cast<std::size_t>(nx)),
      std::vector<float>(static_cast<std::size_t>(nx)) };
    const auto straight = [&](auto&& self, std::int64_t y, std::int64_t z, int f, float* row) -> void
    {
      for (const std::size_t a : { 1U, 2U })
      {
        const std::int64_t at = a == 1 ? y : z;
        const std::int64_t last = grid.size[a] - 1;
        if (beyond == Beyond::Mirrored || grid.wraps[a] || (at >= 0 && at <= last))
          continue;
        const std::int64_t face = at < 0 ? 0 : last;
        const std::int64_t other = std::clamp<std::int64_t>(2 * face - at, 0, last);
        float* const second = opposite[a - 1].data();
        self(self, a == 1 ? face : y, a == 1 ? z : face, f, row);
        self(self, a == 1 ? other : y, a == 1 ? z : other, f, second);
        for (std::int64_t x = 0; x < nx; ++x)
          row[x] = 2 * row[x] - second[x];
        return;
      }
      fill(y, z, f, row);
    };
#pragma omp for schedule(dynamic) collapse(2)
    for (std::int64_t slab = 0; slab < slabs; ++slab)
      for (std::int64_t block = 0; block < blocks; ++block)
      {
        const std::int64_t firstRow = block * blockRows;
        const std::int64_t rows = std::min(blockRows, ny - firstRow);
        const std::int64_t first = slab * slabPlanes;
        const std::int64_t last = std::min(first + slabPlanes, nz);
        const auto planeOf = [&](std::int64_t z, int f)
        { return planes.data() + (((z % ring + ring) % ring) * fields + f) * plane; };
        const std::int64_t reach = deep ? radius : 0;
        for (std::int64_t z = first - reach; z < last + reach; ++z)
        {
          for (int f = 0; f < fields; ++f)
          {
            for (std::int64_t r = -radius; r < rows + radius; ++r)
            {
              float* const own = padded.data() + radius;
              straight(straight, firstRow + r, z, f, own);
              for (std::int64_t i = 1; i <= radius; ++i)
              {
                const bool on = beyond == Beyond::Straight && !grid.wraps[0];
                const std::int64_t far = std::min(i, nx - 1);
                own[-i] = on ? 2 * own[0] - own[far] : own[inside(-i, nx, grid.wraps[0])];
                own[nx - 1 + i] = on ? 2 * own[nx - 1] - own[nx - 1 - far] : own[inside(nx - 1 + i, nx, grid.wraps[0])];
              }
              blend<radius>(
                tap, nx, [&](int k) { return own + k; }, along.data() + (r + radius) * nx);
            }
            for (std::int64_t r = 0; r < rows; ++r)
              blend<radius>(
                tap, nx, [&](int k) { return along.data() + (r + radius + k) * nx; }, planeOf(z, f) + r * nx);
          }
          const std::int64_t done = z - reach;
          if (done < first)
            continue;
          for (std::int64_t r = 0; r < rows; ++r)
          {
            for (int f = 0; f < fields; ++f)
            {
              float* const to = out.data() + f * nx;
              if (deep)
                blend<radius>(
                  tap, nx, [&](int k) { return planeOf(done + k, f) + r * nx; }, to);
              else
                std::copy_n(planeOf(done, f) + r * nx, nx, to);
            }
            sink(firstRow + r, done, out.data());
          }
        }
      }
  }
}

/// f and its first and second differences at a node.
struct Quadric
{
  float value = 0;
  std::array<float, 3> slope{};
  std::array<float, 3> bend{};
  std::array<float, 3> twist{}; ///< xy, xz, yz
};

double shareOf(const Quadric& q, bool deep) noexcept
{
  const auto size = [](const std::array<float, 3>& v) { return std::abs(v[0]) + std::abs(v[1]) + std::abs(v[2]); };
  if (size(q.bend) + 2 * size(q.twist) < gentle * size(q.slope))
    return cubeShare(
      q.value + (q.bend[0] + q.bend[1] + q.bend[2]) * (1.0F / 24), { q.slope[0], q.slope[1], q.slope[2] });
  const auto octant = [&](float x, float y, float z)
  {
    const float bend = q.bend[0] + q.bend[1] + (deep ? q.bend[2] : 0);
    const float value = q.value + (x * q.slope[0] + y * q.slope[1] + z * q.slope[2]) +
      (x * y * q.twist[0] + x * z * q.twist[1] + y * z * q.twist[2]) + bend * (1.0F / 96) +
      (q.bend[0] * (x * x) + q.bend[1] * (y * y) + q.bend[2] * (z * z)) / 2;
    return cubeShare(value,
      { 0.5 * (q.slope[0] + x * q.bend[0] + (y * q.twist[0] + z * q.twist[1])),
        0.5 * (q.slope[1] + y * q.bend[1] + (x * q.twist[0] + z * q.twist[2])),
        0.5 * (q.slope[2] + z * q.bend[2] + (x * q.twist[1] + y * q.twist[2])) });
  };
  constexpr float s = 0.25F;
  // in pairs, so that a mirrored sum is the same
  const auto quarters = [&](float z)
  { return (octant(-s, -s, z) + octant(s, -s, z)) + (octant(-s, s, z) + octant(s, s, z)); };
  return deep ? (quarters(-s) + quarters(s)) / 8 : quarters(0) / 4;
}

class Smoothing
{
public:
  Smoothing(const Grid& grid, std::span<const std::uint8_t> label, std::uint8_t second)
    : grid_(grid)
    , label_(label)
    , second_(second)
    , level_(label.size())
    , other_(label.size())
    , share_(label.size())
  {
  }

  std::vector<std::uint8_t> run()
  {
    const std::int64_t nx = grid_.size[0];
    blurred<4, 1, Beyond::Straight>(
      grid_,
      [&](std::int64_t y, std::int64_t z, int, float* row)
      {
        const std::int64_t from = grid_.row(y, z);
        for (std::int64_t x = 0; x < nx; ++x)
          row[x] = isSecond(from + x) ? 1.0F : -1.0F;
      },
      [&](std::int64_t y, std::int64_t z, const float* row)
      {
        Level* const to = other_.data() + grid_.row(y, z);
        for (std::int64_t x = 0; x < nx; ++x)
          to[x] = toLevel(row[x]);
      });
    blurred<4, 1, Beyond::Straight>(
      grid_,
      [&](std::int64_t y, std::int64_t z, int, float* row)
      {
        const Level* const once = other_.data() + grid_.row(y, z);
        for (std::int64_t x = 0; x < nx; ++x)
          row[x] = levelUnit * static_cast<float>(once[x]);
      },
      [&](std::int64_t y, std::int64_t z, const float* twice)
      {
        const std::int64_t from = grid_.row(y, z);
        for (std::int64_t x = 0; x < nx; ++x)
          level_[from + x] = held(from + x, 2 * levelUnit * static_cast<float>(other_[from + x]) - twice[x]);
      });
    cut();
    for (int i = 0; i < moves; ++i)
    {
      move();
      cut();
    }
    return std::move(share_);
  }

private:
  [[nodiscard]] bool isSecond(std::int64_t i) const noexcept { return label_[i] == second_; }

  /// On the side of its label.
  Level held(std::int64_t i, float value) const noexcept
  {
    return toLevel(isSecond(i) ? std::max(value, leastLevel) : std::min(value, -leastLevel));
  }

  template <class Work>
  void eachRow(Work&& work) const
  {
#pragma omp parallel for num_threads(grid_.threads) if (grid_.threads > 1) schedule(dynamic, 16)
    for (std::int64_t r = 0; r < grid_.size[1] * grid_.size[2]; ++r)
      work(r % grid_.size[1], r / grid_.size[1]);
  }

  /// The levels of a row and of its neighbours, by y, then z; straight on beyond faces, kept in `beyond`.
  std::array<const Level*, 9> around(std::int64_t y, std::int64_t z, std::array<std::vector<Level>, 9>& beyond) const
  {
    std::array<const Level*, 9> rows{};
    const auto leaves = [&](std::size_t a, std::int64_t at)
    { return !grid_.wraps[a] && grid_.size[a] > 1 && (at < 0 || at >= grid_.size[a]); };
    const auto row = [&](std::int64_t j, std::int64_t k) { return level_.data() + grid_.row(y + j, z + k); };
    for (std::int64_t k = -1; k <= 1; ++k)
      for (std::int64_t j = -1; j <= 1; ++j)
      {
        const auto i = static_cast<std::size_t>(j + 1 + 3 * (k + 1));
        const bool overY = leaves(1, y + j);
        const bool overZ = leaves(2, z + k);
        rows[i] = row(j, k);
        if (!overY && !overZ)
          continue;
        const Level* const near = row(overY ? 0 : j, overZ ? 0 : k);
        const Level* const acrossY = row(overY ? -j : j, overZ ? 0 : k);
        const Level* const acrossZ = row(overY ? 0 : j, overZ ? -k : k);
        const Level* const across = row(overY ? -j : j, overZ ? -k : k);
        beyond[i].resize(static_cast<std::size_t>(grid_.size[0]));
        for (std::int64_t x = 0; x < grid_.size[0]; ++x)
        {
          const int level = overY && overZ ? 4 * near[x] - 2 * (acrossY[x] + acrossZ[x]) + across[x]
            : overY                        ? 2 * near[x] - acrossY[x]
                                           : 2 * near[x] - acrossZ[x];
          beyond[i][static_cast<std::size_t>(x)] = static_cast<Level>(std::clamp(level, -32000, 32000));
        }
        rows[i] = beyond[i].data();
      }
    return rows;
  }

  /// Shares from the levels.
  void cut()
  {
    const std::int64_t nx = grid_.size[0];
    const bool deep = grid_.size[2] > 1;
    eachRow(
      [&](std::int64_t y, std::int64_t z)
      {
        std::array<std::vector<Level>, 9> beyond;
        const std::array<const Level*, 9> rows = around(y, z, beyond);
        const Level* const f = rows[4];
        const std::int64_t from = grid_.row(y, z);
        for (std::int64_t x = 0; x < nx; ++x)
        {
          const bool second = isSecond(from + x);
          const std::int64_t low = x - 1;
          const std::int64_t high = x + 1;
          const auto at = [&](const Level* row, std::int64_t i)
          {
            if (i >= 0 && i < nx)
              return static_cast<int>(row[i]);
            if (grid_.wraps[0] || nx == 1)
              return static_cast<int>(row[i < 0 ? nx - 1 : 0]);
            return i < 0 ? 2 * row[0] - row[1] : 2 * row[nx - 1] - row[nx - 2];
          };
          const int own = at(f, x);
          const int reach = std::abs(at(f, high) - own) + std::abs(own - at(f, low)) + std::abs(at(rows[5], x) - own) +
            std::abs(own - at(rows[3], x)) + std::abs(at(rows[7], x) - own) + std::abs(own - at(rows[1], x));
          if (2 * std::abs(own) > reach + little) // no surface within half a node along every axis
          {
            share_[from + x] = second ? most : 0;
            continue;
          }
          // Of the node's own phase, so that swapping the labels swaps the shares.
          const float unit = second ? levelUnit : -levelUnit;
          const auto value = [&](const Level* row, std::int64_t i) { return unit * static_cast<float>(at(row, i)); };
          Quadric q;
          q.value = value(f, x);
          const auto differences = [&](std::size_t a, float less, float more)
          {
            q.slope[a] = 0.5F * (more - less);
            q.bend[a] = (more + less) - 2 * q.value;
          };
          differences(0, value(f, low), value(f, high));
          differences(1, value(rows[3], x), value(rows[5], x));
          differences(2, value(rows[1], x), value(rows[7], x));
          const auto twisted = [&](float lowLow, float highLow, float lowHigh, float highHigh)
          { return 0.25F * ((lowLow + highHigh) - (highLow + lowHigh)); };
          q.twist[0] = twisted(value(rows[3], low), value(rows[3], high), value(rows[5], low), value(rows[5], high));
          q.twist[1] = twisted(value(rows[1], low), value(rows[1], high), value(rows[7], low), value(rows[7], high));
          q.twist[2] = twisted(value(rows[0], x), value(rows[2], x), value(rows[6], x), value(rows[8], x));
          const int share = std::max(static_cast<int>(std::lround(most * shareOf(q, deep))), half + 1);
          share_[from + x] = static_cast<std::uint8_t>(second ? share : most - share);
        }
      });
  }

  /// Moves the surface by what labels exceed shares around a node, over the surface's area there.
  void move()
  {
    const std::int64_t nx = grid_.size[0];
    std::swap(level_, other_);
    const auto slope =
      [&](const auto* own, const auto* low, const auto* high, const auto* below, const auto* above, std::int64_t x)
    {
      const std::int64_t l = x > 0 ? x - 1 : grid_.before();
      const std::int64_t h = x < nx - 1 ? x + 1 : grid_.behind();
      const auto a = static_cast<float>(own[h] - own[l]);
      const auto b = static_cast<float>(high[x] - low[x]);
      const auto c = static_cast<float>(above[x] - below[x]);
      return 0.5F * std::sqrt(a * a + b * b + c * c);
    };
    blurred<8, 2, Beyond::Mirrored>(
      grid_,
      [&](std::int64_t y, std::int64_t z, int field, float* row)
      {
        const std::int64_t from = grid_.row(y, z);
        const std::uint8_t* const s = share_.data() + from;
        if (field == 0)
        {
          for (std::int64_t x = 0; x < nx; ++x)
            row[x] = static_cast<float>((isSecond(from + x) ? most : 0) - s[x]) * (1.0F / most);
          return;
        }
        const std::uint8_t* const low = share_.data() + grid_.row(y - 1, z);
        const std::uint8_t* const high = share_.data() + grid_.row(y + 1, z);
        const std::uint8_t* const below = share_.data() + grid_.row(y, z - 1);
        const std::uint8_t* const above = share_.data() + grid_.row(y, z + 1);
        for (std::int64_t x = 0; x < nx; ++x)
          row[x] = std::min(1.0F, slope(s, low, high, below, above, x) * (1.0F / most));
      },
      [&](std::int64_t y, std::int64_t z, const float* sums)
      {
        const std::int64_t from = grid_.row(y, z);
        const Level* const f = other_.data() + from;
        const Level* const low = other_.data() + grid_.row(y - 1, z);
        const Level* const high = other_.data() + grid_.row(y + 1, z);
        const Level* const below = other_.data() + grid_.row(y, z - 1);
        const Level* const above = other_.data() + grid_.row(y, z + 1);
        for (std::int64_t x = 0; x < nx; ++x)
        {
          const float shift = std::clamp(sums[x] / std::max(sums[nx + x], leastArea), -1.0F, 1.0F);
          const float steep = std::max(levelUnit * slope(f, low, high, below, above, x), leastSlope);
          level_[from + x] = held(from + x, levelUnit * static_cast<float>(f[x]) + shift * steep);
        }
      });
  }

  Grid grid_;
  std::span<const std::uint8_t> label_;
  std::uint8_t second_;
  std::vector<Level> level_;
  std::vector<Level> other_;
  std::vector<std::uint8_t> share_;
};

} // namespace

std::vector<double> evenShares()
{
  std::vector<double> share(shareLevels);
  for (std::size_t i = 0; i < share.size(); ++i)
    share[i] = static_cast<double>(i) / most;
  return share;
}

std::vector<std::uint8_t> labelShares(const Lattice& lattice, std::span<const std::uint8_t> label, std::uint8_t second,
  const std::array<bool, 3>& wraps, int threads)
{
  if (label.size() != static_cast<std::size_t>(lattice.count()))
    throw ParameterError(fmt::format("{} labels for {} nodes", label.size(), lattice.count()), "give one a node");
  return Smoothing({ lattice.size, wraps, std::max(1, threads) }, label, second).run();
}

double cubeShare(double value, const std::array<double, 3>& slope) noexcept
{
  double m1 = std::abs(slope[0]);
  double m2 = std::abs(slope[1]);
  double m3 = std::abs(slope[2]);
  const double sum = m1 + m2 + m3;
  const double from = 0.5 * sum - std::abs(value); // from the corner that is deepest in the lesser part
  if (!(from > 0))
    return value > 0 ? 1 : value < 0 ? 0 : 0.5;
  const auto order = [](double& low, double& high)
  {
    const double less = std::min(low, high);
    high = std::max(low, high);
    low = less;
  };
  order(m1, m2);
  order(m2, m3);
  order(m1, m2);
  const double both = m1 + m2;
  double part = 0;
  if (from < m1)
    part = from * from * from / (6 * m1 * m2 * m3);
  else if (from < m2)
    part = (from * (from - m1) + m1 * m1 / 3) / (2 * m2 * m3);
  else if (both <= m3 && from >= both)
    part = (2 * from - both) / (2 * m3);
  else
  {
    double cube = from * from * (3 * both - from);
    if (from >= m3)
      cube = from * from * (3 * sum - 2 * from) + m3 * m3 * (m3 - 3 * from);
    part = (cube + m1 * m1 * (m1 - 3 * from) + m2 * m2 * (m2 - 3 * from)) / (6 * m1 * m2 * m3);
  }
  return value > 0 ? 1 - part : part;
}

} // namespace lamella
