#pragma once

#include <mpi.h>
#include <unistd.h>

namespace lamella::benchmark
{

/// MPI_Barrier that leaves the processor to those who still work.
inline void waitForAll()
{
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Ibarrier(MPI_COMM_WORLD, &request);
  for (int done = 0;;)
  {
    MPI_Test(&request, &done, MPI_STATUS_IGNORE);
    if (done != 0)
      return;
    usleep(500);
  }
}

} // namespace lamella::benchmark
