#include "core/Communicator.h"

#include <algorithm>
#include <numeric>

namespace lamella
{

Communicator::Communicator(MPI_Comm comm)
  : comm_(comm)
{
  int initialized = 0;
  MPI_Initialized(&initialized);
  if (initialized && comm != MPI_COMM_NULL)
  {
    MPI_Comm_rank(comm, &rank_);
    MPI_Comm_size(comm, &size_);
  }
}

int Communicator::sizeOnMachine() const
{
  int count = 1;
  if (parallel())
  {
    MPI_Comm here = MPI_COMM_NULL;
    MPI_Comm_split_type(comm_, MPI_COMM_TYPE_SHARED, rank_, MPI_INFO_NULL, &here);
    MPI_Comm_size(here, &count);
    MPI_Comm_free(&here);
  }
  return count;
}

void Communicator::sum(std::span<double> values) const
{
  if (parallel())
    MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_SUM, comm_);
}

double Communicator::sum(double value) const
{
  sum(std::span<double>(&value, 1));
  return value;
}

std::int64_t Communicator::sum(std::int64_t value) const
{
  if (parallel())
    MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_INT64_T, MPI_SUM, comm_);
  return value;
}

bool Communicator::any(bool value) const
{
  int flag = value ? 1 : 0;
  if (parallel())
    MPI_Allreduce(MPI_IN_PLACE, &flag, 1, MPI_INT, MPI_MAX, comm_);
  return flag != 0;
}

double Communicator::max(double value) const
{
  if (parallel())
    MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_MAX, comm_);
  return value;
}

std::int64_t Communicator::sumBefore(std::int64_t value) const
{
  std::int64_t before = 0;
  if (parallel())
  {
    MPI_Exscan(&value, &before, 1, MPI_INT64_T, MPI_SUM, comm_);
    if (rank_ == 0)
      before = 0;
  }
  return before;
}

std::vector<double> Communicator::gather(std::span<const double> mine) const
{
  if (!parallel())
    return { mine.begin(), mine.end() };
  const int own = static_cast<int>(mine.size());
  std::vector<int> counts(static_cast<std::size_t>(size_));
  MPI_Gather(&own, 1, MPI_INT, counts.data(), 1, MPI_INT, 0, comm_);
  std::vector<int> begins(counts.size(), 0);
  std::partial_sum(counts.begin(), counts.end() - 1, begins.begin() + 1);
  std::vector<double> all(rank_ == 0 ? static_cast<std::size_t>(begins.back() + counts.back()) : 0);
  MPI_Gatherv(mine.data(), own, MPI_DOUBLE, all.data(), counts.data(), begins.data(), MPI_DOUBLE, 0, comm_);
  return all;
}

void Communicator::broadcast(std::vector<std::byte>& bytes) const
{
  if (!parallel())
    return;
  std::uint64_t count = bytes.size();
  MPI_Bcast(&count, 1, MPI_UINT64_T, 0, comm_);
  bytes.resize(count);
  broadcast(std::span(bytes));
}

void Communicator::broadcast(std::span<std::byte> bytes) const
{
  constexpr std::size_t most = std::size_t{ 1 } << 30; // a count is an int
  for (std::size_t at = 0; parallel() && at < bytes.size(); at += most)
    MPI_Bcast(bytes.data() + at, static_cast<int>(std::min(most, bytes.size() - at)), MPI_BYTE, 0, comm_);
}

} // namespace lamella
