#include "outlines/ShareLevel.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace lamella::micrograph
{
namespace
{

/// Share of a unit square within n · x <= offset from its centre, n of length 1.
double shareOf(double nx, double ny, double offset)
{
  const double a = std::max(std::abs(nx), std::abs(ny));
  const double b = std::min(std::abs(nx), std::abs(ny));
  if (offset > 0)
    return 1 - shareOf(nx, ny, -offset);
  const double u = offset + (a + b) / 2; // from the corner that is farthest inside
  return u <= 0 ? 0 : u < b ? u * u / (2 * a * b) : (u - b / 2) / a;
}

/// The offset that gives a share, 0 < share < 1.
double offsetOf(double nx, double ny, double share)
{
  const double a = std::max(std::abs(nx), std::abs(ny));
  const double b = std::min(std::abs(nx), std::abs(ny));
  if (share > 0.5)
    return -offsetOf(nx, ny, 1 - share);
  const double u = 2 * a * share < b ? std::sqrt(2 * a * b * share) : a * share + b / 2;
  return u - (a + b) / 2;
}

/// The line through a pixel: lumen where n · x <= offset, from the pixel's centre.
struct Line
{
  double nx = 0, ny = 0, offset = 0;
  [[nodiscard]] double distance(double x, double y) const { return offset - nx * x - ny * y; }
};

/// Shares of 3 × 3 pixels, the middle one at [1][1]; the first index is the row.
using Patch = std::array<std::array<double, 3>, 3>;

Line lineOf(const Patch& share)
{
  std::array<double, 3> columns{};
  std::array<double, 3> rows{};
  for (std::size_t j = 0; j < 3; ++j)
  {
    for (std::size_t i = 0; i < 3; ++i)
    {
      columns[i] += share[j][i];
      rows[j] += share[j][i];
    }
  }
  Line best;
  double least = 1e300;
  const auto attempt = [&](double nx, double ny)
  {
    const double length = std::hypot(nx, ny);
    Line line{ nx / length, ny / length, 0 };
    line.offset = offsetOf(line.nx, line.ny, share[1][1]);
    double error = 0;
    for (std::size_t j = 0; j < 3; ++j)
    {
      for (std::size_t i = 0; i < 3; ++i)
      {
        const double distance = line.distance(static_cast<double>(i) - 1, static_cast<double>(j) - 1);
        const double off = shareOf(line.nx, line.ny, distance) - share[j][i];
        error += off * off;
      }
    }
    if (error < least)
    {
      least = error;
      best = line;
    }
  };
  // Heights of lumen in columns, over a slope, with lumen below or above; then the same of rows.
  const double up = rows[2] > rows[0] ? -1 : 1;
  const double right = columns[2] > columns[0] ? -1 : 1;
  for (const double slope : { columns[1] - columns[0], (columns[2] - columns[0]) / 2, columns[2] - columns[1] })
    attempt(-slope, up);
  for (const double slope : { rows[1] - rows[0], (rows[2] - rows[0]) / 2, rows[2] - rows[1] })
    attempt(right, -slope);
  return best;
}

} // namespace

std::vector<float> levelOfShares(const Lattice& lattice, std::span<const float> share)
{
  if (lattice.dimension != 2)
    throw ParameterError("shares of a volume", "give a picture");
  if (static_cast<std::int64_t>(share.size()) != lattice.count())
    throw ParameterError(fmt::format("{} shares for {} nodes", share.size(), lattice.count()), "give one a node");
  if (!std::all_of(share.begin(), share.end(), [](float value) { return std::isfinite(value); }))
    throw ParameterError("a share that is no finite number", "give shares from 0 to 1");
  const std::int64_t nx = lattice.size[0];
  const std::int64_t ny = lattice.size[1];
  const auto at = [&](std::int64_t x, std::int64_t y)
  {
    const auto node =
      static_cast<std::size_t>(std::clamp<std::int64_t>(x, 0, nx - 1) + nx * std::clamp<std::int64_t>(y, 0, ny - 1));
    return std::clamp(static_cast<double>(share[node]), 0.0, 1.0);
  };
  const auto partly = [](double value) { return value > 0 && value < 1; };

  std::vector<float> level(share.size());
  std::vector<float> sum(share.size(), 0.F);
  std::vector<std::uint8_t> count(share.size(), 0);
  for (std::int64_t y = 0; y < ny; ++y)
  {
    for (std::int64_t x = 0; x < nx; ++x)
    {
      const auto node = static_cast<std::size_t>(x + nx * y);
      const double own = at(x, y);
      if (!partly(own))
      {
        level[node] = own > 0.5 ? 1.F : -1.F;
        continue;
      }
      Patch patch;
      for (std::int64_t j = 0; j < 3; ++j)
        for (std::int64_t i = 0; i < 3; ++i)
          patch[static_cast<std::size_t>(j)][static_cast<std::size_t>(i)] = at(x + i - 1, y + j - 1);
      const Line line = lineOf(patch);
      level[node] = static_cast<float>(line.offset);
      // What this line says of the pixels beside it that are all lumen or all wall.
      for (const auto& [dx, dy] : { std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1) })
      {
        if (x + dx >= 0 && x + dx < nx && y + dy >= 0 && y + dy < ny && !partly(at(x + dx, y + dy)))
        {
          const auto other = static_cast<std::size_t>(x + dx + nx * (y + dy));
          sum[other] += static_cast<float>(line.distance(dx, dy));
          ++count[other];
        }
      }
    }
  }
  for (std::size_t node = 0; node < level.size(); ++node)
  {
    if (count[node] > 0)
    {
      const float mean = sum[node] / static_cast<float>(count[node]);
      level[node] = level[node] > 0 ? std::max(mean, 1e-3F) : std::min(mean, -1e-3F);
    }
  }
  return level;
}

} // namespace lamella::micrograph
