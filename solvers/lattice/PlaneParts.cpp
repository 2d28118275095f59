#include "lattice/PlaneParts.h"

#include <algorithm>
#include <limits>

namespace lamella
{
namespace
{

constexpr std::int64_t mostAligned = 16;

} // namespace

PlaneParts::PlaneParts(std::int64_t planes, bool periodic, const Communicator& comm)
  : comm_(comm)
  , periodic_(periodic)
{
  const auto ranks = static_cast<std::int64_t>(comm.size());
  if (!canSplit(planes, comm.size()))
    return;
  // Parts of whole blocks of planes, which may be halved as often as blocks may; from there on every rank works out all
  // of what is left, at most a quarter of the box at each halving, and smoothed twice as much.
  double least = std::numeric_limits<double>::infinity();
  for (std::int64_t block = mostAligned; block > 1; block /= 2)
  {
    const std::int64_t blocks = (planes + block - 1) / block;
    if (blocks < ranks)
      continue;
    const auto largest = static_cast<double>(block * ((blocks + ranks - 1) / ranks));
    const double cost = largest + 2 * static_cast<double>(planes) / static_cast<double>(block * block);
    if (!(cost < least))
      continue;
    least = cost;
    begin_.clear();
    for (std::int64_t r = 0; r <= ranks; ++r)
      begin_.push_back(std::min(planes, block * (blocks * r / ranks)));
  }
}

bool PlaneParts::beginEven() const
{
  return std::ranges::all_of(
    begin_.begin(), begin_.end() - 1, [](std::int64_t b) { return b % 2 == 0; });
}

PlaneParts PlaneParts::halved(std::int64_t planes) const
{
  PlaneParts parts = *this;
  for (std::int64_t& b : parts.begin_)
    b /= 2;
  if (split())
    parts.begin_.back() = planes;
  return parts;
}

void PlaneParts::shift(const void* mine, void* theirs, std::size_t bytes, int by) const
{
  if (!split())
    return;
  const int ranks = comm_.size();
  const auto beside = [&](int rank)
  {
    if (rank < 0 || rank >= ranks)
      return periodic_ ? (rank + ranks) % ranks : MPI_PROC_NULL;
    return rank;
  };
  constexpr std::size_t most = std::size_t{ 1 } << 30; // a count is an int
  for (std::size_t at = 0; at < bytes; at += most)
  {
    const auto count = static_cast<int>(std::min(most, bytes - at));
    MPI_Sendrecv(static_cast<const std::byte*>(mine) + at, count, MPI_BYTE, beside(comm_.rank() + by), by > 0 ? 1 : 2,
      static_cast<std::byte*>(theirs) + at, count, MPI_BYTE, beside(comm_.rank() - by), by > 0 ? 1 : 2, comm_.handle(),
      MPI_STATUS_IGNORE);
  }
}

void PlaneParts::gatherBytes(void* values, std::int64_t planes, std::size_t each) const
{
  if (!split() || each == 0)
    return;
  std::vector<int> counts;
  std::vector<int> begins;
  for (std::size_t r = 0; r + 1 < begin_.size(); ++r)
  {
    const std::int64_t end = r + 2 == begin_.size() ? planes : std::min(planes, begin_[r + 1]);
    begins.push_back(static_cast<int>(std::min(planes, begin_[r])));
    counts.push_back(static_cast<int>(end) - begins.back());
  }
  MPI_Datatype plane = MPI_DATATYPE_NULL;
  MPI_Type_contiguous(static_cast<int>(each), MPI_BYTE, &plane);
  MPI_Type_commit(&plane);
  MPI_Allgatherv(MPI_IN_PLACE, 0, MPI_DATATYPE_NULL, values, counts.data(), begins.data(), plane, comm_.handle());
  MPI_Type_free(&plane);
}

void PlaneParts::gather(std::span<double> values, std::int64_t planes) const
{
  gatherBytes(values.data(), planes, values.size_bytes() / static_cast<std::size_t>(planes));
}

void PlaneParts::gather(std::span<float> values, std::int64_t planes) const
{
  gatherBytes(values.data(), planes, values.size_bytes() / static_cast<std::size_t>(planes));
}

void PlaneParts::sum(std::span<double> values) const
{
  if (split())
    comm_.sum(values);
}

void PlaneParts::inOrder(std::span<std::byte> values, const std::function<void()>& add) const
{
  if (!split())
  {
    add();
    return;
  }
  const int ranks = comm_.size();
  const auto count = static_cast<int>(values.size());
  if (comm_.rank() > 0)
    MPI_Recv(values.data(), count, MPI_BYTE, comm_.rank() - 1, 3, comm_.handle(), MPI_STATUS_IGNORE);
  add();
  if (comm_.rank() + 1 < ranks)
    MPI_Send(values.data(), count, MPI_BYTE, comm_.rank() + 1, 3, comm_.handle());
  MPI_Bcast(values.data(), count, MPI_BYTE, ranks - 1, comm_.handle());
}

} // namespace lamella
