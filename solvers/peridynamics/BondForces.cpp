#include "peridynamics/BondForces.h"

#include "peridynamics/BondNumbers.h"
#include "peridynamics/RowJobs.h"

#include <omp.h>

#include <algorithm>
#include <limits>

namespace lamella::peridynamics
{
namespace
{

/// Which bonds a pass sums: all, those between owned rows, or those between an owned row and another rank's.
enum class Part
{
  All,
  Inner,
  Rim
};

/// The layers along the slowest axis that belong to other ranks.
class RemoteLayers
{
public:
  RemoteLayers() = default;
  template <class Real>
  RemoteLayers(const NodeLayout& l, const RimInFlight<Real>& rim)
    : space_(l.dimension == 3)
    , begin_(rim.low() ? 0 : none)
    , end_(rim.high() ? l.size[space_ ? 2 : 1] : all)
  {
  }

  [[nodiscard]] bool any() const noexcept { return begin_ != none || end_ != all; }
  [[nodiscard]] bool contain(std::int64_t y, std::int64_t z) const noexcept
  {
    const std::int64_t layer = space_ ? z : y;
    return layer < begin_ || layer >= end_;
  }
  /// Is one of them among the `reach` layers to either side?
  [[nodiscard]] bool near(std::int64_t y, std::int64_t z, std::int64_t reach) const noexcept
  {
    return space_ ? contain(y, z - reach) || contain(y, z + reach) : contain(y - reach, z) || contain(y + reach, z);
  }

private:
  static constexpr std::int64_t none = std::numeric_limits<std::int64_t>::min();
  static constexpr std::int64_t all = std::numeric_limits<std::int64_t>::max();

  bool space_ = false;
  std::int64_t begin_ = none; ///< layers below
  std::int64_t end_ = all;    ///< layers from here on
};

/// The force pass of one thread over its band.
template <class Real>
class ForceBand
{
public:
  ForceBand(const BondLattice& bonds, const BondNumbers<Real>& numbers, const std::vector<Chunk>& list,
    const NodeField<Real>& u, NodeField<Real>& f, bool nonlinear)
    : bonds_(bonds)
    , numbers_(numbers)
    , chunks_(list)
    , u_(u)
    , f_(f)
    , nonlinear_(nonlinear)
    , parts_(nonlinear ? bonds.dimension() : 1)
    , bufferPitch_(bonds.layout().bufferLength() + NodeLayout::margin)
    , buffers_(bufferPitch_ * maxChunk * parts_)
    , dump_(bonds.layout().bufferLength() * bonds.dimension())
    , marks_(nonlinear ? bonds.layout().bufferLength() : 0)
    , kernels_(kernelsOf<Real>(bonds))
  {
    begin(job_, bonds, numbers);
    job_.t = buffers_.data() + NodeLayout::margin;
    job_.pitch = bufferPitch_;
    job_.marks = marks_.data() + (nonlinear ? NodeLayout::margin : 0);
  }

  /// @param part Rim adds to what Inner has written
  /// @param rim on its way, or null; to be polled, never waited for
  void run(const Band& band, Part part, const RemoteLayers& remote, std::vector<Bond>* list, RimInFlight<Real>* rim)
  {
    const NodeLayout& l = bonds_.layout();
    const int d = l.dimension;
    const int reach = bonds_.stencil().layers();
    const auto zero = [&](std::int64_t row)
    {
      if (part == Part::Rim)
        return;
      for (int c = 0; c < d; ++c)
        std::fill_n(f_.component(c) + l.begin(row), l.pitch, Real(0));
    };
    sweep(l, reach, band, zero,
      [&](std::int64_t y, std::int64_t z, std::int64_t row, bool own)
      {
        const bool away = part != Part::All && remote.contain(y, z);
        if (part == Part::Inner ? away : part == Part::Rim && !remote.near(y, z, reach))
          return;
        if (rim != nullptr && row % rowsBetweenPolls == 0)
          rim->poll();
        if (runs_.find(bonds_, row, 64 / static_cast<int>(sizeof(Real))))
        {
          clearGaps();
          for (const Chunk& chunk : chunks_)
          {
            const std::int64_t toY = y + chunk.step[1];
            const std::int64_t toZ = z + chunk.step[2];
            if (!inLattice(bonds_, 1, toY) || !inLattice(bonds_, 2, toZ))
              continue;
            if (part != Part::All && (away || remote.contain(toY, toZ)) != (part == Part::Rim))
              continue;
            const bool target = inBand(l, band, toY, toZ);
            if (own || target)
              pair(chunk, y, z, own, target, list);
          }
        }
        if (own)
          for (int c = 0; c < d; ++c)
            clearRim(l, f_.component(c) + l.index(0, y, z));
      });
  }

