#include "cracks/CrackEdges.h"

#include "core/Error.h"
#include "peridynamics/Stencil.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <tuple>
#include <unordered_map>

namespace lamella::cracks
{
namespace
{

using Step = std::array<int, 3>;
using Node = std::array<std::int64_t, 3>;

Node operator+(const Node& n, const Step& s)
{
  return { n[0] + s[0], n[1] + s[1], n[2] + s[2] };
}

/// A node with bonds to both of two neighbours: its step from the first, and the numbers of its steps from either.
struct Common
{
  Step fromFirst;
  int first;
  int second;
};

/// The steps that bonds make, and none, by number.
class Steps
{
public:
  explicit Steps(const peridynamics::Stencil& stencil, int dimension)
    : reach_(stencil.layers())
    , width_(2 * reach_ + 1)
    , number_(static_cast<std::size_t>(width_ * width_ * (dimension == 3 ? width_ : 1)), -1)
    , flat_(dimension == 2)
  {
    add({ 0, 0, 0 });
    for (const peridynamics::Offset& o : stencil.half())
    {
      add({ o.step[0], o.step[1], o.step[2] });
      add({ -o.step[0], -o.step[1], -o.step[2] });
    }
  }

  [[nodiscard]] int reach() const noexcept { return reach_; }
  [[nodiscard]] int count() const noexcept { return static_cast<int>(all_.size()); }
  /// -1: no bond is like that.
  [[nodiscard]] int number(const Step& s) const
  {
    for (const int c : s)
      if (std::abs(c) > reach_)
        return -1;
    return number_[place(s)];
  }
  [[nodiscard]] std::vector<Common> commonOf(int axis) const
  {
    std::vector<Common> common;
    for (int k = 0; k < count(); ++k)
    {
      Step from = all_[static_cast<std::size_t>(k)];
      from[static_cast<std::size_t>(axis)] -= 1;
      if (const int second = number(from); second >= 0)
        common.push_back({ all_[static_cast<std::size_t>(k)], k, second });
    }
    return common;
  }

private:
  [[nodiscard]] std::size_t place(const Step& s) const
  {
    const int z = flat_ ? 0 : s[2] + reach_;
    return static_cast<std::size_t>(s[0] + reach_ + width_ * (s[1] + reach_ + width_ * z));
  }
  void add(const Step& s)
  {
    number_[place(s)] = count();
    all_.push_back(s);
  }

  int reach_;
  int width_;
  std::vector<int> number_;
  std::vector<Step> all_;
  bool flat_;
};

/// A bit a step that a node has lost, for the nodes that lost any.
class LostSteps
{
public:
  LostSteps(int steps, std::size_t bonds)
    : words_(static_cast<std::size_t>(steps + 63) / 64)
  {
    slots_.reserve(bonds);
  }
  void lose(std::int64_t node, int step)
  {
    const auto [found, isNew] = slots_.try_emplace(node, slots_.size());
    if (isNew)
      bits_.resize(bits_.size() + words_);
    bits_[found->second * words_ + static_cast<std::size_t>(step) / 64] |= std::uint64_t{ 1 } << (step % 64);
  }
  /// Null: none.
  [[nodiscard]] const std::uint64_t* of(std::int64_t node) const
  {
    const auto found = slots_.find(node);
    return found == slots_.end() ? nullptr : bits_.data() + found->second * words_;
  }
  [[nodiscard]] static bool has(const std::uint64_t* bits, int step)
  {
    return bits != nullptr && (bits[step / 64] >> (step % 64) & 1U) != 0;
  }
  [[nodiscard]] const std::unordered_map<std::int64_t, std::size_t>& nodes() const noexcept { return slots_; }

private:
  std::size_t words_;
  std::unordered_map<std::int64_t, std::size_t> slots_;
  std::vector<std::uint64_t> bits_;
};

} // namespace

std::vector<CrackEdge> crackEdges(
  const Lattice& lattice, double horizon, std::span<const CutBond> bonds, std::span<const std::uint8_t> solid)
{
  const peridynamics::Stencil stencil(lattice.dimension, horizon);
  const auto exists = [&](const Node& n)
  {
    for (std::size_t a = 0; a < 3; ++a)
      if (n[a] < 0 || n[a] >= lattice.size[a])
        return false;
    return solid.empty() || solid[static_cast<std::size_t>(lattice.index(n[0], n[1], n[2]))] != 0;
  };
  const Steps steps(stencil, lattice.dimension);
  LostSteps lost(steps.count(), bonds.size());
  for (const CutBond& b : bonds)
  {
    const Step& s = b.step;
    if (std::max({ std::abs(s[0]), std::abs(s[1]), std::abs(s[2]) }) > steps.reach())
      throw ParameterError(lattice.dimension == 3
          ? fmt::format(
              "a broken bond of {}, {} and {} spacings is longer than the horizon of {:g}", s[0], s[1], s[2], horizon)
          : fmt::format("a broken bond of {} and {} spacings is longer than the horizon of {:g}", s[0], s[1], horizon),
        "give the horizon with which the sample was broken");
    const Node other = b.node + s;
    const int number = steps.number(s);
    if (number < 0 || !exists(b.node) || !exists(other))
      continue;
    lost.lose(lattice.index(b.node[0], b.node[1], b.node[2]), number);
    lost.lose(lattice.index(other[0], other[1], other[2]), steps.number({ -s[0], -s[1], -s[2] }));
  }

  std::vector<std::vector<Common>> common;
  std::array<std::int64_t, 3> pitch{ 1, lattice.size[0], lattice.size[0] * lattice.size[1] };
  for (int axis = 0; axis < lattice.dimension; ++axis)
    common.push_back(steps.commonOf(axis));
  std::vector<CrackEdge> edges;
  const auto judge = [&](const Node& n, int axis)
  {
    Node next = n;
    ++next[static_cast<std::size_t>(axis)];
    if (!exists(n) || !exists(next))
      return;
    const std::uint64_t* first = lost.of(lattice.index(n[0], n[1], n[2]));
    const std::uint64_t* second = lost.of(lattice.index(next[0], next[1], next[2]));
    int one = 0;
    int both = 0;
    for (const Common& c : common[static_cast<std::size_t>(axis)])
      if (exists(n + c.fromFirst))
      {
        const int held = (LostSteps::has(first, c.first) ? 0 : 1) + (LostSteps::has(second, c.second) ? 0 : 1);
        one += held == 1 ? 1 : 0;
        both += held == 2 ? 1 : 0;
      }
    if (one > both)
      edges.push_back({ n[0], n[1], axis, static_cast<double>(one - both) / (one + both), n[2] });
  };
  for (const auto& [node, slot] : lost.nodes())
  {
    const Node n{ node % pitch[1], node / pitch[1] % lattice.size[1], node / pitch[2] };
    for (int axis = 0; axis < lattice.dimension; ++axis)
    {
      const auto a = static_cast<std::size_t>(axis);
      judge(n, axis);
      // a pair is judged from its first node, but for those whose first node lost nothing
      if (n[a] == 0 || lost.of(node - pitch[a]) != nullptr)
        continue;
      Node before = n;
      --before[a];
      judge(before, axis);
    }
  }
  std::sort(edges.begin(), edges.end(),
    [](const CrackEdge& a, const CrackEdge& b)
    { return std::tie(a.z, a.y, a.x, a.axis) < std::tie(b.z, b.y, b.x, b.axis); });
  return edges;
}

} // namespace lamella::cracks
