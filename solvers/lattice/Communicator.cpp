#include "lattice/Communicator.h"

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

} // namespace lamella
