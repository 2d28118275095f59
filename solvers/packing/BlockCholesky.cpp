// Sparse Cholesky factors by blocks: left-looking, one block column after the other.
#include "packing/BlockCholesky.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>

#include <algorithm>
#include <cmath>

namespace lamella::packing
{
namespace
{

// L with L Lᵀ = a, and its inverse. False: a is not positive definite.
template <class Block>
bool invertedRoot(const Block& a, Block& inverse)
{
  constexpr int n = Block::RowsAtCompileTime;
  Block root = Block::Zero();
  for (int j = 0; j < n; ++j)
  {
    double rest = a(j, j);
    for (int k = 0; k < j; ++k)
      rest -= root(j, k) * root(j, k);
    if (!(rest > 0))
      return false;
    root(j, j) = std::sqrt(rest);
    for (int i = j + 1; i < n; ++i)
    {
      double below = a(i, j);
      for (int k = 0; k < j; ++k)
        below -= root(i, k) * root(j, k);
      root(i, j) = below / root(j, j);
    }
  }
  inverse.setZero();
  for (int j = 0; j < n; ++j)
  {
    inverse(j, j) = 1 / root(j, j);
    for (int i = j + 1; i < n; ++i)
    {
      double sum = 0;
      for (int k = j; k < i; ++k)
        sum -= root(i, k) * inverse(k, j);
      inverse(i, j) = sum / root(i, i);
    }
  }
  return true;
}

} // namespace

template <int Dim>
void BlockCholesky<Dim>::analyse(std::size_t grains, const std::vector<std::array<std::int32_t, 2>>& links)
{
  const bool known = place_.size() == grains;
  if (!known)
    order(grains, links);
  findEntries(grains, links);
  if (known && entries() > entriesWhenOrdered_ + entriesWhenOrdered_ / 5)
  {
    order(grains, links);
    findEntries(grains, links);
  }
  else if (known)
    return;
  entriesWhenOrdered_ = entries();
}

template <int Dim>
void BlockCholesky<Dim>::order(std::size_t grains, const std::vector<std::array<std::int32_t, 2>>& links)
{
  const auto n = static_cast<Eigen::Index>(grains);
  std::vector<Eigen::Triplet<double>> both;
  both.reserve(2 * links.size() + grains);
  for (Eigen::Index i = 0; i < n; ++i)
    both.emplace_back(static_cast<int>(i), static_cast<int>(i), 1.0);
  for (const auto& [first, second] : links)
  {
    both.emplace_back(first, second, 1.0);
    both.emplace_back(second, first, 1.0);
  }
  Eigen::SparseMatrix<double> graph(n, n);
  graph.setFromTriplets(both.begin(), both.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
  Eigen::AMDOrdering<int>()(graph, permutation); // where each place takes its grain from
  grain_.assign(permutation.indices().data(), permutation.indices().data() + n);
  place_.resize(grains);
  for (std::size_t k = 0; k < grains; ++k)
    place_[static_cast<std::size_t>(grain_[k])] = static_cast<std::int32_t>(k);
}

// A column has the rows of its links, and those of the columns whose first row below the diagonal it is.
template <int Dim>
void BlockCholesky<Dim>::findEntries(std::size_t grains, const std::vector<std::array<std::int32_t, 2>>& links)
{
  std::vector<std::int32_t> linkBegin(grains + 1, 0);
  const auto column = [&](const std::array<std::int32_t, 2>& link)
  {
    return static_cast<std::size_t>(
      std::min(place_[static_cast<std::size_t>(link[0])], place_[static_cast<std::size_t>(link[1])]));
  };
  const auto rowOf = [&](const std::array<std::int32_t, 2>& link)
  { return std::max(place_[static_cast<std::size_t>(link[0])], place_[static_cast<std::size_t>(link[1])]); };
  for (const auto& link : links)
    ++linkBegin[column(link) + 1];
  for (std::size_t j = 0; j < grains; ++j)
    linkBegin[j + 1] += linkBegin[j];
  std::vector<std::int32_t> linkRow(links.size());
  std::vector<std::int32_t> filled(linkBegin.begin(), linkBegin.end() - 1);
  for (const auto& link : links)
    linkRow[static_cast<std::size_t>(filled[column(link)]++)] = rowOf(link);

  begin_.assign(grains + 1, 0);
  row_.clear();
  std::vector<std::int32_t> firstChild(grains, -1);
  std::vector<std::int32_t> nextChild(grains, -1);
  std::vector<std::int32_t> seen(grains, -1);
  for (std::size_t j = 0; j < grains; ++j)
  {
    const auto here = static_cast<std::int32_t>(j);
    const auto add = [&](std::int32_t row)
    {
      if (row == here || seen[static_cast<std::size_t>(row)] == here)
        return;
      seen[static_cast<std::size_t>(row)] = here;
      row_.push_back(row);
    };
    for (auto l = static_cast<std::size_t>(linkBegin[j]); l < static_cast<std::size_t>(linkBegin[j + 1]); ++l)
      add(linkRow[l]);
    for (std::int32_t child = firstChild[j]; child >= 0; child = nextChild[static_cast<std::size_t>(child)])
    {
      const auto end = static_cast<std::size_t>(begin_[static_cast<std::size_t>(child) + 1]);
      for (auto e = static_cast<std::size_t>(begin_[static_cast<std::size_t>(child)]); e < end; ++e)
        add(row_[e]);
    }
    std::sort(row_.begin() + begin_[j], row_.end());
    begin_[j + 1] = static_cast<std::int32_t>(row_.size());
    if (begin_[j + 1] > begin_[j])
    {
      const auto parent = static_cast<std::size_t>(row_[static_cast<std::size_t>(begin_[j])]);
      nextChild[j] = firstChild[parent];
      firstChild[parent] = here;
    }
  }

  slot_.resize(links.size());
  turned_.resize(links.size());
  for (std::size_t l = 0; l < links.size(); ++l)
  {
    const std::size_t j = column(links[l]);
    slot_[l] = static_cast<std::int32_t>(
      std::lower_bound(row_.begin() + begin_[j], row_.begin() + begin_[j + 1], rowOf(links[l])) - row_.begin());
    turned_[l] = place_[static_cast<std::size_t>(links[l][0])] > place_[static_cast<std::size_t>(links[l][1])] ? 1 : 0;
  }
}

template <int Dim>
bool BlockCholesky<Dim>::factorise(const BlockMatrix<Dim>& matrix, double shift)
{
  const std::size_t n = grain_.size();
  const Block shifts = Block::Identity() * shift;
  value_.assign(row_.size(), Block::Zero());
  for (std::size_t l = 0; l < slot_.size(); ++l)
  {
    Block& value = value_[static_cast<std::size_t>(slot_[l])];
    if (turned_[l] != 0)
      value = matrix.coupling[l].transpose();
    else
      value = matrix.coupling[l];
  }
  inverse_.resize(n);
  border_.resize(n);
  work_.resize(n);
  next_.resize(n);
  nextColumn_.resize(n);
  firstColumn_.assign(n, -1);
  corner_ = matrix.corner + shifts;
  for (std::size_t j = 0; j < n; ++j)
  {
    const auto begin = static_cast<std::size_t>(begin_[j]);
    const auto end = static_cast<std::size_t>(begin_[j + 1]);
    const auto grain = static_cast<std::size_t>(grain_[j]);
    Block diagonal = matrix.diagonal[grain] + shifts;
    Block border = matrix.border[grain];
    for (std::size_t e = begin; e < end; ++e)
      work_[static_cast<std::size_t>(row_[e])] = value_[e];
    // less what the columns before it, whose next row this is, bring
    for (std::int32_t k = firstColumn_[j]; k >= 0;)
    {
      const auto from = static_cast<std::size_t>(k);
      k = nextColumn_[from];
      const auto at = static_cast<std::size_t>(next_[from]);
      const auto last = static_cast<std::size_t>(begin_[from + 1]);
      const Block across = value_[at].transpose();
      diagonal.noalias() -= value_[at] * across;
      border.noalias() -= value_[at] * border_[from];
      for (std::size_t e = at + 1; e < last; ++e)
        work_[static_cast<std::size_t>(row_[e])].noalias() -= value_[e] * across;
      if (at + 1 < last)
      {
        next_[from] = static_cast<std::int32_t>(at + 1);
        const auto row = static_cast<std::size_t>(row_[at + 1]);
        nextColumn_[from] = firstColumn_[row];
        firstColumn_[row] = static_cast<std::int32_t>(from);
      }
    }
    if (!invertedRoot(diagonal, inverse_[j]))
      return false;
    const Block right = inverse_[j].transpose();
    for (std::size_t e = begin; e < end; ++e)
      value_[e].noalias() = work_[static_cast<std::size_t>(row_[e])] * right;
    border_[j].noalias() = inverse_[j] * border;
    corner_.noalias() -= border_[j].transpose() * border_[j];
    if (begin < end)
    {
      next_[j] = static_cast<std::int32_t>(begin);
      const auto row = static_cast<std::size_t>(row_[begin]);
      nextColumn_[j] = firstColumn_[row];
      firstColumn_[row] = static_cast<std::int32_t>(j);
    }
  }
  Block inverse;
  if (!invertedRoot(corner_, inverse))
    return false;
  corner_.noalias() = inverse.transpose() * inverse;
  return true;
}

template <int Dim>
Eigen::VectorXd BlockCholesky<Dim>::solve(const Eigen::VectorXd& right, Eigen::Index box) const
{
  using Vec = Eigen::Matrix<double, Dim, 1>;
  const std::size_t n = grain_.size();
  std::vector<Vec> x(n);
  Vec onBox = Vec::Zero();
  onBox.head(box) = right.tail(box);
  for (std::size_t j = 0; j < n; ++j)
    x[j] = right.template segment<Dim>(Dim * static_cast<Eigen::Index>(grain_[j]));
  for (std::size_t j = 0; j < n; ++j)
  {
    x[j] = inverse_[j] * x[j];
    onBox -= border_[j].transpose() * x[j];
    for (auto e = static_cast<std::size_t>(begin_[j]); e < static_cast<std::size_t>(begin_[j + 1]); ++e)
      x[static_cast<std::size_t>(row_[e])] -= value_[e] * x[j];
  }
  onBox = corner_ * onBox;
  for (std::size_t j = n; j-- > 0;)
  {
    Vec rest = x[j] - border_[j] * onBox;
    for (auto e = static_cast<std::size_t>(begin_[j]); e < static_cast<std::size_t>(begin_[j + 1]); ++e)
      rest -= value_[e].transpose() * x[static_cast<std::size_t>(row_[e])];
    x[j] = inverse_[j].transpose() * rest;
  }
  Eigen::VectorXd solution(right.size());
  for (std::size_t j = 0; j < n; ++j)
    solution.template segment<Dim>(Dim * static_cast<Eigen::Index>(grain_[j])) = x[j];
  solution.tail(box) = onBox.head(box);
  return solution;
}

template class BlockCholesky<2>;
template class BlockCholesky<3>;

} // namespace lamella::packing
