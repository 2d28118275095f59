#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <vector>

#include <mpi.h>
#include <unistd.h>

namespace lamella::benchmark
{

/// Starts the program again under mpirun on two ranks, unless it already runs there. Does not come back then, or only
/// to say that it could not.
/// @param options of mpirun
/// @return whether it runs on ranks
inline bool onRanks(int argc, char** argv, const std::vector<const char*>& options = {})
{
  if (std::getenv("OMPI_COMM_WORLD_SIZE") != nullptr)
    return true;
  std::vector<const char*> words{ "mpirun", "--allow-run-as-root", "-n", "2" };
  words.insert(words.end(), options.begin(), options.end());
  words.insert(words.end(), argv, argv + argc);
  words.push_back(nullptr);
  execvp(words[0], const_cast<char* const*>(words.data()));
  fmt::print(stderr, "error: cannot start mpirun\nhint: install openmpi-bin\n");
  return false;
}

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
