#include "peridynamics/fracture/MotionHistory.h"

#include "core/Error.h"

#include <algorithm>

namespace lamella::peridynamics
{
namespace
{

/// Calls f with each number of a point, in an order that files keep.
template <class Point, class F>
void eachNumber(Point& p, F&& f)
{
  f(p.time);
  f(p.strain);
  f(p.stress);
  f(p.rate);
  f(p.energies.kinetic);
  f(p.energies.elastic);
  f(p.energies.broken);
  f(p.energies.damped);
  f(p.energies.supplied);
  f(p.energies.initial);
}

constexpr std::size_t numbers = 10;

} // namespace

void MotionHistory::add(const MotionPoint& point)
{
  points_.push_back(point);
  peak_ = std::max(peak_, point.stress);
}

void MotionHistory::put(io::Checkpoint& checkpoint) const
{
  std::vector<std::int64_t> counts;
  std::vector<double> values;
  for (const MotionPoint& p : points_)
  {
    counts.insert(counts.end(), { p.step, p.broken });
    eachNumber(p, [&](double value) { values.push_back(value); });
  }
  const auto rows = static_cast<std::int64_t>(points_.size());
  checkpoint.arrays["history_counts"] = { { rows, 2 }, std::move(counts), "", "step, broken bonds" };
  checkpoint.arrays["history"] = { { rows, static_cast<std::int64_t>(numbers) }, std::move(values), "",
    "time, strain, stress, rate; energies: kinetic, elastic, broken, damped, supplied, initial" };
}

void MotionHistory::take(const io::Checkpoint& checkpoint)
{
  const std::vector<std::int64_t>& counts = checkpoint.integers("history_counts");
  const std::vector<double>& values = checkpoint.reals("history");
  if (counts.size() % 2 != 0 || values.size() != numbers * (counts.size() / 2))
    throw InputError("the checkpoint's history is not as long everywhere", "start the run anew");
  points_.clear();
  for (std::size_t row = 0; row < counts.size() / 2; ++row)
  {
    MotionPoint p;
    p.step = counts[2 * row];
    p.broken = counts[2 * row + 1];
    std::size_t at = numbers * row;
    eachNumber(p, [&](double& value) { value = values[at++]; });
    add(p);
  }
}

} // namespace lamella::peridynamics
