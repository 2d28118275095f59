#include "lbm/elements/ElementShare.h"

namespace lamella::lbm
{

ElementShare::ElementShare(const Problem& problem)
  : problem_(problem)
{
  const Lattice& lattice = problem.lattice;
  if (lattice.dimension == 2 || lattice.size[1] > lattice.size[2])
    order_ = { 0, 2, 1 };
  const auto cut = static_cast<std::size_t>(order_[2]);
  box_.elements = turned(lattice.size);
  box_.periodic = turned(problem.periodic());
  box_.fixed = problem.options.sides == Sides::Periodic ? -1 : order_[static_cast<std::size_t>(problem.axis)];
  slab_.size = lattice.size;
  if (!moves())
    return;
  if (box_.wholeNodes() > PlaneParts::fewNodes)
    box_.parts = PlaneParts(box_.elements[2], box_.periodic[2], problem.comm);
  for (int r = 0; r < problem.comm.size(); ++r)
  {
    blocks_.push_back(problem.parts.block(r));
    Block& slab = slabs_.emplace_back(Block{ { 0, 0, 0 }, lattice.size });
    if (!box_.parts.split())
      continue;
    const auto [first, last] = box_.parts.of(r);
    slab.start[cut] = first;
    slab.size[cut] = last - first;
  }
  slab_ = slabs_[static_cast<std::size_t>(problem.comm.rank())];
  box_.elements = turned(slab_.size);
}

std::vector<double> ElementShare::toBlock(std::span<const double> ofNodes) const
{
  std::vector<Block> before; // each node once, of a box that is not split the first rank's
  std::vector<Block> after;
  for (std::size_t r = 0; r < blocks_.size(); ++r)
  {
    Block nodes{ turned(slabs_[r].start), turned(slabs_[r].size) };
    const bool last = nodes.start[2] + nodes.size[2] == box_.whole(2);
    nodes.size = { nodes.size[0] + 1, nodes.size[1] + 1, nodes.size[2] + (last ? 1 : 0) };
    if (!box_.parts.split() && r > 0)
      nodes.size[2] = 0;
    before.push_back(nodes);
    Block corners{ turned(blocks_[r].start), turned(blocks_[r].size) };
    for (std::int64_t& size : corners.size)
      ++size;
    after.push_back(corners);
  }
  const Block& mine = after[static_cast<std::size_t>(problem_.comm.rank())];
  std::vector<double> moved(static_cast<std::size_t>(mine.count()));
  Redistribution(3, turned(problem_.lattice.size), before, after, problem_.comm, 0)
    .forward(ofNodes.data(), moved.data(), static_cast<std::size_t>(mine.size[0]));
  return moved;
}

} // namespace lamella::lbm
