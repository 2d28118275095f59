#include "cracks/BondCount.h"

#include "peridynamics/Stencil.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace lamella::cracks
{
namespace
{

using Normal = std::array<double, 3>;

std::array<int, 3> kindOf(const std::array<int, 3>& step)
{
  std::array<int, 3> kind{ std::abs(step[0]), std::abs(step[1]), std::abs(step[2]) };
  std::sort(kind.begin(), kind.end());
  return kind;
}

double lengthOf(const std::array<int, 3>& step)
{
  return std::sqrt(static_cast<double>(step[0] * step[0] + step[1] * step[1] + step[2] * step[2]));
}

/// Evenly over half of the directions; in space Fibonacci's spiral.
std::vector<Normal> directions(int dimension)
{
  const int count = dimension == 2 ? 720 : 2000;
  std::vector<Normal> all;
  for (int i = 0; i < count; ++i)
    if (dimension == 2)
    {
      const double angle = std::numbers::pi * i / count;
      all.push_back({ std::cos(angle), std::sin(angle), 0 });
    }
    else
    {
      const double z = (i + 0.5) / count;
      const double turn = std::numbers::pi * (3 - std::sqrt(5.0)) * i;
      const double r = std::sqrt(1 - z * z);
      all.push_back({ r * std::cos(turn), r * std::sin(turn), z });
    }
  return all;
}

} // namespace

BondCount::BondCount(int dimension, double horizon)
  : dimension_(dimension)
{
  const peridynamics::Stencil stencil(dimension, horizon);
  std::vector<std::array<int, 3>> kinds;
  for (const peridynamics::Offset& o : stencil.half())
    kinds.push_back(kindOf(o.step));
  std::sort(kinds.begin(), kinds.end());
  kinds.erase(std::unique(kinds.begin(), kinds.end()), kinds.end());
  const std::vector<Normal> normals = directions(dimension);
  const auto rows = static_cast<Eigen::Index>(normals.size());
  const auto columns = static_cast<Eigen::Index>(kinds.size());

  // by kinds of steps: Σ |ξ · n|/|ξ| over the steps of the kind
  Eigen::MatrixXd cuts = Eigen::MatrixXd::Zero(rows, columns);
  for (const peridynamics::Offset& o : stencil.half())
  {
    const auto column = std::lower_bound(kinds.begin(), kinds.end(), kindOf(o.step)) - kinds.begin();
    for (Eigen::Index r = 0; r < rows; ++r)
    {
      const Normal& n = normals[static_cast<std::size_t>(r)];
      cuts(r, column) += std::abs(o.step[0] * n[0] + o.step[1] * n[1] + o.step[2] * n[2]) / o.length;
    }
  }
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(columns);
  weights /= (cuts * weights).mean();
  const Eigen::VectorXd left = Eigen::VectorXd::Ones(rows) - cuts * weights;
  const Eigen::MatrixXd square = cuts.transpose() * cuts / static_cast<double>(rows);
  // as near to these as leaves the scatter of the counts small
  constexpr double hold = 1e-3;
  const Eigen::MatrixXd held =
    square + hold * square.trace() / static_cast<double>(columns) * Eigen::MatrixXd::Identity(columns, columns);
  weights += held.ldlt().solve(cuts.transpose() * left / static_cast<double>(rows));
  weights /= (cuts * weights).mean();
  anisotropy_ = (cuts * weights - Eigen::VectorXd::Ones(rows)).cwiseAbs().maxCoeff();
  for (std::size_t k = 0; k < kinds.size(); ++k)
    weights_[kinds[k]] = weights[static_cast<Eigen::Index>(k)] / lengthOf(kinds[k]);
}

double BondCount::weight(const std::array<int, 3>& step) const
{
  const auto found = weights_.find(kindOf(step));
  return found == weights_.end() ? 0 : found->second;
}

double BondCount::size(std::span<const CutBond> bonds) const
{
  double sum = 0;
  for (const CutBond& b : bonds)
    sum += weight(b.step);
  return sum;
}

std::array<double, 9> BondCount::normals(std::span<const CutBond> bonds) const
{
  std::array<double, 9> tensor{};
  double sum = 0;
  for (const CutBond& b : bonds)
  {
    const double w = weight(b.step);
    const double square = lengthOf(b.step) * lengthOf(b.step);
    sum += w;
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t c = 0; c < 3; ++c)
        tensor[3 * r + c] += w * b.step[r] * b.step[c] / square;
  }
  if (sum == 0)
    return tensor;
  for (double& t : tensor)
    t *= (dimension_ + 1) / sum;
  for (std::size_t a = 0; a < static_cast<std::size_t>(dimension_); ++a)
    tensor[4 * a] -= 1;
  return tensor;
}

} // namespace lamella::cracks
