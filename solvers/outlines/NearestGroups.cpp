#include "outlines/NearestContours.h"

#include <algorithm>
#include <cmath>

namespace lamella::micrograph
{
namespace
{

constexpr std::int64_t kBlock = 8; ///< nodes along a group's side
constexpr std::size_t kGroup = 64; ///< points of a group at most
constexpr std::size_t kVector = 4; ///< points that are worked on at once, twice over

using Numbers __attribute__((vector_size(8 * kVector))) = double;
using Loaded __attribute__((vector_size(8 * kVector), aligned(8), may_alias)) = double; ///< at any address

/// One of several segments that matter to a group.
struct Candidate
{
  double x = 0, y = 0, dx = 0, dy = 0, inverse = 0; ///< from, to − from, 1/length²
};

/// The nearest of the segments for each point; of those that are equally near the first.
/// @param count of points, a multiple of 2 kVector  @param which its position among the segments
LAMELLA_BOTH void nearestOf(const Candidate* segments, std::size_t segmentCount, const double* px, const double* py,
  std::size_t count, double* squared, double* which)
{
  for (std::size_t i = 0; i < count; i += 2 * kVector)
  {
    const Numbers x0 = *reinterpret_cast<const Loaded*>(px + i);
    const Numbers y0 = *reinterpret_cast<const Loaded*>(py + i);
    const Numbers x1 = *reinterpret_cast<const Loaded*>(px + i + kVector);
    const Numbers y1 = *reinterpret_cast<const Loaded*>(py + i + kVector);
    const Numbers zero = {};
    const Numbers one = zero + 1.0;
    Numbers best0 = zero + Nearest::kNone;
    Numbers best1 = best0;
    Numbers at0 = zero;
    Numbers at1 = zero;
    for (std::size_t k = 0; k < segmentCount; ++k)
    {
      const Candidate& s = segments[k];
      const Numbers wayX0 = x0 - s.x;
      const Numbers wayY0 = y0 - s.y;
      const Numbers wayX1 = x1 - s.x;
      const Numbers wayY1 = y1 - s.y;
      Numbers t0 = (wayX0 * s.dx + wayY0 * s.dy) * s.inverse;
      Numbers t1 = (wayX1 * s.dx + wayY1 * s.dy) * s.inverse;
      t0 = t0 > zero ? t0 : zero;
      t1 = t1 > zero ? t1 : zero;
      t0 = t0 < one ? t0 : one;
      t1 = t1 < one ? t1 : one;
      const Numbers awayX0 = wayX0 - t0 * s.dx;
      const Numbers awayY0 = wayY0 - t0 * s.dy;
      const Numbers awayX1 = wayX1 - t1 * s.dx;
      const Numbers awayY1 = wayY1 - t1 * s.dy;
      const Numbers squared0 = awayX0 * awayX0 + awayY0 * awayY0;
      const Numbers squared1 = awayX1 * awayX1 + awayY1 * awayY1;
      const Numbers place = zero + static_cast<double>(k);
      at0 = squared0 < best0 ? place : at0;
      at1 = squared1 < best1 ? place : at1;
      best0 = squared0 < best0 ? squared0 : best0;
      best1 = squared1 < best1 ? squared1 : best1;
    }
    *reinterpret_cast<Loaded*>(squared + i) = best0;
    *reinterpret_cast<Loaded*>(squared + i + kVector) = best1;
    *reinterpret_cast<Loaded*>(which + i) = at0;
    *reinterpret_cast<Loaded*>(which + i + kVector) = at1;
  }
}

double distanceTo(const Segment& segment, const Point& point)
{
  const Point foot = footOn(segment, point);
  return std::hypot(point[0] - foot[0], point[1] - foot[1]);
}

} // namespace

/// Searches one group of points after another.
class NearestContours::Groups
{
public:
  Groups(const NearestContours& search, double within)
    : search_(search)
    , within_(within)
    , last_(static_cast<std::size_t>(search.labels_) - 1)
  {
  }

  void clear() { count_ = 0; }
  [[nodiscard]] bool full() const { return count_ == kGroup; }
  [[nodiscard]] bool empty() const { return count_ == 0; }

  void add(std::int64_t index, const Point& point)
  {
    index_[count_] = index;
    x_[count_] = point[0];
    y_[count_] = point[1];
    ++count_;
  }

