#include "peridynamics/fracture/SpringWindow.h"

#include <algorithm>

namespace lamella::peridynamics
{
namespace
{

constexpr std::size_t mostOffsets = 1100; // half of the bonds of a node in space, at a horizon of eight

} // namespace

Box grown(const Box& box, int by, const NodeLayout& layout)
{
  Box b;
  for (std::size_t a = 0; a < 3; ++a)
  {
    const bool flat = a >= static_cast<std::size_t>(layout.dimension);
    b.low[a] = flat ? 0 : std::max<std::int64_t>(0, box.low[a] - by);
    b.high[a] = flat ? 1 : std::min(layout.size[a], box.high[a] + by);
  }
  b.low[0] = b.low[0] / eventLanes * eventLanes;
  b.high[0] = (b.high[0] + eventLanes - 1) / eventLanes * eventLanes;
  return b;
}

Box parents(const Box& fine, const NodeLayout& coarse)
{
  Box b;
  for (std::size_t a = 0; a < 3; ++a)
  {
    b.low[a] = fine.low[a] / 2;
    b.high[a] = std::min(coarse.size[a], fine.high[a] / 2 + 1);
  }
  return grown(b, 0, coarse);
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

void SpringWindow::product(
  const WindowField& u, const WindowField& out, std::int64_t y, std::int64_t z, std::int64_t low, std::int64_t high)
{
  const NodeLayout& l = u.field.layout();
  if (l.pitch != pitch_ || l.rowsY() != rowsY_)
  {
    pitch_ = l.pitch;
    rowsY_ = l.rowsY();
    jumps_.clear();
    for (const auto& s : steps_)
      jumps_.push_back(s[0] + pitch_ * (s[1] + rowsY_ * s[2]));
  }
  const float* spring[mostOffsets];
  const float* back[mostOffsets];
  SpringRows rows{};
  rows.count = static_cast<int>(count_);
  rows.jump = jumps_.data();
  for (std::int64_t o = 0; o < count_; ++o)
  {
    const auto& s = steps_[static_cast<std::size_t>(o)];
    spring[o] = values_.data() + rowOf(y, z) + o * width_ + low - rows_.low[0];
    back[o] = values_.data() + rowOf(y - s[1], z - s[2]) + o * width_ + low - s[0] - rows_.low[0];
  }
  rows.spring = spring;
  rows.back = back;
  for (int c = 0; c < dimension_; ++c)
  {
    rows.here[c] = u.row(c, low, y, z);
    rows.out[c] = out.row(c, low, y, z);
    rows.direction[c] = directions_[static_cast<std::size_t>(c)].data();
  }
  eventKernels().springs(dimension_, high - low, rows);
}

} // namespace lamella::peridynamics
