#include "packing/Enthalpy.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lamella::packing
{

template <int Dim>
Enthalpy<Dim>::Enthalpy(GrainSystem<Dim>& grains, const RelaxationOptions& options)
  : g_(grains)
  , options_(options)
  , law_(options.smoothing)
  , boxUnknowns_(options.box == BoxMotion::Fixed ? 0
        : options.box == BoxMotion::Volume       ? 1
                                                 : Dim)
{
  g_.sight = law_.smoothing > 0 ? ContactLaw::reach : 0;
}

template <int Dim>
Enthalpy<Dim>::~Enthalpy()
{
  g_.sight = 0;
}

template <int Dim>
void Enthalpy<Dim>::evaluate()
{
  g_.updatePairs();
  force_.setZero(size());
  virial_.setZero();
  forceSum_ = 0;
  contacts_ = 0;
  for (std::size_t index = 0; index < g_.pairs().size(); ++index)
  {
    const auto& pair = g_.pairs()[index];
    const Vec r = g_.separation(index);
    const double square = r.squaredNorm();
    const double most = pair.reach + (law_.smoothing > 0 ? ContactLaw::reach : 0);
    if (square >= most * most)
      continue;
    const double distance = std::sqrt(square);
    const double f = law_.force(pair.reach - distance);
    const Vec onSecond = f / distance * r;
    force_.template segment<Dim>(Dim * static_cast<Eigen::Index>(pair.first)) -= onSecond;
    force_.template segment<Dim>(Dim * static_cast<Eigen::Index>(pair.second)) += onSecond;
    virial_ += onSecond.cwiseProduct(r);
    forceSum_ += f;
    ++contacts_;
  }
  for (int wall = 0; wall < GrainSystem<Dim>::walls; ++wall)
  {
    const int axis = wall / 2;
    if (g_.periodic[static_cast<std::size_t>(axis)])
      continue;
    for (std::size_t i = 0; i < g_.count(); ++i)
    {
      const double overlap = g_.wallOverlap(i, wall);
      if (!law_.acts(overlap))
        continue;
      const double f = law_.force(overlap);
      force_[Dim * static_cast<Eigen::Index>(i) + axis] += wall % 2 == 0 ? f : -f;
      virial_[axis] += f * (g_.radius[i] - overlap);
      forceSum_ += f;
      ++contacts_;
    }
  }
  if (boxUnknowns_ == 0)
    return;
  const Vec onBox = virial_ - options_.pressure * g_.volume() * wallShares<Dim>(g_, options_);
  if (boxUnknowns_ == 1)
    force_[size() - 1] = onBox.sum();
  else
    force_.template tail<Dim>() = onBox;
}

template <int Dim>
double Enthalpy<Dim>::unbalanced() const
{
  double sum = 0;
  for (std::size_t i = 0; i < g_.count(); ++i)
    sum += force_.template segment<Dim>(Dim * static_cast<Eigen::Index>(i)).norm();
  if (sum == 0)
    return 0;
  if (contacts_ == 0)
    return std::numeric_limits<double>::infinity();
  // smoothed, all near pairs push a little: as if 2 Dim contacts a grain held them
  const double held = law_.smoothing > 0 ? Dim * static_cast<double>(g_.count()) : static_cast<double>(contacts_);
  return sum / static_cast<double>(g_.count()) / (forceSum_ / held);
}

template <int Dim>
double Enthalpy<Dim>::pressureError() const
{
  if (boxUnknowns_ == 0)
    return 0;
  return force_.tail(boxUnknowns_).cwiseAbs().maxCoeff() / (boxUnknowns_ == 1 ? Dim : 1) /
    (options_.pressure * g_.volume());
}

template <int Dim>
void Enthalpy<Dim>::move(const Eigen::VectorXd& step)
{
  for (std::size_t i = 0; i < g_.count(); ++i)
    g_.position[i] += step.template segment<Dim>(Dim * static_cast<Eigen::Index>(i));
  if (boxUnknowns_ == 1)
    g_.strain(Vec::Constant(std::exp(step[size() - 1])));
  else if (boxUnknowns_ == Dim)
    g_.strain(step.template tail<Dim>().array().exp());
}

template <int Dim>
const BlockMatrix<Dim>& Enthalpy<Dim>::hessian()
{
  linksChanged_ = false;
  if (version_ != g_.pairsVersion() || !addGrains())
  {
    makeLinks();
    addGrains();
  }
  addWalls();
  addBox();
  return matrix_;
}

// A separation changes by (dx₂ − dx₁) + Q r with Q the strain: its derivatives by the box are those by the second
// grain, times r. Where the box has one unknown for all edges they are in the first column.
template <int Dim>
typename Enthalpy<Dim>::Square Enthalpy<Dim>::onBox(const Vec& r, const Square& k) const
{
  if (boxUnknowns_ == Dim)
    return k * r.asDiagonal();
  Square g = Square::Zero();
  if (boxUnknowns_ == 1)
    g.col(0) = k * r;
  return g;
}

template <int Dim>
void Enthalpy<Dim>::makeLinks()
{
  linkOf_.assign(g_.pairs().size(), -1);
  matrix_.links.clear();
  for (std::size_t index = 0; index < g_.pairs().size(); ++index)
  {
    const auto& pair = g_.pairs()[index];
    const double most = pair.reach + widest() + nearby;
    if (g_.separation(index).squaredNorm() >= most * most)
      continue;
    linkOf_[index] = static_cast<std::int32_t>(matrix_.links.size());
    matrix_.links.push_back({ pair.first, pair.second });
  }
  version_ = g_.pairsVersion();
  linksChanged_ = true;
}

// @returns false: two that touch are not linked
template <int Dim>
bool Enthalpy<Dim>::addGrains()
{
  matrix_.diagonal.assign(g_.count(), Square::Zero());
  matrix_.border.assign(g_.count(), Square::Zero());
  matrix_.coupling.assign(matrix_.links.size(), Square::Zero());
  matrix_.corner.setZero();
  for (std::size_t index = 0; index < g_.pairs().size(); ++index)
  {
    const auto& pair = g_.pairs()[index];
    const Vec r = g_.separation(index);
    const double square = r.squaredNorm();
    const double most = pair.reach + widest();
    if (square >= most * most)
      continue;
    if (linkOf_[index] < 0)
      return false;
    const double distance = std::sqrt(square);
    const double overlap = pair.reach - distance;
    const Vec n = r / distance;
    const double across = law_.force(overlap) / distance;
    const Square k = (law_.slope(overlap) + across) * n * n.transpose() - across * Square::Identity();
    const Square g = onBox(r, k);
    const auto first = static_cast<std::size_t>(pair.first);
    const auto second = static_cast<std::size_t>(pair.second);
    matrix_.diagonal[first] += k;
    matrix_.diagonal[second] += k;
    matrix_.coupling[static_cast<std::size_t>(linkOf_[index])] = -k;
    matrix_.border[first] -= g;
    matrix_.border[second] += g;
    addToCorner(r, g);
  }
  return true;
}

template <int Dim>
void Enthalpy<Dim>::addWalls()
{
  for (int wall = 0; wall < GrainSystem<Dim>::walls; ++wall)
  {
    const int axis = wall / 2;
    if (g_.periodic[static_cast<std::size_t>(axis)])
      continue;
    const Vec n = GrainSystem<Dim>::wallNormal(wall);
    for (std::size_t i = 0; i < g_.count(); ++i)
    {
      const double overlap = g_.wallOverlap(i, wall);
      if (!law_.acts(overlap))
        continue;
      const Square k = law_.slope(overlap) * n * n.transpose();
      const Vec r = (g_.radius[i] - overlap) * n;
      const Square g = onBox(r, k);
      matrix_.diagonal[i] += k;
      matrix_.border[i] -= g;
      addToCorner(r, g);
    }
  }
}

template <int Dim>
void Enthalpy<Dim>::addToCorner(const Vec& r, const Square& g)
{
  if (boxUnknowns_ == Dim)
    matrix_.corner += r.asDiagonal() * g;
  else if (boxUnknowns_ == 1)
    matrix_.corner(0, 0) += r.dot(g.col(0));
}

// Second derivatives of pV, and of each contact's energy through exp(q): − force · r on the diagonal.
template <int Dim>
void Enthalpy<Dim>::addBox()
{
  const double pv = options_.pressure * g_.volume();
  if (boxUnknowns_ == 1)
    matrix_.corner(0, 0) += Dim * Dim * pv - virial_.sum();
  else if (boxUnknowns_ == Dim)
  {
    matrix_.corner.array() += pv;
    matrix_.corner.diagonal() -= virial_;
  }
  for (int a = boxUnknowns_; a < Dim; ++a)
    matrix_.corner(a, a) = 1;
}

template class Enthalpy<2>;
template class Enthalpy<3>;

} // namespace lamella::packing