  void search(const Visit& visit)
  {
    const auto [lowX, highX] = std::minmax_element(x_.begin(), x_.begin() + count_);
    const auto [lowY, highY] = std::minmax_element(y_.begin(), y_.begin() + count_);
    centre_ = { (*lowX + *highX) / 2, (*lowY + *highY) / 2 };
    radius_ = std::hypot(*highX - centre_[0], *highY - centre_[1]) * (1 + 1e-12);
    const std::size_t padded = (count_ + 2 * kVector - 1) / (2 * kVector) * (2 * kVector);
    std::fill(x_.begin() + count_, x_.begin() + padded, x_[count_ - 1]);
    std::fill(y_.begin() + count_, y_.begin() + padded, y_[count_ - 1]);
    gather();
    std::fill(found_.begin(), found_.begin() + count_, Nearest{});
    for (const Label& label : labels_)
    {
      choose(label);
      nearestOf(candidates_.data(), candidates_.size(), x_.data(), y_.data(), padded, squared_.data(), which_.data());
      for (std::size_t i = 0; i < count_; ++i)
        if (squared_[i] < found_[i].squared[last_])
          insert(found_[i], squared_[i], label.label, segments_[static_cast<std::size_t>(which_[i])]);
    }
    for (std::size_t i = 0; i < count_; ++i)
      visit(index_[i], { x_[i], y_[i] }, found_[i]);
  }

private:
  struct Label
  {
    std::int32_t label = 0;
    std::size_t first = 0; ///< of its runs in near_
    std::size_t end = 0;
    double squared = Nearest::kNone; ///< of the centre
    std::int32_t segment = -1;
  };
  struct Near
  {
    const Run* run = nullptr;
    std::array<double, kRun> squared; ///< of the centre
  };

  /// How far from the centre something may be and matter, from distances that are no less than those of the nearest
  /// labels to it. No point's distance differs from the centre's by more than the radius.
  [[nodiscard]] double limit(const std::array<double, Nearest::kMost>& distances) const
  {
    double most = distances[last_] + 2 * radius_;
    if (last_ == 2)
      most = std::min(most, Nearest::kThird * (distances[1] + radius_) + radius_);
    return std::min(most, within_ + radius_) * (1 + 1e-12); // round-off
  }

  /// Bounds of the nearest labels' distances from the centre.
  [[nodiscard]] std::array<double, Nearest::kMost> bounds() const
  {
    std::array<double, Nearest::kMost> distances{ Nearest::kNone, Nearest::kNone, Nearest::kNone };
    // From what was near the group before; a move that is short beside these distances changes them little.
    if (hints_.size() > last_)
    {
      for (std::size_t i = 0; i <= last_; ++i)
        distances[i] = distanceTo(search_.segments_[static_cast<std::size_t>(hints_[i])], centre_);
      std::sort(distances.begin(), distances.end());
      const double move = std::hypot(centre_[0] - before_[0], centre_[1] - before_[1]);
      if (move <= std::max(4 * radius_, distances[last_] / 2))
        return distances;
    }
    const Nearest nearest = search_.at(centre_, within_ + radius_);
    for (std::size_t i = 0; i <= last_; ++i)
      distances[i] = std::sqrt(nearest.squared[i]);
    return distances;
  }

  /// Fills near_ and labels_.
  void gather()
  {
    near_.clear();
    runsWithin(limit(bounds()));
    std::sort(near_.begin(), near_.end(),
      [](const Near& a, const Near& b)
      { return a.run->label != b.run->label ? a.run->label < b.run->label : a.run->first < b.run->first; });
    labels_.clear();
    for (std::size_t i = 0; i < near_.size(); ++i)
    {
      const Run& run = *near_[i].run;
      if (labels_.empty() || labels_.back().label != run.label)
        labels_.push_back({ run.label, i, i, Nearest::kNone, -1 });
      Label& label = labels_.back();
      label.end = i + 1;
      for (std::size_t k = 0; k < static_cast<std::size_t>(run.count); ++k)
      {
        if (near_[i].squared[k] < label.squared)
        {
          label.squared = near_[i].squared[k];
          label.segment = run.first + static_cast<std::int32_t>(k);
        }
      }
    }
    // Now the distances are known.
    order_.clear();
    for (const Label& label : labels_)
      order_.emplace_back(label.squared, label.segment);
    const std::size_t some = std::min(order_.size(), last_ + 1);
    std::partial_sort(order_.begin(), order_.begin() + static_cast<std::ptrdiff_t>(some), order_.end());
    std::array<double, Nearest::kMost> distances{ Nearest::kNone, Nearest::kNone, Nearest::kNone };
    hints_.clear();
    for (std::size_t i = 0; i < some; ++i)
    {
      distances[i] = std::sqrt(order_[i].first);
      hints_.push_back(order_[i].second);
    }
    before_ = centre_;
    limit_ = limit(distances);
    std::erase_if(labels_, [&](const Label& label) { return label.squared > limit_ * limit_; });
  }

