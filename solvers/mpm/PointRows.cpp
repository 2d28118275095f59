// The matrix of PointSystem, row by row.
#include "mpm/PointSystem.h"

#include "mpm/SmallStrain.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

namespace lamella::mpm
{
namespace
{

/// Which of the nodes at most two away a row has, in order of place.
template <int Dim>
struct Neighbours
{
  std::array<std::uint64_t, 2> bits{}; // in a plane the first holds all

  void set(std::size_t slot) { bits[slot / 64] |= std::uint64_t{ 1 } << slot % 64; }
  /// Those before it.
  [[nodiscard]] int before(std::size_t slot) const
  {
    int sum = std::popcount(bits[slot / 64] & ((std::uint64_t{ 1 } << slot % 64) - 1));
    if (slot >= 64)
      sum += std::popcount(bits[0]);
    return sum;
  }
  [[nodiscard]] int count() const { return std::popcount(bits[0]) + std::popcount(bits[1]); }
};

constexpr int reach = 2;
constexpr int width = 2 * reach + 1;

/// Place among the neighbours; around periods where these are given.
template <int Dim>
std::size_t slotOf(
  const std::array<int, Dim>& from, const std::array<int, Dim>& to, const std::array<int, Dim>& periods)
{
  int slot = 0;
  for (std::size_t a = Dim; a-- > 0;)
  {
    int way = to[a] - from[a];
    if (periods[a] > 0 && way > reach)
      way -= periods[a];
    if (periods[a] > 0 && way < -reach)
      way += periods[a];
    slot = width * slot + way + reach;
  }
  return static_cast<std::size_t>(slot);
}

} // namespace

// All points behind one first node act on the same splines; where they lie alike and are of the same kinds, as in most
// of a sample that was cut along pixels, the block of numbers is the same, too, and is kept.
template <int Dim>
BlockRows<Dim> PointSystem<Dim>::rows(const std::function<void()>& told) const
{
  constexpr std::size_t values = splines * Dim;
  constexpr std::size_t often = 20000; // groups between two questions
  std::vector<std::size_t> group;      // first point of each
  for (std::size_t p = 0; p < base_.size(); ++p)
    if (p == 0 || base_[p] != base_[p - 1])
      group.push_back(p);
  std::vector<std::array<int, Dim>> at(nodes_.size());
  for (std::size_t k = 0; k < nodes_.size(); ++k)
    at[k] = coordinates(nodes_[k]);

  const auto nodesOf = [&](std::size_t p)
  {
    std::array<std::int32_t, splines> node;
    for (std::size_t k = 0; k < splines; ++k)
      node[k] = place_[static_cast<std::size_t>(master_[static_cast<std::size_t>(base_[p] + jumps_[k])])];
    return node;
  };
  std::vector<Neighbours<Dim>> neighbours(nodes_.size());
  for (std::size_t g = 0; g < group.size(); ++g)
  {
    const auto node = nodesOf(group[g]);
    for (const std::int32_t k : node)
      for (const std::int32_t l : node)
        neighbours[static_cast<std::size_t>(k)].set(
          slotOf<Dim>(at[static_cast<std::size_t>(k)], at[static_cast<std::size_t>(l)], periods_));
    if (g % often == 0)
      told();
  }
  BlockRows<Dim> m;
  m.begin.assign(nodes_.size() + 1, 0);
  for (std::size_t k = 0; k < nodes_.size(); ++k)
    m.begin[k + 1] = m.begin[k] + neighbours[k].count();
  m.column.resize(static_cast<std::size_t>(m.begin.back()));
  m.value.assign(m.column.size(), BlockRows<Dim>::Block::Zero());

  using Key = std::vector<std::int64_t>;
  constexpr std::size_t mostKept = (std::size_t{ 32 } << 20U) / (values * values * sizeof(double));
  std::map<Key, std::vector<double>> kept;
  std::vector<double> own(values * values);
  Key key;
  for (std::size_t g = 0; g < group.size(); ++g)
  {
    const std::size_t first = group[g];
    const std::size_t end = g + 1 < group.size() ? group[g + 1] : base_.size();
    constexpr double fine = 1e11; // far below what matters, above round-off
    key.clear();
    for (std::size_t p = first; p < end; ++p)
    {
      key.push_back(kind_[p]);
      for (const double f : fraction_[p])
        key.push_back(std::llround(fine * f));
    }
    const auto found = kept.find(key);
    const std::vector<double>* block = found == kept.end() ? nullptr : &found->second;
    if (block == nullptr)
    {
      std::fill(own.begin(), own.end(), 0.0);
      for (std::size_t p = first; p < end; ++p)
        addBlock(p, own);
      block = &own;
      if (kept.size() < mostKept)
        block = &kept.emplace(key, own).first->second;
    }
    const auto node = nodesOf(first);
    std::array<double, values> factor; // the sign of images
    for (std::size_t k = 0; k < splines; ++k)
      for (std::size_t c = 0; c < Dim; ++c)
        factor[k * Dim + c] = sign_[static_cast<std::size_t>(base_[first] + jumps_[k]) * Dim + c];
    for (std::size_t k = 0; k < splines; ++k)
    {
      const auto row = static_cast<std::size_t>(node[k]);
      for (std::size_t l = 0; l < splines; ++l)
      {
        const std::size_t slot = slotOf<Dim>(at[row], at[static_cast<std::size_t>(node[l])], periods_);
        const auto to = static_cast<std::size_t>(m.begin[row] + neighbours[row].before(slot));
        m.column[to] = node[l];
        auto& value = m.value[to];
        for (std::size_t c = 0; c < Dim; ++c)
          for (std::size_t d = 0; d < Dim; ++d)
            value(static_cast<Eigen::Index>(c), static_cast<Eigen::Index>(d)) +=
              factor[k * Dim + c] * factor[l * Dim + d] * (*block)[(k * Dim + c) * values + l * Dim + d];
      }
    }
    if (g % often == 0)
      told();
  }
  return m;
}

// Adds V Bᵀ C B of a point among its splines, images not folded.
template <int Dim>
void PointSystem<Dim>::addBlock(std::size_t p, std::vector<double>& to) const
{
  constexpr std::size_t values = splines * Dim;
  const std::array<AxisShape<3>, Dim> s = profiles(p);
  std::array<std::array<double, Dim>, splines> g; // gradients of the splines
  std::array<std::array<double, values>, strains> cb;
  for (std::size_t k = 0; k < splines; ++k)
  {
    const std::array<std::size_t, 3> i{ k % 3, k / 3 % 3, k / 9 };
    for (std::size_t c = 0; c < Dim; ++c)
    {
      g[k][c] = 1;
      for (std::size_t a = 0; a < Dim; ++a)
        g[k][c] *= a == c ? s[a].gradient[i[a]] : s[a].value[i[a]];
    }
    for (std::size_t c = 0; c < Dim; ++c)
    {
      std::array<std::array<double, Dim>, Dim> gradient{};
      gradient[c] = g[k];
      const Strain t = stress(p, strainOf<Dim>(gradient));
      for (std::size_t v = 0; v < strains; ++v)
        cb[v][k * Dim + c] = t[v];
    }
  }
  for (std::size_t k = 0; k < splines; ++k)
    for (std::size_t c = 0; c < Dim; ++c)
    {
      double* const row = &to[(k * Dim + c) * values];
      for (std::size_t v = 0; v < strains; ++v)
      {
        const auto i = static_cast<std::size_t>(voigt<Dim>[v][0]);
        const auto j = static_cast<std::size_t>(voigt<Dim>[v][1]);
        if (i != c && j != c)
          continue;
        const double b = g[k][i == c ? j : i];
        for (std::size_t l = 0; l < values; ++l)
          row[l] += b * cb[v][l];
      }
    }
}

template void PointSystem<2>::addBlock(std::size_t, std::vector<double>&) const;
template void PointSystem<3>::addBlock(std::size_t, std::vector<double>&) const;
template BlockRows<2> PointSystem<2>::rows(const std::function<void()>&) const;
template BlockRows<3> PointSystem<3>::rows(const std::function<void()>&) const;

} // namespace lamella::mpm
