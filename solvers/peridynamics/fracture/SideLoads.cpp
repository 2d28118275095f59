#include "peridynamics/fracture/SideLoads.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lamella::peridynamics
{
namespace
{

/// Calls f(position) for the solid nodes of a box that this rank owns.
template <class F>
void eachSolid(const BondLattice& bonds, const NodeBox& box, F&& f)
{
  const NodeLayout& l = bonds.layout();
  std::array<std::int64_t, 3> low{};
  std::array<std::int64_t, 3> high{};
  for (std::size_t a = 0; a < 3; ++a)
  {
    low[a] = std::max<std::int64_t>(0, box.low[a] - l.start[a]);
    high[a] = std::min(l.size[a], box.high[a] - l.start[a]);
  }
  for (std::int64_t z = low[2]; z < high[2]; ++z)
    for (std::int64_t y = low[1]; y < high[1]; ++y)
      for (std::int64_t x = low[0]; x < high[0]; ++x)
        if (const std::int64_t i = l.index(x, y, z); bonds.solid(i))
          f(i);
}

} // namespace

NodeBox nodesBetween(const Lattice& lattice, const std::array<double, 3>& low, const std::array<double, 3>& high)
{
  constexpr double slack = 1e-6;
  NodeBox box{ { 0, 0, 0 }, { 1, 1, 1 } };
  for (int c = 0; c < lattice.dimension; ++c)
  {
    const auto a = static_cast<std::size_t>(c);
    const auto number = [&](double position) { return (position - lattice.origin[a]) / lattice.spacing; };
    const auto last = static_cast<double>(lattice.size[a]);
    box.low[a] = static_cast<std::int64_t>(std::clamp(std::ceil(number(low[a]) - slack), 0.0, last));
    box.high[a] = static_cast<std::int64_t>(std::clamp(std::floor(number(high[a]) + slack) + 1, 0.0, last));
  }
  return box;
}

NodeBox sideLayers(const Lattice& lattice, int axis, bool high, std::int64_t layers)
{
  NodeBox box{ { 0, 0, 0 }, lattice.size };
  const auto a = static_cast<std::size_t>(axis);
  if (high)
    box.low[a] = std::max<std::int64_t>(0, lattice.size[a] - layers);
  else
    box.high[a] = std::min(lattice.size[a], layers);
  return box;
}

NodeField<double> tractionLoad(const BondLattice& bonds, std::span<const SideTraction> tractions)
{
  const NodeLayout& l = bonds.layout();
  const int d = l.dimension;
  Lattice whole;
  whole.size = l.global;
  NodeField<double> load(l);
  for (const SideTraction& side : tractions)
  {
    if (side.axis < 0 || side.axis >= d)
      throw ParameterError(
        fmt::format("a traction on axis {} in {} dimensions", side.axis, d), "use x, y or, in 3D, z: 0, 1 or 2");
    const auto a = static_cast<std::size_t>(side.axis);
    if (bonds.periodic()[a])
      throw ParameterError(fmt::format("a traction on {}, along which the sample is periodic", "xyz"[side.axis]),
        "make that direction not periodic");
    const int layers = side.layers > 0 ? side.layers : bonds.stencil().layers();
    if (layers > l.global[a])
      throw ParameterError(fmt::format("a traction on {} layers of a sample that has {}", layers, l.global[a]),
        "give fewer layers, or a larger sample");
    for (int c = 0; c < d; ++c)
      if (const double value = side.traction[static_cast<std::size_t>(c)]; !std::isfinite(value))
        throw ParameterError(fmt::format("a traction of {} Pa along {}", value, "xyz"[c]), "give a number");
    const double area = std::pow(bonds.spacing(), d - 1) / layers;
    eachSolid(bonds, sideLayers(whole, side.axis, side.high, layers),
      [&](std::int64_t i)
      {
        for (int c = 0; c < d; ++c)
          load.component(c)[i] += area * side.traction[static_cast<std::size_t>(c)];
      });
  }
  return load;
}

ImposedMotion imposeMotion(const BondLattice& bonds, std::span<const MovedNodes> moved)
{
  const NodeLayout& l = bonds.layout();
  ImposedMotion motion{ FixedComponents(l.count()), NodeField<double>(l) };
  for (std::size_t k = 0; k < moved.size(); ++k)
  {
    bool any = false;
    for (int c = 0; c < l.dimension; ++c)
      if (const auto& value = moved[k].velocity[static_cast<std::size_t>(c)]; value && !std::isfinite(*value))
        throw ParameterError(fmt::format("a velocity of {} m/s along {}", *value, "xyz"[c]), "give a number");
    eachSolid(bonds, moved[k].box,
      [&](std::int64_t i)
      {
        any = true;
        for (int c = 0; c < l.dimension; ++c)
          if (const auto& value = moved[k].velocity[static_cast<std::size_t>(c)])
          {
            motion.fixed[i] = static_cast<std::uint8_t>(motion.fixed[i] | (1U << c));
            motion.velocity.component(c)[i] = *value;
          }
      });
    if (!bonds.communicator().any(any))
      throw ParameterError(
        fmt::format("there is no solid node in box {} of moved nodes", k + 1), "move the box, or make it larger");
  }
  return motion;
}

} // namespace lamella::peridynamics
