// From phases and grains to bits: the making of a BondLattice.
#include "core/Error.h"
#include "core/Memory.h"
#include "lattice/AxisNames.h"
#include "peridynamics/BondLattice.h"
#include "peridynamics/NotchCut.h"
#include "peridynamics/RimExchange.h"
#include "peridynamics/kernels/RowKernels.h"
#include "peridynamics/multigrid/Galerkin.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace lamella::peridynamics
{
namespace
{

void checkSize(const Lattice& lattice, const Stencil& stencil)
{
  if (lattice.dimension != stencil.dimension())
    throw ParameterError(
      fmt::format("a model of {} dimensions for a lattice of {}", stencil.dimension(), lattice.dimension),
      "plane stress and plane strain take pictures, space takes volumes");
  for (std::size_t a = 0; a < static_cast<std::size_t>(lattice.dimension); ++a)
    if (lattice.size[a] <= stencil.layers())
      throw ParameterError(fmt::format("a horizon of {} spacings does not fit into {} nodes along {}",
                             stencil.horizon(), lattice.size[a], axisNames[a]),
        "take a smaller horizon, a larger sample or a finer lattice");
}

/// Nodes between the ends of each bond that its line comes within half a spacing of, as jumps from its first node.
std::vector<std::vector<std::int64_t>> nodesBetween(const Stencil& stencil, const NodeLayout& layout)
{
  std::vector<std::vector<std::int64_t>> between;
  for (const Offset& o : stencil.half())
  {
    std::vector<std::int64_t> jumps;
    const int longest = std::max({ std::abs(o.step[0]), std::abs(o.step[1]), std::abs(o.step[2]) });
    for (int m = 1; m < longest; ++m)
    {
      // along each axis the nearest node, or both where the line runs half-way
      std::array<std::array<int, 2>, 3> at{};
      for (std::size_t a = 0; a < 3; ++a)
      {
        const int twice = 2 * m * o.step[a]; // over 2 `longest`
        const auto floorOf = [](int p, int q) { return p >= 0 ? p / q : -((-p + q - 1) / q); };
        at[a] = { floorOf(twice + longest - 1, 2 * longest), floorOf(twice + longest, 2 * longest) };
      }
      for (const int z : at[2])
        for (const int y : at[1])
          for (const int x : at[0])
            jumps.push_back((z * layout.rowsY() + y) * layout.pitch + x);
    }
    std::sort(jumps.begin(), jumps.end());
    jumps.erase(std::unique(jumps.begin(), jumps.end()), jumps.end());
    between.push_back(std::move(jumps));
  }
  return between;
}

} // namespace

Block slab(const Lattice& lattice, const Stencil& stencil, const Communicator& comm)
{
  const std::size_t axis = lattice.dimension == 3 ? 2 : 1;
  const std::int64_t n = lattice.size[axis];
  const std::int64_t ranks = comm.size();
  if (ranks > 1 && n / ranks < stencil.layers())
    throw ParameterError(fmt::format("{} ranks share {} layers along {}, less than the horizon of {} each", ranks, n,
                           axisNames[axis], stencil.layers()),
      fmt::format("run it on at most {} ranks", std::max<std::int64_t>(1, n / stencil.layers())));
  // Slabs begin at layers that can be halved often, for coarser lattices, as long as shares stay within 4 % of even, or
  // no slab is thicker than one must be. To halve them once, without which there is no multigrid, is worth a layer.
  const std::int64_t worthHalving = 2 * coarseReach(stencil.layers()); // layers: fewer cannot be
  const auto begin = [&](std::int64_t rank, int halvings)
  { return rank == ranks ? n : ((n >> halvings) * rank / ranks) << halvings; };
  int halvings = 7;
  for (bool good = false; !good && halvings > 0; halvings -= good ? 0 : 1)
  {
    good = true;
    for (std::int64_t rank = 0; rank < ranks; ++rank)
    {
      const std::int64_t layers = begin(rank + 1, halvings) - begin(rank, halvings);
      good = good && layers >= stencil.layers() &&
        (layers <= (n + ranks - 1) / ranks + (halvings == 1 && n / ranks >= worthHalving ? 1 : 0) ||
          static_cast<double>(layers) <= 1.04 * static_cast<double>(n) / static_cast<double>(ranks));
    }
  }
  Block block{ { 0, 0, 0 }, lattice.size };
  block.start[axis] = begin(comm.rank(), halvings);
  block.size[axis] = begin(comm.rank() + 1, halvings) - block.start[axis];
  return block;
}

class BondLatticeBuilder
{
public:
  BondLatticeBuilder(BondLattice& bonds, const BondModel& model, const Lattice& lattice, const BondKinds& kinds)
    : b_(bonds)
    , model_(model)
    , lattice_(lattice)
    , kinds_(kinds)
  {
  }

  void build(std::span<const std::uint8_t> phase, std::span<const std::int32_t> grain)
  {
    prepare(phase.size(), grain.size());
    spread(phase, grain);
    connect();
    phase_ = {};
    grain_ = {};
    if (b_.corrected_)
      weigh();
    for (std::size_t i = 0; i < model_.notches.size(); ++i)
      cut(NotchCut(model_.notches[i], i + 1, lattice_, b_.periodic_));
    finish();
  }

private:
  template <class F>
  void forRows(F&& f)
  {
    const std::int64_t rows = b_.layout_.rows();
#pragma omp parallel for schedule(dynamic, 16)
    for (std::int64_t r = 0; r < rows; ++r)
      f(r);
  }

  void prepare(std::size_t phases, std::size_t grains)
  {
    checkSize(lattice_, b_.stencil_);
    const Block block = slab(lattice_, b_.stencil_, *b_.comm_);
    const auto count = static_cast<std::size_t>(block.count());
    if (b_.comm_->any(phases != count || (grains != 0 && grains != count)))
      throw InputError(fmt::format("{} phases and {} grains for {} nodes", phases, grains, count),
        "give the phase of every node of the rank's slab, and the grain of every one or of none");
    b_.layout_ = NodeLayout::make(
      lattice_.dimension, b_.stencil_.layers(), block.size, block.start, lattice_.size, b_.periodic_[0]);
    b_.kinds_ = kinds_.kinds();
    b_.planes_ = std::bit_width(b_.kinds_.size() - 1);
    b_.words_ = static_cast<int>((b_.stencil_.half().size() + 31) / 32);
    b_.corrected_ = model_.surfaceCorrection;
    const double need = BondLattice::bytesNeeded(model_, lattice_, b_.comm_->size(), grains > 0);
    const auto available = static_cast<double>(availableMemory());
    if (b_.comm_->any(need > available))
      throw MemoryError(fmt::format("the bonds of {} nodes need {}, and {} are free", b_.layout_.owned(),
                          bytesText(need), bytesText(available)),
        "take a smaller sample, a smaller horizon or a coarser lattice, or more ranks");
    for (const Offset& o : b_.stencil_.half())
      b_.jump_.push_back((o.step[2] * b_.layout_.rowsY() + o.step[1]) * b_.layout_.pitch + o.step[0]);
    const std::int64_t n = b_.layout_.count();
    b_.bits_ = AlignedArray<std::uint32_t>(n * b_.planes_ * b_.words_);
    b_.strips_ = AlignedArray<std::uint8_t>(n / 16);
    b_.solid_ = AlignedArray<std::uint8_t>(n);
    phase_ = AlignedArray<std::uint8_t>(n);
    if (grains > 0)
      grain_ = AlignedArray<std::int32_t>(n);
  }

  void spread(std::span<const std::uint8_t> phase, std::span<const std::int32_t> grain)
  {
    const NodeLayout& l = b_.layout_;
    const auto [nx, ny, nz] = l.size;
    std::int64_t solid = 0;
    for (std::int64_t z = 0; z < nz; ++z)
      for (std::int64_t y = 0; y < ny; ++y)
        for (std::int64_t x = 0; x < nx; ++x)
        {
          const auto from = static_cast<std::size_t>((z * ny + y) * nx + x);
          const std::int64_t to = l.index(x, y, z);
          phase_[to] = phase[from];
          if (!grain.empty())
            grain_[to] = grain[from];
          b_.solid_[to] = kinds_.isVoid(phase[from]) ? 0 : 1;
          solid += b_.solid_[to];
        }
    b_.solidNodes_ = b_.comm_->sum(solid);
    if (b_.solidNodes_ == 0)
      throw InputError("the sample is all void", "say which phases carry bonds, or take another sample");
    exchangeRim(l, b_.periodic_, *b_.comm_, phase_.data());
    exchangeRim(l, b_.periodic_, *b_.comm_, b_.solid_.data());
    if (!grain.empty())
      exchangeRim(l, b_.periodic_, *b_.comm_, grain_.data());
  }

  /// Sets the bits of all bonds between nodes in memory, those within the rim included: a strip is then uniform on one
  /// rank where it is on another, and its sums are the same.
  void connect()
  {
    const NodeLayout& l = b_.layout_;
    const auto& half = b_.stencil_.half();
    const auto between =
      model_.voidBonds == VoidBonds::Cut ? nodesBetween(b_.stencil_, l) : std::vector<std::vector<std::int64_t>>();
    std::int64_t missing = -1; // a pair of phases without data, the greatest
    forRows(
      [&](std::int64_t row)
      {
        const std::int64_t y = row % l.rowsY() - l.ghost;
        const std::int64_t z = row / l.rowsY() - l.ghostZ();
        std::int64_t lacking = -1;
        for (std::size_t o = 0; o < half.size(); ++o)
        {
          const auto& step = half[o].step;
          if (y + step[1] < -l.ghost || y + step[1] >= l.size[1] + l.ghost || z + step[2] >= l.size[2] + l.ghostZ())
            continue;
          const std::int64_t low = std::max<std::int64_t>(-l.ghost, -l.ghost - step[0]);
          const std::int64_t high = l.size[0] + l.ghost - std::max(0, step[0]);
          const std::int64_t jump = b_.jump_[o];
          const std::int64_t word = static_cast<std::int64_t>(o / 32) * l.count();
          const std::uint32_t bit = 1U << (o % 32);
          for (std::int64_t i = l.index(low, y, z); i < l.index(high, y, z); ++i)
          {
            if (b_.solid_[i] == 0 || b_.solid_[i + jump] == 0)
              continue;
            if (!between.empty() &&
              std::any_of(between[o].begin(), between[o].end(), [&](std::int64_t k) { return b_.solid_[i + k] == 0; }))
              continue;
            const bool apart =
              grain_.size() > 0 && grain_[i] != 0 && grain_[i + jump] != 0 && grain_[i] != grain_[i + jump];
            const int kind =
              apart ? kinds_.between(phase_[i], phase_[i + jump]) : kinds_.within(phase_[i], phase_[i + jump]);
            if (kind < 0)
            {
              const auto [a, c] = std::minmax(phase_[i], phase_[i + jump]);
              lacking = std::max(lacking, std::int64_t{ a } * 256 + c);
              continue;
            }
            for (int p = 0; p < b_.planes_; ++p)
              if ((kind >> p) & 1)
                b_.bits_[p * b_.words_ * l.count() + word + i] |= bit;
          }
        }
        if (lacking >= 0)
#pragma omp critical(lamellaMissingPair)
          missing = std::max(missing, lacking);
      });
    missing = static_cast<std::int64_t>(b_.comm_->max(static_cast<double>(missing)));
    if (missing >= 0)
      throw ParameterError(
        fmt::format("no material is given for bonds of {}",
          pairName(model_, static_cast<std::uint8_t>(missing / 256), static_cast<std::uint8_t>(missing % 256))),
        "these phases lie within a horizon of each other: give the pair a material, its own, another pair's or a "
        "mixture");
  }

  void weigh()
  {
    const NodeLayout& l = b_.layout_;
    const auto& half = b_.stencil_.half();
    b_.shares_ = NodeField<float>(l);
    // energy of a bond under unit strain along an axis: its elongation is n², so n⁴ |ξ|
    const auto energy = [](const Offset& o, std::size_t a)
    { return o.weight * std::pow(o.step[a] / o.length, 4) * o.length; };
    std::array<double, 3> bulk{};
    for (std::size_t a = 0; a < 3; ++a)
      for (const Offset& o : half)
        bulk[a] += 2 * energy(o, a);
    forRows(
      [&](std::int64_t row)
      {
        const std::int64_t y = row % l.rowsY() - l.ghost;
        const std::int64_t z = row / l.rowsY() - l.ghostZ();
        if (y < 0 || y >= l.size[1] || z < 0 || z >= l.size[2])
          return;
        for (std::int64_t i = l.index(0, y, z); i < l.index(l.size[0], y, z); ++i)
        {
          if (b_.solid_[i] == 0)
            continue;
          std::array<double, 3> lost{}; // exactly 0 in the bulk
          for (std::size_t o = 0; o < half.size(); ++o)
            for (const std::int64_t first : { i, i - b_.jump_[o] })
              if (b_.kind(first, static_cast<int>(o)) == 0)
                for (std::size_t a = 0; a < 3; ++a)
                  lost[a] += energy(half[o], a);
          for (int c = 0; c < l.dimension; ++c)
          {
            const auto a = static_cast<std::size_t>(c);
            const double share = std::max(0.25, 1 - lost[a] / bulk[a]);
            b_.shares_.component(c)[i] = static_cast<float>(share * share);
          }
        }
      });
    b_.exchange(b_.shares_);
  }

  void cut(const NotchCut& notch)
  {
    const NodeLayout& l = b_.layout_;
    const auto& half = b_.stencil_.half();
    forRows(
      [&](std::int64_t row)
      {
        const std::int64_t y = row % l.rowsY() - l.ghost;
        const std::int64_t z = row / l.rowsY() - l.ghostZ();
        for (std::int64_t x = -l.ghost; x < l.size[0] + l.ghost; ++x)
        {
          const std::int64_t i = l.index(x, y, z);
          const std::array<std::int64_t, 3> node{ x + l.start[0], y + l.start[1], z + l.start[2] };
          if (b_.solid_[i] == 0 || !notch.near(node, l.ghost))
            continue;
          for (std::size_t o = 0; o < half.size(); ++o)
            if (b_.kind(i, static_cast<int>(o)) != 0 && notch.crosses(node, half[o].step))
              for (int p = 0; p < b_.planes_; ++p)
                b_.bits_[(p * b_.words_ + static_cast<std::int64_t>(o / 32)) * l.count() + i] &= ~(1U << (o % 32));
        }
      });
  }

  void finish()
  {
    const NodeLayout& l = b_.layout_;
    forRows(
      [&](std::int64_t row)
      {
        for (std::int64_t s = 0; s < l.pitch / 16; ++s)
          b_.classify(row, s);
      });
    std::int64_t bonds = 0;
#pragma omp parallel for reduction(+ : bonds)
    for (std::int64_t r = 0; r < l.size[1] * l.size[2]; ++r)
      for (std::int64_t x = 0; x < l.size[0]; ++x)
        for (int w = 0; w < b_.words_; ++w)
        {
          std::uint32_t some = 0;
          for (int p = 0; p < b_.planes_; ++p)
            some |= b_.plane(p, w)[l.index(x, r % l.size[1], r / l.size[1])];
          bonds += std::popcount(some);
        }
    b_.bonds_ = b_.comm_->sum(bonds);
  }

  BondLattice& b_;
  const BondModel& model_;
  const Lattice& lattice_;
  const BondKinds& kinds_;
  AlignedArray<std::uint8_t> phase_;
  AlignedArray<std::int32_t> grain_;
};

BondLattice::BondLattice(const BondModel& model, const Lattice& lattice, std::span<const std::uint8_t> phase,
  std::span<const std::int32_t> grain, const Communicator& comm)
  : stencil_(bondStencil(model))
  , comm_(&comm)
  , spacing_(lattice.spacing)
  , periodic_(model.periodic)
  , rowKernels_(&peridynamics::rowKernels())
{
  if (lattice.dimension == 2)
    periodic_[2] = false;
  const BondKinds kinds(model, stencil_, spacing_);
  BondLatticeBuilder(*this, model, lattice, kinds).build(phase, grain);
}

double BondLattice::bytesNeeded(const BondModel& model, const Lattice& lattice, int ranks, bool grains)
{
  const Stencil stencil(model.continuum == Continuum::Space ? 3 : 2, model.horizon);
  const BondKinds kinds(model, stencil, lattice.spacing);
  const auto planes = static_cast<double>(std::bit_width(kinds.kinds().size() - 1));
  const auto words = static_cast<double>((stencil.half().size() + 31) / 32);
  const NodeLayout layout =
    NodeLayout::largestPart(lattice.dimension, stencil.layers(), lattice.size, ranks, model.periodic[0]);
  // bits, strips, what is solid, shares of energy; and for a while the phases and grains with their rim
  const double perNode =
    4 * planes * words + 1.0 / 16 + 1 + (model.surfaceCorrection ? 4 * stencil.dimension() : 0) + 1 + (grains ? 4 : 0);
  return perNode * static_cast<double>(layout.count());
}

} // namespace lamella::peridynamics
