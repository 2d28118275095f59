#include "peridynamics/PorePressure.h"

#include "core/Error.h"
#include "peridynamics/OwnNodes.h"
#include "peridynamics/RimExchange.h"

#include <Eigen/Dense>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace lamella::peridynamics
{
namespace
{

// kinds of nodes
constexpr std::uint8_t wallNode = 1; // 0: beyond the lattice
constexpr std::uint8_t closedPore = 2;
constexpr std::uint8_t openPore = 3;

std::array<std::int64_t, 3> axisSteps(const NodeLayout& l)
{
  return { 1, l.pitch, l.pitch * l.rowsY() };
}

/// Does a step from a node lead out of the lattice?
bool leaves(const NodeLayout& l, const std::array<bool, 3>& periodic, const std::array<std::int64_t, 3>& node,
  std::size_t axis, int side)
{
  const std::int64_t to = node[axis] + side;
  return !periodic[axis] && (to < 0 || to >= l.global[axis]);
}

} // namespace

PorePressure::PorePressure(
  const BondLattice& bonds, std::span<const std::uint8_t> phase, std::span<const std::uint8_t> chosen, bool closedSides)
  : layout_(bonds.layout())
  , kind_(bonds.layout().count())
  , removed_(bonds.layout().count())
  , closedSides_(closedSides)
{
  const NodeLayout& l = bonds.layout();
  const Communicator& comm = bonds.communicator();
  if (comm.any(static_cast<std::int64_t>(phase.size()) != l.owned()))
    throw InputError(
      fmt::format("{} phases for {} nodes, in which a pressure is to act", phase.size(), l.owned()), "give one a node");
  std::array<double, 256> wrong{}; // solid nodes of chosen phases
  std::size_t n = 0;
  eachOwnNode(l,
    [&](std::int64_t i, const std::array<std::int64_t, 3>&)
    {
      const std::uint8_t id = phase[n++];
      const bool named = std::ranges::find(chosen, id) != chosen.end();
      wrong[id] += bonds.solid(i) && named ? 1 : 0;
      kind_[i] = bonds.solid(i) ? wallNode : named || chosen.empty() ? closedPore : openPore;
    });
  comm.sum(wrong);
  for (std::size_t id = 0; id < wrong.size(); ++id)
    if (wrong[id] > 0)
      throw ParameterError(fmt::format("a pressure in phase {}, which is solid", id), "choose phases that are empty");
  const auto count = [&]
  {
    std::int64_t nodes = 0;
    eachOwnNode(
      l, [&](std::int64_t i, const std::array<std::int64_t, 3>&) { nodes += kind_[i] == closedPore ? 1 : 0; });
    return comm.sum(nodes);
  };
  const std::int64_t nodes = count();
  flood(bonds);
  const std::int64_t held = count();
  openNodes_ = nodes - held;
  volume_ = static_cast<double>(held) * std::pow(bonds.spacing(), l.dimension);
  if (nodes == 0)
    throw NoPathError("a pressure, but no pore for it: no node is of an empty phase that it acts in",
      "choose phases that are empty and that the sample has");
  if (faces_ == 0)
    throw NoPathError(fmt::format("no pore holds a pressure: all {} nodes of these phases are open to {}", openNodes_,
                        closedSides ? "other empty phases" : "a free side or to other empty phases"),
      closedSides ? "choose the other empty phases too" : "take a larger window, or straight sides, which close pores");
}

void PorePressure::flood(const BondLattice& bonds)
{
  const NodeLayout& l = bonds.layout();
  const auto step = axisSteps(l);
  const auto eachNeighbour = [&](std::int64_t i, auto&& f)
  {
    for (std::size_t a = 0; a < static_cast<std::size_t>(l.dimension); ++a)
      for (const int side : { -1, 1 })
        f(i + side * step[a], a, side);
  };
  std::vector<std::int64_t> front;
  if (!closedSides_)
    eachOwnNode(l,
      [&](std::int64_t i, const std::array<std::int64_t, 3>& node)
      {
        bool outside = false;
        for (std::size_t a = 0; a < static_cast<std::size_t>(l.dimension); ++a)
          for (const int side : { -1, 1 })
            outside = outside || leaves(l, bonds.periodic(), node, a, side);
        if (outside && kind_[i] == closedPore)
          kind_[i] = openPore;
      });
  // through this rank's nodes, then from what the rim shows of other ranks, until nothing changes anywhere
  bool changed = true;
  while (changed)
  {
    exchangeRim(l, bonds.periodic(), bonds.communicator(), kind_.data());
    front.clear();
    eachOwnNode(l,
      [&](std::int64_t i, const std::array<std::int64_t, 3>&)
      {
        bool reached = false;
        if (kind_[i] == closedPore)
          eachNeighbour(i, [&](std::int64_t j, std::size_t, int) { reached = reached || kind_[j] == openPore; });
        if (reached)
          front.push_back(i);
      });
    changed = bonds.communicator().any(!front.empty());
    for (const std::int64_t i : front)
      kind_[i] = openPore;
    while (!front.empty())
    {
      const std::int64_t i = front.back();
      front.pop_back();
      eachNeighbour(i,
        [&](std::int64_t j, std::size_t, int)
        {
          if (kind_[j] != closedPore || !l.ownedNode(l.node(j)))
            return;
          kind_[j] = openPore;
          front.push_back(j);
        });
    }
  }
  std::int64_t faces = 0;
  forEachFace([&](std::int64_t, std::size_t, int) { ++faces; });
  faces_ = bonds.communicator().sum(faces);
}

template <class F>
void PorePressure::forEachFace(F&& f) const
{
  const NodeLayout& l = layout_;
  const auto step = axisSteps(l);
  eachOwnNode(l,
    [&](std::int64_t i, const std::array<std::int64_t, 3>&)
    {
      if (kind_[i] != wallNode)
        return;
      for (std::size_t a = 0; a < static_cast<std::size_t>(l.dimension); ++a)
        for (const int side : { -1, 1 })
          if (kind_[i + side * step[a]] == closedPore)
            f(i, a, side);
    });
}

void PorePressure::apply(const BondLattice& bonds, double pressure, NodeField<double>& load) const
{
  load.fill(0);
  const double force = pressure * std::pow(bonds.spacing(), bonds.dimension() - 1);
  const auto step = axisSteps(layout_);
  const int most = bonds.stencil().layers();
  // by the node that feels it, and not by the face: that may be another rank's
  const auto felt = [&](std::int64_t i, std::int64_t towards)
  {
    for (int k = 0; k < most && kind_[i + k * towards] == wallNode; ++k)
      if (kind_[i + (k + 1) * towards] == closedPore)
      {
        const std::int64_t face = i + k * towards;
        int layers = 1;
        while (layers < most && kind_[face - layers * towards] == wallNode)
          ++layers;
        return force / layers;
      }
    return 0.0;
  };
  eachOwnNode(layout_,
    [&](std::int64_t i, const std::array<std::int64_t, 3>&)
    {
      for (int c = 0; c < layout_.dimension; ++c)
        for (const int side : { -1, 1 })
          load.component(c)[i] -= side * felt(i, side * step[static_cast<std::size_t>(c)]);
    });
  bonds.exchange(load);
}

void PorePressure::remove(const BondLattice& bonds, const std::vector<std::int64_t>& nodes)
{
  for (const std::int64_t i : nodes)
  {
    removed_[i] = 1;
    kind_[i] = closedPore;
  }
  flood(bonds);
}

void takeOutRigidMotion(const BondLattice& bonds, const PorePressure& pores, NodeField<double>& u)
{
  const NodeLayout& l = bonds.layout();
  const int d = l.dimension;
  const auto part = [&](std::int64_t i) { return bonds.solid(i) && !pores.removed(i); };
  std::array<double, 7> sums{}; // nodes, their places, their displacements
  eachOwnNode(l,
    [&](std::int64_t i, const std::array<std::int64_t, 3>& node)
    {
      if (!part(i))
        return;
      sums[0] += 1;
      for (std::size_t a = 0; a < 3; ++a)
        sums[1 + a] += static_cast<double>(node[a]);
      for (int c = 0; c < d; ++c)
        sums[4 + static_cast<std::size_t>(c)] += u.component(c)[i];
    });
  bonds.communicator().sum(sums);
  Eigen::Vector3d centre(sums[1], sums[2], sums[3]);
  Eigen::Vector3d mean(sums[4], sums[5], sums[6]);
  centre /= sums[0];
  mean /= sums[0];
  const auto from = [&](const std::array<std::int64_t, 3>& node) -> Eigen::Vector3d
  {
    return Eigen::Vector3d(static_cast<double>(node[0]), static_cast<double>(node[1]), static_cast<double>(node[2])) -
      centre;
  };
  const auto moved = [&](std::int64_t i)
  {
    Eigen::Vector3d v = Eigen::Vector3d::Zero();
    for (int c = 0; c < d; ++c)
      v[c] = u.component(c)[i];
    return v;
  };
  std::array<double, 9> moments{}; // inertia xx, yy, zz, xy, yz, zx; angular momentum
  eachOwnNode(l,
    [&](std::int64_t i, const std::array<std::int64_t, 3>& node)
    {
      if (!part(i))
        return;
      const Eigen::Vector3d x = from(node);
      const Eigen::Vector3d turn = x.cross(moved(i) - mean);
      for (int a = 0; a < 3; ++a)
      {
        const auto k = static_cast<std::size_t>(a);
        moments[k] += x.squaredNorm() - x[a] * x[a];
        moments[3 + k] -= x[a] * x[(a + 1) % 3];
        moments[6 + k] += turn[a];
      }
    });
  bonds.communicator().sum(moments);
  const auto turns = [&](int a) // about this axis
  {
    bool may = d == 3 || a == 2;
    for (int b = 0; b < d; ++b)
      may = may && (b == a || !bonds.periodic()[static_cast<std::size_t>(b)]);
    return may;
  };
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  Eigen::Vector3d momentum = Eigen::Vector3d::Zero();
  for (int a = 0; a < 3; ++a)
  {
    const int b = (a + 1) % 3;
    const auto k = static_cast<std::size_t>(a);
    inertia(a, a) = turns(a) ? moments[k] : 1;
    momentum[a] = turns(a) ? moments[6 + k] : 0;
    if (turns(a) && turns(b))
      inertia(a, b) = inertia(b, a) = moments[3 + k];
  }
  const Eigen::Vector3d rotation = inertia.completeOrthogonalDecomposition().solve(momentum);
  eachOwnNode(l,
    [&](std::int64_t i, const std::array<std::int64_t, 3>& node)
    {
      if (!part(i))
        return;
      const Eigen::Vector3d rigid = mean + rotation.cross(from(node));
      for (int c = 0; c < d; ++c)
        u.component(c)[i] -= rigid[c];
    });
  bonds.exchange(u);
}

} // namespace lamella::peridynamics
