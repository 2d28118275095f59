#include "peridynamics/multigrid/Galerkin.h"

#include "peridynamics/multigrid/Fold.h"

#include <algorithm>
#include <cmath>

namespace lamella::peridynamics
{
namespace
{

/// What a fine block adds to a coarse one: the fine node is 2X + parity; the coarse block lies at X + shift.
struct Term
{
  int parityX;
  int shiftX;
  int target; ///< index into Level::half; -1 the diagonal
  float weight;
  bool seamX; ///< of the blocks whose step is shorter by one, see Fold
};

/// Terms of the fine rows (2(Y − shiftY) + parityY, 2(Z − shiftZ) + parityZ) in coarse row (Y, Z).
struct Group
{
  int parityY;
  int shiftY;
  int parityZ;
  int shiftZ;
  std::vector<Term> terms;
};

struct Parent
{
  int step;
  float weight;
};

std::vector<Parent> parents(int position) // of a fine node at 2·0 + position
{
  const int base = position >= 0 ? position / 2 : -((1 - position) / 2);
  if (position - 2 * base == 0)
    return { { base, 1.0F } };
  return { { base, 0.5F }, { base + 1, 0.5F } };
}

class Terms
{
public:
  Terms(int dimension, const std::vector<std::array<int, 3>>& half)
    : dimension_(dimension)
    , half_(half)
  {
  }

  /// Adds to groups. A step of nothing: the block of a node with itself, or with `twice` of two nodes that count as
  /// one, A(i, j) and A(j, i) both.
  void addTo(std::vector<Group>& groups, const std::array<int, 3>& step, bool twice, bool seamX) const
  {
    for (int pz = 0; pz < (dimension_ == 3 ? 2 : 1); ++pz)
      for (int py = 0; py < 2; ++py)
        for (int px = 0; px < 2; ++px)
          add(groups, { px, py, pz }, step, twice ? 2.0F : 1.0F, seamX);
  }

private:
  void add(std::vector<Group>& groups, const std::array<int, 3>& parity, const std::array<int, 3>& step, float factor,
    bool seamX) const
  {
    const bool self = step == std::array{ 0, 0, 0 };
    std::array<std::vector<Parent>, 3> from;
    std::array<std::vector<Parent>, 3> to;
    for (std::size_t a = 0; a < 3; ++a)
    {
      from[a] = parents(parity[a]);
      to[a] = parents(parity[a] + step[a]);
    }
    for (const Parent& fz : from[2])
      for (const Parent& fy : from[1])
        for (const Parent& fx : from[0])
          for (const Parent& tz : to[2])
            for (const Parent& ty : to[1])
              for (const Parent& tx : to[0])
              {
                float weight = fx.weight * fy.weight * fz.weight * tx.weight * ty.weight * tz.weight;
                if (self)
                  weight *= factor;
                std::array<int, 3> at{ fx.step, fy.step, fz.step };
                std::array<int, 3> reach{ tx.step - fx.step, ty.step - fy.step, tz.step - fz.step };
                int sign = reach[2] != 0 ? reach[2] : reach[1] != 0 ? reach[1] : reach[0];
                if (self && sign < 0)
                  continue; // its mirror image is stored
                if (sign < 0)
                {
                  at = { tx.step, ty.step, tz.step };
                  for (int& r : reach)
                    r = -r;
                }
                int target = -1;
                if (sign != 0)
                  target = static_cast<int>(std::find(half_.begin(), half_.end(), reach) - half_.begin());
                else if (!self)
                  weight *= 2; // A(i, j) and A(j, i) both
                place(groups, parity, at, { parity[0], at[0], target, weight, seamX });
              }
  }

  static void place(
    std::vector<Group>& groups, const std::array<int, 3>& parity, const std::array<int, 3>& at, const Term& term)
  {
    auto found = std::find_if(groups.begin(), groups.end(),
      [&](const Group& g)
      { return g.parityY == parity[1] && g.shiftY == at[1] && g.parityZ == parity[2] && g.shiftZ == at[2]; });
    if (found == groups.end())
      found = groups.insert(groups.end(), { parity[1], at[1], parity[2], at[2], {} });
    for (Term& t : found->terms)
      if (t.parityX == term.parityX && t.shiftX == term.shiftX && t.target == term.target && t.seamX == term.seamX)
      {
        t.weight += term.weight;
        return;
      }
    found->terms.push_back(term);
  }

