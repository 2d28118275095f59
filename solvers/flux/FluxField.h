#pragma once

#include "lattice/Lattice.h"
#include "lbm/Links.h"
#include "lbm/SteadyDiffusion.h"

#include <array>
#include <cstdint>
#include <span>

namespace lamella::flux
{

/// A node by its place in the whole lattice; one beyond it along periodic axes and in ghost layers.
using Node = std::array<std::int64_t, 3>;

/// Flux through the faces between nodes, on a box of nodes: a rank's block and one layer around it, which along
/// periodic axes reaches beyond the lattice and elsewhere ends with it. All fluxes are per metre of spacing.
class FluxField
{
public:
  virtual ~FluxField() = default;

  /// Flux along +axis through the low face of a node (half a spacing below it). With node[axis] = size[axis] it is the
  /// high face of the last node. The node's block and its neighbours are within the box.
  [[nodiscard]] virtual double face(const Node& node, int axis) const = 0;

  /// The diffusing quantity on that face.
  [[nodiscard]] virtual double valueAt(const Node& node, int axis) const = 0;
};

/// What both kinds of field are made on.
struct FluxSetting
{
  Lattice lattice;
  lbm::Block box;         ///< see FluxField
  int axis = 0;           ///< direction of the mean gradient
  bool periodic = false;  ///< every side; else values 1 and 0 on the two faces of `axis`, no flux through others
  bool transient = false; ///< values on the two faces of `axis` though the others are periodic
  bool rising = false;    ///< the value rises along +axis: 0 on the low face, 1 on the high one

  [[nodiscard]] bool wraps(std::size_t a) const noexcept
  {
    return periodic && !(transient && a == static_cast<std::size_t>(axis));
  }
  [[nodiscard]] std::size_t index(const Node& node) const noexcept
  {
    return static_cast<std::size_t>(
      (node[0] - box.start[0]) + box.size[0] * ((node[1] - box.start[1]) + box.size[1] * (node[2] - box.start[2])));
  }
};

/// Fluxes from values and conductivities over the very links that the solver used (lbm/Links.h), so that what flows
/// into a node also flows out of it. A diagonal link counts half along each of the two paths round its corner.
class LinkFlux final : public FluxField
{
public:
  /// @param value   of the box's nodes; not finite: carries nothing. Periodic: the nodes beyond the lattice must hold
  ///                the value a box length further on (see continueValues())
  /// @param phase   ids of the box's nodes
  /// @param conductivity by id
  LinkFlux(const FluxSetting& setting, lbm::Stencil stencil, std::span<const double> value,
    std::span<const std::uint8_t> phase, std::span<const double> conductivity);

  [[nodiscard]] double face(const Node& node, int axis) const override;
  [[nodiscard]] double valueAt(const Node& node, int axis) const override;

  /// The node's flux vector: half of every link's flux, as lbm::SteadyDiffusion::flux() has it.
  [[nodiscard]] std::array<double, 3> atNode(const Node& node) const;

private:
  [[nodiscard]] double link(const Node& node, const lbm::Direction& d) const;
  [[nodiscard]] bool inside(const Node& node) const noexcept;
  [[nodiscard]] double wallValue(bool high) const noexcept { return high == setting_.rising ? 1.0 : 0.0; }
  [[nodiscard]] double unit() const noexcept { return links_.scale() / setting_.lattice.spacing; }

  FluxSetting setting_;
  lbm::Links links_;
  bool diagonal_;
  std::span<const double> value_;
  std::span<const std::uint8_t> phase_;
};

/// Fluxes from flux vectors at nodes alone: a face takes the mean of its two nodes. Not exactly conservative, so lines
/// may end where LinkFlux would lead them on.
class NodeFlux final : public FluxField
{
public:
  /// @param flux  3 numbers a node of the box
  /// @param value of the box's nodes, or empty
  NodeFlux(const FluxSetting& setting, std::span<const double> flux, std::span<const double> value);

  [[nodiscard]] double face(const Node& node, int axis) const override;
  [[nodiscard]] double valueAt(const Node& node, int axis) const override;

private:
  FluxSetting setting_;
  std::span<const double> flux_;
  std::span<const double> value_;
};

/// Periodic fields: adds the jump of one box length to the values of the box's nodes that lie beyond the lattice along
/// the axis of the gradient.
void continueValues(const FluxSetting& setting, std::span<double> value);

} // namespace lamella::flux
