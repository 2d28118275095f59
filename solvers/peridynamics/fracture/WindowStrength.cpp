#include "peridynamics/fracture/WindowStrength.h"

#include "core/Error.h"
#include "core/Together.h"
#include "lattice/SubWindows.h"

#include <algorithm>
#include <cstddef>
#include <span>

namespace lamella::peridynamics
{
namespace
{

constexpr double pastThePeak = 0.9; // of it: what comes further down tells nothing of strength

} // namespace

FractureStudyOptions toThePeak(const FractureStudyOptions& sample)
{
  FractureStudyOptions o;
  o.loading = sample.loading;
  o.method = sample.method;
  o.threads = sample.threads;
  o.memory = sample.memory;
  o.displacement = false;
  o.fracture = sample.fracture;
  o.fracture.stopShare = std::max(sample.fracture.stopShare, pastThePeak);
  o.fracture.maxBroken = FractureOptions{}.maxBroken;
  o.fracture.checkpoint = {};
  o.fracture.continueFrom.clear();
  o.fracture.keepWith = {};
  o.fracture.takeBack = {};
  return o;
}

std::vector<statistics::WindowTiling> windowStrengths(const BondModel& model, const Lattice& lattice,
  std::span<const std::uint8_t> phase, std::span<const std::int32_t> grain, const FractureStudyOptions& options,
  const Communicator& comm)
{
  std::vector<statistics::WindowTiling> tilings;
  std::vector<SubWindow> all;
  for (const int parts : windowParts)
    if (const SubWindows cuts = subWindows(lattice, parts); cuts.windows.size() > 1)
    {
      tilings.push_back({ cuts.counts, std::vector<double>(cuts.windows.size(), 0.0) });
      all.insert(all.end(), cuts.windows.begin(), cuts.windows.end());
    }
  const auto ranks = static_cast<std::size_t>(comm.size());
  std::vector<double> strength(all.size(), 0.0); // of this rank's, and 0 of the others'
  FractureStudyOptions own = toThePeak(options);
  std::size_t done = 0;
  own.fracture.progress = [&](const FractureProgress& p)
  {
    if (!options.fracture.progress)
      return false;
    FractureProgress told = p;
    told.share = std::min(
      1.0, (static_cast<double>(done) + p.share * static_cast<double>(ranks)) / static_cast<double>(all.size()));
    return options.fracture.progress(told);
  };
  const auto pull = [&](const SubWindow& window)
  {
    const std::vector<std::uint8_t> ids = cut(lattice, phase, window);
    const std::vector<std::int32_t> grains = grain.empty() ? std::vector<std::int32_t>{} : cut(lattice, grain, window);
    try
    {
      return studyFracture(model, latticeOf(lattice, window), ids, grains, own, Communicator()).peak.stress;
    }
    catch (const NoPathError&)
    {
      return 0.0;
    }
    catch (const InputError&)
    {
      return 0.0; // but hinges
    }
  };
  together(comm,
    [&]
    {
      for (auto w = static_cast<std::size_t>(comm.rank()); w < all.size(); w += ranks, done += ranks)
        strength[w] = pull(all[w]);
    });
  comm.sum(strength);
  auto from = strength.begin();
  for (statistics::WindowTiling& tiling : tilings)
  {
    std::copy_n(from, tiling.values.size(), tiling.values.begin());
    from += static_cast<std::ptrdiff_t>(tiling.values.size());
  }
  return tilings;
}

} // namespace lamella::peridynamics
