// Steps of pixels are smoothed away between the nodes that make them: a least-squares problem a chain, seven diagonals.
#include "outlines/ContourSmoothing.h"

#include "outlines/RingSystem.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace lamella::micrograph
{
namespace
{

struct Vector
{
  double x = 0, y = 0;
};

[[nodiscard]] std::size_t wrapped(std::ptrdiff_t i, std::size_t n) noexcept
{
  const auto size = static_cast<std::ptrdiff_t>(n);
  return static_cast<std::size_t>(i < 0 ? i + size : i >= size ? i - size : i);
}

/// Unit normal to the right of a chain, towards the wall, from the chord between the crossings `reach` before and
/// after.
[[nodiscard]] Vector normalAt(const Trace& trace, std::size_t at, std::ptrdiff_t reach)
{
  const auto& c = trace.crossings;
  const auto i = static_cast<std::ptrdiff_t>(at);
  const auto last = static_cast<std::ptrdiff_t>(c.size()) - 1;
  const Crossing& a = trace.closed ? c[wrapped(i - reach, c.size())]
                                   : c[static_cast<std::size_t>(std::max<std::ptrdiff_t>(i - reach, 0))];
  const Crossing& b =
    trace.closed ? c[wrapped(i + reach, c.size())] : c[static_cast<std::size_t>(std::min(i + reach, last))];
  const Vector d{ b.px() - a.px(), b.py() - a.py() };
  const double length = std::sqrt(d.x * d.x + d.y * d.y);
  return length > 0 ? Vector{ d.y / length, -d.x / length }
                    : Vector{ static_cast<double>(c[at].ex), static_cast<double>(c[at].ey) };
}

/// Where a chain would leave its room, at corners, it is held eight times as strongly from now on.
void tighten(const std::vector<double>& free, double room, bool closed, std::vector<double>& hold)
{
  const std::size_t n = free.size();
  const std::vector<double> before = hold;
  for (std::size_t i = 0; i < n; ++i)
  {
    if (std::abs(free[i]) <= room + 0.05)
      continue;
    for (std::ptrdiff_t d = -2; d <= 2; ++d)
    {
      const auto k = static_cast<std::ptrdiff_t>(i) + d;
      if (closed || (k >= 0 && k < static_cast<std::ptrdiff_t>(n)))
      {
        const std::size_t at = wrapped(k, n);
        hold[at] = std::min(before[at] * 8, 1e5);
      }
    }
  }
}

constexpr std::size_t fewest = 8; ///< crossings that a chain to be smoothed has

} // namespace

double signedArea(const Trace& trace, bool halfWay)
{
  // Closed chains from a point of theirs, for less round-off; open ones from the corner where the border begins.
  const Crossing& first = trace.crossings.front();
  const double x0 = trace.closed ? first.x : 0.0;
  const double y0 = trace.closed ? first.y : 0.0;
  const auto x = [&](const Crossing& c) { return (halfWay ? c.x : c.px()) - x0; };
  const auto y = [&](const Crossing& c) { return (halfWay ? c.y : c.py()) - y0; };
  double twice = 0;
  const auto add = [&](const Crossing& a, const Crossing& b) { twice += x(a) * y(b) - x(b) * y(a); };
  for (std::size_t i = 1; i < trace.crossings.size(); ++i)
    add(trace.crossings[i - 1], trace.crossings[i]);
  if (trace.closed)
  {
    add(trace.crossings.back(), first);
    return twice / 2;
  }
  const double w = trace.width;
  const double h = trace.height;
  const auto border = [&](const Crossing& c) // twice the area swept from the origin along the border
  {
    return y(c) == 0 ? 0 : x(c) == w ? w * y(c) : y(c) == h ? w * h + h * (w - x(c)) : 2 * w * h;
  };
  return (twice + border(first) - border(trace.crossings.back())) / 2;
}

double capArea(const Trace& trace)
{
  const auto& c = trace.crossings;
  const std::size_t n = c.size();
  double sum = 0;
  for (std::size_t i = trace.closed ? 0 : 1; i < (trace.closed ? n : n - 1); ++i)
  {
    const Crossing& a = c[i == 0 ? n - 1 : i - 1];
    const Crossing& b = c[i + 1 < n ? i + 1 : 0];
    const Vector in{ c[i].px() - a.px(), c[i].py() - a.py() };
    const Vector out{ b.px() - c[i].px(), b.py() - c[i].py() };
    const double turn = std::atan2(in.x * out.y - in.y * out.x, in.x * out.x + in.y * out.y);
    sum += turn * (in.x * in.x + in.y * in.y + out.x * out.x + out.y * out.y) / 24;
  }
  return sum;
}

void thinOut(Trace& trace)
{
  const auto& c = trace.crossings;
  const std::size_t n = c.size();
  if (n < 2 * fewest)
    return;
  std::vector<Crossing> kept;
  kept.reserve(n);
  bool dropped = false;
  for (std::size_t i = 0; i < n; ++i)
  {
    const bool end = i == 0 || i + 1 == n;
    bool drop = false;
    if (!end && !dropped)
    {
      const Crossing& a = c[i - 1];
      const Crossing& b = c[i + 1];
      const bool step = std::abs(b.x - a.x) == 1 && std::abs(b.y - a.y) == 1; // two cells on, diagonally
      const bool across = (a.ex == 0) == (b.ex == 0) && (a.ex == 0) != (c[i].ex == 0);
      if (step && across)
      {
        const Vector normal = normalAt(trace, i, 4);
        drop = c[i].ex != 0 ? std::abs(normal.x) < std::abs(normal.y) : std::abs(normal.y) < std::abs(normal.x);
      }
    }
    dropped = drop;
    if (!drop)
      kept.push_back(c[i]);
  }
  trace.crossings = std::move(kept);
}

void smooth(Trace& trace, const SmoothingScale& scale)
{
  auto& c = trace.crossings;
  const std::size_t n = c.size();
  if (n < fewest)
    return;
  const double room = 0.5 - scale.margin;
  const double push = std::pow(2 * std::numbers::pi / 3, 6);
  RingSystem ring(n, trace.closed);
  std::vector<Vector> normal(n);
  std::vector<double> length(n); // to the next crossing
  struct Bend
  {
    std::array<double, 3> c;
    double constant;
  };
  std::vector<Bend> bend(n);
  std::vector<double> free(n);
  std::vector<double> hold(n, 1.0);
  for (std::size_t i = 0; i < n; ++i)
    free[i] = c[i].t;
  for (int round = 0; round < scale.rounds; ++round)
  {
    // From short waves to long ones: few crossings at a time reach the end of their room.
    const double wavelength = std::min(scale.wavelength, 8 * std::pow(1.5, round));
    const double pull = std::pow(2 * std::numbers::pi / wavelength, 6);
    const std::ptrdiff_t reach = round == 0 ? 3 : 1;
    for (std::size_t i = 0; i < n; ++i)
    {
      normal[i] = normalAt(trace, i, reach);
      const Crossing& next = c[wrapped(static_cast<std::ptrdiff_t>(i) + 1, n)];
      const double dx = next.px() - c[i].px();
      const double dy = next.py() - c[i].py();
      length[i] = std::max(std::sqrt(dx * dx + dy * dy), 0.3);
    }
    for (std::size_t i = 0; i < n; ++i)
    {
      const std::size_t before = wrapped(static_cast<std::ptrdiff_t>(i) - 1, n);
      const std::size_t after = wrapped(static_cast<std::ptrdiff_t>(i) + 1, n);
      const double mean = (length[before] + length[i]) / 2;
      const double a = 1 / (mean * length[before]);
      const double b = 1 / (mean * length[i]);
      const auto along = [&](const Crossing& k) { return normal[i].x * k.ex + normal[i].y * k.ey; };
      bend[i].c = { a * along(c[before]), -(a + b) * along(c[i]), b * along(c[after]) };
      bend[i].constant = normal[i].x * (a * (c[before].x - c[i].x) + b * (c[after].x - c[i].x)) +
        normal[i].y * (a * (c[before].y - c[i].y) + b * (c[after].y - c[i].y));
    }
    ring.clear();
    for (std::size_t k = trace.closed ? 0 : 1; k < (trace.closed ? n : n - 2); ++k)
    {
      const std::size_t after = wrapped(static_cast<std::ptrdiff_t>(k) + 1, n);
      const Bend& p = bend[k];
      const Bend& q = bend[after];
      ring.add(wrapped(static_cast<std::ptrdiff_t>(k) - 1, n), { -p.c[0], q.c[0] - p.c[1], q.c[1] - p.c[2], q.c[2] },
        q.constant - p.constant, 1 / length[k]);
    }
    for (std::size_t i = 0; i < n; ++i)
    {
      const std::size_t before = wrapped(static_cast<std::ptrdiff_t>(i) - 1, n);
      const double along = normal[i].x * c[i].ex + normal[i].y * c[i].ey;
      const double weight = (length[before] + length[i]) / 2 * std::max(along * along, 0.05);
      const bool outside = std::abs(free[i]) > room;
      ring.addDiagonal(
        i, weight * std::max(hold[i] * pull, outside ? push : 0.0), outside ? std::copysign(room, free[i]) : 0.0);
    }
    ring.solve();
    for (std::size_t i = 0; i < n; ++i)
    {
      free[i] = ring.solution(i);
      c[i].t = std::clamp(free[i], -room, room);
    }
    tighten(free, room, trace.closed, hold);
  }
}

double restoreArea(Trace& trace, double target, double margin)
{
  auto& c = trace.crossings;
  const double room = 0.5 - margin;
  std::vector<double> share(c.size());
  std::vector<double> before(c.size());
  for (std::size_t i = 0; i < c.size(); ++i)
  {
    const Vector normal = normalAt(trace, i, 1);
    share[i] = 1 / std::max(std::abs(normal.x * c[i].ex + normal.y * c[i].ey), 0.5);
    before[i] = c[i].t;
  }
  const auto missing = [&](double move)
  {
    for (std::size_t i = 0; i < c.size(); ++i)
      c[i].t = std::clamp(before[i] + move * share[i], -room, room);
    return target - signedArea(trace);
  };
  // The area grows with the move, linearly but for the ends of the room: regula falsi (Illinois).
  double low = 0;
  double atLow = missing(0);
  if (atLow == 0)
    return 0;
  double high = std::copysign(0.02, atLow);
  double atHigh = missing(high);
  while (atHigh * atLow > 0 && std::abs(high) < 2)
  {
    low = high;
    atLow = atHigh;
    high *= 2;
    atHigh = missing(high);
  }
  if (atHigh * atLow > 0)
    return atHigh;
  const double enough = 1e-13 * (1 + std::abs(target));
  double rest = atHigh;
  for (int i = 0; i < 60 && std::abs(rest) > enough; ++i)
  {
    const double middle = (low * atHigh - high * atLow) / (atHigh - atLow);
    rest = missing(middle);
    if (rest * atHigh < 0)
    {
      low = high;
      atLow = atHigh;
    }
    else
    {
      atLow /= 2;
    }
    high = middle;
    atHigh = rest;
  }
  return rest;
}

} // namespace lamella::micrograph