  int dimension_;
  const std::vector<std::array<int, 3>>& half_;
};

/// What blocks of one neighbour add, by whether its steps along y and z are shorter by one.
struct Variant
{
  bool seamY = false;
  bool seamZ = false;
  std::vector<Group> groups;
};

/// Positions of a fine row, split by parity, whose values are not zero: [first, last).
struct Range
{
  std::int64_t first;
  std::int64_t last;
};

/// One coarse row: sums of weighted fine rows.
class RowSum
{
public:
  RowSum(const MatrixRows& rows, const NodeLayout& fine, const std::array<Fold, 3>& folds, Level& coarse,
    const std::vector<std::vector<Variant>>& variants)
    : rows_(rows)
    , fine_(fine)
    , folds_(folds)
    , coarse_(coarse)
    , variants_(variants)
    , entries_(coarse.entries())
    , stride_((fine.size[0] + 15) / 16 * 16)
    , natural_(static_cast<std::size_t>(stride_ * entries_))
    , folded_(natural_.size())
    , split_(static_cast<std::size_t>(2 * stride_ * entries_))
    , seam_(split_.size())
    , sums_((coarse.half.size() + 1) * static_cast<std::size_t>(coarse.layout.bufferLength()))
    , touched_(coarse.half.size() + 1, 0)
    , whole_(coarse.packed() ? coarse.half.size() * static_cast<std::size_t>(entries_ * coarse.layout.size[0]) : 0)
  {
  }

  void add(std::int64_t y, std::int64_t z)
  {
    const int neighbours = static_cast<int>(rows_.neighbours.size());
    for (int q = 0; q <= neighbours; ++q) // the last is the diagonal
    {
      for (const Variant& v : variants_[static_cast<std::size_t>(q)])
        for (const Group& g : v.groups)
        {
          const std::int64_t atY = 2 * (y - g.shiftY) + g.parityY;
          const std::int64_t atZ = fine_.dimension == 3 ? 2 * (z - g.shiftZ) + g.parityZ : 0;
          if (atY < 0 || atY >= folds_[1].positions() || atZ < 0 || atZ >= folds_[2].positions())
            continue;
          for (std::int64_t fineZ = atZ; fineZ <= lastAt(2, atZ); ++fineZ)
            for (std::int64_t fineY = atY; fineY <= lastAt(1, atY); ++fineY)
              addRow(q, v, g, y, z, fineY, fineZ);
        }
      if (rows_.channels == 1 && q < neighbours)
        expand(rows_.neighbours[static_cast<std::size_t>(q)].tensor, y, z);
    }
    if (whole_.empty())
      return;
    const std::int64_t n = coarse_.layout.size[0];
    for (int c = 0; c < static_cast<int>(coarse_.half.size()) * entries_; ++c)
      coarse_.pack(c, y, z, whole_.data() + c * n);
    std::fill(whole_.begin(), whole_.end(), 0.0F);
  }

private:
  /// The last of the own nodes at a position.
  [[nodiscard]] std::int64_t lastAt(std::size_t axis, std::int64_t position) const noexcept
  {
    return folds_[axis].here() && position == folds_[axis].own - 2 ? position + 1 : position;
  }

  void addRow(
    int q, const Variant& v, const Group& g, std::int64_t y, std::int64_t z, std::int64_t fineY, std::int64_t fineZ)
  {
    const bool self = q == static_cast<int>(rows_.neighbours.size());
    const std::array<int, 3> step = self ? std::array{ 0, 0, 0 } : rows_.neighbours[static_cast<std::size_t>(q)].step;
    if (folds_[1].shortens(fineY, step[1]) != v.seamY || folds_[2].shortens(fineZ, step[2]) != v.seamZ)
      return;
    const int channels = self ? entries_ : rows_.channels;
    if (self)
      rows_.diagonal(fineY, fineZ, natural_.data(), stride_);
    else if (!rows_.block(q, fineY, fineZ, natural_.data(), stride_))
      return;
    const std::int64_t n = folds_[0].positions();
    if (!folds_[0].here())
      split(natural_, channels, n, split_);
    else
      fold(channels, step[0]);
    const Range all{ 0, n };
    for (const Term& t : g.terms)
      if (!t.seamX)
        accumulate(t, split_, all, channels, y, z, channels == 1 && !self);
      else
        for (const Range& range : seams_)
          accumulate(t, seam_, range, channels, y, z, channels == 1 && !self);
  }

  static Range halves(const Range& r, int parity) // [first, last) of the nodes 2i + parity
  {
    return { (r.first + 1 - parity) / 2, (r.last + 1 - parity) / 2 };
  }

