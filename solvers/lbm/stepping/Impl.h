#pragma once

#include "core/Error.h"
#include "core/Mix.h"
#include "lbm/stepping/Accuracy.h"
#include "lbm/stepping/LatticeBoltzmann.h"
#include "lbm/stepping/SlotMap.h"
#include "lbm/stepping/Sweep.h"

#include <memory>
#include <string>
#include <vector>

namespace lamella::lbm
{

inline void require(bool fine, const std::string& message, const char* hint)
{
  if (!fine)
    throw ParameterError(message, hint);
}

/// A number of 30 bits from a node and what it has; their sum tells pictures and fields apart, whichever rank holds the
/// node, and does not overflow below 2^33 nodes.
inline std::int64_t mark(std::int64_t node, std::uint64_t what)
{
  return static_cast<std::int64_t>(mixed(mixed(static_cast<std::uint64_t>(node)) ^ what) >> 34);
}

/// What LatticeBoltzmann holds, for its files.
struct LatticeBoltzmann::Impl
{
  Lattice lattice;
  Communicator comm;
  Decomposition parts;
  SteppingOptions options;
  Velocities velocities;
  bool two = true; ///< relaxation times
  std::vector<double> diffusivity;
  double largest = 0;    ///< diffusivity that occurs [m²/s]
  double relaxation = 0; ///< of it
  double dt = 0;
  bool adapts = false; ///< the time step only brings the run to rest, and is chosen as the flux becomes known
  /// Mean length of the runs of each diffusivity that occurs along x, in spacings; the best comes first.
  std::vector<Chord> chords;
  std::array<double, 2> atFaces{}; ///< the largest diffusivity on the low and on the high face of the axis [m²/s]
  std::string phaseSum;            ///< tells pictures apart
  std::string initial;             ///< tells initial values apart
  std::unique_ptr<SlotMap> map;
  std::unique_ptr<Sweep> sweep;
  std::array<SlotMap::Plane, 2> planes;
  double mostSquares = 0; ///< Σ u² above which stepping has gone wrong
  std::int64_t steps = 0;
  std::int64_t stepped = 0; ///< in this object, whatever was restored
  std::int64_t savedAt = 0; ///< steps when a checkpoint was tried last
  io::CheckpointPace pace;
  std::int64_t checkpoints = 0;
  std::int64_t lastCheckpoint = 0;
  std::vector<SteppingRecord> records;
  double seconds = 0;

  Impl(const Lattice& box, MPI_Comm handle, SteppingOptions given);

  void check(const Block& block, std::span<const std::uint8_t> phase) const;
  /// Nodes that take part. @throws NoPathError
  [[nodiscard]] NodeSet participants(const Halo& halo, std::span<const std::uint8_t> phase) const;
  void chooseTime(std::span<const std::uint8_t> phase);
  /// Relaxation that comes to rest soonest where the whole box conducts like this [m²/s].
  [[nodiscard]] double restRelaxation(double effective) const;
  /// Relaxation rates of all phase ids at the present relaxation.
  [[nodiscard]] std::vector<double> rates() const;
  /// Goes on at another relaxation with the same field and flux.
  void relaxAt(double other);
  [[nodiscard]] double relaxationOf(double d) const noexcept { return relaxation * d / largest; }
  [[nodiscard]] SlotSides slotSides() const;
  void build(std::span<const std::uint8_t> phase);
  void allowUpTo(double magnitude);
  /// Populations of every stored node from f(index in the block, position).
  template <class F>
  void fill(F&& value);
  /// Calls f(node, index in the block, populations that have arrived, completed at mirrors and faces).
  template <class F>
  void forEachArrived(F&& f) const;

  /// Length between the faces and area across, in spacings.
  [[nodiscard]] double length(int axis) const;
  [[nodiscard]] double across() const;
  /// What crosses the two planes in one step, over the area across. Collective.
  [[nodiscard]] std::array<double, 2> crossing() const;
  /// The flux through the faces [m/s]; NaN where the value goes less than a node's distance deep yet. Collective.
  [[nodiscard]] std::array<double, 2> resolvedFlux() const;
  /// Are all sides but those of the axis free of given values?
  [[nodiscard]] bool onlyAxisFixed() const;
  /// How far the state is from rest when this crosses the faces in one step, over the area across: the largest relative
  /// deviation of what crosses between two planes and, with two relaxation times, of what is dissipated (at rest the
  /// flux times the fall of the value, Σ over the half links net²/(4 Λ w)). Collective.
  [[nodiscard]] double unrest(double flux, double fall) const;
  void report(double fraction, const char* what) const;
  void advance(std::int64_t count);
  [[nodiscard]] std::string scene() const;
};

template <class F>
void LatticeBoltzmann::Impl::fill(F&& value)
{
  double* f = sweep->data();
  const std::int64_t nx = parts.block().size[0];
  for (std::size_t r = 0; r < map->rows().size(); ++r)
    map->forEach(r,
      [&](std::int32_t node, std::int64_t index)
      {
        const double u = value(index, map->position(r, index - static_cast<std::int64_t>(r) * nx));
        for (int q = 0; q < velocities.count(); ++q)
          f[q * map->stride() + node] = velocities.weight[q] * u;
      });
}

template <class F>
void LatticeBoltzmann::Impl::forEachArrived(F&& f) const
{
  const double* data = sweep->data();
  const int count = velocities.count();
  std::array<double, maxPopulations> slot{};
  std::array<double, maxPopulations> arrived{};
  for (std::size_t r = 0; r < map->rows().size(); ++r)
  {
    const SlotRun* run = map->runs().data() + map->rows()[r].firstRun;
    map->forEach(r,
      [&](std::int32_t node, std::int64_t index)
      {
        while (node >= run->first + run->count)
          ++run;
        const SlotPattern& pattern = map->patterns()[run->pattern];
        for (int q = 0; q < count; ++q)
          slot[q] = data[q * map->stride() + node];
        for (int q = 0; q < count; ++q)
          arrived[q] = slot[pattern.mirror[q]];
        if (pattern.share != 0)
        {
          double known = 0;
          for (int q = 0; q < count; ++q)
            known += pattern.fixed[q] ? 0.0 : arrived[q];
          for (int q = 0; q < count; ++q)
            if (pattern.fixed[q])
              arrived[q] = velocities.weight[q] * (pattern.value - known) * pattern.share;
        }
        f(node, index, arrived);
      });
  }
}

} // namespace lamella::lbm
