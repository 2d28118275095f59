#include "packing/Packing.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <thread>

namespace lamella::packing
{

std::vector<Packing> packMany(const PackingOptions& options, std::span<const std::uint64_t> seeds, int threads)
{
  std::vector<Packing> samples(seeds.size());
  std::vector<std::exception_ptr> failures(seeds.size());
  std::atomic<std::size_t> next{ 0 };
  std::atomic<std::size_t> done{ 0 };
  const auto work = [&](bool reports)
  {
    for (std::size_t i = next++; i < seeds.size(); i = next++)
    {
      PackingOptions mine = options;
      mine.seed = seeds[i];
      mine.progress = nullptr;
      mine.every = 0;
      try
      {
        samples[i] = pack(mine);
      }
      catch (...)
      {
        failures[i] = std::current_exception();
      }
      ++done;
      if (reports && options.progress)
        options.progress(static_cast<double>(done) / static_cast<double>(seeds.size()), "packing");
    }
  };
  std::vector<std::thread> others;
  for (int t = 1; t < std::min<int>(threads, static_cast<int>(seeds.size())); ++t)
    others.emplace_back(work, false);
  work(true);
  for (std::thread& t : others)
    t.join();
  for (const std::exception_ptr& failure : failures)
    if (failure)
      std::rethrow_exception(failure);
  return samples;
}

} // namespace lamella::packing
