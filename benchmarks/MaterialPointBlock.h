#pragma once

#include "mpm/Orthotropic.h"
#include "mpm/PointDynamics.h"
#include "mpm/WallMaterial.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace lamella::benchmark
{

using namespace lamella::mpm;

template <int Dim>
std::shared_ptr<const PointLaw<Dim>> wood()
{
  return makeLaw<Dim, Orthotropic>({ orthotropicConstants<Dim>(OrthotropicMaterial{}) });
}

/// A block of unit cells between platens that close slowly; of `porous` ones, walls two cells thick around lumens of 9
/// × 4. Walls that yield begin sheared, so that they flow.
/// @param stiffness of the law  @param comm ranks that share it
template <int Dim>
std::unique_ptr<PointDynamics<Dim>> block(std::shared_ptr<const PointLaw<Dim>> law, double stiffness, int cells,
  int perCell, bool porous, bool fused, const Communicator& comm = Communicator(),
  Precision precision = Precision::Double)
{
  const Lattice lattice = makeLattice(cells, cells, Dim == 3 ? cells : 1, Dim, 1);
  std::vector<std::uint8_t> phase(static_cast<std::size_t>(lattice.count()), 1);
  std::vector<std::array<float, Dim>> axis(phase.size());
  for (std::size_t i = 0; i < phase.size(); ++i)
  {
    const auto n = static_cast<std::int64_t>(i);
    const std::int64_t x = n % cells;
    const std::int64_t y = n / cells % cells;
    if (porous && x % 11 >= 2 && y % 6 >= 2)
      phase[i] = 0;
    axis[i] = {};
    axis[i][0] = std::cos(0.3F * std::sin(0.1F * static_cast<float>(x)));
    axis[i][1] = std::sin(0.3F * std::sin(0.1F * static_cast<float>(x)));
  }
  PointOptions made;
  made.perNode = perCell;
  made.density = { 1 };
  made.history = law->history();
  MaterialPoints<Dim> points(0, made.history);
  if (comm.rank() == 0)
    points = pointsFromLattice<Dim>(lattice, phase, axis, made);
  if (made.history > 0)
    for (double& shear : points.column(MaterialPoints<Dim>::deformations + 1))
      shear = 0.01;

  PointDynamicsOptions<Dim> options;
  options.spacing = 1;
  options.fused = fused;
  options.precision = precision;
  options.comm = comm;
  const double speed = 0.01 * std::sqrt(stiffness); // of the wave's
  for (auto& side : options.sides)
    side = { Side{ Edge::Wall, 0 }, Side{ Edge::Wall, static_cast<double>(cells) } };
  options.sides[0] = { Side{ Edge::Wall, 0, 0, true }, Side{ Edge::Wall, static_cast<double>(cells), 0, true } };
  options.sides[1][1].velocity = -speed;
  return std::make_unique<PointDynamics<Dim>>(std::move(points), std::move(law), options);
}

} // namespace lamella::benchmark
