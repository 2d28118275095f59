#include "cracks/BondCrossings.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace lamella::cracks
{
namespace
{

struct Segment
{
  std::int32_t curve;
  std::int32_t from; ///< point at which it begins
  Place a;
  Place b;
};

/// Distance of a point from a segment, and where on the segment it is nearest.
std::array<double, 2> nearest(const Place& p, const Place& a, const Place& b)
{
  const Place along{ b[0] - a[0], b[1] - a[1] };
  const double square = along[0] * along[0] + along[1] * along[1];
  const double part =
    square > 0 ? std::clamp(((p[0] - a[0]) * along[0] + (p[1] - a[1]) * along[1]) / square, 0.0, 1.0) : 0;
  return { std::hypot(p[0] - a[0] - part * along[0], p[1] - a[1] - part * along[1]), part };
}

/// Segments by the unit squares that their boxes touch.
class Squares
{
public:
  explicit Squares(std::span<const CrackCurve> curves)
  {
    for (std::size_t c = 0; c < curves.size(); ++c)
    {
      const std::vector<Place>& points = curves[c].points;
      for (std::size_t i = 0; i + 1 < points.size(); ++i)
      {
        const auto at = static_cast<std::int32_t>(segments_.size());
        segments_.push_back({ static_cast<std::int32_t>(c), static_cast<std::int32_t>(i), points[i], points[i + 1] });
        forSquares(points[i], points[i + 1], 0, [&](std::int64_t key) { squares_[key].push_back(at); });
      }
    }
  }

  /// Calls f(segment) for those within a distance of the box around two points; some more than once.
  template <class F>
  void near(const Place& a, const Place& b, double distance, F&& f) const
  {
    forSquares(
      a, b, distance,
      [&](std::int64_t key)
      {
        if (const auto found = squares_.find(key); found != squares_.end())
          for (const std::int32_t s : found->second)
            f(segments_[static_cast<std::size_t>(s)]);
      });
  }

private:
  template <class F>
  static void forSquares(const Place& a, const Place& b, double more, F&& f)
  {
    const auto first = [&](std::size_t c) { return std::llround(std::floor(std::min(a[c], b[c]) - more)); };
    const auto last = [&](std::size_t c) { return std::llround(std::floor(std::max(a[c], b[c]) + more)); };
    for (std::int64_t y = first(1); y <= last(1); ++y)
      for (std::int64_t x = first(0); x <= last(0); ++x)
        f(y * (std::int64_t{ 1 } << 32) + x);
  }

  std::vector<Segment> segments_;
  std::unordered_map<std::int64_t, std::vector<std::int32_t>> squares_;
};

} // namespace

std::vector<Crossing> crossings(std::span<const CrackCurve> curves, std::span<const CutBond> bonds)
{
  constexpr double beside = 0.5;
  constexpr double none = 1e300;
  const Squares squares(curves);
  std::vector<Crossing> found(bonds.size());
  for (std::size_t i = 0; i < bonds.size(); ++i)
  {
    const CutBond& bond = bonds[i];
    const Place p{ static_cast<double>(bond.node[0]), static_cast<double>(bond.node[1]) };
    const Place q{ p[0] + bond.step[0], p[1] + bond.step[1] };
    double best = none;
    const auto take = [&](const Segment& s, double distance, double part)
    {
      if (distance < best)
      {
        best = distance;
        found[i] = { s.curve, s.from + (part > 0.5 ? 1 : 0) };
      }
    };
    squares.near(p, q, 0,
      [&](const Segment& s)
      {
        const Place along{ s.b[0] - s.a[0], s.b[1] - s.a[1] };
        const double det = bond.step[0] * along[1] - bond.step[1] * along[0];
        if (std::abs(det) < 1e-12)
          return;
        const Place to{ s.a[0] - p[0], s.a[1] - p[1] };
        const double onBond = (to[0] * along[1] - to[1] * along[0]) / det;
        const double onPath = (to[0] * bond.step[1] - to[1] * bond.step[0]) / det;
        if (onBond >= 0 && onBond <= 1 && onPath >= 0 && onPath <= 1)
          take(s, std::abs(onBond - 0.5), onPath);
      });
    if (found[i].curve >= 0)
      continue;
    squares.near(p, q, beside,
      [&](const Segment& s)
      {
        // they do not cross: an end of one of them is nearest to the other
        for (const Place& end : { p, q })
          if (const auto [distance, part] = nearest(end, s.a, s.b); distance <= beside)
            take(s, distance, part);
        if (const double a = nearest(s.a, p, q)[0]; a <= beside)
          take(s, a, 0);
        if (const double b = nearest(s.b, p, q)[0]; b <= beside)
          take(s, b, 1);
      });
  }
  return found;
}

} // namespace lamella::cracks
