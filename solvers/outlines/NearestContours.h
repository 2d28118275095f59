#pragma once

#include "outlines/Contour.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

/// Internal: which outlines are nearest, each of another lumen.
namespace lamella::micrograph
{

/// A straight piece of an outline.
struct Segment
{
  Point from{ 0, 0 };
  Point to{ 0, 0 };
  std::int32_t label = 0; ///< lumen
  std::int32_t chain = 0;
};

/// The point of a segment that is nearest to another one; its first one where it has no length.
[[nodiscard]] inline Point footOn(const Segment& segment, const Point& point)
{
  const Point way{ segment.to[0] - segment.from[0], segment.to[1] - segment.from[1] };
  const double t = ((point[0] - segment.from[0]) * way[0] + (point[1] - segment.from[1]) * way[1]) /
    (way[0] * way[0] + way[1] * way[1]);
  const double share = t > 0 ? std::min(t, 1.0) : 0.0;
  return { segment.from[0] + share * way[0], segment.from[1] + share * way[1] };
}

/// The nearest segments of different labels, by rising distance.
struct Nearest
{
  static constexpr int kMost = 3;
  static constexpr double kThird = 1.25; ///< as far beyond the second nearest a third one is of interest
  static constexpr double kNone = std::numeric_limits<double>::infinity();
  std::array<double, kMost> squared{ kNone, kNone, kNone }; ///< distance²; infinite: there is none
  std::array<std::int32_t, kMost> label{ 0, 0, 0 };
  std::array<std::int32_t, kMost> segment{ -1, -1, -1 };
};

/// For processors with and without AVX2, chosen when the program is loaded; both give the same numbers.
#define LAMELLA_BOTH __attribute__((target_clones("avx2", "default")))

/// Nearest segments of up to three different labels, exact to round-off: a tree of boxes around runs of eight segments
/// that follow each other.
///
/// Many points are searched in groups: what any point of a group can need lies within distances that the group's centre
/// and the triangle inequality give, one for each label; only these segments are tried, each for several points at
/// once.
class NearestContours
{
public:
  static constexpr std::size_t kRun = 8; ///< segments

  /// @param labels how many different ones are wanted, 1 to 3
  NearestContours(std::vector<Segment> segments, int labels);

  [[nodiscard]] std::span<const Segment> segments() const noexcept { return segments_; }
  [[nodiscard]] bool empty() const noexcept { return segments_.empty(); }

  /// @param within nothing farther away is looked for
  [[nodiscard]] Nearest at(const Point& point, double within = Nearest::kNone) const;

  using Visit = std::function<void(std::int64_t index, const Point& point, const Nearest& nearest)>;

  /// For the nodes of nx × ny at (i + ½, j + ½) · spacing that are `wanted`. The third nearest may be left out where it
  /// is more than kThird times as far as the second.
  /// @param within nothing farther away need be found
  void atNodes(std::int64_t nx, std::int64_t ny, double spacing, std::span<const std::uint8_t> wanted, double within,
    const Visit& visit) const;

  /// The same for points anywhere. They should follow each other: those within squares of this size are searched
  /// together.
  void atPoints(std::span<const Point> points, double size, double within, const Visit& visit) const;

private:
  class Groups; ///< NearestGroups.cpp

  struct Run
  {
    Point low;
    Point high;
    std::int32_t first = 0;
    std::int32_t count = 0;
    std::int32_t label = 0;
    std::int32_t lanes = 0;
  };
  struct Branch
  {
    Point low;
    Point high;
    std::int32_t first = 0; ///< of two branches that follow each other, or of the runs of a leaf
    std::int32_t runs = 0;  ///< 0: not a leaf
  };
  /// Eight segments beside each other, for loops that the compiler turns into vectors; short runs repeat their last
  /// one.
  using Lanes = std::array<double, 5 * kRun>; ///< x, y, dx, dy, 1/length², eight of each

  /// Of a point to a box.
  static double squaredTo(const Point& point, const Point& low, const Point& high)
  {
    const double dx = std::max({ low[0] - point[0], 0.0, point[0] - high[0] });
    const double dy = std::max({ low[1] - point[1], 0.0, point[1] - high[1] });
    return dx * dx + dy * dy;
  }
  /// Of a point to each of a run's segments.
  static void squaredToRun(const double* lanes, double px, double py, double* squared);

  void build(std::size_t branch, std::int32_t first, std::int32_t count);
  void tryRun(const Run& run, const Point& point, Nearest& nearest) const;

  std::vector<Segment> segments_;
  std::vector<Run> runs_;
  std::vector<Lanes> lanes_;
  std::vector<Branch> tree_;
  int labels_;
};

/// Segments of all chains, none without length.
[[nodiscard]] std::vector<Segment> segmentsOf(const ContourSet& contours);

} // namespace lamella::micrograph
