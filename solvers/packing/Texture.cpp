#include "packing/Texture.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lamella::packing
{
namespace
{

template <int Dim>
typename GrainSystem<Dim>::Vec between(const GrainSystem<Dim>& grains, std::size_t from, std::size_t to)
{
  typename GrainSystem<Dim>::Vec r = grains.position[to] - grains.position[from];
  for (int a = 0; a < Dim; ++a)
    if (grains.periodic[static_cast<std::size_t>(a)])
      r[a] -= grains.box[a] * std::round(r[a] / grains.box[a]);
  return r;
}

} // namespace

template <int Dim>
Texture<Dim>::Texture(const GrainSystem<Dim>& grains, const Packing& packing, const PackingStatistics& statistics)
  : grains_(grains)
  , own_(grains.count(), Square::Zero())
{
  for (const Contact& c : packing.contacts)
  {
    const auto first = static_cast<std::size_t>(c.first);
    const auto second = static_cast<std::size_t>(c.second);
    if (c.second < 0 || statistics.rattler[first] != 0 || statistics.rattler[second] != 0)
      continue;
    const Vec n = Eigen::Map<const Vec>(c.normal.data());
    const Square each = n * n.transpose();
    fabric_ += each;
    own_[first] += 0.5 * each;
    own_[second] += 0.5 * each;
  }
  const Eigen::SelfAdjointEigenSolver<Square> axes(fabric_);
  const Vec few = axes.eigenvectors().col(0);
  const Vec many = axes.eigenvectors().col(Dim - 1);
  turn_ += few * many.transpose() - many * few.transpose() - few * few.transpose() - many * many.transpose();
}

template <int Dim>
std::size_t Texture<Dim>::regionToTurn(std::span<const std::size_t> tried) const
{
  std::size_t chosen = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < grains_.count(); ++i)
  {
    bool inside = true;
    for (int a = 0; a < Dim; ++a)
      inside = inside &&
        (grains_.periodic[static_cast<std::size_t>(a)] ||
          std::min(grains_.position[i][a], grains_.box[a] - grains_.position[i][a]) >= radius);
    if (!inside ||
      std::any_of(
        tried.begin(), tried.end(), [&](std::size_t t) { return between(grains_, i, t).norm() < 0.5 * radius; }))
      continue;
    Square region = Square::Zero();
    for (std::size_t j = 0; j < grains_.count(); ++j)
      if (between(grains_, i, j).squaredNorm() < radius * radius)
        region += own_[j];
    const Square after = fabric_ - region + turn_ * region * turn_.transpose();
    const double deviator = (after - Square::Identity() * (after.trace() / Dim)).norm();
    if (deviator < least)
    {
      least = deviator;
      chosen = i;
    }
  }
  return chosen;
}

template <int Dim>
void Texture<Dim>::turn(GrainSystem<Dim>& grains, std::size_t middle) const
{
  std::vector<Vec> moved(grains.count(), Vec::Zero());
  for (std::size_t i = 0; i < grains.count(); ++i)
    if (const Vec r = between(grains, middle, i); r.squaredNorm() < radius * radius)
      moved[i] = turn_ * r - r;
  for (std::size_t i = 0; i < grains.count(); ++i)
    grains.position[i] += moved[i];
}

template class Texture<2>;
template class Texture<3>;

} // namespace lamella::packing
