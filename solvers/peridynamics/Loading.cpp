#include "peridynamics/Loading.h"

#include "core/Error.h"
#include "core/Plausible.h"
#include "peridynamics/BondForces.h"
#include "peridynamics/Fragments.h"
#include "peridynamics/OwnNodes.h"
#include "peridynamics/multigrid/FreeBlocks.h"

#include <fmt/format.h>

#include <cmath>

namespace lamella::peridynamics
{
namespace
{

void check(const BondLattice& bonds, const Loading& loading, int axis, int layers)
{
  for (const auto& [name, value] : { std::pair{ "strain", loading.strain }, { "lateral strain", loading.lateralStrain },
         { "traction", loading.traction }, { "pressure", loading.pressure } })
    if (!std::isfinite(value))
      throw ParameterError(fmt::format("the {} {} is not a finite number", name, value), "give a number, such as 1e-3");
    else if (value != 0 && !plausible(value))
      throw ParameterError(
        fmt::format("the {} {:g} is not between 1e-30 and 1e30 in size", name, value), "give a number, such as 1e-3");
  if (loading.load == LoadCase::Pressure)
  {
    if (loading.pressure == 0)
      throw ParameterError("the pressure is 0: nothing is loaded", "give it in Pa; suction is negative");
    for (int a = 0; a < bonds.dimension() && loading.straightSides; ++a)
      if (const std::int64_t m = bonds.layout().global[static_cast<std::size_t>(a)];
          !bonds.periodic()[static_cast<std::size_t>(a)] && m <= 2 * layers)
        throw ParameterError(
          fmt::format("two straight sides of {} layers leave nothing of {} nodes along {}", layers, m, "xyz"[a]),
          "a larger sample, a finer spacing or a smaller horizon");
    return;
  }
  const char names[] = { 'x', 'y', 'z' };
  for (int a = 0; a < bonds.dimension(); ++a)
    if ((a == axis || loading.load == LoadCase::Biaxial) && bonds.periodic()[static_cast<std::size_t>(a)])
      throw ParameterError(fmt::format("the sample is periodic along {}, where a platen is to hold it", names[a]),
        "make that direction not periodic, or load the periodic cell by a mean strain");
  const std::int64_t n = bonds.layout().global[static_cast<std::size_t>(axis)];
  if (n <= 2 * layers)
    throw ParameterError(
      fmt::format("two platens of {} layers leave nothing of a sample of {} nodes along {}", layers, n, names[axis]),
      "a larger sample, a finer spacing or a smaller horizon");
}

// Pieces that no platen holds are fixed where they are; some piece has to go from one platen to the other.
void takeOutLoosePieces(const BondLattice& bonds, LoadedSample& s, int axis)
{
  const NodeLayout& l = bonds.layout();
  // which platen a node belongs to, as bits for findFragments()
  AlignedArray<std::uint8_t> platen(l.count());
  eachOwnNode(l,
    [&](std::int64_t i, const std::array<std::int64_t, 3>& node)
    {
      const std::int64_t layer = node[static_cast<std::size_t>(axis)];
      platen[i] = static_cast<std::uint8_t>(
        (layer < s.lowLayers[1] ? 1 : 0) | (layer >= s.highLayers[0] ? 2 : 0) | (s.fixed[i] != 0 ? 4 : 0));
    });
  const Fragments fragments = findFragments(bonds, &platen);
  bool path = false;
  for (const Fragment& f : fragments.pieces)
    path = path || (f.fixed & 3U) == 3;
  if (!path)
    throw NoPathError(fmt::format("no piece of the sample reaches from one platen to the other along {}: it is in {} "
                                  "pieces",
                        "xyz"[axis], fragments.pieces.size()),
      "look at its phases; a longer horizon or more matrix would join them");
  for (const Fragment& f : fragments.pieces)
    if ((f.fixed & 4U) == 0)
    {
      ++s.loosePieces;
      s.looseNodes += f.nodes;
    }
  if (s.loosePieces == 0)
    return;
  eachOwnNode(l,
    [&](std::int64_t i, const std::array<std::int64_t, 3>&)
    {
      if (fragments.piece[i] < 0 || (fragments.pieces[static_cast<std::size_t>(fragments.piece[i])].fixed & 4U) != 0)
        return;
      s.fixed[i] = allComponents(l.dimension);
      for (int c = 0; c < l.dimension; ++c)
      {
        s.displacement.component(c)[i] = 0;
        if (s.load)
          s.load->component(c)[i] = 0;
      }
    });
}

// Straight sides hold the component across them.
void holdSides(const BondLattice& bonds, int layers, LoadedSample& s)
{
  const NodeLayout& l = bonds.layout();
  eachOwnNode(l,
    [&](std::int64_t i, const std::array<std::int64_t, 3>& node)
    {
      if (!bonds.solid(i))
        return;
      for (std::size_t a = 0; a < static_cast<std::size_t>(l.dimension); ++a)
        if (!bonds.periodic()[a] && (node[a] < layers || node[a] >= l.global[a] - layers))
          s.fixed[i] = static_cast<std::uint8_t>(s.fixed[i] | (1U << a));
    });
}

// The rim of bit masks, by way of a field.
void exchangeFixed(const BondLattice& bonds, FixedComponents& fixed)
{
  NodeField<float> bits(bonds.layout(), 1);
  for (std::int64_t i = 0; i < fixed.size(); ++i)
    bits.component(0)[i] = static_cast<float>(fixed[i]);
  bonds.exchange(bits);
  for (std::int64_t i = 0; i < fixed.size(); ++i)
    fixed[i] = static_cast<std::uint8_t>(bits.component(0)[i]);
}

} // namespace

LostPieces looseUnderPressure(const BondLattice& bonds, LoadedSample& s)
{
  const NodeLayout& l = bonds.layout();
  constexpr std::uint8_t held = 1;
  constexpr std::uint8_t lost = 2; // before
  AlignedArray<std::uint8_t> marks(l.count());
  eachOwnNode(l,
    [&](std::int64_t i, const std::array<std::int64_t, 3>&)
    {
      if (bonds.solid(i))
        marks[i] = s.pores->removed(i) ? lost : s.fixed[i] != 0 ? held : 0;
    });
  const Fragments fragments = findFragments(bonds, &marks);
  const Fragment* largest = nullptr;
  s.held = false;
  for (const Fragment& f : fragments.pieces)
    if ((f.fixed & lost) == 0)
    {
      s.held = s.held || (f.fixed & held) != 0;
      if (largest == nullptr || f.nodes > largest->nodes)
        largest = &f;
    }
  const auto stays = [&](const Fragment& f) { return s.held ? (f.fixed & held) != 0 : &f == largest; };
  LostPieces result;
  for (const Fragment& f : fragments.pieces)
    if ((f.fixed & lost) == 0 && !stays(f))
    {
      ++result.pieces;
      result.nodes += f.nodes;
    }
  if (result.pieces == 0)
    return result;
  std::vector<std::int64_t> nodes; // of this rank
  eachOwnNode(l,
    [&](std::int64_t i, const std::array<std::int64_t, 3>&)
    {
      if (fragments.piece[i] < 0 || s.pores->removed(i) ||
        stays(fragments.pieces[static_cast<std::size_t>(fragments.piece[i])]))
        return;
      nodes.push_back(i);
      s.fixed[i] = allComponents(l.dimension);
      for (int c = 0; c < l.dimension; ++c)
        s.displacement.component(c)[i] = 0;
    });
  s.pores->remove(bonds, nodes);
  exchangeFixed(bonds, s.fixed);
  for (std::int64_t z = 0; z < l.size[2]; ++z)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
      bonds.forEachBond(y, z,
        [&](std::int64_t i, std::int64_t, int o, int)
        {
          if (l.ownedNode(l.node(i)) && s.pores->removed(i))
            result.bonds.push_back(bonds.bond(i, o));
        });
  s.pores->apply(bonds, s.pressure, *s.load);
  return result;
}

double poreStrain(const BondLattice& bonds, const LoadedSample& sample, const NodeField<double>& u)
{
  double work = 0;
  eachOwnNode(u.layout(),
    [&](std::int64_t i, const std::array<std::int64_t, 3>&)
    {
      for (int c = 0; c < u.components(); ++c)
        work += sample.load->component(c)[i] * u.component(c)[i];
    });
  return bonds.communicator().sum(work) / (sample.pressure * sample.pores->volume());
}

double workOfResidual(
  const BondLattice& bonds, const LoadedSample& sample, const NodeField<double>& u, const NodeField<double>& force)
{
  std::array<double, 2> sums{};
  eachOwnNode(bonds.layout(),
    [&](std::int64_t i, const std::array<std::int64_t, 3>&)
    {
      for (int c = 0; c < u.components(); ++c)
        if ((sample.fixed[i] >> c & 1U) == 0)
        {
          sums[0] += u.component(c)[i] * force.component(c)[i];
          sums[1] += u.component(c)[i] * sample.load->component(c)[i];
        }
    });
  bonds.communicator().sum(sums);
  return std::abs(sums[0] / sums[1]);
}

LoadedSample applyLoading(const BondLattice& bonds, const Loading& loading, std::span<const std::uint8_t> phase)
{
  const NodeLayout& l = bonds.layout();
  const int d = l.dimension;
  const int axis = loading.axis < 0 ? d - 1 : loading.axis;
  if (axis >= d)
    throw ParameterError(fmt::format("there is no axis {} in {} dimensions", axis, d), "use x, y or, in 3D, z");
  const int layers = loading.layers > 0 ? loading.layers : bonds.stencil().layers();
  check(bonds, loading, axis, layers);

  LoadedSample s;
  s.fixed = FixedComponents(l.count());
  s.displacement = NodeField<double>(l);
  const auto a = static_cast<std::size_t>(axis);
  const std::int64_t n = l.global[a];
  if (loading.load == LoadCase::Pressure)
  {
    s.pressure = loading.pressure;
    s.pores.emplace(bonds, phase, loading.pressureIn, loading.straightSides);
    s.load.emplace(l);
    s.highLayers = { n, n };
    if (loading.straightSides)
    {
      holdSides(bonds, layers, s);
      s.lowLayers = { 0, layers };
      s.highLayers = { n - layers, n };
    }
    s.pores->apply(bonds, s.pressure, *s.load);
    const LostPieces lost = looseUnderPressure(bonds, s);
    s.loosePieces = lost.pieces;
    s.looseNodes = lost.nodes;
    if (s.pores->faces() == 0)
      throw NoPathError(fmt::format("no pore holds a pressure once {} loose pieces are out", lost.pieces),
        "look at the phases; a longer horizon or more matrix would join the pieces");
    exchangeFixed(bonds, s.fixed);
    return s;
  }
  s.lowLayers = { 0, layers };
  s.highLayers = { n - layers, n };
  const double length = static_cast<double>(n - 2 * layers + 1) * bonds.spacing();
  const int across = (axis + 1) % d;

  const auto share = [&](std::int64_t layer, std::int64_t count)
  {
    const double part = static_cast<double>(layer - (layers - 1)) / static_cast<double>(count - 2 * layers + 1);
    return loading.rigid ? std::clamp(part, 0.0, 1.0) : part;
  };
  if (loading.load == LoadCase::Traction)
    s.load.emplace(l);
  const double nodeForce = loading.traction * std::pow(bonds.spacing(), d - 1) / layers;
  eachOwnNode(l,
    [&](std::int64_t i, const std::array<std::int64_t, 3>& node)
    {
      const std::int64_t layer = node[a];
      const bool low = layer < layers;
      const bool high = layer >= n - layers;
      if (!bonds.solid(i))
        return;
      switch (loading.load) // a pressure returned above
      {
        case LoadCase::Stretch:
          if (low || high)
            s.fixed[i] = loading.smooth ? static_cast<std::uint8_t>(1U << axis) : allComponents(d);
          s.displacement.component(axis)[i] = loading.strain * length * share(layer, n);
          break;
        case LoadCase::Shear:
          if (low || high)
            s.fixed[i] = allComponents(d);
          s.displacement.component(across)[i] = loading.strain * length * share(layer, n);
          break;
        case LoadCase::Traction:
          if (low)
            s.fixed[i] = allComponents(d);
          if (high)
            s.load->component(axis)[i] = nodeForce;
          break;
        case LoadCase::Biaxial:
          for (int c = 0; c < d; ++c)
          {
            const auto b = static_cast<std::size_t>(c);
            const std::int64_t m = l.global[b];
            if (node[b] < layers || node[b] >= m - layers)
              s.fixed[i] = static_cast<std::uint8_t>(s.fixed[i] | (1U << c));
            s.displacement.component(c)[i] = (c == axis ? loading.strain : loading.lateralStrain) *
              static_cast<double>(m - 2 * layers + 1) * bonds.spacing() * share(node[b], m);
          }
          break;
        case LoadCase::Pressure:
          break;
      }
    });
  takeOutLoosePieces(bonds, s, axis);
  exchangeFixed(bonds, s.fixed);
  bonds.exchange(s.displacement);
  return s;
}

Reactions reactions(
  const BondLattice& bonds, const LoadedSample& sample, const NodeField<double>& u, int axis, bool nonlinear)
{
  NodeField<double> f(bonds.layout());
  if (nonlinear)
    nonlinearForce(bonds, u, f);
  else
    linearForce(bonds, u, f);
  const int a = axis < 0 ? bonds.dimension() - 1 : axis;
  Reactions r;
  r.low = layerSum(bonds, f, a, sample.lowLayers[0], sample.lowLayers[1]);
  r.high = layerSum(bonds, f, a, sample.highLayers[0], sample.highLayers[1]);
  return r;
}

} // namespace lamella::peridynamics
