// What material points keep on disk, and how they go on from it.
#include "core/Error.h"
#include "mpm/FusedStep.h"
#include "mpm/PointDynamics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace lamella::mpm
{
namespace
{

constexpr int valuesASide = 4; // position, velocity, force, impulse

} // namespace

template <int Dim>
void PointDynamics<Dim>::keep(io::Checkpoint& checkpoint) const
{
  const bool several = options_.comm.parallel();
  const auto all = several ? std::make_shared<const MaterialPoints<Dim>>(gather()) : nullptr;
  const MaterialPoints<Dim>& points = several ? *all : points_;
  const auto count = static_cast<std::int64_t>(points.count());
  io::CheckpointArray& table = checkpoint.arrays["points"];
  table = { { points.numbers(), count }, {}, "SI",
    "by component: position, velocity, gradient of velocity, deformation gradient, mass, initial volume, wall axis, "
    "history" };
  table.columns = [this, all, &points](std::int64_t begin, std::int64_t end, std::span<double> values)
  {
    const auto first = static_cast<std::size_t>(begin);
    const auto each = static_cast<std::size_t>(end - begin);
    for (int n = 0; n < points.numbers(); ++n)
      if (const int c = MaterialPoints<Dim>::columnOf(n); c >= 0)
        std::copy_n(points.column(c).begin() + begin, each, values.begin() + n * (end - begin));
    for (std::size_t p = 0; p < each; ++p)
    {
      const Matrix<Dim> c = all ? points.affine(first + p) : affine(first + p);
      for (std::size_t i = 0; i < Dim * Dim; ++i)
        values[(2 * Dim + i) * each + p] = c.m[i];
    }
  };
  checkpoint.arrays["phase"] = { { count }, std::vector<std::int64_t>(points.phase().begin(), points.phase().end()), "",
    "phase of each point" };
  checkpoint.arrays["id"] = { { count }, std::vector<std::int64_t>(points.id().begin(), points.id().end()), "",
    "number of each point" };
  std::vector<double> sides;
  std::vector<std::int64_t> cells;
  for (int a = 0; a < Dim; ++a)
  {
    for (int side = 0; side < 2; ++side)
      sides.insert(
        sides.end(), { position(a, side), walls_(a, side).velocity, walls_(a, side).force, impulse(a, side) });
    cells.push_back(grid_.axis(a).cells);
  }
  checkpoint.arrays["sides"] = { { Dim, 2, valuesASide }, std::move(sides), "SI",
    "of each end of each axis: position, velocity, force, impulse" };
  checkpoint.arrays["cells"] = { { Dim }, std::move(cells), "", "of the grid along each axis" };
  checkpoint.numbers["steps"] = static_cast<double>(step_);
  checkpoint.numbers["time"] = time_;
  checkpoint.numbers["step"] = dt_;
  checkpoint.numbers["last step"] = before_;
  checkpoint.numbers["wave factor"] = factor_;
  checkpoint.numbers["supplied energy"] = supplied_;
  checkpoint.numbers["initial energy"] = initial_;
  checkpoint.numbers["initial moment"] = options_.comm.sum(startMoment_);
  checkpoint.numbers["even steps to"] = static_cast<double>(evenTo_);
  checkpoint.numbers["even step"] = evenStep_;
  // so that a run that goes on has them to the last bit
  if (looked_.stiffestAt == step_ && std::isfinite(looked_.stiffest))
    checkpoint.numbers["greatest stiffness"] = looked_.stiffest;
  if (looked_.elasticAt == step_)
    checkpoint.numbers["elastic energy"] = looked_.elastic;
  if (looked_.kineticAt == step_)
    checkpoint.numbers["kinetic energy"] = looked_.kinetic;
  if (fused_ && !several)
    fused_->keep(checkpoint);
  checkpoint.arrays["wave"] = { { static_cast<std::int64_t>(measured_.field().size()) }, measured_.field(), "",
    "by node, the fastest oscillation as it was found last" };
}

template <int Dim>
void PointDynamics<Dim>::sortAnew()
{
  if (fused_)
    fused_->forget();
}

template <int Dim>
void PointDynamics<Dim>::takeBack(const io::Checkpoint& checkpoint)
{
  const std::vector<double>& columns = checkpoint.reals("points");
  const auto& phases = checkpoint.integers("phase");
  const auto& ids = checkpoint.integers("id");
  const auto& sides = checkpoint.reals("sides");
  const auto& cells = checkpoint.integers("cells");
  const auto count = static_cast<std::size_t>(count_);
  if (columns.size() != count * static_cast<std::size_t>(points_.numbers()) || phases.size() != count ||
    ids.size() != count || sides.size() != static_cast<std::size_t>(Dim * 2 * valuesASide) ||
    cells.size() != static_cast<std::size_t>(Dim))
    throw InputError(fmt::format("the checkpoint is not of {} material points", count), "start the run anew");
  for (const char* const name : { "points", "sides", "time", "step", "last step", "wave factor" })
    checkpoint.expectFinite(name);
  // of this run's own points; on several ranks each has a share, and none may have all phases
  const auto own = std::max_element(points_.phase().begin(), points_.phase().end());
  const std::int64_t mostPhases =
    1 + static_cast<std::int64_t>(options_.comm.max(own == points_.phase().end() ? 0.0 : static_cast<double>(*own)));
  for (std::size_t p = 0; p < count; ++p)
    if (phases[p] < 0 || phases[p] >= mostPhases || ids[p] < 0 || ids[p] >= count_)
      throw InputError(
        fmt::format("the checkpoint's material point {} has phase {} and number {}", p, phases[p], ids[p]),
        "start the run anew");
  for (int a = 0; a < Dim; ++a)
  {
    const auto axis = static_cast<std::size_t>(a);
    const double low = sides[axis * 2 * valuesASide];
    const double high = sides[(axis * 2 + 1) * valuesASide];
    const double room = high - low;
    bool inside = room > 0 && cells[axis] > 0 && cells[axis] <= 4 * std::int64_t{ grid_.axis(a).cells } + 16;
    for (std::size_t p = 0; p < count && inside; ++p) // a rim of cells lies around the sides
      inside = columns[axis * count + p] > low - room && columns[axis * count + p] < high + room;
    if (!inside)
      throw InputError(
        fmt::format("the checkpoint's box is {} cells from {} to {} along {}, and not that of its points", cells[axis],
          low, high, "xyz"[axis]),
        "start the run anew");
  }
  // a share on each rank; the first step sends them where they belong
  const auto rank = static_cast<std::size_t>(options_.comm.rank());
  const auto ranks = static_cast<std::size_t>(options_.comm.size());
  const std::size_t first = count * rank / ranks;
  const int history = points_.history();
  points_ = MaterialPoints<Dim>(); // there is room for one
  points_ = MaterialPoints<Dim>(count * (rank + 1) / ranks - first, history);
  points_.storeAffines();
  for (std::size_t p = 0; p < points_.count(); ++p)
  {
    for (int n = 0; n < points_.numbers(); ++n)
    {
      const int c = MaterialPoints<Dim>::columnOf(n);
      points_.column(c < 0 ? points_.affines() + n - 2 * Dim : c)[p] =
        columns[static_cast<std::size_t>(n) * count + first + p];
    }
    points_.phase()[p] = static_cast<std::uint8_t>(phases[first + p]);
    points_.id()[p] = static_cast<std::uint32_t>(ids[first + p]);
  }
  auto value = sides.begin();
  std::array<GridAxis, Dim> axes = grid_.axes();
  for (int a = 0; a < Dim; ++a)
  {
    for (int side = 0; side < 2; ++side)
    {
      options_.sides[static_cast<std::size_t>(a)][static_cast<std::size_t>(side)].position = *value++;
      walls_(a, side).velocity = *value++;
      walls_(a, side).force = *value++;
      impulse_[static_cast<std::size_t>(a)][static_cast<std::size_t>(side)] = *value++;
    }
    axes[static_cast<std::size_t>(a)].cells = static_cast<int>(cells[static_cast<std::size_t>(a)]);
  }
  grid_.set(axes); // the number of cells: the rest is laid from the sides
  layGrid(false);
  step_ = checkpoint.count("steps");
  time_ = checkpoint.number("time");
  dt_ = checkpoint.number("step");
  before_ = checkpoint.number("last step");
  factor_ = checkpoint.number("wave factor");
  supplied_ = checkpoint.number("supplied energy");
  initial_ = checkpoint.number("initial energy");
  startMoment_ = rank == 0 ? checkpoint.number("initial moment") : 0;
  if (checkpoint.numbers.contains("even step")) // earlier versions had none of these
  {
    checkpoint.expectFinite("even step");
    evenTo_ = checkpoint.count("even steps to");
    evenStep_ = checkpoint.number("even step");
  }
  looked_ = {};
  const auto known = [&](const char* name, std::int64_t& at, double& sum) // nor these, and there may be none
  {
    if (!checkpoint.numbers.contains(name))
      return;
    checkpoint.expectFinite(name);
    at = step_;
    sum = checkpoint.number(name);
  };
  known("greatest stiffness", looked_.stiffestAt, looked_.stiffest);
  if (!(looked_.stiffest > 0)) // of no points that there are: they are looked at
    looked_.stiffestAt = -1;
  known("elastic energy", looked_.elasticAt, looked_.elastic);
  known("kinetic energy", looked_.kineticAt, looked_.kinetic);
  if (checkpoint.arrays.contains("wave"))
    measured_.takeBack(checkpoint.reals("wave"));
  if (fused_ && !options_.comm.parallel())
    fused_->takeBack(checkpoint, grid_);
  else if (fused_)
    fused_->startAnew();
}

template void PointDynamics<2>::keep(io::Checkpoint&) const;
template void PointDynamics<3>::keep(io::Checkpoint&) const;
template void PointDynamics<2>::sortAnew();
template void PointDynamics<3>::sortAnew();
template void PointDynamics<2>::takeBack(const io::Checkpoint&);
template void PointDynamics<3>::takeBack(const io::Checkpoint&);

} // namespace lamella::mpm
