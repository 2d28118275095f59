#pragma once

#include "micrograph/Contour.h"
#include "micrograph/ContourLattice.h"

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

/// The point of a segment that is nearest to another one.
[[nodiscard]] inline Point footOn(const Segment& segment, const Point& point)
{
  const Point way{ segment.to[0] - segment.from[0], segment.to[1] - segment.from[1] };
  const double t = ((point[0] - segment.from[0]) * way[0] + (point[1] - segment.from[1]) * way[1]) /
    (way[0] * way[0] + way[1] * way[1]);
  const double share = std::clamp(t, 0.0, 1.0);
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

/// Nearest segments of up to three different labels, exact to round-off: a tree of boxes around runs of eight segments
/// that follow each other.
///
/// For lattices nodes are searched in blocks of 8 × 8: what any node of a block can need lies within a distance that
/// the block's centre and the triangle inequality give, and only these runs are tried for each node.
class NearestContours
{
public:
  /// @param labels how many different ones are wanted, 1 to 3
  NearestContours(std::vector<Segment> segments, int labels);

  [[nodiscard]] std::span<const Segment> segments() const noexcept { return segments_; }
  [[nodiscard]] bool empty() const noexcept { return segments_.empty(); }

  /// @param within nothing farther away is looked for
  [[nodiscard]] Nearest at(const Point& point, double within = Nearest::kNone) const;

  /// For the nodes of nx × ny at (i + ½, j + ½) · spacing that are `wanted`. The third nearest may be left out where it
  /// is more than kThird times as far as the second.
  /// @param within nothing farther away need be found
  void atNodes(std::int64_t nx, std::int64_t ny, double spacing, std::span<const std::uint8_t> wanted, double within,
    const std::function<void(std::int64_t node, const Point& point, const Nearest& nearest)>& visit) const;

private:
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

  void build(std::size_t branch, std::int32_t first, std::int32_t count);
  /// Eight segments beside each other, for loops that the compiler turns into vectors; short runs repeat their last
  /// one.
  using Lanes = std::array<double, 40>; ///< x, y, dx, dy, 1/length², eight of each

  void tryRun(const Run& run, const Point& point, Nearest& nearest) const;
  template <typename Visit>
  void within(const Point& point, double distance, const Visit& visit) const;

  std::vector<Segment> segments_;
  std::vector<Run> runs_;
  std::vector<Lanes> lanes_;
  std::vector<Branch> tree_;
  int labels_;
};

/// Segments of all chains, none without length.
[[nodiscard]] std::vector<Segment> segmentsOf(const ContourSet& contours);

/// @param samples points that are spread over the outlines
[[nodiscard]] WallThickness wallThickness(const ContourSet& contours, int samples = 4000);

} // namespace lamella::micrograph
