#pragma once

#include "session/Session.h"

#include <cstddef>
#include <functional>
#include <string>

namespace lamella::cli
{

/// How samples are spread.
struct Sharing
{
  int jobs = 1; ///< processes of this machine; 1 where there are MPI ranks
  /// Does one of them. What it throws stops all. @param told progress of this one; false: stop
  std::function<void(std::size_t task, const std::function<bool(double, const std::string&)>& told)> work;
  /// Told of one whose process came to a sudden end: killed, or out of memory.
  std::function<void(std::size_t task, const std::string& how)> died;
};

/// Does `count` tasks on MPI ranks, where there are several, or on processes of this machine. Whoever is free takes the
/// next one. Returns on all ranks when all are done.
///
/// Ranks share a counter (MPI_Fetch_and_op), processes one in common memory: nobody hands out, all work.
/// @throws what `work` throws, or an Error of its kind; Cancelled
void shareOut(Session& session, const Sharing& sharing, std::size_t count);

} // namespace lamella::cli
