#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include <mpi.h>
#include <sys/wait.h>
#include <unistd.h>

namespace lamella::benchmark
{

/// Whether mpirun started this program.
inline bool onRanks()
{
  return std::getenv("OMPI_COMM_WORLD_SIZE") != nullptr;
}

/// Becomes mpirun. Comes back only to say that it could not.
/// @param options of mpirun
/// @param program and its arguments
inline void becomeRanks(int ranks, const std::vector<const char*>& options, const std::vector<const char*>& program)
{
  const std::string count = std::to_string(ranks);
  std::vector<const char*> words{ "mpirun", "--allow-run-as-root", "-n", count.c_str() };
  words.insert(words.end(), options.begin(), options.end());
  words.insert(words.end(), program.begin(), program.end());
  words.push_back(nullptr);
  execvp(words[0], const_cast<char* const*>(words.data()));
  fmt::print(stderr, "error: cannot start mpirun\nhint: install openmpi-bin\n");
}

/// Starts the program again under mpirun on two ranks, unless it already runs there. Does not come back then, or only
/// to say that it could not.
/// @param options of mpirun
/// @return whether it runs on ranks
inline bool onRanks(int argc, char** argv, const std::vector<const char*>& options = {})
{
  if (!onRanks())
    becomeRanks(2, options, { argv, argv + argc });
  return onRanks();
}

/// Runs a program under mpirun, of more ranks than cores too, and waits for it.
/// @return whether it ended well
inline bool startOnRanks(int ranks, const std::vector<std::string>& program)
{
  std::vector<const char*> words;
  for (const std::string& word : program)
    words.push_back(word.c_str());
  const pid_t child = fork();
  if (child == 0)
  {
    becomeRanks(ranks, { "--oversubscribe" }, words);
    _exit(1);
  }
  int status = 1;
  return child > 0 && waitpid(child, &status, 0) == child && status == 0;
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
