// What material points keep on disk, and how they go on from it.
#include "lattice/Error.h"
#include "mpm/FusedStep.h"
#include "mpm/PointDynamics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

namespace lamella::mpm
{
namespace
{

constexpr int valuesASide = 4; // position, velocity, force, impulse

} // namespace

template <int Dim>
void PointDynamics<Dim>::keep(io::Checkpoint& checkpoint)
{
  const auto count = static_cast<std::int64_t>(points_.count());
  std::vector<double> columns;
  columns.reserve(points_.count() * static_cast<std::size_t>(points_.columns()));
  for (int c = 0; c < points_.columns(); ++c)
    columns.insert(columns.end(), points_.column(c).begin(), points_.column(c).end());
  checkpoint.arrays["points"] = { { points_.columns(), count }, std::move(columns), "SI",
    "by component: position, velocity, gradient of velocity, deformation gradient, mass, initial volume, wall axis, "
    "history" };
  checkpoint.arrays["phase"] = { { count }, std::vector<std::int64_t>(points_.phase().begin(), points_.phase().end()),
    "", "phase of each point" };
  checkpoint.arrays["id"] = { { count }, std::vector<std::int64_t>(points_.id().begin(), points_.id().end()), "",
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
  checkpoint.numbers["initial moment"] = startMoment_;
  if (fused_)
    fused_->forget(); // the run that goes on sorts its points too
}

template <int Dim>
void PointDynamics<Dim>::takeBack(const io::Checkpoint& checkpoint)
{
  const std::vector<double>& columns = checkpoint.reals("points");
  const auto& phases = checkpoint.integers("phase");
  const auto& ids = checkpoint.integers("id");
  const auto& sides = checkpoint.reals("sides");
  const auto& cells = checkpoint.integers("cells");
  if (columns.size() != points_.count() * static_cast<std::size_t>(points_.columns()) ||
    phases.size() != points_.count() || ids.size() != points_.count() ||
    sides.size() != static_cast<std::size_t>(Dim * 2 * valuesASide) || cells.size() != static_cast<std::size_t>(Dim))
    throw InputError(fmt::format("the checkpoint is not of {} material points", points_.count()), "start the run anew");
  for (int c = 0; c < points_.columns(); ++c)
    std::copy_n(columns.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(c) * points_.count()),
      points_.count(), points_.column(c).begin());
  std::transform(
    phases.begin(), phases.end(), points_.phase().begin(), [](std::int64_t i) { return static_cast<std::uint8_t>(i); });
  std::transform(
    ids.begin(), ids.end(), points_.id().begin(), [](std::int64_t i) { return static_cast<std::uint32_t>(i); });
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
  step_ = static_cast<std::int64_t>(checkpoint.number("steps"));
  time_ = checkpoint.number("time");
  dt_ = checkpoint.number("step");
  before_ = checkpoint.number("last step");
  factor_ = checkpoint.number("wave factor");
  supplied_ = checkpoint.number("supplied energy");
  initial_ = checkpoint.number("initial energy");
  startMoment_ = checkpoint.number("initial moment");
  if (fused_)
    fused_->forget();
}

template void PointDynamics<2>::keep(io::Checkpoint&);
template void PointDynamics<3>::keep(io::Checkpoint&);
template void PointDynamics<2>::takeBack(const io::Checkpoint&);
template void PointDynamics<3>::takeBack(const io::Checkpoint&);

} // namespace lamella::mpm
