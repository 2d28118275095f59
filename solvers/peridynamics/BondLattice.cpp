#include "peridynamics/BondLattice.h"

#include "peridynamics/RimExchange.h"
#include "peridynamics/kernels/RowKernels.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lamella::peridynamics
{

std::int64_t BondLattice::bytes() const noexcept
{
  return 4 * bits_.size() + strips_.size() + solid_.size() + (corrected_ ? 4 * layout_.count() * dimension() : 0);
}

double BondLattice::springConstant(std::int64_t index, int offset) const noexcept
{
  return springConstant(index, offset, kind(index, offset));
}

double BondLattice::springConstant(std::int64_t index, int offset, int k) const noexcept
{
  if (k == 0)
    return 0;
  const Offset& o = stencil_.half()[static_cast<std::size_t>(offset)];
  const double spring = o.weight * kinds_[static_cast<std::size_t>(k)].stiffness / (o.length * spacing_);
  if (!corrected_)
    return spring;
  double square = 0;
  for (int c = 0; c < dimension(); ++c)
  {
    const double n = o.step[static_cast<std::size_t>(c)] / o.length;
    square += 0.5 * n * n * (double{ shares(c)[index] } + double{ shares(c)[index + jump(offset)] });
  }
  return spring / std::sqrt(square);
}

int BondLattice::degree(std::int64_t index) const noexcept
{
  int count = 0;
  for (int o = 0; o < static_cast<int>(jump_.size()); ++o)
    count += (kind(index, o) != 0 ? 1 : 0) + (kind(index - jump(o), o) != 0 ? 1 : 0);
  return count;
}

StripCounts BondLattice::strips() const noexcept
{
  StripCounts counts;
  const std::int64_t n = (layout_.size[0] + 15) / 16;
  for (std::int64_t z = 0; z < layout_.size[2]; ++z)
    for (std::int64_t y = 0; y < layout_.size[1]; ++y)
    {
      const std::uint8_t* s = stripsOf(layout_.row(y, z)) + layout_.before / 16;
      for (std::int64_t i = 0; i < n; ++i)
        ++(s[i] == 0 ? counts.empty : s[i] == 255 ? counts.mixed : counts.uniform);
    }
  return counts;
}

Bond BondLattice::bond(std::int64_t index, int offset) const noexcept
{
  Bond b{ layout_.node(index), offset };
  for (std::size_t a = 0; a < 3; ++a)
  {
    b.node[a] += layout_.start[a];
    if (periodic_[a])
      b.node[a] = (b.node[a] + layout_.global[a]) % layout_.global[a];
  }
  return b;
}

NodeField<float> BondLattice::fieldOf(std::span<const std::uint8_t> numbers) const
{
  NodeField<float> field(layout_, 1);
  std::size_t k = 0;
  for (std::int64_t z = 0; z < layout_.size[2]; ++z)
    for (std::int64_t y = 0; y < layout_.size[1]; ++y)
      for (std::int64_t x = 0; x < layout_.size[0]; ++x)
        field.at(0, x, y, z) = numbers[k++];
  exchange(field);
  return field;
}

template <class Real>
void BondLattice::exchange(NodeField<Real>& field) const
{
  startExchange(field).finish();
}
template <class Real>
RimInFlight<Real> BondLattice::startExchange(NodeField<Real>& field) const
{
  std::vector<Real*> arrays;
  for (int c = 0; c < field.components(); ++c)
    arrays.push_back(field.component(c));
  return RimInFlight<Real>(layout_, periodic_, *comm_, arrays);
}
template RimInFlight<double> BondLattice::startExchange(NodeField<double>&) const;
template RimInFlight<float> BondLattice::startExchange(NodeField<float>&) const;
template void BondLattice::exchange(NodeField<double>&) const;
template void BondLattice::exchange(NodeField<float>&) const;

void BondLattice::classify(std::int64_t row, std::int64_t strip)
{
  const int count = static_cast<int>(jump_.size());
  const std::int64_t begin = layout_.begin(row) + strip * 16;
  // every plane must be all ones or all zeros over the strip and over all bonds
  int code = 0;
  bool some = false;
  bool mixed = false;
  for (int p = 0; p < planes_; ++p)
  {
    std::uint32_t all = ~0U;
    std::uint32_t any = 0;
    for (int w = 0; w < words_; ++w)
    {
      const int used = std::min(32, count - 32 * w);
      const std::uint32_t unused = used == 32 ? 0 : ~0U << used;
      const std::uint32_t* bits = plane(p, w) + begin;
      for (int x = 0; x < 16; ++x)
      {
        all &= bits[x] | unused;
        any |= bits[x];
      }
    }
    some = some || any != 0;
    if (all == ~0U)
      code |= 1 << p;
    else if (any != 0)
      mixed = true;
  }
  if (some && !mixed && corrected_)
    for (std::int64_t i = begin; i < begin + 16 && !mixed; ++i)
      for (int o = 0; o < count && !mixed; ++o)
        for (int c = 0; c < dimension(); ++c)
          mixed = mixed || shares(c)[i] != 1.0F || shares(c)[i + jump(o)] != 1.0F;
  strips_[row * (layout_.pitch / 16) + strip] = static_cast<std::uint8_t>(!some ? 0
      : mixed || code == 255                                                    ? 255
                                                                                : code);
}

std::int64_t BondLattice::put(const Bond& bond, int kind)
{
  // all images of the first node that lie in this rank's rim or block
  std::int64_t owned = 0;
  const auto shifts = [&](std::size_t a) { return periodic_[a] ? 1 : 0; };
  for (int sz = -shifts(2); sz <= shifts(2); ++sz)
    for (int sy = -shifts(1); sy <= shifts(1); ++sy)
      for (int sx = -shifts(0); sx <= shifts(0); ++sx)
      {
        const std::array<int, 3> s{ sx, sy, sz };
        std::array<std::int64_t, 3> n{};
        bool here = true;
        for (std::size_t a = 0; a < 3; ++a)
        {
          const std::int64_t rim = a == 2 ? layout_.ghostZ() : layout_.ghost;
          n[a] = bond.node[a] + s[a] * layout_.global[a] - layout_.start[a];
          here = here && n[a] >= -rim && n[a] < layout_.size[a] + rim;
        }
        if (!here)
          continue;
        const std::int64_t i = layout_.index(n[0], n[1], n[2]);
        if (this->kind(i, bond.offset) == kind)
          continue;
        const std::uint32_t bit = 1U << (bond.offset & 31);
        for (int p = 0; p < planes_; ++p)
        {
          std::uint32_t& word = bits_[(p * words_ + (bond.offset >> 5)) * layout_.count() + i];
          word = (kind >> p & 1) != 0 ? word | bit : word & ~bit;
        }
        classify(layout_.rowOf(i), (layout_.xOf(i) + layout_.before) / 16);
        owned += layout_.ownedNode(n) ? 1 : 0;
      }
  return owned;
}

void BondLattice::breakKnown(const Bond& bond)
{
  put(bond, 0);
  --bonds_;
}

namespace
{

/// Rows of all ranks, one after another as they lie in the whole layout. @param begin of the first one
template <class T>
AlignedArray<T> rowsOfAll(const Communicator& comm, const NodeLayout& part, const NodeLayout& all, const T* mine,
  std::int64_t rowLength, std::int64_t begin)
{
  AlignedArray<T> rows(all.rows() * rowLength + begin);
  const bool space = part.dimension == 3;
  const std::int64_t layer = space ? part.rowsY() : 1;
  MPI_Datatype row = MPI_DATATYPE_NULL; // counts in rows: longer arrays before an int overflows
  MPI_Type_contiguous(static_cast<int>(rowLength * static_cast<std::int64_t>(sizeof(T))), MPI_BYTE, &row);
  MPI_Type_commit(&row);
  const int own = static_cast<int>(part.size[space ? 2 : 1] * layer);
  std::vector<int> counts(static_cast<std::size_t>(comm.size()));
  MPI_Allgather(&own, 1, MPI_INT, counts.data(), 1, MPI_INT, comm.handle());
  std::vector<int> begins(counts.size(), 0);
  std::partial_sum(counts.begin(), counts.end() - 1, begins.begin() + 1);
  const std::int64_t first = begin + part.ghost * layer * rowLength; // the rim before the first layer
  MPI_Allgatherv(mine + first, own, row, rows.data() + first, counts.data(), begins.data(), row, comm.handle());
  MPI_Type_free(&row);
  return rows;
}

} // namespace

BondLattice BondLattice::whole(const Communicator& alone) const
{
  BondLattice all(*this);
  if (!comm_->parallel())
    return all;
  all.comm_ = &alone;
  all.layout_ = NodeLayout::make(layout_.dimension, layout_.ghost, layout_.global, {}, layout_.global, periodic_[0]);
  const std::int64_t here = layout_.count();
  const std::int64_t there = all.layout_.count();
  all.bits_ = AlignedArray<std::uint32_t>(there * planes_ * words_);
  for (std::int64_t p = 0; p < planes_ * words_; ++p)
  {
    const auto plane =
      rowsOfAll(*comm_, layout_, all.layout_, bits_.data() + p * here, layout_.pitch, layout_.begin(0));
    std::copy_n(plane.data(), there, all.bits_.data() + p * there);
  }
  all.strips_ = rowsOfAll(*comm_, layout_, all.layout_, strips_.data(), layout_.pitch / 16, 0);
  all.solid_ = rowsOfAll(*comm_, layout_, all.layout_, solid_.data(), layout_.pitch, layout_.begin(0));
  if (corrected_)
  {
    all.shares_ = NodeField<float>(all.layout_, shares_.components());
    for (int c = 0; c < shares_.components(); ++c)
      std::copy_n(rowsOfAll(*comm_, layout_, all.layout_, shares_.component(c), layout_.pitch, layout_.begin(0)).data(),
        there, all.shares_.component(c));
  }
  return all;
}

std::int64_t BondLattice::putAll(std::vector<std::int64_t> mine)
{
  // every rank hears of all: breaks are few, and their order does not matter
  if (comm_->parallel())
  {
    const std::vector<std::int64_t> all = gather(*comm_, mine, 5);
    mine.assign(all.begin(), all.end());
  }
  std::int64_t changed = 0;
  for (std::size_t k = 0; k < mine.size(); k += 5)
    changed +=
      put({ { mine[k], mine[k + 1], mine[k + 2] }, static_cast<int>(mine[k + 3]) }, static_cast<int>(mine[k + 4]));
  return comm_->parallel() ? comm_->sum(changed) : changed;
}

std::int64_t BondLattice::breakBonds(std::span<const Bond> bonds)
{
  std::vector<std::int64_t> mine;
  for (const Bond& b : bonds)
    mine.insert(mine.end(), { b.node[0], b.node[1], b.node[2], b.offset, 0 });
  const std::int64_t broken = putAll(std::move(mine));
  bonds_ -= broken;
  return broken;
}

std::int64_t BondLattice::restoreBonds(std::span<const KnownBond> bonds)
{
  std::vector<std::int64_t> mine;
  for (const KnownBond& b : bonds)
    mine.insert(mine.end(), { b.bond.node[0], b.bond.node[1], b.bond.node[2], b.bond.offset, b.kind });
  const std::int64_t restored = putAll(std::move(mine));
  bonds_ += restored;
  return restored;
}

} // namespace lamella::peridynamics