  std::int64_t critical = 0;

private:
  static constexpr std::int64_t rowsBetweenPolls = 8;

  // What pull() reads and push() does not write. Most rows have the gaps of the row before, which are still clear.
  void clearGaps()
  {
    if (runs_.gaps == clear_)
      return;
    for (const Run& r : runs_.gaps)
      for (int b = 0; b < maxChunk * parts_; ++b)
      {
        Real* const t = buffers_.data() + NodeLayout::margin + b * bufferPitch_;
        std::fill(t + r.begin, t + r.end, Real(0));
      }
    clear_ = runs_.gaps;
  }

  void pair(const Chunk& chunk, std::int64_t y, std::int64_t z, bool own, bool target, std::vector<Bond>* list)
  {
    const NodeLayout& l = bonds_.layout();
    const auto d = static_cast<std::size_t>(l.dimension);
    const std::int64_t i = l.index(0, y, z);
    const std::int64_t j = l.index(0, y + chunk.step[1], z + chunk.step[2]);
    RowJob<Real>& job = job_;
    aim(job, bonds_, numbers_, chunk, u_, y, z);
    for (std::size_t c = 0; c < d; ++c)
    {
      const int k = static_cast<int>(c);
      job.f[c] = own ? f_.component(k) + i : dump_.data() + k * l.bufferLength() + NodeLayout::margin;
    }
    const auto& table = (nonlinear_ ? kernels_.nonlinear : kernels_.linear)[d - 2];
    for (const Run& r : runs_.push)
      table[follow(job, numbers_, chunk, r)][bonds_.corrected() ? 1 : 0][chunk.count - 1](job, r.begin, r.end);
    if (job.marked)
      count(chunk, y, z, own, list);
    if (!target)
      return;
    for (std::size_t c = 0; c < d; ++c)
      job.f[c] = f_.component(static_cast<int>(c)) + j;
    for (const Run& r : runs_.pull)
      (nonlinear_ ? kernels_.pullNonlinear : kernels_.pullLinear)[d - 2][chunk.count - 1](job, r.begin, r.end);
  }

  void count(const Chunk& chunk, std::int64_t y, std::int64_t z, bool own, std::vector<Bond>* list)
  {
    const NodeLayout& l = bonds_.layout();
    if (own)
      for (std::int64_t x = 0; x < l.size[0]; ++x)
        for (int b = 0; b < chunk.count; ++b)
          if ((marks_[NodeLayout::margin + x] >> b) & 1)
          {
            ++critical;
            if (list != nullptr)
              list->push_back(bonds_.bond(l.index(x, y, z), chunk.first + b));
          }
    std::fill_n(marks_.data(), marks_.size(), static_cast<unsigned char>(0));
  }

