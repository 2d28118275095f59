#include "elasticity/StiffPieces.h"

#include "core/Communicator.h"
#include "pores/PoreLabelling.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace lamella::elasticity
{
namespace
{

constexpr std::size_t mostPieces = 20000; // the largest of them
constexpr std::int64_t leastVoxels = 8;   // of a piece
constexpr double ground = 1e-9;           // added to the diagonal, relative: all pieces may be free to move together

} // namespace

template <int D>
StiffPieces<D>::StiffPieces(const ElasticGrid<D>& grid, std::span<const std::uint8_t> phase,
  const std::vector<bool>& stiff, const std::function<ElementMatrix(std::uint8_t)>& element)
  : grid_(grid)
{
  for (std::size_t a = 0; a < D; ++a)
    period_[a] = grid.periodic[a] ? static_cast<double>(grid.elements[a]) : 0.0;
  findOwners(phase, stiff);
  if (pieces_.size() > 1)
    assemble(phase, element);
}

template <int D>
std::int64_t StiffPieces<D>::node(std::int64_t x, std::int64_t y, std::int64_t z) const
{
  const auto within = [&](std::int64_t i, int axis) { return i == grid_.nodes(axis) ? 0 : i; };
  const std::int64_t nx = grid_.nodes(0);
  const std::int64_t ny = grid_.nodes(1);
  return within(x, 0) + nx * (within(y, 1) + (D == 3 ? ny * within(z, D - 1) : 0));
}

template <int D>
void StiffPieces<D>::findOwners(std::span<const std::uint8_t> phase, const std::vector<bool>& stiff)
{
  std::array<std::int64_t, 3> size{ 1, 1, 1 };
  std::copy(grid_.elements.begin(), grid_.elements.end(), size.begin());
  const Lattice lattice = makeLattice(size[0], size[1], size[2], D, 1.0);
  std::vector<std::uint8_t> mask(phase.size());
  for (std::size_t i = 0; i < phase.size(); ++i)
    mask[i] = stiff[phase[i]] ? 1 : 0;
  pores::LabelOptions o;
  o.connectivity = D == 3 ? 26 : 8; // pieces that share a node move together there
  for (std::size_t a = 0; a < D; ++a)
    o.periodic[a] = grid_.periodic[a];
  o.minimumSize = leastVoxels;
  const Communicator alone;
  const pores::PoreLabelling labelling(lattice, alone, mask, 1, o);
  std::int64_t unknowns = 0;
  for (const pores::Pore& found : labelling.pores().first(std::min(mostPieces, labelling.pores().size())))
  {
    Piece piece;
    bool large = found.percolates != 0;
    for (std::size_t a = 0; a < D; ++a)
    {
      piece.centre[a] = found.centre[a] + 0.5;
      large = large || (grid_.periodic[a] && 2 * (found.high[a] - found.low[a]) >= size[a]);
    }
    piece.motions = large ? D : motions;
    piece.first = unknowns;
    unknowns += piece.motions;
    pieces_.push_back(piece);
  }
  std::vector<std::int32_t> labels(phase.size());
  labelling.labels(labels);
  owner_.assign(static_cast<std::size_t>(grid_.nodes(0) * grid_.nodes(1) * (D == 3 ? grid_.nodes(D - 1) : 1)), -1);
  std::size_t i = 0;
  for (std::int64_t z = 0; z < size[2]; ++z)
    for (std::int64_t y = 0; y < size[1]; ++y)
      for (std::int64_t x = 0; x < size[0]; ++x, ++i)
        if (labels[i] > 0 && static_cast<std::size_t>(labels[i]) <= pieces_.size())
          for (int k = 0; k < corners; ++k)
            owner_[static_cast<std::size_t>(node(x + (k & 1), y + (k >> 1 & 1), z + (k >> 2)))] = labels[i] - 1;
  // what sides hold belongs to none
  for (std::size_t n = 0; n < owner_.size(); ++n)
  {
    auto rest = static_cast<std::int64_t>(n);
    for (int a = 0; a < D; ++a)
    {
      const std::int64_t at = rest % grid_.nodes(a);
      rest /= grid_.nodes(a);
      const auto axis = static_cast<std::size_t>(a);
      if (!grid_.periodic[axis] && (at == 0 || at == grid_.elements[axis]) &&
        std::ranges::any_of(grid_.held[axis], [](bool h) { return h; }))
        owner_[n] = -1;
    }
  }
}

template <int D>
typename StiffPieces<D>::Basis StiffPieces<D>::basis(const Piece& piece, const std::array<double, 3>& place) const
{
  Basis b = Basis::Zero();
  std::array<double, 3> d{};
  for (std::size_t a = 0; a < D; ++a)
  {
    b(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(a)) = 1;
    d[a] = place[a] - piece.centre[a];
    if (period_[a] > 0)
      d[a] -= period_[a] * std::round(d[a] / period_[a]);
  }
  if (piece.motions == D)
    return b;
  if constexpr (D == 2)
  {
    b(0, 2) = -d[1];
    b(1, 2) = d[0];
  }
  else
    for (int k = 0; k < 3; ++k)
    {
      const int i = (k + 1) % 3;
      const int j = (k + 2) % 3;
      b(i, 3 + k) = -d[static_cast<std::size_t>(j)];
      b(j, 3 + k) = d[static_cast<std::size_t>(i)];
    }
  return b;
}

template <int D>
void StiffPieces<D>::assemble(
  std::span<const std::uint8_t> phase, const std::function<ElementMatrix(std::uint8_t)>& element)
{
  std::map<std::uint8_t, ElementMatrix> matrices;
  std::map<std::pair<std::int32_t, std::int32_t>, Eigen::Matrix<double, motions, motions>> blocks;
  std::array<std::int64_t, 3> size{ 1, 1, 1 };
  std::copy(grid_.elements.begin(), grid_.elements.end(), size.begin());
  std::size_t i = 0;
  for (std::int64_t z = 0; z < size[2]; ++z)
    for (std::int64_t y = 0; y < size[1]; ++y)
      for (std::int64_t x = 0; x < size[0]; ++x, ++i)
      {
        std::array<std::int32_t, corners> owner{};
        for (int k = 0; k < corners; ++k)
          owner[static_cast<std::size_t>(k)] =
            owner_[static_cast<std::size_t>(node(x + (k & 1), y + (k >> 1 & 1), z + (k >> 2)))];
        // a piece that moves stiffly as a whole does not strain its elements, but where it is too large to turn
        const bool same = std::ranges::all_of(owner, [&](std::int32_t o) { return o == owner[0]; });
        if (same)
          continue;
        auto found = matrices.find(phase[i]);
        if (found == matrices.end())
          found = matrices.emplace(phase[i], element(phase[i])).first;
        const ElementMatrix& matrix = found->second;
        std::array<std::int32_t, corners> distinct = owner;
        std::ranges::sort(distinct);
        const auto end = std::unique(distinct.begin(), distinct.end());
        std::array<Eigen::Matrix<double, D * corners, motions>, corners> moved;
        int count = 0;
        std::array<std::int32_t, corners> whose{};
        for (auto p = distinct.begin(); p != end; ++p)
        {
          if (*p < 0)
            continue;
          auto& m = moved[static_cast<std::size_t>(count)];
          m.setZero();
          for (int k = 0; k < corners; ++k)
            if (owner[static_cast<std::size_t>(k)] == *p)
            {
              const Basis b = basis(pieces_[static_cast<std::size_t>(*p)],
                { static_cast<double>(x + (k & 1)), static_cast<double>(y + (k >> 1 & 1)),
                  static_cast<double>(z + (k >> 2)) });
              for (int c = 0; c < D; ++c)
                m.row(c * corners + k) = b.row(c);
            }
          whose[static_cast<std::size_t>(count++)] = *p;
        }
        for (int p = 0; p < count; ++p)
        {
          const Eigen::Matrix<double, D * corners, motions> force = matrix * moved[static_cast<std::size_t>(p)];
          for (int q = 0; q < count; ++q)
          {
            using Block = Eigen::Matrix<double, motions, motions>;
            const std::pair key{ whose[static_cast<std::size_t>(q)], whose[static_cast<std::size_t>(p)] };
            blocks.try_emplace(key, Block::Zero()).first->second +=
              moved[static_cast<std::size_t>(q)].transpose() * force;
          }
        }
      }
  std::vector<Eigen::Triplet<double>> entries;
  double largest = 0;
  for (const auto& [pair, block] : blocks)
  {
    const Piece& row = pieces_[static_cast<std::size_t>(pair.first)];
    const Piece& column = pieces_[static_cast<std::size_t>(pair.second)];
    for (int a = 0; a < row.motions; ++a)
      for (int b = 0; b < column.motions; ++b)
      {
        const bool diagonal = pair.first == pair.second && a == b;
        largest = std::max(largest, diagonal ? block(a, b) : 0.0);
        entries.emplace_back(static_cast<int>(row.first + a), static_cast<int>(column.first + b),
          block(a, b) * (diagonal ? 1 + ground : 1));
      }
  }
  const std::int64_t unknowns = pieces_.back().first + pieces_.back().motions;
  for (int k = 0; k < unknowns; ++k) // pieces that touch nothing
    entries.emplace_back(k, k, ground * largest);
  Eigen::SparseMatrix<double> matrix(unknowns, unknowns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  factor_.compute(matrix);
}

template <int D>
void StiffPieces<D>::add(const float* r, float* z, int threads) const
{
  const std::int64_t nx = grid_.nodes(0);
  const std::int64_t rows = grid_.rows();
  const auto place = [&](std::int64_t x, std::int64_t row, std::int64_t plane)
  {
    return D == 3
      ? std::array<double, 3>{ static_cast<double>(x), static_cast<double>(row), static_cast<double>(plane) }
      : std::array<double, 3>{ static_cast<double>(x), static_cast<double>(plane), 0.0 };
  };
  Eigen::VectorXd right = Eigen::VectorXd::Zero(factor_.rows());
  for (std::int64_t k = 0; k < grid_.planes(); ++k)
    for (std::int64_t j = 0; j < rows; ++j)
      for (std::int64_t i = 0; i < nx; ++i)
        if (const std::int32_t o = owner_[static_cast<std::size_t>(i + nx * (j + rows * k))]; o >= 0)
        {
          const Piece& piece = pieces_[static_cast<std::size_t>(o)];
          const Basis b = basis(piece, place(i, j, k));
          Eigen::Matrix<double, D, 1> force;
          for (int c = 0; c < D; ++c)
            force(c) = static_cast<double>(r[c * grid_.componentStride() + grid_.at(j, k) + i]);
          right.segment(piece.first, piece.motions) += (b.transpose() * force).head(piece.motions);
        }
  const Eigen::VectorXd moved = factor_.solve(right);
#pragma omp parallel for num_threads(threads) if (threads > 1) schedule(static)
  for (std::int64_t k = 0; k < grid_.planes(); ++k)
    for (std::int64_t j = 0; j < rows; ++j)
      for (std::int64_t i = 0; i < nx; ++i)
        if (const std::int32_t o = owner_[static_cast<std::size_t>(i + nx * (j + rows * k))]; o >= 0)
        {
          const Piece& piece = pieces_[static_cast<std::size_t>(o)];
          const Eigen::Matrix<double, D, 1> u =
            basis(piece, place(i, j, k)).leftCols(piece.motions) * moved.segment(piece.first, piece.motions);
          for (int c = 0; c < D; ++c)
          {
            float* const row = z + c * grid_.componentStride() + grid_.at(j, k);
            row[i] += static_cast<float>(u(c));
            if (i == 0 && grid_.periodic[0])
              row[grid_.elements[0]] = row[0];
          }
        }
}

template class StiffPieces<2>;
template class StiffPieces<3>;

} // namespace lamella::elasticity
