#pragma once

#include "BreakableSamples.h"

#include "peridynamics/fracture/DampedPull.h"
#include "peridynamics/fracture/Fracture.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <numbers>
#include <set>

/// Whole runs of a sample that breaks, with their CPU time.
namespace lamella::benchmark
{

struct Run
{
  peridynamics::FractureRecord record;
  std::int64_t bonds = 0;
  double startSeconds = 0; ///< bonds, hierarchy and first equilibrium; CPU
  double runSeconds = 0;   ///< from there on; CPU
  [[nodiscard]] double seconds() const noexcept { return startSeconds + runSeconds; }
};

inline Run quasiStatic(const Sample& s, const peridynamics::FractureOptions& options)
{
  const Communicator comm(MPI_COMM_SELF);
  Run r;
  const double begin = cpu();
  peridynamics::BondLattice bonds(s.model, s.lattice, s.phase, s.grain, comm);
  r.bonds = bonds.bonds();
  peridynamics::QuasiStaticFracture fracture(bonds, {}, options);
  const double ready = cpu();
  fracture.run();
  r.record = fracture.record();
  r.startSeconds = ready - begin;
  r.runSeconds = cpu() - ready;
  return r;
}

/// All critical elongations by a factor.
inline void scaleStretch(peridynamics::BondModel& model, double factor)
{
  for (auto& [phases, pair] : model.pairs)
    for (peridynamics::BondMaterial* material : { &pair.material, pair.betweenGrains ? &*pair.betweenGrains : nullptr })
      if (material != nullptr && material->criticalStretch)
        *material->criticalStretch *= factor;
}

template <class Breaks>
std::set<peridynamics::Bond> bondsOf(const Breaks& broken)
{
  std::set<peridynamics::Bond> bonds;
  for (const auto& b : broken)
    bonds.insert(b.bond);
  return bonds;
}

/// Share of a's bonds that b has too.
inline double common(const std::set<peridynamics::Bond>& a, const std::set<peridynamics::Bond>& b)
{
  const auto same = std::count_if(a.begin(), a.end(), [&](const peridynamics::Bond& x) { return b.contains(x); });
  return static_cast<double>(same) / static_cast<double>(std::max<std::size_t>(1, a.size()));
}

/// The median run by time; one that takes longer than ten seconds is not repeated.
template <class T, class Seconds>
T median(int repeat, const std::function<T()>& measured, Seconds&& seconds)
{
  std::vector<T> all{ measured() };
  while (static_cast<int>(all.size()) < repeat && seconds(all.front()) < 10)
    all.push_back(measured());
  std::sort(all.begin(), all.end(), [&](const T& a, const T& b) { return seconds(a) < seconds(b); });
  return all[all.size() / 2];
}

constexpr double density = 1000; ///< of samples in motion: sets the unit of time, no more

struct PullSettings
{
  double transits = 100; ///< travel times of a wave from platen to platen until the quasi-static peak's strain
  double damping = 0.1;  ///< share of the critical one
  double tau = 1;        ///< of the regulated rate, in travel times; 0: no regulation
  double delta = 0.01;   ///< crack that gives its reference energy, over the width
  double jump = 0.98;    ///< share of the first break's strain at which it starts
  double safety = 0.8;
  double stop = 0.05; ///< share of the peak at which it ends
};

struct Motion
{
  peridynamics::DampedPullRecord record;
  double seconds = 0;    ///< CPU
  double overdamped = 0; ///< ν/m over twice the lowest frequency of the sample
};

/// @param reference of the same sample: modulus, first break, peak and last strain
inline Motion damped(const Sample& s, const peridynamics::FractureRecord& reference, const PullSettings& set)
{
  const Communicator comm(MPI_COMM_SELF);
  const double begin = cpu();
  peridynamics::BondLattice bonds(s.model, s.lattice, s.phase, s.grain, comm);
  const double travel = peridynamics::travelTime(s.lattice.length(1), reference.modulus, density);
  peridynamics::DampedPullOptions o;
  o.density = density;
  o.strainRate = reference.peak.strain / (set.transits * travel);
  o.damping = set.damping;
  o.safety = set.safety;
  o.stopShare = set.stop;
  o.startStrain = set.jump * reference.first.strain;
  o.maxStrain = 1.2 * reference.curve.back().strain + reference.peak.strain;
  if (set.tau > 0)
  {
    // The weakest phase's fracture energy times a short crack.
    const auto& soft = s.model.pairs.begin()->second.material;
    double s0 = std::numeric_limits<double>::infinity();
    for (const peridynamics::BondKind& kind : bonds.kinds())
      if (kind.criticalStretch > 0)
        s0 = std::min(s0, kind.criticalStretch);
    const double h = s.model.horizon * s.lattice.spacing;
    const double gc = 9 * soft.youngsModulus * h * s0 * s0 / (4 * std::numbers::pi);
    o.rate.emplace(set.tau * travel, gc * set.delta * s.lattice.length(0), 1);
  }
  Motion m{ peridynamics::pullApart(bonds, {}, o), 0, 0 };
  const double mass = density * s.lattice.spacing * s.lattice.spacing;
  m.overdamped = m.record.viscosity / mass / (2 * std::numbers::pi / travel);
  m.seconds = cpu() - begin;
  return m;
}

} // namespace lamella::benchmark
