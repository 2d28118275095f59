#include "outlines/NearestContours.h"

#include <algorithm>
#include <cmath>
#include <unordered_set>

namespace lamella::micrograph
{
namespace
{

constexpr std::size_t kRun = NearestContours::kRun;

void grow(Point& low, Point& high, const Point& point)
{
  for (const int axis : { 0, 1 })
  {
    low[axis] = std::min(low[axis], point[axis]);
    high[axis] = std::max(high[axis], point[axis]);
  }
}

/// Puts a segment in its place; of two at the same distance the lower label and segment count as nearer, so that the
/// order of trying does not matter.
void insert(Nearest& nearest, double squared, std::int32_t label, std::int32_t segment, int labels)
{
  int place = 0;
  while (place < labels - 1 && nearest.label[place] != label)
    ++place;
  const auto before = [&](int i)
  {
    if (squared != nearest.squared[i])
      return squared < nearest.squared[i];
    return label != nearest.label[i] ? label < nearest.label[i] : segment < nearest.segment[i];
  };
  if (!before(place))
    return;
  while (place > 0 && before(place - 1))
  {
    nearest.squared[place] = nearest.squared[place - 1];
    nearest.label[place] = nearest.label[place - 1];
    nearest.segment[place] = nearest.segment[place - 1];
    --place;
  }
  nearest.squared[place] = squared;
  nearest.label[place] = label;
  nearest.segment[place] = segment;
}

} // namespace

/// @param lanes x, y, dx, dy and 1/length² of eight segments, one after another
LAMELLA_BOTH void NearestContours::squaredToRun(const double* lanes, double px, double py, double* squared)
{
#pragma omp simd
  for (std::size_t i = 0; i < kRun; ++i)
  {
    const double x = px - lanes[i];
    const double y = py - lanes[i + kRun];
    const double dx = lanes[i + 2 * kRun];
    const double dy = lanes[i + 3 * kRun];
    double t = (x * dx + y * dy) * lanes[i + 4 * kRun];
    t = t > 0 ? t : 0;
    t = t < 1 ? t : 1;
    const double awayX = x - t * dx;
    const double awayY = y - t * dy;
    squared[i] = awayX * awayX + awayY * awayY;
  }
}

NearestContours::NearestContours(std::vector<Segment> segments, int labels)
  : segments_(std::move(segments))
{
  std::unordered_set<std::int32_t> known;
  for (const Segment& segment : segments_)
    if (static_cast<int>(known.size()) < labels)
      known.insert(segment.label);
  labels_ = std::min(labels, static_cast<int>(known.size()));
  const auto count = static_cast<std::int32_t>(segments_.size());
  for (std::int32_t i = 0; i < count; ++i)
  {
    const Segment& segment = segments_[static_cast<std::size_t>(i)];
    if (i == 0 || runs_.back().count == static_cast<std::int32_t>(kRun) ||
      segments_[static_cast<std::size_t>(i) - 1].chain != segment.chain)
    {
      runs_.push_back({ segment.from, segment.from, i, 0, segment.label, static_cast<std::int32_t>(lanes_.size()) });
      lanes_.emplace_back();
    }
    Run& run = runs_.back();
    const double dx = segment.to[0] - segment.from[0];
    const double dy = segment.to[1] - segment.from[1];
    for (auto lane = static_cast<std::size_t>(run.count); lane < kRun; ++lane)
    {
      lanes_.back()[lane] = segment.from[0];
      lanes_.back()[lane + kRun] = segment.from[1];
      lanes_.back()[lane + 2 * kRun] = dx;
      lanes_.back()[lane + 3 * kRun] = dy;
      lanes_.back()[lane + 4 * kRun] = 1 / (dx * dx + dy * dy);
    }
    grow(run.low, run.high, segment.from);
    grow(run.low, run.high, segment.to);
    ++run.count;
  }
  if (!runs_.empty())
  {
    tree_.resize(1);
    build(0, 0, static_cast<std::int32_t>(runs_.size()));
  }
}

void NearestContours::build(std::size_t branch, std::int32_t first, std::int32_t count)
{
  Branch box{ runs_[static_cast<std::size_t>(first)].low, runs_[static_cast<std::size_t>(first)].high, first, count };
  for (std::int32_t i = first; i < first + count; ++i)
  {
    grow(box.low, box.high, runs_[static_cast<std::size_t>(i)].low);
    grow(box.low, box.high, runs_[static_cast<std::size_t>(i)].high);
  }
  if (count > 2)
  {
    const int axis = box.high[0] - box.low[0] >= box.high[1] - box.low[1] ? 0 : 1;
    const auto begin = runs_.begin() + first;
    std::nth_element(begin, begin + count / 2, begin + count,
      [axis](const Run& a, const Run& b)
      {
        const double left = a.low[axis] + a.high[axis];
        const double right = b.low[axis] + b.high[axis];
        return left != right ? left < right : a.first < b.first;
      });
    box.runs = 0;
    box.first = static_cast<std::int32_t>(tree_.size());
    tree_[branch] = box;
    tree_.resize(tree_.size() + 2);
    build(static_cast<std::size_t>(box.first), first, count / 2);
    build(static_cast<std::size_t>(box.first) + 1, first + count / 2, count - count / 2);
    return;
  }
  tree_[branch] = box;
}

void NearestContours::tryRun(const Run& run, const Point& point, Nearest& nearest) const
{
  std::array<double, kRun> squared;
  squaredToRun(lanes_[static_cast<std::size_t>(run.lanes)].data(), point[0], point[1], squared.data());
  std::int32_t which = 0;
  for (std::int32_t i = 1; i < run.count; ++i)
    which = squared[static_cast<std::size_t>(i)] < squared[static_cast<std::size_t>(which)] ? i : which;
  insert(nearest, squared[static_cast<std::size_t>(which)], run.label, run.first + which, labels_);
}

Nearest NearestContours::at(const Point& point, double within) const
{
  Nearest nearest;
  if (tree_.empty())
    return nearest;
  const double most = within * within;
  std::array<std::pair<double, std::int32_t>, 128> stack;
  std::size_t depth = 0;
  stack[depth++] = { squaredTo(point, tree_[0].low, tree_[0].high), 0 };
  while (depth > 0)
  {
    const auto [squared, index] = stack[--depth];
    if (squared > std::min(most, nearest.squared[static_cast<std::size_t>(labels_) - 1]))
      continue;
    const Branch& branch = tree_[static_cast<std::size_t>(index)];
    for (std::int32_t i = branch.first; i < branch.first + branch.runs; ++i)
      tryRun(runs_[static_cast<std::size_t>(i)], point, nearest);
    if (branch.runs == 0)
    {
      const Branch& left = tree_[static_cast<std::size_t>(branch.first)];
      const Branch& right = tree_[static_cast<std::size_t>(branch.first) + 1];
      std::pair<double, std::int32_t> a{ squaredTo(point, left.low, left.high), branch.first };
      std::pair<double, std::int32_t> b{ squaredTo(point, right.low, right.high), branch.first + 1 };
      if (a.first < b.first)
        std::swap(a, b);
      stack[depth++] = a;
      stack[depth++] = b;
    }
  }
  return nearest;
}

std::vector<Segment> segmentsOf(const ContourSet& contours)
{
  std::vector<Segment> segments;
  for (std::size_t chain = 0; chain < contours.contours.size(); ++chain)
  {
    const Contour& contour = contours.contours[chain];
    const std::size_t n = contour.points.size();
    for (std::size_t i = 0; i + (contour.closed ? 0 : 1) < n; ++i)
    {
      const Segment segment{ contour.points[i], contour.points[(i + 1) % n], contour.lumen,
        static_cast<std::int32_t>(chain) };
      if (segment.from != segment.to)
        segments.push_back(segment);
    }
  }
  return segments;
}

} // namespace lamella::micrograph
