#include "peridynamics/multigrid/Level.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace lamella::peridynamics
{

void Level::allocateVectors()
{
  inverse = NodeField<float>(layout, entries());
  x = NodeField<float>(layout);
  r = NodeField<float>(layout);
  d = NodeField<float>(layout);
  findJumps();
}

bool Level::rimless() const noexcept
{
  return !comm->parallel() &&
    std::none_of(
      periodic.begin(), periodic.end(), [](bool p) { return p; });
}

void Level::allocateMatrix(bool packed)
{
  diagonal = NodeField<float>(layout, entries());
  tight_ = rimless();
  if (packed && tight_)
  {
    pitch_ = rimlessPitch(layout);
    numbers_ = AlignedArray<std::int16_t>(rimlessNodes(layout) * components());
    scale = NodeField<float>(layout, 1);
    findJumps();
    return;
  }
  if (!tight_)
  {
    blocks = NodeField<float>(layout, static_cast<int>(components()));
    return;
  }
  pitch_ = rimlessPitch(layout);
  values_ = AlignedArray<float>(rimlessNodes(layout) * components());
}

void Level::arrange()
{
  const std::int64_t count = components();
  if (count == 0 || values_.size() > 0 || packed())
    return;
  pitch_ = layout.pitch;
  AlignedArray<float> values(count * layout.count());
  for (std::int64_t row = 0; row < layout.rows(); ++row)
    for (int c = 0; c < static_cast<int>(count); ++c)
      std::copy_n(blocks.component(c) + layout.begin(row), pitch_, values.data() + (row * count + c) * pitch_);
  values_ = std::move(values);
  blocks = NodeField<float>();
  findJumps();
}

void Level::findJumps()
{
  jumps_.clear();
  backJumps_.clear();
  const std::int64_t row = components() * pitch_;
  for (const auto& s : half)
  {
    jumps_.push_back(s[0] + layout.pitch * (s[1] + layout.rowsY() * s[2]));
    const bool ordered = values_.size() > 0 || packed();
    backJumps_.push_back(
      ordered ? s[0] + row * (s[1] + (tight_ ? layout.size[1] : layout.rowsY()) * s[2]) : jumps_.back());
  }
  const int g = layout.ghost;
  mirrored_.clear();
  for (int z = 0; z <= layout.ghostZ(); ++z)
    for (int after = 0; after <= g; ++after)
      for (int before = 0; before <= g; ++before)
        for (const auto& s : half)
          mirrored_.push_back(!tight_ || (s[1] <= before && -s[1] <= after && s[2] <= z) ? 1 : 0);
}

const std::uint8_t* Level::mirrored(std::int64_t y, std::int64_t z) const noexcept
{
  const std::int64_t g = layout.ghost;
  const std::int64_t before = std::clamp<std::int64_t>(y, 0, g);
  const std::int64_t after = std::clamp<std::int64_t>(layout.size[1] - 1 - y, 0, g);
  const std::int64_t below = std::clamp<std::int64_t>(z, 0, layout.ghostZ());
  return mirrored_.data() + (before + (g + 1) * (after + (g + 1) * below)) * static_cast<std::int64_t>(half.size());
}

void Level::pointTo(BlockRow& row, std::int64_t index) const noexcept
{
  const std::array<std::int64_t, 3> node = layout.node(index);
  row.half = static_cast<int>(half.size());
  row.jump = jumps_.data();
  row.back = backJumps_.data();
  row.mirrored = mirrored(node[1], node[2]);
  const bool ordered = values_.size() > 0 || packed();
  row.blockStride = entries() * (ordered ? pitch_ : layout.count());
  row.nextRow = ordered ? components() * pitch_ : layout.pitch;
  row.scale = packed() ? scale.component(0) + index : nullptr;
  for (int e = 0; e < entries(); ++e)
  {
    row.diagonal[e] = diagonal.component(e) + index;
    if (packed())
      row.packed[e] = numbers_.data() + place(e, index);
    else
      row.block[e] = ordered ? values_.data() + place(e, index) : blocks.component(e) + index;
  }
}

float Level::unpack(int component, std::int64_t index, float number) const noexcept
{
  const std::int64_t other = index + jumps_[static_cast<std::size_t>(component / entries())];
  return number * scale.component(0)[index] * scale.component(0)[other];
}

void Level::pack(int component, std::int64_t y, std::int64_t z, const float* values)
{
  constexpr float most = 32767;
  const std::int64_t i = layout.index(0, y, z);
  const float* here = scale.component(0) + i;
  const float* there = here + jumps_[static_cast<std::size_t>(component / entries())];
  std::int16_t* to = numbers_.data() + place(component, i);
  for (std::int64_t x = 0; x < layout.size[0]; ++x)
  {
    const float unit = here[x] * there[x];
    to[x] = static_cast<std::int16_t>(unit > 0 ? std::lrint(std::clamp(values[x] / unit, -most, most)) : 0);
  }
}

void Level::addBroken(const NodeField<float>& x, NodeField<float>& out, const std::array<std::int64_t, 3>& low,
  const std::array<std::int64_t, 3>& high) const
{
  const int d = layout.dimension;
  for (const BrokenSpring& spring : broken)
  {
    bool apart = false;
    bool within = true;
    for (std::size_t a = 0; a < 3; ++a)
    {
      apart = apart || spring.high[a] <= low[a] || spring.low[a] >= high[a];
      within = within && spring.low[a] >= low[a] && spring.high[a] <= high[a];
    }
    if (apart)
      continue;
    const auto stretchOf = [&](const BrokenSpring::Node& n)
    {
      float along = 0;
      for (int c = 0; c < d; ++c)
        along += spring.direction[static_cast<std::size_t>(c)] * x.component(c)[n.index];
      return n.weight * along;
    };
    float all = 0;
    for (const BrokenSpring::Node& n : spring.nodes)
      all += stretchOf(n);
    for (const BrokenSpring::Node& n : spring.nodes)
    {
      if (!within)
      {
        const std::array<std::int64_t, 3> at = layout.node(n.index);
        bool outside = false;
        for (std::size_t a = 0; a < 3; ++a)
          outside = outside || at[a] < low[a] || at[a] >= high[a];
        if (outside)
          continue;
      }
      const float pull = spring.stiffness * n.weight * (all - stretchOf(n)); // the diagonal block knows of it
      for (int c = 0; c < d; ++c)
        out.component(c)[n.index] += pull * spring.direction[static_cast<std::size_t>(c)];
    }
  }
}

// Once for each number, whatever many springs change it: rounding then adds up no more often.
void Level::foldBroken()
{
  struct Change
  {
    std::int64_t index;
    int component;
    float value;
  };
  std::vector<Change> changes;
  const int d = layout.dimension;
  for (const BrokenSpring& spring : broken)
    for (const BrokenSpring::Node& a : spring.nodes)
      for (const BrokenSpring::Node& b : spring.nodes)
      {
        const std::array<std::int64_t, 3> from = layout.node(a.index);
        const std::array<std::int64_t, 3> to = layout.node(b.index);
        std::array<int, 3> step{};
        for (std::size_t i = 0; i < 3; ++i)
          step[i] = static_cast<int>(to[i] - from[i]);
        if ((step[2] != 0 ? step[2] : step[1] != 0 ? step[1] : step[0]) <= 0)
          continue;
        const int first = static_cast<int>(std::find(half.begin(), half.end(), step) - half.begin()) * entries();
        for (int e = 0; e < entries(); ++e)
          changes.push_back({ a.index, first + e,
            a.weight * b.weight * spring.stiffness * spring.direction[static_cast<std::size_t>(entryRow[d - 2][e])] *
              spring.direction[static_cast<std::size_t>(entryColumn[d - 2][e])] });
      }
  broken.clear();
  std::stable_sort(changes.begin(), changes.end(),
    [](const Change& a, const Change& b)
    { return a.index != b.index ? a.index < b.index : a.component < b.component; });
  for (std::size_t k = 0; k < changes.size();)
  {
    const std::int64_t i = changes[k].index;
    const int component = changes[k].component;
    float exact = value(component, i);
    for (; k < changes.size() && changes[k].index == i && changes[k].component == component; ++k)
      exact -= changes[k].value;
    const float unit = unpack(component, i, 1);
    constexpr float most = 32767;
    const float number = unit > 0 ? std::nearbyint(std::clamp(exact / unit, -most, most)) : 0;
    numbers_[place(component, i)] = static_cast<std::int16_t>(number);
    // a translation is to cost what it did
    const float rounded = number * unit - exact;
    diagonal.component(component % entries())[i] -= rounded;
    diagonal.component(component % entries())[i + jumps_[static_cast<std::size_t>(component / entries())]] -= rounded;
  }
}

std::int64_t Level::bytes() const noexcept
{
  std::int64_t components = 0;
  for (const NodeField<float>* f : { &blocks, &diagonal, &inverse, &scale, &x, &r, &d })
    components += f->layout().count() > 1 ? f->components() : 0;
  std::int64_t springs = 0;
  for (const BrokenSpring& spring : broken)
    springs += static_cast<std::int64_t>(sizeof(BrokenSpring) + spring.nodes.size() * sizeof(BrokenSpring::Node));
  return (components * layout.count() + values_.size()) * static_cast<std::int64_t>(sizeof(float)) +
    numbers_.size() * static_cast<std::int64_t>(sizeof(std::int16_t)) + springs;
}

std::vector<std::array<int, 3>> forwardNeighbours(int dimension, int reach)
{
  std::vector<std::array<int, 3>> all;
  for (int z = 0; z <= (dimension == 3 ? reach : 0); ++z)
    for (int y = -reach; y <= reach; ++y)
      for (int x = -reach; x <= reach; ++x)
        if (z > 0 || (z == 0 && (y > 0 || (y == 0 && x > 0))))
          all.push_back({ x, y, z });
  return all;
}

void subtractProduct(const Level& level, const NodeField<float>& x, NodeField<float>& out)
{
  const NodeLayout& l = level.layout;
  const int d = l.dimension;
  const LevelKernels& k = levelKernels();
  forOwnRows(level,
    [&](std::int64_t y, std::int64_t z)
    {
      BlockRow row;
      const std::int64_t i = l.index(0, y, z);
      level.pointTo(row, i);
      for (int c = 0; c < d; ++c)
      {
        row.here[c] = x.component(c) + i;
        row.out[c] = out.component(c) + i;
      }
      k.subtractProduct(d, l.size[0], row);
    });
  std::array<std::int64_t, 3> low{ 0, 0, 0 };
  std::array<std::int64_t, 3> high = l.size;
  if (level.shared)
  {
    const std::size_t slowest = d == 3 ? 2 : 1;
    low[slowest] = level.share.first();
    high[slowest] = level.share.last();
  }
  level.addBroken(x, out, low, high);
}

namespace
{

// to float at `inverse`, entry by entry; true: a direction has no inverse, but the block is not zero
template <int Dim>
bool invert(
  const std::array<double, 6>& entries, NodeField<float>& inverse, std::int64_t i, double least, double threshold)
{
  using Block = Eigen::Matrix<double, Dim, Dim>;
  constexpr int row[6] = { 0, 1, Dim == 3 ? 2 : 0, 0, 1, 0 };
  constexpr int column[6] = { 0, 1, Dim == 3 ? 2 : 1, 1, 2, 2 };
  bool singular = false;
  Block a;
  for (int e = 0; e < blockEntries(Dim); ++e)
    a(row[e], column[e]) = a(column[e], row[e]) = entries[static_cast<std::size_t>(e)];
  Block b = Block::Zero();
  const double trace = a.trace();
  if (trace > least)
  {
    // well apart from singular: det/traceᵈ bounds the smallest eigenvalue from below
    const double determinant = a.determinant();
    if (determinant > 1e-3 * std::pow(trace, Dim) && 1e-3 * trace > least)
      b = a.inverse();
    else
    {
      Eigen::SelfAdjointEigenSolver<Block> eigen;
      eigen.computeDirect(a);
      singular = !(eigen.eigenvalues()[0] > threshold * trace);
      for (int c = 0; c < Dim; ++c)
        if (eigen.eigenvalues()[c] > std::max(threshold * trace, least))
          b += eigen.eigenvectors().col(c) * eigen.eigenvectors().col(c).transpose() / eigen.eigenvalues()[c];
    }
  }
  for (int e = 0; e < blockEntries(Dim); ++e)
    inverse.component(e)[i] = static_cast<float>(b(row[e], column[e]));
  return singular;
}

template <int Dim>
std::int64_t invertRow(const NodeField<float>& blocks, NodeField<float>& inverse, std::int64_t begin, std::int64_t n,
  double least, double threshold)
{
  std::int64_t singular = 0;
  for (std::int64_t i = begin; i < begin + n; ++i)
  {
    std::array<double, 6> entries{};
    for (int e = 0; e < blockEntries(Dim); ++e)
      entries[static_cast<std::size_t>(e)] = static_cast<double>(blocks.component(e)[i]);
    singular += invert<Dim>(entries, inverse, i, least, threshold) ? 1 : 0;
  }
  return singular;
}

} // namespace

std::int64_t invertBlocks(const NodeField<float>& blocks, NodeField<float>& inverse, double least)
{
  const NodeLayout& l = blocks.layout();
  std::int64_t singular = 0;
  const std::int64_t rows = l.size[1] * l.size[2];
#pragma omp parallel for schedule(static) reduction(+ : singular) if (l.owned() >= worthThreads)
  for (std::int64_t i = 0; i < rows; ++i)
    singular += (l.dimension == 3 ? invertRow<3> : invertRow<2>)(blocks, inverse,
      l.index(0, i % l.size[1], i / l.size[1]), l.size[0], 0.0, least);
  return singular;
}

void invertBlock(const NodeField<float>& blocks, NodeField<float>& inverse, std::int64_t index, double least)
{
  (blocks.layout().dimension == 3 ? invertRow<3> : invertRow<2>)(blocks, inverse, index, 1, least, singularShare);
}

void invertBlock(const std::array<double, 6>& block, NodeField<float>& inverse, std::int64_t index)
{
  if (inverse.layout().dimension == 3)
    invert<3>(block, inverse, index, 0, singularShare);
  else
    invert<2>(block, inverse, index, 0, singularShare);
}

} // namespace lamella::peridynamics
