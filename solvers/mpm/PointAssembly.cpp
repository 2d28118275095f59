// The matrix of PointSystem, entry by entry.
#include "mpm/PointSystem.h"

#include "mpm/SmallStrain.h"

#include <algorithm>

namespace lamella::mpm
{

// add(first node, second node, block by rows) for every pair of a point's nodes, images folded onto their masters.
template <int Dim>
template <class Add>
void PointSystem<Dim>::forEachBlock(std::size_t p, const Add& add) const
{
  const std::array<AxisShape<3>, Dim> s = profiles(p);
  std::array<std::int32_t, splines> node;
  std::array<std::array<Strain, Dim>, splines> b;  // strain of a unit displacement
  std::array<std::array<Strain, Dim>, splines> cb; // and its stress, times the volume
  for (std::size_t k = 0; k < splines; ++k)
  {
    const auto at = static_cast<std::size_t>(base_[p] + jumps_[k]);
    node[k] = place_[static_cast<std::size_t>(master_[at])];
    const std::array<std::size_t, 3> i{ k % 3, k / 3 % 3, k / 9 };
    std::array<double, Dim> g;
    for (std::size_t c = 0; c < Dim; ++c)
    {
      g[c] = 1;
      for (std::size_t a = 0; a < Dim; ++a)
        g[c] *= a == c ? s[a].gradient[i[a]] : s[a].value[i[a]];
    }
    for (std::size_t c = 0; c < Dim; ++c)
    {
      std::array<std::array<double, Dim>, Dim> gradient{};
      for (std::size_t j = 0; j < Dim; ++j)
        gradient[c][j] = sign_[at * Dim + c] * g[j];
      b[k][c] = strainOf<Dim>(gradient);
      cb[k][c] = stress(p, b[k][c]);
    }
  }
  std::array<double, Dim * Dim> block;
  for (std::size_t k = 0; k < splines; ++k)
    for (std::size_t l = 0; l < splines; ++l)
      if (node[k] <= node[l])
      {
        for (std::size_t c = 0; c < Dim; ++c)
          for (std::size_t d = 0; d < Dim; ++d)
          {
            double sum = 0;
            for (std::size_t v = 0; v < strains; ++v)
              sum += b[k][c][v] * cb[l][d][v];
            block[c * Dim + d] = sum;
          }
        add(node[k], node[l], block);
      }
}

template <int Dim>
std::vector<double> PointSystem<Dim>::diagonal() const
{
  std::vector<double> d(nodes_.size() * Dim * Dim, 0.0);
  for (std::size_t p = 0; p < base_.size(); ++p)
    forEachBlock(p,
      [&](std::int32_t k, std::int32_t l, const auto& block)
      {
        if (k == l)
          for (std::size_t e = 0; e < block.size(); ++e)
            d[static_cast<std::size_t>(k) * block.size() + e] += block[e];
      });
  return d;
}

template <int Dim>
packing::BlockMatrix<Dim> PointSystem<Dim>::assemble(const std::vector<double>& scale) const
{
  using Block = typename packing::BlockMatrix<Dim>::Block;
  // by node: pairs with nodes of a higher number, a list each, found by a search from its end: new ones are few
  std::vector<std::vector<std::int32_t>> second(nodes_.size());
  std::vector<std::vector<Block>> value(nodes_.size());
  packing::BlockMatrix<Dim> m;
  m.diagonal.assign(nodes_.size(), Block::Zero());
  for (std::size_t p = 0; p < base_.size(); ++p)
    forEachBlock(p,
      [&](std::int32_t k, std::int32_t l, const std::array<double, Dim * Dim>& block)
      {
        const auto row = static_cast<std::size_t>(k);
        const auto column = static_cast<std::size_t>(l);
        Block scaled;
        for (int c = 0; c < Dim; ++c)
          for (int d = 0; d < Dim; ++d)
            scaled(c, d) = block[static_cast<std::size_t>(c * Dim + d)] *
              scale[row * Dim + static_cast<std::size_t>(c)] * scale[column * Dim + static_cast<std::size_t>(d)];
        if (k == l)
        {
          m.diagonal[row] += scaled;
          return;
        }
        auto& others = second[row];
        const auto at = std::find(others.begin(), others.end(), l);
        if (at == others.end())
        {
          others.push_back(l);
          value[row].push_back(scaled.transpose());
        }
        else
          value[row][static_cast<std::size_t>(at - others.begin())] += scaled.transpose();
      });
  for (std::size_t k = 0; k < nodes_.size(); ++k)
  {
    for (std::size_t i = 0; i < second[k].size(); ++i)
    {
      m.links.push_back({ static_cast<std::int32_t>(k), second[k][i] });
      m.coupling.push_back(value[k][i]);
    }
    for (int c = 0; c < Dim; ++c)
      if (!(m.diagonal[k](c, c) > 0))
        m.diagonal[k](c, c) = 1;
  }
  m.border.assign(nodes_.size(), Block::Zero());
  return m;
}

template std::vector<double> PointSystem<2>::diagonal() const;
template std::vector<double> PointSystem<3>::diagonal() const;
template packing::BlockMatrix<2> PointSystem<2>::assemble(const std::vector<double>&) const;
template packing::BlockMatrix<3> PointSystem<3>::assemble(const std::vector<double>&) const;

} // namespace lamella::mpm
