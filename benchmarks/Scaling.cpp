#include "Scaling.h"

#include "Ranks.h"

#include "core/Communicator.h"
#include "core/Median.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <utility>
#include <vector>

namespace lamella::benchmark
{

std::optional<Table> tableOf(
  const Keys& keys, const std::string& bench, const std::string& name, const std::string& columns)
{
  std::optional<Table> table;
  if (Communicator(MPI_COMM_WORLD).rank() == 0)
    table.emplace(keys, bench, name, columns.c_str());
  return table;
}

double loadNow()
{
  double load = 0;
  return getloadavg(&load, 1) == 1 ? load : std::numeric_limits<double>::quiet_NaN();
}

void measureMachine(const Keys& keys, const std::string& bench)
{
  const Communicator world(MPI_COMM_WORLD);
  auto table = tableOf(keys, bench, "machine", "what,bytes,median,least");
  const auto told = [&](const char* what, std::size_t bytes, const std::vector<double>& seconds)
  {
    if (table)
      table->line(what, bytes, median(seconds), *std::ranges::min_element(seconds));
  };
  const auto batches = [&](int count, int times, auto&& f)
  {
    std::vector<double> seconds;
    for (int i = 0; i < count; ++i)
    {
      const double start = MPI_Wtime();
      for (int k = 0; k < times; ++k)
        f();
      seconds.push_back((MPI_Wtime() - start) / times);
    }
    return seconds;
  };
  if (world.size() < 2)
    return;
  for (const std::size_t bytes : { std::size_t{ 8 }, std::size_t{ 1 } << 12, std::size_t{ 1 } << 16,
         std::size_t{ 1 } << 18, std::size_t{ 1 } << 20, std::size_t{ 1 } << 22 })
  {
    std::vector<std::byte> mine(bytes);
    std::vector<std::byte> theirs(bytes);
    const int other = 1 - world.rank();
    MPI_Barrier(world.handle());
    told("message", bytes,
      batches(bytes < 100000 ? 1000 : 100, bytes < 100000 ? 50 : 4,
        [&]
        {
          std::array<MPI_Request, 2> requests;
          PMPI_Irecv(theirs.data(), static_cast<int>(bytes), MPI_BYTE, other, 1, world.handle(), &requests[0]);
          PMPI_Isend(mine.data(), static_cast<int>(bytes), MPI_BYTE, other, 1, world.handle(), &requests[1]);
          PMPI_Waitall(2, requests.data(), MPI_STATUSES_IGNORE);
        }));
  }
  std::array<double, 6> sums{};
  MPI_Barrier(world.handle());
  told("reduction", 48, batches(1000, 50, [&] { world.sum(sums); }));
  std::vector<float> memory(std::size_t{ 1 } << 24, 1.0F);
  const auto pass = [&]
  {
    for (float& v : memory)
      v *= 0.999F;
  };
  const std::size_t moved = 2 * memory.size() * sizeof(float);
  waitForAll();
  if (world.rank() == 0)
    told("memory by one", moved, batches(30, 1, pass));
  waitForAll();
  told("memory by all", moved, batches(30, 1, pass));
}

std::string countColumns(const std::string& prefix)
{
  std::string columns;
  for (const char* name : { "messages", "messages_most", "bytes", "bytes_most", "waits", "reductions", "reduced",
         "gatherings", "gathered", "exchanges", "exchanged", "work", "work_most", "whole" })
    columns += (columns.empty() ? "" : ",") + prefix + name;
  return columns;
}

std::string countValues(const MpiCounts& c)
{
  const Communicator world(MPI_COMM_WORLD);
  const std::array<std::pair<double, bool>, 11> all{ { { static_cast<double>(c.messages), true },
    { static_cast<double>(c.bytes), true }, { static_cast<double>(c.waits), false },
    { static_cast<double>(c.reductions), false }, { static_cast<double>(c.reducedBytes), false },
    { static_cast<double>(c.gatherings), false }, { static_cast<double>(c.gatheredBytes), false },
    { static_cast<double>(c.exchanges), false }, { static_cast<double>(c.exchangedBytes), false }, { c.work, true },
    { c.whole, false } } };
  std::vector<double> values;
  for (const auto& [value, most] : all)
  {
    values.push_back(world.sum(value) / world.size());
    if (most)
      values.push_back(world.max(value));
  }
  return fmt::format("{}", fmt::join(values, ","));
}

StudyStarter::StudyStarter(const Keys& keys, std::string program)
  : keys_(keys)
  , program_(std::move(program))
{
}

bool StudyStarter::operator()(int ranks, const std::string& study, const Keys& more) const
{
  const std::string wanted = text(keys_, "study", "");
  if (!wanted.empty() && wanted != study)
    return true;
  Keys all = keys_;
  all["study"] = study;
  for (const auto& [key, value] : more)
    all[key] = value;
  std::vector<std::string> words{ program_ };
  for (const auto& [key, value] : all)
    words.push_back(key + "=" + value);
  fmt::print("  {} on {} rank{}\n", study, ranks, ranks == 1 ? "" : "s");
  std::fflush(stdout);
  return startOnRanks(ranks, words);
}

} // namespace lamella::benchmark