  void split(const std::vector<float>& natural, int channels, std::int64_t n, std::vector<float>& out)
  {
    for (int c = 0; c < channels; ++c)
    {
      const float* from = natural.data() + c * stride_;
      float* even = out.data() + 2 * c * stride_;
      float* odd = even + stride_;
      for (std::int64_t i = 0; i < n / 2; ++i)
      {
        even[i] = from[2 * i];
        odd[i] = from[2 * i + 1];
      }
      if (n % 2 != 0)
        even[n / 2] = from[n - 1];
    }
  }

  /// The row by positions, and apart from it what its shorter steps hold.
  void fold(int channels, int step)
  {
    const std::int64_t n = folds_[0].own;
    const std::int64_t length = std::abs(step);
    seams_.clear();
    if (step > 0)
      seams_ = { { std::max<std::int64_t>(0, n - 1 - length), n - 1 } };
    else if (step < 0)
      seams_ = { { 0, std::min(length - 1, n - 2) }, { n - 2, n - 1 } };
    for (int c = 0; c < channels; ++c)
    {
      float* row = natural_.data() + c * stride_;
      float* apart = folded_.data() + c * stride_;
      std::fill_n(apart, n, 0.0F);
      for (const Range& r : seams_)
        for (std::int64_t i = r.first; i < r.last; ++i)
          if (folds_[0].shortens(i, step))
            std::swap(apart[i], row[i]);
      if (folds_[0].shortens(n - 1, step))
        apart[n - 2] += row[n - 1];
      else
        row[n - 2] += row[n - 1];
    }
    split(natural_, channels, n - 1, split_);
    if (!seams_.empty())
      split(folded_, channels, n - 1, seam_);
  }

  // to a sum of scalars, or straight to the entries
  void accumulate(const Term& t, const std::vector<float>& values, const Range& range, int channels, std::int64_t y,
    std::int64_t z, bool scalars)
  {
    const Range part = halves(range, t.parityX);
    if (part.first >= part.last)
      return;
    for (int c = 0; c < channels; ++c)
    {
      const float* from = values.data() + (2 * c + t.parityX) * stride_ + part.first;
      const Range at{ t.shiftX + part.first, t.shiftX + part.last };
      if (!scalars)
      {
        add(t.target, c, y, z, at, t.weight, from);
        continue;
      }
      const auto slot = static_cast<std::size_t>(t.target + 1);
      float* to = sums_.data() + static_cast<std::int64_t>(slot) * coarse_.layout.bufferLength();
      if (touched_[slot] == 0)
      {
        touched_[slot] = 1;
        std::fill_n(to, coarse_.layout.bufferLength(), 0.0F);
      }
      levelKernels().axpy(at.last - at.first, t.weight, from, to + NodeLayout::margin + at.first);
    }
  }

  void expand(const std::array<float, 6>& tensor, std::int64_t y, std::int64_t z)
  {
    const NodeLayout& l = coarse_.layout;
    for (std::size_t slot = 0; slot < touched_.size(); ++slot)
    {
      if (touched_[slot] == 0)
        continue;
      touched_[slot] = 0;
      const float* from =
        sums_.data() + static_cast<std::int64_t>(slot) * l.bufferLength() + NodeLayout::margin - l.ghost;
      for (int e = 0; e < entries_; ++e)
        if (tensor[static_cast<std::size_t>(e)] != 0)
          add(static_cast<int>(slot) - 1, e, y, z, { -l.ghost, l.size[0] + l.ghost },
            tensor[static_cast<std::size_t>(e)], from);
    }
  }

  /// Adds weight times some values to an entry of coarse row (y, z). What lies before and after the own nodes is zero
  /// where sides across x are not periodic.
  void add(int target, int e, std::int64_t y, std::int64_t z, Range at, float weight, const float* from)
  {
    if (coarse_.layout.before == 0)
    {
      const std::int64_t first = at.first;
      at = { std::max<std::int64_t>(at.first, 0), std::min(at.last, coarse_.layout.size[0]) };
      if (at.first >= at.last)
        return;
      from += at.first - first;
    }
    const std::int64_t i = coarse_.layout.index(0, y, z);
    float* row = target < 0 ? coarse_.diagonal.component(e) + i
      : coarse_.packed()    ? whole_.data() + (target * entries_ + e) * coarse_.layout.size[0]
                            : &coarse_.block(target * entries_ + e, i);
    levelKernels().axpy(at.last - at.first, weight, from, row + at.first);
  }

