#include "micrograph/NearestContours.h"

#include <algorithm>
#include <cmath>
#include <unordered_set>

namespace lamella::micrograph
{
namespace
{

constexpr std::size_t kRun = 8;
constexpr std::int64_t kBlock = 8;

double squaredToBox(const Point& point, const Point& low, const Point& high)
{
  const double dx = std::max({ low[0] - point[0], 0.0, point[0] - high[0] });
  const double dy = std::max({ low[1] - point[1], 0.0, point[1] - high[1] });
  return dx * dx + dy * dy;
}

void grow(Point& low, Point& high, const Point& point)
{
  for (const int axis : { 0, 1 })
  {
    low[axis] = std::min(low[axis], point[axis]);
    high[axis] = std::max(high[axis], point[axis]);
  }
}

/// For processors with and without AVX2, chosen when the program is loaded; both give the same numbers.
#define LAMELLA_BOTH __attribute__((target_clones("avx2", "default")))

/// @param lanes x, y, dx, dy and 1/length² of eight segments, one after another
LAMELLA_BOTH void squaredToSegments(const double* lanes, double px, double py, double* squared)
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

/// Boxes beside each other in memory.
struct Boxes
{
  std::vector<double> lowX, lowY, highX, highY, squared;

  void resize(std::size_t count)
  {
    for (std::vector<double>* values : { &lowX, &lowY, &highX, &highY, &squared })
    {
      values->resize(count);
    }
  }
};

LAMELLA_BOTH void squaredToBoxes(const double* lowX, const double* lowY, const double* highX, const double* highY,
  std::size_t count, double px, double py, double* squared)
{
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i)
  {
    const double left = lowX[i] - px;
    const double right = px - highX[i];
    const double below = lowY[i] - py;
    const double above = py - highY[i];
    double dx = left > right ? left : right;
    double dy = below > above ? below : above;
    dx = dx > 0 ? dx : 0;
    dy = dy > 0 ? dy : 0;
    squared[i] = dx * dx + dy * dy;
  }
}

/// What a run must be nearer than to matter, whatever its label.
double wantedWithin(const Nearest& nearest, std::size_t last)
{
  const double most = nearest.squared[last];
  return last == 2 ? std::min(most, Nearest::kThird * Nearest::kThird * nearest.squared[1]) : most;
}

/// Of a label that is known already only what is nearer matters.
bool nearerThanKnown(const Nearest& nearest, double squared, std::int32_t label)
{
  for (std::size_t i = 0; i < Nearest::kMost; ++i)
  {
    if (nearest.label[i] == label)
    {
      return squared <= nearest.squared[i];
    }
  }
  return true;
}

/// Puts a segment in its place; of two at the same distance the lower label and segment count as nearer, so that the
/// order of trying does not matter.
void insert(Nearest& nearest, double squared, std::int32_t label, std::int32_t segment, int labels)
{
  int place = 0;
  while (place < labels - 1 && nearest.label[place] != label)
  {
    ++place;
  }
  const auto before = [&](int i)
  {
    if (squared != nearest.squared[i])
    {
      return squared < nearest.squared[i];
    }
    return label != nearest.label[i] ? label < nearest.label[i] : segment < nearest.segment[i];
  };
  if (!before(place))
  {
    return;
  }
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

NearestContours::NearestContours(std::vector<Segment> segments, int labels)
  : segments_(std::move(segments))
{
  std::unordered_set<std::int32_t> known;
  for (const Segment& segment : segments_)
  {
    if (static_cast<int>(known.size()) < labels)
    {
      known.insert(segment.label);
    }
  }
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
  squaredToSegments(lanes_[static_cast<std::size_t>(run.lanes)].data(), point[0], point[1], squared.data());
  std::int32_t which = 0;
  for (std::int32_t i = 1; i < run.count; ++i)
  {
    which = squared[static_cast<std::size_t>(i)] < squared[static_cast<std::size_t>(which)] ? i : which;
  }
  insert(nearest, squared[static_cast<std::size_t>(which)], run.label, run.first + which, labels_);
}

Nearest NearestContours::at(const Point& point, double within) const
{
  Nearest nearest;
  if (tree_.empty())
  {
    return nearest;
  }
  const double most = within * within;
  std::array<std::pair<double, std::int32_t>, 128> stack;
  std::size_t depth = 0;
  stack[depth++] = { squaredToBox(point, tree_[0].low, tree_[0].high), 0 };
  while (depth > 0)
  {
    const auto [squared, index] = stack[--depth];
    if (squared > std::min(most, nearest.squared[static_cast<std::size_t>(labels_) - 1]))
    {
      continue;
    }
    const Branch& branch = tree_[static_cast<std::size_t>(index)];
    for (std::int32_t i = branch.first; i < branch.first + branch.runs; ++i)
    {
      tryRun(runs_[static_cast<std::size_t>(i)], point, nearest);
    }
    if (branch.runs == 0)
    {
      const Branch& left = tree_[static_cast<std::size_t>(branch.first)];
      const Branch& right = tree_[static_cast<std::size_t>(branch.first) + 1];
      std::pair<double, std::int32_t> a{ squaredToBox(point, left.low, left.high), branch.first };
      std::pair<double, std::int32_t> b{ squaredToBox(point, right.low, right.high), branch.first + 1 };
      if (a.first < b.first)
      {
        std::swap(a, b);
      }
      stack[depth++] = a;
      stack[depth++] = b;
    }
  }
  return nearest;
}

template <typename Visit>
void NearestContours::within(const Point& point, double distance, const Visit& visit) const
{
  std::array<std::int32_t, 128> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  const double most = distance * distance;
  while (depth > 0)
  {
    const Branch& branch = tree_[static_cast<std::size_t>(stack[--depth])];
    if (squaredToBox(point, branch.low, branch.high) > most)
    {
      continue;
    }
    for (std::int32_t i = branch.first; i < branch.first + branch.runs; ++i)
    {
      const Run& run = runs_[static_cast<std::size_t>(i)];
      if (const double squared = squaredToBox(point, run.low, run.high); squared <= most)
      {
        visit(squared, run);
      }
    }
    if (branch.runs == 0)
    {
      stack[depth++] = branch.first + 1;
      stack[depth++] = branch.first;
    }
  }
}

void NearestContours::atNodes(std::int64_t nx, std::int64_t ny, double spacing, std::span<const std::uint8_t> wanted,
  double within, const std::function<void(std::int64_t, const Point&, const Nearest&)>& visit) const
{
  if (tree_.empty())
  {
    return;
  }
  std::vector<std::pair<double, const Run*>> near;
  Boxes boxes;
  std::vector<std::pair<std::int64_t, Point>> nodes;
  const std::size_t last = static_cast<std::size_t>(labels_) - 1;
  for (std::int64_t y0 = 0; y0 < ny; y0 += kBlock)
  {
    for (std::int64_t x0 = 0; x0 < nx; x0 += kBlock)
    {
      nodes.clear();
      Point low{ Nearest::kNone, Nearest::kNone };
      Point high{ -Nearest::kNone, -Nearest::kNone };
      for (std::int64_t y = y0; y < std::min(ny, y0 + kBlock); ++y)
      {
        for (std::int64_t x = x0; x < std::min(nx, x0 + kBlock); ++x)
        {
          if (wanted[static_cast<std::size_t>(x + nx * y)] != 0)
          {
            const Point point{ (static_cast<double>(x) + 0.5) * spacing, (static_cast<double>(y) + 0.5) * spacing };
            nodes.emplace_back(x + nx * y, point);
            grow(low, high, point);
          }
        }
      }
      if (nodes.empty())
      {
        continue;
      }
      const Point centre{ (low[0] + high[0]) / 2, (low[1] + high[1]) / 2 };
      const double radius = std::hypot(high[0] - centre[0], high[1] - centre[1]) * (1 + 1e-12);
      const Nearest middle = at(centre, within + radius);
      // The second nearest distance changes by no more than `radius` from the centre to a node.
      double limit = std::sqrt(middle.squared[last]) + 2 * radius;
      if (last == 2)
      {
        limit = std::min(limit, Nearest::kThird * (std::sqrt(middle.squared[1]) + radius) + radius);
      }
      limit = std::min(limit, within + radius);
      Nearest before = middle;
      near.clear();
      this->within(centre, limit, [&](double squared, const Run& run) { near.emplace_back(squared, &run); });
      std::sort(near.begin(), near.end(),
        [](const auto& a, const auto& b)
        { return a.first != b.first ? a.first < b.first : a.second->first < b.second->first; });
      boxes.resize(near.size());
      for (std::size_t i = 0; i < near.size(); ++i)
      {
        boxes.lowX[i] = near[i].second->low[0];
        boxes.lowY[i] = near[i].second->low[1];
        boxes.highX[i] = near[i].second->high[0];
        boxes.highY[i] = near[i].second->high[1];
      }
      for (const auto& [node, point] : nodes)
      {
        squaredToBoxes(boxes.lowX.data(), boxes.lowY.data(), boxes.highX.data(), boxes.highY.data(), near.size(),
          point[0], point[1], boxes.squared.data());
        // What was nearest to the node before gives a bound at once.
        Nearest nearest;
        for (std::size_t i = 0; i <= last && before.segment[i] >= 0; ++i)
        {
          const Segment& segment = segments_[static_cast<std::size_t>(before.segment[i])];
          const Point at = footOn(segment, point);
          const double dx = point[0] - at[0];
          const double dy = point[1] - at[1];
          insert(nearest, (dx * dx + dy * dy) * (1 + 1e-14), segment.label, before.segment[i], labels_);
        }
        double most = wantedWithin(nearest, last);
        for (std::size_t i = 0; i < near.size(); ++i)
        {
          if (boxes.squared[i] <= most && nearerThanKnown(nearest, boxes.squared[i], near[i].second->label))
          {
            tryRun(*near[i].second, point, nearest);
            most = wantedWithin(nearest, last);
          }
        }
        before = nearest;
        visit(node, point, nearest);
      }
    }
  }
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
      {
        segments.push_back(segment);
      }
    }
  }
  return segments;
}

WallThickness wallThickness(const ContourSet& contours, int samples)
{
  const NearestContours search(segmentsOf(contours), 2);
  double length = 0;
  for (const Segment& segment : search.segments())
  {
    length += std::hypot(segment.to[0] - segment.from[0], segment.to[1] - segment.from[1]);
  }
  std::vector<double> thickness;
  const double step = length / samples;
  double next = step / 2;
  for (const Segment& segment : search.segments())
  {
    const double own = std::hypot(segment.to[0] - segment.from[0], segment.to[1] - segment.from[1]);
    while (next < own)
    {
      const double t = next / own;
      next += step;
      const Nearest nearest = search.at({ segment.from[0] + t * (segment.to[0] - segment.from[0]),
        segment.from[1] + t * (segment.to[1] - segment.from[1]) });
      if (nearest.squared[1] < Nearest::kNone)
      {
        thickness.push_back(std::sqrt(nearest.squared[1]));
      }
    }
    next -= own;
  }
  if (thickness.empty())
  {
    return {};
  }
  std::sort(thickness.begin(), thickness.end());
  return { thickness[thickness.size() / 20], thickness[thickness.size() / 2] };
}

} // namespace lamella::micrograph
