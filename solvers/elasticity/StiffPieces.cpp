#include "elasticity/StiffPieces.h"

#include <algorithm>
#include <map>
#include <utility>

namespace lamella::elasticity
{
namespace
{

constexpr std::size_t mostPieces = 20000;
constexpr std::int64_t leastVoxels = 8; // of a piece
constexpr double ground = 1e-9;         // added to the diagonal, relative: all pieces may be free to move together

} // namespace

template <int D>
StiffPieces<D>::StiffPieces(const ElasticGrid<D>& grid, std::span<const std::uint8_t> phase,
  const std::vector<bool>& stiff, const std::function<ElementMatrix(std::uint8_t)>& element)
  : grid_(grid)
  , motion_(grid, phase, stiff, leastVoxels, mostPieces)
{
  std::int64_t unknowns = 0;
  for (std::size_t p = 0; p < pieces(); ++p)
  {
    first_.push_back(unknowns);
    unknowns += motionsOf(p);
  }
  first_.push_back(unknowns);
  if (pieces() > 1)
    assemble(phase, stiff, element);
}

template <int D>
void StiffPieces<D>::assemble(std::span<const std::uint8_t> phase, const std::vector<bool>& stiff,
  const std::function<ElementMatrix(std::uint8_t)>& element)
{
  using Moved = Eigen::Matrix<double, D * corners, bodyMotions>;
  using Block = Eigen::Matrix<double, bodyMotions, bodyMotions>;
  const std::vector<std::int32_t> owners = motion_.owners();
  std::map<std::uint8_t, ElementMatrix> matrices;
  std::map<std::pair<std::int32_t, std::int32_t>, Block> blocks;
  std::array<std::int64_t, 3> size{ 1, 1, 1 };
  std::copy(grid_.elements.begin(), grid_.elements.end(), size.begin());
  const auto around = [&](std::int64_t i, int axis) { return i == grid_.nodes(axis) ? 0 : i; };
  std::size_t i = 0;
  for (std::int64_t z = 0; z < size[2]; ++z)
    for (std::int64_t y = 0; y < size[1]; ++y)
      for (std::int64_t x = 0; x < size[0]; ++x, ++i)
      {
        std::array<std::array<std::int64_t, D>, corners> node{};
        std::array<std::int32_t, corners> owner{};
        std::array<std::int32_t, corners> piece{};
        for (int k = 0; k < corners; ++k)
        {
          auto& n = node[static_cast<std::size_t>(k)];
          n[0] = around(x + (k & 1), 0);
          n[1] = around(y + (k >> 1 & 1), 1);
          std::int64_t at = n[0] + grid_.nodes(0) * n[1];
          if constexpr (D == 3)
          {
            n[2] = around(z + (k >> 2), 2);
            at += grid_.nodes(0) * grid_.nodes(1) * n[2];
          }
          const std::int32_t o = owner[static_cast<std::size_t>(k)] = owners[static_cast<std::size_t>(at)];
          piece[static_cast<std::size_t>(k)] = o < 0 ? -1 : motion_.pieceOf(o);
        }
        // what moves as a body does not strain; a soft element may lie between a piece and the piece's own next copy
        if (std::ranges::all_of(piece, [&](std::int32_t p) { return p == piece[0]; }) &&
          (piece[0] < 0 || stiff[phase[i]]))
          continue;
        auto found = matrices.find(phase[i]);
        if (found == matrices.end())
          found = matrices.emplace(phase[i], element(phase[i])).first;
        std::array<std::int32_t, corners> distinct = piece;
        std::ranges::sort(distinct);
        const auto end = std::unique(distinct.begin(), distinct.end());
        std::array<Moved, corners> moved;
        std::array<std::int32_t, corners> whose{};
        int count = 0;
        for (auto p = distinct.begin(); p != end; ++p)
        {
          if (*p < 0)
            continue;
          Moved& m = moved[static_cast<std::size_t>(count)];
          m.setZero();
          for (int k = 0; k < corners; ++k)
          {
            if (piece[static_cast<std::size_t>(k)] != *p)
              continue;
            const auto d = motion_.fromCentre(owner[static_cast<std::size_t>(k)], node[static_cast<std::size_t>(k)]);
            for (int motion = 0; motion < motionsOf(static_cast<std::size_t>(*p)); ++motion)
            {
              const auto affine = PieceMotions<D>::affineOf(PieceMotions<D>::Motions::Unit(motion));
              const Eigen::Matrix<double, D, 1> u = affine.shift + affine.slope * d;
              for (int c = 0; c < D; ++c)
                m(c * corners + k, motion) = u(c);
            }
          }
          whose[static_cast<std::size_t>(count++)] = *p;
        }
        for (int p = 0; p < count; ++p)
        {
          const Moved force = found->second * moved[static_cast<std::size_t>(p)];
          for (int q = 0; q < count; ++q)
            blocks
              .try_emplace(
                std::pair{ whose[static_cast<std::size_t>(q)], whose[static_cast<std::size_t>(p)] }, Block::Zero())
              .first->second += moved[static_cast<std::size_t>(q)].transpose() * force;
        }
      }
  std::vector<Eigen::Triplet<double>> entries;
  double largest = 0;
  for (const auto& [pair, block] : blocks)
  {
    const auto row = static_cast<std::size_t>(pair.first);
    const auto column = static_cast<std::size_t>(pair.second);
    for (int a = 0; a < motionsOf(row); ++a)
      for (int b = 0; b < motionsOf(column); ++b)
      {
        const bool diagonal = row == column && a == b;
        largest = std::max(largest, diagonal ? block(a, b) : 0.0);
        entries.emplace_back(static_cast<int>(first_[row] + a), static_cast<int>(first_[column] + b),
          block(a, b) * (diagonal ? 1 + ground : 1));
      }
  }
  const auto unknowns = static_cast<int>(first_.back());
  for (int k = 0; k < unknowns; ++k) // pieces that touch nothing
    entries.emplace_back(k, k, ground * largest);
  Eigen::SparseMatrix<double> matrix(unknowns, unknowns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  factor_.compute(matrix);
}

template <int D>
template <class Real>
void StiffPieces<D>::add(std::vector<typename PieceMotions<D>::Affine> affine, int threads, Real* u) const
{
  Eigen::VectorXd right(first_.back());
  for (std::size_t p = 0; p < affine.size(); ++p)
    right.segment(first_[p], motionsOf(p)) = PieceMotions<D>::workOf(affine[p]).head(motionsOf(p));
  const Eigen::VectorXd moved = factor_.solve(right);
  for (std::size_t p = 0; p < affine.size(); ++p)
  {
    auto motion = PieceMotions<D>::Motions::Zero().eval();
    motion.head(motionsOf(p)) = moved.segment(first_[p], motionsOf(p));
    affine[p] = PieceMotions<D>::affineOf(motion);
  }
  motion_.place(std::span<const typename PieceMotions<D>::Affine>(affine), true, threads, u);
}

template class StiffPieces<2>;
template class StiffPieces<3>;
template void StiffPieces<2>::add(std::vector<PieceMotions<2>::Affine>, int, float*) const;
template void StiffPieces<3>::add(std::vector<PieceMotions<3>::Affine>, int, float*) const;
template void StiffPieces<2>::add(std::vector<PieceMotions<2>::Affine>, int, double*) const;
template void StiffPieces<3>::add(std::vector<PieceMotions<3>::Affine>, int, double*) const;

} // namespace lamella::elasticity
