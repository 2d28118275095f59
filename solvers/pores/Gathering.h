#pragma once

#include "core/Communicator.h"

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

/// Vectors of any length between the ranks and rank 0; one rank never calls MPI.
namespace lamella::pores
{

/// Rank 0's value on every rank.
template <typename Value>
void broadcast(const Communicator& comm, Value& value)
{
  if (comm.parallel())
    MPI_Bcast(&value, sizeof value, MPI_BYTE, 0, comm.handle());
}

/// A value type as an MPI type: counts of values, not bytes, which 2³¹ soon are.
template <typename Value>
struct Type
{
  Type()
  {
    MPI_Type_contiguous(sizeof(Value), MPI_BYTE, &type);
    MPI_Type_commit(&type);
  }
  ~Type() { MPI_Type_free(&type); }
  Type(const Type&) = delete;
  Type& operator=(const Type&) = delete;
  MPI_Datatype type = MPI_DATATYPE_NULL;
};

/// Collective. Values of all ranks one after the other on rank 0. @returns how many each has, on rank 0
template <typename Values>
std::vector<std::int64_t> gather(const Communicator& comm, Values& values)
{
  if (!comm.parallel())
    return { static_cast<std::int64_t>(values.size()) };
  const Type<typename Values::value_type> type;
  const auto own = static_cast<std::int64_t>(values.size());
  std::vector<std::int64_t> counts(static_cast<std::size_t>(comm.size()));
  MPI_Gather(&own, 1, MPI_INT64_T, counts.data(), 1, MPI_INT64_T, 0, comm.handle());
  if (comm.rank() != 0)
  {
    MPI_Send(values.data(), static_cast<int>(own), type.type, 0, 11, comm.handle());
    return {};
  }
  for (int rank = 1; rank < comm.size(); ++rank)
  {
    const auto count = static_cast<std::size_t>(counts[static_cast<std::size_t>(rank)]);
    values.resize(values.size() + count);
    MPI_Recv(values.data() + values.size() - count, static_cast<int>(count), type.type, rank, 11, comm.handle(),
      MPI_STATUS_IGNORE);
  }
  return counts;
}

/// The way back: each rank's part of the values on rank 0.
/// @param counts of all ranks, on rank 0  @param mine of this rank
template <typename Values>
void scatter(const Communicator& comm, Values& all, std::span<const std::int64_t> counts, std::size_t mine, Values& own)
{
  if (!comm.parallel())
  {
    own = std::move(all);
    return;
  }
  const Type<typename Values::value_type> type;
  if (comm.rank() != 0)
  {
    own.resize(mine);
    MPI_Recv(own.data(), static_cast<int>(own.size()), type.type, 0, 12, comm.handle(), MPI_STATUS_IGNORE);
    return;
  }
  std::int64_t at = counts[0];
  for (int rank = 1; rank < comm.size(); ++rank)
  {
    const std::int64_t count = counts[static_cast<std::size_t>(rank)];
    MPI_Send(all.data() + at, static_cast<int>(count), type.type, rank, 12, comm.handle());
    at += count;
  }
  all.resize(static_cast<std::size_t>(counts[0]));
  own = std::move(all);
}

} // namespace lamella::pores
