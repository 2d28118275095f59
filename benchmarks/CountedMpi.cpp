#include "CountedMpi.h"

#include <ctime>

#include <mpi.h>

namespace lamella::benchmark
{
namespace
{

struct Counting
{
  MpiCounts counts;
  double last = 0; ///< processor time at the end of the last call
  bool afterGathering = false;
};

Counting& counting()
{
  static Counting all;
  return all;
}

double processorTime()
{
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

void settleWork(Counting& c)
{
  const double now = processorTime();
  c.counts.work += now - c.last;
  if (c.afterGathering)
    c.counts.whole += now - c.last;
  c.last = now;
}

// For the time of one call.
class Call
{
public:
  explicit Call(bool gathers = false)
    : gathers_(gathers)
  {
    settleWork(counting());
    counting().afterGathering = false;
  }
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;
  ~Call()
  {
    counting().last = processorTime();
    counting().afterGathering = gathers_;
  }
  MpiCounts* operator->() const { return &counting().counts; }

private:
  bool gathers_;
};

std::int64_t bytesOf(int count, MPI_Datatype type)
{
  int size = 0;
  PMPI_Type_size(type, &size);
  return std::int64_t{ count } * size;
}

int sizeOf(MPI_Comm comm)
{
  int size = 1;
  PMPI_Comm_size(comm, &size);
  return size;
}

// Of the values of one type that all ranks but this one have.
std::int64_t othersBytes(const int* counts, MPI_Datatype type, MPI_Comm comm)
{
  int rank = 0;
  PMPI_Comm_rank(comm, &rank);
  std::int64_t total = 0;
  for (int r = 0; r < sizeOf(comm); ++r)
    if (r != rank)
      total += bytesOf(counts[r], type);
  return total;
}

} // namespace

MpiCounts MpiCounts::operator-(const MpiCounts& b) const
{
  return { messages - b.messages, bytes - b.bytes, waits - b.waits, reductions - b.reductions,
    reducedBytes - b.reducedBytes, gatherings - b.gatherings, gatheredBytes - b.gatheredBytes, exchanges - b.exchanges,
    exchangedBytes - b.exchangedBytes, work - b.work, whole - b.whole };
}

MpiCounts mpiCounts()
{
  settleWork(counting());
  return counting().counts;
}

} // namespace lamella::benchmark

// Those that the measured solvers call; of a name that MPI gives, so that the solvers' calls end here.
using lamella::benchmark::bytesOf;
using lamella::benchmark::Call;
using lamella::benchmark::othersBytes;
using lamella::benchmark::sizeOf;

extern "C"
{

  int MPI_Isend(const void* data, int count, MPI_Datatype type, int to, int tag, MPI_Comm comm, MPI_Request* request)
  {
    const Call call;
    if (to != MPI_PROC_NULL)
    {
      ++call->messages;
      call->bytes += bytesOf(count, type);
    }
    return PMPI_Isend(data, count, type, to, tag, comm, request);
  }

  int MPI_Irecv(void* data, int count, MPI_Datatype type, int from, int tag, MPI_Comm comm, MPI_Request* request)
  {
    const Call call;
    return PMPI_Irecv(data, count, type, from, tag, comm, request);
  }

  int MPI_Recv(void* data, int count, MPI_Datatype type, int from, int tag, MPI_Comm comm, MPI_Status* status)
  {
    const Call call;
    ++call->waits;
    return PMPI_Recv(data, count, type, from, tag, comm, status);
  }

  int MPI_Probe(int from, int tag, MPI_Comm comm, MPI_Status* status)
  {
    const Call call;
    return PMPI_Probe(from, tag, comm, status);
  }

  int MPI_Waitall(int count, MPI_Request* requests, MPI_Status* statuses)
  {
    const Call call;
    if (count > 0)
      ++call->waits;
    return PMPI_Waitall(count, requests, statuses);
  }

  int MPI_Testall(int count, MPI_Request* requests, int* done, MPI_Status* statuses)
  {
    const Call call;
    return PMPI_Testall(count, requests, done, statuses);
  }

  int MPI_Sendrecv(const void* send, int sendCount, MPI_Datatype sendType, int to, int sendTag, void* receive,
    int count, MPI_Datatype type, int from, int tag, MPI_Comm comm, MPI_Status* status)
  {
    const Call call;
    if (to != MPI_PROC_NULL)
    {
      ++call->messages;
      call->bytes += bytesOf(sendCount, sendType);
    }
    if (from != MPI_PROC_NULL)
      ++call->waits;
    return PMPI_Sendrecv(send, sendCount, sendType, to, sendTag, receive, count, type, from, tag, comm, status);
  }

  int MPI_Allreduce(const void* send, void* receive, int count, MPI_Datatype type, MPI_Op op, MPI_Comm comm)
  {
    const Call call;
    ++call->reductions;
    call->reducedBytes += bytesOf(count, type);
    return PMPI_Allreduce(send, receive, count, type, op, comm);
  }

  int MPI_Exscan(const void* send, void* receive, int count, MPI_Datatype type, MPI_Op op, MPI_Comm comm)
  {
    const Call call;
    ++call->reductions;
    call->reducedBytes += bytesOf(count, type);
    return PMPI_Exscan(send, receive, count, type, op, comm);
  }

  int MPI_Allgather(
    const void* send, int sendCount, MPI_Datatype sendType, void* receive, int count, MPI_Datatype type, MPI_Comm comm)
  {
    const Call call;
    ++call->gatherings;
    call->gatheredBytes += (sizeOf(comm) - 1) * bytesOf(count, type);
    return PMPI_Allgather(send, sendCount, sendType, receive, count, type, comm);
  }

  int MPI_Allgatherv(const void* send, int sendCount, MPI_Datatype sendType, void* receive, const int* counts,
    const int* starts, MPI_Datatype type, MPI_Comm comm)
  {
    const Call call(true);
    ++call->gatherings;
    call->gatheredBytes += othersBytes(counts, type, comm);
    return PMPI_Allgatherv(send, sendCount, sendType, receive, counts, starts, type, comm);
  }

  int MPI_Alltoallv(const void* send, const int* sendCounts, const int* sendStarts, MPI_Datatype sendType,
    void* receive, const int* counts, const int* starts, MPI_Datatype type, MPI_Comm comm)
  {
    const Call call;
    ++call->exchanges;
    call->exchangedBytes += othersBytes(sendCounts, sendType, comm);
    return PMPI_Alltoallv(send, sendCounts, sendStarts, sendType, receive, counts, starts, type, comm);
  }

} // extern "C"
