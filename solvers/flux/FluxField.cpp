#include "flux/FluxField.h"

#include <cmath>
#include <limits>

namespace lamella::flux
{
namespace
{

using lbm::Boundary;
using lbm::Direction;

std::array<Boundary, 3> boundaries(const FluxSetting& setting)
{
  const Boundary side = setting.periodic ? Boundary::Periodic : Boundary::Insulated;
  std::array<Boundary, 3> result{ side, side, side };
  if (!setting.wraps(static_cast<std::size_t>(setting.axis)))
    result[static_cast<std::size_t>(setting.axis)] = Boundary::Fixed;
  return result;
}

Direction along(int axis, int step, int other = -1, int otherStep = 0)
{
  std::array<int, 3> d{ 0, 0, 0 };
  d[static_cast<std::size_t>(axis)] = step;
  if (other >= 0)
    d[static_cast<std::size_t>(other)] = otherStep;
  return { d[0], d[1], d[2] };
}

Node moved(Node node, const Direction& d, int times = 1)
{
  for (int axis = 0; axis < 3; ++axis)
    node[static_cast<std::size_t>(axis)] += times * d[axis];
  return node;
}

} // namespace

LinkFlux::LinkFlux(const FluxSetting& setting, lbm::Stencil stencil, std::span<const double> value,
  std::span<const std::uint8_t> phase, std::span<const double> conductivity)
  : setting_(setting)
  , links_(setting.lattice, stencil, boundaries(setting), conductivity)
  , diagonal_(stencil == lbm::Stencil::D2Q9 || stencil == lbm::Stencil::D3Q19)
  , value_(value)
  , phase_(phase)
{
}

bool LinkFlux::inside(const Node& node) const noexcept
{
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (!setting_.wraps(axis) && (node[axis] < 0 || node[axis] >= setting_.lattice.size[axis]))
      return false;
  return true;
}

double LinkFlux::link(const Node& node, const Direction& d) const
{
  const double weight = links_.weight(d, node);
  if (weight == 0)
    return 0;
  const std::size_t here = setting_.index(node);
  const std::size_t there = setting_.index(moved(node, d));
  const double conductance = weight * links_.mean(phase_[here], phase_[there], d.axis());
  const double difference = value_[here] - value_[there];
  return conductance > 0 && std::isfinite(difference) ? conductance * difference : 0.0;
}

double LinkFlux::face(const Node& node, int axis) const
{
  const auto a = static_cast<std::size_t>(axis);
  if (!setting_.wraps(a) && (node[a] == 0 || node[a] == setting_.lattice.size[a]))
  {
    if (axis != setting_.axis)
      return 0;
    const bool high = node[a] != 0;
    const std::size_t at = setting_.index(high ? moved(node, along(axis, -1)) : node);
    // From the node to the wall. These links are told by phases alone, so that the place does not matter.
    const double out = links_.wall(phase_[at], {}, setting_.axis, high) * (value_[at] - wallValue(high)) * unit();
    return std::isfinite(out) ? (high ? out : -out) : 0.0;
  }
  const Node below = moved(node, along(axis, -1));
  double sum = this->link(below, along(axis, 1));
  for (int other = 0; diagonal_ && other < setting_.lattice.dimension; ++other)
  {
    for (int step = -1; other != axis && step <= 1; step += 2)
    {
      const Direction d = along(axis, 1, other, step);
      sum += this->link(below, d) / 2; // along the axis first, then across
      const Node from = moved(node, d, -1);
      sum += inside(from) ? this->link(from, d) / 2 : 0.0; // across first
    }
  }
  return sum * unit();
}

double LinkFlux::valueAt(const Node& node, int axis) const
{
  const auto a = static_cast<std::size_t>(axis);
  const bool low = !setting_.wraps(a) && node[a] == 0;
  const bool high = !setting_.wraps(a) && node[a] == setting_.lattice.size[a];
  if ((low || high) && axis == setting_.axis)
    return wallValue(high);
  const std::size_t above = setting_.index(high ? moved(node, along(axis, -1)) : node);
  const std::size_t below = setting_.index(low ? node : moved(node, along(axis, -1)));
  const double up = links_.diffusivity(phase_[above]);
  const double down = links_.diffusivity(phase_[below]);
  if (!(up > 0) || !std::isfinite(value_[above]))
    return value_[below];
  if (!(down > 0) || !std::isfinite(value_[below]))
    return value_[above];
  return (up * value_[above] + down * value_[below]) / (up + down); // where both half links carry the same flux
}

std::array<double, 3> LinkFlux::atNode(const Node& node) const
{
  std::array<double, 3> flux{ 0, 0, 0 };
  for (const Direction& d : links_.all())
  {
    const double half = this->link(node, d) / 2 * unit();
    for (int axis = 0; axis < 3; ++axis)
      flux[static_cast<std::size_t>(axis)] += half * d[axis];
  }
  const auto a = static_cast<std::size_t>(setting_.axis);
  if (!setting_.wraps(a))
  {
    if (node[a] == 0)
      flux[a] += this->face(node, setting_.axis) / 2;
    if (node[a] == setting_.lattice.size[a] - 1)
      flux[a] += this->face(moved(node, along(setting_.axis, 1)), setting_.axis) / 2;
  }
  return flux;
}

NodeFlux::NodeFlux(const FluxSetting& setting, std::span<const double> flux, std::span<const double> value)
  : setting_(setting)
  , flux_(flux)
  , value_(value)
{
}

double NodeFlux::face(const Node& node, int axis) const
{
  const auto a = static_cast<std::size_t>(axis);
  const bool low = node[a] == 0;
  const bool high = node[a] == setting_.lattice.size[a];
  if (!setting_.wraps(a) && (low || high))
    return axis == setting_.axis ? flux_[3 * setting_.index(high ? moved(node, along(axis, -1)) : node) + a] : 0.0;
  return (flux_[3 * setting_.index(node) + a] + flux_[3 * setting_.index(moved(node, along(axis, -1))) + a]) / 2;
}

double NodeFlux::valueAt(const Node& node, int axis) const
{
  if (value_.empty())
    return std::numeric_limits<double>::quiet_NaN();
  const auto a = static_cast<std::size_t>(axis);
  const bool low = !setting_.wraps(a) && node[a] == 0;
  const bool high = !setting_.wraps(a) && node[a] == setting_.lattice.size[a];
  const double above = value_[setting_.index(high ? moved(node, along(axis, -1)) : node)];
  const double below = value_[setting_.index(low ? node : moved(node, along(axis, -1)))];
  return (above + below) / 2;
}

void continueValues(const FluxSetting& setting, std::span<double> value)
{
  const auto a = static_cast<std::size_t>(setting.axis);
  const double jump = setting.rising ? 1.0 : -1.0; // over one box length along +axis
  std::size_t at = 0;
  Node node;
  for (node[2] = setting.box.start[2]; node[2] < setting.box.start[2] + setting.box.size[2]; ++node[2])
  {
    for (node[1] = setting.box.start[1]; node[1] < setting.box.start[1] + setting.box.size[1]; ++node[1])
    {
      for (node[0] = setting.box.start[0]; node[0] < setting.box.start[0] + setting.box.size[0]; ++node[0], ++at)
        if (node[a] < 0)
          value[at] -= jump;
        else if (node[a] >= setting.lattice.size[a])
          value[at] += jump;
    }
  }
}

} // namespace lamella::flux
