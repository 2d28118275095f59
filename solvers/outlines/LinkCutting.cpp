#include "outlines/LinkCutting.h"

#include "outlines/CellSums.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace lamella::micrograph
{
namespace
{

/// Goes through the cells of one frame row by row and lists the links that are cut.
class LinkSweep
{
public:
  LinkSweep(const CellSums& cells, int axis, bool across)
    : cells_(cells)
    , axis_(axis)
    , across_(across)
    , count_(cells.lines(axis).place.size())
    , rowState_(count_)
    , columnState_(count_ * static_cast<std::size_t>(cells.frame().size[0]))
  {
  }

  /// @param differ whether the nodes at a link's ends are of two phases
  template <typename Differ>
  void list(const Differ& differ, LinkCuts& cuts)
  {
    const CellFrame& frame = cells_.frame();
    for (std::int64_t row = 0; row < frame.size[1]; ++row)
    {
      double cover = 0;
      std::fill(rowState_.begin(), rowState_.end(), 0);
      for (std::int64_t column = 0; column < frame.size[0]; ++column)
      {
        const std::int32_t slot = cells_.slot(column, row);
        if (slot < 0)
        {
          if (differ(column, row))
            add(column, row, slot, cover, cuts);
          continue;
        }
        if (cells_.sum(slot).cut || differ(column, row))
          add(column, row, slot, cover, cuts);
        cover += cells_.sum(slot).cover;
        for (const int axis : { 0, 1 })
        {
          const LineSums& lines = cells_.lines(axis);
          int* state = stateOf(axis, column);
          for (std::size_t k = 0; k < lines.place.size(); ++k)
            state[k] += lines.turn[static_cast<std::size_t>(slot) * count_ + k];
        }
      }
    }
  }

private:
  int* stateOf(int axis, std::int64_t column)
  {
    return axis == 0 ? rowState_.data() : columnState_.data() + static_cast<std::size_t>(column) * count_;
  }

  void share(int axis, std::int64_t column, std::int32_t slot, std::vector<float>& out)
  {
    const LineSums& lines = cells_.lines(axis);
    const int* state = stateOf(axis, column);
    for (std::size_t k = 0; k < count_; ++k)
    {
      const float part = slot < 0 ? 0.F : lines.part[static_cast<std::size_t>(slot) * count_ + k];
      out.push_back(std::clamp(static_cast<float>(state[k]) + part, 0.F, 1.F));
    }
  }

  void add(std::int64_t column, std::int64_t row, std::int32_t slot, double cover, LinkCuts& cuts)
  {
    const CellFrame& frame = cells_.frame();
    const double width = frame.end(0, column) - frame.begin(0, column);
    const double height = frame.end(1, row) - frame.begin(1, row);
    const CellSum sum = slot < 0 ? CellSum{} : cells_.sum(slot);
    cuts.link.push_back(column + frame.size[0] * row);
    cuts.area.push_back(static_cast<float>(std::clamp((cover * width + sum.area) / (width * height), 0.0, 1.0)));
    const double length = sum.length > 0 ? sum.length : 1;
    cuts.normal.push_back({ static_cast<float>(sum.normal[0] / length), static_cast<float>(sum.normal[1] / length) });
    share(axis_, column, slot, cuts.share);
    if (across_)
      share(1 - axis_, column, slot, cuts.across);
  }

  const CellSums& cells_;
  int axis_;
  bool across_;
  std::size_t count_;
  std::vector<int> rowState_;
  std::vector<int> columnState_;
};

} // namespace

LinkCuts cutLinks(
  std::span<const ContourEdge> edges, const PhaseImage& image, const ContourLatticeOptions& options, int axis)
{
  LinkCuts cuts;
  const LineRule rule = gaussRule(options.lines);
  cuts.place = rule.place;
  cuts.weight = rule.weight;
  const std::int64_t nx = image.lattice.size[0];
  const std::int64_t ny = image.lattice.size[1];
  CellSums cells(CellFrame(nx, ny, axis));
  cells.addAreas(edges);
  cells.addLines(edges, axis, cuts.place);
  if (options.across)
    cells.addLines(edges, 1 - axis, cuts.place);
  const std::int64_t step = axis == 0 ? 1 : nx;
  const std::int64_t last = axis == 0 ? nx : ny;
  const auto differ = [&](std::int64_t column, std::int64_t row)
  {
    const std::int64_t along = axis == 0 ? column : row;
    if (along == 0 || along == last)
      return false;
    const auto node = static_cast<std::size_t>(column + nx * row);
    return image.phase[node] != image.phase[node - static_cast<std::size_t>(step)];
  };
  LinkSweep(cells, axis, options.across).list(differ, cuts);
  return cuts;
}

LineRule gaussRule(int count)
{
  LineRule rule;
  for (int i = 0; i < count; ++i)
  {
    // Newton on the Legendre polynomial, from the usual first guess; the roots are simple and it converges at once.
    double x = -std::cos(std::numbers::pi * (i + 0.75) / (count + 0.5));
    double slope = 1;
    for (int turn = 0; turn < 8; ++turn)
    {
      double before = 1;
      double value = x;
      for (int n = 2; n <= count; ++n)
      {
        const double after = ((2 * n - 1) * x * value - (n - 1) * before) / n;
        before = value;
        value = after;
      }
      slope = count * (x * value - before) / (x * x - 1);
      x -= value / slope;
    }
    rule.place.push_back((x + 1) / 2);
    rule.weight.push_back(1 / ((1 - x * x) * slope * slope));
  }
  return rule;
}

double LinkCuts::harmonicAlong(std::size_t cut, double lumen, double wall) const
{
  double sum = 0;
  for (std::size_t k = 0; k < weight.size(); ++k)
  {
    const double s = share[cut * weight.size() + k];
    sum += weight[k] / (s / lumen + (1 - s) / wall);
  }
  return sum;
}

double LinkCuts::harmonicAcross(std::size_t cut, double lumen, double wall) const
{
  double sum = 0;
  for (std::size_t k = 0; k < weight.size(); ++k)
  {
    const double s = across[cut * weight.size() + k];
    sum += weight[k] / (s * lumen + (1 - s) * wall);
  }
  return 1 / sum;
}

} // namespace lamella::micrograph
