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
const typename Enthalpy<Dim>::Matrix& Enthalpy<Dim>::hessian()
{
  patternChanged_ = false;
  if (version_ != g_.pairsVersion() || !fill())
  {
    makePattern();
    fill();
  }
  return matrix_;
}

// The entries of a contact, the same for every k in the same order. Its separation changes by (dx₂ − dx₁) + Q r with Q
// the strain: its derivatives are those of r.
template <int Dim>
template <typename Add>
void Enthalpy<Dim>::contact(
  const Vec& r, const Square& k, Eigen::Index first, Eigen::Index second, const Add& add) const
{
  const Eigen::Index box = firstOfBox();
  const Vec kr = k * r;
  for (int a = 0; a < Dim; ++a)
    for (int b = 0; b < Dim; ++b)
    {
      if (a >= b)
        add(first + a, first + b, k(a, b));
      if (second >= 0)
      {
        if (a >= b)
          add(second + a, second + b, k(a, b));
        add(std::max(first, second) + a, std::min(first, second) + b, -k(a, b));
      }
      if (boxUnknowns_ == Dim)
      {
        if (a >= b)
          add(box + a, box + b, r[a] * k(a, b) * r[b]);
        add(box + a, first + b, -r[a] * k(a, b));
        if (second >= 0)
          add(box + a, second + b, r[a] * k(a, b));
      }
    }
  if (boxUnknowns_ != 1)
    return;
  add(box, box, r.dot(kr));
  for (int b = 0; b < Dim; ++b)
  {
    add(box, first + b, -kr[b]);
    if (second >= 0)
      add(box, second + b, kr[b]);
  }
}

// Everything that touches, or nearly: `seen(index, touches, r, k, first, second)`, where index counts pairs, then walls
// by grain.
template <int Dim>
template <typename Seen>
void Enthalpy<Dim>::forContacts(const Seen& seen) const
{
  for (std::size_t index = 0; index < g_.pairs().size(); ++index)
  {
    const auto& pair = g_.pairs()[index];
    const Vec r = g_.separation(index);
    const double square = r.squaredNorm();
    if (square >= (pair.reach + widest()) * (pair.reach + widest()))
      continue;
    const double distance = std::sqrt(square);
    const double overlap = pair.reach - distance;
    const Vec n = r / distance;
    const bool acts = law_.acts(overlap);
    const double across = acts ? law_.force(overlap) / distance : 0;
    const Square k =
      (acts ? law_.slope(overlap) : 0) * n * n.transpose() - across * (Square::Identity() - n * n.transpose());
    if (!seen(
          index, acts, r, k, Dim * static_cast<Eigen::Index>(pair.first), Dim * static_cast<Eigen::Index>(pair.second)))
      return;
  }
  for (int wall = 0; wall < GrainSystem<Dim>::walls; ++wall)
  {
    if (g_.periodic[static_cast<std::size_t>(wall / 2)])
      continue;
    const Vec n = GrainSystem<Dim>::wallNormal(wall);
    for (std::size_t i = 0; i < g_.count(); ++i)
    {
      const double overlap = g_.wallOverlap(i, wall);
      if (overlap <= -widest())
        continue;
      const std::size_t index = g_.pairs().size() + static_cast<std::size_t>(wall) * g_.count() + i;
      const bool acts = law_.acts(overlap);
      if (!seen(index, acts, (g_.radius[i] - overlap) * n, Square((acts ? law_.slope(overlap) : 0) * n * n.transpose()),
            Dim * static_cast<Eigen::Index>(i), -1))
        return;
    }
  }
}

// Second derivatives of pV, and of each contact's energy through exp(q): − force · r on the diagonal.
template <int Dim>
template <typename Add>
void Enthalpy<Dim>::ofBox(const Add& add) const
{
  const Eigen::Index box = firstOfBox();
  const double pv = options_.pressure * g_.volume();
  if (boxUnknowns_ == 1)
    add(box, box, Dim * Dim * pv - virial_.sum());
  else if (boxUnknowns_ == Dim)
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b <= a; ++b)
        add(box + a, box + b, pv - (a == b ? virial_[a] : 0));
}

template <int Dim>
void Enthalpy<Dim>::makePattern()
{
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](Eigen::Index row, Eigen::Index column, double)
  { entries.emplace_back(static_cast<int>(row), static_cast<int>(column), 0.0); };
  firstSlot_.assign(g_.pairs().size() + static_cast<std::size_t>(GrainSystem<Dim>::walls) * g_.count(), -1);
  forContacts(
    [&](std::size_t index, bool, const Vec& r, const Square& k, Eigen::Index first, Eigen::Index second)
    {
      firstSlot_[index] = static_cast<std::ptrdiff_t>(entries.size());
      contact(r, k, first, second, add);
      return true;
    });
  boxSlot_ = entries.size();
  ofBox(add);
  const std::size_t used = entries.size();
  for (Eigen::Index i = 0; i < size(); ++i) // also of grains that nothing touches
    add(i, i, 0);
  matrix_.resize(size(), size());
  matrix_.setFromTriplets(entries.begin(), entries.end());
  slots_.resize(used);
  for (std::size_t e = 0; e < used; ++e)
  {
    const int* const rows = matrix_.innerIndexPtr();
    const int* const begin = rows + matrix_.outerIndexPtr()[entries[e].col()];
    const int* const end = rows + matrix_.outerIndexPtr()[entries[e].col() + 1];
    slots_[e] = static_cast<std::int32_t>(std::lower_bound(begin, end, entries[e].row()) - rows);
  }
  version_ = g_.pairsVersion();
  patternChanged_ = true;
}

// @returns false: one that touches has no entries
template <int Dim>
bool Enthalpy<Dim>::fill()
{
  double* const values = matrix_.valuePtr();
  std::fill_n(values, matrix_.nonZeros(), 0.0);
  const std::int32_t* slot = nullptr;
  const auto add = [&](Eigen::Index, Eigen::Index, double value) { values[*slot++] += value; };
  bool complete = true;
  forContacts(
    [&](std::size_t index, bool touches, const Vec& r, const Square& k, Eigen::Index first, Eigen::Index second)
    {
      if (!touches)
        return true;
      complete = firstSlot_[index] >= 0;
      if (complete)
      {
        slot = slots_.data() + firstSlot_[index];
        contact(r, k, first, second, add);
      }
      return complete;
    });
  slot = slots_.data() + boxSlot_;
  ofBox(add);
  return complete;
}

template class Enthalpy<2>;
template class Enthalpy<3>;

} // namespace lamella::packing