  const BondLattice& bonds_;
  const BondNumbers<Real>& numbers_;
  const std::vector<Chunk>& chunks_;
  const NodeField<Real>& u_;
  NodeField<Real>& f_;
  bool nonlinear_;
  int parts_;
  std::int64_t bufferPitch_; ///< a strip after the last that is written is read, too
  AlignedArray<Real> buffers_;
  AlignedArray<Real> dump_;
  AlignedArray<unsigned char> marks_;
  const RealRowKernels<Real>& kernels_;
  RowJob<Real> job_{}; ///< what changes from pair to pair is set there: to clear all of it took 6 % in narrow lattices
  RowRuns runs_;
  std::vector<Run> clear_; ///< zero in all buffers
};

template <class Real>
CriticalBonds force(const BondLattice& bonds, const NodeField<Real>& u, NodeField<Real>& f, bool nonlinear, bool wanted,
  const Band& within, RimInFlight<Real>* rim = nullptr, int only = 0)
{
  const BondNumbers<Real> numbers(bonds, only);
  const std::vector<Chunk> list = chunks(bonds.stencil(), maxChunk);
  CriticalBonds found;
  const int threads = omp_get_max_threads();
  std::int64_t critical = 0;
  const std::vector<Band> shares = bands(bonds, threads, within);
  const auto run = [&](Part part, const RemoteLayers& remote, RimInFlight<Real>* pending)
  {
    std::vector<std::vector<Bond>> lists(shares.size());
#pragma omp parallel for schedule(static, 1) reduction(+ : critical) num_threads(threads) if (threads > 1)
    for (std::size_t b = 0; b < shares.size(); ++b)
    {
      ForceBand<Real> band(bonds, numbers, list, u, f, nonlinear);
      band.run(shares[b], part, remote, wanted ? &lists[b] : nullptr, b == 0 ? pending : nullptr);
      critical += band.critical;
    }
    for (const auto& bandsList : lists)
      found.bonds.insert(found.bonds.end(), bandsList.begin(), bandsList.end());
  };
  const RemoteLayers remote = rim != nullptr ? RemoteLayers(bonds.layout(), *rim) : RemoteLayers();
  if (remote.any())
  {
    run(Part::Inner, remote, rim);
    rim->finish();
    run(Part::Rim, remote, nullptr);
  }
  else
    run(Part::All, remote, nullptr);
  found.count = critical;
  std::sort(found.bonds.begin(), found.bonds.end());
  return found;
}

Band allRows(const BondLattice& bonds) noexcept
{
  return { 0, bonds.layout().size[1] * bonds.layout().size[2] };
}

} // namespace

template <class Real>
void linearForce(const BondLattice& bonds, const NodeField<Real>& u, NodeField<Real>& f)
{
  (void)force(bonds, u, f, false, false, allRows(bonds));
}

void linearForceOfKind(const BondLattice& bonds, const NodeField<double>& u, int kind, NodeField<double>& f)
{
  (void)force<double>(bonds, u, f, false, false, allRows(bonds), nullptr, kind);
}

template <class Real>
void linearForceOfLayers(
  const BondLattice& bonds, const NodeField<Real>& u, NodeField<Real>& f, std::int64_t first, std::int64_t last)
{
  const std::int64_t rows = bonds.dimension() == 3 ? bonds.layout().size[1] : 1;
  (void)force(bonds, u, f, false, false, { first * rows, last * rows });
}

template <class Real>
void exchangeAndLinearForce(const BondLattice& bonds, NodeField<Real>& u, NodeField<Real>& f)
{
  auto rim = bonds.startExchange(u);
  (void)force(bonds, u, f, false, false, allRows(bonds), &rim);
}

template <class Real>
CriticalBonds nonlinearForce(const BondLattice& bonds, const NodeField<Real>& u, NodeField<Real>& f, bool list)
{
  return force(bonds, u, f, true, list, allRows(bonds));
}

template <class Real>
CriticalBonds exchangeAndNonlinearForce(const BondLattice& bonds, NodeField<Real>& u, NodeField<Real>& f, bool list)
{
  auto rim = bonds.startExchange(u);
  return force(bonds, u, f, true, list, allRows(bonds), &rim);
}

template void linearForce(const BondLattice&, const NodeField<double>&, NodeField<double>&);
template void linearForce(const BondLattice&, const NodeField<float>&, NodeField<float>&);
template void linearForceOfLayers(
  const BondLattice&, const NodeField<double>&, NodeField<double>&, std::int64_t, std::int64_t);
template void linearForceOfLayers(
  const BondLattice&, const NodeField<float>&, NodeField<float>&, std::int64_t, std::int64_t);
template void exchangeAndLinearForce(const BondLattice&, NodeField<double>&, NodeField<double>&);
template void exchangeAndLinearForce(const BondLattice&, NodeField<float>&, NodeField<float>&);
template CriticalBonds exchangeAndNonlinearForce(const BondLattice&, NodeField<double>&, NodeField<double>&, bool);
template CriticalBonds exchangeAndNonlinearForce(const BondLattice&, NodeField<float>&, NodeField<float>&, bool);
template CriticalBonds nonlinearForce(const BondLattice&, const NodeField<double>&, NodeField<double>&, bool);
template CriticalBonds nonlinearForce(const BondLattice&, const NodeField<float>&, NodeField<float>&, bool);

} // namespace lamella::peridynamics
