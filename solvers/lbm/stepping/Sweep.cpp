#include "lbm/stepping/Sweep.h"

#include <algorithm>
#include <cstdlib>
#include <new>
#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace lamella::lbm
{
namespace
{

// Rows that several pairs of steps work on at a time should stay in the second-level cache and leave room there.
constexpr double cacheBytes = 640e3;
constexpr int deepest = 8;
constexpr std::int64_t narrowestTile = 8; // rows; the outer two of a tile are read twice

double* allocate(std::size_t n)
{
  constexpr std::size_t huge = std::size_t{ 1 } << 21;
  const std::size_t bytes = (n * sizeof(double) + huge - 1) / huge * huge;
  void* p = std::aligned_alloc(huge, bytes);
  if (p == nullptr)
    throw std::bad_alloc();
#if defined(MADV_HUGEPAGE)
  madvise(p, bytes, MADV_HUGEPAGE); // nine to nineteen places at once are many pages of 4 kB
#endif
  return static_cast<double*>(p);
}

} // namespace

void Sweep::Free::operator()(double* p) const noexcept
{
  std::free(p);
}

Sweep::Sweep(const SlotMap& map, const Communicator& comm, const StepLoops& loops, std::vector<std::uint8_t> phase,
  std::vector<double> rate, std::array<std::int64_t, 3> size, bool wrapsY, int threads)
  : map_(map)
  , comm_(comm)
  , loops_(loops)
  , phase_(std::move(phase))
  , rate_(std::move(rate))
  , f_(allocate(static_cast<std::size_t>(loops.populations * map.stride())))
  , rowsAll_(static_cast<std::int64_t>(map.rows().size()))
{
  lag_ = size[2] == 1 ? 1 : wrapsY ? 2 * size[1] : size[1] + 1;
  std::uint8_t largest = 0;
  for (const std::uint8_t id : phase_)
    largest = std::max(largest, id);
  arrays_ = { f_.get(), map.stride(), phase_.data(), rate_.data(), largest < 8, map.patterns().data(),
    map.sources().data() };

  const auto& rows = map.rows();
  const double rowBytes = static_cast<double>(map.stored()) / static_cast<double>(std::max<std::int64_t>(rowsAll_, 1)) *
    static_cast<double>(loops.populations) * sizeof(double);
  if (size[2] > 1 && !wrapsY && 2 * static_cast<double>(lag_) * rowBytes > cacheBytes)
  {
    plane_ = size[1];
    tile_ = std::clamp<std::int64_t>(static_cast<std::int64_t>(cacheBytes / (2 * rowBytes)), narrowestTile, plane_);
    lag_ = plane_;
  }

  // slabs of equal numbers of nodes, of whole planes where those are swept in tiles
  slabs_.push_back(0);
  std::int64_t done = 0;
  for (std::int64_t r = 0; r < rowsAll_; ++r)
  {
    if (done * threads >= map.stored() * static_cast<std::int64_t>(slabs_.size()) &&
      static_cast<int>(slabs_.size()) < threads && (tile_ == 0 || r % plane_ == 0))
      slabs_.push_back(r);
    done += rows[r].count;
  }
  slabs_.push_back(rowsAll_);
  std::int64_t narrowest = rowsAll_;
  for (std::size_t k = 0; k + 1 < slabs_.size(); ++k)
    narrowest = std::min(narrowest, slabs_[k + 1] - slabs_[k]);
  interleaved_ = narrowest >= 2 * lag_;
  if (interleaved_ && !comm.parallel() && tile_ == 0)
  {
    // a pair keeps the rows of two lags in use; the gaps between the slabs take a share of the time
    const double fitting = cacheBytes / (2 * static_cast<double>(lag_) * rowBytes);
    const double wide = static_cast<double>(narrowest) / (8 * static_cast<double>(lag_));
    depth_ = std::clamp(static_cast<int>(std::min(fitting, wide)), 1, deepest);
  }

  const auto slabs = static_cast<std::int64_t>(slabs_.size()) - 1;
#pragma omp parallel for schedule(static) num_threads(threads)
  for (std::int64_t k = 0; k < slabs; ++k) // each by the thread that will use it
    for (int q = 0; q < loops_.populations; ++q)
      for (std::int64_t r = slabs_[k]; r < slabs_[k + 1]; ++r)
        std::fill_n(f_.get() + q * map_.stride() + rows[r].first, rows[r].count, 0.0);
}

std::uint64_t Sweep::bytes() const noexcept
{
  return static_cast<std::uint64_t>(loops_.populations * map_.stride()) * sizeof(double) + phase_.size() +
    (rate_.size() + send_.size() + receive_.size()) * sizeof(double);
}

double Sweep::even(std::int64_t r) const
{
  const SlotMap::Row& row = map_.rows()[r];
  return row.special ? loops_.evenRuns(arrays_, map_.runs().data() + row.firstRun, row.runs)
                     : loops_.even(arrays_, row.first, row.count);
}

double Sweep::odd(std::int64_t r) const
{
  const SlotMap::Row& row = map_.rows()[r];
  return loops_.oddRuns(arrays_, map_.runs().data() + row.firstRun, row.firstRun, row.runs);
}

// Pair k works 2k lags behind the first, on so much less at both ends that it needs nothing from beyond.
double Sweep::slab(std::int64_t begin, std::int64_t end, int pairs) const
{
  double squares = 0;
  for (std::int64_t front = begin; front < end + (2 * pairs - 1) * lag_; ++front)
    for (int k = 0; k < pairs; ++k)
    {
      const std::int64_t margin = 2 * k * lag_;
      const std::int64_t e = front - margin;
      if (e >= begin + margin && e < end - margin)
      {
        const double s = even(e);
        squares += k == pairs - 1 ? s : 0.0;
      }
      const std::int64_t o = e - lag_;
      if (o >= begin + margin + lag_ && o < end - margin - lag_ && !map_.rows()[o].late)
        odd(o);
    }
  return squares;
}

// One pair where a plane is too large for the cache: tiles of a few rows of each plane, one tile through all planes
// after the other. The odd step is a row and a plane behind the even one, so the rows that it needs of the tile before
// are done.
double Sweep::tiles(std::int64_t begin, std::int64_t end) const
{
  double squares = 0;
  const std::int64_t low = begin / plane_;
  const std::int64_t high = end / plane_;
  for (std::int64_t from = 0; from < plane_; from += tile_)
  {
    const std::int64_t to = std::min(from + tile_, plane_);
    for (std::int64_t z = low; z < high; ++z)
      for (std::int64_t y = from; y < (to == plane_ ? to + 1 : to); ++y)
      {
        if (y < to)
          squares += even(z * plane_ + y);
        const std::int64_t o = (z - 1) * plane_ + y - 1;
        if (y > 0 && z - 1 > low && !map_.rows()[o].late)
          odd(o);
      }
  }
  return squares;
}

// What the slabs on both sides of a boundary have left out.
double Sweep::gap(std::int64_t boundary, int pairs) const
{
  double squares = 0;
  const auto around = [&](std::int64_t reach, auto&& step)
  {
    for (std::int64_t r = boundary - reach; r < boundary + reach; ++r)
      step((r % rowsAll_ + rowsAll_) % rowsAll_);
  };
  for (int k = 0; k < pairs; ++k)
  {
    around(
      2 * k * lag_,
      [&](std::int64_t r)
      {
        const double s = even(r);
        squares += k == pairs - 1 ? s : 0.0;
      });
    around((2 * k + 1) * lag_,
      [&](std::int64_t r)
      {
        if (!map_.rows()[r].late)
          odd(r);
      });
  }
  return squares;
}

double Sweep::advance(int pairs)
{
  double squares = 0;
  const auto slabs = static_cast<std::int64_t>(slabs_.size()) - 1;
#pragma omp parallel num_threads(static_cast <int>(slabs)) reduction(+ : squares)
  {
    if (interleaved_)
    {
#pragma omp for schedule(static)
      for (std::int64_t k = 0; k < slabs; ++k)
        squares += tile_ > 0 ? tiles(slabs_[k], slabs_[k + 1]) : slab(slabs_[k], slabs_[k + 1], pairs);
#pragma omp for schedule(static)
      for (std::int64_t k = 0; k < slabs; ++k)
        squares += gap(slabs_[k], pairs);
    }
    else
    {
#pragma omp for schedule(static)
      for (std::int64_t k = 0; k < slabs; ++k)
        for (std::int64_t r = slabs_[k]; r < slabs_[k + 1]; ++r)
          squares += even(r);
#pragma omp for schedule(static)
      for (std::int64_t k = 0; k < slabs; ++k)
        for (std::int64_t r = slabs_[k]; r < slabs_[k + 1]; ++r)
          if (!map_.rows()[r].late)
            odd(r);
    }
  }
  if (comm_.parallel())
  {
    exchange(false);
#pragma omp parallel for schedule(static) num_threads(static_cast <int>(slabs))
    for (std::int64_t r = 0; r < rowsAll_; ++r)
      if (map_.rows()[r].late)
        odd(r);
    exchange(true);
  }
  return squares;
}

// Before odd steps the slots that others read go there, afterwards they come back.
void Sweep::exchange(bool back)
{
  const auto& neighbours = map_.neighbours();
  std::size_t outgoing = 0;
  std::size_t incoming = 0;
  for (const auto& n : neighbours)
  {
    outgoing += back ? n.ghost.size() : n.mine.size();
    incoming += back ? n.mine.size() : n.ghost.size();
  }
  send_.resize(std::max(send_.size(), outgoing));
  receive_.resize(std::max(receive_.size(), incoming));
  std::vector<MPI_Request> requests(2 * neighbours.size(), MPI_REQUEST_NULL);
  outgoing = 0;
  incoming = 0;
  for (std::size_t k = 0; k < neighbours.size(); ++k)
  {
    const auto& from = back ? neighbours[k].ghost : neighbours[k].mine;
    const auto& to = back ? neighbours[k].mine : neighbours[k].ghost;
    MPI_Irecv(receive_.data() + incoming, static_cast<int>(to.size()), MPI_DOUBLE, neighbours[k].rank, 0,
      comm_.handle(), &requests[2 * k]);
    for (std::size_t i = 0; i < from.size(); ++i)
      send_[outgoing + i] = f_[from[i]];
    MPI_Isend(send_.data() + outgoing, static_cast<int>(from.size()), MPI_DOUBLE, neighbours[k].rank, 0, comm_.handle(),
      &requests[2 * k + 1]);
    outgoing += from.size();
    incoming += to.size();
  }
  MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
  incoming = 0;
  for (const auto& n : neighbours)
    for (const std::int64_t slot : back ? n.mine : n.ghost)
      f_[slot] = receive_[incoming++];
}

} // namespace lamella::lbm
