#include "peridynamics/fracture/SpringWindow.h"

#include <algorithm>

namespace lamella::peridynamics
{
namespace
{

constexpr std::size_t mostOffsets = 1100; // half of the bonds of a node in space, at a horizon of eight

std::int64_t inLanes(std::int64_t nodes)
{
  return (nodes + eventLanes - 1) / eventLanes * eventLanes;
}

} // namespace

Box expanded(const Box& box, int by, const NodeLayout& layout)
{
  Box b;
  for (std::size_t a = 0; a < 3; ++a)
  {
    const bool flat = a >= static_cast<std::size_t>(layout.dimension);
    b.low[a] = flat ? 0 : std::max<std::int64_t>(0, box.low[a] - by);
    b.high[a] = flat ? 1 : std::min(a == 0 ? inLanes(layout.size[0]) : layout.size[a], box.high[a] + by);
  }
  return b;
}

Box inVectors(const Box& box, const NodeLayout& layout)
{
  Box b = box;
  const std::int64_t low = box.low[0] / 2 * 2;
  const std::int64_t width = inLanes(box.high[0] - low);
  b.low[0] = std::min(low, inLanes(layout.size[0]) - width);
  b.high[0] = b.low[0] + width;
  return b;
}

Box grown(const Box& box, int by, const NodeLayout& layout)
{
  return inVectors(expanded(box, by, layout), layout);
}

Box parentsOf(const Box& fine, const NodeLayout& coarse)
{
  Box b;
  for (std::size_t a = 0; a < 3; ++a)
  {
    b.low[a] = fine.low[a] / 2;
    b.high[a] = std::min(coarse.size[a], fine.high[a] / 2 + 1);
  }
  return b;
}

Box parents(const Box& fine, const NodeLayout& coarse)
{
  return inVectors(parentsOf(fine, coarse), coarse);
}

Box whole(const NodeLayout& l)
{
  return grown({ { 0, 0, 0 }, l.size }, 0, l);
}

Box united(const Box& a, const Box& b)
{
  Box u;
  for (std::size_t i = 0; i < 3; ++i)
  {
    u.low[i] = std::min(a.low[i], b.low[i]);
    u.high[i] = std::max(a.high[i], b.high[i]);
  }
  return u;
}

SpringWindow::SpringWindow(const BondLattice& bonds)
  : dimension_(bonds.dimension())
  , reach_(bonds.stencil().layers())
  , count_(static_cast<std::int64_t>(bonds.stencil().half().size()))
{
  for (int o = 0; o < static_cast<int>(count_); ++o)
  {
    const Offset& half = bonds.stencil().half()[static_cast<std::size_t>(o)];
    steps_.push_back(half.step);
    for (std::size_t a = 0; a < 3; ++a)
      directions_[a].push_back(static_cast<float>(half.step[a] / half.length));
    std::vector<float> table(std::max<std::size_t>(4, std::size_t{ 1 } << bonds.planes()), 0.0F);
    for (std::size_t k = 1; k < bonds.kinds().size(); ++k)
      table[k] = static_cast<float>(half.weight * bonds.kinds()[k].stiffness / (half.length * bonds.spacing()));
    tables_.push_back(std::move(table));
  }
}

void SpringWindow::read(const BondLattice& bonds, const Box& box)
{
  const NodeLayout& l = bonds.layout();
  rows_ = box;
  rows_.low[0] -= eventLanes;
  rows_.high[0] += eventLanes;
  rows_.low[1] -= reach_;
  if (dimension_ == 3)
  {
    rows_.high[1] += reach_;
    rows_.low[2] -= reach_;
  }
  width_ = rows_.high[0] - rows_.low[0];
  values_.resize(static_cast<std::size_t>(rows_.count() * count_));
  forRows(rows_,
    [&](std::int64_t y, std::int64_t z)
    {
      const std::int64_t i = l.index(rows_.low[0], y, z);
      for (int o = 0; o < static_cast<int>(count_); ++o)
      {
        float* out = values_.data() + rowOf(y, z) + o * width_;
        const std::uint32_t* words[8]{};
        for (int p = 0; p < bonds.planes(); ++p)
          words[p] = bonds.plane(p, o >> 5) + i;
        if (bonds.corrected())
          for (std::int64_t x = 0; x < width_; ++x)
            out[x] = static_cast<float>(bonds.springConstant(i + x, o));
        else
          eventKernels().select(
            bonds.planes(), words, o & 31, tables_[static_cast<std::size_t>(o)].data(), width_, out);
      }
    });
}

double SpringWindow::product(WindowRows rows, const NodeLayout& layout, const Box& part, std::int64_t z) const
{
  const float* spring[mostOffsets];
  const float* back[mostOffsets];
  std::int64_t jump[mostOffsets];
  const std::int64_t y = part.low[1];
  const std::int64_t low = part.low[0];
  for (std::int64_t o = 0; o < count_; ++o)
  {
    const auto& s = steps_[static_cast<std::size_t>(o)];
    spring[o] = values_.data() + rowOf(y, z) + o * width_ + low - rows_.low[0];
    back[o] = values_.data() + rowOf(y - s[1], z - s[2]) + o * width_ + low - s[0] - rows_.low[0];
    jump[o] = s[0] + layout.pitch * (s[1] + layout.rowsY() * s[2]);
  }
  rows.jump = jump;
  SpringRows springs{ static_cast<int>(count_), spring, back, rowOf(y + 1, z) - rowOf(y, z), {} };
  for (int c = 0; c < dimension_; ++c)
    springs.direction[c] = directions_[static_cast<std::size_t>(c)].data();
  return eventKernels().springs(dimension_, rows, springs);
}

} // namespace lamella::peridynamics