  void runsWithin(double distance)
  {
    std::array<std::int32_t, 128> stack;
    std::size_t depth = 0;
    stack[depth++] = 0;
    const double most = distance * distance;
    while (depth > 0)
    {
      const Branch& branch = search_.tree_[static_cast<std::size_t>(stack[--depth])];
      if (squaredTo(centre_, branch.low, branch.high) > most)
        continue;
      for (std::int32_t i = branch.first; i < branch.first + branch.runs; ++i)
      {
        const Run& run = search_.runs_[static_cast<std::size_t>(i)];
        if (squaredTo(centre_, run.low, run.high) <= most)
        {
          near_.push_back({ &run, {} });
          squaredToRun(search_.lanes_[static_cast<std::size_t>(run.lanes)].data(), centre_[0], centre_[1],
            near_.back().squared.data());
        }
      }
      if (branch.runs == 0)
      {
        stack[depth++] = branch.first + 1;
        stack[depth++] = branch.first;
      }
    }
  }

  /// The segments of a label that may be its nearest to some point.
  void choose(const Label& label)
  {
    const double most = std::min((std::sqrt(label.squared) + 2 * radius_) * (1 + 1e-12), limit_);
    candidates_.clear();
    segments_.clear();
    for (std::size_t i = label.first; i < label.end; ++i)
    {
      const Near& near = near_[i];
      const Lanes& lanes = search_.lanes_[static_cast<std::size_t>(near.run->lanes)];
      for (std::size_t k = 0; k < static_cast<std::size_t>(near.run->count); ++k)
      {
        if (near.squared[k] <= most * most)
        {
          candidates_.push_back(
            { lanes[k], lanes[k + kRun], lanes[k + 2 * kRun], lanes[k + 3 * kRun], lanes[k + 4 * kRun] });
          segments_.push_back(near.run->first + static_cast<std::int32_t>(k));
        }
      }
    }
  }

  /// Labels come by rising number, so that of two that are equally near the lower one counts as nearer.
  void insert(Nearest& nearest, double squared, std::int32_t label, std::int32_t segment) const
  {
    std::size_t place = last_;
    for (; place > 0 && squared < nearest.squared[place - 1]; --place)
    {
      nearest.squared[place] = nearest.squared[place - 1];
      nearest.label[place] = nearest.label[place - 1];
      nearest.segment[place] = nearest.segment[place - 1];
    }
    nearest.squared[place] = squared;
    nearest.label[place] = label;
    nearest.segment[place] = segment;
  }

  const NearestContours& search_;
  double within_;
  std::size_t last_; ///< of the labels that are wanted

  std::size_t count_ = 0;
  std::array<std::int64_t, kGroup> index_{};
  std::array<double, kGroup> x_{};
  std::array<double, kGroup> y_{};
  std::array<double, kGroup> squared_{};
  std::array<double, kGroup> which_{};
  std::array<Nearest, kGroup> found_{};

  Point centre_{ 0, 0 };
  double radius_ = 0;
  double limit_ = 0;
  Point before_{ 0, 0 }; ///< the group's before
  std::vector<std::int32_t> hints_;
  std::vector<Near> near_; ///< by label
  std::vector<Label> labels_;
  std::vector<std::pair<double, std::int32_t>> order_;
  std::vector<Candidate> candidates_;
  std::vector<std::int32_t> segments_;
};

void NearestContours::atNodes(std::int64_t nx, std::int64_t ny, double spacing, std::span<const std::uint8_t> wanted,
  double within, const Visit& visit) const
{
  if (tree_.empty())
    return;
  static_assert(kBlock * kBlock <= kGroup);
  Groups groups(*this, within);
  for (std::int64_t y0 = 0; y0 < ny; y0 += kBlock)
  {
    for (std::int64_t x0 = 0; x0 < nx; x0 += kBlock)
    {
      groups.clear();
      for (std::int64_t y = y0; y < std::min(ny, y0 + kBlock); ++y)
      {
        for (std::int64_t x = x0; x < std::min(nx, x0 + kBlock); ++x)
        {
          if (wanted[static_cast<std::size_t>(x + nx * y)] != 0)
          {
            groups.add(
              x + nx * y, { (static_cast<double>(x) + 0.5) * spacing, (static_cast<double>(y) + 0.5) * spacing });
          }
        }
      }
      if (!groups.empty())
        groups.search(visit);
    }
  }
}

void NearestContours::atPoints(std::span<const Point> points, double size, double within, const Visit& visit) const
{
  if (tree_.empty())
    return;
  Groups groups(*this, within);
  Point first{ 0, 0 };
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const Point& point = points[i];
    if (!groups.empty() &&
      (groups.full() || std::abs(point[0] - first[0]) > size / 2 || std::abs(point[1] - first[1]) > size / 2))
    {
      groups.search(visit);
      groups.clear();
    }
    first = groups.empty() ? point : first;
    groups.add(static_cast<std::int64_t>(i), point);
  }
  if (!groups.empty())
    groups.search(visit);
}

} // namespace lamella::micrograph