  const MatrixRows& rows_;
  const NodeLayout& fine_;
  const std::array<Fold, 3>& folds_;
  Level& coarse_;
  const std::vector<std::vector<Variant>>& variants_;
  int entries_;
  std::int64_t stride_;
  std::vector<float> natural_; ///< channels of a fine row
  std::vector<float> folded_;  ///< its blocks with shorter steps along x, by position
  std::vector<float> split_;   ///< even nodes, odd nodes of each
  std::vector<float> seam_;    ///< likewise
  std::vector<Range> seams_;   ///< where that is not zero
  std::vector<float> sums_;    ///< a coarse row for the diagonal and each neighbour
  std::vector<char> touched_;
  std::vector<float> whole_; ///< the blocks of a row before they are packed
};

/// What the blocks of a step add. Where nothing is folded there is one variant.
std::vector<Variant> variantsOf(const Terms& terms, const std::array<Fold, 3>& folds, const std::array<int, 3>& step)
{
  const auto ways = [&](std::size_t axis) { return folds[axis].global > 0 && step[axis] != 0 ? 2 : 1; };
  std::vector<Variant> variants;
  for (int z = 0; z < ways(2); ++z)
    for (int y = 0; y < ways(1); ++y)
    {
      Variant v{ y != 0, z != 0, {} };
      for (int x = 0; x < ways(0); ++x)
      {
        const std::array<int, 3> to{ x != 0 ? shorter(step[0]) : step[0], y != 0 ? shorter(step[1]) : step[1],
          z != 0 ? shorter(step[2]) : step[2] };
        terms.addTo(v.groups, to, step != std::array{ 0, 0, 0 }, x != 0);
      }
      variants.push_back(std::move(v));
    }
  return variants;
}

/// Those of the coarse forward neighbours to which blocks of the fine ones add: at a horizon of three the corners of
/// the cube lie beyond.
std::vector<std::array<int, 3>> reachedNeighbours(const MatrixRows& rows, int dimension, int reach)
{
  std::vector<std::array<int, 3>> half = forwardNeighbours(dimension, reach);
  std::vector<char> reached(half.size(), 0);
  const auto shifts = [](int step) // from the parents of a node to those of another, along an axis
  {
    std::vector<int> all;
    for (int parity = 0; parity < 2; ++parity)
      for (const Parent& from : parents(parity))
        for (const Parent& to : parents(parity + step))
          if (std::find(all.begin(), all.end(), to.step - from.step) == all.end())
            all.push_back(to.step - from.step);
    return all;
  };
  const auto reachFrom = [&](const std::array<int, 3>& step)
  {
    for (const int z : dimension == 3 ? shifts(step[2]) : std::vector<int>{ 0 })
      for (const int y : shifts(step[1]))
        for (const int x : shifts(step[0]))
        {
          const int sign = z != 0 ? z : y != 0 ? y : x;
          if (sign != 0)
            reached[static_cast<std::size_t>(
              forwardIndex(reach, sign > 0 ? std::array{ x, y, z } : std::array{ -x, -y, -z }))] = 1;
        }
  };
  reachFrom({ 0, 0, 0 });
  for (const MatrixRows::Neighbour& q : rows.neighbours)
    reachFrom(q.step);
  std::size_t kept = 0;
  for (std::size_t q = 0; q < half.size(); ++q)
    if (reached[q] != 0)
      half[kept++] = half[q];
  half.resize(kept);
  return half;
}

/// What numbers of the packed matrix count in. By Cauchy and Schwarz no block is larger than the root of the diagonal
/// ones at its ends, and these are about the sum of the fine ones' by the squares of their weights; a number that is
/// larger all the same is cut off, as those of the springs are that hold fixed components.
void findScale(const MatrixRows& rows, const NodeLayout& fine, Level& coarse)
{
  constexpr float largest = 1.0F / 32767;
  const NodeLayout& l = coarse.layout;
  const std::int64_t reachZ = l.dimension == 3 ? 1 : 0;
#pragma omp parallel if (fine.owned() >= worthThreads)
  {
    std::vector<float> held(static_cast<std::size_t>(fine.size[0]));
    std::vector<float> sum(static_cast<std::size_t>(l.size[0]) + 1);
#pragma omp for schedule(static)
    for (std::int64_t row = 0; row < l.size[1] * l.size[2]; ++row)
    {
      const std::int64_t y = row % l.size[1];
      const std::int64_t z = row / l.size[1];
      std::fill(sum.begin(), sum.end(), 0.0F);
      for (std::int64_t dz = -reachZ; dz <= reachZ; ++dz)
        for (std::int64_t dy = -1; dy <= 1; ++dy)
        {
          const std::int64_t fineY = 2 * y + dy;
          const std::int64_t fineZ = 2 * z + dz;
          if (fineY < 0 || fineY >= fine.size[1] || fineZ < 0 || fineZ >= fine.size[2])
            continue;
          rows.stiffness(fineY, fineZ, held.data());
          const float weight = (dy == 0 ? 1.0F : 0.25F) * (dz == 0 ? 1.0F : 0.25F);
          for (std::size_t x = 0; x < held.size(); ++x)
          {
            const float part = weight * held[x];
            sum[x / 2] += x % 2 == 0 ? part : 0.25F * part;
            sum[x / 2 + 1] += x % 2 == 0 ? 0 : 0.25F * part;
          }
        }
      float* to = coarse.scale.component(0) + l.index(0, y, z);
      for (std::int64_t x = 0; x < l.size[0]; ++x)
        to[x] = std::sqrt(largest * sum[static_cast<std::size_t>(x)]);
    }
  }
}

} // namespace

void galerkinProduct(const MatrixRows& rows, const NodeLayout& fine, Level& coarse, bool packed)
{
  const NodeLayout& l = coarse.layout;
  coarse.half = packed ? reachedNeighbours(rows, l.dimension, l.ghost) : forwardNeighbours(l.dimension, l.ghost);
  coarse.allocateMatrix(packed);
  if (coarse.packed())
    findScale(rows, fine, coarse);
  const Terms terms(l.dimension, coarse.half);
  const std::array<Fold, 3> folds{ Fold(fine, coarse.periodic, 0), Fold(fine, coarse.periodic, 1),
    Fold(fine, coarse.periodic, 2) };
  std::vector<std::vector<Variant>> variants;
  for (const auto& q : rows.neighbours)
    variants.push_back(variantsOf(terms, folds, q.step));
  variants.push_back(variantsOf(terms, folds, { 0, 0, 0 }));

  // Of the slowest axis the high side of the rim takes part: a fine row has parents there. Of y in space both do.
  const bool space = l.dimension == 3;
  const bool rim = !coarse.rimless();
  const std::int64_t lowY = rim && space ? -l.ghost : 0;
  const std::int64_t highY = l.size[1] + (!rim ? 0 : space ? l.ghost : 1);
  const std::int64_t highZ = l.size[2] + (rim && space ? 1 : 0);
  const std::int64_t count = (highY - lowY) * highZ;
#pragma omp parallel if (fine.owned() >= worthThreads)
  {
    RowSum sum(rows, fine, folds, coarse, variants);
#pragma omp for schedule(dynamic, 4)
    for (std::int64_t i = 0; i < count; ++i)
      sum.add(lowY + i % (highY - lowY), i / (highY - lowY));
  }
  if (rim)
    for (NodeField<float>* f : { &coarse.blocks, &coarse.diagonal })
    {
      coarse.rim.addBack(*f);
      coarse.rim.fill(*f);
    }
}

MatrixRows rowsOf(const Level& level)
{
  MatrixRows rows;
  for (const auto& step : level.half)
  {
    rows.neighbours.push_back({ step, {} });
    for (const int s : step)
      rows.reach = std::max(rows.reach, std::abs(s));
  }
  rows.channels = level.entries();
  rows.block = [&level](int q, std::int64_t y, std::int64_t z, float* out, std::int64_t stride)
  {
    const NodeLayout& l = level.layout;
    for (int e = 0; e < level.entries(); ++e)
    {
      const int component = q * level.entries() + e;
      const std::int64_t i = l.index(0, y, z);
      if (level.packed())
        for (std::int64_t x = 0; x < l.size[0]; ++x)
          out[e * stride + x] = level.value(component, i + x);
      else
        std::copy_n(&level.block(component, i), l.size[0], out + e * stride);
    }
    return true;
  };
  rows.stiffness = [&level](std::int64_t y, std::int64_t z, float* out)
  {
    const NodeLayout& l = level.layout;
    const std::int64_t first = l.index(0, y, z);
    for (std::int64_t x = 0; x < l.size[0]; ++x)
      if (level.packed()) // without the springs that hold fixed components; coarse nodes take each other along
        out[x] = 2 * 32767 * level.scale.component(0)[first + x] * level.scale.component(0)[first + x];
      else
      {
        out[x] = 0;
        for (int c = 0; c < l.dimension; ++c)
          out[x] = std::max(out[x], level.diagonal.component(c)[first + x]);
      }
  };
  rows.diagonal = [&level](std::int64_t y, std::int64_t z, float* out, std::int64_t stride)
  {
    const NodeLayout& l = level.layout;
    for (int e = 0; e < level.entries(); ++e)
      std::copy_n(level.diagonal.component(e) + l.index(0, y, z), l.size[0], out + e * stride);
  };
  return rows;
}

} // namespace lamella::peridynamics
