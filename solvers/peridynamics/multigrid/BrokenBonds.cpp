// Bonds that break, as changes of rank one of every level.
#include "peridynamics/multigrid/BondMultigrid.h"
#include "peridynamics/multigrid/FreeBlocks.h"

#include <algorithm>

namespace lamella::peridynamics
{
namespace
{

// What is left of a diagonal block once all of its bonds are gone: round-off, of the block that there was.
constexpr double roundOff = 1e-5;

using Node = SpringWeights::Node;

std::vector<Node> restricted(const std::vector<Node>& fine)
{
  std::vector<Node> coarse;
  for (const Node& f : fine)
  {
    std::array<int, 3> odd{};
    double weight = f.weight;
    for (std::size_t a = 0; a < 3; ++a)
    {
      odd[a] = static_cast<int>(f.node[a] % 2);
      weight *= odd[a] != 0 ? 0.5 : 1;
    }
    for (int z = 0; z <= odd[2]; ++z)
      for (int y = 0; y <= odd[1]; ++y)
        for (int x = 0; x <= odd[0]; ++x)
        {
          const std::array<std::int64_t, 3> to{ f.node[0] / 2 + x, f.node[1] / 2 + y, f.node[2] / 2 + z };
          const auto found = std::find_if(coarse.begin(), coarse.end(), [&](const Node& n) { return n.node == to; });
          if (found != coarse.end())
            found->weight += weight;
          else
            coarse.push_back({ to, weight });
        }
  }
  std::erase_if(coarse, [](const Node& n) { return n.weight == 0; }); // exact: sums of powers of two
  return coarse;
}

// More of them take longer in a product than packing them with the matrix.
constexpr std::size_t mostSprings = 512;

void remember(Level& level, const SpringWeights& spring, const std::vector<Node>& nodes)
{
  if (nodes.empty())
    return;
  BrokenSpring broken;
  broken.stiffness = static_cast<float>(spring.stiffness);
  for (std::size_t a = 0; a < 3; ++a)
    broken.direction[a] = static_cast<float>(spring.direction[a]);
  broken.low = broken.high = nodes.front().node;
  for (const Node& n : nodes)
  {
    for (std::size_t a = 0; a < 3; ++a)
    {
      broken.low[a] = std::min(broken.low[a], n.node[a]);
      broken.high[a] = std::max(broken.high[a], n.node[a] + 1);
    }
    broken.nodes.push_back({ level.layout.index(n.node[0], n.node[1], n.node[2]), static_cast<float>(n.weight) });
  }
  level.broken.push_back(std::move(broken));
  if (level.broken.size() >= mostSprings)
    level.foldBroken();
}

} // namespace

SpringWeights BondMultigrid::weights(std::int64_t index, int offset) const
{
  const NodeLayout& l = bonds_.layout();
  const Offset& half = bonds_.stencil().half()[static_cast<std::size_t>(offset)];
  SpringWeights spring;
  spring.stiffness = bonds_.springConstant(index, offset);
  for (std::size_t a = 0; a < 3; ++a)
    spring.direction[a] = half.step[a] / half.length;
  std::vector<Node> ends;
  const std::uint8_t all = allComponents(l.dimension);
  const std::int64_t other = index + bonds_.jump(offset);
  if (fixed_[index] != all)
    ends.push_back({ l.node(index), -1 });
  if (fixed_[other] != all)
    ends.push_back({ l.node(other), 1 });
  spring.levels.push_back(std::move(ends));
  while (spring.levels.size() < levels_.size())
    spring.levels.push_back(restricted(spring.levels.back()));
  return spring;
}

// The sum over the bonds that are left, for it must not drift.
void BondMultigrid::invertFinest(std::int64_t index)
{
  const int d = bonds_.dimension();
  const auto& half = bonds_.stencil().half();
  NodeField<float>& inverse = levels_.front()->inverse;
  std::array<double, 6> sum{};
  for (int o = 0; o < static_cast<int>(half.size()); ++o)
  {
    const double k = bonds_.springConstant(index, o) + bonds_.springConstant(index - bonds_.jump(o), o);
    const Offset& step = half[static_cast<std::size_t>(o)];
    for (int e = 0; e < blockEntries(d); ++e)
      sum[static_cast<std::size_t>(e)] += k * step.step[static_cast<std::size_t>(entryRow[d - 2][e])] *
        step.step[static_cast<std::size_t>(entryColumn[d - 2][e])] / (step.length * step.length);
  }
  for (int e = 0; e < blockEntries(d); ++e)
    if ((fixed_[index] >> entryRow[d - 2][e] & 1U) != 0 || (fixed_[index] >> entryColumn[d - 2][e] & 1U) != 0)
      sum[static_cast<std::size_t>(e)] = 0;
  invertBlock(sum, inverse, index);
}

void BondMultigrid::subtract(const SpringWeights& spring)
{
  const int d = bonds_.dimension();
  if (traces_.empty())
    for (const auto& level : levels_)
    {
      traces_.emplace_back(level->layout, 1);
      if (level == levels_.front())
        traces_.back() = NodeField<float>(); // its blocks are summed anew
      else
        for (std::int64_t i = 0; i < level->layout.count(); ++i)
          for (int c = 0; c < d; ++c)
            traces_.back().component(0)[i] += level->diagonal.component(c)[i];
    }
  std::array<double, 6> tensor{};
  for (int e = 0; e < blockEntries(d); ++e)
    tensor[static_cast<std::size_t>(e)] = spring.stiffness *
      spring.direction[static_cast<std::size_t>(entryRow[d - 2][e])] *
      spring.direction[static_cast<std::size_t>(entryColumn[d - 2][e])];

  for (const Node& n : spring.levels.front())
    invertFinest(bonds_.layout().index(n.node[0], n.node[1], n.node[2]));
  for (std::size_t k = 1; k < levels_.size(); ++k)
  {
    Level& level = *levels_[k];
    const NodeLayout& l = level.layout;
    const auto& nodes = spring.levels[k];
    for (const Node& a : nodes)
      for (const Node& b : nodes)
      {
        std::array<int, 3> step{};
        for (std::size_t i = 0; i < 3; ++i)
          step[i] = static_cast<int>(b.node[i] - a.node[i]);
        const int sign = step[2] != 0 ? step[2] : step[1] != 0 ? step[1] : step[0];
        if (sign < 0)
          continue; // its mirror image is stored
        const int first = sign == 0 ? 0 : forwardIndex(l.ghost, step) * level.entries();
        const std::int64_t at = l.index(a.node[0], a.node[1], a.node[2]);
        if (sign != 0 && level.packed())
          continue;
        for (int e = 0; e < level.entries(); ++e)
          (sign == 0 ? level.diagonal.component(e)[at] : level.block(first + e, at)) -=
            static_cast<float>(a.weight * b.weight * tensor[static_cast<std::size_t>(e)]);
      }
    if (level.packed())
      remember(level, spring, nodes);
    for (const Node& n : nodes)
    {
      const std::int64_t i = l.index(n.node[0], n.node[1], n.node[2]);
      invertBlock(level.diagonal, level.inverse, i,
        (level.packed() ? singularShareOfPacked : roundOff) * static_cast<double>(traces_[k].component(0)[i]));
    }
  }
  if (levels_.size() < 2 || !coarsest_)
    return;
  std::vector<std::pair<std::int64_t, double>> v;
  for (const Node& n : spring.levels.back())
    for (int c = 0; c < d; ++c)
      v.emplace_back(CoarsestLevel::number(levels_.back()->layout, n.node[0], n.node[1], n.node[2], c),
        n.weight * spring.direction[static_cast<std::size_t>(c)]);
  if (coarsest_->subtract(v, spring.stiffness))
    return;
  levels_.back()->foldBroken();
  coarsest_.emplace(*levels_.back());
}

} // namespace lamella::peridynamics
