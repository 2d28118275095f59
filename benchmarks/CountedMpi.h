#pragma once

#include <cstdint>

namespace lamella::benchmark
{

/// What this rank has asked of MPI, and what it did in between. The benchmark that links CountedMpi.cpp has MPI's own
/// functions replaced by ones that count (MPI's profiling interface); the solvers know nothing of it.
struct MpiCounts
{
  std::int64_t messages = 0;       ///< sent to other ranks
  std::int64_t bytes = 0;          ///< in them
  std::int64_t waits = 0;          ///< times that it waited for messages
  std::int64_t reductions = 0;     ///< over all ranks
  std::int64_t reducedBytes = 0;   ///< in them, of one rank
  std::int64_t gatherings = 0;     ///< of what all ranks hold
  std::int64_t gatheredBytes = 0;  ///< that came from other ranks
  std::int64_t exchanges = 0;      ///< of each rank with every one
  std::int64_t exchangedBytes = 0; ///< sent in them
  double work = 0;                 ///< processor time outside MPI [s]
  double whole = 0;                ///< of that, between a gathering and the next call: mostly the gathered levels'

  [[nodiscard]] MpiCounts operator-(const MpiCounts& before) const;
};

/// Up to now.
[[nodiscard]] MpiCounts mpiCounts();

} // namespace lamella::benchmark
