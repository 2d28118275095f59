#include "peridynamics/fracture/SlowMotions.h"

#include "peridynamics/BondForces.h"
#include "peridynamics/fracture/EventKernels.h"
#include "peridynamics/multigrid/Level.h"

#include <algorithm>
#include <cmath>

namespace lamella::peridynamics
{
namespace
{

constexpr std::size_t most = 8;
constexpr double worn = 1e-3; // share of its first energy that a combination has left: less is round-off

} // namespace

SlowMotions::SlowMotions(const BondLattice& bonds, const LayerShare& share)
  : bonds_(bonds)
  , share_(share)
{
}

void SlowMotions::clear()
{
  motions_.clear();
  energy_.resize(0, 0);
  first_.resize(0);
  oldest_ = 0;
}

std::int64_t SlowMotions::bytes() const noexcept
{
  std::int64_t total = 0;
  for (const NodeField<float>& m : motions_)
    total += m.components() * m.layout().count() * static_cast<std::int64_t>(sizeof(float));
  return total;
}

// Row by row, so that the sums do not depend on the number of threads and ranks.
Eigen::VectorXd SlowMotions::along(const NodeField<float>& r)
{
  const NodeLayout& l = r.layout();
  const std::size_t count = motions_.size();
  sums_.assign(static_cast<std::size_t>(l.size[1] * l.size[2]) * count, 0.0);
  forLayers(l, share_.first(), share_.last(),
    [&](std::int64_t y, std::int64_t z)
    {
      const std::int64_t i = l.index(0, y, z);
      double* to = sums_.data() + static_cast<std::size_t>(y + l.size[1] * z) * count;
      for (std::size_t m = 0; m < count; ++m)
        for (int c = 0; c < l.dimension; ++c)
          to[m] += eventKernels().dot(l.size[0], motions_[m].component(c) + i, r.component(c) + i);
    });
  share_.gather(sums_);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(count));
  for (std::size_t row = 0; row < sums_.size(); row += count)
    for (std::size_t m = 0; m < count; ++m)
      sum[static_cast<Eigen::Index>(m)] += sums_[row + m];
  return sum;
}

void SlowMotions::answer(const NodeField<float>& r, NodeField<float>& x)
{
  if (motions_.empty())
    return;
  const Eigen::VectorXd s = first_.cwiseSqrt().cwiseInverse(); // equilibrated
  const Eigen::MatrixXd scaled = s.asDiagonal() * energy_ * s.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  const Eigen::VectorXd v = eigen.eigenvectors().transpose() * s.cwiseProduct(along(r));
  Eigen::VectorXd part = Eigen::VectorXd::Zero(v.size());
  for (Eigen::Index k = 0; k < v.size(); ++k)
    if (eigen.eigenvalues()[k] > worn)
      part[k] = v[k] / eigen.eigenvalues()[k];
  const Eigen::VectorXd a = s.cwiseProduct(eigen.eigenvectors() * part);
  const NodeLayout& l = r.layout();
  forLayers(l, share_.first(), share_.last(),
    [&](std::int64_t y, std::int64_t at)
    {
      const std::int64_t i = l.index(0, y, at);
      for (std::size_t m = 0; m < motions_.size(); ++m)
        for (int c = 0; c < l.dimension; ++c)
          levelKernels().axpy(l.size[0], static_cast<float>(a[static_cast<Eigen::Index>(m)]),
            motions_[m].component(c) + i, x.component(c) + i);
    });
}

void SlowMotions::keep(NodeField<float> motion, NodeField<float>& work)
{
  const bool full = motions_.size() == most;
  const std::size_t at = full ? oldest_ : motions_.size();
  if (full)
    motions_[at] = std::move(motion);
  else
    motions_.push_back(std::move(motion));
  oldest_ = (at + 1) % most;
  linearForceOfLayers(bonds_, motions_[at], work, share_.first(), share_.last());
  const Eigen::VectorXd row = -along(work);
  const auto n = static_cast<Eigen::Index>(motions_.size());
  const auto k = static_cast<Eigen::Index>(at);
  if (!(row[k] > 0)) // round-off
  {
    clear();
    return;
  }
  energy_.conservativeResize(n, n);
  first_.conservativeResize(n);
  energy_.row(k) = row.transpose();
  energy_.col(k) = row;
  first_[k] = row[k];
}

void SlowMotions::breakBond(std::int64_t index, int offset, double stiffness)
{
  if (motions_.empty())
    return;
  const Offset& half = bonds_.stencil().half()[static_cast<std::size_t>(offset)];
  const std::int64_t other = index + bonds_.jump(offset);
  Eigen::VectorXd v(static_cast<Eigen::Index>(motions_.size()));
  for (std::size_t m = 0; m < motions_.size(); ++m)
  {
    double along = 0;
    for (int c = 0; c < bonds_.dimension(); ++c)
      along +=
        (static_cast<double>(motions_[m].component(c)[other]) - static_cast<double>(motions_[m].component(c)[index])) *
        half.step[static_cast<std::size_t>(c)] / half.length;
    v[static_cast<Eigen::Index>(m)] = along;
  }
  energy_ -= stiffness * v * v.transpose();
}

} // namespace lamella::peridynamics
