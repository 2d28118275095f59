#pragma once

#include "CountedMpi.h"
#include "Keys.h"
#include "Table.h"

#include <optional>
#include <string>

/// What the benchmarks of more and more ranks share.
namespace lamella::benchmark
{

/// A table of rank 0; none on the others.
[[nodiscard]] std::optional<Table> tableOf(
  const Keys& keys, const std::string& bench, const std::string& name, const std::string& columns);

/// Load of the machine over the last minute, other programs included; NaN where it is not told.
[[nodiscard]] double loadNow();

/// The machine's own figures, into the table "machine": latency and bandwidth of messages between two ranks, time of a
/// reduction, and memory that is read and written in place, by one rank and by all. Medians of short batches, which
/// other programs seldom interrupt. Collective; nothing on one rank.
void measureMachine(const Keys& keys, const std::string& bench);

/// Names of what countValues() gives, each behind a prefix.
[[nodiscard]] std::string countColumns(const std::string& prefix);
/// Means over the ranks; of messages, bytes and work also the most of one. Collective.
[[nodiscard]] std::string countValues(const MpiCounts& mine);

/// Starts this program again under mpirun, once for each table.
class StudyStarter
{
public:
  StudyStarter(const Keys& keys, std::string program);
  /// One study, unless the key study= names another one.
  /// @param more keys of this run alone
  /// @return whether it ended well
  bool operator()(int ranks, const std::string& study, const Keys& more = {}) const;

private:
  const Keys& keys_;
  std::string program_;
};

} // namespace lamella::benchmark
